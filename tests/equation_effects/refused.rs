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

#[test]
fn a_pole_inside_the_range_of_a_parameter_is_refused_with_its_column() {
    let text = |range: &str| {
        "[[effect]]\nname = \"mine\"\ntitle = \"mine\"\nport = \"disc.torque\"\n\
         equation = \"a / (place - 1)\"\n\
         parameters.a = { value = 0.1, unit = \"N.m\", description = \"a\" }\n"
            .to_owned()
            + &format!(
                "parameters.place = {{ value = 2.0, unit = \"1\", range = {range}, description = \"b\" }}\n"
            )
    };
    let read = |text: String| {
        let model = common::rig_text(false, law("stribeck"), &text);
        Rig::from_toml(&model, "model.toml").map_err(|error| error.to_string())
    };
    for range in ["[0.5, 4.0]", "\"positive\"", "[1.0, 4.0]"] {
        let message = read(text(range)).unwrap_err();
        let words = "model.toml: [effect mine] equation = \"a / (place - 1)\", column 3: the divisor may become zero here";
        assert!(message.starts_with(words), "{message}");
    }
    read(text("[1.5, 4.0]")).unwrap();
}

#[test]
fn numbers_that_overflow_hide_no_pole() {
    let base = |equation: &str| effect("disc.torque", equation, &[("a", 0.1, "N.m")]);
    for equation in [
        "a / (exp(999) - exp(999) + 1)",
        "a / abs(exp(999) - exp(999))",
    ] {
        let model = common::rig_text(false, law("stribeck"), &base(equation));
        let message = Rig::from_toml(&model, "m").unwrap_err().to_string();
        assert!(
            message.contains("column 3: the divisor may become zero"),
            "{message}"
        );
    }
}

#[test]
fn powers_of_powers_are_read_at_once() {
    let powers = format!("a*sign({}angle{})", "(".repeat(15), "^63)".repeat(15));
    let extra = effect("disc.torque", &powers, &[("a", 0.1, "N.m")]);
    let begin = std::time::Instant::now();
    Rig::from_toml(&common::rig_text(false, law("stribeck"), &extra), "m").unwrap();
    assert!(begin.elapsed().as_secs() < 5, "{:?}", begin.elapsed());
}

#[test]
fn points_that_make_no_function_are_refused_with_file_effect_and_place() {
    let many = vec!["0.0"; 1_000_000].join(", ");
    for (x, y, more, words) in [
        (
            "[0.0, 2.0, 1.0]",
            "[0.0, 1.0, 2.0]",
            "",
            "x[2] = 1.0 must lie above x[1] = 2.0",
        ),
        (
            "[nan, 1.0]",
            "[0.0, 1.0]",
            "",
            "x[0] = NaN must be a finite number",
        ),
        (
            "[0.0, 1.0]",
            "[0.0, nan]",
            "",
            "y[1] = NaN must be a finite number",
        ),
        (
            "[0.0]",
            "[1.0]",
            "",
            "has 1 x and 1 y; it needs as many of one as of the other, from 2 to 400",
        ),
        (
            &format!("[{many}]"),
            &format!("[{many}]"),
            "",
            "has 1000000 x and 1000000 y; it needs",
        ),
        (
            "[0.0, 1e-320]",
            "[0.0, 1.0]",
            "",
            "between x[0] = 0.0 and the next point at 1e-320",
        ),
        (
            "[0.0, 1.0]",
            "[0.0, 1.0]",
            "period = 0.5\n",
            "period = 0.5 must be above x[last] − x[0] = 1.0",
        ),
    ] {
        let extra = effect("disc.torque", "a*f(angle)", &[("a", 0.1, "1")])
            + &format!(
                "[effect.tables.f]\nx = {x}\ny = {y}\nx_unit = \"rad\"\ny_unit = \"N.m\"\ninterpolation = \"linear\"\n{more}"
            );
        let text = common::rig_text(false, law("stribeck"), &extra);
        let of_model = Rig::from_toml(&text, "model.toml").unwrap_err().to_string();
        let of_file = Supposition::read_all(&extra, "mine.toml")
            .unwrap_err()
            .to_string();
        for (file, message) in [("model.toml", of_model), ("mine.toml", of_file)] {
            let begin = format!("{file}: [effect mine] table f");
            assert!(
                message.starts_with(&begin) && message.contains(words),
                "{message}"
            );
            assert!(message.len() < 1000, "{} bytes", message.len());
        }
    }
}
