//! What is wrong with a model file is told, with what would be right.

use super::plants::{JOINT, SLED};
use stickslip::cosim;

#[test]
fn a_wrong_file_is_refused_with_section_key_and_what_is_right() {
    let refused = |text: &str| cosim::open(text, "plant.toml").err().unwrap().to_string();
    for (from, to, wanted) in [
        (
            "[coulomb_friction]",
            "[coulomb]",
            "there is no section [coulomb] in the model of a drive; known are plant",
        ),
        (
            "inertia = 2.0\n",
            "",
            "[drive] is missing or lacks inertia; it needs inertia [kg], mass",
        ),
        (
            "inertia = 2.0",
            "inertia = -2.0",
            "[drive] inertia = -2 must be a finite number above 0",
        ),
        (
            "inertia = 2.0",
            "inertia = { value = 2.0, unit = \"g\" }",
            "[drive] inertia.unit = \"g\" must be \"kg\"",
        ),
        (
            "[coulomb_friction]\nforce",
            "[hardening]\ncoefficient",
            "there is no section [hardening] in the model of a drive",
        ),
        (
            "force = 3.0",
            "force = 3.0\nwidth = 1.0",
            "there is no key width in [coulomb_friction]",
        ),
        (
            "kind = \"drive\"",
            "kind = \"balance\"",
            "your own model, which stays yours",
        ),
        (
            "kind = \"drive\"",
            "kind = \"contact\"",
            "a law without a body",
        ),
        (
            "kind = \"drive\"",
            "kind = \"slide\"",
            "one of drive, pendulum, contact",
        ),
        ("path = \"line\"", "path = \"curve\"", "one of line, turn"),
        (
            "[coulomb_friction]\nforce = 3.0",
            "[sensor_delay]\ndelay = 0.01",
            "an effect of the readings, not of the motion",
        ),
    ] {
        assert!(SLED.contains(from), "{from}");
        let message = refused(&SLED.replace(from, to));
        assert!(
            message.starts_with("plant.toml: ") && message.contains(wanted),
            "{message}"
        );
    }
    let own = |equation: &str| {
        refused(&format!(
            "{SLED}[[effect]]\nname = \"own\"\ntitle = \"t\"\nport = \"plant.force\"\nequation = \"{equation}\"\n\
             parameters.size = {{ value = 1.0, unit = \"N.s4/m2\", description = \"d\" }}\n"
        ))
    };
    let message = own("size * acceleration^2");
    assert!(
        message.contains("[effect own] equation")
            && message.contains("in proportion to the acceleration"),
        "{message}"
    );
    let message = own("size * acceleration^2 +");
    assert!(
        message.contains("effect own: equation") && message.contains("column"),
        "{message}"
    );
    let message = own("size * speed^2");
    assert!(message.contains("speed"), "{message}");
}

#[test]
fn a_jump_over_what_depends_on_the_velocity_is_no_event_and_refused() {
    for (plant, coordinate) in [
        (SLED, "velocity"),
        (SLED, "friction"),
        (JOINT, "velocity"),
        (JOINT, "motor"),
    ] {
        let unit = if plant == SLED { "N" } else { "rad/s2" };
        let text = format!(
            "{plant}[[effect]]\nname = \"own\"\ntitle = \"t\"\nport = \"plant.force\"\n\
             equation = \"size * sign({coordinate})\"\n\
             parameters.size = {{ value = 1.0, unit = \"{unit}\", description = \"d\" }}\n"
        );
        let message = cosim::open(&text, "plant.toml").err().unwrap().to_string();
        assert!(
            message.contains("effect own: equation") && message.contains("column 8: sign jumps"),
            "{message}"
        );
    }
}

#[test]
fn a_small_plant_takes_no_table_and_says_which_keys_it_takes() {
    let text = format!(
        "{SLED}[[effect]]\nname = \"own\"\ntitle = \"t\"\nport = \"plant.force\"\nequation = \"f(position)\"\n\
         [effect.tables.f]\nx = [0.0]\ny = [nan]\n"
    );
    let message = cosim::open(&text, "plant.toml").err().unwrap().to_string();
    assert!(
        message.starts_with("plant.toml: [effect own] has no key \"tables\"; known are name"),
        "{message}"
    );
}
