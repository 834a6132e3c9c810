//! Files that other files name: source lists, the icon, the variables of terminals.

use quick_xml::Reader;
use quick_xml::events::Event;

use super::description::Description;
use super::finding::{Finding, Rule};
use super::package::Package;
use super::xml;
use crate::platform::FmiVersion;

const BUILD_DESCRIPTION: &str = "sources/buildDescription.xml";
const TERMINALS: &str = "terminalsAndIcons/terminalsAndIcons.xml";

pub(super) fn check(package: &Package, description: &Description) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut need = |file: String, by: &str| {
        if !package.has(&file) {
            findings.push(Finding::new(
                Rule::ListedFile,
                format!("{by} names {file}, which is not there"),
            ));
        }
    };
    for file in &description.source_files {
        need(format!("sources/{file}"), "modelDescription.xml");
    }
    if description.version == FmiVersion::Fmi2 {
        return findings;
    }
    match attributes(package, BUILD_DESCRIPTION, "SourceFile", "name") {
        Ok(files) => files
            .into_iter()
            .for_each(|file| need(format!("sources/{file}"), BUILD_DESCRIPTION)),
        Err(finding) => return vec![finding],
    }
    match attributes(package, TERMINALS, "Icon", "x1") {
        Ok(icons) if !icons.is_empty() => need("terminalsAndIcons/icon.png".to_owned(), TERMINALS),
        Ok(_) => {}
        Err(finding) => return vec![finding],
    }
    match attributes(package, TERMINALS, "TerminalMemberVariable", "variableName") {
        Ok(names) => {
            let unknown = names
                .into_iter()
                .filter(|name| !description.has_variable(name));
            findings.extend(unknown.map(|name| {
                Finding::new(
                    Rule::ListedFile,
                    format!("{TERMINALS} names {name}, which is no variable"),
                )
            }));
        }
        Err(finding) => findings.push(finding),
    }
    findings
}

/// Values of one attribute of all elements of one name; none if the file is not there.
fn attributes(
    package: &Package,
    file: &str,
    element: &str,
    attribute: &str,
) -> Result<Vec<String>, Finding> {
    if !package.has(file) {
        return Ok(Vec::new());
    }
    let broken = |reason: String| Finding::new(Rule::ListedFile, format!("{file}: {reason}"));
    let text = xml::text(package, file).map_err(broken)?;
    let mut reader = Reader::from_str(&text);
    let mut values = Vec::new();
    loop {
        match reader.read_event() {
            Ok(Event::Start(start) | Event::Empty(start)) if start.name().as_ref() == element => {
                values.extend(xml::attributes(&start).map_err(broken)?.remove(attribute));
            }
            Ok(Event::DocType(_)) => {
                return Err(broken(
                    "declares a document type; entities are refused".to_owned(),
                ));
            }
            Ok(Event::Eof) => return Ok(values),
            Ok(_) => {}
            Err(error) => return Err(broken(format!("is not well-formed: {error}"))),
        }
    }
}
