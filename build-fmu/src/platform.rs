//! FMI versions and platforms: folder names, file endings, names of the library.

use std::fmt;
use std::str::FromStr;

use object::{Architecture, BinaryFormat};
use thiserror::Error;

/// Version of the standard that an FMU follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FmiVersion {
    /// FMI 2.0 co-simulation (2.0.5).
    Fmi2,
    /// FMI 3.0 co-simulation (3.0.2).
    Fmi3,
}

impl FmiVersion {
    /// Both, the older first.
    pub const ALL: [FmiVersion; 2] = [FmiVersion::Fmi2, FmiVersion::Fmi3];

    /// The part of the FMU's file name that tells the version: `fmi2` or `fmi3`.
    pub fn tag(self) -> &'static str {
        match self {
            FmiVersion::Fmi2 => "fmi2",
            FmiVersion::Fmi3 => "fmi3",
        }
    }

    /// What `fmiXGetVersion` of the library must answer.
    pub fn number(self) -> &'static str {
        match self {
            FmiVersion::Fmi2 => "2.0",
            FmiVersion::Fmi3 => "3.0",
        }
    }
}

impl fmt::Display for FmiVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "FMI {}", self.number())
    }
}

/// Operating system and processor of a library.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Platform {
    /// Linux on x86-64.
    Linux64,
    /// Linux on 64-bit ARM.
    LinuxAarch64,
    /// Windows on x86-64.
    Windows64,
    /// macOS on x86-64.
    Darwin64,
    /// macOS on 64-bit ARM.
    DarwinAarch64,
}

/// A name that is no platform of FMI.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("`{name}` is no platform; use one of {}", Platform::ALL.map(Platform::name).join(", "))]
pub struct UnknownPlatform {
    /// What was given.
    pub name: String,
}

impl FromStr for Platform {
    type Err = UnknownPlatform;

    /// By the folder name of either version: `win64` and `x86_64-windows` are the same.
    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Platform::ALL
            .into_iter()
            .find(|platform| {
                FmiVersion::ALL
                    .into_iter()
                    .any(|version| platform.folder(version) == name)
            })
            .ok_or_else(|| UnknownPlatform {
                name: name.to_owned(),
            })
    }
}

impl fmt::Display for Platform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Platform {
    /// All platforms that a library can be packed for.
    pub const ALL: [Platform; 5] = [
        Platform::Linux64,
        Platform::LinuxAarch64,
        Platform::Windows64,
        Platform::Darwin64,
        Platform::DarwinAarch64,
    ];

    /// The name on the command line and of the folder of prebuilt libraries: `linux64`, `aarch64-linux`, …
    pub fn name(self) -> &'static str {
        self.folder(FmiVersion::Fmi2)
    }

    /// File format and processor of its libraries.
    pub fn machine(self) -> (BinaryFormat, Architecture) {
        match self {
            Platform::Linux64 => (BinaryFormat::Elf, Architecture::X86_64),
            Platform::LinuxAarch64 => (BinaryFormat::Elf, Architecture::Aarch64),
            Platform::Windows64 => (BinaryFormat::Pe, Architecture::X86_64),
            Platform::Darwin64 => (BinaryFormat::MachO, Architecture::X86_64),
            Platform::DarwinAarch64 => (BinaryFormat::MachO, Architecture::Aarch64),
        }
    }

    /// The platform that this program was built for, if FMI has a folder for it.
    pub fn current() -> Option<Platform> {
        match (std::env::consts::OS, std::env::consts::ARCH) {
            ("linux", "x86_64") => Some(Platform::Linux64),
            ("linux", "aarch64") => Some(Platform::LinuxAarch64),
            ("windows", "x86_64") => Some(Platform::Windows64),
            ("macos", "x86_64") => Some(Platform::Darwin64),
            ("macos", "aarch64") => Some(Platform::DarwinAarch64),
            _ => None,
        }
    }

    /// Folder below `binaries/`.
    ///
    /// FMI 2 names only three 64-bit folders; for ARM it leaves the name open, and importers look for the FMI 3 tuple.
    pub fn folder(self, version: FmiVersion) -> &'static str {
        match (version, self) {
            (FmiVersion::Fmi2, Platform::Linux64) => "linux64",
            (FmiVersion::Fmi2, Platform::Windows64) => "win64",
            (FmiVersion::Fmi2, Platform::Darwin64) => "darwin64",
            (FmiVersion::Fmi3, Platform::Linux64) => "x86_64-linux",
            (FmiVersion::Fmi3, Platform::Windows64) => "x86_64-windows",
            (FmiVersion::Fmi3, Platform::Darwin64) => "x86_64-darwin",
            (_, Platform::LinuxAarch64) => "aarch64-linux",
            (_, Platform::DarwinAarch64) => "aarch64-darwin",
        }
    }

    /// Ending of a shared library's file name, without the dot.
    pub fn library_extension(self) -> &'static str {
        match self {
            Platform::Linux64 | Platform::LinuxAarch64 => "so",
            Platform::Windows64 => "dll",
            Platform::Darwin64 | Platform::DarwinAarch64 => "dylib",
        }
    }

    /// File name that the build gives the library of a crate whose library is called `stem`.
    pub fn library_file_name(self, stem: &str) -> String {
        match self {
            Platform::Linux64 | Platform::LinuxAarch64 => format!("lib{stem}.so"),
            Platform::Windows64 => format!("{stem}.dll"),
            Platform::Darwin64 | Platform::DarwinAarch64 => format!("lib{stem}.dylib"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_platform_has_the_names_of_both_versions() {
        for platform in Platform::ALL {
            for version in FmiVersion::ALL {
                assert_eq!(platform.folder(version).parse(), Ok(platform));
            }
        }
        let error = "win32".parse::<Platform>().unwrap_err().to_string();
        assert!(
            error.contains("win32") && error.contains("win64"),
            "{error}"
        );
    }
}
