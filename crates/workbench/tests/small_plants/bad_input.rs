//! Cases of small plants that cannot be used.

use crate::*;

#[test]
fn bad_input_is_told_with_what_would_be_right() {
    let record = drive(5.0, 1);
    let table: &[(&str, &str, &str, &str)] = &[
        (
            "model.toml",
            "kind = \"drive\"",
            "kind = \"drvie\"",
            "one of drive, pendulum, contact",
        ),
        (
            "model.toml",
            "unit = \"mm\"",
            "unit = \"inch\"",
            "none of m, mm, um",
        ),
        (
            "model.toml",
            "unit = \"V\", factor = 4.0",
            "unit = \"V\"",
            "factor",
        ),
        (
            "model.toml",
            "column = \"x\"",
            "column = \"y\"",
            "has no column `y`",
        ),
        (
            "model.toml",
            "[drive]",
            "[dirve]",
            "drive, coulomb_friction",
        ),
        (
            "model.toml",
            "viscous = 25.0",
            "viscosity = 25.0",
            "viscous [N.s/m]",
        ),
        ("model.toml", "value = 9.0", "value = -9.0", "above 0"),
        ("model.toml", "unit = \"kg\"", "unit = \"g\"", "\"kg\""),
        (
            "model.toml",
            "compare_rate = 40.0",
            "compare_rate = 4000.0",
            "is sampled at 250.0 Hz",
        ),
        ("run-a.csv", "t,x,volt", "time,x,volt", "names `t` as time"),
        ("run-a.csv", "\n400.0,", "\n400.0,x", "is not a number"),
        ("run-a.csv", "\n400.0,", "\n4.0,", "comes after"),
    ];
    for (file, from, to, words) in table {
        let place = Place::new(DRIVE, &record, &drive(5.0, 2));
        let text = fs::read_to_string(place.file(file)).unwrap();
        assert!(text.contains(from), "{from}");
        fs::write(place.file(file), text.replacen(from, to, 1)).unwrap();
        let (code, message) = place.run("diagnose", &[]);
        assert_eq!(code, 2, "{message}");
        assert!(
            message.contains(words) && (message.contains(file) || message.contains("run-a.csv: ")),
            "{words}: {message}"
        );
    }
    let joint = balance(|_, _, _, _, _| 0.0, 1);
    for (from, to, words) in [
        ("predicted = {", "# predicted = {", "what the model says"),
        ("\"model\", unit", "\"torque\", unit", "same column"),
        (
            "kind = \"balance\"",
            "kind = \"drive\"",
            "belongs to a balance",
        ),
        (
            "\"model\", unit",
            "\"modle\", unit",
            "has no column `modle`",
        ),
    ] {
        let place = Place::new(&BALANCE.replacen(from, to, 1), &joint, &joint);
        let (code, message) = place.run("diagnose", &[]);
        assert_eq!(code, 2, "{message}");
        assert!(message.contains(words), "{words}: {message}");
    }
    let place = Place::new(DRIVE, &record, &record);
    let (code, message) = place.run("diagnose", &[]);
    assert_eq!(code, 2, "{message}");
    assert!(message.contains("same measurement"), "{message}");
    let (code, message) = place.run("diagnose", &["--without", "coulom_friction"]);
    assert_eq!(code, 2, "{message}");
    assert!(message.contains("coulomb_friction"), "{message}");
}
