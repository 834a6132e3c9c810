//! Chapter 5: what the rig does, on the virtual rig.

mod friction_torque;
mod full_rig;
pub(super) mod recorded;
mod settings;
mod sweeps;
mod wobble;

use super::Experiment;

/// The chapter's experiments.
pub(super) const EXPERIMENTS: &[Experiment] = &[
    Experiment {
        id: "sec-5.1-virtual-rig",
        title: "The virtual rig: its settings and the facts to which it is calibrated",
        run: settings::settings,
    },
    Experiment {
        id: "fig-5.1",
        title: "Reduced rig, N₂ = 10 N: speed sweep",
        run: sweeps::speeds,
    },
    Experiment {
        id: "fig-5.2",
        title: "Reduced rig: phase portraits over ω_ref",
        run: sweeps::portraits_over_speed,
    },
    Experiment {
        id: "fig-5.3",
        title: "Reduced rig, 55 rpm: normal-force sweep",
        run: sweeps::forces,
    },
    Experiment {
        id: "fig-5.4",
        title: "Reduced rig: phase portraits over N₂",
        run: sweeps::portraits_over_force,
    },
    Experiment {
        id: "sec-5.2-wobble",
        title: "What a normal force that varies with the disc's angle does to the pattern and to 0.92 Hz",
        run: wobble::explanation,
    },
    Experiment {
        id: "sec-5.3-virtual-rig",
        title: "The full virtual rig: its settings and the facts to which it is calibrated",
        run: settings::full_settings,
    },
    Experiment {
        id: "fig-5.5",
        title: "Full rig: speed and normal-force sweeps (Figs 5.5 to 5.8)",
        run: full_rig::sweeps,
    },
    Experiment {
        id: "fig-5.9",
        title: "Friction torque by inverse dynamics at 55 rpm, 50 N (Figs 5.9, 5.11, 5.12)",
        run: friction_torque::one_case,
    },
    Experiment {
        id: "fig-5.10",
        title: "Normal force over the angle",
        run: friction_torque::normal_force,
    },
    Experiment {
        id: "fig-5.13",
        title: "Friction torque over velocity and acceleration in all cases (Figs 5.13, 5.14)",
        run: friction_torque::all_cases,
    },
];
