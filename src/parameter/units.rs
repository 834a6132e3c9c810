//! Units: from a name such as `N.m.s/rad` to exponents of the SI base units.

use thiserror::Error;

/// Exponents of the SI base units (and the radian, which both standards count among them).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BaseUnit {
    /// Kilogram.
    pub kg: i32,
    /// Metre.
    pub m: i32,
    /// Second.
    pub s: i32,
    /// Ampere.
    pub a: i32,
    /// Kelvin.
    pub k: i32,
    /// Radian.
    pub rad: i32,
}

impl BaseUnit {
    /// The XML attributes of both standards with a non-zero exponent, in the standards' order.
    pub fn attributes(&self) -> impl Iterator<Item = (&'static str, i32)> {
        [
            ("kg", self.kg),
            ("m", self.m),
            ("s", self.s),
            ("A", self.a),
            ("K", self.k),
            ("rad", self.rad),
        ]
        .into_iter()
        .filter(|(_, exponent)| *exponent != 0)
    }

    fn add(&mut self, other: Self, times: i32) {
        self.kg += times * other.kg;
        self.m += times * other.m;
        self.s += times * other.s;
        self.a += times * other.a;
        self.k += times * other.k;
        self.rad += times * other.rad;
    }
}

/// A unit that people like to read instead: value in it = `factor` · value in the unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayUnit {
    /// Name, for example `rpm`.
    pub name: &'static str,
    /// Display value per value in the unit.
    pub factor: f64,
}

/// The definition of a unit. All units here are coherent SI: factor 1, offset 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Name as variables use it.
    pub name: String,
    /// Its SI exponents.
    pub base: BaseUnit,
    /// Units to display it in.
    pub display_units: Vec<DisplayUnit>,
}

/// Names of the units that may occur in a product, with their exponents (kg, m, s, A, K, rad).
const SYMBOLS: &[(&str, [i32; 6])] = &[
    ("kg", [1, 0, 0, 0, 0, 0]),
    ("m", [0, 1, 0, 0, 0, 0]),
    ("s", [0, 0, 1, 0, 0, 0]),
    ("A", [0, 0, 0, 1, 0, 0]),
    ("K", [0, 0, 0, 0, 1, 0]),
    ("rad", [0, 0, 0, 0, 0, 1]),
    ("Hz", [0, 0, -1, 0, 0, 0]),
    ("N", [1, 1, -2, 0, 0, 0]),
    ("J", [1, 2, -2, 0, 0, 0]),
    ("W", [1, 2, -3, 0, 0, 0]),
    ("V", [1, 2, -3, -1, 0, 0]),
    ("Ohm", [1, 2, -3, -2, 0, 0]),
    ("ohm", [1, 2, -3, -2, 0, 0]),
    ("H", [1, 2, -2, -2, 0, 0]),
];

impl Unit {
    /// The definition of the unit called `name`: symbols with an optional integer exponent, joined
    /// by `.`; everything after a `/` divides. `1` is dimensionless.
    ///
    /// # Errors
    /// A symbol that is not an SI unit known here, or an exponent that is not an integer.
    pub fn parse(name: &str) -> Result<Self, UnitError> {
        let mut base = BaseUnit::default();
        for (place, part) in name.split('/').enumerate() {
            let sign = if place == 0 { 1 } else { -1 };
            for factor in part.trim_matches(['(', ')']).split('.') {
                if factor == "1" {
                    continue;
                }
                let letters = factor.trim_end_matches(|c: char| c.is_ascii_digit() || c == '-');
                let exponent = match &factor[letters.len()..] {
                    "" => 1,
                    // Larger ones are no physics, and their sums could overflow.
                    digits => digits.parse::<i8>().map(i32::from).map_err(|_| UnitError {
                        unit: name.to_owned(),
                        part: factor.to_owned(),
                    })?,
                };
                let Some((_, e)) = SYMBOLS.iter().find(|(symbol, _)| *symbol == letters) else {
                    return Err(UnitError {
                        unit: name.to_owned(),
                        part: factor.to_owned(),
                    });
                };
                let symbol = BaseUnit {
                    kg: e[0],
                    m: e[1],
                    s: e[2],
                    a: e[3],
                    k: e[4],
                    rad: e[5],
                };
                base.add(symbol, sign * exponent);
            }
        }
        let display_units = match name {
            "rad" => vec![DisplayUnit {
                name: "deg",
                factor: 180.0 / std::f64::consts::PI,
            }],
            "rad/s" => vec![DisplayUnit {
                name: "rpm",
                factor: 30.0 / std::f64::consts::PI,
            }],
            _ => Vec::new(),
        };
        Ok(Self {
            name: name.to_owned(),
            base,
            display_units,
        })
    }
}

/// Whether a number that people give in `written` is one in `unit`, without conversion: spaces, `*` and `·` may stand for
/// products, `^` and raised digits for exponents, `-` for no unit, and radians may be left out. Hertz counts turns, not
/// radians, and is no other unit than itself.
pub(crate) fn is_same(written: &str, unit: &str) -> bool {
    let spelled = match written.trim() {
        "" | "-" => "1".to_owned(),
        other => other
            .replace([' ', '*', '·'], ".")
            .replace('^', "")
            .replace('²', "2")
            .replace('³', "3")
            .replace('Ω', "Ohm")
            .replace("./", "/")
            .replace("/.", "/"),
    };
    if spelled.contains("Hz") != unit.contains("Hz") {
        return false;
    }
    let measure = |name: &str| {
        let base = Unit::parse(name).ok()?.base;
        Some(BaseUnit { rad: 0, ..base })
    };
    measure(&spelled).is_some_and(|base| Some(base) == measure(unit))
}

/// A unit name that cannot be read.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "unit \"{unit}\": \"{part}\" is not an SI symbol with an optional integer exponent (expected for example N.m.s/rad)"
)]
pub struct UnitError {
    /// The whole name.
    pub unit: String,
    /// The part that is not understood.
    pub part: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn torsional_damping_in_base_units() {
        let unit = Unit::parse("N.m.s/rad").unwrap();
        assert_eq!(
            unit.base,
            BaseUnit {
                kg: 1,
                m: 2,
                s: -1,
                rad: -1,
                ..Default::default()
            }
        );
    }

    #[test]
    fn resistance_equals_volt_per_ampere() {
        assert_eq!(
            Unit::parse("Ohm").unwrap().base,
            Unit::parse("V/A").unwrap().base
        );
        assert_eq!(
            Unit::parse("H").unwrap().base,
            Unit::parse("V.s/A").unwrap().base
        );
    }

    #[test]
    fn dimensionless_has_no_exponents() {
        assert_eq!(Unit::parse("1").unwrap().base.attributes().count(), 0);
    }

    #[test]
    fn speed_can_be_shown_in_rpm() {
        let unit = Unit::parse("rad/s").unwrap();
        let one_turn_per_second = 2.0 * std::f64::consts::PI * unit.display_units[0].factor;
        assert!((one_turn_per_second - 60.0).abs() < 1e-12);
    }

    #[test]
    fn the_same_unit_has_many_spellings() {
        for (written, unit) in [
            ("kg m2", "kg.m2"),
            ("kg·m²", "kg.m2"),
            ("kg*m^2", "kg.m2"),
            ("N m s/rad", "N.m.s/rad"),
            ("N m / rad", "N.m/rad"),
            ("N m", "N.m/rad"),
            ("V/A", "Ohm"),
            ("Ω", "Ohm"),
            ("ohm", "Ohm"),
            ("-", "1"),
            ("rad", "1"),
            ("Hz", "Hz"),
        ] {
            assert!(is_same(written, unit), "{written} {unit}");
        }
    }

    #[test]
    fn what_would_need_a_conversion_is_another_unit() {
        for (written, unit) in [
            ("g cm2", "kg.m2"),
            ("kg m", "kg.m2"),
            ("mm", "m"),
            ("rpm", "rad/s"),
            ("deg", "rad"),
            ("Hz", "1/s"),
            ("mH", "H"),
            ("%", "1"),
            ("N m", "N"),
        ] {
            assert!(!is_same(written, unit), "{written} {unit}");
        }
    }

    #[test]
    fn unknown_symbol_is_named() {
        let error = Unit::parse("N.furlong").unwrap_err();
        assert_eq!(error.part, "furlong");
    }
}
