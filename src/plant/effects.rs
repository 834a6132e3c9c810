//! Physical effects beyond the nominal rig, each a section of `model.toml`; absent means off.

use crate::parameter::{BUILT_IN, ParameterInfo, Range, Section, section};
use crate::series::Scalar;

section! {
    /// Dry friction of the disc's bearings, present without any normal force:
    /// a torque T sign(ω2), with stiction at the same level.
    pub struct BearingFriction {
        /// Coulomb torque of the bearings
        torque: "N.m", Range::NonNegative;
    }
}

section! {
    /// A disc that runs out of true: the pin's force is N2 (1 + a cos(θ2 − φ)) while the load cell
    /// gives the mean.
    pub struct NormalForceWobble {
        /// Relative amplitude a of the normal force's variation
        amplitude: "1", Range::Between(0.0, 1.0);
        /// Disc angle φ at which the normal force is largest
        phase: "rad", Range::Finite;
    }
}

section! {
    /// A friction surface that differs around the disc, twice per turn: friction × (1 + a cos(2 θ2 − φ)).
    pub struct PositionFriction {
        /// Relative amplitude a of the friction's variation
        amplitude: "1", Range::Between(0.0, 1.0);
        /// Phase φ of the variation
        phase: "rad", Range::Finite;
    }
}

section! {
    /// A disc whose centre of mass is off the axis: torque −T cos(θ2 − φ).
    pub struct Unbalance {
        /// Largest gravity torque T
        torque: "N.m", Range::NonNegative;
        /// Disc angle φ at which it is largest against the motion
        phase: "rad", Range::Finite;
    }
}

section! {
    /// Viscous drag on the disc: torque −b ω2.
    pub struct ViscousDrag {
        /// Drag coefficient b
        coefficient: "N.m.s/rad", Range::Finite;
    }
}

section! {
    /// Aerodynamic drag on the disc: torque −q ω2 |ω2|.
    pub struct QuadraticDrag {
        /// Drag coefficient q
        coefficient: "N.m.s2/rad2", Range::Finite;
    }
}

section! {
    /// A shaft that stiffens with its twist: extra torque k3 (θ2 − θ3)³; play
    /// in the coupling does not count as twist.
    pub struct ShaftHardening {
        /// Cubic stiffness k3
        cubic_stiffness: "N.m/rad3", Range::Finite;
    }
}

section! {
    /// Internal friction of the shaft: a spring in series with a damper beside the shaft,
    /// dw/dt = k_h d(θ2 − θ3)/dt − w/τ (standard linear solid; Zener 1948).
    pub struct ShaftHysteresis {
        /// Stiffness k_h of the relaxing part
        stiffness: "N.m/rad", Range::NonNegative;
        /// Relaxation time τ
        relaxation_time: "s", Range::Positive;
    }
}

section! {
    /// Play in the shaft's coupling: no torque within a dead band.
    pub struct Backlash {
        /// Full width of the dead band
        gap: "rad", Range::NonNegative, BUILT_IN;
    }
}

section! {
    /// Torque ripple of the motor or the gears: extra motor torque T sin(n θm + φ).
    pub struct GearRipple {
        /// Amplitude T, on the motor's side
        torque: "N.m", Range::Finite;
        /// Cycles n per turn of the motor
        order: "1", Range::Positive, BUILT_IN;
        /// Phase φ
        phase: "rad", Range::Finite;
    }
}

section! {
    /// Viscous friction of the motor beyond the nominal one, on the motor's side.
    pub struct MotorViscous {
        /// Extra viscous damping
        coefficient: "N.m.s/rad", Range::Finite;
    }
}

section! {
    /// A supply that sags: the motor sees `factor` × u.
    pub struct SupplySag {
        /// Voltage at the motor over commanded voltage
        factor: "1", Range::NonNegative;
    }
}

section! {
    /// An armature that warms up: R (1 + r t/60 s).
    pub struct ResistanceDrift {
        /// Relative change r of the resistance per minute
        rate_per_minute: "1", Range::Finite;
    }
}

section! {
    /// A load cell with an offset: reading = true N2 + bias while the pin touches; a lifted pin reads
    /// zero.
    pub struct LoadCellBias {
        /// Reading minus true normal force
        bias: "N", Range::Finite;
    }
}

section! {
    /// A contact that wears: friction × (1 + w t/60 s).
    pub struct FrictionWear {
        /// Relative change w of the friction per minute
        rate_per_minute: "1", Range::Finite;
    }
}

section! {
    /// Friction that is not proportional to the normal force: ∝ 50 N (N2/50 N)^p.
    pub struct LoadExponent {
        /// Exponent p
        exponent: "1", Range::Positive;
    }
}

section! {
    /// Friction that fluctuates at random in time: friction × (1 + s ξ(t)), ξ a seeded random
    /// function of zero mean and unit variance that never exceeds 4.9, so that friction stays friction
    /// up to s = 0.2.
    pub struct StochasticFriction {
        /// Relative standard deviation s
        standard_deviation: "1", Range::Between(0.0, 0.2);
        /// Time over which the fluctuation stays correlated
        correlation_time: "s", Range::Positive;
        /// Number of the random function: the same seed gives the same fluctuation
        seed: "1", Range::NonNegative, BUILT_IN;
    }
}

section! {
    /// Disc sensors that lag: what is read is the angle and velocity `delay` earlier.
    pub struct SensorDelay {
        /// Lag of the disc's channels
        delay: "s", Range::Between(0.0, 1.0), BUILT_IN;
    }
}

section! {
    /// Bristles of a sticking pin: it gives way like a spring with a damper, T = σ0 z + σ1 dz/dt, until
    /// T reaches the breakaway torque (Dahl 1968; Dupont, Hayward, Armstrong and Altpeter 2002).
    pub struct Presliding {
        /// Stiffness σ0 of the bristles
        stiffness: "N.m/rad", Range::Positive;
        /// Damping σ1 of the bristles
        damping: "N.m.s/rad", Range::NonNegative;
    }
}

/// How an effect comes into the motion.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Acts {
    /// By another number of the rig, its load or its voltage, or on what is read alone: the recurrences stay those of the plain rig.
    ByNumbers,
    /// By series of its own beside the rig's.
    BySeries,
}

macro_rules! effects {
    (
        $(#[$doc:meta])*
        $effects:ident
        $(#[$names_doc:meta])*
        $names:ident
        $( $field:ident : $kind:ident, $acts:ident; )*
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $effects<S> {
            $(
                #[doc = concat!("Section `[", stringify!($field), "]`.")]
                pub $field: Option<$kind<S>>,
            )*
        }

        $(#[$names_doc])*
        pub const $names: &[&str] = &[$( stringify!($field), )*];

        impl<S> Default for $effects<S> {
            fn default() -> Self {
                Self { $( $field: None, )* }
            }
        }

        impl<S: Scalar> $effects<S> {
            /// Switches the effect `name` on with the values that `value` gives; `None` if there is
            /// no such effect.
            pub fn insert<E>(
                &mut self,
                name: &str,
                value: impl FnMut(&'static ParameterInfo) -> Result<S, E>,
            ) -> Option<Result<(), E>> {
                match name {
                    $( stringify!($field) => Some($kind::from_values(value).map(|effect| {
                        self.$field = Some(effect);
                    })), )*
                    _ => None,
                }
            }

            /// Parameters of the effect `name`, on or off; `None` if there is no such effect.
            pub fn infos(name: &str) -> Option<&'static [ParameterInfo]> {
                match name {
                    $( stringify!($field) => Some($kind::<S>::INFOS), )*
                    _ => None,
                }
            }

            /// Switches the effect `name` off; whether it was on.
            pub fn remove(&mut self, name: &str) -> bool {
                match name {
                    $( stringify!($field) => self.$field.take().is_some(), )*
                    _ => false,
                }
            }

            /// The effects that are on, by name, in a fixed order.
            pub fn active(&self) -> Vec<(&'static str, &dyn Section<S>)> {
                let mut sections: Vec<(&'static str, &dyn Section<S>)> = Vec::new();
                $( if let Some(effect) = &self.$field {
                    sections.push((stringify!($field), effect));
                } )*
                sections
            }

            /// Whether any effect that is on needs series of its own beside the rig's.
            pub(super) fn need_series(&self) -> bool {
                false $( || (Acts::$acts == Acts::BySeries && self.$field.is_some()) )*
            }

            /// The effects that are on, by name, to be changed.
            pub fn active_mut(&mut self) -> Vec<(&'static str, &mut dyn Section<S>)> {
                let mut sections: Vec<(&'static str, &mut dyn Section<S>)> = Vec::new();
                $( if let Some(effect) = &mut self.$field {
                    sections.push((stringify!($field), effect));
                } )*
                sections
            }

            /// The same effects over another kind of number.
            pub fn to_scalar<T: Scalar>(&self) -> $effects<T> {
                $effects { $( $field: self.$field.map(|effect| effect.to_scalar()), )* }
            }
        }
    };
}

effects! {
    /// The effects that are switched on.
    Effects
    /// Names of all effects, as `model.toml` spells their sections.
    EFFECT_NAMES
    bearing_friction: BearingFriction, ByNumbers;
    normal_force_wobble: NormalForceWobble, BySeries;
    position_friction: PositionFriction, BySeries;
    unbalance: Unbalance, BySeries;
    viscous_drag: ViscousDrag, BySeries;
    quadratic_drag: QuadraticDrag, BySeries;
    shaft_hardening: ShaftHardening, BySeries;
    shaft_hysteresis: ShaftHysteresis, BySeries;
    backlash: Backlash, BySeries;
    gear_ripple: GearRipple, BySeries;
    motor_viscous: MotorViscous, ByNumbers;
    supply_sag: SupplySag, ByNumbers;
    resistance_drift: ResistanceDrift, BySeries;
    load_cell_bias: LoadCellBias, ByNumbers;
    friction_wear: FrictionWear, ByNumbers;
    load_exponent: LoadExponent, ByNumbers;
    presliding: Presliding, BySeries;
    stochastic_friction: StochasticFriction, BySeries;
    sensor_delay: SensorDelay, ByNumbers;
}

effects! {
    /// The effects on disc D1 of the full rig that are switched on; their equations are those on disc D2, with θ1, ω1, N1
    /// and the twist θ1 − θ2 of shaft 1.
    Disc1Effects
    /// Names of the effects on disc D1, as `model.toml` spells their sections.
    DISC1_EFFECT_NAMES
    bearing_friction1: BearingFriction, BySeries;
    unbalance1: Unbalance, BySeries;
    viscous_drag1: ViscousDrag, BySeries;
    quadratic_drag1: QuadraticDrag, BySeries;
    normal_force_wobble1: NormalForceWobble, BySeries;
    shaft_hardening1: ShaftHardening, BySeries;
}

/// Parameters of the effect `name` on either disc; `None` if there is no such effect.
pub fn effect_infos(name: &str) -> Option<&'static [ParameterInfo]> {
    Effects::<f64>::infos(name).or_else(|| Disc1Effects::<f64>::infos(name))
}
