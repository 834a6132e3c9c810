//! Writes cases: each directory appears whole or not at all.

use crate::answers::{Answer, Answers};
use crate::error::{MakerError, at};
use crate::instruments::{Noise, record_csv};
use crate::law::ContactLaw;
use crate::plan::PlannedCase;
use crate::random::{Purpose, Stream};
use crate::rig::NOMINAL;
use crate::simulator::{Simulator, State};
use std::fs;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Makes all `cases` under `directory` on `threads` threads, then writes `ANSWERS.json`.
/// `on_case` is called after each finished case.
///
/// # Errors
/// The directory holds something already, a file cannot be written, or a simulation diverges.
pub fn make_cases(
    directory: &Path,
    cases: &[PlannedCase],
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
            let result = make_case(directory, case);
            let failed = result.is_err();
            if let Ok(mut results) = results.lock() {
                results.push((case.name.clone(), result));
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

/// Draws, simulates and writes one case; returns its answer.
fn make_case(directory: &Path, planned: &PlannedCase) -> Result<Answer, MakerError> {
    let case = planned.recipe.draw();
    let partial = directory.join(format!(".partial-{}", planned.name));
    fs::create_dir_all(&partial).map_err(at(&partial))?;
    let write = |file: &str, text: String| {
        let path = partial.join(file);
        fs::write(&path, text).map_err(at(path))
    };
    write("model.toml", model_toml(&case.believed_law))?;
    for (index, run) in case.runs.iter().enumerate() {
        let stream =
            |purpose: fn(u64) -> Purpose| Stream::new(planned.recipe.seed, purpose(index as u64));
        let samples = Simulator::new(&case.rig, State::default(), stream(Purpose::Contact))
            .run(&run.excitation)
            .map_err(|error| match error {
                MakerError::Diverged { time, .. } => MakerError::Diverged {
                    case: planned.name.clone(),
                    time,
                },
                other => other,
            })?;
        let text = record_csv(
            &run.excitation,
            &samples,
            &case.rig.effects,
            Noise::scaled(planned.recipe.noise),
            &mut stream(Purpose::Sensors),
        );
        write(run.file, text)?;
    }
    let path = directory.join(&planned.name);
    fs::rename(&partial, &path).map_err(at(path))?;
    Ok(case.answer)
}

/// What the analyst believes: nominal parameters and `law`.
pub fn model_toml(law: &ContactLaw) -> String {
    let rig = &NOMINAL;
    let contact = match law {
        ContactLaw::Coulomb { mu_c } => format!("mu_c = {mu_c}\n"),
        ContactLaw::CoulombStiction { mu_c, mu_s } => format!("mu_c = {mu_c}\nmu_s = {mu_s}\n"),
        ContactLaw::Stribeck {
            mu_c,
            mu_s,
            omega_s,
        } => format!("mu_c = {mu_c}\nmu_s = {mu_s}\nomega_s = {omega_s}\n"),
        ContactLaw::TwoGaussian(law) => format!(
            "a1 = {}\nb1 = {}\nc1 = {}\na2 = {}\nb2 = {}\nc2 = {}\nomega_centre = {}\n\
             acceleration_semi_axis = {}\n",
            law.height[0],
            law.centre[0],
            law.width[0],
            law.height[1],
            law.centre[1],
            law.width[1],
            law.omega_centre,
            law.acceleration_semi_axis
        ),
        ContactLaw::Blend { base, .. } => return model_toml(base),
    };
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
