//! The friction torque as two Gaussians of the phase-plane angle (Eq. 6-1; Pires 2019).

use super::two_gaussian::TwoGaussian;
use crate::parameter::{Range, section};

section! {
    /// Friction torque T(α) = a1 exp(−((α−b1)/c1)²) + a2 exp(−((α−b2)/c2)²), whatever the normal force
    /// is; breakaway at the larger of its values at α = ±π.
    pub struct TwoGaussianTorque {
        /// Height of the first Gaussian of the friction torque
        a1: "N.m", Range::Finite;
        /// Angle at which the first Gaussian peaks
        b1: "rad", Range::Finite;
        /// Width of the first Gaussian
        c1: "rad", Range::Positive;
        /// Height of the second Gaussian of the friction torque
        a2: "N.m", Range::Finite;
        /// Angle at which the second Gaussian peaks
        b2: "rad", Range::Finite;
        /// Width of the second Gaussian
        c2: "rad", Range::Positive;
        /// Slip velocity at the centre of the phase-plane ellipse, and its velocity semi-axis
        omega_centre: "rad/s", Range::Positive;
        /// Acceleration semi-axis of the phase-plane ellipse
        acceleration_semi_axis: "rad/s2", Range::Positive;
    }
}

impl<S: Copy> TwoGaussianTorque<S> {
    /// The two Gaussians and the ellipse.
    pub fn shape(&self) -> TwoGaussian<S> {
        TwoGaussian {
            heights: [self.a1, self.a2],
            peaks: [self.b1, self.b2],
            widths: [self.c1, self.c2],
            omega_centre: self.omega_centre,
            acceleration_semi_axis: self.acceleration_semi_axis,
        }
    }
}
