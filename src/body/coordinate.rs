//! Equations of small plants' effects: what they may depend on, and their check.

use super::{Dimension, Kind, Parameter, Path};
use crate::expression::{
    self, Dimension as SiDimension, ExpressionError, Names, Program, Quantity,
};
use crate::parameter::Range;
use operations::COORDINATES;

/// Coordinates of small plants beyond those of an FMU's port: predicted force and torque of a joint's motor.
const FURTHER: [&str; 2] = ["predicted", "motor"];
/// Number of all coordinates.
pub const COUNT: usize = COORDINATES.len() + FURTHER.len();
/// Place of the position among them.
pub const POSITION: usize = 0;
/// Place of the velocity.
pub const VELOCITY: usize = 1;
/// Place of the acceleration.
pub const ACCELERATION: usize = 2;
/// Place of the direction of motion.
pub const DIRECTION: usize = 3;
/// Place of the time.
pub const TIME: usize = 4;
/// Place of the friction.
pub const FRICTION: usize = 5;
/// Place of the load: of a contact the normal load over its mean, of a joint the moment of its weight, else a measured force.
pub const LOAD: usize = 6;
/// Place of the predicted force.
pub const PREDICTED: usize = 7;
/// Place of the torque of a joint's motor.
pub const MOTOR: usize = 8;

/// What equations on a plant of this kind and path may depend on.
#[must_use]
pub fn quantities(kind: Kind, path: Path) -> Vec<Quantity> {
    let of = |dimension: Dimension| si(dimension.unit(kind, path));
    let force = of(Dimension::Force);
    let dimensions: [SiDimension; COUNT] = [
        of(Dimension::Position),
        of(Dimension::Speed),
        of(Dimension::Acceleration),
        SiDimension::NONE,
        si("s"),
        force,
        match kind {
            Kind::Contact => SiDimension::NONE,
            _ => force,
        },
        force,
        force,
    ];
    let has = |place: usize| match place {
        // A run that is predicted has no measured acceleration.
        ACCELERATION => !kind.runs_alone(),
        LOAD => !matches!(kind, Kind::Drive | Kind::Pendulum),
        PREDICTED => kind == Kind::Balance,
        MOTOR => kind == Kind::Joint,
        _ => true,
    };
    let names = COORDINATES.iter().chain(&FURTHER).zip(dimensions);
    names
        .enumerate()
        .filter(|(place, _)| has(*place))
        .map(|(place, (name, dimension))| Quantity {
            name,
            place,
            dimension,
            is_positive: false,
            // What friction and a motor's torque are depends on the velocity.
            is_rate: [VELOCITY, FRICTION, MOTOR].contains(&place),
        })
        .collect()
}

/// Reads and checks an equation over these parameters on a plant of this kind and path.
///
/// # Errors
/// The first thing that is wrong, with its column.
pub fn compile(
    equation: &str,
    parameters: &[Parameter],
    kind: Kind,
    path: Path,
) -> Result<Program, ExpressionError> {
    let parameters: Vec<(&str, SiDimension, Range)> = parameters
        .iter()
        .map(|own| {
            let unit = own.dimension.unit(kind, path);
            (own.key, si(unit), own.range)
        })
        .collect();
    let force = Dimension::Force.unit(kind, path);
    let names = Names {
        parameters: &parameters,
        coordinates: &quantities(kind, path),
        tables: &[],
        result: (si(force), force),
    };
    expression::parse(equation, &names)
}

/// Dimension of a unit that is known to be one; minutes are seconds in kind.
fn si(unit: &str) -> SiDimension {
    SiDimension::of_unit(&unit.replace("min", "s")).unwrap_or_default()
}
