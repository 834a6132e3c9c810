//! How large things are in the records at hand: every size that the engine compares is a share of one of these.

use crate::record::Run;
use stickslip::friction::Law;
use stickslip::plant::Rig;

/// Sizes in the plant's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Speed that the motion hardly exceeds.
    pub speed: f64,
    /// Friction torque under the measured loads.
    pub torque: f64,
    /// Twist of the shaft: what friction and a swing of the speed bring about.
    pub twist: f64,
    /// Acceleration of the disc.
    pub acceleration: f64,
    /// Mean normal force while the pin presses; 0 where it never does.
    pub load: f64,
    /// Current that carries the friction torque.
    pub current: f64,
    /// Longest time in a record.
    pub duration: f64,
    /// Smallest angle of the disc that the instruments tell from none.
    pub resolution: f64,
    /// Mean friction coefficient of the law.
    pub coefficient: f64,
}

/// Mean normal force of the samples in which the pin presses; `None` where it never does.
pub fn mean_load<'a>(forces: impl Iterator<Item = &'a [f64]>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for force in forces.flatten().filter(|force| **force > 0.0) {
        sum += force;
        count += 1.0;
    }
    (count > 0.0).then(|| sum / count)
}

impl Scales {
    /// The sizes of these records of `rig`.
    #[must_use]
    pub fn of(rig: &Rig<f64>, runs: &[Run], resolution: f64) -> Self {
        let speed = runs
            .iter()
            .map(|run| run.traces.speed)
            .fold(f64::MIN_POSITIVE, f64::max);
        let load = mean_load(runs.iter().map(|run| run.normal_force.as_slice())).unwrap_or(0.0);
        let breakaway = rig.law.breakaway();
        let braking = if matches!(rig.law, Law::TwoGaussianTorque(_)) {
            breakaway
        } else {
            breakaway * load * rig.contact.radius
        };
        let drive = rig.gearbox.ratio * rig.motor.coulomb_torque;
        let torque = if braking > 0.0 {
            braking
        } else {
            drive.max(0.1 * speed)
        };
        let duration = runs
            .iter()
            .filter_map(|run| run.time.last().copied())
            .fold(0.0, f64::max);
        Self {
            speed,
            torque,
            twist: speed + torque,
            acceleration: speed + torque,
            load,
            current: torque / (rig.gearbox.ratio * rig.motor.torque_constant),
            duration,
            resolution,
            coefficient: breakaway,
        }
    }
}
