//! Which cases to make on other rigs.

use crate::error::MakerError;
use crate::excitation::Brake;
use crate::hidden_effect::Effect;
use crate::kinds::{in_turn, only};
use crate::other_rigs::case::{OtherCase, RigChoice};
use crate::plan::{Measured, check_seeds, check_sizes};
use crate::random::{Purpose, Stream};
use crate::recipe::Kind;

/// How many effects and of which sort.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sort {
    /// One effect of a catalogue.
    Single,
    /// Two.
    Pair,
    /// Three.
    Triple,
    /// One that no catalogue has.
    Outside,
    /// None.
    Clean,
}

/// Effects that can sit on either disc of the full rig.
pub const ON_EITHER_DISC: [Effect; 6] = [
    Effect::Unbalance,
    Effect::ViscousDrag,
    Effect::QuadraticDrag,
    Effect::BearingFriction,
    Effect::NormalForceWobble,
    Effect::ShaftHardening,
];

/// What to make on other rigs.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherWish {
    /// First seed; case `k` has seed + k.
    pub seed: u64,
    /// Number of cases.
    pub cases: usize,
    /// How many effects and of which sort.
    pub sort: Sort,
    /// Only this kind.
    pub kind: Option<String>,
    /// What every case has in common.
    pub common: OtherCase,
}

/// Every kind of `sort`, on the full rig if `full_rig`.
pub fn kinds(sort: Sort, full_rig: bool) -> Vec<Kind> {
    let on_either = ON_EITHER_DISC.map(|effect| [(effect, true), (effect, false)]);
    let choices: Vec<(Effect, bool)> = if full_rig {
        on_either.concat()
    } else {
        Effect::catalogue().map(|effect| (effect, false)).collect()
    };
    let sets_of = |count| {
        let sets = combinations(&choices, count);
        sets.iter().map(|set| Kind::of(set)).collect()
    };
    match sort {
        Sort::Clean => vec![Kind::clean(Brake::On)],
        Sort::Outside => Kind::outsiders(true),
        Sort::Single => {
            let further = Kind::under_other_laws().filter(|_| !full_rig);
            let singles = choices.iter().map(|&choice| Kind::of(&[choice]));
            singles.chain(further).collect()
        }
        Sort::Pair => sets_of(2),
        Sort::Triple => sets_of(3),
    }
}

/// Every set of `count` effects that records can part: not two laws, no effect twice, and not
/// `motor_viscous` with `supply_sag`.
pub(crate) fn combinations(choices: &[(Effect, bool)], count: usize) -> Vec<Vec<(Effect, bool)>> {
    let mut sets: Vec<Vec<(Effect, bool)>> = vec![Vec::new()];
    for &choice in choices {
        let longer: Vec<_> = sets
            .iter()
            .filter(|set| set.len() < count && fits(set, choice.0))
            .map(|set| set.iter().copied().chain([choice]).collect())
            .collect();
        sets.extend(longer);
    }
    sets.retain(|set| set.len() == count);
    sets.iter_mut().for_each(|set| set.sort());
    sets
}

fn fits(set: &[(Effect, bool)], effect: Effect) -> bool {
    let one_law = effect.replaced_law().is_none()
        || set.iter().all(|(other, _)| other.replaced_law().is_none());
    let partable = |other: Effect| {
        let pair = [other.min(effect), other.max(effect)];
        other != effect && pair != [Effect::MotorViscous, Effect::SupplySag]
    };
    one_law && set.iter().all(|(other, _)| partable(*other))
}

impl OtherWish {
    /// The cases wished for.
    ///
    /// # Errors
    /// The seeds touch those of the suites, a number is out of range, or no kind has that name.
    pub fn plan(&self) -> Result<Vec<OtherCase>, MakerError> {
        check_seeds(self.seed, self.cases)?;
        check_sizes(self.common.size, self.common.noise)?;
        let full_rig = self.common.rig == RigChoice::Full;
        let kinds = kinds(self.sort, full_rig);
        let mut kinds = only(kinds, self.kind.as_deref(), |kind| &kind.name)?;
        if matches!(self.sort, Sort::Pair | Sort::Triple) {
            Stream::new(self.seed, Purpose::Recipe).shuffle(&mut kinds);
        }
        let case = |(name, seed, kind)| OtherCase {
            name,
            kind,
            seed,
            ..self.common.clone()
        };
        Ok(in_turn(&kinds, self.seed, self.cases).map(case).collect())
    }
}

/// Everything neutral: a clean case of any rig.
impl Default for OtherCase {
    fn default() -> Self {
        Self {
            name: String::new(),
            kind: Kind::clean(Brake::On),
            seed: 0,
            rig: RigChoice::Drawn,
            size: (1.0, 1.0),
            share_laws: false,
            rough: false,
            noise: 1.0,
            measured: Measured::default(),
            load_reference: Some(50.0),
        }
    }
}
