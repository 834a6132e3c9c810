//! What the page of a drive, a pendulum or a joint says besides its variables and parameters.

use stickslip::body::catalogue;

use super::equations::Equations;
use super::{effect_by_equation, group, written_effects};
use crate::model_description::Facts;

const DRIVE: Equations = Equations {
    title: "Drive",
    source: "the model file",
    equations: &["m a + b v + F_0 + {effects} = F"],
};

const PENDULUM: Equations = Equations {
    title: "Pendulum, all over its moment of inertia",
    source: "the model file",
    equations: &["a + k sin ( x − x_0 ) + b v + {effects} = 0"],
};

const JOINT: Equations = Equations {
    title: "Joint, all over its moment of inertia",
    source: "the model file",
    equations: &["a + k sin ( x − x_0 ) + b v + {effects} = c ( g u − e v )"],
};

/// Symbols of the equations and the variables and parameters that they stand for.
const SYMBOLS: &str = "<p><small><i>x, v, a</i>: position, velocity, acceleration; <i>m</i>: inertia; <i>b</i>: viscous; \
    <i>F<sub>0</sub></i>: offset; <i>F</i>: force; <i>k</i>: stiffness; <i>x<sub>0</sub></i>: rest; <i>c</i>: connected; \
    <i>g</i>: gain; <i>u</i>: voltage; <i>e</i>: back_emf.</small></p>\n";

/// The equations of a body's `model.toml` and of its effects.
pub(super) fn equations(model: &toml::Table) -> String {
    let kind = model.get("plant").and_then(|plant| plant.get("kind"));
    let base = match kind.and_then(toml::Value::as_str) {
        Some("pendulum") => PENDULUM,
        Some("joint") => JOINT,
        _ => DRIVE,
    };
    let mut html = format!("<h2>Equations</h2>\n{}{SYMBOLS}", group(&base));
    let known = catalogue().unwrap_or_default();
    for own in known.iter().filter(|own| model.contains_key(&own.name)) {
        let source = "catalogue of effects of the project";
        html.push_str(&effect_by_equation([
            &own.title,
            &own.name,
            &own.port,
            &own.equation,
            source,
        ]));
    }
    html.push_str(&written_effects(model));
    html
}

pub(super) fn signs() -> String {
    "<h2>Signs and units</h2>\n<p>A positive force, torque or voltage drives the body forward. Effects and <code>friction</code> are \
     positive against forward motion. All quantities are in SI units; those of a pendulum or a joint are over the moment of inertia. \
     The body slides forward, slides backward or sticks; turning, sticking and breakaway are located as events. While it sticks, \
     <code>velocity</code> is zero and <code>friction</code> is the reaction that holds it.</p>"
        .to_owned()
}

pub(super) fn usage(facts: &Facts<'_>) -> String {
    let experiment = facts.identity.default_experiment;
    format!(
        "<h2>Use</h2>\n<ul>\n<li>Default experiment: {} s to {} s, communication step {} s.</li>\n\
         <li>The run starts from <code>position</code> and <code>velocity</code>.</li>\n\
         <li>While the inputs hold, the solution does not depend on the communication step. Inputs are held between communication \
         points, or follow their derivatives where given (FMI 2).</li>\n\
         <li>The state can be saved, restored and serialised; several instances may live in one process.</li>\n\
         <li>FMI 3: with early return allowed, a step ends where the body begins to stick or breaks away.</li>\n</ul>",
        experiment.start_time, experiment.stop_time, experiment.step_size
    )
}
