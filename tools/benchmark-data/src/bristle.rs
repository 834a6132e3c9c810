//! Bristle friction: sticking is a very stiff spring, never a constraint.
//!
//! LuGre (Canudas de Wit et al. 1995) with an elastic range (Dupont et al. 2002):
//! dz/dt = ω while |z| < 0.998 z_ss (the elastic share), else ω − |ω| z / z_ss, with z_ss = δ·level/breakaway, and
//! T = stiffness·z + damping·dz/dt. δ is the deflection at breakaway, far below an encoder step,
//! so the records cannot show it.

use crate::numerics::Bristles;
use libm::exp;

/// Share of critical damping of a stuck bristle [-].
const DAMPING_RATIO: f64 = 0.7;

/// One contact seen as bristles between an inertia and the ground.
#[derive(Debug, Clone, Copy)]
pub struct Bristle {
    deflection: f64,
    breakaway_deflection: f64,
    elastic_share: f64,
    damped_speed: f64,
    soft_damped_speed: f64,
    /// Deflection that would bear all that the bristle bore last, its damping too [rad].
    borne: f64,
}

impl Bristle {
    /// An unloaded bristle of these scales.
    pub fn new(scales: Bristles) -> Self {
        Self {
            deflection: 0.0,
            breakaway_deflection: scales.deflection,
            elastic_share: scales.elastic_share,
            damped_speed: scales.damped_speed,
            soft_damped_speed: scales.soft_damped_speed,
            borne: 0.0,
        }
    }

    /// The same bristle, so soft that it breaks away at `breakaway_deflection` [rad] > 0 now.
    pub fn soften(&mut self, breakaway_deflection: f64) {
        self.breakaway_deflection = breakaway_deflection;
        self.damped_speed = self.soft_damped_speed;
    }

    /// The direction in which the bristle bears as much as it can before it slips; `None`: less.
    pub fn gives_way(&self) -> Option<f64> {
        let limit = self.elastic_share * self.breakaway_deflection;
        (self.borne.abs() >= limit).then(|| self.borne.signum())
    }

    /// Lets the bristle slip back to `share` of its deflection at breakaway.
    pub fn slip_to(&mut self, share: f64) {
        let limit = share * self.breakaway_deflection;
        self.deflection = self.deflection.clamp(-limit, limit);
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
            self.borne = 0.0;
            return 0.0;
        }
        let steady = self.breakaway_deflection * level / breakaway;
        let before = self.deflection;
        let elastic_only = before + step * velocity;
        self.deflection = if elastic_only.abs() < self.elastic_share * steady {
            elastic_only
        } else {
            elastic_only / (1.0 + step * velocity.abs() / steady)
        };
        let stiffness = breakaway / self.breakaway_deflection;
        let elastic = stiffness * self.deflection;
        let speed_ratio = velocity / self.damped_speed;
        self.borne = self.deflection;
        if speed_ratio.abs() > 5.0 {
            return elastic;
        }
        let damping = 2.0 * DAMPING_RATIO * libm::sqrt(stiffness * inertia);
        let rate = (self.deflection - before) / step;
        let torque = elastic + damping * exp(-speed_ratio * speed_ratio) * rate;
        self.borne = torque / stiffness;
        torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALES: Bristles = Bristles {
        deflection: 4e-5,
        ..Bristles::DISSERTATION
    };

    #[test]
    fn steady_sliding_gives_the_level_with_the_sign_of_velocity() {
        for velocity in [-3.0, 0.5, 12.0] {
            let mut bristle = Bristle::new(SCALES);
            let mut torque = 0.0;
            for _ in 0..2000 {
                torque = bristle.advance(1e-5, velocity, 1.0, 0.6, 0.015);
            }
            assert!((torque - 0.6 * f64::signum(velocity)).abs() < 1e-9);
        }
    }

    #[test]
    fn an_unloaded_contact_bears_nothing() {
        assert_eq!(
            Bristle::new(SCALES).advance(1e-5, 1.0, 0.0, 0.0, 0.015),
            0.0
        );
    }
}
