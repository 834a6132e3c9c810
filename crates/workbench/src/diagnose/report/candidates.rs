//! The section on the sets of effects that were compared.

use super::figures;
use super::markup::{figure, table};
use crate::diagnose::console::{number, readable};
use crate::diagnose::finding::Finding;

/// Sets of effects that are listed.
const SHOWN_RIVALS: usize = 6;

/// The sets of effects that were fitted, as bars and as a table, and the check of what the best leaves.
pub fn candidates(finding: &Finding) -> String {
    if finding.ranking.is_empty() {
        return String::new();
    }
    let check = finding.check.map_or(String::new(), |check| {
        let structure = check.p_value.map_or(
            "no structure that noise would not leave".to_owned(),
            |p_value| {
                format!(
                    "structure that records of the fitted model itself leave with a probability of {}",
                    number(p_value)
                )
            },
        );
        format!(
            "<p>The check of what is left: {structure}. Squared residuals over their number are {}.</p>\n",
            number(check.misfit)
        )
    });
    format!(
        "<h2>The candidates</h2>\n{}{}{check}",
        figure(
            &figures::ranking(finding),
            "Sets of effects fitted on top of the model together with its nominal parameters, and judged on windows they were \
             not fitted to. A gain near zero says that chance does as well.",
        ),
        rivals(finding)
    )
}

/// The sets with their probabilities and how far the best is ahead of each.
fn rivals(finding: &Finding) -> String {
    let cell = |value: Option<f64>| value.map_or("–".to_owned(), number);
    let rows: Vec<Vec<String>> = finding
        .ranking
        .iter()
        .take(SHOWN_RIVALS)
        .map(|ranked| {
            let margin = match (ranked.margin, ranked.margin_error) {
                (Some(margin), Some(error)) => format!("{} ± {}", number(margin), number(error)),
                _ => "–".to_owned(),
            };
            vec![
                readable(&ranked.name),
                ranked
                    .probability
                    .map_or("–".to_owned(), |p| format!("{p:.3}")),
                cell(ranked.score),
                margin,
            ]
        })
        .collect();
    let columns = [
        ("set of effects", false),
        ("probability", true),
        ("log evidence less the best's", true),
        (
            "the best is ahead by, in ln likelihood on windows left out",
            true,
        ),
    ];
    table(&columns, &rows)
}
