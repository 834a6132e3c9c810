//! Effects on small plants as equations: lists of operations that an FMU can carry.

use operations::{COORDINATES, Operation};
use stickslip::expression::{self, Dimension as SiDimension, ExpressionError, Names, Quantity};
use stickslip::parameter::Range as Allowed;

use super::term::{Entry, Range};
use super::unit::{Dimension, Kind, Path};

/// Coordinates of small plants beyond those of an FMU's port: normal load over its mean, predicted force.
const FURTHER: [&str; 2] = ["load", "predicted"];

/// The operations of an effect's equation on a plant of this kind and path; `None` where it has no equation.
///
/// # Errors
/// The equation is wrong, which a test excludes for the catalogue.
pub fn as_operations(
    entry: &Entry,
    kind: Kind,
    path: Path,
) -> Option<Result<Vec<Operation>, ExpressionError>> {
    let equation = entry.equation?;
    // Minutes are seconds in kind.
    let si = |unit: &str| SiDimension::of_unit(&unit.replace("min", "s")).unwrap_or_default();
    let of = |dimension: Dimension| si(dimension.unit(kind, path));
    let position = match path {
        Path::Turn => SiDimension::NONE,
        Path::Line => si("m"),
    };
    let force = of(Dimension::Force);
    let dimensions = [
        position,
        of(Dimension::Speed),
        of(Dimension::Acceleration),
        SiDimension::NONE,
        si("s"),
        force,
        SiDimension::NONE,
        force,
    ];
    let names = COORDINATES.iter().chain(&FURTHER).zip(dimensions);
    let coordinates: Vec<Quantity> = names
        .enumerate()
        .map(|(place, (name, dimension))| Quantity {
            name,
            place,
            dimension,
            is_positive: false,
            is_rate: false,
        })
        .collect();
    let parameters: Vec<(&str, SiDimension, Allowed)> = entry
        .parameters
        .iter()
        .map(|own| {
            let range = match own.range {
                Range::Free => Allowed::Finite,
                Range::Positive => Allowed::Positive,
                Range::Within(low, high) => Allowed::Between(low, high),
            };
            (own.key, of(own.dimension), range)
        })
        .collect();
    let names = Names {
        parameters: &parameters,
        coordinates: &coordinates,
        tables: &[],
        result: (force, Dimension::Force.unit(kind, path)),
    };
    Some(expression::parse(equation, &names).map(|program| program.operations().to_vec()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::small_plant::catalogue::CATALOGUE;
    use crate::diagnose::small_plant::term::Sample;

    #[test]
    fn equations_give_what_the_diagnosis_fits() {
        let sample = Sample {
            time: 3.7,
            position: 0.9,
            velocity: -1.3,
            acceleration: 2.2,
            direction: -1.0,
            load: 1.1,
            predicted: -0.8,
            ..Sample::default()
        };
        let friction = -0.6;
        let at = [
            sample.position,
            sample.velocity,
            sample.acceleration,
            sample.direction,
            sample.time,
            friction,
            sample.load,
            sample.predicted,
        ];
        let mut compared = 0;
        for entry in CATALOGUE {
            let parameters: Vec<f64> = (0..entry.parameters.len())
                .map(|place| 0.7 + 0.4 * place as f64)
                .collect();
            for &kind in entry.kinds {
                let path = entry.path.unwrap_or(Path::Turn);
                let Some(operations) = as_operations(entry, kind, path) else {
                    continue;
                };
                let operations = operations.unwrap();
                let value = operations::value(&operations, &parameters, &at, &mut Vec::new());
                let wanted = (entry.force)(&parameters, &sample, friction);
                assert!(
                    (value - wanted).abs() < 1e-12,
                    "{}: {value} {wanted}",
                    entry.name
                );
                compared += 1;
            }
        }
        assert!(compared > 30, "{compared}");
    }
}
