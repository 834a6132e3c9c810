//! The reference run of a model: native, so that it does not come from what is to be checked with it.

use stickslip::cosim::{Causality, MODEL_FILE, VariableType};
use thiserror::Error;

use super::repeat::{self, Experiment, RepeatError};
use super::table::{Column, Table};
use super::{CSV, DESCRIPTION, EXPERIMENTS, FOLDER, NAME, NAMESPACE, VERSION, manifest_file};
use crate::component::{ComponentError, Native};
use crate::model_description::{Attributes, Document, Facts, XmlError, number};

/// Rows of the results: enough for some cycles of stick-slip, few enough for a few tens of KiB.
const ROWS: u32 = 401;
/// The page on the experiment; the standard recommends its name.
pub const PAGE: &str = "documentation/fmi-ls-ref.txt";

/// Texts by their names inside the FMU.
pub type Files = Vec<(String, String)>;

/// Why there is no reference run.
#[derive(Debug, Error)]
pub enum WriteError {
    /// A value is for what is no input.
    #[error("{name} is no input of {model}; its inputs are {known}")]
    NoInput {
        /// The name.
        name: String,
        /// Model identifier.
        model: &'static str,
        /// All inputs.
        known: String,
    },
    /// The model cannot be opened.
    #[error(transparent)]
    Model(#[from] ComponentError),
    /// The model cannot be run.
    #[error("the reference run: {0}")]
    Run(#[from] RepeatError),
    /// The XML could not be written.
    #[error(transparent)]
    Xml(#[from] XmlError),
}

/// Files of the reference run of the model `model_toml` by their names inside the FMU. Each input holds a constant value, since
/// importers differ in what is between the rows of stimuli: that of `held` for its name, or else its share of its nominal value.
/// The shares of n inputs are 1/n, 2/n … 1, so that inputs that are taken for one another are noticed.
///
/// # Errors
/// [`WriteError`].
pub fn files(
    facts: &Facts<'_>,
    model_toml: &str,
    held: &[(String, f64)],
) -> Result<Files, WriteError> {
    let model = facts.identity.model_identifier;
    let names = |causality, kinds: &[VariableType]| -> Vec<(&str, f64)> {
        let variables = facts.table.variables().iter();
        variables
            .filter(|row| row.causality == causality && kinds.contains(&row.variable_type))
            .map(|row| (row.name.as_str(), row.nominal.unwrap_or(1.0)))
            .collect()
    };
    let inputs = names(Causality::Input, &[VariableType::Real]);
    if let Some((name, _)) = held
        .iter()
        .find(|(name, _)| !inputs.iter().any(|(known, _)| known == name))
    {
        let known: Vec<&str> = inputs.iter().map(|(name, _)| *name).collect();
        return Err(WriteError::NoInput {
            name: name.clone(),
            model,
            known: known.join(", "),
        });
    }
    let values: Vec<(&str, f64)> = inputs
        .iter()
        .enumerate()
        .map(|(at, (name, nominal))| {
            let share = (at + 1) as f64 / inputs.len() as f64;
            let given = held.iter().rev().find(|(known, _)| known == name);
            (*name, given.map_or(share * nominal, |(_, value)| *value))
        })
        .collect();
    let default = facts.identity.default_experiment;
    let (start, step) = (default.start_time, default.step_size);
    let rows: Vec<f64> = (0..ROWS).map(|row| start + f64::from(row) * step).collect();
    let stop = start + f64::from(ROWS - 1) * step;
    let experiment = Experiment {
        name: "held-inputs".to_owned(),
        start,
        stop,
        step,
        tolerance: Some(default.tolerance),
        parameters: Vec::new(),
        stimuli: Table {
            time: vec![start, stop],
            columns: values
                .iter()
                .map(|(name, value)| Column {
                    name: (*name).to_owned(),
                    values: vec![*value; 2],
                })
                .collect(),
        },
    };
    let outputs = names(
        Causality::Output,
        &[VariableType::Real, VariableType::Boolean],
    );
    let outputs: Vec<&str> = outputs.into_iter().map(|(name, _)| name).collect();
    let mut native = Native::from_text(model_toml, MODEL_FILE)?;
    let results = repeat::run(&mut native, &experiment, &outputs, &rows, false)?;
    let said = values
        .iter()
        .map(|(name, value)| format!("{name} = {}", number(*value)))
        .collect::<Vec<_>>()
        .join(", ");
    let place = |name: String| format!("{FOLDER}/{name}");
    Ok(vec![
        (manifest_file(), manifest(model)?),
        (
            place(format!("{model}.exp")),
            experiments(model, &experiment, &said)?,
        ),
        (
            place(format!("{model}_in.csv")),
            experiment.stimuli.to_csv(),
        ),
        (place(format!("{model}_ref.csv")), results.to_csv()),
        (PAGE.to_owned(), page(model, &experiment, &said)),
    ])
}

fn manifest(model: &str) -> Result<String, XmlError> {
    let attributes = Attributes::new()
        .text("xmlns:fmi-ls", NAMESPACE)
        .text("fmi-ls:fmi-ls-name", NAME)
        .text("fmi-ls:fmi-ls-version", VERSION)
        .text("fmi-ls:fmi-ls-description", DESCRIPTION);
    let mut xml = Document::new()?;
    xml.element("fmiReferences", attributes, |xml| {
        let related = |source: &str, kind: &str, role: &str, description: &str| {
            Attributes::new()
                .text("type", kind)
                .text("source", source)
                .text("role", role)
                .text("description", description)
        };
        for attributes in [
            related(
                &format!("{model}.exp"),
                EXPERIMENTS,
                "experiment/smoke-test",
                "A run with held inputs, by which an import can be checked",
            ),
            related(
                &format!("{model}_in.csv"),
                CSV,
                "other",
                "Inputs of that run",
            ),
            related(
                &format!("{model}_ref.csv"),
                CSV,
                "result",
                "Outputs of that run, from the native model",
            ),
            related(
                &format!("../../resources/{MODEL_FILE}"),
                "application/toml",
                "model",
                "The model from which the FMU was made",
            ),
        ] {
            xml.leaf("Related", attributes)?;
        }
        Ok(())
    })?;
    xml.finish()
}

fn experiments(model: &str, experiment: &Experiment, said: &str) -> Result<String, XmlError> {
    let mut xml = Document::new()?;
    let set = Attributes::new()
        .text("name", model)
        .text("description", "Runs by which an import can be checked");
    let one = Attributes::new()
        .text("name", experiment.name.as_str())
        .text("description", format!("The inputs hold {said}"))
        .optional_number("tolerance", experiment.tolerance);
    xml.element("Experiments", set, |xml| {
        xml.element("Experiment", one, |xml| {
            xml.leaf(
                "TransientSimulation",
                Attributes::new()
                    .number("startTime", experiment.start)
                    .number("stopTime", experiment.stop)
                    .number("stepSize", experiment.step),
            )?;
            let source = |name| Attributes::new().text("source", name);
            xml.leaf("Stimuli", source(format!("{model}_in.csv")))?;
            xml.leaf("References", source(format!("{model}_ref.csv")))
        })
    })?;
    xml.finish()
}

fn page(model: &str, experiment: &Experiment, said: &str) -> String {
    let Experiment {
        start, stop, step, ..
    } = experiment;
    format!(
        "Reference results of {model} (FMI-LS-REF {VERSION})\n\n\
         {FOLDER}/ holds one run by which an import can be checked.\n\
         From {start} s to {stop} s in communication steps of {step} s, parameters at their start values,\n\
         inputs held from before initialisation on: {said}.\n\n\
         {model}.exp      the experiment (Experiments Format of the Modelica Association, draft)\n\
         {model}_in.csv   the inputs\n\
         {model}_ref.csv  the outputs, Booleans as 0 and 1\n\n\
         The results are those of the native model, not of the library in this FMU. In co-simulation an importer\n\
         should find the same numbers to the last bits, whatever its communication step. In model exchange it\n\
         should find them within the tolerance of its solver; rows next to a switch may then differ more.\n\n\
         build-fmu check repeats the run.\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::Source;

    const RIG: &str = include_str!("../../../modelDescription/reduced-rig.toml");

    fn written(held: &[(String, f64)]) -> Result<Files, WriteError> {
        let source = Source::from_text(RIG.to_owned(), "rig.toml").unwrap();
        files(&source.facts(), RIG, held)
    }

    fn table(files: &[(String, String)], end: &str) -> Table {
        let (_, text) = files.iter().find(|(name, _)| name.ends_with(end)).unwrap();
        Table::parse(text).unwrap()
    }

    #[test]
    fn the_reduced_rig_sticks_breaks_away_and_sticks_again() {
        let files = written(&[]).unwrap();
        let results = table(&files, "_ref.csv");
        assert_eq!(results.time.len(), ROWS as usize);
        let stuck = results.columns.iter().find(|column| column.name == "stuck");
        let stuck = &stuck.unwrap().values;
        let changes = stuck.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!(changes >= 4, "{changes} changes of the mode");
    }

    #[test]
    fn no_two_inputs_hold_the_same_share() {
        let inputs = table(&written(&[]).unwrap(), "_in.csv");
        let values: Vec<(&str, f64)> = inputs
            .columns
            .iter()
            .map(|column| (column.name.as_str(), column.values[0]))
            .collect();
        assert_eq!(values, [("u", 2.5), ("N2", 50.0)]);
    }

    #[test]
    fn inputs_hold_what_is_asked_for_and_others_are_named() {
        let files = written(&[("u".to_owned(), 3.0)]).unwrap();
        assert_eq!(table(&files, "_in.csv").columns[0].values, [3.0, 3.0]);
        let error = written(&[("voltage".to_owned(), 3.0)]).unwrap_err();
        assert!(error.to_string().contains("u, N2"), "{error}");
    }
}
