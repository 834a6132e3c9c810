//! A run of an oscillator: its samples and the phases between its switches.

use stickslip::friction::ContactMode;
use stickslip::integrator::{IntegrationError, Options, Simulation};
use stickslip::series::evaluate;

use super::system::{BODIES, Oscillator, OscillatorState};

/// A stretch of time in one mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Begin.
    pub from: f64,
    /// End.
    pub to: f64,
    /// Mode of the contact.
    pub mode: ContactMode,
}

impl Span {
    /// Length.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.to - self.from
    }
}

/// A sampled run.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Sample times.
    pub time: Vec<f64>,
    /// Position of the first body.
    pub position: Vec<f64>,
    /// Velocity of the first body.
    pub velocity: Vec<f64>,
    /// Friction force.
    pub friction: Vec<f64>,
    /// The modes that were passed, in order.
    pub spans: Vec<Span>,
}

impl Motion {
    /// Runs `oscillator` from `initial` at time 0 to `end`, with a sample every `step`.
    ///
    /// # Errors
    /// [`IntegrationError`] where the run cannot go on.
    pub fn of(
        oscillator: &Oscillator,
        initial: OscillatorState,
        end: f64,
        step: f64,
        options: Options,
    ) -> Result<Self, IntegrationError> {
        let mut run = Simulation::new(oscillator.clone(), options, 0.0, initial, ())?;
        let mut motion = Self {
            time: Vec::new(),
            position: Vec::new(),
            velocity: Vec::new(),
            friction: Vec::new(),
            spans: Vec::new(),
        };
        loop {
            let (from, to) = (run.segment_start(), run.segment_end());
            motion.note_mode(from, to.min(end), *run.mode());
            while motion.time.len() as f64 * step <= to.min(end) {
                let time = motion.time.len() as f64 * step;
                let state = run.state_at(time);
                motion.time.push(time);
                motion.position.push(state[0]);
                motion.velocity.push(state[BODIES]);
                motion
                    .friction
                    .push(evaluate(&run.jet().friction[..=options.order], time - from));
            }
            if to >= end {
                return Ok(motion);
            }
            run.next_segment()?;
        }
    }

    fn note_mode(&mut self, from: f64, to: f64, mode: ContactMode) {
        match self.spans.last_mut() {
            Some(last) if last.mode == mode => last.to = to,
            _ => self.spans.push(Span { from, to, mode }),
        }
    }

    /// Phases of sticking that last longer than `shortest`: the touch of a grazing contact is none.
    #[must_use]
    pub fn sticking(&self, shortest: f64) -> Vec<Span> {
        self.spans
            .iter()
            .filter(|span| span.mode.is_stuck() && span.length() > shortest)
            .copied()
            .collect()
    }

    /// Lengths of the slips between two phases of sticking that each last longer than `shortest`.
    #[must_use]
    pub fn slip_lengths(&self, shortest: f64) -> Vec<f64> {
        self.sticking(shortest)
            .windows(2)
            .map(|pair| pair[1].from - pair[0].to)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oscillator::Drive;
    use stickslip::friction::{Coulomb, CoulombStiction, Law};

    fn block(law: Law<f64>) -> Motion {
        let mut block = Oscillator::new(1, law).unwrap();
        block.stiffness[0][0] = 1.0;
        block.surface = Drive::constant(0.096);
        Motion::of(&block, [0.0; 7], 40.0, 0.01, Options::default()).unwrap()
    }

    #[test]
    fn coulomb_block_leaves_where_algebra_says() {
        // From rest the block slips backward until it has the belt's velocity: X = F (1 − cos s), X' = F sin s = V. Then
        // it rides the belt to X = F.
        let (force, velocity) = (0.98_f64, 0.096_f64);
        let catch_up = (velocity / force).asin();
        let leaves = catch_up + force * catch_up.cos() / velocity;
        let motion = block(Law::Coulomb(Coulomb { mu_c: force }));
        let first = motion.sticking(1e-6)[0];
        assert!((first.from - catch_up).abs() < 1e-10, "{first:?}");
        assert!((first.to - leaves).abs() < 1e-10, "{first:?}, not {leaves}");
        assert!((leaves - 10.257).abs() < 1e-3);
    }

    #[test]
    fn stiction_block_slips_as_long_as_algebra_says() {
        let law = CoulombStiction {
            mu_c: 0.98,
            mu_s: 1.47,
        };
        let motion = block(Law::CoulombStiction(law));
        // A circle about X = F_d from the angle of breakaway back to the belt's velocity.
        let angle = (0.49_f64 / 0.096).atan();
        let expected = std::f64::consts::TAU - 2.0 * angle;
        for slip in motion.slip_lengths(1e-6) {
            assert!((slip - expected).abs() < 1e-9, "{slip}, not {expected}");
        }
        assert!(motion.slip_lengths(1e-6).len() > 1);
    }
}
