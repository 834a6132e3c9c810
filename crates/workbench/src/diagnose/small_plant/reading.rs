//! A record of a small plant from its file: columns found, units converted, times made even.

use std::path::Path as FilePath;

use super::case::SmallCaseError;
use super::columns::{Column, Quantity};
use super::fmu::missing::Recorded;
use super::model_file::SmallModel;
use crate::diagnose::record_part::Part;
use crate::files::record::{Dialect, Missing, Record, Table};
use inference::body::motion::{Measured, Motion};
use stickslip::body::Kind;

/// Fewest samples of a record.
const FEWEST: usize = 100;
/// Most by which a sampling step may differ from the median one, relative to it, before the record is read off again at even times.
const JITTER: f64 = 0.02;
/// A clock of which fewer than one step in so many is off is even, and these steps are wrong: a bus or a loaded computer puts off many.
const RARE: usize = 100;
/// Highest frequency that samples tell, over their rate: a little below Nyquist's.
const TOLD: f64 = 0.45;

/// Reads a record, the stretches between its holes each for itself; `driven` names columns that are wanted as they are, `notes` takes what
/// has to be said.
///
/// # Errors
/// [`SmallCaseError`], naming the file and what would be right.
pub fn read(
    part: &Part,
    model: &SmallModel,
    driven: &[&str],
    notes: &mut Vec<String>,
) -> Result<Vec<Recorded>, SmallCaseError> {
    let mut read = Vec::new();
    let mut failed = Vec::new();
    for mut sheet in Sheet::open(part, model, notes)? {
        let clock = sheet.look_at_the_clock(notes);
        match clock.and_then(|()| recorded(&sheet, part, model, driven)) {
            Ok(stretch) => read.push(stretch),
            Err(error) => failed.push(error),
        }
    }
    let mut failed = failed.into_iter();
    if read.is_empty()
        && let Some(error) = failed.next()
    {
        return Err(error);
    }
    // One in which the plant rests is no reason to refuse the others.
    notes.extend(failed.map(|error| format!("a stretch was left out: {error}")));
    Ok(read)
}

/// The motion of a stretch, and what drives it.
fn recorded(
    sheet: &Sheet<'_>,
    part: &Part,
    model: &SmallModel,
    driven: &[&str],
) -> Result<Recorded, SmallCaseError> {
    let columns = &model.columns;
    let mut motion = sheet.motion(part, columns.position.as_ref(), columns.velocity.as_ref())?;
    if let Some(force) = sheet.series(Quantity::Force)? {
        motion.force = force;
    }
    for quantity in [Quantity::Load, Quantity::ExternalLoad] {
        if let Some(load) = sheet.series(quantity)? {
            motion.load = load;
        }
    }
    if let Some(predicted) = sheet.series(Quantity::Predicted)? {
        motion.predicted = predicted;
    }
    if model.model.kind == Kind::Joint {
        motion.voltage = match (
            sheet.series(Quantity::Voltage)?,
            sheet.series(Quantity::Duty)?,
        ) {
            (Some(voltage), _) => voltage,
            (None, duty) => {
                let supply = sheet.series(Quantity::Supply)?.unwrap_or_default();
                let duty = duty.unwrap_or_default().into_iter();
                duty.zip(supply)
                    .map(|(share, volts)| share * volts)
                    .collect()
            }
        };
        motion.connected = sheet
            .series(Quantity::Connected)?
            .unwrap_or(vec![1.0; motion.len()]);
    }
    // A free swing is compared as a whole, a contact's law says how it sticks, and where an FMU rests, its pursuit tells.
    if matches!(model.model.kind, Kind::Drive | Kind::Balance | Kind::Joint) {
        let measurement = &model.measurement;
        let cut_off = measurement
            .compare_low_pass
            .unwrap_or(0.5 * measurement.compare_rate);
        motion.leave_rests_out(measurement.standstill_speed, cut_off);
        if motion.hardly_moves() {
            return Err(sheet.unusable(format!(
                "it is faster than [measurement] standstill_speed = {} for {:.3} s of {:.3} s; where it rests, friction takes any force, so that these records tell nothing",
                measurement.standstill_speed,
                motion.seconds_that_tell(),
                motion.seconds()
            )));
        }
    }
    let driven = driven
        .iter()
        .map(|name| sheet.column(name, "what drives an input"));
    let driven = driven.collect::<Result<Vec<_>, SmallCaseError>>()?;
    motion.driving = match model.model.kind {
        Kind::Drive => motion.force.clone(),
        Kind::Joint => motion.voltage.clone(),
        Kind::Fmu => driven.first().cloned().unwrap_or(motion.driving),
        Kind::Pendulum | Kind::Contact | Kind::Balance => motion.driving,
    };
    let mut motions = vec![motion];
    for port in model
        .ports
        .iter()
        .flat_map(|ports| ports.ports.iter().skip(1))
    {
        let [position, velocity] = [&port.measured_position, &port.measured_velocity];
        let motion = sheet.motion(part, position.as_ref(), velocity.as_ref())?;
        motions.push(Motion {
            driving: motions[0].driving.clone(),
            ..motion
        });
    }
    Ok(Recorded { motions, driven })
}

/// A record's table with its clock.
struct Sheet<'a> {
    model: &'a SmallModel,
    file: String,
    /// The columns that are there, for messages.
    known: String,
    record: Record,
    /// Sampling interval [s].
    interval: f64,
    /// Whether it is a stretch between holes.
    is_stretch: bool,
    /// Step of the even times at which the columns are read off, in the file's unit; `None` where its own are even.
    even: Option<f64>,
}

impl<'a> Sheet<'a> {
    fn open(
        part: &Part,
        model: &'a SmallModel,
        notes: &mut Vec<String>,
    ) -> Result<Vec<Self>, SmallCaseError> {
        let file = part.path.display().to_string();
        let time_name = &model.columns.time.column;
        let table = match &part.table {
            // A table's time stands apart from its columns, and has the name that is asked for.
            Some(table) => Table::of_record(table, time_name),
            None => Table::open(&part.path, &file, Dialect::Any)?,
        };
        if !table.said().is_empty() {
            notes.push(format!("read from {file}: {}", table.said().join(", ")));
        }
        let known = table.names().join(", ");
        let mut names = table.names().to_vec();
        let Some(time) = names.iter().position(|name| name == time_name) else {
            return Err(SmallCaseError::Unusable {
                what: format!(
                    "the model's [columns] names `{time_name}` as time, which is not there; it has {known}"
                ),
                file,
            });
        };
        "time".clone_into(&mut names[time]);
        // A free swing is compared as a whole, and an FMU runs from its start.
        let may_have_holes = !matches!(model.model.kind, Kind::Pendulum | Kind::Fmu);
        let missing = match may_have_holes {
            true => Missing::KeepAsNan,
            false => Missing::Refuse,
        };
        let record = table.record(&names, missing)?;
        let mut sheet = Self {
            model,
            file,
            known,
            record,
            interval: f64::NAN,
            even: None,
            is_stretch: false,
        };
        let to_seconds = sheet.factor(Quantity::Time);
        if let Some((from, to)) = part.span {
            sheet.record = sheet.record.window(from / to_seconds, to / to_seconds);
        }
        let given = model.columns.given(model.model.kind);
        let wanted: Vec<&str> = given.map(|(_, column)| column.column.as_str()).collect();
        sheet.record = sheet.record.without_missing(&wanted);
        Ok(match may_have_holes {
            true => sheet.stretches(notes),
            false => vec![sheet],
        })
    }

    /// The stretches between steps of time that are off, where these are few; the sheet itself where there are none.
    fn stretches(self, notes: &mut Vec<String>) -> Vec<Self> {
        let (time, usual) = (self.record.time(), self.record.median_step());
        let is_off = |pair: &[f64]| ((pair[1] - pair[0]) / usual - 1.0).abs() > JITTER;
        let steps = time.windows(2).enumerate();
        let mut ends: Vec<usize> = steps
            .filter(|(_, pair)| is_off(pair))
            .map(|(at, _)| at + 1)
            .collect();
        if ends.is_empty() || ends.len() >= time.len().div_ceil(RARE) {
            return vec![self];
        }
        ends.push(time.len());
        let mut begin = 0;
        let mut stretches = Vec::new();
        for end in ends {
            if end - begin >= FEWEST {
                let to = time.get(end).copied().unwrap_or(f64::INFINITY);
                stretches.push(Self {
                    model: self.model,
                    file: self.file.clone(),
                    known: self.known.clone(),
                    record: self.record.window(time[begin], to),
                    interval: f64::NAN,
                    even: None,
                    is_stretch: true,
                });
            }
            begin = end;
        }
        if stretches.is_empty() {
            return vec![self];
        }
        let used: usize = stretches.iter().map(|own| own.record.len()).sum();
        let left_out = match time.len() - used {
            0 => String::new(),
            short => format!("; {short} samples in stretches shorter than {FEWEST} were left out"),
        };
        notes.push(format!(
            "{}: has holes or missing values; stretches between them that were read as records of their own: {}{left_out}",
            self.file,
            stretches.len()
        ));
        stretches
    }

    /// Finds the sampling interval, and whether the times are even.
    fn look_at_the_clock(&mut self, notes: &mut Vec<String>) -> Result<(), SmallCaseError> {
        let to_seconds = self.factor(Quantity::Time);
        let (count, usual) = (self.record.len(), self.record.median_step() * to_seconds);
        if count < FEWEST || !usual.is_finite() {
            return Err(self.unusable(format!(
                "has {count} samples with a value in every column that [columns] names; at least {FEWEST} are needed"
            )));
        }
        let time = self.record.time();
        let steps: Vec<f64> = time
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) * to_seconds)
            .collect();
        let is_off = |step: &f64| (step / usual - 1.0).abs() > JITTER;
        let off = steps.iter().filter(|step| is_off(step)).count();
        let longest = steps.iter().copied().fold(0.0, f64::max);
        let is_even = off < steps.len().div_ceil(RARE);
        if let Some(at) = steps.iter().position(is_off)
            && is_even
        {
            return Err(self.unusable(format!(
                "the step at {} s is {:.6} s where {usual:.6} s is usual; a stretch without holes can be given as {}@FROM:TO",
                time[at] * to_seconds,
                steps[at],
                self.file
            )));
        }
        self.interval = usual;
        if !is_even {
            self.interval = (time[count - 1] - time[0]) * to_seconds / (count - 1) as f64;
            self.even = Some(self.interval / to_seconds);
            let shortest = steps.iter().copied().fold(f64::INFINITY, f64::min);
            notes.push(format!(
                "{}: steps of time from {shortest:.6} to {longest:.6} s; its columns were read off every {:.6} s, straight between \
                 samples",
                self.file, self.interval
            ));
        }
        // Where the clock is not even, what the longest step still tells counts.
        let rate = 1.0 / if is_even { usual } else { longest };
        let measurement = &self.model.measurement;
        for (key, cut_off) in [
            ("motion_low_pass", Some(measurement.motion_low_pass)),
            ("compare_low_pass", measurement.compare_low_pass),
        ] {
            if cut_off.is_some_and(|cut_off| cut_off >= TOLD * rate) {
                return Err(self.unusable(format!(
                    "is sampled at {rate:.1} Hz{}; the model's [measurement] {key} must be below {:.1} Hz",
                    if is_even { "" } else { " in its longest step" },
                    TOLD * rate
                )));
            }
        }
        let rate = 1.0 / self.interval;
        if measurement.compare_rate > 1.001 * rate {
            return Err(self.unusable(format!(
                "is sampled at {rate:.1} Hz; the model's [measurement] compare_rate must not be above that"
            )));
        }
        Ok(())
    }

    fn unusable(&self, what: String) -> SmallCaseError {
        SmallCaseError::Unusable {
            file: self.file.clone(),
            what,
        }
    }

    /// What one of a column's unit is in SI units.
    fn factor(&self, quantity: Quantity) -> f64 {
        let path = self.model.model.path;
        let mut given = self.model.columns.given(self.model.model.kind);
        let column = given.find(|(given, _)| *given == quantity);
        column
            .and_then(|(_, column)| column.factor(quantity, path).ok())
            .unwrap_or(1.0)
    }

    /// The motion that these columns have.
    fn motion(
        &self,
        part: &Part,
        position: Option<&Column>,
        velocity: Option<&Column>,
    ) -> Result<Motion, SmallCaseError> {
        let series = |column: Option<&Column>, quantity: Quantity| {
            column
                .map(|own| {
                    let factor = own.factor(quantity, self.model.model.path).unwrap_or(1.0);
                    let values = self.column(&own.column, quantity.word())?;
                    Ok::<Vec<f64>, SmallCaseError>(
                        values.iter().map(|value| value * factor).collect(),
                    )
                })
                .transpose()
        };
        let measured = match (
            series(position, Quantity::Position)?,
            series(velocity, Quantity::Velocity)?,
        ) {
            (Some(position), Some(velocity)) => {
                check_velocity(&position, &velocity, self.interval)
                    .map_err(|what| self.unusable(what))?;
                Measured::Both(position, velocity)
            }
            (Some(position), None) => Measured::Position(position),
            (None, Some(velocity)) => Measured::Velocity(velocity),
            (None, None) => {
                return Err(
                    self.unusable("neither position nor velocity is named in [columns]".to_owned())
                );
            }
        };
        let measurement = &self.model.measurement;
        let begin = self.record.time()[0] * self.factor(Quantity::Time);
        let name = file_name(&part.path);
        Ok(Motion::new(
            match part.span {
                _ if self.is_stretch => format!("{name} from {begin:.3} s"),
                Some((from, to)) => format!("{name} {from}–{to} s"),
                None => name,
            },
            begin,
            self.interval,
            measured,
            measurement.motion_low_pass,
            measurement.standstill_speed,
        ))
    }

    /// A column at even times, as it is.
    fn column(&self, name: &str, quantity: &'static str) -> Result<Vec<f64>, SmallCaseError> {
        let values = self
            .record
            .column(name)
            .ok_or_else(|| SmallCaseError::NoColumn {
                file: self.file.clone(),
                column: name.to_owned(),
                quantity,
                known: self.known.clone(),
            })?;
        Ok(match self.even {
            Some(step) => at_even_times(self.record.time(), values, step),
            None => values.to_vec(),
        })
    }

    /// A quantity in SI units; `None` where the model names no column for it.
    fn series(&self, quantity: Quantity) -> Result<Option<Vec<f64>>, SmallCaseError> {
        let mut given = self.model.columns.given(self.model.model.kind);
        let Some((_, column)) = given.find(|(given, _)| *given == quantity) else {
            return Ok(None);
        };
        let factor = self.factor(quantity);
        let values = self.column(&column.column, quantity.word())?;
        Ok(Some(values.iter().map(|value| value * factor).collect()))
    }
}

/// A column at even steps of time from its first sample on, straight between samples.
fn at_even_times(time: &[f64], values: &[f64], step: f64) -> Vec<f64> {
    let mut low = 0;
    (0..time.len())
        .map(|at| {
            let wanted = time[0] + at as f64 * step;
            while low + 2 < time.len() && time[low + 1] < wanted {
                low += 1;
            }
            let part = ((wanted - time[low]) / (time[low + 1] - time[low])).clamp(0.0, 1.0);
            values[low] + part * (values[low + 1] - values[low])
        })
        .collect()
}

/// Refuses a velocity that is not the position's, such as one in rpm called rad/s.
fn check_velocity(position: &[f64], velocity: &[f64], interval: f64) -> Result<(), String> {
    // Over some samples, so that the noise of single readings does not count.
    let wide = 20.min(position.len() / 4).max(1);
    let (mut product, mut square) = (0.0, 0.0);
    for at in 0..position.len() - wide {
        let moved = position[at + wide] - position[at];
        let summed = velocity[at..at + wide].iter().sum::<f64>() * interval;
        product += moved * summed;
        square += summed * summed;
    }
    let ratio = product / square;
    if (0.9..1.1).contains(&ratio) {
        Ok(())
    } else {
        Err(format!(
            "the position changes {ratio:.4} times as fast as the velocity says; check the units in [columns] (rpm to rad/s is 0.1047, deg to rad 0.01745)"
        ))
    }
}

/// Last part of a path.
fn file_name(path: &FilePath) -> String {
    path.file_name().map_or_else(
        || path.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}
