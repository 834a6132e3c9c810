//! A small layer over quick-xml: elements with attributes, two spaces of indentation, numbers that read back exactly.

use std::io;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};
use thiserror::Error;

/// The XML could not be written.
#[derive(Debug, Error)]
pub enum XmlError {
    /// The writer failed.
    #[error("the XML could not be written: {0}")]
    Write(#[from] io::Error),
    /// What was written is not UTF-8.
    #[error("the XML is not UTF-8: {0}")]
    Encoding(#[from] std::string::FromUtf8Error),
}

/// Attributes of one element, in the order in which they are added.
#[derive(Debug, Default)]
pub(crate) struct Attributes(Vec<(&'static str, String)>);

impl Attributes {
    pub(crate) fn new() -> Self {
        Self::default()
    }

    pub(crate) fn text(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.0.push((name, value.into()));
        self
    }

    pub(crate) fn flag(self, name: &'static str, value: bool) -> Self {
        self.text(name, value.to_string())
    }

    pub(crate) fn number(self, name: &'static str, value: f64) -> Self {
        self.text(name, number(value))
    }

    /// Adds the attribute only if there is a value.
    pub(crate) fn optional_text(self, name: &'static str, value: Option<&str>) -> Self {
        match value {
            Some(value) => self.text(name, value),
            None => self,
        }
    }

    /// Adds the attribute only if there is a value.
    pub(crate) fn optional_number(self, name: &'static str, value: Option<f64>) -> Self {
        match value {
            Some(value) => self.number(name, value),
            None => self,
        }
    }

    /// Adds a list of references with blanks between them, empty if there are none.
    pub(crate) fn list(self, name: &'static str, values: impl IntoIterator<Item = u32>) -> Self {
        let words: Vec<String> = values.into_iter().map(|value| value.to_string()).collect();
        self.text(name, words.join(" "))
    }
}

/// Shortest decimal text that reads back as the same number.
pub(crate) fn number(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-4..1e7).contains(&magnitude) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

/// A document under construction.
pub(crate) struct Document(Writer<Vec<u8>>);

impl Document {
    pub(crate) fn new() -> Result<Self, XmlError> {
        let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
        writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        Ok(Self(writer))
    }

    /// An element without content.
    pub(crate) fn leaf(&mut self, name: &str, attributes: Attributes) -> Result<(), XmlError> {
        self.0.write_event(Event::Empty(start(name, &attributes)))?;
        Ok(())
    }

    /// An element whose content is written by `content`.
    pub(crate) fn element(
        &mut self,
        name: &str,
        attributes: Attributes,
        content: impl FnOnce(&mut Self) -> Result<(), XmlError>,
    ) -> Result<(), XmlError> {
        self.0.write_event(Event::Start(start(name, &attributes)))?;
        content(self)?;
        self.0.write_event(Event::End(BytesEnd::new(name)))?;
        Ok(())
    }

    pub(crate) fn finish(self) -> Result<String, XmlError> {
        let mut text = String::from_utf8(self.0.into_inner())?;
        text.push('\n');
        Ok(text)
    }
}

fn start<'a>(name: &'a str, attributes: &'a Attributes) -> BytesStart<'a> {
    let mut element = BytesStart::new(name);
    for (attribute, value) in &attributes.0 {
        element.push_attribute((*attribute, value.as_str()));
    }
    element
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_exactly() {
        for value in [
            0.0,
            -0.5,
            5.18e-5,
            0.000_843_7,
            1e-12,
            3.0e8,
            180.0 / std::f64::consts::PI,
        ] {
            assert_eq!(
                number(value).parse::<f64>().unwrap().to_bits(),
                value.to_bits()
            );
        }
        assert_eq!(number(5.18e-5), "5.18e-5");
        assert_eq!(number(50.0), "50");
    }

    #[test]
    fn attributes_are_escaped() {
        let mut document = Document::new().unwrap();
        document
            .leaf("A", Attributes::new().text("b", "x < \"y\" & z"))
            .unwrap();
        let text = document.finish().unwrap();
        assert!(
            text.contains("b=\"x &lt; &quot;y&quot; &amp; z\""),
            "{text}"
        );
    }
}
