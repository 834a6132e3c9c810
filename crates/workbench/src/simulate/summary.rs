//! What a run came to, on one screen.

use std::fmt;
use std::time::Duration;

use crate::analysis::limit_cycle::{self, LimitCycle};
use crate::analysis::motion::{self, Motion};
use crate::files::record::{Record, RecordError};

/// Velocity [rad/s] up to which a disc passes for sticking where a component does not tell.
const AT_REST: f64 = 1e-9;
/// Range of a velocity [rad/s] above which it may be a limit cycle.
const SMALLEST_RANGE: f64 = 1e-3;

/// What a run came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Kind of motion of disc D2, judged over the last third of the run.
    pub motion: Motion,
    /// Where that third begins and ends [s].
    pub judged: (f64, f64),
    /// Its limit cycle, if there is one.
    pub cycle: Option<LimitCycle>,
    /// Lowest and highest velocity of disc D2 in that third [rad/s].
    pub velocity: (f64, f64),
    /// Share of that third in which disc D2 sticks.
    pub stick_fraction: f64,
    /// Number of switches over the whole run, where the component tells.
    pub switches: Option<u64>,
    /// Time that the run took.
    pub wall_time: Duration,
}

impl Summary {
    /// Reads it off a result.
    ///
    /// # Errors
    /// [`RecordError::MissingColumn`] where the result has no `theta_dot`.
    pub fn new(
        record: &Record,
        switches: Option<u64>,
        wall_time: Duration,
    ) -> Result<Self, RecordError> {
        let (time, velocity) = (record.time(), record.require("theta_dot")?);
        let (start, end) = (time[0], time[time.len() - 1]);
        let (_, settled) = motion::thirds(start, end);
        let stuck = record.column("stuck");
        let evidence = motion::evidence(time, velocity, |row| {
            stuck.map_or(velocity[row].abs() <= AT_REST, |stuck| stuck[row] != 0.0)
        });
        let from = time.partition_point(|&at| at < settled);
        Ok(Self {
            motion: evidence.judge(),
            judged: (settled, end),
            cycle: limit_cycle::find(&time[from..], &velocity[from..], AT_REST, SMALLEST_RANGE),
            velocity: (evidence.late.minimum, evidence.late.maximum),
            stick_fraction: evidence.stick_fraction,
            switches,
            wall_time,
        })
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (from, to) = self.judged;
        writeln!(
            f,
            "motion          {} (disc D2, from {from:.2} s to {to:.2} s)",
            self.motion.name()
        )?;
        match &self.cycle {
            Some(cycle) => writeln!(
                f,
                "frequency       {:.4} Hz ({} periods of {:.4} s, each within {:.1e} s)",
                cycle.frequency(),
                cycle.periods,
                cycle.period,
                cycle.period_spread
            )?,
            None => writeln!(f, "frequency       none: no two whole periods in that time")?,
        }
        writeln!(
            f,
            "velocity        {:.4} … {:.4} rad/s",
            self.velocity.0, self.velocity.1
        )?;
        writeln!(f, "stick fraction  {:.3}", self.stick_fraction)?;
        match self.switches {
            Some(switches) => writeln!(
                f,
                "switches        {switches} between sticking and slipping over the whole run, all contacts"
            )?,
            None => writeln!(f, "switches        not told by an FMU")?,
        }
        writeln!(
            f,
            "wall time       {:.1} ms",
            1e3 * self.wall_time.as_secs_f64()
        )
    }
}
