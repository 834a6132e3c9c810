//! The inputs of a rig as signals, and as its plant takes them.

use super::variables::CHANNELS;
use crate::cosim::input_signals;
use crate::plant::RigInputs;

/// Values and derivatives of a rig's inputs, at the places of [`Channel`](super::variables::Channel).
pub(super) type InputSignals = input_signals::InputSignals<CHANNELS>;

impl InputSignals {
    /// The signals from `now` [s] on, for the plant.
    pub(super) fn rig_inputs(&self, now: f64) -> RigInputs<f64> {
        let [voltage, normal_force, normal_force_1] = self.centred(now).polynomials;
        RigInputs {
            time: now,
            voltage,
            normal_force,
            normal_force_1,
            ..RigInputs::held(0.0, 0.0, 0.0)
        }
    }

    /// The signals for the plant about the centre that they have, coefficient by coefficient.
    pub(super) fn uncentred(&self) -> RigInputs<f64> {
        self.rig_inputs(self.centre)
    }

    /// Whether the plant's `inputs` are these signals from `now` [s] on.
    pub(super) fn agree_with(&self, inputs: &RigInputs<f64>, now: f64) -> bool {
        self.rig_inputs(now) == Self::of(inputs).rig_inputs(now)
    }

    /// The signals of the plant's `inputs`.
    pub(super) fn of(inputs: &RigInputs<f64>) -> Self {
        Self::new(
            inputs.time,
            [inputs.voltage, inputs.normal_force, inputs.normal_force_1],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::variables::Channel;
    use super::*;

    #[test]
    fn held_inputs_agree_at_any_later_time() {
        let voltage = Channel::Voltage as usize;
        let mut signals = InputSignals::default();
        signals.set_value(voltage, 3.1, 0.0);
        let inputs = signals.rig_inputs(0.0);
        signals.begin_step();
        signals.set_value(voltage, 3.1, 0.7);
        assert!(signals.agree_with(&inputs, 0.7));
        signals.set_value(voltage, 3.2, 0.7);
        assert!(!signals.agree_with(&inputs, 0.7));
    }
}
