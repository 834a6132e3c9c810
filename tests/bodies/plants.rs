//! Small plants, and runs of them.

use stickslip::cosim::{self, CoSimulationModel, StateWriter};

/// A mass on a spring, 2 kg and 50 N/m, with 3 N of dry friction.
pub const SPRING: &str = r#"
[plant]
kind = "drive"
path = "line"
[drive]
inertia = 2.0
viscous = 0.0
offset = 0.0
[elastic_force]
linear = 50.0
square = 0.0
[coulomb_friction]
force = 3.0
"#;

/// A mass alone with 3 N of dry friction.
pub const SLED: &str = r#"
[plant]
kind = "drive"
path = "line"
[drive]
inertia = 2.0
viscous = 0.0
offset = 0.0
[coulomb_friction]
force = 3.0
"#;

pub const PENDULUM: &str = r#"
[plant]
kind = "pendulum"
path = "turn"
[pendulum]
stiffness = 40.0
rest = 0.0
viscous = 0.0
[coulomb_friction]
force = 1.5
"#;

/// A joint whose friction grows with the motor's torque and the weight.
pub const JOINT: &str = r#"
[plant]
kind = "joint"
path = "turn"
[joint]
stiffness = 72.0
rest = 0.0
viscous = 1.0
gain = 15.0
back_emf = 10.0
[coulomb_friction]
force = 4.0
[stribeck]
excess = 2.0
speed = 0.4
[motor_load_friction]
coefficient = 0.15
[external_load_friction_square]
coefficient = 0.002
"#;

pub struct Run(pub Box<dyn CoSimulationModel>);

impl Run {
    /// A run that is at the end of its initialisation, at this tolerance and with these start values.
    pub fn at(text: &str, tolerance: Option<f64>, values: &[(&str, f64)]) -> Self {
        let mut run = Self(cosim::open(text, "test").unwrap());
        run.0.set_up(0.0, tolerance);
        for (name, value) in values {
            run.set(name, *value);
        }
        run.0.initialise().unwrap();
        run
    }

    pub fn new(text: &str, values: &[(&str, f64)]) -> Self {
        Self::at(text, None, values)
    }

    pub fn reference(&self, name: &str) -> u32 {
        self.0.table().find(name).unwrap().value_reference
    }

    pub fn set(&mut self, name: &str, value: f64) {
        let reference = self.reference(name);
        self.0.set_real(reference, value).unwrap();
    }

    pub fn get(&mut self, name: &str) -> f64 {
        let reference = self.reference(name);
        self.0.real(reference).unwrap()
    }

    pub fn stuck(&mut self) -> bool {
        let reference = self.reference("stuck");
        self.0.boolean(reference).unwrap()
    }

    pub fn step(&mut self, until: f64) {
        self.0.step(until, false).unwrap();
    }

    pub fn state(&mut self) -> [f64; 4] {
        ["position", "velocity", "friction", "acceleration"].map(|name| self.get(name))
    }

    pub fn saved(&self) -> Vec<u8> {
        let mut state = StateWriter::default();
        self.0.save(&mut state);
        state.into_bytes()
    }
}
