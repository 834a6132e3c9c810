//! Writes cases: each directory appears whole or not at all.

use crate::answers::{Answer, Answers};
use crate::error::{MakerError, at};
use crate::excitation::SAMPLE_INTERVAL;
use crate::instruments::{Instruments, record_csv};
use crate::law::ContactLaw;
use crate::plan::{Measured, PlannedCase};
use crate::random::{Purpose, Stream};
use crate::records::Recording;
use crate::rig::NOMINAL;
use crate::simulator::{Simulator, State};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A case that can be made.
pub trait Case: Sync {
    /// Directory name.
    fn name(&self) -> &str;
    /// Draws and simulates it.
    ///
    /// # Errors
    /// A simulation diverges, or no draw makes a case.
    fn make(&self) -> Result<MadeCase, MakerError>;
}

/// A case in memory.
pub struct MadeCase {
    /// Names and contents of its files.
    pub files: Vec<(String, String)>,
    /// The true `sensors.toml` where the case must not have it.
    pub true_sensors: Option<String>,
    /// What was hidden.
    pub answer: Answer,
}

/// Makes all `cases` under `directory` on `threads` threads, then writes `ANSWERS.json`.
/// `on_case` is called after each finished case. True instruments that a case must not have go to
/// `true-sensors/<case>/sensors.true.toml`.
///
/// # Errors
/// The directory holds something already, a file cannot be written, or a case cannot be made.
pub fn make_cases<C: Case>(
    directory: &Path,
    cases: &[C],
    threads: usize,
    on_case: &(dyn Fn() + Sync),
) -> Result<(), MakerError> {
    fs::create_dir_all(directory).map_err(at(directory))?;
    let mut entries = fs::read_dir(directory).map_err(at(directory))?;
    if entries.next().is_some() {
        return Err(MakerError::OutputNotEmpty(directory.to_owned()));
    }
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<(String, Result<Answer, MakerError>)>> = Mutex::default();
    let worker = || {
        while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
            let result = write_case(directory, case);
            let failed = result.is_err();
            if let Ok(mut results) = results.lock() {
                results.push((case.name().to_owned(), result));
            }
            if failed {
                // Nothing more is begun once a case has failed.
                next.store(cases.len(), Ordering::Relaxed);
            }
            on_case();
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(worker);
        }
        worker();
    });
    let results = results.into_inner().unwrap_or_default();
    let answers = results
        .into_iter()
        .map(|(name, result)| Ok((name, result?)))
        .collect::<Result<Answers, MakerError>>()?;
    let text = serde_json::to_string_pretty(&answers)? + "\n";
    let partial = directory.join(".partial-ANSWERS.json");
    let path = directory.join("ANSWERS.json");
    fs::write(&partial, text).map_err(at(&partial))?;
    fs::rename(&partial, &path).map_err(at(path))
}

/// Makes and writes one case; returns its answer.
fn write_case<C: Case>(directory: &Path, case: &C) -> Result<Answer, MakerError> {
    let made = case.make()?;
    let partial = directory.join(format!(".partial-{}", case.name()));
    fs::create_dir_all(&partial).map_err(at(&partial))?;
    for (file, text) in made.files {
        let path = partial.join(file);
        fs::write(&path, text).map_err(at(path))?;
    }
    if let Some(text) = made.true_sensors {
        let beside = directory.join("true-sensors").join(case.name());
        fs::create_dir_all(&beside).map_err(at(&beside))?;
        let path = beside.join("sensors.true.toml");
        fs::write(&path, text).map_err(at(path))?;
    }
    let path = directory.join(case.name());
    fs::rename(&partial, &path).map_err(at(path))?;
    Ok(made.answer)
}

impl Case for PlannedCase {
    fn name(&self) -> &str {
        &self.name
    }

    fn make(&self) -> Result<MadeCase, MakerError> {
        let case = self.recipe.draw();
        let mut files = vec![("model.toml".to_owned(), model_toml(&case.believed_law))];
        let mut tools = Stream::new(self.recipe.seed, Purpose::Instruments);
        let known = Instruments::dissertation(&mut tools).noisier(self.recipe.noise);
        let instruments = if self.measured.unknown {
            known.unknown_to_all(&mut tools)
        } else {
            known
        };
        let reads_current = self.measured.sensors.has("i");
        let sensors = instruments.toml(reads_current);
        if reads_current && !self.measured.unknown {
            files.push(("sensors.toml".to_owned(), sensors.clone()));
        }
        for (index, run) in case.runs.iter().enumerate() {
            let stream =
                |purpose: fn(u64) -> Purpose| Stream::new(self.recipe.seed, purpose(index as u64));
            let samples = Simulator::new(&case.rig, State::default(), stream(Purpose::Contact))
                .run(&run.excitation)
                .map_err(|error| error.in_case(&self.name))?;
            let mut noise = stream(Purpose::Sensors);
            let text = if self.measured == Measured::default() {
                let effects = &case.rig.effects;
                record_csv(&run.excitation, &samples, effects, &known, &mut noise)
            } else {
                Recording {
                    excitation: &run.excitation,
                    samples: &samples,
                    effects: &case.rig.effects,
                    disc1_effects: None,
                    instruments: &instruments,
                    sensors: self.measured.sensors,
                    interval: SAMPLE_INTERVAL,
                    voltage_step: 1e-5,
                }
                .csv(&mut noise)
            };
            files.push((run.file.to_owned(), text));
        }
        let unknown = self.measured.unknown;
        let mut answer = case.answer;
        answer.sensors = unknown.then(|| instruments.answers());
        Ok(MadeCase {
            files,
            true_sensors: unknown.then_some(sensors),
            answer,
        })
    }
}

/// What the analyst believes: nominal parameters and `law`.
pub fn model_toml(law: &ContactLaw) -> String {
    let rig = &NOMINAL;
    let mut contact = String::new();
    for (key, value) in law.numbers() {
        // Writing into a String cannot fail.
        let _ = writeln!(contact, "{key} = {value}");
    }
    format!(
        "# What the analyst believes before looking at the records. \
         SI units, shaft side of the gearbox unless named motor.\n\
         [disc]\ninertia = {}            # kg m2\n\
         [shaft]\nstiffness = {}         # N m/rad\ndamping = {}           # N m s/rad\n\
         [gearbox]\nratio = {:.1}\n\
         [motor]\ninertia = {}         # kg m2\nresistance = {}            # ohm\n\
         inductance = {}      # H\ntorque_constant = {}       # N m/A\n\
         back_emf_constant = {}    # V s/rad\ncoulomb_torque = {}       # N m\n\
         viscous_damping = {}   # N m s/rad\n\
         [contact]\nradius = {}             # m, pin to rotation centre\nlaw = \"{}\"\n{contact}",
        rig.disc_inertia,
        rig.shaft_stiffness,
        rig.shaft_damping,
        rig.gear_ratio,
        rig.motor_inertia,
        rig.resistance,
        rig.inductance,
        rig.torque_constant,
        rig.back_emf_constant,
        rig.motor_coulomb_torque,
        rig.motor_viscous_damping,
        rig.contact_radius,
        law.name(),
    )
}
