//! Derivatives of a segment: the variational equations along a motion that is computed without them.
//!
//! The series of the motion itself come from the same recurrences as in a plain run, to the last bit.
//! A derivative y of the state obeys equations that are linear in y, dy/dt = A y + b dT/dω y_ω + r,
//! where r collects what a parameter does while the state is held. With the friction's exponential
//! e along the motion known, d e = e dq takes one product of series, where dual numbers in the
//! recurrence of e take two and carry every product of the linear part twice.
//!
//! Rigs with effects, moving loads and laws with branches take the recurrences over dual numbers.

use super::expansion::PinJet;
use super::index::{CURRENT, OMEGA, OMEGA1, OMEGA3, THETA, THETA1, THETA3};
use super::linear_parts::LinearParts;
use super::{INPUT_TERMS, Rig, RigInputs, RigJet, RigMode, RigState};
use crate::friction::{ContactMode, ExponentialCurve, Law, Regime};
use crate::integrator::step_from_last_terms;
use crate::series::{RECIPROCAL, Scalar, Series, TERMS};

/// Lowest order that is worth two sets of series.
pub(super) const LOWEST_ORDER: usize = 4;

/// Relative accuracy wanted of the derivatives in one segment. With less of it than the motion has, fewer
/// orders do, and derivatives count as free of transients about where the motion does.
pub(super) const ACCURACY: f64 = 1e-9;

/// The motion without derivatives, and the coefficients of the equations with theirs.
#[derive(Clone, Debug)]
pub(super) struct Tangent<S> {
    pub rig: Rig<f64>,
    pub jet: RigJet<f64>,
    pub rates: Rates<S>,
    /// Tolerance of the run as far as it is known: zero at first.
    pub tolerance: f64,
    /// Orders by which a second pass on the slow manifold may fall short of the motion's.
    pub spared: usize,
}

/// Coefficients of the accelerations and of di/dt.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rates<S> {
    /// k2/J2, c2/J2, 1/J2.
    pub disc: [S; 3],
    /// k1/J2, c1/J2: what D1 does to D2.
    pub from_disc1: [S; 2],
    /// k1/J1, c1/J1, 1/J1.
    pub disc1: [S; 3],
    /// k2, c2, η K_T, η² C_m, 1, each over η² J_m.
    pub motor: [S; 5],
    /// 1/L, R/L, η K_E/L.
    pub circuit: [S; 3],
}

impl<S: Scalar> Rates<S> {
    fn new(parts: &LinearParts<S>) -> Self {
        let (disc, disc1) = (parts.inverse_inertia, parts.inverse_inertia_1);
        let (motor, circuit) = (parts.inverse_motor_inertia, parts.inverse_inductance);
        Self {
            disc: [parts.stiffness * disc, parts.damping * disc, disc],
            from_disc1: [parts.stiffness_1 * disc, parts.damping_1 * disc],
            disc1: [parts.stiffness_1 * disc1, parts.damping_1 * disc1, disc1],
            motor: [
                parts.stiffness * motor,
                parts.damping * motor,
                parts.current_to_torque * motor,
                parts.motor_damping * motor,
                motor,
            ],
            circuit: [
                circuit,
                parts.resistance * circuit,
                parts.back_emf * circuit,
            ],
        }
    }
}

impl<S: Scalar> Tangent<S> {
    /// The plain counterpart of `rig`, whose effects must not act on the motion.
    pub fn new(rig: &Rig<S>, parts: &LinearParts<S>) -> Self {
        let plain = rig.lift();
        Self {
            jet: RigJet::new(&plain),
            rig: plain,
            rates: Rates::new(parts),
            tolerance: 0.0,
            spared: 0,
        }
    }

    /// Notes the tolerance of the run.
    pub fn set_tolerance(&mut self, tolerance: f64, order: usize) {
        if tolerance != self.tolerance {
            self.tolerance = tolerance;
            // The terms fall to the tolerance at the last order, about evenly from one to the next.
            let ratio = libm::log(ACCURACY / tolerance) / libm::log(1.0 / tolerance);
            self.spared = (order as f64 * ratio.clamp(0.0, 1.0)) as usize;
        }
    }

    /// Number of the last order, up to `order`, whose derivatives tell in the segment just expanded, if
    /// they are as free of transients as the motion.
    pub fn orders(&self, order: usize) -> usize {
        if self.tolerance == 0.0 {
            return order;
        }
        let mut sizes = [0.0_f64; TERMS];
        for index in [OMEGA, OMEGA3, CURRENT, OMEGA1] {
            let series = &self.jet.states[index];
            let unit = 1.0 / (1.0 + series[0].abs());
            for (size, c) in sizes.iter_mut().zip(&series[..=order]) {
                *size = size.max(c.abs() * unit);
            }
        }
        let (last, before) = (sizes[order], sizes[order - 1]);
        let scale = 1.0 / self.tolerance;
        let step = step_from_last_terms(last * scale, before * scale, order).min(1.0);
        let (mut power, mut wanted) = (1.0, LOWEST_ORDER);
        for (k, size) in sizes[..=order].iter().enumerate() {
            // A derivative of (t/T)^k by T is k times as large.
            if size * power * k as f64 > ACCURACY {
                wanted = wanted.max(k);
            }
            power *= step;
        }
        wanted
    }

    /// Puts the orders beyond `top` into `jet`, where the derivatives no longer tell.
    pub fn beyond(&self, top: usize, order: usize, jet: &mut RigJet<S>) {
        let plain = &self.jet;
        for k in top + 1..=order {
            for (series, plain) in jet.states.iter_mut().zip(&plain.states) {
                series[k] = S::constant(plain[k]);
            }
            jet.motor_torque[k] = S::constant(plain.motor_torque[k]);
            jet.disc.rest(k, &plain.disc);
            if let (Some(plain), Some(pin)) = (&plain.disc1, jet.disc1.as_mut()) {
                pin.rest(k, plain);
            }
        }
    }
}

/// What a pin contact does to the derivatives in the course of a segment.
pub(super) enum PinTangent<S> {
    /// It slips by an exponential curve.
    OnCurve {
        /// Load [N m] with the sign of sliding.
        load: S,
        curve: ExponentialCurve<S>,
        sign: f64,
    },
    /// Its torque is constant.
    Constant { torque: S, breakaway: S },
    /// It sticks.
    Stuck { decay: S, breakaway: S },
}

impl<S: Scalar> PinTangent<S> {
    /// `None` for a contact that has to be followed in dual numbers.
    pub fn new(mode: ContactMode, law: &Law<S>, pin: &PinJet<S>) -> Option<Self> {
        if !pin.load_is_constant {
            return None;
        }
        let load = pin.load[0];
        match mode {
            ContactMode::Stuck => Some(Self::Stuck {
                decay: law.band().1,
                breakaway: load * law.breakaway(),
            }),
            ContactMode::Breaking(direction) => {
                let breakaway = load * law.breakaway();
                Some(Self::Constant {
                    torque: breakaway * direction.sign(),
                    breakaway,
                })
            }
            ContactMode::Slipping(direction, Regime::Free) => {
                let sign = direction.sign();
                match (law, law.exponential_curve()) {
                    (Law::Coulomb(_) | Law::CoulombStiction(_), _) => Some(Self::Constant {
                        torque: load * law.sliding() * sign,
                        breakaway: S::ZERO,
                    }),
                    (_, Some(curve)) if curve.span.value() != 0.0 => Some(Self::OnCurve {
                        load: load * sign,
                        curve,
                        sign,
                    }),
                    _ => None,
                }
            }
            ContactMode::Slipping(..) => None,
        }
    }

    /// d(friction torque)/d(coefficient j of the slip velocity) is this factor × coefficient k − j of
    /// the exponential.
    #[inline(always)]
    pub fn slope(&self) -> Option<f64> {
        match self {
            Self::OnCurve { load, curve, sign } => {
                Some(-(load.value() * curve.inverse_omega_s.value() * *sign))
            }
            Self::Constant { .. } | Self::Stuck { .. } => None,
        }
    }

    /// Derivatives of coefficient `k` of a sliding contact's torque, the motion held.
    #[inline(always)]
    pub fn owed_torque(&self, k: usize, omega: &Series<f64>, plain: &PinJet<f64>) -> S {
        match self {
            Self::OnCurve { load, curve, sign } => {
                let excess = &plain.curve[1];
                let product = f64::convolution(&excess[..=k], &omega[..=k]) * *sign;
                let (load_value, share) = (load.value(), excess[k] / curve.span.value());
                let level = if k == 0 {
                    curve.mu_c.value() + excess[0]
                } else {
                    excess[k]
                };
                let mu_c = if k == 0 { load_value } else { 0.0 };
                S::combined([
                    (level, load),
                    (load_value * share, &curve.span),
                    (-(load_value * product), &curve.inverse_omega_s),
                    (mu_c, &curve.mu_c),
                ])
            }
            Self::Constant { torque, .. } if k == 0 => *torque,
            Self::Constant { .. } | Self::Stuck { .. } => S::ZERO,
        }
    }

    /// Puts order `k` of what the guards look at into `jet`; for a stuck contact the torque, too.
    #[inline(always)]
    pub fn reaction(
        &self,
        k: usize,
        resisting: impl FnOnce() -> S,
        inertia: &S,
        omega: &Series<S>,
        plain: &PinJet<f64>,
        jet: &mut PinJet<S>,
    ) {
        let (Self::Stuck { breakaway, .. } | Self::Constant { breakaway, .. }) = self else {
            return;
        };
        jet.breakaway[k] = if k == 0 { *breakaway } else { S::ZERO };
        jet.resisting[k] = resisting().with_value(plain.resisting[k]);
        if let Self::Stuck { decay, .. } = self {
            let (j, d, w) = (inertia.value(), decay.value(), omega[k].value());
            jet.torque[k] = S::combined([
                (-1.0, &jet.resisting[k]),
                (j * d, &omega[k]),
                (d * w, inertia),
                (j * w, decay),
            ])
            .with_value(plain.torque[k]);
        }
    }
}

impl<S: Scalar> PinJet<S> {
    /// Order `k` of `plain`, without derivatives.
    pub(super) fn rest(&mut self, k: usize, plain: &PinJet<f64>) {
        self.torque[k] = S::constant(plain.torque[k]);
        self.resisting[k] = S::constant(plain.resisting[k]);
        self.breakaway[k] = S::constant(plain.breakaway[k]);
    }
}

impl<S: Scalar> Rig<S> {
    /// What the pins on D2 and D1 do, if derivatives can be had without dual recurrences.
    #[allow(clippy::type_complexity)]
    pub(super) fn pin_tangents(
        &self,
        mode: &RigMode,
        jet: &RigJet<S>,
    ) -> Option<(PinTangent<S>, Option<PinTangent<S>>)> {
        let disc = PinTangent::new(mode.disc, &self.law, &jet.disc)?;
        let disc1 = match (&self.outer, &jet.disc1) {
            (Some(outer), Some(pin)) => Some(PinTangent::new(mode.disc1, &outer.law, pin)?),
            _ => None,
        };
        Some((disc, disc1))
    }

    /// As `expand_plain` by a motion without derivatives and its variational equations; `false`,
    /// with nothing done, where that is not possible.
    pub(super) fn expand_tangent(
        &self,
        mode: &RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        order: usize,
        jet: &mut RigJet<S>,
    ) -> bool {
        if order < LOWEST_ORDER || jet.tangent.is_none() {
            return false;
        }
        let Some((disc, disc1)) = self.pin_tangents(mode, jet) else {
            return false;
        };
        let Some(mut tangent) = jet.tangent.take() else {
            return false;
        };
        tangent.rig.expand_motion(
            mode,
            time.value(),
            &state.map(S::value),
            &inputs.lift(),
            order,
            &mut tangent.jet,
        );
        if let Some(disc1) = &disc1 {
            vary::<S, true>(mode, inputs, order, &tangent, &disc, disc1, jet);
        } else {
            vary::<S, false>(mode, inputs, order, &tangent, &disc, &disc, jet);
        }
        jet.tangent = Some(tangent);
        true
    }
}

/// Fills `jet` up to `order` with the motion in `tangent` and its derivatives.
fn vary<S: Scalar, const FULL: bool>(
    mode: &RigMode,
    inputs: &RigInputs<S>,
    order: usize,
    tangent: &Tangent<S>,
    disc: &PinTangent<S>,
    disc1: &PinTangent<S>,
    jet: &mut RigJet<S>,
) {
    let plain = &tangent.jet;
    let rates = &tangent.rates;
    let motor_sign = motor_sign(mode);
    let RigJet {
        states: x,
        disc: disc_jet,
        disc1: disc1_jet,
        motor_torque,
        voltage,
        parts,
        ..
    } = jet;
    for k in 0..=order.min(TERMS - 2) {
        let per_next = RECIPROCAL[k + 1];
        let twist = x[THETA][k] - x[THETA3][k];
        let rate = x[OMEGA][k] - x[OMEGA3][k];
        let shaft_torque = || shaft(&twist, &rate, &parts.stiffness, &parts.damping);
        let [k2, c2, by_inertia] = &rates.disc;
        let mut on_disc = S::ZERO;
        let mut outer_torque = S::ZERO;
        if FULL && let (Some(pin_jet), Some(plain)) = (disc1_jet.as_mut(), &plain.disc1) {
            let plain_omega = &tangent.jet.states[OMEGA1];
            let twist_1 = x[THETA1][k] - x[THETA][k];
            let rate_1 = x[OMEGA1][k] - x[OMEGA][k];
            outer_torque = shaft(&twist_1, &rate_1, &parts.stiffness_1, &parts.damping_1);
            let [k1, c1] = &rates.from_disc1;
            on_disc = shaft(&twist_1, &rate_1, k1, c1);
            let [k1, c1, by_inertia_1] = &rates.disc1;
            let inertia = &parts.inertia_1;
            disc1.reaction(k, || outer_torque, inertia, &x[OMEGA1], plain, pin_jet);
            let acceleration = match disc1 {
                PinTangent::Stuck { decay, .. } => decaying(decay, &x[OMEGA1][k]),
                _ => {
                    let torque = sliding(k, disc1, (&x[OMEGA1], plain_omega), plain, pin_jet);
                    S::combined([
                        (-1.0, &shaft(&twist_1, &rate_1, k1, c1)),
                        (-by_inertia_1.value(), &torque),
                        (-torque.value(), by_inertia_1),
                    ])
                }
            };
            x[OMEGA1][k + 1] = acceleration;
        }
        let resisting = || {
            let outside = if k == 0 { inputs.disc_torque } else { S::ZERO };
            S::combined([
                (1.0, &shaft_torque()),
                (-1.0, &outer_torque),
                (-1.0, &outside),
            ])
        };
        disc.reaction(
            k,
            resisting,
            &parts.inertia,
            &x[OMEGA],
            &plain.disc,
            disc_jet,
        );
        let acceleration = match disc {
            PinTangent::Stuck { decay, .. } => decaying(decay, &x[OMEGA][k]),
            _ => {
                let mut torque = sliding(
                    k,
                    disc,
                    (&x[OMEGA], &plain.states[OMEGA]),
                    &plain.disc,
                    disc_jet,
                );
                if k == 0 {
                    torque -= inputs.disc_torque;
                }
                S::combined([
                    (-k2.value(), &twist),
                    (-c2.value(), &rate),
                    (-by_inertia.value(), &torque),
                    (-twist.value(), k2),
                    (-rate.value(), c2),
                    (-torque.value(), by_inertia),
                    (1.0, &on_disc),
                ])
            }
        };
        x[OMEGA][k + 1] = acceleration;

        let current = x[CURRENT][k];
        let motor_speed = x[OMEGA3][k];
        let outside = if k == 0 { inputs.motor_torque } else { S::ZERO };
        let motor_acceleration = match motor_sign {
            None => {
                let held = S::combined([
                    (1.0, &shaft_torque()),
                    (parts.current_to_torque.value(), &current),
                    (current.value(), &parts.current_to_torque),
                    (-parts.motor_damping.value(), &motor_speed),
                    (-motor_speed.value(), &parts.motor_damping),
                    (1.0, &outside),
                ]);
                motor_torque[k] = held.with_value(plain.motor_torque[k]);
                S::ZERO
            }
            Some(sign) => {
                let friction = if k == 0 {
                    parts.motor_coulomb * sign
                } else {
                    S::ZERO
                };
                motor_torque[k] = friction;
                let net = outside - friction;
                let [k2, c2, torque, damping, by_inertia] = &rates.motor;
                S::combined([
                    (k2.value(), &twist),
                    (twist.value(), k2),
                    (c2.value(), &rate),
                    (rate.value(), c2),
                    (torque.value(), &current),
                    (current.value(), torque),
                    (-damping.value(), &motor_speed),
                    (-motor_speed.value(), damping),
                    (by_inertia.value(), &net),
                    (net.value(), by_inertia),
                ])
            }
        };
        x[OMEGA3][k + 1] = motor_acceleration;
        let [circuit, resistance, back_emf] = &rates.circuit;
        let mut current_rate = S::combined([
            (-resistance.value(), &current),
            (-current.value(), resistance),
            (-back_emf.value(), &motor_speed),
            (-motor_speed.value(), back_emf),
        ]);
        if k < INPUT_TERMS {
            current_rate += S::combined([
                (circuit.value(), &voltage[k]),
                (voltage[k].value(), circuit),
            ]);
        }
        x[CURRENT][k + 1] = current_rate;
        x[THETA][k + 1] = x[OMEGA][k];
        x[THETA3][k + 1] = motor_speed;
        let used = if FULL { OMEGA1 } else { CURRENT };
        if FULL {
            x[THETA1][k + 1] = x[OMEGA1][k];
        }
        for (series, plain) in x[..=used].iter_mut().zip(&plain.states) {
            series[k + 1] = S::combined([(per_next, &series[k + 1])]);
            series[k + 1].set_value(plain[k + 1]);
        }
    }
}

/// Derivatives of stiffness × twist + damping × rate.
#[inline(always)]
pub(super) fn shaft<S: Scalar>(twist: &S, rate: &S, stiffness: &S, damping: &S) -> S {
    S::combined([
        (stiffness.value(), twist),
        (damping.value(), rate),
        (twist.value(), stiffness),
        (rate.value(), damping),
    ])
}

/// Derivatives of −decay × ω.
#[inline(always)]
fn decaying<S: Scalar>(decay: &S, omega: &S) -> S {
    S::combined([(-decay.value(), omega), (-omega.value(), decay)])
}

/// Coefficient `k` of a sliding contact's torque, which is also left in `jet`.
#[inline(always)]
fn sliding<S: Scalar>(
    k: usize,
    pin: &PinTangent<S>,
    (omega, plain_omega): (&Series<S>, &Series<f64>),
    plain: &PinJet<f64>,
    jet: &mut PinJet<S>,
) -> S {
    let owed = pin.owed_torque(k, plain_omega, plain);
    jet.torque[k] = moved_torque(k, owed, pin, omega, plain);
    jet.torque[k]
}

/// Coefficient `k` of a sliding contact's torque: what parameters owe and what the velocity does.
#[inline(always)]
pub(super) fn moved_torque<S: Scalar>(
    k: usize,
    owed: S,
    pin: &PinTangent<S>,
    omega: &Series<S>,
    plain: &PinJet<f64>,
) -> S {
    let torque = match pin.slope() {
        Some(slope) => {
            let moved = S::filtered(&plain.curve[1][..=k], &omega[..=k]);
            S::combined([(1.0, &owed), (slope, &moved)])
        }
        None => owed,
    };
    torque.with_value(plain.torque[k])
}

/// Direction in which the motor turns, ±1; `None` if it rests.
pub(super) fn motor_sign(mode: &RigMode) -> Option<f64> {
    match mode.motor {
        ContactMode::Stuck => None,
        ContactMode::Breaking(direction) | ContactMode::Slipping(direction, _) => {
            Some(direction.sign())
        }
    }
}
