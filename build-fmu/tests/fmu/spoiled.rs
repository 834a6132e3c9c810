//! FMUs with one defect planted.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Read, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// Files of an FMU by their names.
pub type Files = BTreeMap<String, Vec<u8>>;

/// Name of the model description.
pub const DESCRIPTION: &str = "modelDescription.xml";
/// Name of the library in FMI 2.0 and FMI 3.0.
pub const LIBRARY: [&str; 2] = [
    "binaries/linux64/ReducedRig.so",
    "binaries/x86_64-linux/ReducedRig.so",
];

/// A way to spoil the good FMU.
pub enum Defect {
    /// Replaces text in the model description, which must be there.
    Replace(&'static str, &'static str),
    /// Replaces text in a file, in which it must be.
    ReplaceIn(&'static str, &'static str, &'static str),
    /// Changes the files.
    Files(fn(&mut Files, library: &str)),
    /// Changes the archive's bytes.
    Bytes(fn(&mut Vec<u8>)),
}

/// Adds a text.
pub fn add(files: &mut Files, name: &str) {
    files.insert(name.to_owned(), b"text".to_vec());
}

/// Overwrites the lower half of a field of the first entry of the central directory.
pub fn patch(bytes: &mut [u8], offset: usize, value: u16) {
    let at = bytes
        .windows(4)
        .position(|window| window == b"PK\x01\x02")
        .unwrap();
    bytes[at + offset..at + offset + 2].copy_from_slice(&value.to_le_bytes());
}

/// Gives a symbol another name of the same length.
pub fn rename_symbol(library: &mut [u8], from: &[u8], to: &[u8]) {
    let places: Vec<usize> = (0..library.len() - from.len())
        .filter(|at| library[*at..].starts_with(from))
        .collect();
    assert!(!places.is_empty());
    for at in places {
        library[at..at + to.len()].copy_from_slice(to);
    }
}

/// The files of an FMU.
pub fn unpack(path: &Path) -> Files {
    let mut archive = ZipArchive::new(fs::File::open(path).unwrap()).unwrap();
    let names: Vec<String> = archive
        .file_names()
        .map(|name| name.unwrap().into_owned())
        .collect();
    names
        .into_iter()
        .map(|name| {
            let mut content = Vec::new();
            archive
                .by_name(&name)
                .unwrap()
                .read_to_end(&mut content)
                .unwrap();
            (name, content)
        })
        .collect()
}

/// An FMU of these files.
pub fn pack(files: &Files, level: i64) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        let options = SimpleFileOptions::default()
            .unix_permissions(0o644)
            .compression_level(Some(level));
        writer.start_file(name.as_str(), options).unwrap();
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn replace(files: &mut Files, file: &str, from: &str, to: &str) {
    let text = String::from_utf8(files[file].clone()).unwrap();
    assert!(text.contains(from), "{from} is not in {file}");
    files.insert(file.to_owned(), text.replacen(from, to, 1).into_bytes());
}

/// The FMU of these files with one defect.
pub fn spoil(good: &Files, defect: &Defect, library: &str) -> Vec<u8> {
    let mut files = good.clone();
    match defect {
        Defect::Replace(from, to) => replace(&mut files, DESCRIPTION, from, to),
        Defect::ReplaceIn(file, from, to) => replace(&mut files, file, from, to),
        Defect::Files(change) => change(&mut files, library),
        Defect::Bytes(_) => {}
    }
    let mut bytes = pack(&files, 1);
    if let Defect::Bytes(change) = defect {
        change(&mut bytes);
    }
    bytes
}
