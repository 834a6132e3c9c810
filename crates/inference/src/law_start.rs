//! From where fits of friction laws start: the friction that the records themselves show over speed and acceleration.
//!
//! Where both ends of the shaft were measured, friction is what the model at the measured state lacks of the measured
//! acceleration. Elsewhere a fit of the analyst's model, with a free torque on the disc in every piece of a window, tells it as
//! far as that model's motion is the measured one. A law's numbers follow from the scatter by ordinary least squares.

use crate::data::{Data, reduced};
use crate::fit::Fit;
use crate::marginal::Disturbance;
use crate::record::{Run, channel};
use crate::scales::Scales;
use crate::trace::{Motion, Traces};
use nalgebra::{DMatrix, DVector, Matrix2, SMatrix, SVector, Vector2};
use rayon::prelude::*;
use stickslip::integrator::{HybridSystem, Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES, index};
use stickslip::series::{Dual, Scalar};

/// Most points of a scatter that a search goes over.
const MOST_POINTS: usize = 500;
/// Starts of Eq. 6-2 that are followed up.
const FOLLOWED: usize = 12;
/// Starts of Eq. 6-2 that fits begin from in each view.
const KEPT: usize = 3;
/// Numbers of Eq. 6-2.
const NUMBERS: usize = 8;
/// Starts that differ by less, in usual changes of their numbers, are one.
const ALIKE: f64 = 0.3;
/// Steps of the least squares of a start.
const STEPS: usize = 60;

/// Friction coefficient at one speed and acceleration along the motion.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Slip speed, positive.
    pub speed: f64,
    /// Acceleration along the motion.
    pub acceleration: f64,
    /// Friction coefficient.
    pub coefficient: f64,
    /// Its weight: inverse variance.
    pub weight: f64,
}

/// What the records show of the friction, in as many views of it as they allow.
#[derive(Clone, Debug, Default)]
pub struct Scatter {
    /// The views: from the measured motion, which noise blurs, and from free torques, which a motion that is not the measured
    /// one bends.
    pub views: Vec<Vec<Point>>,
    /// Friction coefficient at which a disc that rested let go, in the middle of all such moments; `None` where none was seen.
    pub breakaway: Option<f64>,
}

impl Scatter {
    /// The friction that the records show where the disc slides under a load.
    #[must_use]
    pub fn of(data: &Data, fit: &Fit) -> Self {
        let either = |run: &Run, a: usize, b: usize| run.has(a) || run.has(b);
        let both = |run: &Run| {
            either(run, channel::THETA, channel::OMEGA)
                && either(run, channel::THETA3, channel::OMEGA3)
        };
        let is_measured = data.runs.iter().all(both);
        let rig = fit.hypothesis.rig_at().ok().filter(|_| is_measured);
        let of_motion = rig.map(|rig| of_motion(data, &rig));
        Self {
            views: of_motion
                .into_iter()
                .chain([of_free_torque(data, fit)])
                .map(thinned)
                .collect(),
            breakaway: rig.and_then(|rig| breakaway(data, &rig)),
        }
    }
}

fn thinned(mut points: Vec<Point>) -> Vec<Point> {
    // A few points that are known much better than others must not decide alone.
    let mut weights: Vec<f64> = points.iter().map(|p| p.weight).collect();
    weights.sort_by(f64::total_cmp);
    let most = weights.get(weights.len() / 2).copied().unwrap_or(1.0);
    for point in &mut points {
        point.weight = point.weight.min(most);
    }
    let every = points.len().div_ceil(MOST_POINTS).max(1);
    points.into_iter().step_by(every).collect()
}

/// Friction as what the model at the measured state lacks of the measured acceleration.
fn of_motion(data: &Data, rig: &Rig<f64>) -> Vec<Point> {
    let samples: usize = data.runs.iter().map(Run::len).sum();
    let every = samples.div_ceil(2 * MOST_POINTS).max(1);
    let mut points = Vec::new();
    for run in data.runs.iter() {
        let sliding = (every / 2..run.len())
            .step_by(every)
            .filter(|at| run.traces.motion[*at] == Motion::Sliding);
        points.extend(sliding.filter_map(|at| measured(run, at, rig)));
    }
    points
}

/// Friction coefficient at which a disc that rested let go, in the middle of all such moments: of a single one noise may tell anything.
fn breakaway(data: &Data, rig: &Rig<f64>) -> Option<f64> {
    let mut coefficients = Vec::new();
    for run in data.runs.iter() {
        let motion = &run.traces.motion;
        let clear = (0..run.len()).filter(|at| motion[*at] != Motion::Unclear);
        let clear: Vec<usize> = clear.collect();
        for pair in clear.windows(2) {
            let [rests, slides] = [pair[0], pair[1]];
            if motion[rests] == Motion::Stuck && motion[slides] == Motion::Sliding {
                // Between the two it is not clear when: the middle is as good a guess as any.
                let resting = [run.traces.disc.angle[rests], 0.0, 0.0];
                let at = rests.midpoint(slides);
                coefficients.extend(friction(run, at, rig, resting).map(|own| own.coefficient));
            }
        }
    }
    coefficients.sort_by(f64::total_cmp);
    coefficients.get(coefficients.len() / 2).copied()
}

/// Friction at a sample of a record, as measured; `None` where nothing presses.
fn measured(run: &Run, at: usize, rig: &Rig<f64>) -> Option<Point> {
    let disc = &run.traces.disc;
    let moving = [disc.angle[at], disc.velocity[at], disc.acceleration[at]];
    friction(run, at, rig, moving)
}

/// Friction at a sample of a record, where the disc has this angle, speed and acceleration; `None` where nothing presses.
fn friction(
    run: &Run,
    at: usize,
    rig: &Rig<f64>,
    [angle, speed, acceleration]: [f64; 3],
) -> Option<Point> {
    let Traces { gear, disc1, .. } = &run.traces;
    let per_coefficient = rig.contact.radius * run.normal_force[at];
    if per_coefficient <= 0.0 {
        return None;
    }
    let mut state = [0.0; STATES];
    state[index::THETA] = angle;
    state[index::OMEGA] = speed;
    state[index::THETA3] = gear.angle[at];
    state[index::OMEGA3] = gear.velocity[at];
    if let Some(disc1) = disc1 {
        state[index::THETA1] = disc1.disc.angle[at];
        state[index::OMEGA1] = disc1.disc.velocity[at];
    }
    let force_1 = run.normal_force_1.get(at).copied().unwrap_or(0.0);
    let inputs = RigInputs::held(run.voltage[at], run.normal_force[at], force_1);
    let there = Simulation::new(*rig, Options::default(), run.time[at], state, inputs).ok()?;
    let modelled = there.system().states(there.jet())[index::OMEGA][1];
    // Where the disc rests, the motion is the one that the model would begin.
    let along = if speed == 0.0 { modelled } else { speed }.signum();
    let lacking = rig.disc.inertia * (acceleration - modelled);
    let friction = there.jet().friction_torque_at(0.0).abs() - along * lacking;
    Some(Point {
        speed: speed.abs(),
        acceleration: along * acceleration,
        coefficient: friction / per_coefficient,
        weight: per_coefficient * per_coefficient,
    })
}

/// Friction from free torques beside the analyst's model.
fn of_free_torque(data: &Data, fit: &Fit) -> Vec<Point> {
    let prior = data.scales.torque;
    let free = Disturbance {
        disc: prior,
        ..Disturbance::NONE
    };
    let forms = reduced(data, &fit.starts, &fit.grams, &free);
    let radius = fit.hypothesis.rig.contact.radius;
    let inertia = fit.hypothesis.rig.disc.inertia;
    let mut points = Vec::new();
    for (gram, form) in fit.grams.iter().zip(&forms) {
        let (Some(gram), Some(form)) = (gram, form) else {
            continue;
        };
        for (column, value, deviation) in form.disturbances() {
            let Some(place) = column
                .checked_sub(gram.disc())
                .and_then(|piece| gram.places.get(piece))
            else {
                continue;
            };
            let per_coefficient = radius * place.normal_force;
            if !place.sliding || per_coefficient <= 0.0 {
                continue;
            }
            let along = place.speed.signum();
            let (torque, deviation) = (prior * value, prior * deviation);
            points.push(Point {
                speed: place.speed.abs(),
                acceleration: along * (place.acceleration + torque / inertia),
                coefficient: (place.friction - along * torque) / per_coefficient,
                weight: (per_coefficient / deviation).powi(2),
            });
        }
    }
    points
}

/// Numbers μ_c, μ_s, ω_s of laws that fall exponentially with speed, one for each view that shows one.
#[must_use]
pub fn stribeck(scatter: &Scatter, scales: &Scales) -> Vec<[f64; 3]> {
    let views = scatter.views.iter();
    views.filter_map(|points| falling(points, scales)).collect()
}

fn falling(points: &[Point], scales: &Scales) -> Option<[f64; 3]> {
    let mut best: Option<(f64, [f64; 3])> = None;
    for share in [0.03, 0.06, 0.1, 0.17, 0.3, 0.5, 0.8] {
        let omega_s = share * scales.speed;
        let curve = |p: &Point| [1.0, (-p.speed / omega_s).exp()];
        let Some((level, left)) = linear(points, curve) else {
            continue;
        };
        let (mu_c, mu_s) = (level[0], level[0] + level[1]);
        if mu_c > 0.0 && mu_s > mu_c && best.is_none_or(|(least, _)| left < least) {
            best = Some((left, [mu_c, mu_s, omega_s]));
        }
    }
    best.map(|(_, numbers)| numbers)
}

/// The two coefficients of least squares, and the weighted sum of squares left.
fn linear(points: &[Point], curve: impl Fn(&Point) -> [f64; 2]) -> Option<(Vector2<f64>, f64)> {
    let mut moments = Matrix2::<f64>::zeros();
    let mut right = Vector2::<f64>::zeros();
    let mut square = 0.0;
    for p in points {
        let row = Vector2::from(curve(p));
        moments += p.weight * row * row.transpose();
        right += p.weight * p.coefficient * row;
        square += p.weight * p.coefficient * p.coefficient;
    }
    let ridge = 1e-6 * moments.trace();
    let solved = (moments + Matrix2::identity() * ridge)
        .cholesky()?
        .solve(&right);
    Some((solved, square - right.dot(&solved)))
}

/// Sets of the eight numbers of Eq. 6-2 that follow the views of a scatter, for each the best first.
#[must_use]
pub fn hysteresis(scatter: &Scatter, scales: &Scales) -> Vec<[f64; 8]> {
    let views = scatter.views.iter();
    views.flat_map(|points| following(points, scales)).collect()
}

fn following(points: &[Point], scales: &Scales) -> Vec<[f64; 8]> {
    if points.len() < 2 * NUMBERS {
        return Vec::new();
    }
    let mut coarse: Vec<(f64, [f64; 8])> = Vec::new();
    for centre in [0.3, 0.5, 0.7, 0.9] {
        for semi_axis in [0.4, 0.8, 1.6] {
            let ellipse = (centre * scales.speed, semi_axis * scales.acceleration);
            coarse.extend(on_ellipse(points, ellipse));
        }
    }
    coarse.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut followed: Vec<(f64, [f64; 8])> = Vec::new();
    for (_, numbers) in coarse {
        let alike = |other: &(f64, [f64; 8])| {
            (other.1[1] - numbers[1]).abs() < 0.5 && (other.1[4] - numbers[4]).abs() < 0.5
        };
        if followed.iter().any(alike) {
            continue;
        }
        followed.push((0.0, numbers));
        if followed.len() == FOLLOWED {
            break;
        }
    }
    let mut refined: Vec<(f64, [f64; 8])> = followed
        .into_par_iter()
        .map(|(_, numbers)| least_squares(points, numbers, scales))
        .collect();
    refined.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut kept: Vec<[f64; 8]> = Vec::new();
    for (_, numbers) in refined {
        let alike = |other: &[f64; 8]| {
            let sizes = sizes(scales);
            let apart = (0..8).map(|j| ((other[j] - numbers[j]) / sizes[j]).abs());
            apart.fold(0.0, f64::max) < ALIKE
        };
        if kept.len() < KEPT && !kept.iter().any(alike) {
            kept.push(numbers);
        }
    }
    kept
}

/// Sets of peaks and widths over the angle on an ellipse, with the heights that are best for each, and what they leave.
fn on_ellipse(points: &[Point], (centre, semi_axis): (f64, f64)) -> Vec<(f64, [f64; 8])> {
    const PEAKS: [f64; 8] = [-3.1, -2.2, -1.3, -0.4, 0.5, 1.4, 2.3, 3.1];
    const WIDTHS: [f64; 3] = [0.7, 1.3, 2.6];
    let bells = DMatrix::from_row_iterator(
        points.len(),
        PEAKS.len() * WIDTHS.len(),
        points.iter().flat_map(|p| {
            let alpha = angle(p, centre, semi_axis);
            let weighted = move |width: f64, peak: f64| p.weight.sqrt() * bell(alpha, peak, width);
            WIDTHS
                .into_iter()
                .flat_map(move |width| PEAKS.map(|peak| weighted(width, peak)))
        }),
    );
    let levels = DVector::from_iterator(
        points.len(),
        points.iter().map(|p| p.weight.sqrt() * p.coefficient),
    );
    let (products, pulls) = (bells.tr_mul(&bells), bells.tr_mul(&levels));
    let square = levels.norm_squared();
    let mut found = Vec::new();
    for (first, second) in [(0, 0), (1, 1), (1, 2), (2, 1)] {
        for b1 in 0..PEAKS.len() {
            for b2 in b1 + 1..PEAKS.len() {
                let own = [first * PEAKS.len() + b1, second * PEAKS.len() + b2];
                let moments = Matrix2::from_fn(|i, j| products[(own[i], own[j])]);
                let right = Vector2::from_fn(|i, _| pulls[own[i]]);
                let ridge = Matrix2::identity() * (1e-6 * moments.trace());
                let Some(cholesky) = (moments + ridge).cholesky() else {
                    continue;
                };
                let heights = cholesky.solve(&right);
                let numbers = [
                    heights[0],
                    PEAKS[b1],
                    WIDTHS[first],
                    heights[1],
                    PEAKS[b2],
                    WIDTHS[second],
                    centre,
                    semi_axis,
                ];
                found.push((square - right.dot(&heights), numbers));
            }
        }
    }
    found
}

/// How much each of the eight numbers may well change.
fn sizes(scales: &Scales) -> [f64; 8] {
    let coefficient = scales.coefficient;
    [
        coefficient,
        1.0,
        1.0,
        coefficient,
        1.0,
        1.0,
        scales.speed,
        scales.acceleration,
    ]
}

fn angle<S: Scalar>(p: &Point, centre: S, semi_axis: S) -> S {
    let along = S::constant(p.acceleration) / semi_axis;
    along.atan2((S::constant(p.speed) - centre) / centre)
}

fn bell<S: Scalar>(alpha: S, peak: S, width: S) -> S {
    let z = (alpha - peak) / width;
    (-(z * z)).exp()
}

fn level<S: Scalar>(numbers: &[S; 8], p: &Point) -> S {
    let &[a1, b1, c1, a2, b2, c2, centre, semi_axis] = numbers;
    let alpha = angle(p, centre, semi_axis);
    a1 * bell(alpha, b1, c1) + a2 * bell(alpha, b2, c2)
}

/// The median of the weighted squares of what a set of numbers leaves.
fn spread(points: &[Point], numbers: &[f64; 8]) -> f64 {
    let mut squares: Vec<f64> = points
        .iter()
        .map(|p| p.weight * (p.coefficient - level(numbers, p)).powi(2))
        .collect();
    squares.sort_by(f64::total_cmp);
    squares[squares.len() / 2].max(f64::MIN_POSITIVE)
}

/// Levenberg–Marquardt steps from a coarse set of numbers, with the sum of squares in the end.
fn least_squares(points: &[Point], start: [f64; 8], scales: &Scales) -> (f64, [f64; 8]) {
    let sizes = sizes(scales);
    let spread = spread(points, &start);
    // Where friction changes faster than readings can be smoothed, points are far off: they count less.
    let square = |numbers: &[f64; 8]| -> f64 {
        points
            .iter()
            .map(|p| {
                spread
                    * (1.0 + p.weight * (p.coefficient - level(numbers, p)).powi(2) / spread).ln()
            })
            .sum()
    };
    let mut numbers = start;
    let mut left = square(&numbers);
    let mut damping = 1e-2;
    for _ in 0..STEPS {
        let mut curvature = SMatrix::<f64, 8, 8>::zeros();
        let mut gradient = SVector::<f64, 8>::zeros();
        let free: [Dual<8>; 8] = std::array::from_fn(|j| Dual::variable(numbers[j], j));
        for p in points {
            let here = level(&free, p);
            let row = SVector::<f64, 8>::from_fn(|j, _| here.derivative[j] * sizes[j]);
            let off = p.coefficient - here.value;
            let weight = p.weight / (1.0 + p.weight * off * off / spread);
            curvature += weight * row * row.transpose();
            gradient += weight * off * row;
        }
        for j in 0..8 {
            curvature[(j, j)] *= 1.0 + damping;
            curvature[(j, j)] += 1e-9 * curvature.trace();
        }
        let Some(cholesky) = curvature.cholesky() else {
            break;
        };
        let step = cholesky.solve(&gradient);
        let mut trial = numbers;
        for j in 0..8 {
            trial[j] += step[j].clamp(-0.5, 0.5) * sizes[j];
        }
        for width in [2, 5] {
            trial[width] = trial[width].clamp(0.2, 8.0);
        }
        for peak in [1, 4] {
            trial[peak] = trial[peak].clamp(-5.0, 5.0);
        }
        trial[6] = trial[6].clamp(0.1 * scales.speed, 3.0 * scales.speed);
        trial[7] = trial[7].clamp(0.1 * scales.acceleration, 10.0 * scales.acceleration);
        let after = square(&trial);
        if after < left {
            let settled = left - after < 1e-4 * left;
            (numbers, left) = (trial, after);
            damping = (0.2 * damping).max(1e-6);
            if settled {
                break;
            }
        } else {
            damping *= 5.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    (left, numbers)
}
