//! Cases that cannot be used.

use crate::*;

#[test]
fn what_cannot_be_used_is_refused_with_what_would_be_right() {
    let table: &[(&str, Change, &str)] = &[
        // Times.
        (
            "run-b.csv",
            |t| t.replacen("\n0.0500,", "\n0.0100,", 1),
            "0.01 s comes after 0.04 s",
        ),
        (
            "run-b.csv",
            |t| t.replacen("\n0.0500,", "\n0.0400,", 1),
            "times must increase",
        ),
        ("run-a.csv", |t| scaled(t, "time", 1e3), "is `time` in ms?"),
        (
            "run-a.csv",
            |t| scaled(t, "time", 1.0 / 60.0),
            "is `time` in minutes?",
        ),
        // Columns and what stands in them.
        (
            "run-a.csv",
            |t| t.replacen("N2,", "force,", 1),
            "has no column `N2`",
        ),
        (
            "run-a.csv",
            |t| t.replace("theta", "angle"),
            "has no column of the motion",
        ),
        (
            "run-a.csv",
            |t| t.replacen(",N2,", ",u,", 1),
            "column 3 is named `u`",
        ),
        ("run-a.csv", |t| t.replace("time,", "clock,"), "`time`"),
        (
            "run-a.csv",
            |t| t.replacen("time,", "t,", 1),
            "has no column `time` [s], the first column is `t`",
        ),
        (
            "run-a.csv",
            |t| t.replacen("\n0.0500,", "\n0.0500,x", 1),
            "is not a number",
        ),
        (
            "run-a.csv",
            |t| t.replacen("\n0.0500,", "\n0.0500,1,", 1),
            "the header names 7 columns",
        ),
        ("run-a.csv", |_| String::new(), "is empty"),
        ("run-a.csv", |t| lines(t, |_| false), "no sample below it"),
        (
            "held-out.csv",
            |t| column(t, "theta", |_, _| "NaN".into()),
            "no stretch of 0.975 s",
        ),
        (
            "held-out.csv",
            |t| {
                column(t, "theta_dot", |r, v| {
                    if r % 40 == 0 {
                        "inf".into()
                    } else {
                        v.to_string()
                    }
                })
            },
            "is not finite",
        ),
        // Units.
        (
            "run-a.csv",
            |t| scaled(t, "theta_dot", 30.0 / PI),
            "is `theta_dot` in rpm?",
        ),
        (
            "run-a.csv",
            |t| scaled(t, "theta3_dot", 180.0 / PI),
            "is `theta3_dot` in degrees per second?",
        ),
        (
            "run-a.csv",
            |t| scaled(t, "theta_dot", 0.5 / PI),
            "is `theta_dot` in turns per second?",
        ),
        (
            "run-a.csv",
            |t| scaled(t, "theta", 180.0 / PI),
            "is `theta` in degrees?",
        ),
        (
            "run-a.csv",
            |t| scaled(t, "theta3", 0.5 / PI),
            "is `theta3` in turns?",
        ),
        (
            "held-out.csv",
            |t| scaled(&scaled(t, "theta3", 8.0), "theta3_dot", 8.0),
            "motor's side of the gearbox",
        ),
        (
            "held-out.csv",
            |t| scaled(t, "theta3", 8.0),
            "motor's side of the gearbox",
        ),
        ("run-a.csv", |t| scaled(t, "theta", -1.0), "opposite signs"),
        (
            "run-a.csv",
            |t| {
                ["theta", "theta_dot", "theta3", "theta3_dot"]
                    .iter()
                    .fold(t.to_owned(), |t, c| scaled(&t, c, 180.0 / PI))
            },
            "are all angles in degrees",
        ),
        ("run-a.csv", |t| scaled(t, "u", 1e3), "is u in mV?"),
        (
            "run-a.csv",
            |t| scaled(t, "u", 1.0 / 24.0),
            "a share of the supply voltage",
        ),
        ("run-a.csv", |t| scaled(t, "N2", 1e3), "is it in mN or g?"),
        ("run-a.csv", |t| scaled(t, "N2", 1e-3), "is it in kN?"),
        (
            "run-a.csv",
            |t| scaled(t, "N2", -1.0),
            "pulling as positive",
        ),
        (
            "run-a.csv",
            |t| scaled(&scaled(t, "theta", 180.0 / PI), "theta_dot", 180.0 / PI),
            "are `theta` and `theta_dot` in degrees?",
        ),
        (
            "run-a.csv",
            |t| scaled(&scaled(t, "theta3", -1.0), "theta3_dot", -1.0),
            "count in opposite directions",
        ),
        // Sensors.
        (
            "run-a.csv",
            |t| column(t, "theta", |_, v| v.rem_euclid(2.0 * PI).to_string()),
            "give the angle unwrapped",
        ),
        (
            "run-a.csv",
            |t| scaled(t, "theta", 0.0),
            "`theta` does not change while `theta_dot`",
        ),
        (
            "run-a.csv",
            |t| scaled(t, "theta3_dot", 0.0),
            "`theta3_dot` does not change while `theta3`",
        ),
        (
            "run-a.csv",
            |t| {
                ["theta", "theta_dot", "theta3", "theta3_dot"]
                    .iter()
                    .fold(t.to_owned(), |t, c| scaled(&t, c, 0.0))
            },
            "neither disc nor motor moves",
        ),
        // Too little.
        (
            "run-a.csv",
            |t| lines(t, |row| row < 60),
            "no stretch of 0.975 s",
        ),
        (
            "run-a.csv",
            |t| lines(t, |row| row % 12 == 0),
            "sampled every 0.1200 s",
        ),
        // The same measurement twice.
        (
            "held-out.csv",
            |_| files()[1].1.clone(),
            "same measurement as",
        ),
        (
            "held-out.csv",
            |_| lines(&files()[2].1, |row| row > 500),
            "or a part of it",
        ),
        ("run-b.csv", |_| files()[1].1.clone(), "Give it once"),
        // Model and sensors.
        ("model.toml", |t| t.replace("[shaft]", "[shfat]"), "shfat"),
        (
            "model.toml",
            |t| t.replace("inertia = 0.0149", "inertia = -1.0"),
            "inertia",
        ),
        (
            "model.toml",
            |t| t.replace("\"stribeck\"", "\"stribek\""),
            "stribek",
        ),
        (
            "sensors.toml",
            |_| "disc_encoder_step = 0.006\n".into(),
            "gear_encoder_step",
        ),
        (
            "sensors.toml",
            |_| {
                "disc_encoder_step = 0\ngear_encoder_step = 1\ndisc_velocity_noise = 1\ngear_velocity_noise = 1\nload_cell_noise = 1\n".into()
            },
            "must be a finite number above 0",
        ),
    ];
    for (file, change, words) in table {
        let message = match changed(file, change) {
            Ok(case) => panic!("{file}: `{words}` was not said; notes: {:?}", case.notes),
            Err(message) => message,
        };
        assert!(message.contains(words), "{words}: {message}");
        assert!(message.contains(file), "{file}: {message}");
    }
}
