//! The central directory of a zip archive as it is written, before any reader has tidied it up.

/// What the central directory says of one entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct DirectoryEntry {
    pub(super) name: String,
    pub(super) system: u8,
    pub(super) version_needed: u16,
    pub(super) flags: u16,
    pub(super) method: u16,
    pub(super) compressed_size: u64,
    pub(super) size: u64,
    pub(super) external_attributes: u32,
}

const END_SIGNATURE: [u8; 4] = *b"PK\x05\x06";
const ENTRY_SIGNATURE: [u8; 4] = *b"PK\x01\x02";
const END_LENGTH: usize = 22;
const ENTRY_LENGTH: usize = 46;

/// All entries; `None` if there is no complete central directory (zip64 counts as none: no FMU needs it).
pub(super) fn read(bytes: &[u8]) -> Option<Vec<DirectoryEntry>> {
    let last = bytes.len().checked_sub(END_LENGTH)?;
    let first = last.saturating_sub(usize::from(u16::MAX));
    let end = (first..=last)
        .rev()
        .find(|at| bytes[*at..].starts_with(&END_SIGNATURE))?;
    let count = word(bytes, end + 10)?;
    let mut at = usize::try_from(long(bytes, end + 16)?).ok()?;
    let mut entries = Vec::with_capacity(usize::from(count));
    for _ in 0..count {
        if !bytes.get(at..)?.starts_with(&ENTRY_SIGNATURE) {
            return None;
        }
        let lengths = [
            word(bytes, at + 28)?,
            word(bytes, at + 30)?,
            word(bytes, at + 32)?,
        ];
        let name_end = at + ENTRY_LENGTH + usize::from(lengths[0]);
        let name = bytes.get(at + ENTRY_LENGTH..name_end)?;
        entries.push(DirectoryEntry {
            name: String::from_utf8_lossy(name).into_owned(),
            system: *bytes.get(at + 5)?,
            version_needed: word(bytes, at + 6)?,
            flags: word(bytes, at + 8)?,
            method: word(bytes, at + 10)?,
            compressed_size: u64::from(long(bytes, at + 20)?),
            size: u64::from(long(bytes, at + 24)?),
            external_attributes: long(bytes, at + 38)?,
        });
        at = name_end + usize::from(lengths[1]) + usize::from(lengths[2]);
    }
    Some(entries)
}

fn word(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn long(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}
