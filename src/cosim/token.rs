//! The instantiation token (FMI 3) or GUID (FMI 2): a hash that ties XML, binary and resource together.
//!
//! The binary computes it from the variable table that it builds and from the text of `model.toml`
//! that it finds, `build-fmu` writes it into the XML, and instantiation compares the two. The hash
//! guards against drift, not against an attacker.

use super::variables::VariableTable;
use std::fmt;

/// A 128-bit FNV-1a hash; the same on every platform and in every version of the compiler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token(pub u128);

impl Token {
    /// The token of a component with this variable table and this `model.toml`.
    pub fn new(table: &VariableTable, model_toml: &str) -> Self {
        let mut hash = Fnv128::new();
        for variable in table.variables() {
            hash.number(u64::from(variable.value_reference));
            hash.text(&variable.name);
            hash.text(match variable.variable_type {
                super::VariableType::Real => "real",
                super::VariableType::Boolean => "boolean",
            });
            hash.text(variable.causality.xml());
            hash.text(variable.variability.xml());
            hash.text(variable.initial.map_or("", super::Initial::xml));
            hash.text(variable.unit.as_deref().unwrap_or(""));
            hash.text(variable.display_unit.unwrap_or(""));
            for value in [
                variable.start,
                variable.minimum,
                variable.maximum,
                variable.nominal,
            ] {
                hash.number(value.is_some().into());
                hash.number(value.unwrap_or(0.0).to_bits());
            }
            hash.number(variable.above_minimum.into());
            hash.text(&variable.description);
            for reference in [variable.alias_of, variable.derivative_of] {
                hash.number(reference.map_or(u64::MAX, u64::from));
            }
            hash.number(variable.reinit.into());
            hash.number(variable.event_indicator.into());
            for list in [&variable.dependencies, &variable.initial_dependencies] {
                hash.number(list.len() as u64);
                list.iter()
                    .for_each(|reference| hash.number(u64::from(*reference)));
            }
        }
        hash.text(model_toml);
        Self(hash.0)
    }

    /// The token of what this text says in full.
    #[must_use]
    pub fn of_text(text: &str) -> Self {
        let mut hash = Fnv128::new();
        hash.text(text);
        Self(hash.0)
    }
}

impl fmt::Display for Token {
    /// As a GUID in braces, the form that FMI 2 importers know.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = format!("{:032x}", self.0);
        write!(
            f,
            "{{{}-{}-{}-{}-{}}}",
            &digits[..8],
            &digits[8..12],
            &digits[12..16],
            &digits[16..20],
            &digits[20..]
        )
    }
}

struct Fnv128(u128);

impl Fnv128 {
    fn new() -> Self {
        Self(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 ^= u128::from(*byte);
            self.0 = self
                .0
                .wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    }

    fn number(&mut self, number: u64) {
        self.bytes(&number.to_le_bytes());
    }

    /// Length first, so that neighbouring texts cannot trade letters.
    fn text(&mut self, text: &str) {
        self.number(text.len() as u64);
        self.bytes(text.as_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cosim::test_model;

    #[test]
    fn hash_agrees_with_the_published_test_vector() {
        let mut hash = Fnv128::new();
        hash.bytes(b"foobar");
        assert_eq!(hash.0, 0x343e_1662_793c_64bf_6f0d_3597_ba44_6f18);
    }

    #[test]
    fn every_letter_of_the_resource_and_every_field_of_the_table_counts() {
        let table = test_model::table();
        let token = Token::new(&table, "a = 1");
        assert_eq!(token, Token::new(&test_model::table(), "a = 1"));
        assert_ne!(token, Token::new(&table, "a = 1 "));
        let mut rows = table.variables().to_vec();
        rows[1].minimum = Some(-1.0);
        assert_ne!(
            token,
            Token::new(&VariableTable::new(rows).unwrap(), "a = 1")
        );
    }

    #[test]
    fn shown_as_a_guid() {
        let shown = Token(0x0123_4567_89ab_cdef_0123_4567_89ab_cdef).to_string();
        assert_eq!(shown, "{01234567-89ab-cdef-0123-456789abcdef}");
    }
}
