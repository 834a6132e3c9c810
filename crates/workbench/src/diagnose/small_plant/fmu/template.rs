//! `stickslip ports`: a first ports file for an FMU, to be corrected by hand.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;

use super::ports::key;
use crate::component::{Description, Fmu, Kind, Role, Variable};
use crate::files::atomic;
use crate::outcome::Outcome;
use inference::body::term::MOST_PARAMETERS;

/// Arguments of `ports`.
#[derive(Debug, Args)]
pub struct PortsArguments {
    /// The FMU.
    fmu: PathBuf,
    /// File to write; without it the text goes to the screen.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes a first ports file.
///
/// # Errors
/// The FMU cannot be read, or the file not be written.
pub fn command(arguments: &PortsArguments) -> anyhow::Result<Outcome> {
    let description = Fmu::describe(&arguments.fmu)?;
    let text = text(&arguments.fmu, &description);
    match &arguments.out {
        Some(file) => {
            atomic::write_file(file, text.as_bytes())?;
            println!(
                "{}: correct it by hand, then use it with diagnose",
                file.display()
            );
        }
        None => print!("{text}"),
    }
    Ok(Outcome::Done)
}

/// Units of torques and of what turns, and those of forces and of what moves along a line.
const TURNING: [&str; 8] = ["N.m", "N m", "Nm", "rad", "rad/s", "deg", "deg/s", "rpm"];
const POSITIONS: [&str; 5] = ["rad", "deg", "rev", "m", "mm"];
const VELOCITIES: [&str; 5] = ["rad/s", "deg/s", "rpm", "m/s", "mm/s"];
const FORCES: [&str; 8] = ["N.m", "N m", "Nm", "mN.m", "kN.m", "N", "kN", "mN"];

/// The text of a first ports file.
#[must_use]
pub fn text(fmu: &Path, description: &Description) -> String {
    let real: Vec<&Variable> = description
        .variables
        .iter()
        .filter(|v| v.kind == Kind::Real)
        .collect();
    let of = |role: Role, units: &[&str]| -> Vec<&Variable> {
        let fits = |v: &&&Variable| {
            v.role == role && (units.is_empty() || units.contains(&v.unit.as_str()))
        };
        real.iter().filter(fits).copied().collect()
    };
    // A parameter that may change between steps does as well as an input.
    let mut forces = of(Role::Input, &FORCES);
    let takes_force = |v: &&&Variable| v.is_tunable && FORCES.contains(&v.unit.as_str());
    forces.extend(real.iter().filter(takes_force).copied());
    let turns = real
        .iter()
        .any(|v| v.role == Role::Output && TURNING.contains(&v.unit.as_str()));
    let mut text = format!(
        "# Ports of {}, from its description. Correct what is marked, then: stickslip diagnose --model {} --ports THIS-FILE \\\n\
         #   --records run-a.csv run-b.csv --held-out held-out.csv --out result\n\n\
         [plant]\nkind = \"fmu\"\npath = \"{}\"  # \"turn\" or \"line\": of the motion where the missing force acts\n",
        description.model_name,
        fmu.display(),
        if turns { "turn" } else { "line" }
    );
    text.push_str("\n# Input or tunable parameter for a force or torque, and the outputs that are position and velocity where it acts. Several places: one\n# [[port]] with a name for each.\n[port]\n");
    let _ = writeln!(text, "input = {}", choice(&forces, &of(Role::Input, &[])));
    let outputs = of(Role::Output, &[]);
    for (word, units) in [("position", &POSITIONS[..]), ("velocity", &VELOCITIES[..])] {
        let _ = writeln!(
            text,
            "{word} = {}",
            choice(&of(Role::Output, units), &outputs)
        );
    }
    text.push_str(
        "# A load on which friction may depend; a normal force on a turn takes its radius [m] as factor.\n\
         # load = { variable = \"name\", factor = 1.0 }\n",
    );
    text.push_str(
        "\n# Inputs that a column drives; between two samples they are \"held\" or \"linear\". Others keep their start values.\n[inputs]\n",
    );
    for input in of(Role::Input, &[]) {
        let _ = writeln!(
            text,
            "# {} = {{ column = {:?}, unit = {:?}, between = \"linear\" }}{}",
            key(&input.name),
            input.name,
            input.unit,
            remark(input)
        );
    }
    text.push_str(
        "\n# Variables that take the first measured \"position\" or \"velocity\".\n[start]\n",
    );
    text.push_str("# phi_start = \"position\"\n");
    text.push_str(
        "\n# The records' columns, with their units.\n[columns]\ntime = { column = \"t\", unit = \"s\" }\n\
         position = { column = \"position\", unit = \"rad\" }\n# velocity = { column = \"velocity\", unit = \"rad/s\" }\n\
         \n[measurement]\nmotion_low_pass = 20.0  # [Hz] frees the motion from noise; some ten times what the plant does\n\
         compare_low_pass = 10.0  # [Hz] forces are compared below this; not above motion_low_pass\n\
         compare_rate = 50.0  # [Hz] a few times compare_low_pass\n\
         edge = 0.5  # [s] left aside at both ends: until the FMU's start is forgotten\n\
         standstill_speed = 0.01  # below this the plant counts as standing; above the noise of the velocity\n",
    );
    let _ = writeln!(
        text,
        "\n# Parameters that are uncertain, at most {MOST_PARAMETERS}, with one standard deviation over the value.\n[parameters]"
    );
    for parameter in of(Role::Parameter, &[]) {
        let unit = if parameter.unit.is_empty() {
            "1"
        } else {
            &parameter.unit
        };
        let _ = writeln!(
            text,
            "# {} = {{ value = {:?}, unit = {unit:?}, relative_uncertainty = 0.05 }}{}",
            key(&parameter.name),
            parameter.start.unwrap_or_default(),
            remark(parameter)
        );
    }
    text
}

/// The first of `likely`, or of `others` where there is none, with the rest as a comment.
fn choice(likely: &[&Variable], others: &[&Variable]) -> String {
    let all = if likely.is_empty() { others } else { likely };
    let names: Vec<String> = all.iter().map(|v| format!("{:?}", v.name)).collect();
    match names.split_first() {
        None => "\"\"  # the FMU has none".to_owned(),
        Some((first, [])) => first.clone(),
        Some((first, rest)) => format!("{first}  # or {}", rest.join(", ")),
    }
}

fn remark(variable: &Variable) -> String {
    if variable.description.is_empty() {
        String::new()
    } else {
        format!("  # {}", variable.description)
    }
}
