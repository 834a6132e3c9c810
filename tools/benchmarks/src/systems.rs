//! The three test systems and their numbers: the one place from which every solver takes them.

use std::f64::consts::PI;

use crate::laws::LAWS;

/// Length of every run [s].
pub const END_TIME: f64 = 60.0;
/// Time between two outputs [s].
pub const OUTPUT_STEP: f64 = 0.01;

const DISC_INERTIA: f64 = 0.0149;
const STIFFNESS: f64 = 0.3482;
const DAMPING: f64 = 0.0022;
const PIN_RADIUS: f64 = 0.075;
const ETA: f64 = 8.0;
const MOTOR_INERTIA: f64 = 5.18e-5;
const INDUCTANCE: f64 = 8.437e-4;
const RESISTANCE: f64 = 0.33;
const TORQUE_CONSTANT: f64 = 0.126;
const BACK_EMF_CONSTANT: f64 = 0.0602;
const COULOMB_TORQUE: f64 = 0.1196;
const VISCOUS_DAMPING: f64 = 1.784e-4;

/// Disc D1 of the full rig with its shaft and normal force.
#[derive(Clone, Copy, Debug)]
pub struct FirstDisc {
    /// Moment of inertia [kg m²].
    pub inertia: f64,
    /// Shaft stiffness [N m/rad].
    pub stiffness: f64,
    /// Shaft damping [N m s/rad].
    pub damping: f64,
    /// Normal force [N].
    pub normal_force: f64,
}

/// One initial value problem of the benchmark: from rest, all states zero, 60 s.
#[derive(Clone, Copy, Debug)]
pub struct System {
    /// Short name in tables: `a`, `b`, `c`.
    pub key: &'static str,
    /// What it is, for headings.
    pub title: &'static str,
    /// Law of every disc contact: its name in [`LAWS`].
    pub law: &'static str,
    /// Present in the full rig.
    pub first_disc: Option<FirstDisc>,
    /// Normal force on disc D2 [N].
    pub normal_force: f64,
    /// Reference speed that sets the voltage [rad/s].
    pub speed: f64,
    /// θ2 at 60 s known from elsewhere [rad].
    pub published_theta: Option<f64>,
    /// Ratio to CVODE asked for at an error of 1e-6 rad.
    pub bar: f64,
}

/// The systems (a), (b) and (c), in this order.
#[must_use]
pub fn all() -> [System; 3] {
    [
        System {
            key: "a",
            title: "reduced rig, Stribeck law, 5.76 rad/s, 50 N",
            law: "stribeck",
            first_disc: None,
            normal_force: 50.0,
            speed: 5.76,
            published_theta: Some(325.043_124_442_9),
            bar: 30.0,
        },
        System {
            key: "b",
            title: "reduced rig, two-Gaussian friction coefficient, 55 rpm, 50 N",
            law: "two_gaussian_mu",
            first_disc: None,
            normal_force: 50.0,
            speed: 55.0 * 2.0 * PI / 60.0,
            published_theta: None,
            bar: 10.0,
        },
        System {
            key: "c",
            title: "full rig, Stribeck law on both discs, 40 rpm, 30 N on D1, 20 N on D2",
            law: "stribeck",
            first_disc: Some(FirstDisc {
                inertia: 0.0288,
                stiffness: 2.905,
                damping: 0.0214,
                normal_force: 30.0,
            }),
            normal_force: 20.0,
            speed: 40.0 * 2.0 * PI / 60.0,
            published_theta: None,
            bar: 10.0,
        },
    ]
}

/// Numbers of a law as lines of `model.toml`.
fn law_numbers(law: &str) -> &'static str {
    let row = LAWS.iter().find(|(name, _)| *name == law);
    row.map_or("", |(_, numbers)| numbers)
}

impl System {
    /// Voltage that turns the free motor at the reference speed [V].
    #[must_use]
    pub fn voltage(&self) -> f64 {
        RESISTANCE * (VISCOUS_DAMPING * ETA * self.speed + COULOMB_TORQUE) / TORQUE_CONSTANT
            + BACK_EMF_CONSTANT * ETA * self.speed
    }

    /// Every number under the short name by which the peers know it.
    #[must_use]
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        let mut list = vec![
            ("J2", DISC_INERTIA),
            ("k2", STIFFNESS),
            ("c2", DAMPING),
            ("N2", self.normal_force),
            ("eta", ETA),
            ("Jm", MOTOR_INERTIA),
            ("R", RESISTANCE),
            ("L", INDUCTANCE),
            ("KT", TORQUE_CONSTANT),
            ("KE", BACK_EMF_CONSTANT),
            ("Tfm", COULOMB_TORQUE),
            ("Cm", VISCOUS_DAMPING),
            ("radius", PIN_RADIUS),
            ("u", self.voltage()),
        ];
        for line in law_numbers(self.law).lines() {
            let (key, value) = line.split_once(" = ").unwrap_or_default();
            let value = value.parse().unwrap_or(f64::NAN);
            match key {
                "c1" => list.push(("c1g", value)),
                "c2" => list.push(("c2g", value)),
                "omega_centre" => list.extend([("Vc", value), ("V", value)]),
                "acceleration_semi_axis" => list.push(("A", value)),
                _ => list.push((key, value)),
            }
        }
        if let Some(disc) = self.first_disc {
            list.extend([
                ("J1", disc.inertia),
                ("k1", disc.stiffness),
                ("c1", disc.damping),
                ("N1", disc.normal_force),
            ]);
        }
        list
    }

    /// The same numbers as a `model.toml`.
    #[must_use]
    pub fn model_toml(&self) -> String {
        self.model_with_law(self.law)
    }

    /// The `model.toml` with another of the [`LAWS`] on every disc.
    #[must_use]
    pub fn model_with_law(&self, law: &str) -> String {
        let numbers = law_numbers(law);
        let contact = format!("radius = {PIN_RADIUS:?}\nlaw = \"{law}\"\n{numbers}\n");
        let first_disc = self.first_disc.map_or_else(String::new, |disc| {
            format!(
                "[disc1]\ninertia = {:?}\n[shaft1]\nstiffness = {:?}\ndamping = {:?}\n[contact1]\n{contact}",
                disc.inertia, disc.stiffness, disc.damping
            )
        });
        format!(
            "[disc]\ninertia = {DISC_INERTIA:?}\n\
             [shaft]\nstiffness = {STIFFNESS:?}\ndamping = {DAMPING:?}\n\
             [gearbox]\nratio = {ETA:?}\n\
             [motor]\ninertia = {MOTOR_INERTIA:?}\nresistance = {RESISTANCE:?}\ninductance = {INDUCTANCE:?}\n\
             torque_constant = {TORQUE_CONSTANT:?}\nback_emf_constant = {BACK_EMF_CONSTANT:?}\n\
             coulomb_torque = {COULOMB_TORQUE:?}\nviscous_damping = {VISCOUS_DAMPING:?}\n\
             [contact]\n{contact}{first_disc}"
        )
    }
}
