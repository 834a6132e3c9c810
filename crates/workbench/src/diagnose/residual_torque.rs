//! Residual torques: what would have to be added on the disc and on the motor, piece by piece, for a model to follow the
//! records.

use inference::data::{Data, reduced};
use inference::gram::Place;
use inference::marginal::Disturbance;
use inference::units::PlantUnits;
use stickslip::parameter::ParameterError;
use stickslip::plant::Rig;

use super::restart::best_starts;

/// Residual torques over one piece of a window.
#[derive(Debug, Clone, Copy)]
pub struct ResidualTorque {
    /// Record that the piece belongs to.
    pub run: usize,
    /// Where the motion is, SI units.
    pub place: Place,
    /// Torque on the disc [N m].
    pub disc: f64,
    /// Its standard deviation [N m].
    pub disc_deviation: f64,
    /// Torque on the gearbox output [N m].
    pub motor: f64,
    /// Its standard deviation [N m].
    pub motor_deviation: f64,
}

/// Residual torques of `rig`, which is in SI units, on the records of `data`, which are in the plant's `units`.
///
/// # Errors
/// A number of the rig leaves its range in the plant's units.
pub fn residual_torques(
    data: &Data,
    units: &PlantUnits,
    rig: &Rig<f64>,
) -> Result<Vec<ResidualTorque>, ParameterError> {
    // A priori they may be as large as the friction torque.
    let prior = data.scales.torque;
    let free = Disturbance {
        disc: prior,
        motor: prior,
        ..Disturbance::NONE
    };
    let data = &data.clone().with_motor_torques();
    let starts = best_starts(data, &units.to_plant(rig)?);
    let forms = reduced(data, &starts.states, &starts.grams, &free);
    let mut found = Vec::new();
    for ((gram, form), window) in starts.grams.iter().zip(&forms).zip(&data.windows) {
        let (Some(gram), Some(form)) = (gram, form) else {
            continue;
        };
        let torques = form.disturbances();
        let at = |column: usize| {
            let torque = torques.iter().find(|(found, _, _)| *found == column);
            let unit = prior * units.torque;
            torque.map_or((0.0, 0.0), |(_, value, deviation)| {
                (unit * value, unit * deviation)
            })
        };
        for (piece, place) in gram.places.iter().enumerate() {
            let (disc, disc_deviation) = at(gram.disc() + piece);
            let (motor, motor_deviation) =
                gram.motor().map_or((0.0, 0.0), |first| at(first + piece));
            found.push(ResidualTorque {
                run: window.run,
                place: to_si(place, units),
                disc,
                disc_deviation,
                motor,
                motor_deviation,
            });
        }
    }
    Ok(found)
}

fn to_si(place: &Place, units: &PlantUnits) -> Place {
    Place {
        time: place.time * units.time,
        speed: place.speed / units.time,
        acceleration: place.acceleration / units.time.powi(2),
        gear_speed: place.gear_speed / units.time,
        normal_force: place.normal_force * units.force,
        current: place.current * units.current,
        friction: place.friction * units.torque,
        ..*place
    }
}
