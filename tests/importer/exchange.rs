//! Model exchange as an importer with a solver of its own does it.

use super::{Fmi2, Fmi3, Instance};
use stickslip::ffi::{Status, fmi2, fmi3};

/// A vector that a solver asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vector {
    States,
    Nominals,
    Derivatives,
    Indicators,
}

impl Instance<'_> {
    /// Number of continuous states in the description.
    pub fn state_count(&self) -> usize {
        self.component.table.states().count()
    }

    /// Number of event indicators in the description.
    pub fn indicator_count(&self) -> usize {
        self.component.table.event_indicators().count()
    }

    pub fn enter_events(&self) -> Status {
        // SAFETY: no pointers but the handle.
        unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2EnterEventMode(self.handle),
                Fmi3 => fmi3::fmi3EnterEventMode(self.handle),
            }
        }
    }

    pub fn enter_continuous_time(&self) -> Status {
        // SAFETY: no pointers but the handle.
        unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2EnterContinuousTimeMode(self.handle),
                Fmi3 => fmi3::fmi3EnterContinuousTimeMode(self.handle),
            }
        }
    }

    /// Iterates over the events of this instant; whether states have changed.
    #[track_caller]
    pub fn update_discrete_states(&self) -> bool {
        let (mut again, mut changed) = (true, false);
        while again {
            // SAFETY: places of the results.
            unsafe {
                match self.version {
                    Fmi2 => {
                        let mut info = fmi2::EventInfo {
                            new_discrete_states_needed: 9,
                            terminate_simulation: 9,
                            nominals_of_continuous_states_changed: 9,
                            values_of_continuous_states_changed: 9,
                            next_event_time_defined: 9,
                            next_event_time: 9.0,
                        };
                        assert_eq!(
                            fmi2::fmi2NewDiscreteStates(self.handle, &mut info),
                            Status::Ok
                        );
                        assert_eq!(
                            (info.terminate_simulation, info.next_event_time_defined),
                            (0, 0)
                        );
                        again = info.new_discrete_states_needed == 1;
                        changed |= info.values_of_continuous_states_changed == 1;
                    }
                    Fmi3 => {
                        let mut flags = [9_u8; 5];
                        let [needed, terminate, nominals, values, defined] = &mut flags;
                        let mut time = 9.0;
                        let status = fmi3::fmi3UpdateDiscreteStates(
                            self.handle,
                            needed,
                            terminate,
                            nominals,
                            values,
                            defined,
                            &mut time,
                        );
                        assert_eq!(status, Status::Ok);
                        assert_eq!((flags[1], flags[2], flags[4]), (0, 0, 0));
                        again = flags[0] == 1;
                        changed |= flags[3] == 1;
                    }
                }
            }
        }
        changed
    }

    pub fn set_time(&self, time: f64) -> Status {
        // SAFETY: no pointers but the handle.
        unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2SetTime(self.handle, time),
                Fmi3 => fmi3::fmi3SetTime(self.handle, time),
            }
        }
    }

    pub fn set_states(&self, states: &[f64]) -> Status {
        // SAFETY: as many values as said.
        unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2SetContinuousStates(self.handle, states.as_ptr(), states.len()),
                Fmi3 => fmi3::fmi3SetContinuousStates(self.handle, states.as_ptr(), states.len()),
            }
        }
    }

    /// A vector, or the status with which it was refused.
    pub fn try_vector(&self, which: Vector, count: usize) -> Result<Vec<f64>, Status> {
        let mut values = vec![f64::NAN; count];
        match self.fill(which, &mut values) {
            Status::Ok => Ok(values),
            refused => Err(refused),
        }
    }

    /// Fills `values` with a vector.
    pub fn fill(&self, which: Vector, values: &mut [f64]) -> Status {
        let (place, count) = (values.as_mut_ptr(), values.len());
        let c = self.handle;
        // SAFETY: as many places as said.
        unsafe {
            match (self.version, which) {
                (Fmi2, Vector::States) => fmi2::fmi2GetContinuousStates(c, place, count),
                (Fmi2, Vector::Nominals) => {
                    fmi2::fmi2GetNominalsOfContinuousStates(c, place, count)
                }
                (Fmi2, Vector::Derivatives) => fmi2::fmi2GetDerivatives(c, place, count),
                (Fmi2, Vector::Indicators) => fmi2::fmi2GetEventIndicators(c, place, count),
                (Fmi3, Vector::States) => fmi3::fmi3GetContinuousStates(c, place, count),
                (Fmi3, Vector::Nominals) => {
                    fmi3::fmi3GetNominalsOfContinuousStates(c, place, count)
                }
                (Fmi3, Vector::Derivatives) => {
                    fmi3::fmi3GetContinuousStateDerivatives(c, place, count)
                }
                (Fmi3, Vector::Indicators) => fmi3::fmi3GetEventIndicators(c, place, count),
            }
        }
    }

    #[track_caller]
    pub fn vector(&self, which: Vector) -> Vec<f64> {
        let count = match which {
            Vector::Indicators => self.indicator_count(),
            _ => self.state_count(),
        };
        self.try_vector(which, count).unwrap()
    }

    /// Ends a step of the solver; whether an event is due.
    #[track_caller]
    pub fn complete_step(&self) -> bool {
        let (mut event, mut terminate) = (9, 9);
        let (mut event_3, mut terminate_3) = (9, 9);
        // SAFETY: places of the results.
        let status = unsafe {
            match self.version {
                Fmi2 => {
                    fmi2::fmi2CompletedIntegratorStep(self.handle, 1, &mut event, &mut terminate)
                }
                Fmi3 => fmi3::fmi3CompletedIntegratorStep(
                    self.handle,
                    1,
                    &mut event_3,
                    &mut terminate_3,
                ),
            }
        };
        assert_eq!(status, Status::Ok);
        match self.version {
            Fmi2 => event == 1,
            Fmi3 => event_3 == 1,
        }
    }

    /// Goes on to `end` by Heun's method in steps of `size` \[s\], events at the end of the step in which they are.
    #[track_caller]
    pub fn integrate(&mut self, size: f64, end: f64) -> usize {
        let mut events = 0;
        while self.time < end - 0.5 * size {
            let x = self.vector(Vector::States);
            let before = self.vector(Vector::Indicators);
            let first = self.vector(Vector::Derivatives);
            let ahead: Vec<f64> = x.iter().zip(&first).map(|(x, k)| x + size * k).collect();
            self.time += size;
            assert_eq!(self.set_time(self.time), Status::Ok);
            assert_eq!(self.set_states(&ahead), Status::Ok);
            let second = self.vector(Vector::Derivatives);
            let next: Vec<f64> = x
                .iter()
                .zip(first.iter().zip(&second))
                .map(|(x, (a, b))| x + 0.5 * size * (a + b))
                .collect();
            assert_eq!(self.set_states(&next), Status::Ok);
            let after = self.vector(Vector::Indicators);
            let crossed = before
                .iter()
                .zip(&after)
                .any(|(a, b)| (*a > 0.0) != (*b > 0.0));
            if self.complete_step() || crossed {
                events += 1;
                assert_eq!(self.enter_events(), Status::Ok);
                self.update_discrete_states();
                assert_eq!(self.enter_continuous_time(), Status::Ok);
            }
        }
        events
    }

    /// Transposed Jacobian of the unknowns by the knowns, times the seeds of the unknowns. FMI 3 only.
    pub fn try_adjoint(
        &self,
        unknowns: &[&str],
        knowns: &[&str],
        seed: &[f64],
    ) -> Result<Vec<f64>, Status> {
        let references =
            |names: &[&str]| -> Vec<u32> { names.iter().map(|n| self.reference(n)).collect() };
        let (unknowns, knowns) = (references(unknowns), references(knowns));
        let mut sensitivity = vec![f64::NAN; knowns.len()];
        // SAFETY: lengths as given.
        let status = unsafe {
            fmi3::fmi3GetAdjointDerivative(
                self.handle,
                unknowns.as_ptr(),
                unknowns.len(),
                knowns.as_ptr(),
                knowns.len(),
                seed.as_ptr(),
                seed.len(),
                sensitivity.as_mut_ptr(),
                sensitivity.len(),
            )
        };
        if status == Status::Ok {
            Ok(sensitivity)
        } else {
            Err(status)
        }
    }
}
