//! The table of live handles.
//!
//! What an importer holds is a number that names a slot and a generation, never an address: a handle
//! that was freed, forged or is in use by another thread is recognised without touching memory that
//! it might point to. Taking a slot is one compare-and-swap on the slot itself; the lock on the list
//! of free slots is for creating and freeing only. The first slots lie in the library itself, so that
//! importers who unload it leave nothing behind unless they had more than 256 instances at a time.

use std::cell::UnsafeCell;
use std::ffi::c_void;
use std::ptr;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

#[cfg(not(target_pointer_width = "64"))]
compile_error!("a handle packs slot and generation into a pointer of 64 bits");

/// Handles stay below 2^47, as addresses do: some importers keep pointers in doubles.
const KIND_BITS: u32 = 4;
const INDEX_BITS: u32 = 20;
const GENERATION_BITS: u32 = 23;
const CHUNK: usize = 256;
const LATER_CHUNKS: usize = (1 << INDEX_BITS) / CHUNK - 1;
/// The number of no slot, at the ends of the list of free ones.
const NONE: u32 = u32::MAX;

const EMPTY: u64 = 0;
const IDLE: u64 = 1;
const BUSY: u64 = 2;
const STATUS_BITS: u32 = 2;

/// Why a handle cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum HandleError {
    /// NULL, freed, forged, or of another kind.
    Dead,
    /// In use by a call that has not returned.
    Busy,
}

struct Slot<T> {
    /// Generation and status.
    tag: AtomicU64,
    /// The next in the list of free slots; read and written only with that list locked.
    next: AtomicU32,
    content: UnsafeCell<Option<Box<T>>>,
}

impl<T> Slot<T> {
    const fn new() -> Self {
        Self {
            tag: AtomicU64::new(EMPTY),
            next: AtomicU32::new(NONE),
            content: UnsafeCell::new(None),
        }
    }
}

struct FreeSlots {
    /// The slot that has been unused for longest of those that were used before.
    first: u32,
    /// The slot that was freed last.
    last: u32,
    /// Number of slots that were ever used.
    fresh: u32,
}

/// Owner of all values of one kind that importers hold handles of.
pub(super) struct Registry<T> {
    kind: u64,
    first_slots: [Slot<T>; CHUNK],
    later_chunks: [OnceLock<Box<[Slot<T>]>>; LATER_CHUNKS],
    free: Mutex<FreeSlots>,
}

// SAFETY: a slot's content is touched only between the compare-and-swap that makes the slot busy and
// the store that ends it, hence by one thread at a time.
unsafe impl<T: Send> Sync for Registry<T> {}

impl<T> Registry<T> {
    /// An empty registry whose handles carry the mark `kind` (1 … 15).
    pub(super) const fn new(kind: u64) -> Self {
        Self {
            kind,
            first_slots: [const { Slot::new() }; CHUNK],
            later_chunks: [const { OnceLock::new() }; LATER_CHUNKS],
            free: Mutex::new(FreeSlots {
                first: NONE,
                last: NONE,
                fresh: 0,
            }),
        }
    }

    /// The slot of this number; `None` where no slot of its chunk was ever used.
    fn slot_at(&self, index: u32) -> Option<&Slot<T>> {
        let (chunk, place) = (index as usize / CHUNK, index as usize % CHUNK);
        match chunk.checked_sub(1) {
            None => Some(&self.first_slots[place]),
            Some(later) => Some(&self.later_chunks.get(later)?.get()?[place]),
        }
    }

    /// Takes a slot off the free ones; `None` when every slot is taken.
    fn free_slot(&self) -> Option<(u32, &Slot<T>)> {
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(slot) = self.slot_at(free.first) {
            let index = free.first;
            free.first = slot.next.swap(NONE, Ordering::Relaxed);
            if free.first == NONE {
                free.last = NONE;
            }
            return Some((index, slot));
        }
        let index = free.fresh;
        if index == 1 << INDEX_BITS {
            return None;
        }
        free.fresh += 1;
        if let Some(later) = (index as usize / CHUNK).checked_sub(1) {
            self.later_chunks[later].get_or_init(|| (0..CHUNK).map(|_| Slot::new()).collect());
        }
        Some((index, self.slot_at(index)?))
    }

    /// Adds a slot to the free ones, behind all others.
    fn give_back(&self, index: u32, slot: &Slot<T>) {
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        slot.next.store(NONE, Ordering::Relaxed);
        match self.slot_at(free.last) {
            Some(last) => last.next.store(index, Ordering::Relaxed),
            None => free.first = index,
        }
        free.last = index;
    }

    /// Keeps `value`; `None` when every slot is taken.
    pub(super) fn insert(&self, value: T) -> Option<*mut c_void> {
        let (index, slot) = self.free_slot()?;
        let generation = (slot.tag.load(Ordering::Acquire) >> STATUS_BITS) + 1;
        // SAFETY: the slot is empty and was taken off the free list, so nobody else touches it.
        unsafe { *slot.content.get() = Some(Box::new(value)) };
        slot.tag
            .store(generation << STATUS_BITS | IDLE, Ordering::Release);
        let bits =
            generation << (INDEX_BITS + KIND_BITS) | u64::from(index) << KIND_BITS | self.kind;
        Some(ptr::without_provenance_mut(bits as usize))
    }

    fn slot(&self, handle: *mut c_void) -> Result<(u32, u64, &Slot<T>), HandleError> {
        let bits = handle.addr() as u64;
        let index = (bits >> KIND_BITS) as u32 & ((1 << INDEX_BITS) - 1);
        let generation = bits >> (INDEX_BITS + KIND_BITS);
        if bits & ((1 << KIND_BITS) - 1) != self.kind || generation == 0 {
            return Err(HandleError::Dead);
        }
        let slot = self.slot_at(index).ok_or(HandleError::Dead)?;
        Ok((index, generation, slot))
    }

    /// Takes the slot for this thread alone.
    fn lock(slot: &Slot<T>, generation: u64) -> Result<Busy<'_, T>, HandleError> {
        let idle = generation << STATUS_BITS | IDLE;
        let busy = generation << STATUS_BITS | BUSY;
        match slot
            .tag
            .compare_exchange(idle, busy, Ordering::Acquire, Ordering::Relaxed)
        {
            Ok(_) => Ok(Busy { slot, after: idle }),
            Err(found) if found == busy => Err(HandleError::Busy),
            Err(_) => Err(HandleError::Dead),
        }
    }

    /// Lends the value to `body`.
    #[inline]
    pub(super) fn with<R>(
        &self,
        handle: *mut c_void,
        body: impl FnOnce(&mut T) -> R,
    ) -> Result<R, HandleError> {
        let (_, generation, slot) = self.slot(handle)?;
        let guard = Self::lock(slot, generation)?;
        // SAFETY: the slot is busy on behalf of this call, so the content is ours alone.
        match unsafe { &mut *guard.slot.content.get() } {
            Some(value) => Ok(body(value)),
            None => Err(HandleError::Dead),
        }
    }

    /// Whether a call with this handle would find its value.
    pub(super) fn is_live(&self, handle: *mut c_void) -> bool {
        self.slot(handle).is_ok_and(|(_, generation, slot)| {
            let tag = slot.tag.load(Ordering::Relaxed);
            tag >> STATUS_BITS == generation && tag & ((1 << STATUS_BITS) - 1) != EMPTY
        })
    }

    /// Ends the handle and gives the value back.
    pub(super) fn remove(&self, handle: *mut c_void) -> Result<Box<T>, HandleError> {
        let (index, generation, slot) = self.slot(handle)?;
        let mut guard = Self::lock(slot, generation)?;
        guard.after = generation << STATUS_BITS | EMPTY;
        // SAFETY: the slot is busy on behalf of this call, so the content is ours alone.
        let value = unsafe { &mut *guard.slot.content.get() }.take();
        drop(guard);
        // A slot whose generations are used up is retired, so that no handle ever comes back to life.
        if generation + 1 < 1 << GENERATION_BITS {
            self.give_back(index, slot);
        }
        value.ok_or(HandleError::Dead)
    }
}

/// A slot taken; given back when dropped, also by a panic.
struct Busy<'a, T> {
    slot: &'a Slot<T>,
    after: u64,
}

impl<T> Drop for Busy<'_, T> {
    fn drop(&mut self) {
        self.slot.tag.store(self.after, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn freed_and_forged_handles_are_dead() {
        let registry = Registry::new(1);
        let first = registry.insert("first").unwrap();
        assert_eq!(registry.with(first, |value| *value), Ok("first"));
        assert_eq!(registry.remove(first).as_deref(), Ok(&"first"));
        assert_eq!(registry.remove(first), Err(HandleError::Dead));
        let second = registry.insert("second").unwrap();
        assert_ne!(first, second);
        assert_eq!(registry.with(first, |_| ()), Err(HandleError::Dead));
        for forged in [0, 1, 7, usize::MAX, second.addr() + 1, second.addr() + 16] {
            let forged = ptr::without_provenance_mut(forged);
            assert_eq!(
                registry.with(forged, |_| ()),
                Err(HandleError::Dead),
                "{forged:?}"
            );
        }
        assert_eq!(registry.with(second, |value| *value), Ok("second"));
    }

    #[test]
    fn a_handle_in_use_is_busy_even_for_its_own_thread() {
        let registry = Registry::new(1);
        let handle = registry.insert(0).unwrap();
        let inner = registry.with(handle, |_| registry.with(handle, |_| ()));
        assert_eq!(inner, Ok(Err(HandleError::Busy)));
        assert!(registry.remove(handle).is_ok());
    }

    #[test]
    fn a_panic_inside_gives_the_slot_back() {
        let registry = Registry::new(1);
        let handle = registry.insert(0).unwrap();
        let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            registry.with(handle, |_| panic!("inside"))
        }));
        assert!(panicked.is_err());
        assert_eq!(registry.with(handle, |value| *value), Ok(0));
    }

    #[test]
    fn the_slot_that_was_unused_for_longest_is_taken_first() {
        let registry = Registry::new(1);
        let handles: Vec<_> = (0..2 * CHUNK)
            .map(|value| registry.insert(value).unwrap())
            .collect();
        let order = [300, 2, 256, 255];
        for index in order {
            assert_eq!(registry.remove(handles[index]).as_deref(), Ok(&index));
        }
        for index in order {
            let again = registry.insert(0).unwrap();
            assert_eq!(registry.slot(again).map(|found| found.0), Ok(index as u32));
        }
    }

    #[test]
    fn a_thousand_values_from_eight_threads() {
        let registry = Registry::new(1);
        std::thread::scope(|scope| {
            for thread in 0..8_usize {
                let registry = &registry;
                scope.spawn(move || {
                    let handles: Vec<_> = (0..125)
                        .map(|i| registry.insert(thread * 1000 + i).unwrap())
                        .collect();
                    for (i, handle) in handles.into_iter().enumerate() {
                        assert_eq!(registry.with(handle, |value| *value), Ok(thread * 1000 + i));
                        assert!(registry.remove(handle).is_ok());
                    }
                });
            }
        });
    }
}
