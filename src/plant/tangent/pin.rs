//! What a pin contact does to the derivatives in the course of a segment.

use super::parameter_forcing::{Forcing, add_series};
use crate::friction::{ContactMode, KnownSlip, Law, LevelSlopes, MOST_PARAMETERS, Regime};
use crate::plant::jet::PinJet;
use crate::plant::slow_manifold::DiscMotion;
use crate::series::{Scalar, Series, TERMS, convolution};

/// One pin contact: its slopes along the motion, over the inertia of its disc.
#[derive(Clone, Debug)]
pub(super) struct PinTangent {
    pub motion: DiscMotion,
    /// Rate [1/s] at which the velocity decays in stick.
    pub decay: f64,
    /// −(∂T/∂ω)/J, −(∂T/∂a)/J and −(∂T/∂θ)/J, where they are not zero.
    pub by_velocity: Option<Series<f64>>,
    pub by_acceleration: Option<Series<f64>>,
    pub by_angle: Option<Series<f64>>,
    /// 1/(1 + (∂T/∂a)/J) at order 0.
    pub inverse_margin: f64,
    slopes: LevelSlopes,
    /// (parameter of the law, slot, derivative).
    parameters: Vec<(usize, usize, f64)>,
    wanted: [bool; MOST_PARAMETERS],
    decay_slots: Vec<(usize, f64)>,
    breakaway_slots: Vec<(usize, f64)>,
    /// Of the torque beside the law.
    constant_slots: Vec<(usize, f64)>,
}

/// The contact in the segment at hand.
pub(super) struct PinSegment<'a, S> {
    pub mode: ContactMode,
    pub law: &'a Law<f64>,
    pub inverse_inertia: f64,
    pub theta: &'a Series<f64>,
    pub omega: &'a Series<f64>,
    /// Its plain series, and those of the load with derivatives.
    pub plain: &'a PinJet<f64>,
    pub load: &'a PinJet<S>,
}

fn slots<S: Scalar>(number: &S) -> Vec<(usize, f64)> {
    let all = (0..S::SLOTS).map(|slot| (slot, number.slot(slot)));
    all.filter(|(_, derivative)| *derivative != 0.0).collect()
}

impl PinTangent {
    pub fn new<S: Scalar>(law: &Law<S>, constant_torque: S) -> Self {
        let section = law.section();
        let mut parameters = Vec::new();
        let mut wanted = [false; MOST_PARAMETERS];
        for (index, wanted) in wanted.iter_mut().enumerate().take(section.infos().len()) {
            for (slot, derivative) in slots(&section.get(index)) {
                parameters.push((index, slot, derivative));
                *wanted = true;
            }
        }
        Self {
            motion: DiscMotion::Stuck,
            decay: 0.0,
            by_velocity: None,
            by_acceleration: None,
            by_angle: None,
            inverse_margin: 1.0,
            slopes: LevelSlopes::default(),
            parameters,
            wanted,
            decay_slots: slots(&law.band().1),
            breakaway_slots: slots(&law.breakaway()),
            constant_slots: slots(&constant_torque),
        }
    }

    /// Finds the slopes and adds what the law's parameters and the load do to `row`, up to order `top`.
    pub fn follow<S: Scalar>(
        &mut self,
        segment: &PinSegment<'_, S>,
        row: usize,
        top: usize,
        forcing: &mut Forcing<S>,
    ) {
        (self.by_velocity, self.by_acceleration, self.by_angle) = (None, None, None);
        self.inverse_margin = 1.0;
        self.motion = match segment.mode {
            ContactMode::Stuck => DiscMotion::Stuck,
            ContactMode::Slipping(_, Regime::Holding) => DiscMotion::Kept,
            // The segment has no length: the law has no root between its branches.
            ContactMode::Slipping(..) if segment.plain.slip.between => DiscMotion::Kept,
            ContactMode::Slipping(..) | ContactMode::Breaking(_) => DiscMotion::Driven,
        };
        match segment.mode {
            _ if self.motion == DiscMotion::Kept => {}
            ContactMode::Stuck => {
                self.decay = segment.law.band().1;
                for &(slot, derivative) in &self.decay_slots {
                    add_series(slot, -derivative, segment.omega, row, top, forcing);
                }
            }
            ContactMode::Breaking(direction) => {
                self.force_by_constant(direction.sign() * segment.inverse_inertia, row, forcing);
                let scale = -direction.sign() * segment.inverse_inertia;
                for &(slot, derivative) in &self.breakaway_slots {
                    add_series(
                        slot,
                        scale * derivative,
                        &segment.plain.load,
                        row,
                        top,
                        forcing,
                    );
                }
                let level = segment.law.breakaway();
                let mut constant = [0.0; TERMS];
                constant[0] = level;
                force_by_load(segment, scale, &constant, row, top, forcing);
            }
            ContactMode::Slipping(direction, regime) => {
                self.force_by_constant(direction.sign() * segment.inverse_inertia, row, forcing);
                self.slide(segment, direction.sign(), regime, row, top, forcing);
            }
        }
    }

    /// Adds what the torque beside the law does to `row`.
    fn force_by_constant<S: Scalar>(&self, factor: f64, row: usize, forcing: &mut Forcing<S>) {
        for &(slot, derivative) in &self.constant_slots {
            forcing[row][0].add_to_slot(slot, -factor * derivative);
        }
    }

    fn slide<S: Scalar>(
        &mut self,
        segment: &PinSegment<'_, S>,
        sign: f64,
        regime: Regime,
        row: usize,
        top: usize,
        forcing: &mut Forcing<S>,
    ) {
        let (pin, load) = (segment.plain, &segment.plain.load);
        let on_curve = pin.load_is_constant && segment.law.exponential_curve().is_some();
        let mut level = if on_curve {
            pin.slip.lower_level
        } else {
            pin.slip.level
        };
        if on_curve {
            level[0] += segment.law.sliding();
        }
        let speed = segment.omega.map(|c| sign * c);
        let slip = KnownSlip {
            regime,
            speed: &speed,
            angle: segment.theta,
            level: &level,
            jet: &pin.slip,
            order: top,
        };
        self.slopes.fill(segment.law, &slip, &self.wanted);
        let scale = -segment.inverse_inertia;
        // The level times `scale` × load.
        let pressed = |series: &Series<f64>, scale: f64| {
            let mut product = [0.0; TERMS];
            if pin.load_is_constant {
                let scale = scale * load[0];
                for (p, c) in product[..=top].iter_mut().zip(series) {
                    *p = scale * c;
                }
            } else {
                for k in 0..=top {
                    product[k] = scale * convolution(&load[..=k], &series[..=k]);
                }
            }
            product
        };
        self.by_velocity = self.slopes.by_speed.map(|slope| pressed(&slope, scale));
        self.by_acceleration = self.slopes.by_rate.map(|slope| pressed(&slope, scale));
        self.by_angle = self
            .slopes
            .by_angle
            .map(|slope| pressed(&slope, sign * scale));
        if let Some(slope) = &self.by_acceleration {
            self.inverse_margin = 1.0 / (1.0 - slope[0]);
        }
        let mut last = None;
        let mut product = [0.0; TERMS];
        for &(index, slot, derivative) in &self.parameters {
            if last != Some(index) {
                product = pressed(&self.slopes.by_parameter[index], sign * scale);
                last = Some(index);
            }
            add_series(slot, derivative, &product, row, top, forcing);
        }
        force_by_load(segment, sign * scale, &level, row, top, forcing);
    }
}

/// Adds `scale` × `level` × the derivatives of the load.
fn force_by_load<S: Scalar>(
    segment: &PinSegment<'_, S>,
    scale: f64,
    level: &Series<f64>,
    row: usize,
    top: usize,
    forcing: &mut Forcing<S>,
) {
    let load = &segment.load.load;
    if segment.load.load_is_constant {
        for slot in 0..S::SLOTS {
            let derivative = load[0].slot(slot);
            if derivative != 0.0 {
                add_series(slot, scale * derivative, level, row, top, forcing);
            }
        }
    } else if load.iter().any(Scalar::varies) {
        for k in 0..=top {
            let product = S::filtered(&level[..=k], &load[..=k]);
            forcing[row][k] += S::combined([(scale, &product)]);
        }
    }
}
