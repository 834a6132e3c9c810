//! What one run of a map needs: the run itself and all that is allocated while it goes.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use stickslip::integrator::Simulation;
use stickslip::plant::Rig;
use workbench::map::{Quantity, Settings, Study, Watch};

/// Counts what is allocated and how much that was at most.
struct Counting;

static NOW: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(now, Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn a_run_of_a_map_needs_at_most_eight_kibibytes() {
    let spans = [
        (Quantity::SpeedRpm, "55:56:2".parse().unwrap()),
        (Quantity::NormalForce, "50:51:2".parse().unwrap()),
    ];
    let model = include_str!("../../modelDescription/reduced-rig.toml");
    let settings = Settings::new(model, "reduced-rig.toml", &spans, 60.0, 1e-9).unwrap();
    let before = NOW.load(Ordering::Relaxed);
    MOST.store(before, Ordering::Relaxed);
    let point = settings.run(0, 0);
    let allocated = MOST.load(Ordering::Relaxed) - before;
    let held = size_of::<Simulation<f64, Rig<f64>>>() + size_of::<Watch>();
    println!("{held} bytes held, {allocated} allocated");
    assert!(point.switches > 80);
    assert!(
        held + allocated <= 8 * 1024,
        "{held} bytes held, {allocated} allocated"
    );
}
