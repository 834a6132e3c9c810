//! Chapter 6: the two friction laws over the phase-plane angle.

mod agreement;
mod angle_fits;
mod bifurcation;

use super::Experiment;

/// The chapter's experiments.
pub(super) const EXPERIMENTS: &[Experiment] = &[
    Experiment {
        id: "fig-6.1",
        title: "Ellipse fit of the phase plane at 55 rpm, 50 N",
        run: angle_fits::ellipse,
    },
    Experiment {
        id: "fig-6.2",
        title: "Two Gaussians through torque and coefficient over α (Figs 6.2, 6.3, 6.8, 6.9)",
        run: angle_fits::gaussians,
    },
    Experiment {
        id: "fig-6.4",
        title: "Both laws at 55 rpm, 50 N (Figs 6.4 to 6.7)",
        run: agreement::sticking_case,
    },
    Experiment {
        id: "fig-6.11",
        title: "Both laws at 55 rpm, 10 N (Figs 6.10 to 6.13)",
        run: agreement::sliding_case,
    },
    Experiment {
        id: "fig-6.14",
        title: "Bifurcation diagram over ω_ref, N₂ = 10 N",
        run: bifurcation::over_speed,
    },
    Experiment {
        id: "fig-6.15",
        title: "Bifurcation diagram over N₂, 55 rpm",
        run: bifurcation::over_force,
    },
];
