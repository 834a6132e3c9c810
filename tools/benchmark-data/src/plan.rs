//! Which cases to make: suites with seeds of their own, or cases on demand.

use crate::error::MakerError;
use crate::excitation::Brake;
use crate::kinds::in_turn;
use crate::random::{Purpose, Stream};
use crate::recipe::{Kind, Recipe};
use crate::records::Sensors;
use clap::ValueEnum;
use strum::IntoStaticStr;

/// Seeds kept for the suites.
const RESERVED_SEEDS: core::ops::Range<u64> = 10_000..30_000;
/// Seeds each group of a suite may use.
const SEEDS_PER_GROUP: u64 = 1_000;

/// Size over practice size of a full effect.
pub const FULL_SIZE: (f64, f64) = (0.6, 1.4);
/// Size over practice size of a small effect.
pub const SMALL_SIZE: (f64, f64) = (0.05, 0.2);

/// A sealed set of cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Suite {
    /// For setting thresholds; seeds from 10000.
    Calibration,
    /// For the one final run; seeds from 20000.
    Final,
}

/// A part of a suite, in order of their seeds; the group's name starts the names of its cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum Group {
    /// One effect at 0.6 to 1.4 of the practice size.
    Full,
    /// One effect at half of that under random friction.
    Rough,
    /// One effect at 0.05 to 0.2.
    Small,
    /// Nothing hidden: braked, without brake, rough.
    Clean,
    /// Two effects.
    Pairs,
    /// Effects in no catalogue.
    Outside,
    /// One effect at 0.1, 0.33, 1 and 2.
    Sizes,
    /// One full effect with instruments half and twice as noisy.
    Noise,
    /// Kinds that the practice records do not have: presliding, and shares of a law.
    Further,
}

/// A case with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedCase {
    /// Directory name; says nothing about the kind.
    pub name: String,
    /// How to draw it.
    pub recipe: Recipe,
    /// What is measured.
    pub measured: Measured,
}

/// What is measured, and whether anybody knows by what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Measured {
    /// Which channels.
    pub sensors: Sensors,
    /// Whether the instruments are unknown.
    pub unknown: bool,
}

/// What to make when no suite is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    /// First seed; case `k` has seed + k.
    pub seed: u64,
    /// Number of cases.
    pub cases: usize,
    /// Kinds to go round, in this order.
    pub kinds: Vec<Kind>,
    /// Size range over practice size.
    pub scale: (f64, f64),
    /// Whether a contact that follows another law does so in part, as far as the size says, instead of wholly.
    pub share_laws: bool,
    /// Whether friction fluctuates.
    pub rough: bool,
    /// Factor on sensor noise.
    pub noise: f64,
    /// What is measured.
    pub measured: Measured,
}

impl Group {
    /// Number of cases if not said otherwise.
    pub fn default_cases(self) -> usize {
        match self {
            Self::Full | Self::Small => 44,
            Self::Rough => 36,
            Self::Clean => 160,
            Self::Pairs => 40,
            Self::Outside => 28,
            Self::Sizes => 88,
            Self::Noise => 22,
            Self::Further => 20,
        }
    }

    /// Kinds the group goes round.
    pub fn kinds(self) -> Vec<Kind> {
        match self {
            Self::Full | Self::Small | Self::Sizes | Self::Noise => Kind::singles(),
            Self::Rough => Kind::singles()
                .into_iter()
                .filter(|kind| kind.brake == Brake::On)
                .collect(),
            Self::Clean => [Brake::On, Brake::On, Brake::Off, Brake::On]
                .map(Kind::clean)
                .to_vec(),
            Self::Pairs => Kind::pairs(),
            Self::Outside => Kind::outsiders(false),
            Self::Further => Kind::further(),
        }
    }

    fn recipe(self, kind: Kind, round: usize, index: usize, seed: u64) -> Recipe {
        let sizes = [0.1, 0.33, 1.0, 2.0];
        let size = sizes[round % sizes.len()];
        let scale = match self {
            Self::Full | Self::Noise | Self::Pairs => FULL_SIZE,
            Self::Further if round.is_multiple_of(2) => FULL_SIZE,
            Self::Further => SMALL_SIZE,
            Self::Rough => (0.3, 0.7),
            Self::Small => SMALL_SIZE,
            Self::Clean | Self::Outside => (1.0, 1.0),
            Self::Sizes => (size, size),
        };
        let rough = self == Self::Rough || (self == Self::Clean && index % 4 == 3);
        let share_laws = matches!(self, Self::Sizes | Self::Further);
        Recipe {
            scale: law_share(&kind, scale, share_laws),
            kind,
            seed,
            rough,
            noise: match self {
                Self::Noise if index.is_multiple_of(2) => 0.5,
                Self::Noise => 2.0,
                _ => 1.0,
            },
        }
    }
}

impl Suite {
    /// First seed.
    pub fn first_seed(self) -> u64 {
        match self {
            Self::Calibration => 10_000,
            Self::Final => 20_000,
        }
    }

    /// The cases of `groups`, `cases` of each (`None`: the group's own number, at most 1000).
    pub fn plan(self, groups: &[Group], cases: Option<usize>) -> Vec<PlannedCase> {
        let mut planned = Vec::new();
        for (rank, group) in Group::value_variants().iter().enumerate() {
            if !groups.contains(group) {
                continue;
            }
            let first_seed = self.first_seed() + rank as u64 * SEEDS_PER_GROUP;
            let mut kinds = group.kinds();
            if *group == Group::Pairs {
                Stream::new(first_seed, Purpose::Recipe).shuffle(&mut kinds);
            }
            let count = cases
                .unwrap_or(group.default_cases())
                .min(SEEDS_PER_GROUP as usize);
            for index in 0..count {
                let kind = kinds[index % kinds.len()].clone();
                let seed = first_seed + index as u64;
                planned.push(PlannedCase {
                    name: format!("{}-{index:04}", <&str>::from(group)),
                    recipe: group.recipe(kind, index / kinds.len(), index, seed),
                    measured: Measured::default(),
                });
            }
        }
        planned
    }
}

impl Wish {
    /// The cases wished for.
    ///
    /// # Errors
    /// The seeds touch those of the suites, or a number is out of range.
    pub fn plan(&self) -> Result<Vec<PlannedCase>, MakerError> {
        check_seeds(self.seed, self.cases)?;
        check_sizes(self.scale, self.noise)?;
        let case = |(name, seed, kind)| PlannedCase {
            name,
            recipe: Recipe {
                scale: law_share(&kind, self.scale, self.share_laws),
                kind,
                seed,
                rough: self.rough,
                noise: self.noise,
            },
            measured: self.measured,
        };
        let cases = in_turn(&self.kinds, self.seed, self.cases);
        Ok(cases.map(case).collect())
    }
}

/// Refuses seeds that belong to a suite.
pub(crate) fn check_seeds(first: u64, cases: usize) -> Result<(), MakerError> {
    let last = first.saturating_add(cases.max(1) as u64 - 1);
    if first < RESERVED_SEEDS.end && last >= RESERVED_SEEDS.start {
        return Err(MakerError::ReservedSeeds { first, last });
    }
    Ok(())
}

/// Refuses sizes and noise out of range.
pub(crate) fn check_sizes(size: (f64, f64), noise: f64) -> Result<(), MakerError> {
    in_range("--size", size.0, 0.01, 3.0, "between 0.01 and 3")?;
    in_range("--noise", noise, 0.0, 100.0, "between 0 and 100")
}

/// Share of a law that is hidden: all of it, whatever the size of other effects, unless shares are asked for.
fn law_share(kind: &Kind, scale: (f64, f64), share_laws: bool) -> (f64, f64) {
    if kind.replaces_law() && !share_laws {
        (1.0, 1.0)
    } else {
        scale
    }
}

fn in_range(
    name: &'static str,
    value: f64,
    low: f64,
    high: f64,
    expected: &'static str,
) -> Result<(), MakerError> {
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(MakerError::OutOfRange {
            name,
            value,
            expected,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn suites_share_no_seed_and_repeat_none() {
        let seeds = |suite: Suite| -> Vec<u64> {
            let plan = suite.plan(Group::value_variants(), None);
            plan.iter().map(|case| case.recipe.seed).collect()
        };
        let (calibration, last) = (seeds(Suite::Calibration), seeds(Suite::Final));
        let all: BTreeSet<u64> = calibration.iter().chain(&last).copied().collect();
        assert_eq!(all.len(), calibration.len() + last.len());
        assert!(all.iter().all(|seed| RESERVED_SEEDS.contains(seed)));
    }

    #[test]
    fn laws_are_hidden_whole_unless_shares_are_asked_for() {
        for kind in Kind::singles() {
            let (whole, share) = (
                law_share(&kind, SMALL_SIZE, false),
                law_share(&kind, SMALL_SIZE, true),
            );
            assert_eq!(share, SMALL_SIZE);
            assert_eq!(whole == (1.0, 1.0), kind.replaces_law(), "{}", kind.name);
        }
    }

    #[test]
    fn wishes_keep_off_the_seeds_of_the_suites() {
        let wish = Wish {
            seed: 9_999,
            cases: 2,
            kinds: Kind::singles(),
            scale: (1.0, 1.0),
            share_laws: false,
            rough: false,
            noise: 1.0,
            measured: Measured::default(),
        };
        assert!(matches!(
            wish.plan(),
            Err(MakerError::ReservedSeeds { last: 10_000, .. })
        ));
    }
}
