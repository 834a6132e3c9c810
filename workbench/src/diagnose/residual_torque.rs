//! Residual torques: what would have to be added on the disc and on the motor, piece by piece, for a model to follow the
//! records.

use super::data::{Data, reduced};
use super::gram::{Gram, Place};
use super::marginal::Disturbance;
use super::restart::best_starts;
use stickslip::plant::Rig;

/// Standard deviation that the residual torques may have a priori [N m].
const PRIOR_TORQUE: f64 = 0.2;

/// Residual torques over one piece of a window.
#[derive(Debug, Clone, Copy)]
pub struct ResidualTorque {
    /// Record that the piece belongs to.
    pub run: usize,
    /// Where the motion is.
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

/// Residual torques of `rig` on the records of `data`.
#[must_use]
pub fn residual_torques(data: &Data, rig: &Rig<f64>) -> Vec<ResidualTorque> {
    let free = Disturbance {
        disc: PRIOR_TORQUE,
        motor: PRIOR_TORQUE,
        ..Disturbance::NONE
    };
    let starts = best_starts(data, rig);
    let forms = reduced(data, &starts.states, &starts.grams, &free);
    let mut found = Vec::new();
    for ((gram, form), window) in starts.grams.iter().zip(&forms).zip(&data.windows) {
        let (Some(gram), Some(form)) = (gram, form) else {
            continue;
        };
        let torques = form.disturbances();
        let at = |column: usize| {
            let torque = torques.iter().find(|(found, _, _)| *found == column);
            torque.map_or((0.0, 0.0), |(_, value, deviation)| {
                (PRIOR_TORQUE * value, PRIOR_TORQUE * deviation)
            })
        };
        for (piece, place) in gram.places.iter().enumerate() {
            let (disc, disc_deviation) = at(Gram::DISC + piece);
            let (motor, motor_deviation) = at(gram.motor() + piece);
            found.push(ResidualTorque {
                run: window.run,
                place: *place,
                disc,
                disc_deviation,
                motor,
                motor_deviation,
            });
        }
    }
    found
}
