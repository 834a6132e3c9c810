//! `model.toml` of a drawn rig, and the facts that its answer states.

use crate::answers::named;
use crate::law::ContactLaw;
use crate::other_rigs::case::DrawnCase;
use crate::rig::relative_uncertainty;
use std::collections::BTreeMap;
use std::fmt::Write;

/// What the analyst believes, with one standard deviation of each uncertain number.
pub fn model_toml(case: &DrawnCase) -> String {
    let rig = &case.rig.believed;
    let spread = case.spread;
    let mut text = String::from(
        "# What the analyst believes before looking at the records. SI units, shaft side of the \
         gearbox unless\n# named motor. relative_uncertainty: one standard deviation.\n",
    );
    let mut section = |name: &str, numbers: &[(&str, f64, &str, &str)]| {
        // Writing into a String cannot fail.
        let _ = writeln!(text, "[{name}]");
        for &(key, value, unit, uncertain) in numbers {
            let sigma = rounded(relative_uncertainty(uncertain, spread));
            let _ = if sigma > 0.0 {
                writeln!(
                    text,
                    "{key} = {{ value = {value:?}, unit = \"{unit}\", relative_uncertainty = {sigma} }}"
                )
            } else {
                writeln!(text, "{key} = {{ value = {value:?}, unit = \"{unit}\" }}")
            };
        }
    };
    if let Some(disc1) = &case.disc1 {
        let part = &disc1.part;
        section("disc1", &[("inertia", part.inertia, "kg m2", "J2")]);
        section(
            "shaft1",
            &[
                ("stiffness", part.shaft_stiffness, "N m/rad", "k2"),
                ("damping", part.shaft_damping, "N m s/rad", "c2"),
            ],
        );
    }
    section("disc", &[("inertia", rig.disc_inertia, "kg m2", "J2")]);
    section(
        "shaft",
        &[
            ("stiffness", rig.shaft_stiffness, "N m/rad", "k2"),
            ("damping", rig.shaft_damping, "N m s/rad", "c2"),
        ],
    );
    section("gearbox", &[("ratio", rig.gear_ratio, "1", "")]);
    section(
        "motor",
        &[
            ("inertia", rig.motor_inertia, "kg m2", ""),
            ("resistance", rig.resistance, "Ohm", "R"),
            ("inductance", rig.inductance, "H", ""),
            ("torque_constant", rig.torque_constant, "N m/A", "KT"),
            ("back_emf_constant", rig.back_emf_constant, "V s/rad", "KE"),
            ("coulomb_torque", rig.motor_coulomb_torque, "N m", "Tfm"),
            (
                "viscous_damping",
                rig.motor_viscous_damping,
                "N m s/rad",
                "",
            ),
        ],
    );
    if let Some(disc1) = &case.disc1 {
        let radius = disc1.part.contact_radius;
        text.push_str(&contact("contact1", radius, &disc1.part.law, spread));
    }
    text.push_str(&contact(
        "contact",
        rig.contact_radius,
        &case.laws.believed,
        spread,
    ));
    text
}

fn contact(name: &str, radius: f64, law: &ContactLaw, spread: f64) -> String {
    let mut text = format!(
        "[{name}]\nradius = {{ value = {radius:?}, unit = \"m\" }}\nlaw = \"{}\"\n",
        law.name()
    );
    let sigma = rounded(relative_uncertainty(crate::rig::FRICTION_LEVEL, spread));
    for (key, value) in law.numbers() {
        let _ = match key {
            "mu_c" | "mu_s" | "a1" | "a2" => writeln!(
                text,
                "{key} = {{ value = {value:?}, unit = \"1\", relative_uncertainty = {sigma} }}"
            ),
            _ => writeln!(text, "{key} = {value:?}"),
        };
    }
    text
}

/// What the rig is and does, for whoever looks at the answers: true numbers of the contact under
/// `contact.`, loads, speeds and what the records show.
pub fn facts(case: &DrawnCase) -> BTreeMap<String, f64> {
    let rig = &case.rig;
    let mut facts = named([
        ("natural_period", rig.period),
        ("samples_per_period", rig.period / case.layout.interval),
        ("learning_periods", case.layout.learning_periods),
        ("held_out_periods", case.layout.held_out_periods),
        ("top_speed", rig.top_speed),
        ("middle_load", rig.middle_load),
        ("friction_torque", rig.torque),
        ("load_reference", rig.load_power.1),
        ("sticking_share", case.motion.sticking),
        ("sticking_phases", case.motion.phases as f64),
        ("sliding_periods", case.motion.sliding),
    ]);
    if case.motion.margin.is_finite() {
        facts.insert("loop_margin".to_owned(), case.motion.margin);
    }
    for (key, value) in case.truth.law.numbers() {
        facts.insert(format!("contact.{key}"), value);
    }
    facts
}

/// A standard deviation to six decimals.
fn rounded(sigma: f64) -> f64 {
    (sigma * 1e6).round() / 1e6
}
