//! Chapter 3: friction laws on three dimensionless systems.

mod block;
mod laws;
mod locomotive;
mod pendulum;

use super::Experiment;

/// The chapter's experiments.
pub(super) const EXPERIMENTS: &[Experiment] = &[
    Experiment {
        id: "fig-3.4",
        title: "Block on belt: Coulomb, Coulomb with stiction, Stribeck (Table 3.1)",
        run: block::published_laws,
    },
    Experiment {
        id: "fig-3.4-other-laws",
        title: "Block on belt: Karnopp, switch model, Wojewoda",
        run: block::other_laws,
    },
    Experiment {
        id: "fig-3.5",
        title: "Torsional pendulum with constant top velocity (Table 3.2)",
        run: pendulum::constant_top,
    },
    Experiment {
        id: "fig-3.6",
        title: "Torsional pendulum with sinusoidal top velocity (Table 3.2)",
        run: pendulum::sinusoidal_top,
    },
    Experiment {
        id: "fig-3.5-other-laws",
        title: "Torsional pendulum: Karnopp, switch model, Wojewoda",
        run: pendulum::other_laws,
    },
    Experiment {
        id: "fig-3.7",
        title: "Locomotive with constant force (Table 3.3)",
        run: locomotive::constant_force,
    },
    Experiment {
        id: "fig-3.8",
        title: "Locomotive with harmonic force (Table 3.3)",
        run: locomotive::harmonic_force,
    },
];
