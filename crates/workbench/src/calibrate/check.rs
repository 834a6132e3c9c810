//! What a target file must not say.

use stickslip::parameter::ParameterError;
use stickslip::plant::Rig;

use super::cycle::Disc;
use super::target::{Goal, Point, Search, Sought, Target, TargetError};

/// Most starts, members and generations of a search: above, it is a slip of the pen.
const MOST: usize = 100_000;

/// Refuses a target that makes no sense for `rig`; `file` names it in messages.
pub(super) fn check(target: &Target, file: &str, rig: &Rig<f64>) -> Result<(), TargetError> {
    let refuse = |(place, message): (String, String)| TargetError::Value {
        file: file.to_owned(),
        place,
        message,
    };
    if target.parameter.is_empty() || target.point.is_empty() {
        return Err(refuse((
            "[[parameter]], [[point]]".to_owned(),
            "at least one of each is needed".to_owned(),
        )));
    }
    check_search(&target.search).map_err(refuse)?;
    for transition in &target.transition {
        transition
            .check()
            .map_err(|message| refuse((transition.label(), message.to_owned())))?;
    }
    for (index, sought) in target.parameter.iter().enumerate() {
        check_range(sought, &target.parameter[..index]).map_err(refuse)?;
        let mut trial = *rig;
        for bound in [sought.minimum, sought.maximum] {
            trial
                .set_parameter(&sought.name, bound)
                .map_err(|source| TargetError::Parameter {
                    file: file.to_owned(),
                    name: sought.name.clone(),
                    hint: hint(&sought.name, &source, rig),
                    source,
                })?;
        }
    }
    for point in &target.point {
        check_point(point, rig)
            .map_err(|message| refuse((format!("[[point]] at {}", point.label()), message)))?;
    }
    Ok(())
}

fn check_search(search: &Search) -> Result<(), (String, String)> {
    let refuse = |message: String| Err(("[search]".to_owned(), message));
    if search.population < 5 {
        return refuse(format!(
            "population is {}; it must be at least 5",
            search.population
        ));
    }
    if search.starts == 0 {
        return refuse("starts is 0; it must be at least 1".to_owned());
    }
    for (name, size) in [
        ("starts", search.starts),
        ("population", search.population),
        ("generations", search.generations),
    ] {
        if size > MOST {
            return refuse(format!("{name} is {size}; it must be at most {MOST}"));
        }
    }
    let margin = search.smallest_loop_margin;
    if !(0.0..1.0).contains(&margin) {
        return refuse(format!(
            "smallest_loop_margin is {margin}; it must be at least 0 and below 1"
        ));
    }
    Ok(())
}

fn check_range(sought: &Sought, earlier: &[Sought]) -> Result<(), (String, String)> {
    let refuse = |message: String| Err((format!("[[parameter]] {}", sought.name), message));
    let Sought {
        name,
        minimum,
        maximum,
    } = sought;
    if earlier.iter().any(|other| other.name == *name) {
        return refuse("is sought twice; one range is needed".to_owned());
    }
    if !minimum.is_finite() || !maximum.is_finite() || minimum >= maximum {
        return refuse(format!(
            "minimum is {minimum} and maximum {maximum}; both must be finite and minimum must be below maximum"
        ));
    }
    Ok(())
}

/// Which names would be right where one is unknown.
fn hint(name: &str, source: &ParameterError, rig: &Rig<f64>) -> String {
    if !matches!(source, ParameterError::Unknown { .. }) {
        return String::new();
    }
    let section = name.split('.').next().unwrap_or(name);
    if rig.effect_infos(section).is_some() {
        return format!("; a model file with a section [{section}] has it");
    }
    let all: Vec<String> = rig
        .parameters()
        .into_iter()
        .map(|parameter| parameter.name)
        .collect();
    let same: Vec<&str> = all
        .iter()
        .filter(|known| known.split('.').next() == Some(section))
        .map(String::as_str)
        .collect();
    if same.is_empty() {
        format!("; it has {}", all.join(", "))
    } else {
        format!("; it has {}", same.join(", "))
    }
}

fn check_point(point: &Point, rig: &Rig<f64>) -> Result<(), String> {
    if !point.speed_rpm.is_finite() {
        return Err(format!(
            "speed_rpm is {}; it must be a finite number",
            point.speed_rpm
        ));
    }
    for (name, force) in [
        ("normal_force", point.normal_force),
        ("normal_force_1", point.normal_force_1),
    ] {
        if !force.is_finite() || force < 0.0 {
            return Err(format!(
                "{name} is {force} N; it must be a finite number of at least 0: a pin presses and cannot pull"
            ));
        }
    }
    let disc1 = point.disc == Disc::D1 || point.normal_force_1 != 0.0;
    if disc1 && rig.disc1.is_none() {
        return Err(
            "disc D1 and normal_force_1 need a model with [disc1], [shaft1] and [contact1]"
                .to_owned(),
        );
    }
    let goals = [
        ("frequency_hz", point.frequency_hz),
        ("half_amplitude", point.half_amplitude),
        ("minimum_velocity", point.minimum_velocity),
        ("maximum_velocity", point.maximum_velocity),
    ];
    for (name, goal) in goals {
        if let Some(goal) = goal {
            check_goal(name, &goal)?;
        }
    }
    if goals.iter().all(|(_, goal)| goal.is_none()) && point.sticking.is_none() {
        return Err(
            "nothing is stated about it; sticking or one of frequency_hz, half_amplitude, minimum_velocity, maximum_velocity is needed"
                .to_owned(),
        );
    }
    Ok(())
}

fn check_goal(name: &str, goal: &Goal) -> Result<(), String> {
    let Goal { value, bar, weight } = *goal;
    if !value.is_finite() || value == 0.0 {
        return Err(format!(
            "{name} has the value {value}; it must be finite and other than 0, since its bar is relative"
        ));
    }
    if matches!(name, "frequency_hz" | "half_amplitude") && value < 0.0 {
        return Err(format!("{name} has the value {value}; it must be above 0"));
    }
    if !bar.is_finite() || bar <= 0.0 {
        return Err(format!(
            "{name} has the bar {bar}; it must be a finite number above 0, such as 0.01 for one per cent"
        ));
    }
    if !weight.is_finite() || weight < 0.0 {
        return Err(format!(
            "{name} has the weight {weight}; it must be a finite number of at least 0"
        ));
    }
    Ok(())
}
