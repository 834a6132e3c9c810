//! The three test systems and their numbers: the one place from which every solver takes them.

use std::f64::consts::PI;

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

/// Friction law of the disc contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Equation (2-3): coefficients of sliding and breakaway, decay velocity [rad/s].
    Stribeck { mu_c: f64, mu_s: f64, omega_s: f64 },
    /// Equation (6-2): the friction coefficient as two Gaussians of the phase-plane angle.
    TwoGaussian {
        a: [f64; 2],
        b: [f64; 2],
        c: [f64; 2],
        omega_centre: f64,
        acceleration_semi_axis: f64,
    },
}

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
    /// Law of every disc contact.
    pub law: Law,
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

const STRIBECK: Law = Law::Stribeck {
    mu_c: 0.12,
    mu_s: 0.20,
    omega_s: 1.2,
};

/// The systems (a), (b) and (c), in this order.
#[must_use]
pub fn all() -> [System; 3] {
    [
        System {
            key: "a",
            title: "reduced rig, Stribeck law, 5.76 rad/s, 50 N",
            law: STRIBECK,
            first_disc: None,
            normal_force: 50.0,
            speed: 5.76,
            published_theta: Some(325.043_124_442_9),
            bar: 30.0,
        },
        System {
            key: "b",
            title: "reduced rig, two-Gaussian friction coefficient, 55 rpm, 50 N",
            law: Law::TwoGaussian {
                a: [0.27115, 0.18567],
                b: [-3.07246, 0.47960],
                c: [1.28946, 2.62303],
                omega_centre: 7.15956,
                acceleration_semi_axis: 58.2873,
            },
            first_disc: None,
            normal_force: 50.0,
            speed: 55.0 * 2.0 * PI / 60.0,
            published_theta: None,
            bar: 10.0,
        },
        System {
            key: "c",
            title: "full rig, Stribeck law on both discs, 40 rpm, 30 N on D1, 20 N on D2",
            law: STRIBECK,
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
        match self.law {
            Law::Stribeck {
                mu_c,
                mu_s,
                omega_s,
            } => {
                list.extend([("mu_c", mu_c), ("mu_s", mu_s), ("omega_s", omega_s)]);
            }
            Law::TwoGaussian {
                a,
                b,
                c,
                omega_centre,
                acceleration_semi_axis,
            } => list.extend([
                ("a1", a[0]),
                ("b1", b[0]),
                ("c1g", c[0]),
                ("a2", a[1]),
                ("b2", b[1]),
                ("c2g", c[1]),
                ("Vc", omega_centre),
                ("V", omega_centre),
                ("A", acceleration_semi_axis),
            ]),
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
        self.model_with_law(&self.law_toml())
    }

    fn law_toml(&self) -> String {
        match self.law {
            Law::Stribeck {
                mu_c,
                mu_s,
                omega_s,
            } => {
                format!(
                    "law = \"stribeck\"\nmu_c = {mu_c:?}\nmu_s = {mu_s:?}\nomega_s = {omega_s:?}\n"
                )
            }
            Law::TwoGaussian {
                a,
                b,
                c,
                omega_centre,
                acceleration_semi_axis,
            } => format!(
                "law = \"two_gaussian_mu\"\na1 = {:?}\nb1 = {:?}\nc1 = {:?}\na2 = {:?}\nb2 = {:?}\nc2 = {:?}\n\
                 omega_centre = {omega_centre:?}\nacceleration_semi_axis = {acceleration_semi_axis:?}\n",
                a[0], b[0], c[0], a[1], b[1], c[1]
            ),
        }
    }

    /// The `model.toml` with another law, given as its lines in `[contact]`, on every disc.
    #[must_use]
    pub fn model_with_law(&self, law: &str) -> String {
        let contact = format!("radius = {PIN_RADIUS:?}\n{law}");
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
