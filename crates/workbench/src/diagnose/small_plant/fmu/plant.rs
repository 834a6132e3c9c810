//! An FMU with its ports: variables found, units compared.

use std::path::{Path as FilePath, PathBuf};

use thiserror::Error;

use super::missing::Recorded;
use super::ports::{Coordinate, Input, LoadVariable, Port, Ports};
use super::pursuit::{Driven, Pursued, PursuedPort};
use crate::component::{
    ComponentError, Description, Fmu, Kind as ValueKind, Role, Variable, closest,
};
use crate::diagnose::small_plant::columns::{Column, Quantity};
use crate::diagnose::small_plant::model_file::SmallModel;
use inference::body::base::PARAMETERS;
use inference::body::motion::Motion;
use stickslip::body::{Dimension, Parameter, Path, plain};

/// An FMU and what its ports are.
#[derive(Debug, Clone)]
pub struct Plant {
    /// The FMU's file.
    pub file: PathBuf,
    /// What was taken for granted.
    pub notes: Vec<String>,
    /// The places where a force may be missing.
    pub places: Vec<Place>,
    /// The step that the FMU states, if any [s]: some take multiples of it alone.
    pub own_step: Option<f64>,
    /// Inputs with the factor from the column to the FMU's unit.
    inputs: Vec<(usize, Input, f64)>,
    /// Variables that take a coordinate of the first sample, with what one of their unit is in SI units.
    start: Vec<(usize, Coordinate, f64)>,
    /// Uncertain parameters with their standard deviations.
    parameters: Vec<(usize, f64)>,
}

/// A place where a force may be missing.
#[derive(Debug, Clone)]
pub struct Place {
    /// The port's input: its place among the variables, and what one of its unit is in SI units.
    pub input: (usize, f64),
    /// The output of the position there, likewise.
    pub position: Option<(usize, f64)>,
    /// The output of the velocity there, likewise.
    pub velocity: Option<(usize, f64)>,
    /// The variable of the load there, likewise.
    pub load: Option<(usize, f64)>,
    /// Frequency below which forces are compared there, where it has one of its own [Hz].
    pub cut_off: Option<f64>,
    /// Whether the position was measured, so that the FMU's is to be the same.
    is_absolute: bool,
    /// Whether the velocity was measured, too or alone.
    has_velocity: bool,
}

/// What is wrong with the ports of an FMU.
#[derive(Debug, Error)]
pub enum PlantError {
    /// No FMU is named.
    #[error(
        "{file}: names no FMU; add fmu = \"plant.fmu\" to [plant], or give it with --model plant.fmu --ports {file}"
    )]
    NoFmu {
        /// The ports file.
        file: String,
    },
    /// The FMU cannot be read.
    #[error(transparent)]
    Component(#[from] ComponentError),
    /// A variable that the FMU does not have.
    #[error("{file}: [{section}] names `{name}`; {fmu} has no such {what}{hint}")]
    NoVariable {
        /// The ports file.
        file: String,
        /// Its section.
        section: &'static str,
        /// The name.
        name: String,
        /// The FMU.
        fmu: String,
        /// What it should be.
        what: &'static str,
        /// The nearest name, as half a sentence; may be empty.
        hint: String,
    },
    /// A unit that does not fit.
    #[error("{file}: [{section}] {name}: {what}")]
    Unit {
        /// The ports file.
        file: String,
        /// Its section.
        section: &'static str,
        /// The variable.
        name: String,
        /// What is wrong and what would be right.
        what: String,
    },
}

/// Finds variables of one FMU for one ports file.
struct Finder<'a> {
    file: &'a str,
    fmu: String,
    path: Path,
    description: Description,
    notes: Vec<String>,
}

impl Plant {
    /// Reads the FMU's description, without running it, and finds what `model` names; `file` names the model in messages and
    /// `directory` is where its relative paths begin.
    ///
    /// # Errors
    /// [`PlantError`].
    pub fn find(
        model: &SmallModel,
        ports: &Ports,
        file: &str,
        directory: &FilePath,
    ) -> Result<Self, PlantError> {
        let named = ports.fmu.as_ref().ok_or_else(|| PlantError::NoFmu {
            file: file.to_owned(),
        })?;
        let fmu = directory.join(named);
        let mut finder = Finder {
            file,
            fmu: fmu.display().to_string(),
            path: model.model.path,
            description: Fmu::describe(&fmu)?,
            notes: Vec::new(),
        };
        let mut places = Vec::with_capacity(ports.ports.len());
        for (at, port) in ports.ports.iter().enumerate() {
            let of_first = |column: &Option<Column>| at == 0 && column.is_some();
            places.push(Place {
                is_absolute: port.measured_position.is_some() || of_first(&model.columns.position),
                has_velocity: port.measured_velocity.is_some() || of_first(&model.columns.velocity),
                ..finder.place(port)?
            });
        }
        let inputs = ports.inputs.iter().map(|(name, input)| {
            let at = finder.variable("inputs", name, "input", |v| v.role == Role::Input)?;
            Ok((at, input.clone(), finder.column_factor(at, input)?))
        });
        let inputs = inputs.collect::<Result<Vec<_>, PlantError>>()?;
        let can_be_set = |v: &Variable| v.start.is_some() && v.role != Role::Time;
        let start = ports.start.iter().map(|(name, coordinate)| {
            let at = finder.variable("start", name, "variable with a start value", can_be_set)?;
            let quantity = match coordinate {
                Coordinate::Position => Quantity::Position,
                Coordinate::Velocity => Quantity::Velocity,
            };
            Ok((at, *coordinate, finder.factor("start", at, quantity)?))
        });
        let start = start.collect::<Result<Vec<_>, PlantError>>()?;
        let terms = model.model.terms();
        let base = terms.iter().filter(|term| term.entry.name == PARAMETERS);
        let parameters = base
            .flat_map(|term| term.entry.parameters.iter().zip(&term.values))
            .map(|(parameter, _)| finder.parameter(parameter))
            .collect::<Result<Vec<_>, PlantError>>()?;
        finder.check_inputs(ports)?;
        Ok(Self {
            file: fmu,
            notes: finder.notes,
            places,
            own_step: finder.description.own_step,
            inputs,
            start,
            parameters,
        })
    }

    /// The columns that drive inputs.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.inputs
            .iter()
            .map(|(_, input, _)| input.column.as_str())
    }

    /// The uncertain parameters' places among the variables, with the values that `model` gives them.
    pub fn settings(&self, model: &SmallModel) -> impl Iterator<Item = (usize, f64)> {
        let base = model.model.terms().first().map(|term| term.values.clone());
        let places = self.parameters.iter().map(|(at, _)| *at);
        places.zip(base.unwrap_or_default())
    }

    /// Standard deviations of the uncertain parameters.
    pub fn deviations(&self) -> impl Iterator<Item = f64> {
        self.parameters.iter().map(|(_, deviation)| *deviation)
    }

    /// Inputs whose columns may be off by a constant, by their place among all that columns drive.
    pub fn offsets(&self) -> impl Iterator<Item = usize> {
        let all = self.inputs.iter().enumerate();
        all.filter(|(_, (_, input, _))| input.may_be_offset)
            .map(|(at, _)| at)
    }

    /// What the FMU with these values of its uncertain `parameters` runs after on a record whose readings at each port are so much late
    /// (`delays` [s]); `offset` is an input and what is added to its column.
    #[must_use]
    pub fn pursued(
        &self,
        record: &Recorded,
        parameters: &[f64],
        delays: &[f64],
        offset: Option<(usize, f64)>,
        cut_off: f64,
    ) -> Pursued {
        let own = self.parameters.iter().zip(parameters);
        let mut settings: Vec<(usize, f64)> = own.map(|((at, _), value)| (*at, *value)).collect();
        let motions = record.motions.iter().zip(delays);
        let ports: Vec<PursuedPort> = self
            .places
            .iter()
            .zip(motions)
            .map(|(place, (motion, delay))| place.pursued(motion, *delay, cut_off))
            .collect();
        settings.extend(self.start.iter().map(|(variable, coordinate, unit)| {
            let first = match coordinate {
                Coordinate::Position => ports[0].measured_position[0],
                Coordinate::Velocity => ports[0].measured_velocity[0],
            };
            (*variable, first / unit)
        }));
        let inputs = self.inputs.iter().zip(&record.driven).enumerate();
        let inputs = inputs.map(|(at, ((variable, input, factor), values))| {
            let more = match offset {
                Some((place, more)) if place == at => more,
                _ => 0.0,
            };
            Driven {
                variable: *variable,
                values: values.iter().map(|value| (value + more) * factor).collect(),
                between: input.between,
            }
        });
        Pursued {
            own_step: self.own_step,
            settings,
            inputs: inputs.collect(),
            begin: record.motions[0].begin,
            interval: record.motions[0].interval,
            ports,
        }
    }
}

impl Place {
    /// What the FMU runs after there.
    fn pursued(&self, motion: &Motion, delay: f64, cut_off: f64) -> PursuedPort {
        let read = |series: &[f64], slope: &[f64]| -> Vec<f64> {
            let pairs = series.iter().zip(slope);
            pairs.map(|(value, slope)| value + delay * slope).collect()
        };
        let velocity = if self.has_velocity {
            motion.velocity.clone()
        } else {
            slopes(&motion.position, motion.interval)
        };
        PursuedPort {
            input: self.input,
            position: self.position,
            velocity: self.velocity,
            load: self.load,
            measured_position: read(&motion.position, &velocity),
            measured_velocity: read(&velocity, &slopes(&velocity, motion.interval)),
            is_absolute: self.is_absolute,
            cut_off: self.cut_off.unwrap_or(cut_off),
        }
    }
}

/// Slopes of a smooth series over even times, with an error of the fourth order inside it: a velocity that falls short of the
/// position's slope would hold the FMU back in every pass.
fn slopes(series: &[f64], interval: f64) -> Vec<f64> {
    let last = series.len().saturating_sub(1);
    let over = |at: usize, wide: usize| -> f64 {
        let (low, high) = (at.saturating_sub(wide), (at + wide).min(last));
        (series[high] - series[low]) / ((high - low).max(1) as f64 * interval)
    };
    (0..series.len())
        .map(|at| {
            if at < 2 || at + 2 > last {
                over(at, 1)
            } else {
                (4.0 * over(at, 1) - over(at, 2)) / 3.0
            }
        })
        .collect()
}

impl Finder<'_> {
    /// What a port names.
    fn place(&mut self, port: &Port) -> Result<Place, PlantError> {
        if port.position.is_none() && port.velocity.is_none() {
            return Err(PlantError::Unit {
                file: self.file.to_owned(),
                section: "port",
                name: port.input.clone(),
                what: "lacks position and velocity; name the output that is the input's coordinate"
                    .to_owned(),
            });
        }
        let takes_force = |v: &Variable| v.role == Role::Input || v.is_tunable;
        let input = self.variable(
            "port",
            &port.input,
            "input or tunable parameter",
            takes_force,
        )?;
        let is_read = |v: &Variable| matches!(v.role, Role::Output | Role::Local);
        let mut output = |name: &Option<String>, quantity| {
            name.as_ref()
                .map(|name| {
                    let at = self.variable("port", name, "output", is_read)?;
                    Ok::<_, PlantError>((at, self.factor("port", at, quantity)?))
                })
                .transpose()
        };
        Ok(Place {
            position: output(&port.position, Quantity::Position)?,
            velocity: output(&port.velocity, Quantity::Velocity)?,
            load: port.load.as_ref().map(|load| self.load(load)).transpose()?,
            input: (input, self.factor("port", input, Quantity::Force)?),
            cut_off: port.compare_low_pass,
            is_absolute: false,
            has_velocity: false,
        })
    }

    /// The variable of a load with its factor to N or N m.
    fn load(&mut self, load: &LoadVariable) -> Result<(usize, f64), PlantError> {
        let is_read = |v: &Variable| v.role != Role::Time;
        let at = self.variable("port", &load.variable, "variable", is_read)?;
        match load.factor {
            Some(factor) if factor.is_finite() && factor != 0.0 => Ok((at, factor)),
            Some(factor) => Err(self.wrong(
                "port",
                at,
                format!("factor = {factor} of load must be a finite number other than 0"),
            )),
            None => {
                let factor = self.factor("port", at, Quantity::ExternalLoad);
                let unit = Quantity::ExternalLoad.units(self.path)[0].0;
                let factor = factor.map_err(|error| match error {
                    PlantError::Unit { what, .. } => {
                        let or =
                            format!("{what}; or give factor = what one of its unit is in {unit}");
                        self.wrong("port", at, or)
                    }
                    other => other,
                })?;
                Ok((at, factor))
            }
        }
    }

    fn variable(
        &self,
        section: &'static str,
        name: &str,
        what: &'static str,
        fits: impl Fn(&Variable) -> bool,
    ) -> Result<usize, PlantError> {
        let fits = |v: &Variable| v.kind == ValueKind::Real && fits(v);
        let variables = &self.description.variables;
        let found = variables.iter().position(|v| v.name == name && fits(v));
        found.ok_or_else(|| {
            let names: Vec<&str> = variables
                .iter()
                .filter(|v| fits(v))
                .map(|v| v.name.as_str())
                .collect();
            PlantError::NoVariable {
                file: self.file.to_owned(),
                section,
                name: name.to_owned(),
                fmu: self.fmu.clone(),
                what,
                hint: match closest(name, names.iter().copied()) {
                    Some(near) => format!("; did you mean `{near}`?"),
                    None if names.is_empty() => "; it has none at all".to_owned(),
                    None => format!("; it has {}", names.join(", ")),
                },
            }
        })
    }

    fn wrong(&self, section: &'static str, at: usize, what: String) -> PlantError {
        PlantError::Unit {
            file: self.file.to_owned(),
            section,
            name: self.description.variables[at].name.clone(),
            what,
        }
    }

    /// What one of a variable's unit is in SI units.
    fn factor(
        &mut self,
        section: &'static str,
        at: usize,
        quantity: Quantity,
    ) -> Result<f64, PlantError> {
        let unit = &self.description.variables[at].unit;
        let units = quantity.units(self.path);
        if unit.is_empty() {
            let name = &self.description.variables[at].name;
            self.notes.push(format!(
                "{} states no unit of `{name}`; it is taken for {}",
                self.fmu, units[0].0
            ));
            return Ok(1.0);
        }
        let known = units.iter().find(|(own, _)| plain(own) == plain(unit));
        known.map(|(_, factor)| *factor).ok_or_else(|| {
            let known: Vec<&str> = units.iter().map(|(unit, _)| *unit).collect();
            self.wrong(
                section,
                at,
                format!(
                    "the FMU gives it in \"{unit}\", which is no unit of {} along such a path; known are {}",
                    quantity.word(),
                    known.join(", ")
                ),
            )
        })
    }

    /// Factor from a column to the input that it drives.
    fn column_factor(&self, at: usize, input: &Input) -> Result<f64, PlantError> {
        let unit = &self.description.variables[at].unit;
        match input.factor {
            Some(factor) if factor.is_finite() && factor != 0.0 => Ok(factor),
            Some(factor) => Err(self.wrong(
                "inputs",
                at,
                format!("factor = {factor} must be a finite number other than 0"),
            )),
            None if plain(unit) == plain(&input.unit) => Ok(1.0),
            None => Err(self.wrong(
                "inputs",
                at,
                format!(
                    "the column is in \"{}\" and the FMU's input in \"{unit}\"; give factor = what one of the column's is in the \
                     input's unit",
                    input.unit
                ),
            )),
        }
    }

    fn parameter(&self, parameter: &Parameter) -> Result<(usize, f64), PlantError> {
        let is_parameter = |v: &Variable| v.role == Role::Parameter;
        let at = self.variable(PARAMETERS, parameter.key, "parameter", is_parameter)?;
        let Dimension::Own { unit, size } = parameter.dimension else {
            return Ok((at, 1.0));
        };
        let own = &self.description.variables[at].unit;
        if plain(own) != plain(unit) && !(own.is_empty() && unit == "1") {
            let shown = if own.is_empty() { "1" } else { own };
            return Err(self.wrong(
                PARAMETERS,
                at,
                format!("unit = \"{unit}\" is not the FMU's, \"{shown}\"; give value and unit as the FMU has them"),
            ));
        }
        Ok((at, size))
    }

    /// Refuses inputs that nothing drives: what they should be nobody but the user knows.
    fn check_inputs(&self, ports: &Ports) -> Result<(), PlantError> {
        let is_open = |v: &&Variable| {
            v.role == Role::Input
                && v.kind == ValueKind::Real
                && ports.ports.iter().all(|port| v.name != port.input)
                && !ports.inputs.contains_key(&v.name)
                && v.start.is_none()
        };
        match self.description.variables.iter().position(|v| is_open(&v)) {
            Some(at) => Err(self.wrong(
                "inputs",
                at,
                "no column drives this input, and the FMU gives it no start value; add the line"
                    .to_owned(),
            )),
            None => Ok(()),
        }
    }
}
