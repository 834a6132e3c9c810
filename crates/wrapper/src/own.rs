//! What an instance has beside the original: values of variables, and what a step leaves for the next.

use operations::{AddedEffect, Settings};

/// What an instance has beside the original.
#[derive(Clone, Debug, PartialEq)]
pub struct Own {
    /// Parameters of every effect.
    pub parameters: Vec<Vec<f64>>,
    /// The longest step with a constant force [s].
    pub coupling_step: f64,
    /// The port's input as the importer set it, in its unit.
    pub input: f64,
    /// Start of the run [s].
    pub start: f64,
    /// Force of the effects along the motion in the last step [N or N m].
    pub force: f64,
    /// The largest so far.
    pub largest: f64,
    /// Acceleration that all other forces gave in the last step [m/s² or rad/s²].
    pub free: f64,
    /// Position and velocity at the end of the last step; `None` before the first.
    pub ended: Option<(f64, f64)>,
    /// Mean velocity over the last step, where only the position is read.
    pub mean: Option<f64>,
}

/// Numbers of an [`Own`] beside the parameters.
const NUMBERS: usize = 9;

impl Own {
    /// That of a new instance.
    pub fn new(settings: &Settings) -> Self {
        let starts = |effect: &AddedEffect| effect.parameters.iter().map(|own| own.start).collect();
        Self {
            parameters: settings.effects.iter().map(starts).collect(),
            coupling_step: settings.coupling_step.start,
            input: settings.port.start,
            start: 0.0,
            force: 0.0,
            largest: 0.0,
            free: 0.0,
            ended: None,
            mean: None,
        }
    }

    /// As numbers, always the same count of them.
    pub fn numbers(&self) -> Vec<f64> {
        let (position, velocity) = self.ended.unwrap_or((f64::NAN, f64::NAN));
        let mut numbers = vec![
            self.coupling_step,
            self.input,
            self.start,
            self.force,
            self.largest,
            self.free,
            position,
            velocity,
            self.mean.unwrap_or(f64::NAN),
        ];
        numbers.extend(self.parameters.iter().flatten());
        numbers
    }

    /// From [`Own::numbers`].
    pub fn take(&mut self, numbers: &[f64]) -> Option<()> {
        let (own, mut rest) = numbers.split_at_checked(NUMBERS)?;
        let known = |value: f64| (!value.is_nan()).then_some(value);
        self.coupling_step = own[0];
        self.input = own[1];
        self.start = own[2];
        self.force = own[3];
        self.largest = own[4];
        self.free = own[5];
        self.ended = known(own[6]).zip(known(own[7]));
        self.mean = known(own[8]);
        for parameters in &mut self.parameters {
            let (mine, others) = rest.split_at_checked(parameters.len())?;
            parameters.copy_from_slice(mine);
            rest = others;
        }
        Some(())
    }
}
