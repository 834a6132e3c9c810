//! The measured motion: position, velocity and acceleration over even times, with force and load.

use std::f64::consts::TAU;

use serde::Deserialize;

use super::filter::LowPass;

/// How force and motion are made comparable.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measurement {
    /// Cut-off of the low-pass that the motion goes through before it is differentiated [Hz].
    pub motion_low_pass: f64,
    /// Cut-off of the low-pass that the measured and the model's force go through alike [Hz]; none where it is left out.
    pub compare_low_pass: Option<f64>,
    /// Rate at which they are compared [Hz]; of a pendulum, rate of its simulation.
    pub compare_rate: f64,
    /// Time at both ends of a record that is left aside, because filters are not settled there [s].
    #[serde(default)]
    pub edge: f64,
    /// Speed below which readings say nothing about the direction of motion [m/s or rad/s]: friction keeps that before.
    #[serde(default)]
    pub standstill_speed: f64,
}

/// Order of the low-pass before differentiating.
const ORDER: usize = 4;

/// One record, at its full sampling rate.
#[derive(Debug, Clone)]
pub struct Motion {
    /// What messages call it.
    pub name: String,
    /// Time of the first sample in its file [s].
    pub begin: f64,
    /// Sampling interval [s].
    pub interval: f64,
    /// Position as measured [m or rad]; integrated velocity where it is not measured.
    pub reading: Vec<f64>,
    /// Position freed from noise [m or rad].
    pub position: Vec<f64>,
    /// Velocity [m/s or rad/s].
    pub velocity: Vec<f64>,
    /// Acceleration [m/s² or rad/s²].
    pub acceleration: Vec<f64>,
    /// Direction of motion at every sample: −1 or 1.
    pub direction: Vec<f64>,
    /// Force or torque [N or N m]; zero for a free swing.
    pub force: Vec<f64>,
    /// Load, of a contact over its mean; zeros where it is not measured.
    pub load: Vec<f64>,
    /// Force or torque that somebody's own model predicts [N or N m]; zero where there is none.
    pub predicted: Vec<f64>,
    /// Voltage at a motor's terminals [V]; zero where there is none.
    pub voltage: Vec<f64>,
    /// 1 where a motor's terminals are connected, 0 where they are open.
    pub connected: Vec<f64>,
    /// What drives the plant: the force of a drive, the voltage of a joint, an FMU's first input; zero where nothing does.
    pub driving: Vec<f64>,
    /// Whether the moment says something of the forces: at rest friction takes any force up to breakaway.
    pub tells: Vec<bool>,
    /// Which of an FMU's ports it is of.
    pub port: usize,
    /// Frequency below which its forces are compared, where that is not `[measurement]`'s [Hz].
    pub cut_off: Option<f64>,
    /// What is particular to an FMU's missing force.
    pub pursuit: Option<Pursuit>,
}

/// How an FMU's missing force changes with what is uncertain, and where it says something.
#[derive(Debug, Clone)]
pub struct Pursuit {
    /// Values of the uncertain parameters at which it was found.
    pub at: Vec<f64>,
    /// Delays of the readings at each port at which it was found [s].
    pub at_delays: Vec<f64>,
    /// By how much it falls as each uncertain parameter grows [N or N m over the parameter's unit].
    pub slopes: Vec<Vec<f64>>,
    /// The same times those values, summed [N or N m].
    pub nominal: Vec<f64>,
    /// Inertia that the port shows at the frequency up to which forces are compared [kg or kg m²]: that of most of the noise.
    pub inertia: f64,
    /// The same at the first instant; negative where a positive input at the port pushes backward.
    pub inertia_at_once: f64,
    /// How [`Self::inertia`] grows with each uncertain parameter.
    pub inertia_slopes: Vec<f64>,
    /// By how much it falls as the motion at each port is read later [N/s or N m/s].
    pub delayed: Vec<Vec<f64>>,
    /// By how much it falls as the columns that may be off by a constant grow [N or N m over the column's unit].
    pub offsets: Vec<Vec<f64>>,
}

/// Usual sizes of what is in a record: root mean squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Position [m or rad], about its mean.
    pub position: f64,
    /// Velocity [m/s or rad/s].
    pub speed: f64,
    /// Acceleration [m/s² or rad/s²].
    pub acceleration: f64,
    /// Force beyond what was predicted [N or N m]; of a free swing its acceleration [rad/s²].
    pub force: f64,
    /// Period of the motion [s]: that of a sine with this acceleration and the speed about its mean.
    pub period: f64,
    /// Length of the longest record [s].
    pub duration: f64,
    /// Longest sampling interval [s].
    pub interval: f64,
    /// Voltage of a motor [V]; 1 where there is none.
    pub voltage: f64,
}

/// What of the motion was measured.
#[derive(Debug, Clone)]
pub enum Measured {
    /// Position [m or rad].
    Position(Vec<f64>),
    /// Velocity [m/s or rad/s] alone.
    Velocity(Vec<f64>),
    /// Both.
    Both(Vec<f64>, Vec<f64>),
}

impl Motion {
    /// The motion from what was measured at even times; `low_pass` [Hz] frees it from noise before it is differentiated, and
    /// below the speed `standstill` [m/s or rad/s] it counts as standing.
    #[must_use]
    pub fn new(
        name: String,
        begin: f64,
        interval: f64,
        measured: Measured,
        low_pass: f64,
        standstill: f64,
    ) -> Self {
        let smooth = |series: &[f64]| LowPass::new(low_pass, ORDER, interval).apply(series);
        let (reading, position, velocity, acceleration) = match measured {
            Measured::Position(reading) => {
                let position = smooth(&reading);
                let velocity = derivative(&position, interval);
                let acceleration = derivative(&velocity, interval);
                (reading, position, velocity, acceleration)
            }
            Measured::Velocity(velocity) => {
                let acceleration = derivative(&smooth(&velocity), interval);
                let position = integral(&velocity, interval);
                (position.clone(), position, velocity, acceleration)
            }
            Measured::Both(reading, velocity) => {
                let position = smooth(&reading);
                let velocity = smooth(&velocity);
                let acceleration = derivative(&velocity, interval);
                (reading, position, velocity, acceleration)
            }
        };
        let count = reading.len();
        Self {
            name,
            begin,
            interval,
            reading,
            position,
            direction: directions(&velocity, standstill),
            velocity,
            acceleration,
            force: vec![0.0; count],
            load: vec![0.0; count],
            predicted: vec![0.0; count],
            voltage: vec![0.0; count],
            connected: vec![0.0; count],
            driving: vec![0.0; count],
            tells: vec![true; count],
            port: 0,
            cut_off: None,
            pursuit: None,
        }
    }

    /// This record and one that goes on where it ends.
    #[must_use]
    pub fn followed_by(&self, next: &Self) -> Self {
        let mut both = self.clone();
        both.reading.extend(&next.reading);
        both.position.extend(&next.position);
        both.velocity.extend(&next.velocity);
        both.direction.extend(&next.direction);
        both.acceleration.extend(&next.acceleration);
        both.force.extend(&next.force);
        both.load.extend(&next.load);
        both.predicted.extend(&next.predicted);
        both.voltage.extend(&next.voltage);
        both.connected.extend(&next.connected);
        both.driving.extend(&next.driving);
        both.tells.extend(&next.tells);
        both
    }

    /// Leaves out of the comparison of forces where it stands or stood within half a period of `cut_off` [Hz], up to which forces are
    /// compared. Through a standstill at speeds up to `standstill` [m/s or rad/s] friction goes from one side to the other.
    pub fn leave_rests_out(&mut self, standstill: f64, cut_off: f64) {
        if standstill > 0.0 {
            let turning = |v: &f64| (v / standstill).clamp(-1.0, 1.0);
            self.direction = self.velocity.iter().map(turning).collect();
        }
        let reach = (0.5 / (cut_off * self.interval)).ceil() as usize;
        let mut tells = vec![true; self.len()];
        for (at, velocity) in self.velocity.iter().enumerate() {
            if velocity.abs() <= standstill {
                let (from, to) = (at.saturating_sub(reach), (at + reach + 1).min(tells.len()));
                tells[from..to].fill(false);
            }
        }
        self.tells = tells;
    }

    /// The same where what drives it takes effect a share of a sample later than it is read: for so long it is the reading before, or the
    /// next one where the share is negative.
    #[must_use]
    pub fn driven_later(&self, share: f64) -> Self {
        let mean = |series: &[f64]| -> Vec<f64> {
            let last = series.len().saturating_sub(1);
            let other = |at: usize| {
                if share > 0.0 {
                    at.saturating_sub(1)
                } else {
                    (at + 1).min(last)
                }
            };
            let mixed = |(at, own): (usize, &f64)| own + share.abs() * (series[other(at)] - own);
            series.iter().enumerate().map(mixed).collect()
        };
        Self {
            force: mean(&self.force),
            voltage: mean(&self.voltage),
            driving: mean(&self.driving),
            ..self.clone()
        }
    }

    /// Whether less than a tenth of it says something of the forces.
    #[must_use]
    pub fn hardly_moves(&self) -> bool {
        10.0 * self.seconds_that_tell() < self.seconds()
    }

    /// For how long it says something of the forces [s].
    #[must_use]
    pub fn seconds_that_tell(&self) -> f64 {
        let telling = self.tells.iter().filter(|own| **own).count();
        telling as f64 * self.interval
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.reading.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.reading.is_empty()
    }

    /// Length [s].
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.len().saturating_sub(1) as f64 * self.interval
    }
}

impl Scales {
    /// Usual sizes over several records.
    #[must_use]
    pub fn of(records: &[Motion]) -> Self {
        let over = |of: fn(&Motion) -> &[f64]| -> Vec<f64> {
            records
                .iter()
                .flat_map(|record| of(record).to_vec())
                .collect()
        };
        let position = over(|m| &m.position);
        let velocity = over(|m| &m.velocity);
        let about = |series: &[f64]| -> f64 {
            let mean = series.iter().sum::<f64>() / series.len().max(1) as f64;
            let about: Vec<f64> = series.iter().map(|x| x - mean).collect();
            root_mean_square(&about)
        };
        let acceleration = root_mean_square(&over(|m| &m.acceleration));
        let unexplained: Vec<f64> = over(|m| &m.force)
            .iter()
            .zip(over(|m| &m.predicted))
            .map(|(force, predicted)| force - predicted)
            .collect();
        let force = root_mean_square(&unexplained);
        let voltage = root_mean_square(&over(|m| &m.voltage));
        Self {
            position: about(&position),
            speed: root_mean_square(&velocity),
            period: TAU * about(&velocity) / acceleration,
            duration: records.iter().map(Motion::seconds).fold(0.0, f64::max),
            interval: records.iter().map(|own| own.interval).fold(0.0, f64::max),
            acceleration,
            voltage: if voltage > 0.0 { voltage } else { 1.0 },
            force: if force > 0.0 { force } else { acceleration },
        }
    }
}

/// Direction of motion; while it stands, that in which it moved last, and before it first moves that in which it will.
fn directions(velocity: &[f64], standstill: f64) -> Vec<f64> {
    let moves = |v: &&f64| v.abs() > standstill;
    let mut direction = velocity.iter().find(moves).map_or(1.0, |v| v.signum());
    velocity
        .iter()
        .map(|v| {
            if moves(&v) {
                direction = v.signum();
            }
            direction
        })
        .collect()
}

/// Root mean square.
#[must_use]
pub fn root_mean_square(series: &[f64]) -> f64 {
    (series.iter().map(|x| x * x).sum::<f64>() / series.len().max(1) as f64).sqrt()
}

/// Central differences, one-sided at the ends.
fn derivative(series: &[f64], interval: f64) -> Vec<f64> {
    let last = series.len().saturating_sub(1);
    (0..series.len())
        .map(|j| {
            let (low, high) = (j.saturating_sub(1), (j + 1).min(last));
            (series[high] - series[low]) / ((high - low).max(1) as f64 * interval)
        })
        .collect()
}

/// Trapezoidal sums from zero.
fn integral(series: &[f64], interval: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let mut before = series.first().copied().unwrap_or(0.0);
    series
        .iter()
        .map(|&value| {
            sum += 0.5 * (value + before) * interval;
            before = value;
            sum
        })
        .collect()
}
