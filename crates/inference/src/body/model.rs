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
        let [force] = self
            .at_port(sample.port)
            .forces(std::array::from_ref(sample));
        force
    }

    /// What acts at a port, sorted out once for many moments.
    #[must_use]
    pub fn at_port(&self, port: usize) -> Acting<'_> {
        let acting = self.acting(port).map(|at| &self.terms[at]);
        let (added, friction) = acting.partition(|term| term.entry.role == Role::Added);
        let base = self.terms.first().filter(|_| self.kind == Kind::Joint);
        Acting {
            friction,
            added,
            joint: base.map(|base| &base.values[..]),
        }
    }

    /// Adds, for each set of numbers of the term at this place, its force at moments of one port to a series of the set's own; friction
    /// and loads are those of the model.
    pub fn add_forces_of(
        &self,
        at: usize,
        numbers: &[Vec<f64>],
        samples: &[Sample],
        series: &mut [Vec<f64>],
    ) {
        let Some(first) = samples.first() else {
            return;
        };
        let acting = self.at_port(first.port);
        let mut term = (self.terms[at].entry, numbers, series);
        let (blocks, rest) = samples.as_chunks::<AT_ONCE>();
        for block in blocks {
            acting.extend(&mut term, block);
        }
        for sample in rest {
            acting.extend(&mut term, std::array::from_ref(sample));
        }
    }

    /// Places of the terms that give a force at a port, the friction first.
    pub fn acting(&self, port: usize) -> impl Iterator<Item = usize> {
        let of_role = move |role: Role| {
            let own = self.terms.iter().enumerate();
            own.filter(move |(_, term)| term.entry.role == role && term.entry.place.is_at(port))
                .map(|(at, _)| at)
        };
        of_role(Role::Law)
            .next_back()
            .into_iter()
            .chain(of_role(Role::Friction))
            .chain(of_role(Role::Added))
    }

    /// Whether another term's force depends on this one's numbers.
    #[must_use]
    pub fn is_depended_on(&self, at: usize) -> bool {
        let is_friction = matches!(self.terms[at].entry.role, Role::Law | Role::Friction);
        let is_base_of_joint = self.kind == Kind::Joint && at == 0;
        is_base_of_joint
            || is_friction && self.terms.iter().any(|own| own.entry.multiplies_friction())
    }

    /// Whether the force of a term depends on a load, alone or through the friction that it multiplies.
    #[must_use]
    pub fn depends_on_load(&self, at: usize) -> bool {
        let multiplies = self.terms[at].entry.multiplies_friction();
        let is_loaded = |own: &Term| {
            matches!(own.entry.role, Role::Law | Role::Friction) && own.entry.needs_load
        };
        self.terms[at].entry.needs_load || multiplies && self.terms.iter().any(is_loaded)
    }

    /// Numbers of other terms on which the force of this one depends.
    #[must_use]
    pub fn context(&self, at: usize) -> Vec<f64> {
        let multiplies = self.terms[at].entry.multiplies_friction();
        let others = self.terms.iter().enumerate().filter(|(other, term)| {
            let is_friction = matches!(term.entry.role, Role::Law | Role::Friction);
            multiplies && is_friction || self.kind == Kind::Joint && *other == 0
        });
        others.flat_map(|(_, term)| term.values.clone()).collect()
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

/// What of a model acts at one port.
pub struct Acting<'a> {
    friction: Vec<&'a Term>,
    added: Vec<&'a Term>,
    /// Numbers of a joint's base, which tell its loads.
    joint: Option<&'a [f64]>,
}

impl Acting<'_> {
    /// Force against the motion at each of some moments of this port.
    #[must_use]
    pub fn forces<const N: usize>(&self, samples: &[Sample; N]) -> [f64; N] {
        self.at_moments(samples, true, |moments| {
            let mut sums = *moments.friction();
            for term in &self.added {
                add(&mut sums, term.entry.forces(&term.values, moments));
            }
            sums
        })
    }

    /// Adds the force of a term under each of its sets of numbers to the set's series.
    fn extend<const N: usize>(
        &self,
        (entry, numbers, series): &mut (&Entry, &[Vec<f64>], &mut [Vec<f64>]),
        samples: &[Sample; N],
    ) {
        self.at_moments(samples, entry.multiplies_friction(), |moments| {
            for (values, series) in numbers.iter().zip(series.iter_mut()) {
                series.extend(entry.forces(values, moments));
            }
        });
    }

    /// What `of` gives at these moments, with a joint's loads, and with the friction where it is wanted.
    fn at_moments<const N: usize, T>(
        &self,
        samples: &[Sample; N],
        with_friction: bool,
        of: impl FnOnce(&Moments<'_, N>) -> T,
    ) -> T {
        let loaded;
        let mut samples = samples;
        if let Some(base) = self.joint {
            loaded = samples.each_ref().map(|sample| {
                let (motor, load) = joint_loads(base, sample);
                Sample {
                    motor,
                    load,
                    ..*sample
                }
            });
            samples = &loaded;
        }
        let mut moments = Moments::new(samples);
        if with_friction {
            let mut friction = [0.0; N];
            for term in &self.friction {
                add(&mut friction, term.entry.forces(&term.values, &moments));
            }
            moments.set_friction(friction);
        }
        of(&moments)
    }
}

fn add<const N: usize>(sums: &mut [f64; N], more: [f64; N]) {
    for (sum, more) in sums.iter_mut().zip(more) {
        *sum += more;
    }
}
