//! What is in no catalogue: a free function at one port over one coordinate, learned from the records.
//!
//! Its values at knots are a Gaussian process a priori, whose smoothness and size the evidence chooses, as it chooses port and
//! coordinate. The model carries the function as a table of an effect by equation and runs exactly under it; derivatives with
//! respect to the values at knots are those of the torque in each small piece of a window.

use crate::data::{Data, grams, reduced};
use crate::fit::{Fit, STEPS};
use crate::gram::{Gram, Place};
use crate::hypothesis::Hypothesis;
use crate::loss;
use crate::marginal::{Disturbance, Reduced};
use crate::policy::LN_PRIOR_ODDS;
use crate::problem::Problem;
use crate::scales::Scales;
use crate::structure::{augment, evidence};
use crate::units::PlantUnits;
use crate::window::Start;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::convert::Infallible;
use std::f64::consts::TAU;
use stickslip::expression::Coordinate;
use stickslip::parameter::ParameterInfo;
use stickslip::plant::{Port, Rig, Supposition};

/// Knots of a function.
const KNOTS: usize = 24;
/// Distances over which a function may change, as shares of the coordinate's range.
const REACHES: [f64; 4] = [0.04, 0.08, 0.16, 0.4];
/// Sizes of a function, as shares of what it acts on.
const SIZES: [f64; 3] = [0.1, 0.3, 1.0];
/// Part of a function's variance that is independent from knot to knot, so that matrices stay positive.
const JITTER: f64 = 1e-6;
/// Families that are fitted after a first look at all.
const FOLLOWED: usize = 3;
/// Most steps of a fit, and the share of a step below which none is tried.
const MOST_STEPS: usize = 12;
const SHORTEST: f64 = 0.01;
/// Decrease of −2 ln likelihood below which a step gains nothing.
const CONVERGED: f64 = 0.5;

/// Where a free function acts, and over which coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Family {
    /// Where it acts.
    pub port: Port,
    /// What it is a function of: of velocities, their magnitude.
    pub over: Coordinate,
    /// What it is multiplied by.
    pub times: Option<Coordinate>,
}

const fn family(port: Port, over: Coordinate, times: Option<Coordinate>) -> Family {
    Family { port, over, times }
}

/// All families.
pub const FAMILIES: [Family; 14] = [
    family(Port::DiscFriction, Coordinate::Angle, None),
    family(Port::DiscFriction, Coordinate::Velocity, None),
    family(Port::DiscFriction, Coordinate::Load, None),
    family(Port::DiscFriction, Coordinate::Time, None),
    family(Port::DiscTorque, Coordinate::Angle, None),
    family(Port::DiscTorque, Coordinate::Time, None),
    family(
        Port::DiscTorque,
        Coordinate::Velocity,
        Some(Coordinate::Velocity),
    ),
    family(Port::ShaftTorque, Coordinate::Twist, None),
    family(Port::ShaftTorque, Coordinate::Time, Some(Coordinate::Twist)),
    family(Port::MotorTorque, Coordinate::Angle, None),
    family(Port::MotorTorque, Coordinate::Time, None),
    family(Port::MotorTorque, Coordinate::Current, None),
    family(
        Port::MotorTorque,
        Coordinate::Time,
        Some(Coordinate::Current),
    ),
    family(
        Port::MotorTorque,
        Coordinate::Velocity,
        Some(Coordinate::Velocity),
    ),
];

impl Family {
    /// Name of the effect.
    #[must_use]
    pub fn name(self) -> String {
        let port = self.port.name().replace('.', "_");
        format!("learned_{port}_over_{}", self.over.name())
    }

    fn is_periodic(self) -> bool {
        self.over == Coordinate::Angle
    }

    /// The coordinate where the motion is, in the plant's units.
    fn coordinate(self, place: &Place, ratio: f64) -> f64 {
        let is_motor = self.port == Port::MotorTorque;
        match self.over {
            Coordinate::Angle if is_motor => (ratio * place.gear_angle).rem_euclid(TAU),
            Coordinate::Angle => place.disc_angle.rem_euclid(TAU),
            Coordinate::Velocity if is_motor => (ratio * place.gear_speed).abs(),
            Coordinate::Velocity => place.speed.abs(),
            Coordinate::Twist => place.twist,
            Coordinate::Current => place.current,
            Coordinate::Load => place.normal_force,
            _ => place.time,
        }
    }

    /// Torques on the disc and at the gearbox's output per unit of the function, where its value is `present`.
    fn torques(self, place: &Place, ratio: f64, present: f64) -> (f64, f64) {
        let slides = if place.sliding {
            place.speed.signum()
        } else {
            0.0
        };
        match (self.port, self.times) {
            (Port::DiscFriction, _) => {
                let factor = (1.0 + present).max(0.1);
                (-slides * place.friction / factor, 0.0)
            }
            (Port::DiscTorque, Some(_)) => (-place.speed, 0.0),
            (Port::DiscTorque, None) => (1.0, 0.0),
            (Port::ShaftTorque, Some(_)) => (-place.twist, place.twist),
            (Port::ShaftTorque, None) => (-1.0, 1.0),
            (_, Some(Coordinate::Current)) => (0.0, ratio * place.current),
            (_, Some(_)) => (0.0, -ratio * ratio * place.gear_speed),
            _ => (0.0, ratio),
        }
    }

    /// A function as large as what it acts on.
    fn size(self, scales: &Scales, ratio: f64) -> f64 {
        let torque = scales.torque;
        match (self.port, self.times) {
            (Port::DiscFriction, _) => 1.0,
            (Port::DiscTorque, Some(_)) => torque / scales.speed,
            (Port::ShaftTorque, Some(_)) => torque / scales.twist,
            (Port::MotorTorque, Some(Coordinate::Current)) => torque / (ratio * scales.current),
            (Port::MotorTorque, Some(_)) => torque / (ratio * ratio * scales.speed),
            (Port::MotorTorque, None) => torque / ratio,
            _ => torque,
        }
    }

    /// Units of coordinate and function: SI values of the plant's, and their names.
    fn units(self, units: &PlantUnits) -> ([f64; 2], [&'static str; 2]) {
        let (x, x_name) = match self.over {
            Coordinate::Velocity => (1.0 / units.time, "rad/s"),
            Coordinate::Load => (units.force, "N"),
            Coordinate::Current => (units.current, "A"),
            Coordinate::Time => (units.time, "s"),
            _ => (1.0, "rad"),
        };
        let (y, y_name) = match (self.port, self.times) {
            (Port::DiscFriction, _) => (1.0, "1"),
            (_, Some(Coordinate::Velocity)) => (units.torque * units.time, "N.m.s/rad"),
            (_, Some(Coordinate::Twist)) => (units.torque, "N.m/rad"),
            (_, Some(Coordinate::Current)) => (units.torque / units.current, "N.m/A"),
            _ => (units.torque, "N.m"),
        };
        ([x, y], [x_name, y_name])
    }

    fn equation(self) -> String {
        let name = self.over.name();
        let term = if self.over == Coordinate::Velocity {
            format!("share*term(abs({name}))")
        } else {
            format!("share*term({name})")
        };
        match self.times {
            None if self.port == Port::DiscFriction => format!("1 + {term}"),
            None => term,
            Some(Coordinate::Velocity) => format!("-{term}*velocity"),
            Some(times) => format!("{term}*{}", times.name()),
        }
    }
}

/// A function of one coordinate as a table of an effect, SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct TableEffect {
    /// Name of the effect.
    pub name: String,
    /// Where it acts.
    pub port: Port,
    /// Its equation, which calls the function `term` and has a factor `share`.
    pub equation: String,
    /// Units of knots and values.
    pub units: [String; 2],
    /// Period of the coordinate, if it has one.
    pub period: Option<f64>,
    /// Knots.
    pub knots: Vec<f64>,
    /// Values at the knots.
    pub values: Vec<f64>,
}

impl TableEffect {
    /// The section `[[effect]]` that describes it.
    #[must_use]
    pub fn section(&self) -> String {
        let list = |numbers: &[f64]| {
            let texts: Vec<String> = numbers.iter().map(|v| format!("{v:?}")).collect();
            texts.join(", ")
        };
        let period = self
            .period
            .map_or(String::new(), |p| format!("period = {p:?}\n"));
        let Self {
            name,
            equation,
            units: [x_unit, y_unit],
            ..
        } = self;
        format!(
            "[[effect]]\nname = \"{name}\"\ntitle = \"a function learned from the records, of which no effect of the catalogue is the cause\"\n\
             port = \"{}\"\nequation = \"{equation}\"\n\
             parameters.share = {{ value = 1.0, unit = \"1\", description = \"Share of the learned function\" }}\n\
             [effect.tables.term]\nx = [{}]\ny = [{}]\nx_unit = \"{x_unit}\"\ny_unit = \"{y_unit}\"\n\
             interpolation = \"spline\"\n{period}",
            self.port.name(),
            list(&self.knots),
            list(&self.values),
        )
    }

    /// `rig` with the function; `None` where it cannot have it.
    #[must_use]
    pub fn added_to(&self, rig: &Rig<f64>) -> Option<Rig<f64>> {
        let read = Supposition::read_all(&self.section(), &self.name).ok()?;
        let definition = read.first()?.definition;
        let mut rig = *rig;
        rig.equations.add(definition).ok()?;
        let whole = |_: &'static ParameterInfo| Ok::<f64, Infallible>(1.0);
        rig.insert_effect(definition.name(), whole)?.ok()?;
        Some(rig)
    }
}

/// A function that was learned.
#[derive(Clone, Debug)]
pub struct Learned {
    /// Where it acts and over what.
    pub family: Family,
    /// The effect that carries it, SI units.
    pub table: TableEffect,
    /// Standard deviations of its values.
    pub deviations: Vec<f64>,
    /// Smallest and largest value of the coordinate in the records, SI units.
    pub range: [f64; 2],
    /// The analyst's model with the function, fitted.
    pub fit: Fit,
    /// Gain in log evidence over the analyst's model.
    pub gain: f64,
}

/// A family on a problem's records, in the plant's units.
struct Basis<'a> {
    problem: &'a Problem,
    family: Family,
    knots: Vec<f64>,
    ratio: f64,
}

impl<'a> Basis<'a> {
    /// `None` where the coordinate does not vary.
    fn new(problem: &'a Problem, family: Family, grams: &[Option<Gram>]) -> Option<Self> {
        let ratio = problem.rig.gearbox.ratio;
        let knots = if family.is_periodic() {
            (0..KNOTS).map(|k| k as f64 * TAU / KNOTS as f64).collect()
        } else {
            let seen = grams
                .iter()
                .flatten()
                .flat_map(|gram| &gram.places)
                .filter(|place| family.torques(place, ratio, 0.0) != (0.0, 0.0))
                .map(|place| family.coordinate(place, ratio));
            let (low, high) = seen.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            if !(high - low > 1e-6 * high.abs().max(low.abs())) {
                return None;
            }
            let step = (high - low) / (KNOTS - 1) as f64;
            (0..KNOTS).map(|k| low + step * k as f64).collect()
        };
        Some(Self {
            problem,
            family,
            knots,
            ratio,
        })
    }

    fn step(&self) -> f64 {
        self.knots[1] - self.knots[0]
    }

    /// The knot below a coordinate, the next one, and the share of the way to that.
    fn between(&self, x: f64) -> (usize, usize, f64) {
        let at = (x - self.knots[0]) / self.step();
        if self.family.is_periodic() {
            let below = at.floor();
            let k = (below as usize) % KNOTS;
            return (k, (k + 1) % KNOTS, at - below);
        }
        let at = at.clamp(0.0, (KNOTS - 1) as f64);
        let k = (at.floor() as usize).min(KNOTS - 2);
        (k, k + 1, at - k as f64)
    }

    /// Gram matrices with the values at the knots as further free numbers, where they are `values`.
    fn augmented(&self, grams: &[Option<Gram>], values: &[f64]) -> Vec<Option<Gram>> {
        let functions = |place: &Place| {
            let (below, above, share) = self.between(self.family.coordinate(place, self.ratio));
            let present = (1.0 - share) * values[below] + share * values[above];
            let (disc, motor) = self.family.torques(place, self.ratio, present);
            let mut hats = vec![(0.0, 0.0); KNOTS];
            hats[below] = ((1.0 - share) * disc, (1.0 - share) * motor);
            hats[above] = (share * disc, share * motor);
            hats
        };
        let with = |gram: &Gram| augment(gram, functions);
        grams.iter().map(|gram| gram.as_ref().map(with)).collect()
    }

    /// Square root of the covariance of the values at the knots.
    fn root(&self, reach: f64, size: f64) -> Option<DMatrix<f64>> {
        let range = if self.family.is_periodic() {
            TAU
        } else {
            self.knots[KNOTS - 1] - self.knots[0]
        };
        let size = size * self.family.size(&self.problem.long.scales, self.ratio);
        let covariance = DMatrix::from_fn(KNOTS, KNOTS, |i, j| {
            let between = self.knots[i] - self.knots[j];
            let distance = if self.family.is_periodic() {
                2.0 * (0.5 * between).sin()
            } else {
                between
            };
            let near = (-0.5 * (distance / (reach * range)).powi(2)).exp();
            size * size * (near + if i == j { JITTER } else { 0.0 })
        });
        Cholesky::new(covariance).map(|cholesky| cholesky.l())
    }

    /// The effect with these values at the knots.
    fn table(&self, values: &[f64]) -> TableEffect {
        let ([x, y], units) = self.family.units(&self.problem.units);
        let scaled = |numbers: &[f64], unit: f64| numbers.iter().map(|v| v * unit).collect();
        TableEffect {
            name: self.family.name(),
            port: self.family.port,
            equation: self.family.equation(),
            units: units.map(str::to_owned),
            period: self.family.is_periodic().then_some(TAU),
            knots: scaled(&self.knots, x),
            values: scaled(values, y),
        }
    }
}

/// A fit of a function and of the free numbers.
struct State {
    /// The fit in small pieces.
    fit: Fit,
    /// Values at the knots, as multiples of the columns of the covariance's root.
    weights: DVector<f64>,
    /// Quadratic forms in the free numbers and the weights.
    forms: Vec<Option<Reduced>>,
    loss: f64,
}

impl State {
    fn at(
        basis: &Basis<'_>,
        data: &Data,
        root: &DMatrix<f64>,
        hypothesis: Hypothesis,
        weights: DVector<f64>,
        starts: Vec<Start>,
    ) -> Option<Self> {
        let values: Vec<f64> = (root * &weights).iter().copied().collect();
        let mut own = hypothesis;
        own.rig = basis.table(&values).added_to(&basis.problem.rig)?;
        let grams = grams(data, &own, &starts);
        let augmented = basis.augmented(&grams, &values);
        let forms = forms(data, &starts, &augmented, own.dimension(), root);
        let loss = loss::total(&forms, &own) + weights.norm_squared();
        Some(Self {
            fit: Fit {
                hypothesis: own,
                starts,
                grams,
                disturbance: Disturbance::NONE,
                loss,
                is_converged: false,
            },
            weights,
            forms,
            loss,
        })
    }

    fn numbers(&self) -> (Vec<f64>, Vec<f64>) {
        let mut precisions = self.fit.hypothesis.prior_precisions();
        let mut x = self.fit.hypothesis.x.clone();
        precisions.extend(self.weights.iter().map(|_| 1.0));
        x.extend(self.weights.iter());
        (precisions, x)
    }

    /// The state after `share` of the step that the quadratic forms suggest.
    fn stepped(
        &self,
        basis: &Basis<'_>,
        data: &Data,
        root: &DMatrix<f64>,
        share: f64,
    ) -> Option<Self> {
        let (precisions, x) = self.numbers();
        let (curvature, gradient) =
            loss::normal_equations(self.forms.iter().flatten(), &precisions, &x);
        let step = Cholesky::new(curvature)?.solve(&gradient) * share;
        let mut hypothesis = self.fit.hypothesis.clone();
        for (x, d) in hypothesis.x.iter_mut().zip(step.iter()) {
            *x += d;
        }
        hypothesis.clamp();
        let own = hypothesis.dimension();
        let weights = &self.weights + step.rows(own, self.weights.len());
        let starts = self
            .fit
            .starts
            .iter()
            .zip(&self.forms)
            .zip(&data.windows)
            .map(|((start, form), window)| match form {
                Some(form) => Start::from(window.moved(&start.state, &form.start_change(&step))),
                None => start.clone(),
            })
            .collect();
        Self::at(basis, data, root, hypothesis, weights, starts)
    }
}

/// Windows as quadratic forms in `own` free numbers and the weights of the columns of `root`.
fn forms(
    data: &Data,
    starts: &[Start],
    augmented: &[Option<Gram>],
    own: usize,
    root: &DMatrix<f64>,
) -> Vec<Option<Reduced>> {
    let forms = reduced(data, starts, augmented, &Disturbance::NONE);
    in_weights(&forms, own, root)
}

fn in_weights(forms: &[Option<Reduced>], own: usize, root: &DMatrix<f64>) -> Vec<Option<Reduced>> {
    let count = root.ncols();
    let mut map = DMatrix::identity(own + count, own + count);
    map.view_mut((own, own), (count, count)).copy_from(root);
    let mapped = |form: &Reduced| form.mapped(&map);
    forms.iter().map(|form| form.as_ref().map(mapped)).collect()
}

/// The function that explains most of what `base`, the analyst's refitted model, leaves; `None` where none explains anything.
#[must_use]
pub fn learn(problem: &Problem, base: &Fit, progress: &mut dyn FnMut(&str)) -> Option<Learned> {
    progress("what a free function explains");
    let data = problem.long.clone().finely_divided();
    let calm_starts = base.starts.iter().map(|start| Start::from(start.state));
    let base = Fit::at(
        &data,
        base.hypothesis.clone(),
        calm_starts.collect(),
        Disturbance::NONE,
    )
    .improved_calmly(&data, 3);
    let own = base.hypothesis.dimension();
    let without = base.told(&data);
    let zero = vec![0.0; KNOTS];
    let mut looks: Vec<(f64, Basis<'_>, DMatrix<f64>)> = Vec::new();
    for family in FAMILIES {
        let Some(basis) = Basis::new(problem, family, &base.grams) else {
            continue;
        };
        let augmented = basis.augmented(&base.grams, &zero);
        let plain = reduced(&data, &base.starts, &augmented, &Disturbance::NONE);
        let mut best: Option<(f64, DMatrix<f64>)> = None;
        for (reach, size) in REACHES
            .iter()
            .flat_map(|reach| SIZES.iter().map(move |size| (*reach, *size)))
        {
            let Some(root) = basis.root(reach, size) else {
                continue;
            };
            let forms = in_weights(&plain, own, &root);
            let mut precisions = base.hypothesis.prior_precisions();
            let mut x = base.hypothesis.x.clone();
            precisions.resize(own + KNOTS, 1.0);
            x.resize(own + KNOTS, 0.0);
            let Some(told) = evidence(&forms, &precisions, &x) else {
                continue;
            };
            let gain = told.total() - without.total();
            if best.as_ref().is_none_or(|(other, _)| gain > *other) {
                best = Some((gain, root));
            }
        }
        if let Some((gain, root)) = best {
            looks.push((gain, basis, root));
        }
    }
    looks.sort_by(|a, b| b.0.total_cmp(&a.0));
    looks.truncate(FOLLOWED);
    let mut best: Option<(f64, State, Basis<'_>, DMatrix<f64>)> = None;
    for (_, basis, root) in looks {
        progress(&basis.family.name());
        let Some(state) = fitted(&basis, &data, &root, &base) else {
            continue;
        };
        let (precisions, x) = state.numbers();
        let Some(told) = evidence_at(&state.forms, &precisions, &x) else {
            continue;
        };
        let gain = told - without.total();
        if best.as_ref().is_none_or(|(other, ..)| gain > *other) {
            best = Some((gain, state, basis, root));
        }
    }
    let (gain, state, basis, root) = best.filter(|(gain, ..)| *gain > -LN_PRIOR_ODDS)?;
    learned(&basis, state, &root, gain)
}

fn fitted(basis: &Basis<'_>, data: &Data, root: &DMatrix<f64>, base: &Fit) -> Option<State> {
    let mut state = State::at(
        basis,
        data,
        root,
        base.hypothesis.clone(),
        DVector::zeros(KNOTS),
        base.starts.clone(),
    )?;
    let mut share = 1.0;
    for _ in 0..MOST_STEPS {
        let trial = state.stepped(basis, data, root, share);
        match trial.filter(|trial| trial.loss < state.loss) {
            Some(trial) => {
                let gained = state.loss - trial.loss;
                state = trial;
                share = (2.0 * share).min(1.0);
                if gained < CONVERGED {
                    break;
                }
            }
            None => share *= 0.3,
        }
        if share < SHORTEST {
            break;
        }
    }
    Some(state)
}

/// Log evidence by Laplace's approximation at the present numbers.
fn evidence_at(forms: &[Option<Reduced>], precisions: &[f64], x: &[f64]) -> Option<f64> {
    let (curvature, _) = loss::normal_equations(forms.iter().flatten(), precisions, x);
    let cholesky = Cholesky::new(curvature)?;
    let volume: f64 = cholesky.l_dirty().diagonal().iter().map(|d| d.ln()).sum();
    let windows: f64 = forms.iter().map(loss::of_window).sum();
    let prior: f64 = precisions
        .iter()
        .zip(x)
        .map(|(p, x)| p.ln() - p * x * x)
        .sum();
    Some(0.5 * (prior - windows) - volume)
}

fn learned(basis: &Basis<'_>, state: State, root: &DMatrix<f64>, gain: f64) -> Option<Learned> {
    let own = state.fit.hypothesis.dimension();
    let values: Vec<f64> = (root * &state.weights).iter().copied().collect();
    let (precisions, x) = state.numbers();
    let (curvature, _) = loss::normal_equations(state.forms.iter().flatten(), &precisions, &x);
    let covariance = Cholesky::new(curvature)?.inverse();
    let of_weights = covariance.view((own, own), (KNOTS, KNOTS));
    let of_values = root * of_weights * root.transpose();
    let ([_, unit], _) = basis.family.units(&basis.problem.units);
    let table = basis.table(&values);
    let (first, last) = (
        table.knots[0],
        table.period.unwrap_or(table.knots[KNOTS - 1]),
    );
    let long = &basis.problem.long;
    let fit = Fit::at(
        long,
        state.fit.hypothesis,
        state.fit.starts,
        Disturbance::NONE,
    )
    .improved(long, STEPS);
    Some(Learned {
        family: basis.family,
        table,
        deviations: of_values
            .diagonal()
            .iter()
            .map(|v| v.max(0.0).sqrt() * unit)
            .collect(),
        range: [first, last],
        fit,
        gain,
    })
}
