//! The friction laws of Chapter 3 with the chapter's numbers.

use stickslip::friction::{Coulomb, CoulombStiction, Karnopp, Law, Stribeck, Switch, Wojewoda};

/// Sliding friction of Tables 3.1 to 3.3.
pub const SLIDING: f64 = 0.98;
/// Static friction of Tables 3.1 to 3.3.
pub const STATIC: f64 = 1.47;
/// Shortest phase that counts as sticking: shorter ones are the touch of a grazing contact.
pub const SHORTEST_STICK: f64 = 1e-6;

/// Friction levels and the velocity at which Stribeck's curve falls.
#[derive(Debug, Clone, Copy)]
pub struct Levels {
    /// Sliding level.
    pub sliding: f64,
    /// Static level.
    pub breakaway: f64,
    /// Stribeck velocity.
    pub velocity: f64,
}

impl Levels {
    /// As printed in the tables.
    pub fn printed(velocity: f64) -> Self {
        Self {
            sliding: SLIDING,
            breakaway: STATIC,
            velocity,
        }
    }

    /// Divided by the largest friction force, as Eqs 3-4 and 3-7 say they are.
    pub fn normalised(velocity: f64) -> Self {
        Self {
            sliding: SLIDING / STATIC,
            breakaway: 1.0,
            velocity,
        }
    }

    /// The three laws of the chapter.
    pub fn published(self) -> [(&'static str, Law<f64>); 3] {
        let Self {
            sliding: mu_c,
            breakaway: mu_s,
            velocity: omega_s,
        } = self;
        [
            ("Coulomb", Law::Coulomb(Coulomb { mu_c })),
            (
                "Coulomb with stiction",
                Law::CoulombStiction(CoulombStiction { mu_c, mu_s }),
            ),
            (
                "Stribeck",
                Law::Stribeck(Stribeck {
                    mu_c,
                    mu_s,
                    omega_s,
                }),
            ),
        ]
    }

    /// The further laws of Section 2.5, with a band of zero velocity of a hundredth of `velocity`.
    pub fn others(self) -> [(&'static str, Law<f64>); 3] {
        let Self {
            sliding: mu_c,
            breakaway: mu_s,
            velocity: omega_s,
        } = self;
        let omega_tolerance = 0.01 * omega_s;
        [
            (
                "Karnopp",
                Law::Karnopp(Karnopp {
                    mu_c,
                    mu_s,
                    omega_s,
                    omega_tolerance,
                }),
            ),
            (
                "switch model",
                Law::Switch(Switch {
                    mu_c,
                    mu_s,
                    omega_s,
                    omega_tolerance,
                    decay_rate: 10.0,
                }),
            ),
            (
                "Wojewoda",
                Law::Wojewoda(Wojewoda {
                    mu_c,
                    mu_s,
                    omega_s,
                    stochastic_amplitude: 0.0,
                    correlation_angle: 1.0,
                    seed: 0.0,
                }),
            ),
        ]
    }
}
