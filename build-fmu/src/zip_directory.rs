//! The central directory of a zip archive as it is written, before any reader has tidied it up, and whether the archive can
//! be unpacked without harm.
//!
//! It is strict where readers differ: the directory ends where the end record begins, there is one disk, no zip64. A reader
//! that accepts the archive then sees these entries and no others, and never more of them than are allowed here.

use std::io::{self, Read, Seek, SeekFrom};

use thiserror::Error;

/// What the central directory says of one entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DirectoryEntry {
    /// Name, with what is not UTF-8 replaced.
    pub name: String,
    /// System whose file attributes it has.
    pub system: u8,
    /// Version of the zip format that an unpacker needs, ten times.
    pub version_needed: u16,
    /// General purpose flags.
    pub flags: u16,
    /// Method of compression.
    pub method: u16,
    /// Packed size [bytes].
    pub compressed_size: u64,
    /// Unpacked size [bytes].
    pub size: u64,
    /// File attributes.
    pub external_attributes: u32,
}

/// Why there is no directory to go by.
#[derive(Debug, Error)]
pub enum DirectoryError {
    /// The archive cannot be read.
    #[error("{0}")]
    Read(#[from] io::Error),
    /// No zip archive, one that is cut off, or one of several disks or of zip64: no FMU needs these.
    #[error("there is no complete central directory at its end")]
    Incomplete,
    /// More than any FMU needs.
    #[error("{0}")]
    TooLarge(String),
}

/// Most entries that an archive may have.
const MOST_ENTRIES: u16 = 10_000;
/// Largest directory that is read [bytes]: names of 400 bytes for each entry.
const LARGEST_DIRECTORY: u32 = 4 << 20;
/// Most folders that the names of all entries go through: each is made when the archive is unpacked.
const MOST_FOLDERS: usize = 4 * MOST_ENTRIES as usize;
/// Unpacked over packed size beyond which a large entry is taken for a bomb; binaries and XML stay below 20, and deflate
/// itself ends at 1032.
const MOST_RATIO: u64 = 200;
/// Unpacked size below which the ratio does not matter.
const RATIO_FLOOR: u64 = 16 << 20;

const END_SIGNATURE: [u8; 4] = *b"PK\x05\x06";
const ENTRY_SIGNATURE: [u8; 4] = *b"PK\x01\x02";
const END_LENGTH: usize = 22;
const ENTRY_LENGTH: usize = 46;

/// All entries in the order of the directory.
///
/// # Errors
/// [`DirectoryError`]; what is too large is refused before it is read.
pub fn read<R: Read + Seek>(archive: &mut R) -> Result<Vec<DirectoryEntry>, DirectoryError> {
    let length = archive.seek(SeekFrom::End(0))?;
    let longest = (END_LENGTH + usize::from(u16::MAX)) as u64;
    let tail_begin = length.saturating_sub(longest);
    let tail = piece(archive, tail_begin, length - tail_begin)?;
    let end = End::last(&tail).ok_or(DirectoryError::Incomplete)?;
    if end.count > MOST_ENTRIES {
        return Err(DirectoryError::TooLarge(format!(
            "it has more than {MOST_ENTRIES} entries"
        )));
    }
    if end.size > LARGEST_DIRECTORY {
        return Err(DirectoryError::TooLarge(format!(
            "its directory has {} bytes, more than {LARGEST_DIRECTORY}",
            end.size
        )));
    }
    if u64::from(end.offset) + u64::from(end.size) != tail_begin + end.place {
        return Err(DirectoryError::Incomplete);
    }
    let bytes = piece(archive, u64::from(end.offset), u64::from(end.size))?;
    entries(&bytes, end.count).ok_or(DirectoryError::Incomplete)
}

/// Why the entries are more than an FMU needs, if they are: more than `most_bytes` unpacked, too many folders, or one that
/// is a bomb.
#[must_use]
pub fn excess(entries: &[DirectoryEntry], most_bytes: u64) -> Option<String> {
    let total: u64 = entries.iter().map(|entry| entry.size).sum();
    if total > most_bytes {
        return Some(format!(
            "it unpacks to more than {} MiB: {total} bytes",
            most_bytes >> 20
        ));
    }
    let folders: usize = entries
        .iter()
        .map(|entry| entry.name.matches('/').count())
        .sum();
    if folders > MOST_FOLDERS {
        return Some(format!(
            "its entries lie in {folders} folders, more than {MOST_FOLDERS}"
        ));
    }
    let bomb = entries.iter().find(|entry| {
        entry.size > RATIO_FLOOR && entry.size / entry.compressed_size.max(1) > MOST_RATIO
    })?;
    Some(format!(
        "entry {} unpacks to more than {MOST_RATIO} times its size: from {} to {} bytes",
        bomb.name, bomb.compressed_size, bomb.size
    ))
}

/// The record at the end of an archive.
struct End {
    /// Where it begins in the bytes that were looked through.
    place: u64,
    count: u16,
    size: u32,
    offset: u32,
}

impl End {
    /// The last one in `tail`, if it is that of a whole archive of one disk.
    fn last(tail: &[u8]) -> Option<Self> {
        let last = tail.len().checked_sub(END_LENGTH)?;
        let place = (0..=last)
            .rev()
            .find(|at| tail[*at..].starts_with(&END_SIGNATURE))?;
        let (disk, first_disk) = (word(tail, place + 4)?, word(tail, place + 6)?);
        let (count_here, count) = (word(tail, place + 8)?, word(tail, place + 10)?);
        let comment = usize::from(word(tail, place + 20)?);
        let whole = disk == 0
            && first_disk == 0
            && count_here == count
            && place + END_LENGTH + comment <= tail.len();
        whole.then_some(Self {
            place: place as u64,
            count,
            size: long(tail, place + 12)?,
            offset: long(tail, place + 16)?,
        })
    }
}

/// The entries of a directory that has `count` of them and nothing else.
fn entries(bytes: &[u8], count: u16) -> Option<Vec<DirectoryEntry>> {
    let mut at = 0;
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
    (at == bytes.len()).then_some(entries)
}

/// `length` bytes from `begin`; fewer where the archive ends before.
fn piece<R: Read + Seek>(archive: &mut R, begin: u64, length: u64) -> io::Result<Vec<u8>> {
    archive.seek(SeekFrom::Start(begin))?;
    let mut bytes = Vec::new();
    archive.take(length).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn word(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn long(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}
