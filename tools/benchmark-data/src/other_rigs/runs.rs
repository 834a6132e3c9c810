//! Voltage and normal force of the runs: plateaus a few natural periods long, and a swing to judge on.

use crate::excitation::{Excitation, Run, SAMPLE_INTERVAL};
use crate::other_rigs::drawing::{LARGEST_LOAD, OtherRig, four_digits};
use crate::random::Stream;
use core::f64::consts::TAU;

/// Most samples of a case, all runs together.
pub const MOST_SAMPLES: f64 = 12_000.0;
/// Lowest and highest speed of a plateau over the top speed [-].
const SPEEDS: (f64, f64) = (0.2, 1.0);
/// Smallest and largest load of a plateau over the middle one [-].
const LOADS: (f64, f64) = (0.25, LARGEST_LOAD);

/// How the runs of a case are laid out.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Learning time in natural periods [-], 20 to 60.
    pub learning_periods: f64,
    /// Held-out time in natural periods [-], 10 to 20.
    pub held_out_periods: f64,
    /// Sampling interval [s], two digits.
    pub interval: f64,
    /// Number of runs to learn from, 2 to 4.
    pub runs: usize,
    /// Whether one of them is without normal force.
    pub one_free: bool,
    /// Whether the drive stops for a while in one of them.
    pub one_stop: bool,
    /// Whether the drive turns backward on some plateaus.
    pub backward: bool,
}

/// What the kind of a case wants of its runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wants {
    /// The drive must stop: a law without stiction sticks nowhere else.
    pub stop: bool,
    /// The disc must move backward too.
    pub backward: bool,
}

impl Layout {
    /// Draws a layout for a rig whose natural period is `period` [s].
    pub fn draw(period: f64, wants: Wants, stream: &mut Stream) -> Self {
        let learning_periods = stream.uniform(20.0, 60.0);
        let held_out_periods = stream.uniform(10.0, 20.0);
        let most = MOST_SAMPLES / (learning_periods + held_out_periods + 1.0);
        let per_period = stream.log_uniform(31.0, 298.0).min(most);
        // Rounded to two digits, towards more time between samples unless that is too much.
        let scale = libm::pow(10.0, libm::floor(libm::log10(period / per_period)) - 1.0);
        let steps = (period / per_period / scale).ceil();
        let steps = if steps * scale > period / 30.0 {
            steps - 1.0
        } else {
            steps
        };
        let interval = format!("{:.1e}", steps * scale);
        let runs = 2 + stream.index(3);
        let one_free = stream.chance(0.6) && runs > 2;
        let one_stop = stream.chance(0.2) || wants.stop;
        Self {
            learning_periods,
            held_out_periods,
            interval: interval.parse().unwrap_or(steps * scale),
            runs,
            one_free,
            one_stop,
            backward: wants.backward,
        }
    }

    /// The layout on the dissertation's rig, sampled every 10 ms.
    pub fn dissertation(wants: Wants, stream: &mut Stream) -> Self {
        Self {
            learning_periods: stream.uniform(45.0, 77.0),
            held_out_periods: stream.uniform(23.0, 38.0),
            interval: SAMPLE_INTERVAL,
            runs: 3,
            one_free: stream.chance(0.6),
            one_stop: wants.stop,
            backward: wants.backward,
        }
    }

    /// Draws the inputs of all runs, the held-out one last. On the full rig `disc1_load` is the
    /// middle normal force on disc D1 [N].
    pub fn draw_runs(
        &self,
        rig: &OtherRig,
        disc1_load: Option<f64>,
        stream: &mut Stream,
    ) -> Vec<Run> {
        let names = if self.one_free {
            ["run-0.csv", "run-a.csv", "run-b.csv", "run-c.csv"]
        } else {
            ["run-a.csv", "run-b.csv", "run-c.csv", "run-d.csv"]
        };
        let weights: Vec<f64> = (0..self.runs)
            .map(|index| {
                let weight = stream.uniform(0.7, 1.3);
                if index == 0 && self.one_free {
                    0.6 * weight
                } else {
                    weight
                }
            })
            .collect();
        let total: f64 = weights.iter().sum();
        let mut runs = Vec::new();
        for (index, weight) in weights.iter().enumerate() {
            let periods = self.learning_periods * weight / total;
            let free = index == 0 && self.one_free;
            // The second last run presses with one load throughout, the last with rising loads.
            let one_load = !free && index + 2 == self.runs;
            let mut inputs = Inputs::new(self, rig, disc1_load);
            let stop = self.one_stop && index + 1 == self.runs;
            inputs.plateaus(periods, free, one_load, stop, stream);
            runs.push(Run {
                file: names[index.min(3)],
                excitation: inputs.excitation.close(),
            });
        }
        let mut inputs = Inputs::new(self, rig, disc1_load);
        let swinging = stream.uniform(0.3, 0.5);
        let periods = self.held_out_periods;
        inputs.plateaus(
            periods * (1.0 - swinging),
            false,
            false,
            self.backward,
            stream,
        );
        inputs.swing(periods * swinging, stream);
        runs.push(Run {
            file: "held-out.csv",
            excitation: inputs.excitation.close(),
        });
        runs
    }
}

/// Inputs of one run in the making.
struct Inputs<'a> {
    layout: &'a Layout,
    rig: &'a OtherRig,
    disc1_load: Option<f64>,
    excitation: Excitation,
}

impl<'a> Inputs<'a> {
    fn new(layout: &'a Layout, rig: &'a OtherRig, disc1_load: Option<f64>) -> Self {
        Self {
            layout,
            rig,
            disc1_load,
            excitation: Excitation::default(),
        }
    }

    /// Plateaus over `periods`; speeds and loads are spread over their ranges.
    fn plateaus(
        &mut self,
        periods: f64,
        free: bool,
        one_load: bool,
        stop: bool,
        stream: &mut Stream,
    ) {
        let length = stream.uniform(3.5, 7.0);
        let count = ((periods / length).round() as usize).clamp(2, 6);
        let mut speeds = spread(count, SPEEDS, stream);
        if !one_load {
            stream.shuffle(&mut speeds);
        }
        let mut loads = spread(count, LOADS, stream);
        let the_load = stream.uniform(0.8, 1.25);
        let disc1_loads = spread(count, LOADS, stream);
        let backward_from = stream.index(2);
        for index in 0..count {
            if free {
                loads[index] = 0.0;
            } else if one_load {
                loads[index] = the_load;
            }
            let sign = if self.layout.backward && (index + backward_from) % 2 == 1 {
                -1.0
            } else {
                1.0
            };
            let stopped = stop && !self.layout.backward && count > 2 && index + 2 == count;
            let speed = if stopped { 0.0 } else { sign * speeds[index] };
            let disc1 = self.disc1_load.map_or(0.0, |load| {
                if free {
                    0.0
                } else {
                    load * disc1_loads[count - 1 - index]
                }
            });
            self.hold(periods / count as f64, speed, loads[index], disc1);
        }
    }

    /// Holds the voltage for `speed` (share of the top speed) under `load` (share of the middle one).
    fn hold(&mut self, periods: f64, speed: f64, load: f64, disc1: f64) {
        let load = four_digits(load * self.rig.middle_load);
        let voltage = if speed == 0.0 {
            0.0
        } else {
            self.rounded(self.rig.voltage(speed * self.rig.top_speed, load))
        };
        for _ in 0..self.samples(periods) {
            self.push(voltage, load, disc1);
        }
    }

    /// A sine about a middle speed, held for about a twentieth of a period at a time.
    fn swing(&mut self, periods: f64, stream: &mut Stream) {
        let load = four_digits(stream.uniform(0.5, 1.3) * self.rig.middle_load);
        let middle = stream.uniform(0.55, 0.75);
        let amplitude = stream.uniform(0.15, 0.25);
        let cycle = stream.uniform(4.0, 8.0);
        let interval = self.layout.interval;
        let held = ((self.rig.period / 20.0 / interval).round() as usize).max(1);
        let disc1 = self.disc1_load.unwrap_or(0.0);
        for sample in 0..self.samples(periods) {
            let time = (sample / held * held) as f64 * interval;
            let phase = TAU * time / (cycle * self.rig.period);
            let speed = (middle + amplitude * libm::sin(phase)) * self.rig.top_speed;
            let voltage = self.rounded(self.rig.voltage(speed, load));
            self.push(voltage, load, disc1);
        }
    }

    fn push(&mut self, voltage: f64, load: f64, disc1: f64) {
        self.excitation.voltage.push(voltage);
        self.excitation.normal_force.push(load);
        if self.disc1_load.is_some() {
            self.excitation.disc1_force.push(four_digits(disc1));
        }
    }

    fn samples(&self, periods: f64) -> usize {
        (periods * self.rig.period / self.layout.interval).round() as usize
    }

    /// A voltage as a record states it: to a ten-thousandth of the largest.
    fn rounded(&self, voltage: f64) -> f64 {
        let step = voltage_step(self.rig);
        let steps = (voltage / step).round();
        // Through the text, so that the record says exactly what the motor saw.
        format!("{:.*}", crate::records::decimals(step), steps * step)
            .parse()
            .unwrap_or(voltage)
    }
}

/// Step to which voltages are stated [V]: a power of ten.
pub fn voltage_step(rig: &OtherRig) -> f64 {
    let top = rig.voltage(rig.top_speed, LARGEST_LOAD * rig.middle_load);
    libm::pow(10.0, libm::floor(libm::log10(top)) - 4.0)
}

/// `count` numbers, one in each equal part of `range`, rising.
fn spread(count: usize, range: (f64, f64), stream: &mut Stream) -> Vec<f64> {
    let width = (range.1 - range.0) / count as f64;
    (0..count)
        .map(|part| range.0 + width * (part as f64 + stream.uniform(0.05, 0.95)))
        .collect()
}
