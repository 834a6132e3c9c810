//! Chapter 4: the rig's parameters and the validation of its model.

mod free_decay;
mod motor;
mod start_up;
mod static_tests;
mod table_4_7;

use super::Experiment;

/// The chapter's experiments.
pub(super) const EXPERIMENTS: &[Experiment] = &[
    Experiment {
        id: "table-4.1",
        title: "Moments of inertia",
        run: static_tests::inertias,
    },
    Experiment {
        id: "table-4.2",
        title: "Static test of shaft 1, against the dynamic stiffness (Fig. 4.7)",
        run: static_tests::shaft1,
    },
    Experiment {
        id: "table-4.3",
        title: "Static test of shaft 2, against the dynamic stiffness (Fig. 4.8)",
        run: static_tests::shaft2,
    },
    Experiment {
        id: "table-4.4",
        title: "Free decays: frequencies, decrements, damping (Tables 4.4, 4.5, Figs 4.9, 4.10)",
        run: free_decay::decays,
    },
    Experiment {
        id: "table-4.6",
        title: "The motor's constants, and numbers that are not given (Table 4.6, Eq. 4-4)",
        run: motor::constants,
    },
    Experiment {
        id: "fig-4.11",
        title: "Four starts without normal force and their measures (Table 4.7)",
        run: start_up::velocities,
    },
    Experiment {
        id: "table-4.7",
        title: "What Table 4.7 says about its records and about the amplitude pulse level",
        run: table_4_7::consistency,
    },
    Experiment {
        id: "fig-4.12",
        title: "Armature current of the four starts",
        run: start_up::currents,
    },
];
