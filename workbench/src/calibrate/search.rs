//! Global, then local: from a target to the set of parameter values that meet it.

use stickslip::plant::Rig;

use super::cost::Judgement;
use super::evolution::Population;
use super::simplex;
use super::target::Target;

/// Evaluations of the local search.
const LOCAL_EVALUATIONS: usize = 250;
/// First size of the local search's simplex, as a share of each parameter's range.
const LOCAL_SIZE: f64 = 0.02;

/// A parameter set with its judgement.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Values of the sought parameters, in the target's order.
    pub values: Vec<f64>,
    /// How it meets the target.
    pub judgement: Judgement,
}

/// What a calibration finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The best set after the local searches.
    pub best: Solution,
    /// All sets found that meet every bar.
    pub ensemble: Vec<Solution>,
    /// Parameter sets that were judged.
    pub evaluations: usize,
}

impl Calibration {
    /// Lowest and highest value of each sought parameter over the ensemble.
    #[must_use]
    pub fn ranges(&self) -> Vec<(f64, f64)> {
        (0..self.best.values.len())
            .map(|index| {
                self.ensemble.iter().fold(
                    (f64::INFINITY, f64::NEG_INFINITY),
                    |(low, high), solution| {
                        (
                            low.min(solution.values[index]),
                            high.max(solution.values[index]),
                        )
                    },
                )
            })
            .collect()
    }
}

fn values_at(target: &Target, place: &[f64]) -> Vec<f64> {
    target
        .parameter
        .iter()
        .zip(place)
        .map(|(sought, x)| sought.minimum + x * (sought.maximum - sought.minimum))
        .collect()
}

/// Judges many places, on all processors.
fn judge_all(rig: &Rig<f64>, target: &Target, places: &[Vec<f64>]) -> Vec<Judgement> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let share = places.len().div_ceil(workers).max(1);
    let judge = |place: &Vec<f64>| Judgement::of(rig, target, &values_at(target, place));
    std::thread::scope(|scope| {
        let handles: Vec<_> = places
            .chunks(share)
            .map(|chunk| scope.spawn(move || chunk.iter().map(judge).collect::<Vec<_>>()))
            .collect();
        handles
            .into_iter()
            .flat_map(|handle| handle.join().unwrap_or_default())
            .collect()
    })
}

/// Searches; `progress` hears of every generation (start, generation, sets that meet the bars).
#[must_use]
pub fn search(
    rig: &Rig<f64>,
    target: &Target,
    progress: impl Fn(usize, usize, usize),
) -> Calibration {
    let costs = |places: &[Vec<f64>]| -> Vec<f64> {
        judge_all(rig, target, places)
            .iter()
            .map(Judgement::excess)
            .collect()
    };
    let settings = &target.search;
    let mut evaluations = 0;
    let mut ensemble = Vec::new();
    let mut best: Option<(f64, Vec<f64>)> = None;
    for start in 0..settings.starts {
        let seed = settings.seed.wrapping_add(1000 * start as u64);
        let mut population =
            Population::strewn(settings.population, target.parameter.len(), seed, costs);
        evaluations += settings.population;
        for generation in 0..settings.generations {
            let met = population.evolve(costs);
            evaluations += settings.population;
            progress(start, generation, met);
        }
        ensemble.extend(
            population
                .members
                .iter()
                .filter(|member| member.cost == 0.0)
                .map(|member| member.place.clone()),
        );
        let distance =
            |place: &[f64]| Judgement::of(rig, target, &values_at(target, place)).distance();
        let lead = population.best().place.clone();
        let (place, value) = simplex::improve(&lead, LOCAL_SIZE, LOCAL_EVALUATIONS, distance);
        evaluations += LOCAL_EVALUATIONS;
        if best.as_ref().is_none_or(|(least, _)| value < *least) {
            best = Some((value, place));
        }
    }
    let place = best.map(|(_, place)| place).unwrap_or_default();
    let solution = |place: &Vec<f64>, judgement: Judgement| Solution {
        values: values_at(target, place),
        judgement,
    };
    let mut places = ensemble;
    places.push(place.clone());
    let judgements = judge_all(rig, target, &places);
    let mut solutions: Vec<Solution> = places
        .iter()
        .zip(judgements)
        .map(|(place, judgement)| solution(place, judgement))
        .collect();
    let best = solutions[solutions.len() - 1].clone();
    solutions.retain(|solution| solution.judgement.excess() == 0.0);
    Calibration {
        best,
        ensemble: solutions,
        evaluations,
    }
}
