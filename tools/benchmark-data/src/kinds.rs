//! Which kind is hidden in which case of a set: one after the other.

use crate::error::MakerError;

/// Name, seed and kind of so many cases from `seed` on: one of `kinds` after the other, or `only` one of them.
///
/// # Errors
/// No kind has the name `only`.
pub fn in_turn(
    kinds: &[&'static str],
    seed: u64,
    cases: usize,
    only: Option<&str>,
) -> Result<Vec<(String, u64, &'static str)>, MakerError> {
    let kinds: Vec<&'static str> = kinds
        .iter()
        .copied()
        .filter(|own| only.is_none_or(|only| only == *own))
        .collect();
    if kinds.is_empty() {
        return Err(MakerError::NoKind(only.unwrap_or_default().to_owned()));
    }
    Ok((0..cases)
        .map(|at| {
            (
                format!("case-{at:04}"),
                seed + at as u64,
                kinds[at % kinds.len()],
            )
        })
        .collect())
}
