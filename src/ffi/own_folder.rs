//! Where this library lies, for importers that pass a resource location which leads nowhere.

use std::path::PathBuf;

/// The folder `resources` of the unpacked FMU in whose `binaries/PLATFORM` this library lies, if the system tells where it was
/// loaded from. Linux does.
pub(super) fn resources() -> Option<PathBuf> {
    let library = library()?;
    let binaries = library.parent()?.parent()?;
    (binaries.file_name()? == "binaries").then(|| binaries.with_file_name("resources"))
}

/// The file whose mapping holds this very function.
#[cfg(target_os = "linux")]
fn library() -> Option<PathBuf> {
    let here = resources as *const () as usize;
    let maps = std::fs::read_to_string("/proc/self/maps").ok()?;
    maps.lines().find_map(|line| file_at(line, here))
}

#[cfg(not(target_os = "linux"))]
fn library() -> Option<PathBuf> {
    None
}

/// The file of a line of the map of memory, if `address` is in its range: `start-end rights offset device inode path`.
#[cfg(any(target_os = "linux", test))]
fn file_at(line: &str, address: usize) -> Option<PathBuf> {
    let (range, rest) = line.split_once(' ')?;
    let (start, end) = range.split_once('-')?;
    let number = |text| usize::from_str_radix(text, 16).ok();
    let within = (number(start)?..number(end)?).contains(&address);
    let path = &rest[rest.find('/')?..];
    within.then(|| PathBuf::from(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_the_map_names_a_file() {
        let line = "7f00-7fff r-xp 00001000 08:01 4711                       /tmp/an fmu/binaries/x86_64-linux/Rig.so";
        let path = Some(PathBuf::from("/tmp/an fmu/binaries/x86_64-linux/Rig.so"));
        assert_eq!(file_at(line, 0x7f00), path);
        assert_eq!(file_at(line, 0x7fff), None);
        assert_eq!(file_at("7f00-7fff rw-p 00000000 00:00 0", 0x7f00), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_program_is_found_and_is_no_fmu() {
        assert_eq!(library(), std::env::current_exe().ok());
        assert_eq!(resources(), None);
    }
}
