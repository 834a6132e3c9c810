//! What is in no catalogue, learned: a free function that the amended model carries as a table, where it predicts the record that
//! is held out better than the analyst's model.

use inference::fit::Fit;
use inference::learned::Learned;
use inference::problem::Problem;
use inference::structure::structures;

use super::amend::{FittedRig, refitted};
use super::case::Case;
use super::console::readable;
use super::disagreements::disagreements;
use super::finding::{Finding, LearnedTerm};
use super::show::is_worse;

/// Standard errors from the middle to the end of a 95 % interval.
const TO_95_PERCENT: f64 = 1.96;

/// Puts into `finding`, whose verdict is that no effect of the catalogue explains the records, what its amended model is: `base`,
/// the analyst's refitted model, with the function that was learned. Where that predicts the held-out record worse than the
/// analyst's model, the function is left out; where `base` does so too, the analyst's model stays as it is.
///
/// # Errors
/// A model's number leaves its range.
pub fn explain_without_cause(
    case: &Case,
    problem: &Problem,
    base: &Fit,
    learned: Option<&Learned>,
    finding: &mut Finding,
) -> anyhow::Result<()> {
    if let Some(learned) = learned {
        let rig = problem.units.to_si(&learned.fit.hypothesis.rig_at()?)?;
        if !is_worse(case, &rig)? {
            return take_over(problem, learned, finding);
        }
        finding.notes.push(format!(
            "a function was learned, {}, but with it the model predicts the held-out record worse than without: it is left out",
            readable(&learned.family.name())
        ));
    } else {
        finding.notes.push(
            if problem.rig.equations.is_full() {
                "no function of one coordinate was learned: the model has as many effects by equation as it can have; take out one \
                 that it does not need"
            } else {
                "no function of one coordinate was learned: none explains enough of what is left"
            }
            .to_owned(),
        );
    }
    let rig = problem.units.to_si(&base.hypothesis.rig_at()?)?;
    if is_worse(case, &rig)? {
        finding.parameters.clear();
        finding.notes.push(
            "refitted parameters predict the held-out record worse than the model as it is: the amended model keeps its own"
                .to_owned(),
        );
    }
    Ok(())
}

fn take_over(problem: &Problem, learned: &Learned, finding: &mut Finding) -> anyhow::Result<()> {
    let estimates = learned.fit.estimates(&problem.long);
    let fitted = FittedRig::of(
        &learned.fit.hypothesis.rig_at()?,
        &estimates,
        &problem.units,
    )?;
    finding.parameters = refitted(&fitted);
    finding.friction_fluctuation = learned.fit.disturbance.relative;
    finding.structure_left =
        disagreements(&structures(&problem.long, &learned.fit), &problem.units);
    let table = &learned.table;
    finding.learned = Some(LearnedTerm {
        name: table.name.clone(),
        port: table.port.name().to_owned(),
        coordinate: learned.family.over.name().to_owned(),
        equation: table.equation.clone(),
        coordinate_unit: table.units[0].to_owned(),
        unit: table.units[1].to_owned(),
        period: table.period,
        knots: table.knots.clone(),
        values: table.values.clone(),
        interval95: table
            .values
            .iter()
            .zip(&learned.deviations)
            .map(|(value, deviation)| {
                let reach = TO_95_PERCENT * deviation;
                [value - reach, value + reach]
            })
            .collect(),
        range: learned.range,
        gain: learned.gain,
    });
    Ok(())
}
