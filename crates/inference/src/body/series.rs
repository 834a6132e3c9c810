//! What a term of a model gives to the compared force of a record, as far as it is the same for many models.
//!
//! Low-pass and thinning are linear. So a term that is linear in some of its numbers comes to a sum of series, one for each of these, which
//! depend on its other numbers alone. Fits change few of those at a time, and sets of effects share most of their terms.

use std::collections::HashMap;
use std::mem;
use std::sync::{Arc, Mutex, PoisonError};

/// Numbers that are remembered at least, of each record: 32 MB at most of both generations.
const REMEMBERED: usize = 1 << 21;

/// On what a term's series depend: its name, and the bits of its numbers that are not linear, of the motion's shift and of other terms.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Key {
    /// The term's name.
    pub term: &'static str,
    /// Bits of the numbers on which its series depend.
    pub bits: Vec<u64>,
}

/// A term's force at the compared moments.
#[derive(Debug, Clone, Default)]
pub struct Series {
    /// With all linear numbers at zero; `None` where that is zero.
    pub constant: Option<Vec<f64>>,
    /// What one more of each linear number adds.
    pub slopes: Vec<Vec<f64>>,
}

impl Series {
    fn size(&self) -> usize {
        let all = self.slopes.iter().chain(&self.constant);
        all.map(Vec::len).sum()
    }
}

/// Series that were found before. The longest unused are forgotten.
#[derive(Debug, Default)]
pub struct Memory(Mutex<Generations>);

#[derive(Debug, Default)]
struct Generations {
    young: HashMap<Key, Arc<Series>>,
    old: HashMap<Key, Arc<Series>>,
    /// Numbers in the young.
    size: usize,
}

impl Memory {
    /// The series of this key, found by `find` where it is not remembered.
    pub fn get(&self, key: Key, find: impl FnOnce() -> Series) -> Arc<Series> {
        if let Some(known) = self.with(|all| all.remember(&key)) {
            return known;
        }
        let found = Arc::new(find());
        self.with(|all| all.add(key, found.clone()));
        found
    }

    fn with<T>(&self, of: impl FnOnce(&mut Generations) -> T) -> T {
        // A panic elsewhere leaves whole entries.
        of(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Generations {
    fn remember(&mut self, key: &Key) -> Option<Arc<Series>> {
        if let Some(own) = self.young.get(key) {
            return Some(own.clone());
        }
        let own = self.old.remove(key)?;
        self.add(key.clone(), own.clone());
        Some(own)
    }

    fn add(&mut self, key: Key, series: Arc<Series>) {
        if self.size > REMEMBERED {
            self.old = mem::take(&mut self.young);
            self.size = 0;
        }
        self.size += series.size();
        self.young.insert(key, series);
    }
}
