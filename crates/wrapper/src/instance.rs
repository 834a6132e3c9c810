//! An instance: the original, the values of the variables that it does not have, and the steps with the effects' force.

use std::ffi::{CString, c_int};

use operations::{AddedEffect, Coupling, Guess, Moment, Settings, value};

use crate::original::{ERROR, Handle, Original, Stepped, is_good};
use crate::own::Own;

/// Most times that a step is taken again, and the change of the force over the largest so far at which it is not.
const MOST_REPEATS: usize = 4;
const SAME: f64 = 1e-9;
/// Share of the first step after which an original that cannot go back shows how it moves.
const GLIMPSE: f64 = 1e-3;

/// Why a call is refused.
pub struct Refused {
    /// Status for the importer.
    pub status: c_int,
    /// Why, where the original has not said so itself.
    pub reason: Option<String>,
}

impl Refused {
    /// An error of the wrapper's own.
    pub fn error(reason: impl Into<String>) -> Self {
        Self {
            status: ERROR,
            reason: Some(reason.into()),
        }
    }

    /// A status of the original.
    pub fn original(status: c_int) -> Self {
        Self {
            status,
            reason: None,
        }
    }
}

/// Who hears of refusals.
pub trait Log: Send {
    /// Says it.
    fn say(&self, status: c_int, message: &CString);
}

/// An instance.
pub struct Instance {
    /// The original.
    pub original: Original,
    settings: Settings,
    /// What it has beside that.
    pub own: Own,
    /// State before a step, where the original can save it.
    before: Handle,
    steps: Vec<f64>,
    log: Box<dyn Log>,
}

// SAFETY: the saved state moves with its instance.
unsafe impl Send for Instance {}

impl Instance {
    /// An instance around a new one of the original.
    ///
    /// # Errors
    /// The original refuses a start value.
    pub fn new(original: Original, settings: Settings, log: Box<dyn Log>) -> Result<Self, Refused> {
        let lengths = settings
            .effects
            .iter()
            .map(|effect| effect.operations.len());
        let longest = lengths.max().unwrap_or(0);
        let instance = Self {
            original,
            own: Own::new(&settings),
            settings,
            before: std::ptr::null_mut(),
            steps: vec![0.0; longest],
            log,
        };
        instance.begin().inspect_err(|refused| {
            instance.refuse("start values", refused);
        })?;
        Ok(instance)
    }

    /// Gives the original the start values that this FMU has instead of its own.
    fn begin(&self) -> Result<(), Refused> {
        for &(reference, value) in &self.settings.starts {
            let status = self.original.set(&[reference], &[value]);
            if !is_good(status) {
                return Err(Refused::error(format!(
                    "the original refuses the start value {value} of the variable with value reference {reference}"
                )));
            }
        }
        Ok(())
    }

    /// Tells the importer why a call of `function` is refused; the status to return.
    pub fn refuse(&self, function: &str, refused: &Refused) -> c_int {
        if let Some(reason) = &refused.reason {
            let message = format!("{function}: {reason}").replace('\0', " ");
            self.log
                .say(refused.status, &CString::new(message).unwrap_or_default());
        }
        refused.status
    }

    /// Notes the start of the run [s].
    pub fn starts(&mut self, time: f64) {
        self.own.start = time;
    }

    /// Goes back to before the set-up, once the original is there.
    ///
    /// # Errors
    /// The original refuses a start value.
    pub fn reset(&mut self) -> Result<(), Refused> {
        self.original.forget(&mut self.before);
        self.own = Own::new(&self.settings);
        self.begin()
    }

    fn place(&mut self, reference: u32) -> Option<(&str, &mut f64)> {
        let step = &self.settings.coupling_step;
        if step.reference == reference {
            return Some((&step.name, &mut self.own.coupling_step));
        }
        let effects = self.settings.effects.iter().zip(&mut self.own.parameters);
        for (effect, values) in effects {
            for (own, value) in effect.parameters.iter().zip(values) {
                if own.reference == reference {
                    return Some((&own.name, value));
                }
            }
        }
        None
    }

    /// Whether the original has none of these variables, or has the port's input, which the effects share.
    pub fn has_own(&mut self, references: &[u32]) -> bool {
        let (input, force) = (self.settings.port.input.0, self.settings.force);
        references
            .iter()
            .any(|&own| own == input || own == force || self.place(own).is_some())
    }

    /// Sets scalar reals, some of them the original's.
    ///
    /// # Errors
    /// A value that cannot be, or a status of the original.
    pub fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Result<(), Refused> {
        let step = self.settings.coupling_step.reference;
        for (&reference, &value) in references.iter().zip(values) {
            if reference == self.settings.force {
                return Err(Refused::error(
                    "the force of the effects is computed and can never be set",
                ));
            }
            if let Some((name, place)) = self.place(reference) {
                if !value.is_finite() || (reference == step && value <= 0.0) {
                    let right = if reference == step {
                        "finite and above 0"
                    } else {
                        "finite"
                    };
                    return Err(Refused::error(format!("{name} = {value} must be {right}")));
                }
                *place = value;
                continue;
            }
            let status = self.original.set(&[reference], &[value]);
            if !is_good(status) {
                return Err(Refused::original(status));
            }
            if reference == self.settings.port.input.0 {
                self.own.input = value;
            }
        }
        Ok(())
    }

    /// Reads scalar reals, some of them not the original's.
    ///
    /// # Errors
    /// A status of the original.
    pub fn reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Refused> {
        for (&reference, value) in references.iter().zip(values) {
            *value = if reference == self.settings.force {
                self.in_port(self.own.force)
            } else if reference == self.settings.port.input.0 {
                self.own.input
            } else if let Some((_, own)) = self.place(reference) {
                *own
            } else {
                self.original.get(reference).map_err(Refused::original)?
            };
        }
        Ok(())
    }

    /// A force along the motion [N or N m] as the port's input takes it.
    fn in_port(&self, force: f64) -> f64 {
        let port = &self.settings.port;
        force * port.inertia.signum() / port.input.1
    }

    /// Position and velocity now, with the velocity over the last step of this length [s] where it is not read.
    fn motion(&mut self, length: f64) -> Result<(f64, f64), Refused> {
        let port = &self.settings.port;
        let read = |output: Option<(u32, f64)>| {
            let read =
                output.map(|(reference, unit)| self.original.get(reference).map(|v| v * unit));
            read.transpose().map_err(Refused::original)
        };
        let (position, velocity) = (read(port.position)?, read(port.velocity)?);
        let ended = self.own.ended;
        Ok(match (position, velocity) {
            (Some(position), Some(velocity)) => (position, velocity),
            (None, velocity) => {
                let velocity = velocity.unwrap_or(0.0);
                let gone = ended.map_or(0.0, |(from, before)| {
                    from + 0.5 * length * (before + velocity)
                });
                (gone, velocity)
            }
            (Some(position), None) => {
                let Some((from, _)) = ended else {
                    return Ok((position, 0.0));
                };
                // The mean over a step is the velocity in its middle; half a step more brings it to the end.
                let mean = (position - from) / length;
                let change = self.own.mean.map_or(0.0, |before| mean - before);
                self.own.mean = Some(mean);
                (position, mean + 0.5 * change)
            }
        })
    }

    /// Steps the original from `from` over `length` [s] with the effects' force.
    ///
    /// # Errors
    /// A status of the original.
    pub fn step(&mut self, from: f64, length: f64) -> Result<Stepped, Refused> {
        if !(length > 0.0 && (from + length).is_finite()) {
            return Err(Refused::error(format!(
                "a step of {length} s from {from} s must be finite and above 0"
            )));
        }
        // Rounding of the quotient must not make one step more.
        let count = (length / self.own.coupling_step * (1.0 - 1e-9))
            .ceil()
            .max(1.0);
        let part = length / count;
        let mut at = from;
        if self.own.ended.is_none() {
            self.own.ended = Some(self.motion(part)?);
            if self.settings.can_vary_steps && !self.settings.can_restore {
                // A glimpse at how the original moves, before the first force has to fit that.
                let glimpse = GLIMPSE * part;
                let stepped = self.coupled(from, glimpse)?;
                if stepped.ends {
                    return Ok(stepped);
                }
                at = from + glimpse;
            }
        }
        let mut place = 0.0;
        while place < count {
            place += 1.0;
            let to = if place == count {
                from + length
            } else {
                from + place * part
            };
            let stepped = self.coupled(at, to - at)?;
            if stepped.ends || place == count {
                return Ok(stepped);
            }
            at = to;
        }
        Err(Refused::error("no step was taken"))
    }

    /// One step with a constant force; where the original can go back, again until the force fits the motion that it gives.
    fn coupled(&mut self, from: f64, length: f64) -> Result<Stepped, Refused> {
        let begun = (self.own.ended.unwrap_or_default(), self.own.mean);
        let can_go_back = match self.original.save(&mut self.before) {
            Some(status) if !is_good(status) => return Err(Refused::original(status)),
            saved => saved.is_some(),
        };
        let load = self.load()?;
        let mut force = self.force(from, length, begun.0, load);
        let mut stepped = self.pushed(from, length, force, begun, can_go_back)?;
        for _ in 0..MOST_REPEATS {
            if !can_go_back || stepped.ends {
                break;
            }
            let better = self.force(from, length, begun.0, load);
            if (better - force).abs() <= SAME * self.own.largest {
                break;
            }
            let status = self.original.restore(self.before);
            if !is_good(status) {
                return Err(Refused::original(status));
            }
            force = better;
            stepped = self.pushed(from, length, force, begun, true)?;
        }
        Ok(stepped)
    }

    /// The effects' force over a step from this position and velocity, under this load.
    fn force(
        &mut self,
        from: f64,
        length: f64,
        (position, velocity): (f64, f64),
        load: f64,
    ) -> f64 {
        let moment = Moment {
            time: from - self.own.start,
            position,
            velocity,
            acceleration: self.own.free,
            direction: velocity.signum(),
        };
        let (effects, own, steps) = (&self.settings.effects, &self.own, &mut self.steps);
        let mut coupling = Coupling {
            against: |[at]: &[Moment; 1]| [against(effects, &own.parameters, at, load, steps)],
            inertia: self.settings.port.inertia.abs(),
        };
        let last = Guess::new(own.force);
        let [found] = coupling.force(&[moment], length, [own.free], [last]);
        found.force
    }

    /// The load at the port now [N or N m]; zero where none is named.
    fn load(&self) -> Result<f64, Refused> {
        let Some((reference, unit)) = self.settings.port.load else {
            return Ok(0.0);
        };
        let read = self.original.get(reference).map_err(Refused::original)?;
        Ok(read * unit)
    }

    /// Steps the original under this force, and learns from the motion that it gives which acceleration all others gave.
    fn pushed(
        &mut self,
        from: f64,
        length: f64,
        force: f64,
        (ended, mean): ((f64, f64), Option<f64>),
        may_go_back: bool,
    ) -> Result<Stepped, Refused> {
        let input = self.own.input + self.in_port(force);
        if !input.is_finite() {
            let reason = format!("at t = {from} s the effects' force is not finite");
            return Err(Refused::error(reason));
        }
        let status = self.original.set(&[self.settings.port.input.0], &[input]);
        if !is_good(status) {
            return Err(Refused::original(status));
        }
        let stepped = self.original.step(from, length, may_go_back);
        if !is_good(stepped.status) {
            return Err(Refused::original(stepped.status));
        }
        (self.own.ended, self.own.mean) = (Some(ended), mean);
        let (position, velocity) = self.motion(length)?;
        self.own.free = (velocity - ended.1) / length - force / self.settings.port.inertia.abs();
        self.own.force = force;
        self.own.largest = self.own.largest.max(force.abs());
        self.own.ended = Some((position, velocity));
        Ok(stepped)
    }
}

/// What the effects oppose to the motion at a moment, each on top of the friction of those before it.
fn against(
    effects: &[AddedEffect],
    parameters: &[Vec<f64>],
    at: &Moment,
    load: f64,
    steps: &mut [f64],
) -> f64 {
    let mut friction = 0.0;
    let mut sum = 0.0;
    for (effect, parameters) in effects.iter().zip(parameters) {
        let coordinates = [
            at.position,
            at.velocity,
            at.acceleration,
            at.direction,
            at.time,
            friction,
            load,
        ];
        let own = value(&effect.operations, parameters, &coordinates, steps);
        sum += own;
        if effect.is_friction {
            friction += own;
        }
    }
    sum
}

impl Drop for Instance {
    fn drop(&mut self) {
        self.original.forget(&mut self.before);
    }
}
