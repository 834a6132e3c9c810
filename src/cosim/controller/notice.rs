//! What a controller tells the log.

use crate::controller::{Gains, Mode};
use crate::cosim;
use std::fmt;

/// The voltage has reached or left a limit.
pub(super) struct Notice {
    time: f64,
    saturated: bool,
    voltage: f64,
}

impl Notice {
    /// What there is to tell of a change of modes at `time` [s].
    pub(super) fn of(gains: &Gains<f64>, was: Mode, is: Mode, time: f64) -> Option<Self> {
        let (was, is) = (was.limit(), is.limit());
        let side = is.or(was).filter(|_| was != is)?;
        Some(Self {
            time,
            saturated: is.is_some(),
            voltage: gains.limits[side as usize],
        })
    }
}

impl cosim::Notice for Notice {
    fn time(&self) -> f64 {
        self.time
    }

    fn what(&self) -> String {
        let verb = if self.saturated { "reaches" } else { "leaves" };
        format!("the voltage {verb} its limit of {} V", self.voltage)
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "t = {} s: {}", self.time, cosim::Notice::what(self))
    }
}
