//! Whether probabilities are what they say: of the findings that say 0.9, nine in ten are right.

use std::fmt::Write as _;

use serde::Serialize;

use super::judge::Judgement;
use super::wilson::Share;

/// Where the bins of the reliability table end.
const ENDS: [f64; 6] = [0.5, 0.7, 0.9, 0.97, 0.99, 1.0];

/// Findings whose first set has about the same probability.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bin {
    /// Probabilities from the first, and up to and with the second of these.
    pub range: [f64; 2],
    /// Findings.
    pub cases: usize,
    /// Mean of their probabilities.
    pub said: f64,
    /// Share whose first set is the hidden one.
    pub right: f64,
    /// Wilson's interval of that share.
    pub interval95: [f64; 2],
}

/// The findings that answer with a set of effects or with none, by their probability; bins without a finding are left out.
#[must_use]
pub fn bins(judged: &[Judgement]) -> Vec<Bin> {
    let mut bins = Vec::new();
    let mut low = 0.0;
    for high in ENDS {
        let own: Vec<(f64, bool)> = judged
            .iter()
            .filter_map(|j| j.first_set)
            .filter(|(said, _)| (low == 0.0 || *said > low) && *said <= high)
            .collect();
        if !own.is_empty() {
            let right = Share::of(own.iter(), |(_, right)| *right);
            bins.push(Bin {
                range: [low, high],
                cases: own.len(),
                said: own.iter().map(|(said, _)| said).sum::<f64>() / own.len() as f64,
                right: right.value(),
                interval95: right.interval95(),
            });
        }
        low = high;
    }
    bins
}

/// Expected calibration error: how far share and probability are apart, on the average over the findings.
#[must_use]
pub fn calibration_error(bins: &[Bin]) -> Option<f64> {
    let cases: usize = bins.iter().map(|bin| bin.cases).sum();
    let apart: f64 = bins
        .iter()
        .map(|bin| bin.cases as f64 * (bin.said - bin.right).abs())
        .sum();
    (cases > 0).then(|| apart / cases as f64)
}

/// The table as Markdown.
#[must_use]
pub fn to_markdown(bins: &[Bin]) -> String {
    let mut text = String::from(
        "| probability of the first set | findings | mean | right | 95 % interval |\n|---|---|---|---|---|\n",
    );
    for bin in bins {
        let [low, high] = bin.range;
        let [least, most] = bin.interval95.map(|share| 100.0 * share);
        let _ = writeln!(
            text,
            "| {low} to {high} | {} | {:.3} | {:.1} % | {least:.1}–{most:.1} % |",
            bin.cases,
            bin.said,
            100.0 * bin.right
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::score::answer::Group;

    fn said(probability: f64, right: bool) -> Judgement {
        Judgement {
            group: Group::Full,
            kind: "unbalance".into(),
            said: "unbalance".into(),
            top_1: right,
            exact: right,
            named: true,
            false_name: !right,
            quiet: false,
            flagged: false,
            first_set: Some((probability, right)),
            size_errors: Vec::new(),
            covered: Vec::new(),
            closed: None,
            seconds: 1.0,
        }
    }

    #[test]
    fn calibration_is_the_mean_distance_of_share_and_probability() {
        // Two of four that say 0.8 are right, and all of four that say 1: (4 × 0.3 + 4 × 0) / 8.
        let judged: Vec<Judgement> = [0.8, 0.8, 0.8, 0.8, 1.0, 1.0, 1.0, 1.0]
            .into_iter()
            .enumerate()
            .map(|(j, probability)| said(probability, j > 1))
            .collect();
        let bins = bins(&judged);
        assert_eq!(bins.len(), 2);
        assert_eq!((bins[0].cases, bins[0].right), (4, 0.5));
        assert!((calibration_error(&bins).unwrap() - 0.15).abs() < 1e-12);
        assert_eq!(calibration_error(&[]), None);
    }

    #[test]
    fn every_probability_is_in_one_bin() {
        for probability in [0.0, 0.3, 0.5, 0.9, 0.995, 1.0] {
            assert_eq!(bins(&[said(probability, true)]).len(), 1, "{probability}");
        }
    }
}
