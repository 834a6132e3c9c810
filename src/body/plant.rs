//! A body that moves along one coordinate, with its numbers.

use super::base::base;
use super::definition::{Definition, Dependence, dependence, of_base, of_effect};
use super::file::{CATALOGUE_FILE, FileError, OWN_EFFECTS, Plant, Reader, catalogue};
use super::{Kind, Path, Port};
use crate::expression::{MOST_PARAMETERS, SITES};
use crate::parameter::{
    self, ParameterError, ParameterInfo, Section, check, parameters, position, set_at, value_at,
};
use crate::series::Scalar;

/// Most terms of a body: its base and twelve effects.
const MOST_TERMS: usize = 13;

/// A base or an effect with its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term<S> {
    /// What it is.
    pub definition: &'static Definition,
    values: [S; MOST_PARAMETERS],
}

impl<S: Scalar> Term<S> {
    /// Its numbers, SI.
    pub fn values(&self) -> &[S] {
        &self.values[..self.definition.infos.len()]
    }
}

impl<S: Scalar> Section<S> for Term<S> {
    fn infos(&self) -> &'static [ParameterInfo] {
        self.definition.infos
    }
    fn get(&self, index: usize) -> S {
        self.values[index]
    }
    fn set(&mut self, index: usize, value: S) {
        self.values[index] = value;
    }
}

/// A drive, a pendulum or a joint with its effects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body<S> {
    /// What it is.
    pub kind: Kind,
    /// Along what it moves.
    pub path: Path,
    /// Base first, then the effects at the port of friction, on whose sum the others may depend.
    terms: [Option<Term<S>>; MOST_TERMS],
    /// Whether a force depends on the acceleration.
    pub(super) reacts: bool,
}

impl Body<f64> {
    /// The body of a model file's text; `file` names it in messages. What belongs to a diagnosis alone, columns and measurement, is
    /// not looked at.
    ///
    /// # Errors
    /// What is wrong, with file, section and key, or why such a plant does not move by itself.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, FileError> {
        let reader = Reader::new(text, file)?;
        let Plant { kind, path, .. } = reader.plant()?;
        let base = base(kind).ok_or_else(|| {
            let why = kind.stands_still().unwrap_or_default();
            let expected = format!("\"drive\", \"pendulum\" or \"joint\" to be simulated; {why}");
            reader.wrong("plant", "kind", &format!("{:?}", kind.word()), &expected)
        })?;
        let mut possible = Vec::new();
        for described in catalogue()? {
            let needed = described.path(CATALOGUE_FILE)?;
            let fits = described.kinds(CATALOGUE_FILE)?.contains(&kind);
            if fits && needed.is_none_or(|needed| needed == path) {
                possible.push(described);
            }
        }
        for reading in ["sensor_delay", "encoder_eccentricity"] {
            if reader.table.contains_key(reading) {
                let expected = "left out: it is an effect of the readings, not of the motion";
                return Err(reader.wrong(reading, "section", "given", expected));
            }
        }
        let names: Vec<&str> = possible.iter().map(|own| own.name.as_str()).collect();
        let known = ["plant", "columns", "measurement", OWN_EFFECTS, kind.word()];
        reader.check_sections(kind, &known, &names)?;

        let numbers = |definition: &'static Definition, parameters| {
            let mut values = [0.0; MOST_PARAMETERS];
            let read = reader.numbers(definition.name, parameters, kind, path)?;
            for (value, (number, _)) in values.iter_mut().zip(read) {
                *value = number;
            }
            Ok::<_, FileError>(Term { definition, values })
        };
        let mut terms = vec![numbers(of_base(base, kind, path)?, base)?];
        for described in possible {
            if reader.table.contains_key(&described.name) {
                let definition = of_effect(described, CATALOGUE_FILE, kind, path)?;
                let parameters = definition
                    .effect
                    .map_or(&[][..], |effect| effect.parameters);
                terms.push(numbers(definition, parameters)?);
            }
        }
        for described in reader.own_effects()? {
            let definition = of_effect(&described, file, kind, path)?;
            let is_taken = names.contains(&definition.name)
                || terms
                    .iter()
                    .any(|term| term.definition.name == definition.name);
            reader.check_name(definition.name, is_taken)?;
            let mut values = [0.0; MOST_PARAMETERS];
            if let Some(effect) = definition.effect {
                let read = described.numbers(effect, file, kind, path)?;
                for (value, (number, _)) in values.iter_mut().zip(read) {
                    *value = number;
                }
            }
            terms.push(Term { definition, values });
        }
        Self::of(&reader, kind, path, terms)
    }

    fn of(
        reader: &Reader<'_>,
        kind: Kind,
        path: Path,
        mut terms: Vec<Term<f64>>,
    ) -> Result<Self, FileError> {
        if terms.len() > MOST_TERMS {
            let (count, most) = ((terms.len() - 1).to_string(), MOST_TERMS - 1);
            let expected = format!("{most} or fewer to be simulated");
            return Err(reader.wrong("plant", "number of effects", &count, &expected));
        }
        let is_friction = |term: &Term<f64>| {
            let effect = term.definition.effect;
            effect.map(|effect| effect.port == Port::Friction)
        };
        terms.sort_by_key(|term| match is_friction(term) {
            None => 0,
            Some(true) => 1,
            Some(false) => 2,
        });
        let (mut friction, mut all) = (Dependence::None, Dependence::None);
        let mut sites = 0;
        for effect in terms.iter().filter_map(|term| term.definition.effect) {
            sites += effect.program.sites().len();
            let own = dependence(&effect.program, friction);
            if own == Dependence::Other {
                let section = format!("effect {}", effect.name);
                let expected =
                    "in proportion to the acceleration, where it depends on it, to be simulated";
                let found = format!("{:?}", effect.equation);
                return Err(reader.wrong(&section, "equation", &found, expected));
            }
            if effect.port == Port::Friction {
                // A friction may not depend on the friction.
                friction = friction.max(dependence(&effect.program, Dependence::None));
            }
            all = all.max(own);
        }
        if sites > SITES {
            let expected = format!("{SITES} or fewer in all equations together to be simulated");
            return Err(reader.wrong("plant", "number of kinks", &sites.to_string(), &expected));
        }
        let mut terms = terms.into_iter();
        Ok(Self {
            kind,
            path,
            terms: std::array::from_fn(|_| terms.next()),
            reacts: all != Dependence::None,
        })
    }
}

impl<S: Scalar> Body<S> {
    /// Base and effects.
    pub fn terms(&self) -> impl Iterator<Item = &Term<S>> {
        self.terms.iter().flatten()
    }

    /// Number of the base at this place, SI; zero where there is none.
    pub(super) fn own(&self, place: usize) -> S {
        self.terms[0]
            .as_ref()
            .map_or(S::ZERO, |base| base.values[place])
    }

    /// Mass or moment of inertia; 1 where all forces are over it.
    pub(super) fn inertia(&self) -> S {
        match self.kind {
            Kind::Drive => self.own(0),
            _ => S::constant(1.0),
        }
    }

    /// Its sections, base first.
    pub fn sections(&self) -> Vec<(&'static str, &dyn Section<S>)> {
        self.terms()
            .map(|term| (term.definition.name, term as &dyn Section<S>))
            .collect()
    }

    /// All parameters.
    pub fn parameters(&self) -> Vec<parameter::Parameter> {
        parameters(&self.sections())
    }

    /// Value of the parameter at this position of [`parameters`](Self::parameters).
    pub fn parameter_at(&self, position: usize) -> Option<S> {
        value_at(&self.sections(), position)
    }

    /// Value of the parameter with this dotted name.
    pub fn parameter(&self, name: &str) -> Option<S> {
        self.parameter_at(position(&self.sections(), name)?)
    }

    /// Replaces a parameter by position after checking its range.
    ///
    /// # Errors
    /// There is no such parameter, or the value is out of range.
    pub fn set_parameter_at(&mut self, position: usize, value: S) -> Result<(), ParameterError> {
        let sections = self.terms.iter_mut().flatten();
        let sections = sections.map(|term| (term.definition.name, term as &mut dyn Section<S>));
        set_at(sections.collect(), position, value)
    }

    /// Replaces the parameter with this dotted name after checking its range.
    ///
    /// # Errors
    /// There is no such parameter, or the value is out of range.
    pub fn set_parameter(&mut self, name: &str, value: S) -> Result<(), ParameterError> {
        let position = position(&self.sections(), name);
        let position = position.ok_or_else(|| ParameterError::Unknown { name: name.into() })?;
        self.set_parameter_at(position, value)
    }

    /// Checks every range.
    ///
    /// # Errors
    /// The first value that is out of range.
    pub fn check(&self) -> Result<(), ParameterError> {
        check(&self.sections())
    }

    /// The same over another kind of number.
    pub fn to_scalar<T: Scalar>(&self) -> Body<T> {
        Body {
            kind: self.kind,
            path: self.path,
            terms: self.terms.map(|term| {
                term.map(|term| Term {
                    definition: term.definition,
                    values: term.values.map(|value| T::constant(value.value())),
                })
            }),
            reacts: self.reacts,
        }
    }
}
