//! Defects of the files of layered standards, for [`mutations`](crate::mutations).

use build_fmu::lint::Rule;

use crate::spoiled::Defect::{self, ReplaceIn};
use crate::spoiled::Files;

const MANIFEST: &str = "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml";
const EXPERIMENT: &str = "extra/org.fmi-standard.fmi-ls-ref/ReducedRig.exp";
const STIMULI: &str = "extra/org.fmi-standard.fmi-ls-ref/ReducedRig_in.csv";
const RESULTS: &str = "extra/org.fmi-standard.fmi-ls-ref/ReducedRig_ref.csv";

/// Changes one value of the results by so much of it: of the variable in the column, at the row.
fn change(files: &mut Files, column: usize, row: usize, change: fn(f64) -> f64) {
    let text = String::from_utf8(files[RESULTS].clone()).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut words: Vec<String> = lines[row].split(',').map(str::to_owned).collect();
    let old: f64 = words[column].parse().unwrap();
    let new = change(old);
    assert_ne!(new, old);
    words[column] = format!("{new:?}");
    lines[row] = words.join(",");
    files.insert(RESULTS.to_owned(), (lines.join("\n") + "\n").into_bytes());
}

/// In an FMU of the reduced rig, of either version.
pub const REFERENCES: &[(&str, Rule, Defect)] = &[
    (
        "standard without version",
        Rule::LayeredStandard,
        ReplaceIn(MANIFEST, "fmi-ls:fmi-ls-version", "fmi-ls:version"),
    ),
    (
        "version in words",
        Rule::LayeredStandard,
        ReplaceIn(MANIFEST, "=\"1.0.0-beta.1\"", "=\"newest\""),
    ),
    (
        "attributes of another namespace",
        Rule::LayeredStandard,
        ReplaceIn(
            MANIFEST,
            "fmi-standard.org/fmi-ls-manifest",
            "fmi-standard.org/manifest",
        ),
    ),
    (
        "standard in a foreign folder",
        Rule::LayeredStandard,
        ReplaceIn(
            MANIFEST,
            "=\"org.fmi-standard.fmi-ls-ref\"",
            "=\"org.fmi-standard.fmi-ls-bus\"",
        ),
    ),
    (
        "manifest cut off",
        Rule::LayeredStandard,
        ReplaceIn(MANIFEST, "</fmiReferences>", ""),
    ),
    (
        "unknown role",
        Rule::LayeredStandard,
        ReplaceIn(MANIFEST, "role=\"result\"", "role=\"results\""),
    ),
    (
        "experiments of another root",
        Rule::LayeredStandard,
        ReplaceIn(EXPERIMENT, "<Experiments ", "<Trials><Experiments "),
    ),
    (
        "two experiments of a name",
        Rule::LayeredStandard,
        ReplaceIn(
            EXPERIMENT,
            "</Experiments>",
            "<Experiment name=\"held-inputs\"/></Experiments>",
        ),
    ),
    (
        "experiment that ends before its start",
        Rule::LayeredStandard,
        ReplaceIn(EXPERIMENT, "stopTime=\"4\"", "stopTime=\"-4\""),
    ),
    (
        "experiment without step",
        Rule::LayeredStandard,
        ReplaceIn(EXPERIMENT, "stepSize=\"0.01\"", "stepSize=\"0\""),
    ),
    (
        "results that are not there",
        Rule::ListedFile,
        ReplaceIn(EXPERIMENT, "ReducedRig_ref.csv", "ReducedRig_out.csv"),
    ),
    (
        "related file that is not there",
        Rule::ListedFile,
        ReplaceIn(
            MANIFEST,
            "../../resources/model.toml",
            "../resources/model.toml",
        ),
    ),
    (
        "results of an unknown variable",
        Rule::ReferenceResults,
        ReplaceIn(RESULTS, "theta3_dot", "theta4_dot"),
    ),
    (
        "stimulus of an output",
        Rule::ReferenceResults,
        ReplaceIn(STIMULI, "time,u,N2", "time,theta,N2"),
    ),
    (
        "text among results",
        Rule::ReferenceResults,
        ReplaceIn(RESULTS, "\n0.01,", "\n0.01s,"),
    ),
    (
        "another stimulus",
        Rule::ReferenceResults,
        ReplaceIn(STIMULI, "\n0,2.5,", "\n0,2.50001,"),
    ),
    (
        "swapped stimuli",
        Rule::ReferenceResults,
        ReplaceIn(STIMULI, "time,u,N2", "time,N2,u"),
    ),
    (
        "one value of the last row",
        Rule::ReferenceResults,
        Defect::Files(|files, _| change(files, 1, 401, |theta| theta * (1.0 + 1e-7))),
    ),
    (
        "one mode",
        Rule::ReferenceResults,
        Defect::Files(|files, _| {
            let text = String::from_utf8(files[RESULTS].clone()).unwrap();
            let header = text.lines().next().unwrap();
            let column = header.split(',').position(|name| name == "stuck").unwrap();
            change(files, column, 1, |stuck| 1.0 - stuck);
        }),
    ),
];
