//! From a kind and a seed to a complete hidden case.

use crate::answers::Answer;
use crate::effects::Effects;
use crate::excitation::{Brake, Run, draw_runs};
use crate::hidden_effect::{Effect, STRIBECK, practice_law};
use crate::law::ContactLaw;
use crate::other_rigs::plan::combinations;
use crate::random::{Purpose, Stream};
use crate::rig::{FRICTION_LEVEL, NOMINAL, draw_ratios};
use crate::simulator::TrueRig;

/// Random friction of a rough case: standard deviation [-].
const ROUGH_STANDARD_DEVIATION: f64 = 0.04;
/// Random friction of a rough case: correlation time [s].
const ROUGH_CORRELATION_TIME: f64 = 0.1;

/// What is hidden, on which rig, under which belief.
#[derive(Debug, Clone, PartialEq)]
pub struct Kind {
    /// `kind` in the answers.
    pub name: String,
    /// The effects, none for a clean case, with whether each sits on disc D1 (of the full rig).
    pub effects: Vec<(Effect, bool)>,
    /// Whether the pin brakes the disc.
    pub brake: Brake,
    /// The analyst's friction law where the kind fixes it.
    pub base: Option<&'static str>,
}

/// How a case is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// What is hidden.
    pub kind: Kind,
    /// Seed of every random number of the case.
    pub seed: u64,
    /// Size over practice size, drawn from this range.
    pub scale: (f64, f64),
    /// Whether friction fluctuates at random.
    pub rough: bool,
    /// Factor on the noise of the instruments.
    pub noise: f64,
}

/// A complete case, ready to simulate.
#[derive(Debug, Clone)]
pub struct HiddenCase {
    /// The rig that makes the records.
    pub rig: TrueRig,
    /// What the analyst believes about the contact.
    pub believed_law: ContactLaw,
    /// The runs.
    pub runs: Vec<Run>,
    /// The sealed answer.
    pub answer: Answer,
}

impl Kind {
    /// These effects with the brake on, named by them.
    pub(crate) fn of(effects: &[(Effect, bool)]) -> Self {
        let names: Vec<_> = effects.iter().map(|(effect, _)| effect.name()).collect();
        Self {
            name: names.join("_and_"),
            effects: effects.to_vec(),
            brake: Brake::On,
            base: None,
        }
    }

    fn named(name: &str, effect: Effect, brake: Brake) -> Self {
        Self {
            name: name.to_owned(),
            brake,
            ..Self::of(&[(effect, false)])
        }
    }

    /// A case with nothing hidden.
    pub fn clean(brake: Brake) -> Self {
        let name = match brake {
            Brake::On => "none",
            Brake::Off => "none_no_brake",
        };
        Self {
            name: name.to_owned(),
            brake,
            ..Self::of(&[])
        }
    }

    /// One effect of the catalogue under another law of the analyst's than usual.
    pub(crate) fn under_other_laws() -> impl Iterator<Item = Self> {
        let wobble = Self {
            base: Some("two_gaussian_mu"),
            ..Self::named(
                "normal_force_wobble_gauss",
                Effect::NormalForceWobble,
                Brake::On,
            )
        };
        let hysteresis = Effect::AccelerationHysteresis;
        let hysteresis = Self {
            base: Some("coulomb_stiction"),
            ..Self::named("acceleration_hysteresis_c", hysteresis, Brake::On)
        };
        [wobble, hysteresis].into_iter()
    }

    /// Every kind of the practice records that hides one effect.
    pub fn singles() -> Vec<Self> {
        let braked = Effect::catalogue().map(|effect| match effect {
            Effect::BearingFriction => Self::named("bearing_friction_braked", effect, Brake::On),
            Effect::QuadraticDrag => Self::named(effect.name(), effect, Brake::Off),
            _ => Self::of(&[(effect, false)]),
        });
        let free = [
            Self::named("bearing_friction", Effect::BearingFriction, Brake::Off),
            Self::named("unbalance_no_brake", Effect::Unbalance, Brake::Off),
        ];
        let kinds = braked.chain(free).chain(Self::under_other_laws());
        kinds.collect()
    }

    /// Kinds of a catalogue that the practice records do not have: presliding, and contacts that follow another law in part.
    pub fn further() -> Vec<Self> {
        let mut kinds: Vec<Self> = Self::singles()
            .into_iter()
            .filter(Self::replaces_law)
            .collect();
        kinds.push(Self::of(&[(Effect::Presliding, false)]));
        kinds
    }

    /// Whether the contact follows another law than the analyst's.
    pub fn replaces_law(&self) -> bool {
        self.effects
            .iter()
            .any(|(effect, _)| effect.replaced_law().is_some())
    }

    /// Kinds in no catalogue, `outside_<name>`, with those of other rigs if `other_rigs`.
    pub fn outsiders(other_rigs: bool) -> Vec<Self> {
        Effect::outsiders()
            .filter(|effect| other_rigs || *effect <= Effect::FadingMotor)
            .map(|effect| Self::named(&format!("outside_{}", effect.name()), effect, Brake::On))
            .collect()
    }

    /// Every pair of catalogue effects, `a_and_b` in alphabetical order. Left out: two laws at
    /// once, and `motor_viscous` with `supply_sag`, which no record without current can part.
    pub fn pairs() -> Vec<Self> {
        let choices: Vec<_> = Effect::catalogue().map(|effect| (effect, false)).collect();
        let mut pairs = combinations(&choices, 2);
        pairs.sort();
        pairs.iter().map(|pair| Self::of(pair)).collect()
    }

    /// The analyst's law on the dissertation's rig.
    fn believed_law(&self) -> ContactLaw {
        let replaced = self
            .effects
            .iter()
            .find_map(|(effect, _)| effect.replaced_law());
        let law = self.base.or(replaced).and_then(practice_law);
        law.unwrap_or(STRIBECK)
    }
}

impl Recipe {
    /// Draws the case.
    pub fn draw(&self) -> HiddenCase {
        let stream = &mut Stream::new(self.seed, Purpose::Recipe);
        let scale = round_to(stream.uniform(self.scale.0, self.scale.1), 1e-3);
        let least_spread = if self.rough { 0.02 } else { 0.01 };
        let spread = round_to(stream.uniform(least_spread, 0.02), 1e-3);
        let ratios = draw_ratios(stream, spread);
        let believed_law = self.kind.believed_law();

        let mut hidden = Effects::default();
        let mut law = believed_law.clone();
        for (effect, _) in &self.kind.effects {
            effect.put(scale, self.kind.brake, stream, &mut hidden);
            if let Some(full_law) = effect.full_law(stream) {
                law = if scale >= 1.0 {
                    full_law
                } else {
                    ContactLaw::Blend {
                        base: Box::new(law),
                        other: Box::new(full_law),
                        weight: scale,
                    }
                };
            }
        }
        if self.rough {
            hidden.stoch_std = ROUGH_STANDARD_DEVIATION;
            hidden.stoch_tau = ROUGH_CORRELATION_TIME;
        }
        let level = ratios.get(FRICTION_LEVEL).copied().unwrap_or(1.0);
        let answer = Answer {
            kind: self.kind.name.clone(),
            rough: hidden.stoch_std,
            seed: self.seed,
            scale,
            spread,
            base: believed_law.name().to_owned(),
            truth: law.name().to_owned(),
            effects: hidden.answers(),
            parameter_ratio: ratios.clone(),
            ..Answer::default()
        };
        HiddenCase {
            rig: TrueRig {
                parameters: NOMINAL.scaled(&ratios),
                law: law.with_level(level),
                effects: hidden,
                disc1: None,
            },
            believed_law,
            runs: draw_runs(
                &mut Stream::new(self.seed, Purpose::Excitation),
                self.kind.brake,
            ),
            answer,
        }
    }
}

fn round_to(value: f64, step: f64) -> f64 {
    let per_unit = (1.0 / step).round();
    (value * per_unit).round() / per_unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_cover_the_practice_records_and_more() {
        assert_eq!(Kind::singles().len(), 22);
        assert_eq!(Kind::further().len(), 5);
        assert_eq!(Kind::outsiders(false).len(), 14);
        // 18·17/2 pairs less three of two laws and one equivalent.
        assert_eq!(Kind::pairs().len(), 149);
    }

    #[test]
    fn a_pair_with_a_law_starts_from_the_simpler_law() {
        let pairs = Kind::pairs();
        let pair = pairs
            .iter()
            .find(|kind| kind.name == "stiction_and_viscous_drag")
            .unwrap();
        assert_eq!(pair.believed_law().name(), "coulomb");
    }

    #[test]
    fn small_law_differences_blend() {
        let case = Recipe {
            kind: Kind::of(&[(Effect::Stiction, false)]),
            seed: 1,
            scale: (0.1, 0.1),
            rough: false,
            noise: 1.0,
        }
        .draw();
        let level = case.answer.parameter_ratio[FRICTION_LEVEL];
        let breakaway = case.rig.law.breakaway() / level;
        assert!(breakaway > 0.1445 && breakaway < 0.148, "{breakaway}");
        assert_eq!(case.answer.truth, "coulomb_stiction");
    }
}
