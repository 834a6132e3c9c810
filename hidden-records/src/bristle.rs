//! Bristle friction: sticking is a very stiff spring, never a constraint.
//!
//! LuGre (Canudas de Wit et al. 1995) with an elastic range (Dupont et al. 2002):
//! dz/dt = ω while |z| < 0.998 z_ss, else ω − |ω| z / z_ss, with z_ss = δ·level/breakaway, and
//! T = stiffness·z + damping·dz/dt. δ is the deflection at breakaway, far below an encoder step,
//! so the records cannot show it.

use libm::exp;

/// Speed above which a stiff bristle no longer damps [rad/s].
const DAMPED_SPEED: f64 = 0.02;
/// The same of one that is soft enough to be seen: faster than it ever rings [rad/s].
const SOFT_DAMPED_SPEED: f64 = 5.0;
/// Share of critical damping of a stuck bristle [-].
const DAMPING_RATIO: f64 = 0.7;

/// Share of the steady deflection up to which bristles only bend. Without it a stuck contact
/// creeps under load and breaks away percents early.
const ELASTIC_SHARE: f64 = 0.998;

/// One contact seen as bristles between an inertia and the ground.
#[derive(Debug, Clone, Copy)]
pub struct Bristle {
    deflection: f64,
    breakaway_deflection: f64,
    damped_speed: f64,
}

impl Bristle {
    /// An unloaded bristle that breaks away at `breakaway_deflection` [rad] > 0.
    pub fn new(breakaway_deflection: f64) -> Self {
        Self {
            deflection: 0.0,
            breakaway_deflection,
            damped_speed: DAMPED_SPEED,
        }
    }

    /// The same bristle, so soft that it breaks away at `breakaway_deflection` [rad] > 0 now.
    pub fn soften(&mut self, breakaway_deflection: f64) {
        self.breakaway_deflection = breakaway_deflection;
        self.damped_speed = SOFT_DAMPED_SPEED;
    }

    /// Advances by `step` [s] at `velocity` [rad/s] and returns the torque opposing a positive
    /// velocity [N m].
    ///
    /// `breakaway` and `level` are the torques [N m] the contact bears at rest and in steady
    /// sliding now; `inertia` [kg m²] is what the bristle holds, for its damping. Implicit in the
    /// deflection, so a stiff bristle needs no smaller step.
    pub fn advance(
        &mut self,
        step: f64,
        velocity: f64,
        breakaway: f64,
        level: f64,
        inertia: f64,
    ) -> f64 {
        if breakaway <= 0.0 || level <= 0.0 {
            self.deflection = 0.0;
            return 0.0;
        }
        let steady = self.breakaway_deflection * level / breakaway;
        let before = self.deflection;
        let elastic_only = before + step * velocity;
        self.deflection = if elastic_only.abs() < ELASTIC_SHARE * steady {
            elastic_only
        } else {
            elastic_only / (1.0 + step * velocity.abs() / steady)
        };
        let stiffness = breakaway / self.breakaway_deflection;
        let elastic = stiffness * self.deflection;
        let speed_ratio = velocity / self.damped_speed;
        if speed_ratio.abs() > 5.0 {
            return elastic;
        }
        let damping = 2.0 * DAMPING_RATIO * libm::sqrt(stiffness * inertia);
        let rate = (self.deflection - before) / step;
        elastic + damping * exp(-speed_ratio * speed_ratio) * rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steady_sliding_gives_the_level_with_the_sign_of_velocity() {
        for velocity in [-3.0, 0.5, 12.0] {
            let mut bristle = Bristle::new(4e-5);
            let mut torque = 0.0;
            for _ in 0..2000 {
                torque = bristle.advance(1e-5, velocity, 1.0, 0.6, 0.015);
            }
            assert!((torque - 0.6 * f64::signum(velocity)).abs() < 1e-9);
        }
    }

    #[test]
    fn an_unloaded_contact_bears_nothing() {
        assert_eq!(Bristle::new(4e-5).advance(1e-5, 1.0, 0.0, 0.0, 0.015), 0.0);
    }
}
