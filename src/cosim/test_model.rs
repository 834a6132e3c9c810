//! A model with a closed solution, for tests of the layers above: x' = −k x + u, seen as `x` and, with
//! feed-through, as `y = x + gain u`; `above` switches where x rises through 0.5.

use super::{
    Causality, CoSimulationModel, DefaultExperiment, Identity, Initial, ModelError, Notice,
    StateError, StateReader, StateWriter, StepEnd, Token, Variability, Variable, VariableTable,
    VariableType,
};
use std::fmt;
use std::sync::Arc;

pub(crate) const MODEL_TOML: &str = "test_model = \"relaxation\"\n";
pub(crate) const TIME: u32 = 0;
pub(crate) const U: u32 = 1;
pub(crate) const X: u32 = 2;
pub(crate) const Y: u32 = 3;
pub(crate) const ABOVE: u32 = 4;
pub(crate) const RATE: u32 = 5;
pub(crate) const GAIN: u32 = 6;
/// With this gain every call on the model panics that is not a reset or the restoring of a state.
pub(crate) const PANIC_GAIN: f64 = 666.0;
/// With this gain a reset, the restoring of a state and the end of the model panic.
pub(crate) const LAST_PANIC_GAIN: f64 = 667.0;
/// What these panics say.
pub(crate) const PANIC: &str = "the test asked for a panic";
/// A resource whose model panics while it is made.
pub(crate) const PANIC_TOML: &str = "test_model = \"panic\"\n";
const THRESHOLD: f64 = 0.5;

static IDENTITY: Identity = Identity {
    model_identifier: "Relaxation",
    description: "Test model",
    default_experiment: DefaultExperiment {
        start_time: 0.0,
        stop_time: 1.0,
        tolerance: 1e-9,
        step_size: 0.1,
    },
};

/// That `x` rose through the threshold.
struct Passed {
    /// End of the step in which it did [s].
    until: f64,
}

impl Notice for Passed {
    fn time(&self) -> f64 {
        self.until
    }

    fn what(&self) -> String {
        format!("x passed {THRESHOLD} before t = {} s", self.until)
    }
}

impl fmt::Display for Passed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.what())
    }
}

fn row(name: &str, causality: Causality, variability: Variability) -> Variable {
    Variable {
        value_reference: 0,
        name: name.into(),
        variable_type: VariableType::Real,
        causality,
        variability,
        initial: None,
        unit: Some("1".into()),
        display_unit: None,
        start: None,
        minimum: None,
        above_minimum: false,
        maximum: None,
        nominal: None,
        description: name.into(),
        alias_of: None,
        derivative_of: None,
        reinit: false,
        event_indicator: false,
        dependencies: Vec::new(),
        initial_dependencies: Vec::new(),
    }
}

pub(crate) fn table() -> VariableTable {
    let calculated = Some(Initial::Calculated);
    let exact = Some(Initial::Exact);
    VariableTable::new(vec![
        row("time", Causality::Independent, Variability::Continuous),
        Variable {
            start: Some(0.0),
            ..row("u", Causality::Input, Variability::Continuous)
        },
        Variable {
            initial: exact,
            start: Some(0.0),
            ..row("x", Causality::Output, Variability::Continuous)
        },
        Variable {
            initial: calculated,
            dependencies: vec![U],
            initial_dependencies: vec![U, X],
            ..row("y", Causality::Output, Variability::Continuous)
        },
        Variable {
            initial: calculated,
            variable_type: VariableType::Boolean,
            unit: None,
            ..row("above", Causality::Local, Variability::Discrete)
        },
        Variable {
            initial: exact,
            start: Some(1.0),
            minimum: Some(0.0),
            above_minimum: true,
            ..row("rate", Causality::Parameter, Variability::Fixed)
        },
        Variable {
            initial: exact,
            start: Some(2.0),
            maximum: Some(1000.0),
            ..row("gain", Causality::Parameter, Variability::Tunable)
        },
    ])
    .unwrap()
}

/// As the library's own, for `text` that asks for one of these models.
pub(crate) fn open(text: &str, file_name: &str) -> Result<Box<dyn CoSimulationModel>, ModelError> {
    assert!(text != PANIC_TOML, "{PANIC}");
    if text == MODEL_TOML {
        Ok(Box::new(TestModel::new()))
    } else {
        super::open(text, file_name)
    }
}

pub(crate) struct TestModel {
    table: Arc<VariableTable>,
    time: f64,
    x: f64,
    input: f64,
    input_slope: f64,
    rate: f64,
    gain: f64,
    notices: Vec<Passed>,
}

impl TestModel {
    fn new() -> Self {
        Self {
            table: Arc::new(table()),
            time: 0.0,
            x: 0.0,
            input: 0.0,
            input_slope: 0.0,
            rate: 1.0,
            gain: 2.0,
            notices: Vec::new(),
        }
    }

    fn may_panic(&self) {
        assert!(self.gain != PANIC_GAIN, "{PANIC}");
    }

    fn may_panic_at_last(&self) {
        assert!(self.gain != LAST_PANIC_GAIN, "{PANIC}");
    }

    /// x a time `h` later.
    fn later(&self, h: f64) -> f64 {
        let forced =
            |t: f64| (self.input + self.input_slope * t - self.input_slope / self.rate) / self.rate;
        forced(h) + (self.x - forced(0.0)) * libm::exp(-self.rate * h)
    }
}

impl CoSimulationModel for TestModel {
    fn identity(&self) -> &'static Identity {
        &IDENTITY
    }
    fn table(&self) -> &Arc<VariableTable> {
        &self.table
    }
    fn token(&self) -> Token {
        Token::new(&self.table, MODEL_TOML)
    }
    fn time(&self) -> f64 {
        self.time
    }
    fn set_up(&mut self, start_time: f64, _tolerance: Option<f64>) {
        self.may_panic();
        self.time = start_time;
    }
    fn initialise(&mut self) -> Result<(), ModelError> {
        self.may_panic();
        Ok(())
    }
    fn real(&mut self, value_reference: u32) -> Result<f64, ModelError> {
        self.may_panic();
        Ok(match value_reference {
            TIME => self.time,
            U => self.input,
            X => self.x,
            Y => self.x + self.gain * self.input,
            RATE => self.rate,
            GAIN => self.gain,
            other => panic!("no real {other}"),
        })
    }
    fn boolean(&mut self, _value_reference: u32) -> Result<bool, ModelError> {
        self.may_panic();
        Ok(self.x > THRESHOLD)
    }
    fn set_real(&mut self, value_reference: u32, value: f64) -> Result<(), ModelError> {
        self.may_panic();
        match value_reference {
            U => (self.input, self.input_slope) = (value, 0.0),
            X => self.x = value,
            RATE => self.rate = value,
            GAIN => self.gain = value,
            other => panic!("{other} cannot be set"),
        }
        Ok(())
    }
    fn set_input_derivative(
        &mut self,
        _value_reference: u32,
        order: u32,
        value: f64,
    ) -> Result<(), ModelError> {
        self.may_panic();
        if order == 1 {
            self.input_slope = value;
        }
        Ok(())
    }
    fn output_derivative(&mut self, value_reference: u32, order: u32) -> Result<f64, ModelError> {
        self.may_panic();
        let slope = self.input - self.rate * self.x;
        Ok(match (value_reference, order) {
            (X, 1) => slope,
            (X, 2) => self.input_slope - self.rate * slope,
            (Y, 1) => slope + self.gain * self.input_slope,
            _ => 0.0,
        })
    }
    fn partial_derivative(&mut self, unknown: u32, known: u32) -> Result<f64, ModelError> {
        self.may_panic();
        Ok(match (unknown, known) {
            (Y, U) => self.gain,
            (Y, GAIN) => self.input,
            _ => 0.0,
        })
    }
    fn step(&mut self, until: f64, stop_at_switch: bool) -> Result<StepEnd, ModelError> {
        self.may_panic();
        let mut until = until;
        let switched = (self.x > THRESHOLD) != (self.later(until - self.time) > THRESHOLD);
        if switched && stop_at_switch {
            let (mut low, mut high) = (self.time, until);
            while high - low > 1e-12 {
                let middle = 0.5 * (low + high);
                let crossed = (self.later(middle - self.time) > THRESHOLD) != (self.x > THRESHOLD);
                if crossed { high = middle } else { low = middle }
            }
            until = high;
        }
        if switched {
            self.notices.push(Passed { until });
        }
        self.x = self.later(until - self.time);
        self.input += self.input_slope * (until - self.time);
        self.time = until;
        Ok(StepEnd {
            time: until,
            switched,
        })
    }
    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn Notice)) {
        self.notices.drain(..).for_each(|notice| tell(&notice));
    }
    fn save(&self, state: &mut StateWriter) {
        self.may_panic();
        for value in [
            self.time,
            self.x,
            self.input,
            self.input_slope,
            self.rate,
            self.gain,
        ] {
            state.real(value);
        }
    }
    fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), StateError> {
        self.may_panic_at_last();
        let mut values = [0.0; 6];
        for value in &mut values {
            *value = state.real()?;
        }
        [
            self.time,
            self.x,
            self.input,
            self.input_slope,
            self.rate,
            self.gain,
        ] = values;
        Ok(())
    }
    fn reset(&mut self) {
        self.may_panic_at_last();
        (self.time, self.x, self.input, self.input_slope) = (0.0, 0.0, 0.0, 0.0);
        (self.rate, self.gain) = (1.0, 2.0);
        self.notices.clear();
    }
}

impl Drop for TestModel {
    fn drop(&mut self) {
        self.may_panic_at_last();
    }
}
