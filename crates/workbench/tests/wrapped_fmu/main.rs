//! FMUs around a foreign FMU: the effects' force is what it should be, all else is the original's.

#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "../common/mod.rs"]
mod common;

use std::fs::{self, File};
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use workbench::component::{self, Component};
use zip::ZipArchive;

use crate::common::{compiled, library as built_library, pack, stickslip};

const DESCRIPTION: &str = include_str!("spring.xml");

/// Ports of the spring with dry friction, as a person would write them.
const PORTS: &str = include_str!("ports.toml");

/// The spring's library, compiled once.
fn library() -> &'static [u8] {
    static LIBRARY: OnceLock<Vec<u8>> = OnceLock::new();
    LIBRARY.get_or_init(|| compiled("crates/workbench/tests/wrapped_fmu/spring.rs"))
}

fn binary() -> String {
    let system = match std::env::consts::OS {
        "macos" => "darwin",
        other => other,
    };
    let (machine, end) = (std::env::consts::ARCH, std::env::consts::DLL_EXTENSION);
    format!("binaries/{machine}-{system}/Spring.{end}")
}

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self::of(DESCRIPTION)
    }

    /// With a spring of this description.
    fn of(description: &str) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        pack(
            &place.file("spring.fmu"),
            &[
                ("modelDescription.xml", description.as_bytes()),
                (&binary(), library()),
                (
                    "documentation/notes.txt",
                    b"what its maker wants to be read",
                ),
            ],
        );
        place
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// What `stickslip build` says of these ports: exit code and text.
    fn build(&self, ports: &str) -> (i32, String) {
        let file = self.file("ports.toml");
        fs::write(&file, ports).unwrap();
        let out = self.file("out");
        stickslip(&[
            "build",
            file.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
            "--library",
            &built_library("stickslip_wrapper"),
        ])
    }

    fn wrapped(&self, ports: &str) -> PathBuf {
        let (code, text) = self.build(ports);
        assert_eq!(code, 0, "{text}");
        self.file("out").join("spring.amended.fmu")
    }
}

/// Position at `end` after steps of `step` [s], with these variables set before.
fn run(fmu: &Path, settings: &[(&str, f64)], step: f64, end: f64) -> [f64; 3] {
    let mut component = component::open(fmu).unwrap();
    let place = |component: &dyn Component, name| component::position(component, name).unwrap();
    let settings: Vec<(usize, f64)> = settings
        .iter()
        .map(|(name, value)| (place(&*component, name), *value))
        .collect();
    component.set(&settings).unwrap();
    component.initialise(0.0, end).unwrap();
    let count = (end / step).round() as usize;
    for at in 0..count {
        component
            .step(at as f64 * step, (at + 1) as f64 * step)
            .unwrap();
    }
    let read = ["x", "v", "effects.force"].map(|name| place(&*component, name));
    let mut values = [0.0; 3];
    component.get(&read, &mut values).unwrap();
    values
}

#[test]
fn friction_around_a_spring_is_exact_to_the_second_order_and_sticks() {
    // An original that goes back to the start of a step, and one that cannot.
    sticks_and_converges(DESCRIPTION);
    let states = "canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"";
    assert!(DESCRIPTION.contains(states));
    sticks_and_converges(&DESCRIPTION.replace(states, ""));
}

fn sticks_and_converges(description: &str) {
    let place = Place::of(description);
    let fmu = place.wrapped(PORTS);
    // Two turns, then the third half swing, from 0.4 about 0.15.
    let exact = 0.15 + 0.25 * (8.0 - std::f64::consts::TAU).cos();
    // The largest of several, since it depends on where in a step a turn falls.
    let error = |coupling: f64| {
        let one = |share: f64| {
            let settings = [("effects.coupling_step", share * coupling)];
            (run(&fmu, &settings, 0.5, 8.0)[0] - exact).abs()
        };
        [1.0, 0.93, 0.87, 0.81]
            .map(one)
            .into_iter()
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(0.08), error(0.005));
    assert!(coarse < 4e-4, "{coarse}");
    let order = (coarse / fine).ln() / 16f64.ln();
    assert!(order > 1.8, "{coarse} {fine}: order {order}");
    // Three half swings lose 0.3 each; at −0.1 the spring is weaker than friction, which then holds it.
    let [x, v, force] = run(&fmu, &[], 0.05, 60.0);
    assert!((x + 0.1).abs() < 1e-4, "{x}");
    assert!(v.abs() < 1e-12, "{v}");
    assert!(
        (force - x).abs() < 1e-9,
        "friction holds the spring: {force}"
    );
}

#[test]
fn an_effect_that_the_user_describes_acts_as_the_built_in_one() {
    let place = Place::new();
    let (_, without) = PORTS
        .rsplit_once("[coulomb_friction]")
        .map(|(a, b)| (b, a))
        .unwrap();
    let own = format!(
        "{without}[[effect]]\nname = \"grip\"\ntitle = \"a seal that grips\"\nport = \"plant.friction\"\n\
         equation = \"grip*direction\"\nparameters.grip = {{ value = 0.15, unit = \"N\", description = \"its force\" }}\n"
    );
    let built_in = run(&place.wrapped(PORTS), &[], 0.01, 8.0);
    let own = place.wrapped(&own);
    assert_eq!(
        run(&own, &[("effects.grip.grip", 0.15)], 0.01, 8.0),
        built_in
    );
    assert_ne!(
        run(&own, &[("effects.grip.grip", 0.1)], 0.01, 8.0),
        built_in
    );
}

#[test]
fn friction_under_a_load_follows_the_original_s_variable() {
    let place = Place::new();
    let built_in = run(&place.wrapped(PORTS), &[], 0.01, 8.0);
    let of_load = "[external_load_friction]\ncoefficient = 0.03";
    let loaded = PORTS
        .replace(
            "velocity = \"v\"\n",
            "velocity = \"v\"\nload = { variable = \"mass\", factor = 5.0 }\n",
        )
        .replace("[coulomb_friction]\nforce = 0.15", of_load);
    assert_eq!(run(&place.wrapped(&loaded), &[], 0.01, 8.0), built_in);
    // In N, as the mass is not.
    let (code, text) = place.build(&loaded.replace(", factor = 5.0", ""));
    assert!(
        code == 2 && text.contains("\"kg\"") && text.contains("give factor"),
        "{code} {text}"
    );
    let (code, text) = place.build(&PORTS.replace("[coulomb_friction]\nforce = 0.15", of_load));
    assert!(
        code == 2 && text.contains("external_load_friction"),
        "{code} {text}"
    );
}

#[test]
fn an_effect_of_no_size_changes_no_bit() {
    let place = Place::new();
    let none = [
        ("effects.coulomb_friction.force", 0.0),
        ("effects.coupling_step", 0.1),
    ];
    let [x, v, force] = run(&place.wrapped(PORTS), &none, 0.1, 5.0);
    let mut original = component::open(&place.file("spring.fmu")).unwrap();
    original.initialise(0.0, 5.0).unwrap();
    for at in 0..50 {
        original
            .step(f64::from(at) * 0.1, f64::from(at + 1) * 0.1)
            .unwrap();
    }
    let mut plain = [0.0; 2];
    original.get(&[1, 2], &mut plain).unwrap();
    assert_eq!([x, v, force], [plain[0], plain[1], 0.0]);
}

#[test]
fn the_original_is_inside_byte_for_byte_and_refitted_parameters_are_its_start_values() {
    let place = Place::new();
    let refitted = PORTS.replace("stiffness = { value = 1.0", "stiffness = { value = 4.0");
    let fmu = place.wrapped(&refitted);
    let mut inside = ZipArchive::new(File::open(&fmu).unwrap()).unwrap();
    let mut outside = ZipArchive::new(File::open(place.file("spring.fmu")).unwrap()).unwrap();
    for at in 0..outside.len() {
        let mut entry = outside.by_index(at).unwrap();
        let name = format!("resources/original/{}", entry.name().unwrap());
        let (mut wanted, mut found) = (Vec::new(), Vec::new());
        entry.read_to_end(&mut wanted).unwrap();
        let mut copy = inside.by_name(&name).unwrap();
        copy.read_to_end(&mut found).unwrap();
        assert!(wanted == found, "{name}");
    }
    let component = component::open(&fmu).unwrap();
    let stiffness = component::position(&*component, "stiffness").unwrap();
    assert_eq!(component.variables()[stiffness].start, Some(4.0));
    // Without friction the period is π now.
    let [x, ..] = run(
        &fmu,
        &[("effects.coulomb_friction.force", 0.0)],
        0.05,
        20.0 * std::f64::consts::PI,
    );
    assert!((x - 1.0).abs() < 2e-3, "{x}");
}

#[test]
fn the_importers_force_and_the_effects_add_up() {
    let place = Place::new();
    let fmu = place.wrapped(PORTS);
    // 0.5 of force and the spring at x = 1 pull with 0.5; friction of 0.6 holds.
    let settings = [("force", 0.5), ("effects.coulomb_friction.force", 0.6)];
    let [x, v, force] = run(&fmu, &settings, 0.1, 3.0);
    assert!((x - 1.0).abs() < 1e-9 && v.abs() < 1e-12, "{x} {v}");
    assert!((force - 0.5).abs() < 1e-9, "{force}");
}

#[test]
fn bad_ports_are_told_with_what_would_be_right() {
    let place = Place::new();
    for (from, to, said) in [
        (
            "inertia = 1.0\n",
            "",
            "[port] lacks inertia; the amended model that `stickslip diagnose` writes has it",
        ),
        (
            "inertia = 1.0",
            "inertia = 0.0",
            "[port] inertia = 0 must be a finite number other than 0",
        ),
        (
            "coupling_step = 0.01",
            "coupling_step = -1.0",
            "[port] coupling_step = -1 must be a number above 0",
        ),
        ("\"spring.fmu\"", "\"sprig.fmu\"", "sprig.fmu"),
        (
            "input = \"force\"",
            "input = \"farce\"",
            "did you mean `force`?",
        ),
    ] {
        assert!(PORTS.contains(from), "{from}");
        let (code, text) = place.build(&PORTS.replace(from, to));
        assert_eq!(code, 2, "{text}");
        assert!(text.contains(said), "{said:?} not in {text}");
        assert!(!place.file("out").join("spring.amended.fmu").exists());
    }
    let out = place.file("out");
    let ports = place.file("ports.toml");
    fs::write(&ports, PORTS).unwrap();
    let (code, text) = stickslip(&[
        "build",
        ports.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--fmi",
        "2",
    ]);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("leave --fmi"), "{text}");
}
