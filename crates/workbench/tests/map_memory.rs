//! What one run of a map needs: the run itself and all that is allocated while it goes.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use stickslip::integrator::Simulation;
use stickslip::plant::Rig;
use workbench::map::{Quantity, Settings, Study, Watch};

/// Counts what a thread allocates and how much that was at most: the test's harness has threads of its own.
struct Counting;

thread_local! {
    static NOW: Cell<usize> = const { Cell::new(0) };
    static MOST: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.get() + layout.size();
        NOW.set(now);
        MOST.set(MOST.get().max(now));
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // It may be from another thread, or from before the count began.
        NOW.set(NOW.get().saturating_sub(layout.size()));
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
    let model = include_str!("../../../modelDescription/reduced-rig.toml");
    let settings = Settings::new(model, "reduced-rig.toml", &spans, 60.0, 1e-9).unwrap();
    NOW.set(0);
    MOST.set(0);
    let point = settings.run(0, 0);
    let allocated = MOST.get();
    let held = size_of::<Simulation<f64, Rig<f64>>>() + size_of::<Watch>();
    println!("{held} bytes held, {allocated} allocated");
    assert!(point.switches > 80);
    assert!(
        held + allocated <= 8 * 1024,
        "{held} bytes held, {allocated} allocated"
    );
}
