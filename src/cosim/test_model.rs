//! A model with a closed solution, for tests of the layers above: x' = −k x + u, seen as `x` and, with
//! feed-through, as `y = x + gain u`; `above` switches where x rises through 0.5.

use super::{
    Causality, CoSimulationModel, DefaultExperiment, Identity, Initial, ModelError, StateError,
    StateReader, StateWriter, StepEnd, Token, Variability, Variable, VariableTable, VariableType,
};
use std::sync::Arc;

pub(crate) const MODEL_TOML: &str = "test_model = \"relaxation\"\n";
pub(crate) const TIME: u32 = 0;
pub(crate) const U: u32 = 1;
pub(crate) const X: u32 = 2;
pub(crate) const Y: u32 = 3;
pub(crate) const ABOVE: u32 = 4;
pub(crate) const RATE: u32 = 5;
pub(crate) const GAIN: u32 = 6;
/// A step with this gain panics.
pub(crate) const PANIC_GAIN: f64 = 666.0;
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

pub(crate) struct TestModel {
    table: Arc<VariableTable>,
    time: f64,
    x: f64,
    input: f64,
    input_slope: f64,
    rate: f64,
    gain: f64,
    notices: Vec<String>,
}

impl TestModel {
    pub(crate) fn new() -> Self {
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
        self.time = start_time;
    }
    fn initialise(&mut self) -> Result<(), ModelError> {
        Ok(())
    }
    fn real(&mut self, value_reference: u32) -> Result<f64, ModelError> {
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
        Ok(self.x > THRESHOLD)
    }
    fn set_real(&mut self, value_reference: u32, value: f64) -> Result<(), ModelError> {
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
        if order == 1 {
            self.input_slope = value;
        }
        Ok(())
    }
    fn output_derivative(&mut self, value_reference: u32, order: u32) -> Result<f64, ModelError> {
        let slope = self.input - self.rate * self.x;
        Ok(match (value_reference, order) {
            (X, 1) => slope,
            (X, 2) => self.input_slope - self.rate * slope,
            (Y, 1) => slope + self.gain * self.input_slope,
            _ => 0.0,
        })
    }
    fn partial_derivative(&mut self, unknown: u32, known: u32) -> Result<f64, ModelError> {
        Ok(match (unknown, known) {
            (Y, U) => self.gain,
            (Y, GAIN) => self.input,
            _ => 0.0,
        })
    }
    fn step(&mut self, until: f64, stop_at_switch: bool) -> Result<StepEnd, ModelError> {
        assert!(self.gain != PANIC_GAIN, "the test asked for a panic");
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
            self.notices
                .push(format!("x passed {THRESHOLD} before t = {until} s"));
        }
        self.x = self.later(until - self.time);
        self.input += self.input_slope * (until - self.time);
        self.time = until;
        Ok(StepEnd {
            time: until,
            switched,
        })
    }
    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn std::fmt::Display)) {
        self.notices.drain(..).for_each(|notice| tell(&notice));
    }
    fn save(&self, state: &mut StateWriter) {
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
        *self = Self::new();
    }
}
