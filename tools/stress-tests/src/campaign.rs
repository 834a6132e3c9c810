//! Sequences of random calls until a number of calls is reached; a failing one is shortened before it is shown.

use std::fmt;
use std::time::{Duration, Instant};

use crate::call::{Call, SLOTS};
use crate::call_sequence::CallSequence;
use crate::component::Component;
use crate::generate::generate;
use crate::library::Library;
use crate::random::Random;
use crate::standard::Version;

/// Actions of one sequence: long enough for a life of many instances, short enough to be shortened.
const SEQUENCE: usize = 2000;

/// What a campaign did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// Sequences.
    pub sequences: u64,
    /// Library calls.
    pub calls: u64,
    /// Calls that were refused as the standard wants it.
    pub refused: u64,
    /// The longest that one call took, the native model's share included.
    pub longest: Duration,
}

/// A sequence that the library did not stand.
#[derive(Debug)]
pub struct Failure {
    /// Seed of the sequence.
    pub seed: u64,
    /// What the library did otherwise than it should.
    pub problem: String,
    /// The calls that are left after shortening.
    pub calls: Vec<Call>,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} (sequence --seed {})", self.problem, self.seed)?;
        for call in &self.calls {
            writeln!(f, "  {call:?}")?;
        }
        Ok(())
    }
}

/// Runs sequences, the first with `seed`, the next with one more, until `calls` library calls are made.
///
/// # Errors
/// The first sequence that fails, shortened.
pub fn run(
    library: &Library,
    components: &[Component; 2],
    version: Version,
    seed: u64,
    calls: u64,
    mut progress: impl FnMut(Tally),
) -> Result<Tally, Failure> {
    let mut tally = Tally::default();
    while tally.calls < calls {
        let seed = seed + tally.sequences;
        let mut call_sequence = CallSequence::new(library, components, version);
        let (mut random, mut script) = (Random::new(seed), Vec::with_capacity(SEQUENCE));
        for _ in 0..SEQUENCE {
            let slot = random.index(SLOTS);
            let call = generate(&mut random, slot, call_sequence.view(slot));
            script.push(call);
            let Some(call) = script.last() else { break };
            let begin = Instant::now();
            let result = call_sequence.carry_out(call);
            tally.longest = tally.longest.max(begin.elapsed());
            if let Err(problem) = result {
                call_sequence.finish();
                let fails = |script: &[Call]| replay(library, components, version, script).is_err();
                let calls = shortened(script, fails);
                return Err(Failure {
                    seed,
                    problem,
                    calls,
                });
            }
        }
        call_sequence.finish();
        tally.sequences += 1;
        tally.calls += call_sequence.calls;
        tally.refused += call_sequence.refused;
        progress(tally);
    }
    Ok(tally)
}

fn replay(
    library: &Library,
    components: &[Component; 2],
    version: Version,
    script: &[Call],
) -> Result<(), String> {
    let mut call_sequence = CallSequence::new(library, components, version);
    let result = script
        .iter()
        .try_for_each(|call| call_sequence.carry_out(call));
    call_sequence.finish();
    result
}

/// Leaves out of a failing list what it fails without: halves first, then smaller and smaller parts.
fn shortened<T: Clone>(mut list: Vec<T>, fails: impl Fn(&[T]) -> bool) -> Vec<T> {
    let mut part = list.len() / 2;
    while part > 0 {
        let mut begin = 0;
        while begin < list.len() {
            let mut without = list.clone();
            without.drain(begin..(begin + part).min(list.len()));
            if fails(&without) {
                list = without;
            } else {
                begin += part;
            }
        }
        part /= 2;
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shortening_leaves_what_matters() {
        let both = |list: &[i32]| list.contains(&7) && list.contains(&93);
        assert_eq!(shortened((0..1000).collect(), both), [7, 93]);
    }
}
