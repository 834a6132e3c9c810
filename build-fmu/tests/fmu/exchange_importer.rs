//! The built FMUs for model exchange in a Rust importer (fmi-rs), under Heun's method, against the native model.

use std::sync::Arc;

use build_fmu::platform::FmiVersion;
use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::fmi2::types::fmi2Status;
use fmi_rs::fmi2::{FMU2, ME};
use fmi_rs::fmi3::FMU3;
use fmi_rs::fmi3::builder::FMU3Builder;
use fmi_rs::fmi3::types::fmi3Status;
use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{self, Rig, RigInputs};

use crate::component::{build, shipped_model};

/// Step \[s\] that follows the motor's 2 ms well.
const STEP: f64 = 1e-4;
const STEPS: u32 = 30_000;
const INPUTS: [(&str, f64); 2] = [("u", 3.1), ("N2", 50.0)];
/// Numbers of states and event indicators of the reduced rig.
const STATES: usize = 5;
const INDICATORS: usize = 5;

type States = [f64; STATES];
type Indicators = [f64; INDICATORS];

/// What a solver asks of either version.
trait Exchange {
    /// Into continuous time, by way of the initialisation and the first events.
    fn start(&self, references: &[u32]);
    /// The events of this instant, and back.
    fn handle_events(&self);
    fn states(&self) -> States;
    fn put(&self, time: f64, states: &States);
    fn derivatives(&self) -> States;
    fn indicators(&self) -> Indicators;
    fn complete_step(&self) -> bool;
}

impl Exchange for Arc<FMU2<ME>> {
    fn start(&self, references: &[u32]) {
        let values = INPUTS.map(|(_, value)| value);
        assert_eq!(self.setReal(references, &values), fmi2Status::Ok);
        assert_eq!(self.setupExperiment(None, 0.0, None), fmi2Status::Ok);
        assert_eq!(self.enterInitializationMode(), fmi2Status::Ok);
        assert_eq!(self.exitInitializationMode(), fmi2Status::Ok);
        self.iterate();
    }

    fn handle_events(&self) {
        assert_eq!(self.enterEventMode(), fmi2Status::Ok);
        self.iterate();
    }

    fn states(&self) -> States {
        let mut states = [f64::NAN; STATES];
        assert_eq!(self.getContinuousStates(&mut states), fmi2Status::Ok);
        states
    }

    fn put(&self, time: f64, states: &States) {
        assert_eq!(self.setTime(time), fmi2Status::Ok);
        assert_eq!(self.setContinuousStates(states), fmi2Status::Ok);
    }

    fn derivatives(&self) -> States {
        let mut derivatives = [f64::NAN; STATES];
        assert_eq!(self.getDerivatives(&mut derivatives), fmi2Status::Ok);
        derivatives
    }

    fn indicators(&self) -> Indicators {
        let mut indicators = [f64::NAN; INDICATORS];
        assert_eq!(self.getEventIndicators(&mut indicators), fmi2Status::Ok);
        indicators
    }

    fn complete_step(&self) -> bool {
        let (mut event, mut terminate) = (0, 0);
        let status = self.completedIntegratorStep(1, &mut event, &mut terminate);
        assert_eq!((status, terminate), (fmi2Status::Ok, 0));
        event != 0
    }
}

/// Event iteration, which the two versions spell differently.
trait Iterate {
    fn iterate(&self);
}

impl Iterate for Arc<FMU2<ME>> {
    fn iterate(&self) {
        let [mut again, mut terminate, mut nominals, mut values] = [true, false, false, false];
        let mut next = None;
        while again {
            let status = self.newDiscreteStates(
                &mut again,
                &mut terminate,
                &mut nominals,
                &mut values,
                &mut next,
            );
            assert_eq!((status, terminate, next), (fmi2Status::Ok, false, None));
        }
        assert_eq!(self.enterContinuousTimeMode(), fmi2Status::Ok);
    }
}

impl Iterate for Arc<FMU3> {
    fn iterate(&self) {
        let [mut again, mut terminate, mut nominals, mut values] = [true, false, false, false];
        let mut next = None;
        while again {
            let status = self.updateDiscreteStates(
                &mut again,
                &mut terminate,
                &mut nominals,
                &mut values,
                &mut next,
            );
            assert_eq!((status, terminate, next), (fmi3Status::Ok, false, None));
        }
        assert_eq!(self.enterContinuousTimeMode(), fmi3Status::Ok);
    }
}

impl Exchange for Arc<FMU3> {
    fn start(&self, references: &[u32]) {
        let values = INPUTS.map(|(_, value)| value);
        assert_eq!(self.setFloat64(references, &values), fmi3Status::Ok);
        assert_eq!(
            self.enterInitializationMode(None, 0.0, None),
            fmi3Status::Ok
        );
        assert_eq!(self.exitInitializationMode(), fmi3Status::Ok);
        self.iterate();
    }

    fn handle_events(&self) {
        assert_eq!(self.enterEventMode(), fmi3Status::Ok);
        self.iterate();
    }

    fn states(&self) -> States {
        let mut states = [f64::NAN; STATES];
        assert_eq!(self.getContinuousStates(&mut states), fmi3Status::Ok);
        states
    }

    fn put(&self, time: f64, states: &States) {
        assert_eq!(self.setTime(time), fmi3Status::Ok);
        assert_eq!(self.setContinuousStates(states), fmi3Status::Ok);
    }

    fn derivatives(&self) -> States {
        let mut derivatives = [f64::NAN; STATES];
        let status = self.getContinuousStateDerivatives(&mut derivatives);
        assert_eq!(status, fmi3Status::Ok);
        derivatives
    }

    fn indicators(&self) -> Indicators {
        let mut indicators = [f64::NAN; INDICATORS];
        assert_eq!(self.getEventIndicators(&mut indicators), fmi3Status::Ok);
        indicators
    }

    fn complete_step(&self) -> bool {
        let (mut event, mut terminate) = (false, false);
        let status = self.completedIntegratorStep(true, &mut event, &mut terminate);
        assert_eq!((status, terminate), (fmi3Status::Ok, false));
        event
    }
}

/// Largest difference of the disc's angle \[rad\] from the native model, and the number of events.
fn run(fmu: &dyn Exchange, references: &[u32]) -> (f64, usize) {
    let text = std::fs::read_to_string(shipped_model("reduced-rig.toml")).unwrap();
    let rig = Rig::from_toml(&text, "reduced-rig.toml").unwrap();
    let inputs = RigInputs::held(INPUTS[0].1, INPUTS[1].1, 0.0);
    let start = [0.0; plant::STATES];
    let mut native = Simulation::new(rig, Options::default(), 0.0, start, inputs).unwrap();
    let (mut largest, mut events) = (0.0_f64, 0);
    fmu.start(references);
    for number in 1..=STEPS {
        let time = f64::from(number) * STEP;
        let (here, before, first) = (fmu.states(), fmu.indicators(), fmu.derivatives());
        let mut next = here;
        (0..STATES).for_each(|place| next[place] += STEP * first[place]);
        fmu.put(time, &next);
        let second = fmu.derivatives();
        for place in 0..STATES {
            next[place] = here[place] + 0.5 * STEP * (first[place] + second[place]);
        }
        fmu.put(time, &next);
        let after = fmu.indicators();
        let crossed = (0..INDICATORS).any(|place| (before[place] > 0.0) != (after[place] > 0.0));
        if fmu.complete_step() || crossed {
            fmu.handle_events();
            events += 1;
        }
        native.advance_to(time).unwrap();
        largest = largest.max((fmu.states()[0] - native.state_at(time)[0]).abs());
    }
    (largest, events)
}

#[test]
fn a_rust_importer_with_its_own_solver_follows_the_native_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = |version| build("reduced-rig.toml", version, folder.path());
    let two = FMU2Builder::new(&path(FmiVersion::Fmi2)).unwrap();
    let variables = &two.model_description.modelVariables;
    let place = |name: &str| {
        variables
            .iter()
            .find(|v| v.name == name)
            .unwrap()
            .valueReference
    };
    let references = INPUTS.map(|(name, _)| place(name));
    let old = run(&two.instantiate_me("rig").unwrap(), &references);
    let three = FMU3Builder::new(&path(FmiVersion::Fmi3)).unwrap();
    let new = run(&three.instantiate_me("rig").unwrap(), &references);
    assert_eq!(
        old.0.to_bits(),
        new.0.to_bits(),
        "both versions are one model"
    );
    assert_eq!(old.1, new.1);
    // Events lie at the ends of steps: half a step at 10 rad/s.
    assert!(old.0 < 3e-3 && old.1 >= 4, "{old:?}");
}
