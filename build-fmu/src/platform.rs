//! FMI versions and platforms: folder names, file endings, names of the library.

use std::fmt;

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

impl Platform {
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

    /// File name that the build gives the library.
    pub fn library_file_name(self) -> &'static str {
        match self {
            Platform::Linux64 | Platform::LinuxAarch64 => "libstickslip.so",
            Platform::Windows64 => "stickslip.dll",
            Platform::Darwin64 | Platform::DarwinAarch64 => "libstickslip.dylib",
        }
    }
}
