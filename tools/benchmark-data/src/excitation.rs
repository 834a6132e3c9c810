//! Voltage and normal force of one run, held constant between samples.
//!
//! The shapes are those of the practice records: plateaus of about 10 s, a braked run at one
//! force, a braked run at rising forces, and a sine held for 50 ms at a time to judge on.

use crate::random::Stream;

/// Sampling interval of all records [s].
pub const SAMPLE_INTERVAL: f64 = 0.01;
/// Samples for which the swinging voltage is held.
const SINE_HOLD_SAMPLES: usize = 5;

/// Inputs of one run; entry `k` holds from sample `k` to sample `k + 1`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Excitation {
    /// Motor voltage [V].
    pub voltage: Vec<f64>,
    /// Mean normal force at the pin [N].
    pub normal_force: Vec<f64>,
    /// Mean normal force at the pin of disc D1 [N]; empty without one.
    pub disc1_force: Vec<f64>,
}

/// One run of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// File name.
    pub file: &'static str,
    /// Its inputs.
    pub excitation: Excitation,
}

/// Whether the pin touches the disc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Brake {
    /// Runs with the brake on, and one short run without.
    On,
    /// The pin never touches.
    Off,
}

impl Excitation {
    fn plateau(&mut self, seconds: f64, voltage: f64, normal_force: f64) {
        self.swing(seconds, voltage, 0.0, 0.0, normal_force);
    }

    fn swing(&mut self, seconds: f64, mean: f64, amplitude: f64, frequency: f64, force: f64) {
        let count = (seconds / SAMPLE_INTERVAL).round() as usize;
        for sample in 0..count {
            let held = (sample / SINE_HOLD_SAMPLES * SINE_HOLD_SAMPLES) as f64 * SAMPLE_INTERVAL;
            let phase = core::f64::consts::TAU * frequency * held;
            self.voltage.push(mean + amplitude * libm::sin(phase));
            self.normal_force.push(force);
        }
    }

    /// The last sample of a file repeats the inputs that held before it.
    pub(crate) fn close(mut self) -> Self {
        for inputs in [
            &mut self.voltage,
            &mut self.normal_force,
            &mut self.disc1_force,
        ] {
            inputs.extend(inputs.last().copied());
        }
        self
    }
}

/// Draws the runs of a case.
pub fn draw_runs(stream: &mut Stream, brake: Brake) -> Vec<Run> {
    match brake {
        Brake::On => braked_runs(stream),
        Brake::Off => free_runs(stream),
    }
}

fn braked_runs(stream: &mut Stream) -> Vec<Run> {
    // Half the cases press exactly as the practice records do, half somewhere near.
    let exact = stream.chance(0.5);
    let force = |stream: &mut Stream, newton: f64| {
        let factor = stream.uniform(0.85, 1.2);
        if exact { newton } else { newton * factor }
    };
    let mut no_brake = Excitation::default();
    no_brake.plateau(10.0, stream.uniform(1.7, 2.0), 0.0);
    no_brake.plateau(10.0, stream.uniform(2.7, 3.0), 0.0);

    let mut one_force = Excitation::default();
    let newton = force(stream, 30.0);
    for (low, high) in [(1.48, 1.68), (1.99, 2.2), (2.5, 2.7), (3.0, 3.21)] {
        one_force.plateau(10.0, stream.uniform(low, high), newton);
    }

    let mut rising_force = Excitation::default();
    for newton in [10.0, 30.0, 50.0, 70.0] {
        let newton = force(stream, newton);
        rising_force.plateau(10.0, stream.uniform(3.0, 3.21), newton);
    }

    let mut held_out = Excitation::default();
    for (low, high, newton) in [(1.7, 2.0, 20.0), (2.7, 3.01, 60.0), (2.2, 2.5, 40.0)] {
        let newton = force(stream, newton);
        held_out.plateau(10.0, stream.uniform(low, high), newton);
    }
    let newton = force(stream, 30.0);
    let frequency = if exact {
        0.13
    } else {
        stream.uniform(0.09, 0.16)
    };
    held_out.swing(
        20.0,
        stream.uniform(2.7, 3.0),
        stream.uniform(0.31, 0.51),
        frequency,
        newton,
    );
    vec![
        run("run-0.csv", no_brake),
        run("run-a.csv", one_force),
        run("run-b.csv", rising_force),
        run("held-out.csv", held_out),
    ]
}

fn free_runs(stream: &mut Stream) -> Vec<Run> {
    let mut rising = Excitation::default();
    for (low, high) in [(1.2, 1.35), (1.75, 1.95), (2.25, 2.45), (2.8, 2.95)] {
        rising.plateau(10.0, stream.uniform(low, high), 0.0);
    }
    let mut mixed = Excitation::default();
    for (low, high) in [(2.75, 2.96), (1.53, 1.66), (2.5, 2.65), (0.97, 1.1)] {
        mixed.plateau(10.0, stream.uniform(low, high), 0.0);
    }
    let mut held_out = Excitation::default();
    held_out.swing(
        40.0,
        stream.uniform(1.95, 2.25),
        stream.uniform(0.6, 0.87),
        stream.uniform(0.09, 0.125),
        0.0,
    );
    vec![
        run("run-a.csv", rising),
        run("run-b.csv", mixed),
        run("held-out.csv", held_out),
    ]
}

fn run(file: &'static str, excitation: Excitation) -> Run {
    Run {
        file,
        excitation: excitation.close(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Purpose;

    #[test]
    fn a_braked_case_has_the_four_files_of_the_practice_records() {
        let runs = draw_runs(&mut Stream::new(3, Purpose::Excitation), Brake::On);
        let shape: Vec<_> = runs
            .iter()
            .map(|run| (run.file, run.excitation.voltage.len()))
            .collect();
        assert_eq!(
            shape,
            [
                ("run-0.csv", 2001),
                ("run-a.csv", 4001),
                ("run-b.csv", 4001),
                ("held-out.csv", 5001)
            ]
        );
        assert!(runs[0].excitation.normal_force.iter().all(|&n| n == 0.0));
    }
}
