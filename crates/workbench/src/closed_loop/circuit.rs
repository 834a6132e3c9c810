//! A rig and what drives it, connected where an output and an input share their name.

use thiserror::Error;

use crate::component::{Component, ComponentError, Role, position};

/// Why components make no circuit or cannot go on.
#[derive(Debug, Error)]
pub enum CircuitError {
    /// A component refused something.
    #[error(transparent)]
    Component(#[from] ComponentError),
    /// The controller drives nothing of the rig.
    #[error(
        "no output of {controller} is an input of {rig}; a controller of this rig has an output `u`"
    )]
    Unconnected {
        /// The controller.
        controller: String,
        /// The rig.
        rig: String,
    },
}

/// Outputs of one component that are inputs of another, by their positions.
#[derive(Debug, Default)]
struct Links {
    from: Vec<usize>,
    to: Vec<usize>,
    values: Vec<f64>,
}

impl Links {
    fn between(source: &dyn Component, target: &dyn Component) -> Self {
        let mut links = Self::default();
        for (from, output) in source.variables().iter().enumerate() {
            let same = |input: &crate::component::Variable| {
                input.role == Role::Input && input.name == output.name
            };
            if output.role == Role::Output
                && let Some(to) = target.variables().iter().position(same)
            {
                links.from.push(from);
                links.to.push(to);
            }
        }
        links.values = vec![0.0; links.from.len()];
        links
    }

    fn pass_on(
        &mut self,
        source: &mut dyn Component,
        target: &mut dyn Component,
    ) -> Result<(), ComponentError> {
        source.get(&self.from, &mut self.values)?;
        let pairs: Vec<(usize, f64)> = self
            .to
            .iter()
            .copied()
            .zip(self.values.iter().copied())
            .collect();
        target.set(&pairs)
    }
}

/// A rig, alone or with a controller.
pub struct Circuit {
    rig: Box<dyn Component>,
    controller: Option<(Box<dyn Component>, Links, Links)>,
    time: f64,
}

impl Circuit {
    /// Connects a rig and perhaps a controller.
    ///
    /// # Errors
    /// [`CircuitError::Unconnected`] where the controller cannot drive the rig.
    pub fn new(
        rig: Box<dyn Component>,
        controller: Option<Box<dyn Component>>,
    ) -> Result<Self, CircuitError> {
        let controller = match controller {
            None => None,
            Some(controller) => {
                let measured = Links::between(&*rig, &*controller);
                let driven = Links::between(&*controller, &*rig);
                if driven.from.is_empty() {
                    return Err(CircuitError::Unconnected {
                        controller: controller.title(),
                        rig: rig.title(),
                    });
                }
                Some((controller, measured, driven))
            }
        };
        Ok(Self {
            rig,
            controller,
            time: 0.0,
        })
    }

    /// Sets an input of whoever has it: the controller, or else the rig.
    ///
    /// # Errors
    /// Nobody has it, or it refuses the value.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), CircuitError> {
        if let Some((controller, ..)) = &mut self.controller
            && let Ok(place) = position(&**controller, name)
        {
            return Ok(controller.set(&[(place, value)])?);
        }
        let place = position(&*self.rig, name)?;
        Ok(self.rig.set(&[(place, value)])?)
    }

    /// Begins the run at time 0, which will not go beyond `stop` [s].
    ///
    /// # Errors
    /// A component refuses its parameters.
    pub fn initialise(&mut self, stop: f64) -> Result<(), CircuitError> {
        self.rig.initialise(0.0, stop)?;
        if let Some((controller, ..)) = &mut self.controller {
            controller.initialise(0.0, stop)?;
        }
        Ok(())
    }

    /// Exchanges values, the rig's first, then lets both advance to `until` [s].
    ///
    /// # Errors
    /// A component cannot go on.
    pub fn step(&mut self, until: f64) -> Result<(), CircuitError> {
        if let Some((controller, measured, driven)) = &mut self.controller {
            measured.pass_on(&mut *self.rig, &mut **controller)?;
            driven.pass_on(&mut **controller, &mut *self.rig)?;
            controller.step(self.time, until)?;
        }
        self.rig.step(self.time, until)?;
        self.time = until;
        Ok(())
    }

    /// The rig, to be looked at.
    pub fn rig(&mut self) -> &mut dyn Component {
        &mut *self.rig
    }
}
