//! Saved states as bytes: a reader and a writer that a model fills, and the envelope that protects
//! what leaves the process.
//!
//! Envelope, little-endian: magic `STKSLIP\0` (8), format version (4), token (16), length of the
//! content (8), content, FNV-1a-64 checksum of all before it (8).

use super::token::Token;
use thiserror::Error;

const MAGIC: [u8; 8] = *b"STKSLIP\0";
const VERSION: u32 = 3;
const HEADER: usize = 8 + 4 + 16 + 8;
const CHECKSUM: usize = 8;

/// Appends values to a state.
#[derive(Debug, Default)]
pub struct StateWriter {
    bytes: Vec<u8>,
}

impl StateWriter {
    /// Appends a real, bit for bit.
    pub fn real(&mut self, value: f64) {
        self.bytes.extend_from_slice(&value.to_bits().to_le_bytes());
    }

    /// Appends an integer.
    pub fn integer(&mut self, value: u64) {
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    /// Appends a flag.
    pub fn flag(&mut self, value: bool) {
        self.bytes.push(value.into());
    }

    /// Appends bytes of any meaning, with their number.
    pub fn block(&mut self, bytes: &[u8]) {
        self.integer(bytes.len() as u64);
        self.bytes.extend_from_slice(bytes);
    }

    /// The content so far.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// Reads values in the order in which they were written.
#[derive(Debug)]
pub struct StateReader<'a> {
    bytes: &'a [u8],
}

impl<'a> StateReader<'a> {
    /// Reads from the content of a [`StateWriter`].
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], StateError> {
        let (value, rest) = self
            .bytes
            .split_first_chunk::<N>()
            .ok_or(StateError::TooShort)?;
        self.bytes = rest;
        Ok(*value)
    }

    /// The next real.
    ///
    /// # Errors
    /// The content ends.
    pub fn real(&mut self) -> Result<f64, StateError> {
        Ok(f64::from_bits(u64::from_le_bytes(self.take()?)))
    }

    /// The next integer.
    ///
    /// # Errors
    /// The content ends.
    pub fn integer(&mut self) -> Result<u64, StateError> {
        Ok(u64::from_le_bytes(self.take()?))
    }

    /// The next flag.
    ///
    /// # Errors
    /// The content ends, or the byte is neither 0 nor 1.
    pub fn flag(&mut self) -> Result<bool, StateError> {
        match self.take::<1>()? {
            [0] => Ok(false),
            [1] => Ok(true),
            [other] => Err(StateError::Content(format!(
                "{other} is not a flag (0 or 1)"
            ))),
        }
    }

    /// The next block of bytes.
    ///
    /// # Errors
    /// The content ends.
    pub fn block(&mut self) -> Result<&'a [u8], StateError> {
        let length = usize::try_from(self.integer()?).map_err(|_| StateError::TooShort)?;
        let (block, rest) = self
            .bytes
            .split_at_checked(length)
            .ok_or(StateError::TooShort)?;
        self.bytes = rest;
        Ok(block)
    }

    /// Confirms that everything was read.
    ///
    /// # Errors
    /// Bytes are left over.
    pub fn finish(self) -> Result<(), StateError> {
        match self.bytes.len() {
            0 => Ok(()),
            left => Err(StateError::Content(format!(
                "{left} bytes are left over at the end"
            ))),
        }
    }
}

/// Number of bytes that [`seal`] makes of `content` bytes.
pub fn sealed_size(content: usize) -> usize {
    HEADER + content + CHECKSUM
}

/// Puts content into the envelope.
pub fn seal(token: Token, content: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(sealed_size(content.len()));
    bytes.extend_from_slice(&MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(&token.0.to_le_bytes());
    bytes.extend_from_slice(&(content.len() as u64).to_le_bytes());
    bytes.extend_from_slice(content);
    bytes.extend_from_slice(&checksum(&bytes).to_le_bytes());
    bytes
}

/// Takes content out of the envelope.
///
/// # Errors
/// The bytes are not a state, are of another version or component, or were changed on the way.
pub fn unseal(token: Token, bytes: &[u8]) -> Result<&[u8], StateError> {
    let mut reader = StateReader::new(bytes);
    if reader.take::<8>()? != MAGIC {
        return Err(StateError::NotAState);
    }
    let version = u32::from_le_bytes(reader.take()?);
    if version != VERSION {
        return Err(StateError::Version { found: version });
    }
    let found = Token(u128::from_le_bytes(reader.take()?));
    if found != token {
        return Err(StateError::Foreign {
            found: found.to_string(),
            expected: token.to_string(),
        });
    }
    let content = reader.block()?;
    let stored = reader.integer()?;
    reader.finish()?;
    if stored != checksum(&bytes[..bytes.len() - CHECKSUM]) {
        return Err(StateError::Checksum);
    }
    Ok(content)
}

fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// Bytes that are not a state of this component.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum StateError {
    /// The bytes end too early.
    #[error("the state is truncated: it ends before its last value")]
    TooShort,
    /// The bytes do not begin as a state does.
    #[error("the bytes are not a state written by this library: the first 8 must be STKSLIP and 0")]
    NotAState,
    /// Written by another version of the library.
    #[error("the state has format version {found}; this library reads version {VERSION}")]
    Version {
        /// Version in the bytes.
        found: u32,
    },
    /// Written by another component.
    #[error("the state belongs to the component {found}; this one is {expected}")]
    Foreign {
        /// Token in the bytes.
        found: String,
        /// Token of this component.
        expected: String,
    },
    /// Changed on the way.
    #[error("the state is corrupted: its checksum does not agree with its content")]
    Checksum,
    /// The content makes no sense to the model.
    #[error("the state's content is invalid: {0}")]
    Content(String),
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOKEN: Token = Token(42);

    #[test]
    fn what_is_sealed_comes_out_again() {
        let mut writer = StateWriter::default();
        writer.real(-0.0);
        writer.integer(7);
        writer.flag(true);
        writer.block(b"abc");
        let content = writer.into_bytes();
        let sealed = seal(TOKEN, &content);
        assert_eq!(sealed.len(), sealed_size(content.len()));
        let mut reader = StateReader::new(unseal(TOKEN, &sealed).unwrap());
        assert_eq!(reader.real().unwrap().to_bits(), (-0.0_f64).to_bits());
        assert_eq!(reader.integer(), Ok(7));
        assert_eq!(reader.flag(), Ok(true));
        assert_eq!(reader.block(), Ok(&b"abc"[..]));
        assert_eq!(reader.finish(), Ok(()));
    }

    #[test]
    fn every_flipped_bit_and_every_truncation_is_noticed() {
        let sealed = seal(TOKEN, b"some content");
        for place in 0..sealed.len() {
            for bit in 0..8 {
                let mut changed = sealed.clone();
                changed[place] ^= 1 << bit;
                assert!(unseal(TOKEN, &changed).is_err(), "byte {place}, bit {bit}");
            }
            assert!(unseal(TOKEN, &sealed[..place]).is_err(), "{place} bytes");
        }
        let mut longer = sealed;
        longer.push(0);
        assert!(unseal(TOKEN, &longer).is_err());
    }

    #[test]
    fn a_state_of_another_component_is_named() {
        let error = unseal(Token(1), &seal(TOKEN, b"")).unwrap_err();
        assert!(matches!(error, StateError::Foreign { .. }));
    }
}
