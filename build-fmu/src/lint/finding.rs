//! What the check says.

use std::fmt;

/// A rule that an FMU can break; the order is that of the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Rule {
    /// An entry's name is not portable or leaves the archive.
    EntryName,
    /// Two entries have names that are equal on some system.
    DuplicateEntry,
    /// An entry is neither stored nor deflated.
    Compression,
    /// An entry needs a newer zip than version 2.0.
    ZipVersion,
    /// An entry is encrypted.
    Encrypted,
    /// An entry is a link or a device.
    NotAFile,
    /// An entry's bytes cannot be read or fail their checksum.
    Damaged,
    /// `modelDescription.xml` is missing, not XML, or declares entities.
    Description,
    /// A version of the standard that this check does not know.
    FmiVersion,
    /// A name, value reference or token that must be there is missing or empty.
    Missing,
    /// Two variables share a name, or two FMI 3 variables a value reference.
    DuplicateVariable,
    /// A combination of causality, variability, initial and start that the standard forbids.
    Role,
    /// A start value, minimum, maximum or nominal that contradicts the others or is no number.
    Limits,
    /// A unit is defined twice, not at all, or with a factor of zero.
    Unit,
    /// A declared type is not defined or of another kind.
    Type,
    /// The model structure does not list the outputs once each, or refers to nothing.
    Structure,
    /// States, derivatives, event indicators or unknowns of the initialisation do not fit together.
    ModelExchange,
    /// The date is no date or lies in the future.
    Date,
    /// The default experiment ends before it starts or has a step that is not above zero.
    Experiment,
    /// A file that is referred to is not in the archive.
    ListedFile,
    /// No library, or one in an unknown folder.
    Binary,
    /// A library's file name differs from the model identifier.
    BinaryName,
    /// A library is for another system or processor than its folder says.
    BinaryPlatform,
    /// A library lacks functions of the standard.
    Symbols,
    /// The library does not instantiate with the token of the model description.
    Instantiation,
    /// A manifest of a layered standard, or an experiment that it names, does not keep to its format.
    LayeredStandard,
    /// The FMU does not give the reference results that it holds.
    ReferenceResults,
}

impl Rule {
    /// The rule's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Rule::EntryName => "entry-name",
            Rule::DuplicateEntry => "duplicate-entry",
            Rule::Compression => "compression",
            Rule::ZipVersion => "zip-version",
            Rule::Encrypted => "encrypted",
            Rule::NotAFile => "not-a-file",
            Rule::Damaged => "damaged",
            Rule::Description => "description",
            Rule::FmiVersion => "fmi-version",
            Rule::Missing => "missing",
            Rule::DuplicateVariable => "duplicate-variable",
            Rule::Role => "role",
            Rule::Limits => "limits",
            Rule::Unit => "unit",
            Rule::Type => "type",
            Rule::Structure => "structure",
            Rule::ModelExchange => "model-exchange",
            Rule::Date => "date",
            Rule::Experiment => "experiment",
            Rule::ListedFile => "listed-file",
            Rule::Binary => "binary",
            Rule::BinaryName => "binary-name",
            Rule::BinaryPlatform => "binary-platform",
            Rule::Symbols => "symbols",
            Rule::Instantiation => "instantiation",
            Rule::LayeredStandard => "layered-standard",
            Rule::ReferenceResults => "reference-results",
        }
    }
}

/// One thing that is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// The broken rule.
    pub rule: Rule,
    /// Which thing, what it is and what would be right.
    pub message: String,
}

impl Finding {
    pub(super) fn new(rule: Rule, message: impl Into<String>) -> Self {
        Self {
            rule,
            message: message.into(),
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.rule.name(), self.message)
    }
}
