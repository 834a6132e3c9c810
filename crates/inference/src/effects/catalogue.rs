//! The effects that are tried.

use super::{Base, Effect, Form};

const fn one(
    name: &'static str,
    key: &'static str,
    origin: f64,
    base: Base,
    positive: bool,
    far: &'static [f64],
) -> Effect {
    Effect {
        name,
        form: Form::One {
            key,
            origin,
            base,
            positive,
            far,
        },
    }
}

const fn polar(
    name: &'static str,
    amplitude: &'static str,
    base: Base,
    orders: &'static [f64],
    far: &'static [f64],
) -> Effect {
    Effect {
        name,
        form: Form::Polar {
            amplitude,
            base,
            orders,
            far,
        },
    }
}

/// All effects, in a fixed order.
pub const EFFECTS: &[Effect] = &[
    one(
        "bearing_friction",
        "torque",
        0.0,
        Base::Torque,
        true,
        &[0.5, 1.5],
    ),
    polar("normal_force_wobble", "amplitude", Base::One, &[], &[0.6]),
    polar("position_friction", "amplitude", Base::One, &[], &[]),
    polar("unbalance", "torque", Base::Torque, &[], &[1.0]),
    one(
        "viscous_drag",
        "coefficient",
        0.0,
        Base::TorqueOverSpeed,
        false,
        &[],
    ),
    one(
        "quadratic_drag",
        "coefficient",
        0.0,
        Base::TorqueOverSpeedSquared,
        false,
        &[],
    ),
    one(
        "shaft_hardening",
        "cubic_stiffness",
        0.0,
        Base::StiffnessOverTwistSquared,
        false,
        &[],
    ),
    Effect {
        name: "shaft_hysteresis",
        form: Form::Relaxation,
    },
    one("backlash", "gap", 0.0, Base::Twist, true, &[0.5, 1.5]),
    polar(
        "gear_ripple",
        "torque",
        Base::MotorTorque,
        &[1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 24.0],
        &[],
    ),
    one(
        "motor_viscous",
        "coefficient",
        0.0,
        Base::MotorTorqueOverSpeed,
        false,
        &[],
    ),
    one("supply_sag", "factor", 1.0, Base::One, false, &[]),
    one(
        "resistance_drift",
        "rate_per_minute",
        0.0,
        Base::PerDuration,
        false,
        &[],
    ),
    one("load_cell_bias", "bias", 0.0, Base::Load, false, &[]),
    one(
        "friction_wear",
        "rate_per_minute",
        0.0,
        Base::PerDuration,
        false,
        &[],
    ),
    Effect {
        name: "load_exponent",
        form: Form::Exponent,
    },
    one("sensor_delay", "delay", 0.0, Base::Time, true, &[]),
    Effect {
        name: "presliding",
        form: Form::Bristles,
    },
    Effect {
        name: "stiction",
        form: Form::Stiction,
    },
    Effect {
        name: "stribeck",
        form: Form::Stribeck,
    },
    Effect {
        name: "acceleration_hysteresis",
        form: Form::Hysteresis,
    },
    one(
        "bearing_friction1",
        "torque",
        0.0,
        Base::Torque,
        true,
        &[0.5, 1.5],
    ),
    polar("unbalance1", "torque", Base::Torque, &[], &[1.0]),
    one(
        "viscous_drag1",
        "coefficient",
        0.0,
        Base::TorqueOverSpeed,
        false,
        &[],
    ),
    one(
        "quadratic_drag1",
        "coefficient",
        0.0,
        Base::TorqueOverSpeedSquared,
        false,
        &[],
    ),
    polar("normal_force_wobble1", "amplitude", Base::One, &[], &[0.6]),
    one(
        "shaft_hardening1",
        "cubic_stiffness",
        0.0,
        Base::Shaft1StiffnessOverTwistSquared,
        false,
        &[],
    ),
];
