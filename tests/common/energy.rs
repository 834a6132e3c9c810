//! The energy balance of a run, as a judge of its numbers.

use stickslip::integrator::Simulation;
use stickslip::plant::{Rig, RigState, index::*};
use stickslip::series::evaluate;

/// Nodes and weights of Gauss-Legendre quadrature with eight points on \[−1, 1\].
pub const GAUSS: [(f64, f64); 8] = [
    (-0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
    (-0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (-0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (-0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

/// Energy in the rig's inertias, inductance and shafts [J].
fn stored_energy(rig: &Rig<f64>, x: &RigState<f64>) -> f64 {
    let motor_inertia = rig.gearbox.ratio.powi(2) * rig.motor.inertia;
    let mut energy = 0.5 * rig.disc.inertia * x[OMEGA].powi(2)
        + 0.5 * motor_inertia * x[OMEGA3].powi(2)
        + 0.5 * rig.motor.inductance * x[CURRENT].powi(2)
        + 0.5 * rig.shaft.stiffness * (x[THETA] - x[THETA3]).powi(2);
    if let Some(disc1) = &rig.disc1 {
        energy += 0.5 * disc1.disc.inertia * x[OMEGA1].powi(2)
            + 0.5 * disc1.shaft.stiffness * (x[THETA1] - x[THETA]).powi(2);
    }
    energy
}

/// Power that flows in, minus all that is lost [W]. The torque constant and the back-EMF constant of
/// the published motor differ, so that its conversion adds a term of its own.
fn net_power(rig: &Rig<f64>, voltage: f64, x: &RigState<f64>, torques: [f64; 3]) -> f64 {
    let (motor, ratio) = (&rig.motor, rig.gearbox.ratio);
    let mut power = voltage * x[CURRENT] - motor.resistance * x[CURRENT].powi(2)
        + (motor.torque_constant - motor.back_emf_constant) * ratio * x[OMEGA3] * x[CURRENT]
        - motor.viscous_damping * (ratio * x[OMEGA3]).powi(2)
        - rig.shaft.damping * (x[OMEGA] - x[OMEGA3]).powi(2)
        - torques[0] * x[OMEGA]
        - torques[2] * x[OMEGA3];
    if let Some(disc1) = &rig.disc1 {
        power -= disc1.shaft.damping * (x[OMEGA1] - x[OMEGA]).powi(2) + torques[1] * x[OMEGA1];
    }
    power
}

/// Friction torques on D2, D1 and in the motor at local time `tau` of the segment.
pub fn torques(run: &Simulation<f64, Rig<f64>>, tau: f64) -> [f64; 3] {
    let jet = run.jet();
    [
        evaluate(jet.friction_torque(), tau),
        jet.friction_torque_1().map_or(0.0, |t| evaluate(t, tau)),
        evaluate(jet.motor_friction_torque(), tau),
    ]
}

/// Energies of a run since its start [J].
pub struct EnergyBalance {
    time: f64,
    stored_at_start: f64,
    supplied: f64,
    turned_over: f64,
}

impl EnergyBalance {
    /// For a run that has just started.
    pub fn new(run: &Simulation<f64, Rig<f64>>) -> Self {
        let time = run.segment_start();
        let stored_at_start = stored_energy(run.system(), &run.state_at(time));
        Self {
            time,
            stored_at_start,
            supplied: 0.0,
            turned_over: stored_at_start,
        }
    }

    /// Runs on to `until` [s] under the inputs in force, which must be held.
    pub fn advance(&mut self, run: &mut Simulation<f64, Rig<f64>>, until: f64) {
        let voltage = run.inputs().voltage[0];
        while self.time < until {
            if run.segment_end() <= self.time {
                run.next_segment().unwrap();
            }
            let (start, from) = (run.segment_start(), self.time);
            let to = run.segment_end().min(until);
            for (node, weight) in GAUSS {
                let time = from + 0.5 * (to - from) * (1.0 + node);
                let x = run.state_at(time);
                let share = 0.5 * (to - from) * weight;
                let torques = torques(run, time - start);
                self.supplied += share * net_power(run.system(), voltage, &x, torques);
                self.turned_over += share * (voltage * x[CURRENT]).abs();
            }
            self.time = to;
        }
    }

    /// What is missing, as a share of the energy that went in or was there.
    pub fn error(&self, run: &Simulation<f64, Rig<f64>>) -> f64 {
        let stored = stored_energy(run.system(), &run.state_at(self.time));
        (self.supplied - (stored - self.stored_at_start)).abs() / self.turned_over
    }
}
