//! One run of a map and what is kept of it.

use stickslip::integrator::{IntegrationError, Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES};

use super::watch::Watch;
use crate::analysis::motion::Motion;

/// Most local extrema of the velocity that are kept of a run for a bifurcation diagram.
pub const MOST_EXTREMA: usize = 48;

/// What is kept of a run: of disc D2 in the last third.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Kind of motion; none where the run failed.
    pub motion: Option<Motion>,
    /// Lowest velocity [rad/s].
    pub minimum: f64,
    /// Highest velocity [rad/s].
    pub maximum: f64,
    /// Frequency [Hz]; NaN where there is no cycle.
    pub frequency: f64,
    /// Share of the time in which it sticks, over whole cycles where there are any.
    pub stick_fraction: f64,
    /// Mode changes of the whole rig over the whole run.
    pub switches: u64,
    /// Local maxima and minima of the velocity [rad/s] in order of time, the last ones that were asked for.
    pub extrema: Vec<f64>,
}

impl Point {
    /// A run that failed.
    #[must_use]
    pub fn failed() -> Self {
        Self {
            motion: None,
            minimum: f64::NAN,
            maximum: f64::NAN,
            frequency: f64::NAN,
            stick_fraction: f64::NAN,
            switches: 0,
            extrema: Vec::new(),
        }
    }

    /// Half of the range of the velocity [rad/s].
    #[must_use]
    pub fn half_amplitude(&self) -> f64 {
        0.5 * (self.maximum - self.minimum)
    }

    /// The point as the text of a journal; [`Point::parse`] gives the same back.
    #[must_use]
    pub fn to_text(&self) -> String {
        let extrema: Vec<String> = self
            .extrema
            .iter()
            .map(|value| format!("{value:?}"))
            .collect();
        format!(
            "{},{:?},{:?},{:?},{:?},{},{}",
            self.motion.map_or("failed", Motion::name),
            self.minimum,
            self.maximum,
            self.frequency,
            self.stick_fraction,
            self.switches,
            extrema.join(" ")
        )
    }

    /// Reads the text of a journal; none where it is not one.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let fields: Vec<&str> = text.split(',').collect();
        let [
            motion,
            minimum,
            maximum,
            frequency,
            stick_fraction,
            switches,
            extrema,
        ] = fields[..]
        else {
            return None;
        };
        let motion = match Motion::ALL.into_iter().find(|kind| kind.name() == motion) {
            None if motion != "failed" => return None,
            found => found,
        };
        Some(Self {
            motion,
            minimum: minimum.parse().ok()?,
            maximum: maximum.parse().ok()?,
            frequency: frequency.parse().ok()?,
            stick_fraction: stick_fraction.parse().ok()?,
            switches: switches.parse().ok()?,
            extrema: extrema
                .split_whitespace()
                .map(|value| value.parse().ok())
                .collect::<Option<Vec<f64>>>()?,
        })
    }
}

/// Runs the rig from rest for `duration` [s] and judges it on the way; no trajectory is stored, and of the local extrema
/// of the velocity the last `extrema` at most.
///
/// # Errors
/// Where the integrator gives up.
pub fn run_point(
    rig: Rig<f64>,
    inputs: RigInputs<f64>,
    duration: f64,
    options: Options,
    extrema: usize,
) -> Result<Point, IntegrationError> {
    let mut run = Simulation::new(rig, options, 0.0, [0.0; STATES], inputs)?;
    let mut watch = Watch::new(duration, extrema);
    let mut segments = 0;
    loop {
        watch.see(&run, options.order);
        if run.segment_end() >= duration {
            break;
        }
        segments += 1;
        if segments > options.budget {
            return Err(IntegrationError::BudgetExhausted {
                segments,
                target: duration,
                time: run.segment_end(),
                mode: format!("{:?}", run.mode()),
            });
        }
        run.next_segment()?;
    }
    Ok(watch.point(run.statistics().switches))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_survive_the_journal() {
        let point = Point {
            motion: Some(Motion::StickSlip),
            minimum: 0.0,
            maximum: 12.1 / 3.0,
            frequency: f64::NAN,
            stick_fraction: 0.25,
            switches: 88,
            extrema: vec![0.1, 1.0 / 3.0],
        };
        let back = Point::parse(&point.to_text()).unwrap();
        assert_eq!(back.to_text(), point.to_text());
        assert_eq!(back.extrema, point.extrema);
        assert_eq!(
            Point::parse(&Point::failed().to_text()).unwrap().motion,
            None
        );
        assert_eq!(Point::parse("stick_slip,1,2"), None);
        assert_eq!(Point::parse("flying,0,0,0,0,0,"), None);
    }
}
