//! What the page of a controller says besides its variables and parameters.

use super::equations::Equations;
use crate::model_description::Facts;

const SPEED: Equations = Equations {
    title: "PI control of speed",
    source: "gains from the dissertation, Table 4.6, which prints them without unit and without control law",
    equations: &[
        "e = ω_ref − θ_3' , {on the motor's speed:} e = η ( ω_ref − θ_3' )",
        "u = κ_p e + v , u_min ≤ u ≤ u_max",
        "v' = κ_i e , {held while} u {is at a limit and would be driven further out}",
    ],
};

const SOFT_TORQUE: Equations = Equations {
    title: "Soft torque by impedance matching",
    source: "torque feedback: Halsey, Kyllingstad, Kylling, SPE 18049 (1988); active damping: Jansen, van den Steen, \
             J. Sound Vib. 179 (1995) 647; integral against the drive's inertia: Kyllingstad, Nessjøen, SPE/IADC 119660 (2009)",
    equations: &[
        "T_y y' = η K_T i − y",
        "u = K_E η ( ω_ref − y / Z_c ) + v , u_min ≤ u ≤ u_max",
        "v' = K_E η a ( ω_ref − θ_3' ) , {held while} u {is at a limit and would be driven further out}",
        "1 / Z_c = 1 / Z − R / ( η^2 K_T K_E )",
    ],
};

/// The law of a controller's `model.toml`; `None` for a rig's.
pub(super) fn equations(model: &toml::Table) -> Option<Equations> {
    if model.contains_key("speed_controller") {
        return Some(SPEED);
    }
    model.contains_key("soft_torque").then_some(SOFT_TORQUE)
}

pub(super) fn signs() -> String {
    "<h2>Signs and units</h2>\n<p>Inputs and output bear the names of the rig's variables that they are connected to: the \
     rig's <code>theta3_dot</code> and <code>i</code> to the controller's, the controller's <code>u</code> to the rig's. \
     SI units; speeds are those of the gearbox output. A positive voltage turns the discs forward.</p>"
        .to_owned()
}

pub(super) fn usage(facts: &Facts<'_>) -> String {
    let experiment = facts.identity.default_experiment;
    format!(
        "<h2>Use</h2>\n<ul>\n<li>Communication step: {} s. The controller itself is exact at any step; what a longer one does \
         to the closed loop is in the project's docs/closed-loop.md.</li>\n\
         <li>Inputs are held between communication points, or follow their derivatives where given (FMI 2). Reaching and \
         leaving a voltage limit are exact events; with early return allowed (FMI 3) a step ends there.</li>\n\
         <li>The state can be saved, restored and serialised; several instances may live in one process.</li>\n</ul>",
        experiment.step_size
    )
}
