//! The variables that a rig's record may have, and their units.

use std::f64::consts::TAU;

use super::record_check::COLUMNS;

/// Name of the time's column.
pub const TIME: &str = "time";

/// Units of a variable, SI first.
pub fn units(variable: &str) -> &'static [(&'static str, f64)] {
    match variable {
        TIME => &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("min", 60.0)],
        "u" => &[("V", 1.0), ("mV", 1e-3)],
        "i" => &[("A", 1.0), ("mA", 1e-3)],
        force if force.starts_with('N') => &[("N", 1.0), ("kN", 1e3), ("mN", 1e-3), ("MN", 1e6)],
        velocity if velocity.ends_with("_dot") => &[
            ("rad/s", 1.0),
            ("deg/s", TAU / 360.0),
            ("°/s", TAU / 360.0),
            ("rpm", TAU / 60.0),
            ("1/min", TAU / 60.0),
        ],
        _ => &[
            ("rad", 1.0),
            ("deg", TAU / 360.0),
            ("°", TAU / 360.0),
            ("rev", TAU),
            ("mrad", 1e-3),
        ],
    }
}

/// Names of the units that a variable of a record may have, SI first.
pub fn unit_names(variable: &str) -> impl Iterator<Item = &'static str> {
    units(variable).iter().map(|(name, _)| *name)
}

/// Names of all variables that a record may have, time first.
pub fn variables() -> impl Iterator<Item = &'static str> {
    std::iter::once(TIME).chain(COLUMNS)
}
