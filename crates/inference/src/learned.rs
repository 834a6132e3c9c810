//! What is in no catalogue: a free function at one port over one coordinate, learned from the records.
//!
//! Its values at knots are a Gaussian process a priori, whose smoothness and size the evidence chooses, as it chooses port and
//! coordinate. The model carries the function as a table of an effect by equation and runs exactly under it; derivatives with
//! respect to the values at knots are those of the torque in each small piece of a window.

mod basis;
mod family;
mod state;
mod table;

use self::basis::{Basis, KNOTS};
pub use self::family::{FAMILIES, FRICTION_OVER_SPEED, Family};
use self::state::{State, fitted, in_weights, tabulated};
pub use self::table::TableEffect;
use crate::data::{Data, reduced};
use crate::evidence::Told;
use crate::fit::{Fit, STEPS};
use crate::hypothesis::Hypothesis;
use crate::marginal::Disturbance;
use crate::policy::{FAR, LN_PRIOR_ODDS};
use crate::problem::Problem;
use crate::structure::evidence;
use crate::window::Start;
use nalgebra::{DMatrix, DVector};

/// Distances over which a function may change, as shares of the coordinate's range.
const REACHES: [f64; 4] = [0.04, 0.08, 0.16, 0.4];
/// Sizes of a function, as shares of what it acts on.
const SIZES: [f64; 3] = [0.1, 0.3, 1.0];
/// Families that are fitted after a first look at all.
const FOLLOWED: usize = 3;
/// Steps of a fit that is carried over to small pieces.
const CLOSER: usize = 3;
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

/// The function that explains most of what `base`, the analyst's refitted model, leaves; `None` where none explains anything.
#[must_use]
pub fn learn(problem: &Problem, base: &Fit, progress: &mut dyn FnMut(&str)) -> Option<Learned> {
    progress("what a free function explains");
    let ground = Ground::new(problem, base);
    let Best {
        told,
        state,
        basis,
        root,
    } = ground.best(&FAMILIES, progress)?;
    let gain = told.total() - ground.base.told(&ground.data).total();
    if gain < -LN_PRIOR_ODDS {
        return None;
    }
    let (table, deviations) = tabulated(&basis, &state, &root)?;
    let hypothesis = state.fit.hypothesis.clone();
    let starts = without_torques(&state.fit.starts);
    let fit = Fit::at(&problem.long, hypothesis, starts, Disturbance::NONE);
    Some(Learned {
        family: basis.family,
        range: [
            table.knots[0],
            table.period.unwrap_or(table.knots[KNOTS - 1]),
        ],
        table,
        deviations,
        fit: fit.improved(&problem.long, STEPS),
        gain,
    })
}

/// Log evidence of friction that is a free function of the speed, on top of `base`, the analyst's refitted model.
#[must_use]
pub fn friction_over_speed(
    problem: &Problem,
    base: &Fit,
    progress: &mut dyn FnMut(&str),
) -> Option<Told> {
    let ground = Ground::new(problem, base);
    let best = ground.best(&[FRICTION_OVER_SPEED], progress)?;
    Some(best.told)
}

/// What functions are fitted to.
struct Ground<'a> {
    problem: &'a Problem,
    /// The windows in small pieces.
    data: Data,
    /// The same for short windows.
    short: Data,
    /// The analyst's refitted model on them.
    base: Fit,
}

/// The best function of some families.
struct Best<'a> {
    told: Told,
    state: State,
    basis: Basis<'a>,
    root: DMatrix<f64>,
}

impl<'a> Ground<'a> {
    fn new(problem: &'a Problem, base: &Fit) -> Self {
        // Fluctuating friction stands in for what is missing: the function is learned as if there were none.
        let [short, data] = [&problem.short, &problem.long]
            .map(|data| data.clone().finely_divided().with_motor_torques());
        let hypothesis = base.hypothesis.clone();
        Self {
            problem,
            base: begun(&data, hypothesis, without_torques(&base.starts)),
            data,
            short,
        }
    }

    /// The function of the families given that explains most.
    fn best(&self, families: &[Family], progress: &mut dyn FnMut(&str)) -> Option<Best<'a>> {
        let Self {
            problem,
            data,
            short,
            base,
        } = self;
        // Over short windows even a wrong model stays near the motion, so that a step tells what a function will do.
        let is_far = base.misfit(data) > FAR;
        let near = is_far.then(|| begun(short, base.hypothesis.clone(), short.anchors()));
        let (first, fit) = near.as_ref().map_or((data, base), |near| (short, near));
        let mut best: Option<Best<'a>> = None;
        for (_, basis, root) in looks(problem, first, fit, families) {
            progress(&basis.family.name());
            let nothing = (fit.hypothesis.clone(), DVector::zeros(KNOTS));
            let mut state = fitted(&basis, first, &root, nothing, fit.starts.clone());
            if is_far {
                let carried =
                    |near: State| fitted(&basis, data, &root, near.values(), data.anchors());
                state = state.and_then(carried);
            }
            let Some(state) = state else {
                continue;
            };
            let told = state.told(data);
            if best
                .as_ref()
                .is_none_or(|other| told.total() > other.told.total())
            {
                best = Some(Best {
                    told,
                    state,
                    basis,
                    root,
                });
            }
        }
        best
    }
}

fn begun(data: &Data, hypothesis: Hypothesis, starts: Vec<Start>) -> Fit {
    Fit::at(data, hypothesis, starts, Disturbance::NONE).improved_calmly(data, CLOSER)
}

/// The same starts for pieces of another length, in which these torques have no place.
fn without_torques(starts: &[Start]) -> Vec<Start> {
    starts
        .iter()
        .map(|start| Start::from(start.state))
        .collect()
}

/// The families that promise most in one step from `base`, each with the smoothness and the size that do.
fn looks<'a>(
    problem: &'a Problem,
    data: &Data,
    base: &Fit,
    families: &[Family],
) -> Vec<(f64, Basis<'a>, DMatrix<f64>)> {
    let own = base.hypothesis.dimension();
    let mut precisions = base.hypothesis.prior_precisions();
    let mut x = base.hypothesis.x.clone();
    precisions.resize(own + KNOTS, 1.0);
    x.resize(own + KNOTS, 0.0);
    let sizes = || {
        REACHES
            .iter()
            .flat_map(|reach| SIZES.map(|size| (*reach, size)))
    };
    let mut looks: Vec<(f64, Basis<'_>, DMatrix<f64>)> = families
        .iter()
        .filter_map(|family| {
            let basis = Basis::new(problem, *family, &base.grams)?;
            let augmented = basis.augmented(&base.grams, &[0.0; KNOTS]);
            let forms = reduced(data, &base.starts, &augmented, &base.disturbance);
            let told = |(reach, size)| {
                let root = basis.root(reach, size)?;
                let told = evidence(data, &in_weights(&forms, own, &root), &precisions, &x)?;
                Some((told.total(), root))
            };
            let best = sizes().filter_map(told).max_by(|a, b| a.0.total_cmp(&b.0));
            best.map(|(told, root)| (told, basis, root))
        })
        .collect();
    looks.sort_by(|a, b| b.0.total_cmp(&a.0));
    looks.truncate(FOLLOWED);
    looks
}
