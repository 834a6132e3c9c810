//! A small plant's model: its base and the effects added to it.

use super::base::joint_loads;
use super::eccentricity::Eccentricity;
use super::equation::Moments;
use super::term::{Entry, Role, Sample};
use stickslip::body::{Dimension, Kind, Parameter, Path};

/// Number of moments whose forces are found at once; it changes no force. So an equation is read once for all of them, and the steps of
/// the longest of the catalogue, 24 numbers for each moment, take 6 KiB of the processor's fastest memory.
pub const AT_ONCE: usize = 32;

/// A term with its numbers.
#[derive(Debug, Clone)]
pub struct Term {
    /// What it is.
    pub entry: &'static Entry,
    /// Its numbers, in the order of the entry's parameters, SI.
    pub values: Vec<f64>,
}

/// The model: the base first, then the effects in the order in which they were added.
#[derive(Debug, Clone)]
pub struct Model {
    /// What the plant is.
    pub kind: Kind,
    /// Along what it moves.
    pub path: Path,
    terms: Vec<Term>,
}

impl Model {
    /// The base alone, with its numbers.
    #[must_use]
    pub fn new(kind: Kind, path: Path, entry: &'static Entry, values: Vec<f64>) -> Self {
        Self {
            kind,
            path,
            terms: vec![Term { entry, values }],
        }
    }

    /// The model with one effect more.
    #[must_use]
    pub fn with(&self, entry: &'static Entry, values: Vec<f64>) -> Self {
        let mut model = self.clone();
        model.terms.push(Term { entry, values });
        model
    }

    /// The model without an effect.
    #[must_use]
    pub fn without_effect(&self, name: &str) -> Self {
        let mut model = self.clone();
        model.terms.retain(|term| term.entry.name != name);
        model
    }

    /// Base and effects.
    #[must_use]
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Whether it has this effect.
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        self.terms.iter().any(|term| term.entry.name == name)
    }

    /// Force against the motion at a moment: what drives the plant must be equal to it.
    #[must_use]
    pub fn force(&self, sample: &Sample) -> f64 {
        let [force] = self.forces_at(std::array::from_ref(sample));
        force
    }

    /// Adds the forces at moments of one port to `forces`.
    pub fn add_forces(&self, samples: &[Sample], forces: &mut Vec<f64>) {
        let (blocks, rest) = samples.as_chunks::<AT_ONCE>();
        for block in blocks {
            forces.extend(self.forces_at(block));
        }
        forces.extend(rest.iter().map(|sample| self.force(sample)));
    }

    /// As [`Self::force`], at each of some moments of one port.
    fn forces_at<const N: usize>(&self, samples: &[Sample; N]) -> [f64; N] {
        let loaded;
        let mut samples = samples;
        if self.kind == Kind::Joint
            && let Some(base) = self.terms.first()
        {
            loaded = samples.each_ref().map(|sample| {
                let (motor, load) = joint_loads(&base.values, sample);
                Sample {
                    motor,
                    load,
                    ..*sample
                }
            });
            samples = &loaded;
        }
        let port = samples.first().map_or(0, |sample| sample.port);
        let mut moments = Moments::new(samples);
        let acts = |term: &&Term| term.entry.place.is_at(port);
        let of_role = |role: Role| self.terms.iter().filter(move |t| t.entry.role == role);
        let add = |sums: &mut [f64; N], more: [f64; N]| {
            for (sum, more) in sums.iter_mut().zip(more) {
                *sum += more;
            }
        };
        let mut friction = [0.0; N];
        if let Some(law) = of_role(Role::Law).rfind(acts) {
            friction = law.entry.forces(&law.values, &moments);
        }
        for term in of_role(Role::Friction).filter(acts) {
            add(&mut friction, term.entry.forces(&term.values, &moments));
        }
        moments.set_friction(friction);
        let mut other = [0.0; N];
        for term in of_role(Role::Added).filter(acts) {
            add(&mut other, term.entry.forces(&term.values, &moments));
        }
        std::array::from_fn(|at| friction[at] + other[at])
    }

    /// Time by which the readings of the motion at a port lag behind the force [s].
    #[must_use]
    pub fn delay(&self, port: usize) -> f64 {
        self.terms
            .iter()
            .enumerate()
            .filter(|(at, term)| match term.entry.role {
                Role::Shift => true,
                Role::Law => self.is_in_force(*at),
                _ => false,
            })
            .filter(|(_, term)| term.entry.place.is_at(port))
            .flat_map(|(_, term)| term.entry.parameters.iter().zip(&term.values))
            .filter(|(parameter, _)| parameter.dimension == Dimension::Delay)
            .map(|(_, value)| value)
            .sum()
    }

    /// The same of each of so many ports.
    #[must_use]
    pub fn delays(&self, ports: usize) -> Vec<f64> {
        (0..ports).map(|port| self.delay(port)).collect()
    }

    /// How the encoder is off centre, if it is.
    #[must_use]
    pub fn eccentricity(&self) -> Option<Eccentricity> {
        let reads = |term: &&Term| term.entry.role == Role::Reading;
        self.terms.iter().find(reads).map(|term| Eccentricity {
            cosine: term.values[0],
            sine: term.values[1],
        })
    }

    /// Whether no later friction law replaces this one at its place.
    fn is_in_force(&self, at: usize) -> bool {
        let place = self.terms[at].entry.place;
        let later = &self.terms[at + 1..];
        !later
            .iter()
            .any(|term| term.entry.role == Role::Law && term.entry.place == place)
    }

    /// The numbers that the records can say something about: those of a law that was replaced cannot.
    #[must_use]
    pub fn free(&self) -> Vec<(usize, usize, &'static Parameter)> {
        self.terms
            .iter()
            .enumerate()
            .filter(|(at, term)| term.entry.role != Role::Law || self.is_in_force(*at))
            .flat_map(|(at, term)| {
                let parameters = term.entry.parameters.iter().enumerate();
                parameters.map(move |(j, parameter)| (at, j, parameter))
            })
            .collect()
    }

    /// A number.
    #[must_use]
    pub fn value(&self, term: usize, parameter: usize) -> f64 {
        self.terms[term].values[parameter]
    }

    /// Sets a number.
    pub fn set(&mut self, term: usize, parameter: usize, value: f64) {
        self.terms[term].values[parameter] = value;
    }
}
