//! A solver of its own for model exchange: Dormand and Prince (1980), order 5(4), with events found by halving the step.

use stickslip::cosim::{CoSimulationModel, ModelExchange};

const A: [[f64; 6]; 6] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [
        19372.0 / 6561.0,
        -25360.0 / 2187.0,
        64448.0 / 6561.0,
        -212.0 / 729.0,
        0.0,
        0.0,
    ],
    [
        9017.0 / 3168.0,
        -355.0 / 33.0,
        46732.0 / 5247.0,
        49.0 / 176.0,
        -5103.0 / 18656.0,
        0.0,
    ],
    [
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
    ],
];
const C: [f64; 6] = [1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// Value reference of an input and its value over time.
pub type Input = (u32, Box<dyn Fn(f64) -> f64>);

/// A model in continuous time.
pub struct Solver<'a> {
    pub model: &'a mut dyn CoSimulationModel,
    /// Value references and values over time of the inputs.
    pub inputs: Vec<Input>,
    pub tolerance: f64,
    pub time: f64,
    pub states: Vec<f64>,
    pub events: Vec<f64>,
    step: f64,
}

impl<'a> Solver<'a> {
    /// The solver of an initialised model, before its first event iteration.
    pub fn new(model: &'a mut dyn CoSimulationModel, inputs: Vec<Input>, tolerance: f64) -> Self {
        let mut solver = Self {
            time: model.time(),
            model,
            inputs,
            tolerance,
            states: Vec::new(),
            events: Vec::new(),
            step: 1e-5,
        };
        solver.update();
        solver
    }

    fn exchange(&mut self) -> &mut dyn ModelExchange {
        self.model.exchange().unwrap()
    }

    fn set_inputs(&mut self, time: f64) {
        for (reference, value) in &self.inputs {
            self.model.set_real(*reference, value(time)).unwrap();
        }
    }

    /// Event mode and back.
    fn update(&mut self) {
        self.exchange().enter_event_mode();
        self.exchange().update_discrete_states().unwrap();
        self.exchange().enter_continuous_time_mode();
        self.states = self.exchange().states().unwrap().to_vec();
    }

    fn put(&mut self, time: f64, states: &[f64]) {
        self.set_inputs(time);
        self.exchange().set_time(time);
        self.exchange().set_states(states);
    }

    fn rates(&mut self, time: f64, states: &[f64]) -> Vec<f64> {
        self.put(time, states);
        self.exchange().derivatives().unwrap().to_vec()
    }

    fn indicators(&mut self, time: f64, states: &[f64]) -> Vec<f64> {
        self.put(time, states);
        self.exchange().indicators().unwrap().to_vec()
    }

    /// The states a step of `h` later, and the error in units of the tolerance.
    fn stride(&mut self, h: f64) -> (Vec<f64>, f64) {
        let start = self.states.clone();
        let mut slopes = vec![self.rates(self.time, &start)];
        let mut next = start.clone();
        for (weights, c) in A.iter().zip(C) {
            for (place, value) in next.iter_mut().enumerate() {
                let sum: f64 = weights.iter().zip(&slopes).map(|(a, k)| a * k[place]).sum();
                *value = start[place] + h * sum;
            }
            let slope = self.rates(self.time + c * h, &next);
            slopes.push(slope);
        }
        let error = (0..start.len()).map(|place| {
            let sum: f64 = ERROR.iter().zip(&slopes).map(|(e, k)| e * k[place]).sum();
            (h * sum).abs() / (self.tolerance * (1.0 + start[place].abs()))
        });
        (next, error.fold(0.0, f64::max))
    }

    /// Goes on to `until` [s].
    pub fn advance_to(&mut self, until: f64) {
        while self.time < until {
            let h = self.step.min(until - self.time);
            let (start, states) = (self.time, self.states.clone());
            let before = self.indicators(start, &states);
            let (mut next, error) = self.stride(h);
            if error > 1.0 {
                self.step = 0.9 * h * error.powf(-0.2).max(0.1);
                continue;
            }
            let lost = |after: &[f64]| {
                before
                    .iter()
                    .zip(after)
                    .any(|(a, b)| (*a > 0.0) != (*b > 0.0))
            };
            let mut length = h;
            let after = self.indicators(start + h, &next);
            let event = lost(&after);
            if event {
                let (mut low, mut high) = (0.0, h);
                while high - low > 1e-13 * (1.0 + start) {
                    let middle = 0.5 * (low + high);
                    let (trial, _) = self.stride(middle);
                    let after = self.indicators(start + middle, &trial);
                    if lost(&after) {
                        (high, next) = (middle, trial);
                    } else {
                        low = middle;
                    }
                }
                length = high;
            }
            self.time = start + length;
            self.states = next;
            let states = self.states.clone();
            self.put(self.time, &states);
            let asked = self.exchange().complete_step().unwrap();
            if event || asked {
                self.events.push(self.time);
                assert!(
                    self.events.len() < 100_000,
                    "events without end at t = {} s",
                    self.time
                );
                self.update();
                self.step = 1e-5;
            } else {
                self.step = h * (0.9 * (error + 1e-12).powf(-0.2)).clamp(0.2, 5.0);
            }
        }
    }
}
