//! What is wrong with an effect is said, wherever it is.

use crate::*;

#[test]
fn what_is_wrong_with_an_effect_is_said_with_its_column() {
    let base = |equation: &str| {
        let mut parameters = vec![("a", 0.1, "N.m")];
        if equation.contains("width") {
            parameters.push(("width", 1.0, "rad/s"));
        }
        effect("disc.torque", equation, &parameters)
    };
    for (text, words) in [
        (
            base("-a * cos(angel)"),
            "column 10: nothing is called \"angel\"",
        ),
        (base("-a * velocity"), "gives a quantity in kg.m2.s-3"),
        (
            base("a + width"),
            "column 3: a sum takes two quantities of one unit",
        ),
        (
            base("a * exp(velocity)"),
            "column 5: exp takes a number without unit",
        ),
        (
            base("a / (velocity/width)"),
            "column 3: the divisor may become zero",
        ),
        (base("a * log(load/load)"), "the divisor may become zero"),
        (
            base("a*time / (time*(1 + abs(angle)))"),
            "the divisor may become zero",
        ),
        (
            base("a").replace("N.m", "N.m99999999999"),
            "\"m99999999999\" is not an SI symbol",
        ),
        (base("a*cos(angle)^0.5"), "column 13: the base of a power"),
        (base("-a * sign(velocity)"), "column 6: sign jumps"),
        (
            base("a").replace("equation = \"a\"", "equation = \"0\""),
            "does not use the parameter \"a\"",
        ),
        (base("-a * (cos(angle)"), "\")\" is expected"),
        (base("-a * foo(angle)"), "there is no function \"foo\""),
        (base("-a * 1e999"), "no finite number"),
        (base("-a ** 2"), "write a power as x^2"),
        (
            base(&format!("a*{}1{}", "(".repeat(60), ")".repeat(60))),
            "brackets deep",
        ),
        (
            base("a").replace("disc.torque", "disc.force"),
            "port = \"disc.force\" must be one of disc.torque",
        ),
        (
            base("a").replace("name = \"mine\"", "name = \"unbalance\""),
            "a name that no part and no effect has yet",
        ),
        (
            base("a").replace("name = \"mine\"", "name = \"Mine 2\""),
            "small letters",
        ),
        (
            base("a").replace("unit = \"N.m\"", "unit = \"lbf.ft\""),
            "\"lbf\" is not an SI symbol",
        ),
        (
            base("a").replace("value = 0.1\n", ""),
            "lacks parameters.a.value",
        ),
        (
            base("a").replace("disc.torque", "disc1.torque"),
            "this one has no disc D1",
        ),
        (
            base("a") + &base("a").replace("0.1", "0.2"),
            "an effect before it has this one",
        ),
        (
            base("a").replace("equation", "equatoin"),
            "has no key \"equatoin\"",
        ),
    ] {
        let error = Rig::from_toml(
            &common::rig_text(false, law("stribeck"), &text),
            "model.toml",
        );
        let message = error.unwrap_err().to_string();
        assert!(message.starts_with("model.toml: "), "{message}");
        assert!(message.contains(words), "{message}\nlacks {words}");
    }
}

#[test]
fn no_text_makes_the_reader_of_equations_fail_otherwise_than_with_a_reason() {
    const PARTS: [&str; 28] = [
        "a", "angle", "velocity", "load", "time", "width", "(", ")", "+", "-", "*", "/", "^", ",",
        "2", "0", "1e3", ".", "sin(", "max(", "pow(", "sqrt(", "abs(", "sign(", "log(", " ", "€",
        "\t",
    ];
    let mut random = common::Uniform(7);
    let mut accepted = 0;
    for _ in 0..20_000 {
        let length = 1 + (random.next() * 12.0) as usize;
        let text: String = (0..length)
            .map(|_| PARTS[(random.next() * PARTS.len() as f64) as usize])
            .collect();
        let extra = effect(
            "disc.torque",
            &text.replace('\t', " "),
            &[("a", 0.1, "N.m")],
        );
        match Rig::from_toml(&common::rig_text(false, law("coulomb"), &extra), "m") {
            Ok(_) => accepted += 1,
            Err(error) => assert!(error.to_string().starts_with("m: "), "{error}"),
        }
    }
    assert!(accepted > 20, "{accepted}");
}

#[test]
fn a_file_of_effects_without_an_effect_is_refused() {
    for text in ["", "effect = []", "effect = 3"] {
        let message = Supposition::read_all(text, "rumble.toml")
            .unwrap_err()
            .to_string();
        assert!(
            message.starts_with("rumble.toml: ") && message.contains("[[effect]]"),
            "{message}"
        );
    }
}
