//! What an instance must do by the standards and by the native model: the judge of every call.

use std::sync::Arc;

use stickslip::cosim::{
    Causality, CoSimulationModel, Initial, StateReader, StateWriter, Variability, Variable,
    VariableTable, VariableType,
};
use stickslip::ffi::Status;

use crate::call::{Array, Arrays, Kind, SetUp};
use crate::standard::{Function, State, Version, is_legal};

/// Bits of the values that a call returns, or the status with which it is refused.
pub type Verdict = Result<Vec<u64>, Status>;

const ERROR: Verdict = Err(Status::Error);
const DISCARD: Verdict = Err(Status::Discard);
const DONE: Verdict = Ok(Vec::new());

/// What the instance should be.
pub struct Expectation {
    /// Version through which it was made.
    pub version: Version,
    /// Which component it is of.
    pub component: usize,
    /// Its state by the standard.
    pub state: State,
    /// The native model that is driven alongside.
    pub native: Box<dyn CoSimulationModel>,
    /// Communication point [s].
    pub time: f64,
    /// Time [s] beyond which no step may go.
    pub stop: Option<f64>,
    /// Status of the last step, FMI 2.
    pub last_step: Status,
    /// FMI 3: event mode used.
    pub event_mode: bool,
    /// FMI 3: early return allowed.
    pub early_return: bool,
    /// Whether the importer gave a logger.
    pub logger: bool,
    /// Whether debug logging is on.
    pub logging: bool,
    /// Categories asked for; `None` for all.
    pub categories: Option<Vec<&'static str>>,
}

/// What a saved state holds.
#[derive(Clone)]
pub struct Saved {
    /// Component to which it belongs.
    pub component: usize,
    /// Version through which it was saved.
    pub version: Version,
    /// State of the instance then.
    pub state: State,
    /// Communication point then [s].
    pub time: f64,
    /// Stop time then [s].
    pub stop: Option<f64>,
    /// Status of the last step then.
    pub last_step: Status,
    /// The native model's bytes.
    pub native: Vec<u8>,
}

/// Largest distance [s] of a communication point from where the last step ended.
fn tolerance(time: f64) -> f64 {
    (64.0 * f64::EPSILON * time.abs()).max(1e-9)
}

impl Expectation {
    /// Whether a message of `category` must arrive.
    pub fn hears(&self, category: &str) -> bool {
        let always = self.version == Version::Two && category != "logEvents";
        self.logger
            && (always
                || self.logging
                    && (self.categories.as_ref()).is_none_or(|chosen| chosen.contains(&category)))
    }

    /// Its variables.
    pub fn table(&self) -> Arc<VariableTable> {
        Arc::clone(self.native.table())
    }

    fn legal(&self, function: Function) -> Result<(), Status> {
        if is_legal(self.version, function, self.state) {
            Ok(())
        } else {
            Err(Status::Error)
        }
    }

    /// A call without arguments that only moves on.
    pub fn enter(&mut self, function: Function, state: State) -> Verdict {
        self.legal(function)?;
        self.state = state;
        DONE
    }

    /// A call that is refused, or does nothing.
    pub fn nothing(&mut self, function: Function, null: bool) -> Verdict {
        self.legal(function)?;
        if null { ERROR } else { DONE }
    }

    /// `fmi2SetupExperiment`; part of `fmi3EnterInitializationMode`.
    pub fn set_up(&mut self, function: Function, set_up: &SetUp) -> Verdict {
        self.legal(function)?;
        let sound = set_up.start.is_finite()
            && set_up
                .stop
                .is_none_or(|stop| stop.is_finite() && stop > set_up.start)
            && set_up
                .tolerance
                .is_none_or(|tolerance| tolerance > 0.0 && tolerance < 1.0);
        if !sound {
            return ERROR;
        }
        self.native.set_up(set_up.start, set_up.tolerance);
        (self.time, self.stop) = (set_up.start, set_up.stop);
        DONE
    }

    /// `ExitInitializationMode`.
    pub fn initialise(&mut self) -> Verdict {
        self.legal(Function::ExitInitialization)?;
        if self.native.initialise().is_err() {
            return ERROR;
        }
        self.state = if self.event_mode {
            State::Event
        } else {
            State::Step
        };
        DONE
    }

    /// `fmi3EnterEventMode`.
    pub fn enter_event(&mut self) -> Verdict {
        self.legal(Function::EnterEvent)?;
        if !self.event_mode {
            return ERROR;
        }
        self.state = State::Event;
        DONE
    }

    /// `Reset`: as after instantiation, except for what the importer chose to hear.
    pub fn reset(&mut self) -> Verdict {
        self.native.reset();
        self.state = State::Instantiated;
        self.time = self.native.identity().default_experiment.start_time;
        self.stop = None;
        self.last_step = Status::Ok;
        DONE
    }

    /// `SetDebugLogging`.
    pub fn debug(&mut self, on: bool, categories: &[&'static str], with_null: bool) -> Verdict {
        if with_null {
            return ERROR;
        }
        let known = |name: &&str| {
            matches!(
                *name,
                "logEvents" | "logStatusWarning" | "logStatusDiscard" | "logStatusError"
            )
        };
        let all = categories.is_empty() || categories.contains(&"logAll");
        let sound = categories
            .iter()
            .all(|name| known(name) || *name == "logAll");
        // Of names that there are not an importer hears, whatever else it chose.
        let told = (!sound).then_some("logStatusWarning");
        self.logging = on;
        self.categories = (!all).then(|| {
            let chosen = categories.iter().copied().filter(known);
            chosen.chain(told).collect()
        });
        if sound { DONE } else { Err(Status::Warning) }
    }

    /// The row behind a value reference, of the asked type.
    fn row(
        table: &VariableTable,
        reference: u32,
        asked: VariableType,
    ) -> Result<&Variable, Status> {
        let row = table
            .variables()
            .iter()
            .find(|row| row.value_reference == reference);
        row.filter(|row| row.variable_type == asked)
            .ok_or(Status::Error)
    }

    fn sound(&self, array: &Array, kind: Kind) -> Result<(), Status> {
        let sound = match array.wrong {
            Arrays::Sound => true,
            Arrays::HugeCount => false,
            // Only setters and getters of these types look at a number of values.
            Arrays::OtherCount => {
                self.version == Version::Two || !matches!(kind, Kind::Real | Kind::Boolean)
            }
            _ => array.references.is_empty(),
        };
        sound.then_some(()).ok_or(Status::Error)
    }

    /// Getters.
    pub fn get(&mut self, kind: Kind, array: &Array) -> Verdict {
        self.legal(Function::Get)?;
        self.sound(array, kind)?;
        let table = self.table();
        let mut values = Vec::new();
        for reference in &array.references {
            values.push(match kind {
                Kind::Real => {
                    Self::row(&table, *reference, VariableType::Real)?;
                    let value = self.native.real(*reference).map_err(|_| Status::Discard)?;
                    finite(value)?
                }
                Kind::Boolean => {
                    Self::row(&table, *reference, VariableType::Boolean)?;
                    let value = self
                        .native
                        .boolean(*reference)
                        .map_err(|_| Status::Discard)?;
                    u64::from(value)
                }
                Kind::Integer | Kind::Text => return ERROR,
            });
        }
        Ok(values)
    }

    fn settable(&self, row: &Variable) -> bool {
        match self.state {
            State::Instantiated | State::Initialization => settable_before(row),
            State::Step if self.event_mode => row.causality == Causality::Input,
            State::Step | State::Event => settable_between(row),
            // Configuration mode is for structural parameters, of which there are none.
            _ => false,
        }
    }

    /// Setters. All values are set, or none.
    pub fn set(&mut self, kind: Kind, array: &Array, values: &[f64]) -> Verdict {
        self.legal(Function::Set)?;
        let references = &array.references;
        if kind != Kind::Real {
            let refused = !references.is_empty() || array.wrong == Arrays::HugeCount;
            return if refused { ERROR } else { DONE };
        }
        self.sound(array, kind)?;
        let table = self.table();
        for (reference, value) in references.iter().zip(values) {
            let row = Self::row(&table, *reference, VariableType::Real)?;
            if !self.settable(row) {
                return ERROR;
            }
            let above = row
                .minimum
                .is_none_or(|least| *value > least || *value == least && !row.above_minimum);
            let below = row.maximum.is_none_or(|most| *value <= most);
            if !(value.is_finite() && above && below) {
                return DISCARD;
            }
        }
        for (reference, value) in references.iter().zip(values) {
            if self.native.set_real(*reference, *value).is_err() {
                return DISCARD;
            }
        }
        DONE
    }

    /// `fmi2SetRealInputDerivatives`.
    pub fn input_derivatives(&mut self, array: &Array, orders: &[i32], values: &[f64]) -> Verdict {
        self.legal(Function::InputDerivatives)?;
        self.sound(array, Kind::Real)?;
        let references = &array.references;
        let table = self.table();
        for (reference, order) in references.iter().zip(orders) {
            let row = Self::row(&table, *reference, VariableType::Real)?;
            if row.causality != Causality::Input || !(1..=3).contains(order) {
                return ERROR;
            }
        }
        if values.iter().any(|value| !value.is_finite()) {
            return DISCARD;
        }
        for ((reference, order), value) in references.iter().zip(orders).zip(values) {
            let order = order.unsigned_abs();
            if self
                .native
                .set_input_derivative(*reference, order, *value)
                .is_err()
            {
                return DISCARD;
            }
        }
        DONE
    }

    /// `GetRealOutputDerivatives`, `fmi3GetOutputDerivatives`.
    pub fn output_derivatives(&mut self, array: &Array, orders: &[i32]) -> Verdict {
        self.legal(Function::OutputDerivatives)?;
        self.sound(array, Kind::Real)?;
        let table = self.table();
        let mut values = Vec::new();
        for (reference, order) in array.references.iter().zip(orders) {
            let row = Self::row(&table, *reference, VariableType::Real)?;
            if row.causality != Causality::Output || !(1..=2).contains(order) {
                return ERROR;
            }
            let value = self
                .native
                .output_derivative(*reference, order.unsigned_abs());
            values.push(finite(value.map_err(|_| Status::Discard)?)?);
        }
        Ok(values)
    }

    /// `GetDirectionalDerivative`.
    pub fn directional(&mut self, unknowns: &Array, knowns: &[u32], seed: &[f64]) -> Verdict {
        self.legal(Function::Directional)?;
        self.sound(unknowns, Kind::Real)?;
        let unknowns = &unknowns.references;
        let table = self.table();
        for known in knowns {
            let row = Self::row(&table, *known, VariableType::Real)?;
            let may_change = match self.state {
                State::Initialization => settable_before(row),
                _ => settable_between(row),
            };
            if !may_change || row.causality == Causality::Output {
                return ERROR;
            }
        }
        for unknown in unknowns {
            let row = Self::row(&table, *unknown, VariableType::Real)?;
            if !matches!(row.causality, Causality::Output | Causality::Local) {
                return ERROR;
            }
        }
        let mut values = Vec::new();
        for unknown in unknowns {
            let mut sum = 0.0;
            for (known, seed) in knowns.iter().zip(seed) {
                let partial = self.native.partial_derivative(*unknown, *known);
                sum += seed * partial.map_err(|_| Status::Discard)?;
            }
            values.push(finite(sum)?);
        }
        Ok(values)
    }

    /// `DoStep`; returns the events that the log must hear of, and in FMI 3 event, early return and time reached.
    pub fn step(&mut self, point: f64, size: f64, null: bool) -> (Verdict, usize) {
        if let Err(status) = self.legal(Function::Step) {
            return (Err(status), 0);
        }
        if null && self.version == Version::Three {
            return (ERROR, 0);
        }
        self.last_step = Status::Discard;
        let until = point + size;
        let near = (point - self.time).abs() <= tolerance(self.time);
        if !(size > 0.0 && until.is_finite() && near) {
            return (DISCARD, 0);
        }
        self.last_step = Status::Error;
        if self.stop.is_some_and(|stop| until > stop + tolerance(stop)) {
            return (ERROR, 0);
        }
        let Ok(end) = self.native.step(until.max(self.time), self.early_return) else {
            self.time = self.native.time();
            return (ERROR, 0);
        };
        self.last_step = Status::Ok;
        self.time = end.time;
        let mut events = 0;
        if end.switched {
            self.native.drain_notices(&mut |_| events += 1);
        }
        let values = match self.version {
            Version::Two => Vec::new(),
            Version::Three => vec![
                u64::from(end.switched && self.event_mode),
                0,
                u64::from(end.time < until),
                self.time.to_bits(),
            ],
        };
        (Ok(values), events)
    }

    /// `fmi2GetStatus`, or with a kind of value `fmi2Get…Status`.
    pub fn get_status(&mut self, kind: Option<Kind>, asked: i32, null: bool) -> Verdict {
        self.legal(Function::GetStatus)?;
        match (kind, asked) {
            // The component has no status of these types; where the answer would go does not matter.
            (Some(Kind::Integer | Kind::Text), _) => DISCARD,
            _ if null => ERROR,
            (None, 0) => Ok(vec![self.last_step as u64]),
            (Some(Kind::Real), 2) => Ok(vec![self.time.to_bits()]),
            (Some(Kind::Boolean), 3) => Ok(vec![0]),
            _ => DISCARD,
        }
    }

    /// The state as the native model and the standard describe it.
    pub fn save(&self) -> Saved {
        let mut native = StateWriter::default();
        self.native.save(&mut native);
        Saved {
            component: self.component,
            version: self.version,
            state: self.state,
            time: self.time,
            stop: self.stop,
            last_step: self.last_step,
            native: native.into_bytes(),
        }
    }

    /// `SetFMUState`.
    pub fn restore(&mut self, saved: Option<&Saved>) -> Verdict {
        let Some(saved) = saved else { return ERROR };
        let fits = saved.component == self.component
            && saved.version == self.version
            && (saved.state != State::Event || self.event_mode);
        if !fits {
            return ERROR;
        }
        let mut reader = StateReader::new(&saved.native);
        if self.native.restore(&mut reader).is_err() {
            return ERROR;
        }
        self.state = saved.state;
        (self.time, self.stop, self.last_step) = (saved.time, saved.stop, saved.last_step);
        DONE
    }
}

fn settable_before(row: &Variable) -> bool {
    row.causality == Causality::Input || row.initial == Some(Initial::Exact)
}

fn settable_between(row: &Variable) -> bool {
    row.causality == Causality::Input || row.variability == Variability::Tunable
}

/// The bits of a value that may be handed out: what overflowed may not.
fn finite(value: f64) -> Result<u64, Status> {
    value
        .is_finite()
        .then_some(value.to_bits())
        .ok_or(Status::Discard)
}
