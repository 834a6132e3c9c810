//! Differential evolution (Storn and Price 1997) with a target set instead of a target point.
//!
//! A trial replaces its parent when it is not worse. Where the cost is flat at zero, the population therefore keeps moving
//! and spreads over the set of all solutions.

use inference::random::Random;

/// A point of the unit cube with its cost.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// Coordinates, each in 0 … 1.
    pub place: Vec<f64>,
    /// Cost, ≥ 0.
    pub cost: f64,
}

/// A population that evolves.
#[derive(Debug, Clone, PartialEq)]
pub struct Population {
    /// The members.
    pub members: Vec<Member>,
    random: Random,
}

impl Population {
    /// Members strewn over the unit cube of the given dimension, one in each of `size` layers of every coordinate (Latin
    /// hypercube). `cost` judges many places at once.
    #[must_use]
    pub fn strewn(
        size: usize,
        dimension: usize,
        seed: u64,
        cost: impl Fn(&[Vec<f64>]) -> Vec<f64>,
    ) -> Self {
        let mut random = Random::new(seed);
        let mut places = vec![vec![0.0; dimension]; size];
        for coordinate in 0..dimension {
            let mut layers: Vec<usize> = (0..size).collect();
            for last in (1..size).rev() {
                layers.swap(last, random.index(last + 1));
            }
            for (place, layer) in places.iter_mut().zip(layers) {
                place[coordinate] = (layer as f64 + random.uniform()) / size as f64;
            }
        }
        let costs = cost(&places);
        Self {
            members: places
                .into_iter()
                .zip(costs)
                .map(|(place, cost)| Member { place, cost })
                .collect(),
            random,
        }
    }

    /// One generation; returns how many members have cost 0.
    pub fn evolve(&mut self, cost: impl Fn(&[Vec<f64>]) -> Vec<f64>) -> usize {
        let count = self.members.len();
        let best = self.best().place.clone();
        let trials: Vec<Vec<f64>> = (0..count).map(|index| self.trial(index, &best)).collect();
        let costs = cost(&trials);
        for ((member, place), cost) in self.members.iter_mut().zip(trials).zip(costs) {
            if cost <= member.cost {
                *member = Member { place, cost };
            }
        }
        self.members
            .iter()
            .filter(|member| member.cost == 0.0)
            .count()
    }

    /// The member with the least cost.
    #[must_use]
    pub fn best(&self) -> &Member {
        self.members
            .iter()
            .min_by(|left, right| left.cost.total_cmp(&right.cost))
            .unwrap_or(&self.members[0])
    }

    fn trial(&mut self, index: usize, best: &[f64]) -> Vec<f64> {
        let count = self.members.len();
        let [mut first, mut second, mut third] = [index; 3];
        while first == index {
            first = self.random.index(count);
        }
        while second == index || second == first {
            second = self.random.index(count);
        }
        while third == index || third == first || third == second {
            third = self.random.index(count);
        }
        let factor = 0.4 + 0.5 * self.random.uniform();
        let greedy = self.random.uniform() < 0.3 && self.members[index].cost > 0.0;
        let dimension = best.len();
        let kept = self.random.index(dimension);
        (0..dimension)
            .map(|coordinate| {
                let here = self.members[index].place[coordinate];
                if coordinate != kept && self.random.uniform() > 0.9 {
                    return here;
                }
                let pull = if greedy {
                    best[coordinate]
                } else {
                    self.members[third].place[coordinate]
                };
                let difference =
                    self.members[first].place[coordinate] - self.members[second].place[coordinate];
                let value = pull + factor * difference;
                if (0.0..=1.0).contains(&value) {
                    value
                } else {
                    self.random.uniform()
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_of_many_valleys_is_found() {
        // Rastrigin's function about 0.3.
        let cost = |places: &[Vec<f64>]| -> Vec<f64> {
            let term = |x: &f64| {
                let y = 10.0 * (x - 0.3);
                y * y + 10.0 * (1.0 - (std::f64::consts::TAU * y).cos())
            };
            places
                .iter()
                .map(|place| place.iter().map(term).sum())
                .collect()
        };
        let mut population = Population::strewn(40, 4, 1, cost);
        for _ in 0..400 {
            population.evolve(cost);
        }
        assert!(population.best().cost < 1e-6, "{:?}", population.best());
    }

    #[test]
    fn the_population_spreads_over_a_flat_set() {
        let cost = |places: &[Vec<f64>]| -> Vec<f64> {
            places
                .iter()
                .map(|place| ((place[0] + place[1] - 1.0).abs() - 0.02).max(0.0))
                .collect()
        };
        let mut population = Population::strewn(30, 2, 7, cost);
        let mut met = 0;
        for _ in 0..100 {
            met = population.evolve(cost);
        }
        assert_eq!(met, 30);
        let first: Vec<f64> = population
            .members
            .iter()
            .map(|member| member.place[0])
            .collect();
        let span = first.iter().fold(0.0_f64, |high, x| high.max(*x))
            - first.iter().fold(1.0_f64, |low, x| low.min(*x));
        assert!(span > 0.6, "{first:?}");
    }
}
