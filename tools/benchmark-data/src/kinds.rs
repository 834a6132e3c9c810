//! Which kind is hidden in which case of a set: one after the other.

use crate::case_files::{Case, MadeCase};
use crate::error::MakerError;

/// Cases on plants of one sort.
#[derive(Debug)]
pub struct Set {
    /// What can be hidden: names of effects, `outside_…` where no catalogue has it.
    pub kinds: &'static [&'static str],
    /// Draws and simulates a case.
    pub make: fn(&SetCase) -> MadeCase,
}

/// One case of a set.
#[derive(Debug, Clone)]
pub struct SetCase {
    /// Directory name.
    pub name: String,
    /// Seed of all that is drawn.
    pub seed: u64,
    /// One of the set's kinds.
    pub kind: &'static str,
    make: fn(&Self) -> MadeCase,
}

impl Set {
    /// So many cases from `seed` on: one kind after the other, or one kind alone.
    ///
    /// # Errors
    /// No kind has this name.
    pub fn plan(
        &self,
        seed: u64,
        cases: usize,
        kind: Option<&str>,
    ) -> Result<Vec<SetCase>, MakerError> {
        let kinds = only(self.kinds.to_vec(), kind, |own| own)?;
        let case = |(name, seed, kind)| SetCase {
            name,
            seed,
            kind,
            make: self.make,
        };
        Ok(in_turn(&kinds, seed, cases).map(case).collect())
    }
}

impl Case for SetCase {
    fn name(&self) -> &str {
        &self.name
    }

    fn make(&self) -> Result<MadeCase, MakerError> {
        Ok((self.make)(self))
    }
}

/// All of `kinds`, or those alone whose name is `wanted`.
///
/// # Errors
/// No kind has that name.
pub(crate) fn only<K>(
    mut kinds: Vec<K>,
    wanted: Option<&str>,
    name: impl Fn(&K) -> &str,
) -> Result<Vec<K>, MakerError> {
    kinds.retain(|kind| wanted.is_none_or(|wanted| wanted == name(kind)));
    if kinds.is_empty() {
        return Err(MakerError::NoKind(wanted.unwrap_or_default().to_owned()));
    }
    Ok(kinds)
}

/// Name, seed and kind of so many cases from `seed` on.
pub(crate) fn in_turn<K: Clone>(
    kinds: &[K],
    seed: u64,
    cases: usize,
) -> impl Iterator<Item = (String, u64, K)> {
    (0..cases).map(move |at| {
        let kind = kinds[at % kinds.len()].clone();
        (format!("case-{at:04}"), seed + at as u64, kind)
    })
}
