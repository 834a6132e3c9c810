//! One case on another rig: drawn, tried until it sticks and slips, simulated, written.

use crate::answers::Answer;
use crate::case_files::{Case, MadeCase};
use crate::effects::Effects;
use crate::error::MakerError;
use crate::excitation::Run;
use crate::hidden_effect::Effect;
use crate::instruments::Instruments;
use crate::law::ContactLaw;
use crate::numerics::{DISSERTATION, Numerics};
use crate::other_rigs::contact::{Laws, Speeds, draw_laws, is_sound};
use crate::other_rigs::disc1::{BelievedOuter, Disc1Draws};
use crate::other_rigs::drawing::{Draws, OtherRig};
use crate::other_rigs::motion::{Motion, Seen};
use crate::other_rigs::runs::{Layout, Wants, voltage_step};
use crate::other_rigs::sizes::Scales;
use crate::other_rigs::text::{facts, model_toml};
use crate::plan::Measured;
use crate::random::{Purpose, Stream};
use crate::recipe::Kind;
use crate::records::Recording;
use crate::rig::{FRICTION_LEVEL, NOMINAL, draw_ratios};
use crate::simulator::{Sample, Simulator, State, TrueRig};
use core::f64::consts::TAU;
use std::collections::BTreeMap;

/// Attempts at inputs and laws before the rig is drawn anew, and how often it is.
const ATTEMPTS: (u64, u64) = (40, 12);
/// How much coarser the step of a trial is [-].
const COARSER: f64 = 10.0;

/// How much finer the step is where friction depends on the acceleration [-].
const FINER_FOR_A_LOOP: f64 = 3.0;

/// Which rig a case is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RigChoice {
    /// Drawn anew, one disc.
    Drawn,
    /// Drawn anew, two discs.
    Full,
    /// The dissertation's, with contacts, loads and sizes drawn anew.
    Dissertation,
}

/// How a case on another rig is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherCase {
    /// Directory name; says nothing about the kind.
    pub name: String,
    /// What is hidden.
    pub kind: Kind,
    /// Seed of every random number of the case.
    pub seed: u64,
    /// The rig.
    pub rig: RigChoice,
    /// Factor on the size of effects, drawn from this range; 1 = full.
    pub size: (f64, f64),
    /// Whether a law is hidden in part where the size is below 1.
    pub share_laws: bool,
    /// Whether friction fluctuates.
    pub rough: bool,
    /// Factor on the noise of the instruments.
    pub noise: f64,
    /// What is measured.
    pub measured: Measured,
    /// Normal force at which a load exponent changes nothing [N]; `None`: the middle load.
    pub load_reference: Option<f64>,
}

/// A complete case on another rig, ready to simulate.
#[derive(Debug, Clone)]
pub struct DrawnCase {
    /// The rig as it truly is.
    pub truth: TrueRig,
    /// What is believed, and the scales.
    pub rig: OtherRig,
    /// Believed and true contact.
    pub laws: Laws,
    /// What is believed of disc D1.
    pub disc1: Option<BelievedOuter>,
    /// Layout of the runs.
    pub layout: Layout,
    /// Inputs.
    pub runs: Vec<Run>,
    /// Instruments as they truly are.
    pub instruments: Instruments,
    /// Factor on the size of the effects.
    pub size: f64,
    /// How far the analyst is off.
    pub spread: f64,
    /// True over believed parameters.
    pub ratios: BTreeMap<String, f64>,
    /// Seed of the random friction.
    pub seed: u64,
    /// What a trial showed.
    pub motion: Motion,
}

impl OtherCase {
    /// Draws rigs, laws and inputs until the records stick and slip.
    ///
    /// # Errors
    /// No draw does.
    pub fn draw(&self) -> Result<DrawnCase, MakerError> {
        let mut rig_stream = Stream::new(self.seed, Purpose::Rig);
        for round in 0..ATTEMPTS.1 {
            let draws = Draws::draw(&mut rig_stream);
            let (mut load_factor, mut law_index) = (1.0, 100 * round);
            for attempt in 0..ATTEMPTS.0 {
                let Some(case) =
                    self.attempt(&draws, load_factor, law_index, 100 * round + attempt)
                else {
                    law_index += 1;
                    continue;
                };
                match self.try_out(&case, COARSER)? {
                    Seen::Good(motion) => return Ok(DrawnCase { motion, ..case }),
                    Seen::NeverSticks => load_factor *= 1.35,
                    Seen::NeverSlides => load_factor *= 0.72,
                    Seen::LoopManyValued => law_index += 1,
                }
            }
        }
        Err(MakerError::NoStickSlip {
            case: self.name.clone(),
        })
    }

    /// One draw; `None` where the law is out of reason.
    fn attempt(
        &self,
        draws: &Draws,
        load_factor: f64,
        law_index: u64,
        inputs_index: u64,
    ) -> Option<DrawnCase> {
        let stream = |purpose| Stream::new(self.seed, purpose);
        let effects: Vec<Effect> = self
            .kind
            .effects
            .iter()
            .map(|(effect, _)| *effect)
            .collect();
        let disc1_draws =
            (self.rig == RigChoice::Full).then(|| Disc1Draws::draw(&mut stream(Purpose::Disc1)));
        let hanging = disc1_draws.map_or(0.0, |disc1| disc1.inertia);

        let mut recipe = stream(Purpose::Recipe);
        let size = thousandth(recipe.uniform(self.size.0, self.size.1));
        let spread = thousandth(if self.rough {
            0.02
        } else {
            recipe.uniform(0.01, 0.02)
        });
        let mut ratios = draw_ratios(&mut recipe, spread);
        if let Some(disc1) = &disc1_draws {
            ratios.extend(disc1.ratios(spread, &mut stream(Purpose::Disc1Ratios)));
        }

        let (natural, top) = match self.rig {
            RigChoice::Dissertation => OtherRig::dissertation_speeds(),
            _ => (
                TAU * draws.frequency,
                TAU * draws.frequency * draws.top_speed,
            ),
        };
        let law_share = if self.share_laws { size } else { 1.0 };
        let laws = draw_laws(
            &effects,
            self.kind.base,
            law_share,
            Speeds { top, natural },
            &mut stream(Purpose::Law(law_index)),
        );
        if !is_sound(&laws.truth, laws.levels) {
            return None;
        }

        // The exponent comes first: the loads depend on it. Every effect takes the same numbers from
        // its stream whatever the scales are.
        let build = |load_power| match self.rig {
            RigChoice::Dissertation => {
                OtherRig::dissertation(draws.drop, laws.levels, load_factor, load_power)
            }
            _ => {
                let torque1 = disc1_draws.map_or(0.0, |disc1| disc1.torque);
                draws.build(laws.levels, load_factor, load_power, hanging, torque1)
            }
        };
        let plain = build((1.0, self.load_reference));
        let exponent = self
            .hide(size, &Scales::of(&plain, 1.0, 0.0), None, recipe.clone())
            .0
            .load_exp;
        let rig = build((exponent, self.load_reference));

        let wants = Wants {
            stop: laws.truth.breakaway() <= 1.01 * laws.levels.sliding,
            backward: effects.contains(&Effect::AsymmetricFriction),
        };
        let layout = match self.rig {
            RigChoice::Dissertation => {
                Layout::dissertation(wants, &mut stream(Purpose::Excitation))
            }
            _ => Layout::draw(rig.period, wants, &mut stream(Purpose::Excitation)),
        };
        let mut tools = stream(Purpose::Instruments);
        let mut instruments = match self.rig {
            RigChoice::Dissertation => Instruments::dissertation(&mut tools),
            _ => rig.draw_instruments(&mut tools),
        };
        instruments = instruments.noisier(self.noise);
        if self.measured.unknown {
            instruments = instruments.unknown_to_all(&mut tools);
        }
        let disc1 = disc1_draws.map(|disc1| disc1.build(&rig, &mut stream(Purpose::Disc1Law)));
        let runs = layout.draw_runs(
            &rig,
            disc1.as_ref().map(|disc1| disc1.middle_load),
            &mut stream(Purpose::Inputs(inputs_index)),
        );
        let longest = runs[..runs.len() - 1]
            .iter()
            .map(|run| run.excitation.voltage.len())
            .max()
            .unwrap_or(1);
        let duration = longest as f64 * layout.interval;
        let scales = Scales::of(&rig, duration, instruments.gearbox_speed);
        let disc1_scales = disc1.as_ref().map(|disc1| disc1.scales(&scales));
        let (mut hidden, hidden_outer) = self.hide(size, &scales, disc1_scales, recipe.clone());
        hidden.load_ref = rig.load_power.1;
        if self.rough {
            hidden.stoch_std = recipe.uniform(0.02, 0.06);
            hidden.stoch_tau = recipe.log_uniform(0.03, 0.3) * rig.period;
        }

        let level = |name: &str| ratios.get(name).copied().unwrap_or(1.0);
        let truth = TrueRig {
            parameters: rig.believed.scaled(&ratios),
            law: laws.truth.with_level(level(FRICTION_LEVEL)),
            effects: hidden,
            disc1: disc1
                .as_ref()
                .map(|disc1| disc1.truth(&ratios, hidden_outer)),
        };
        Some(DrawnCase {
            truth,
            rig,
            laws,
            disc1,
            layout,
            runs,
            instruments,
            size,
            spread,
            ratios,
            seed: self.seed,
            motion: Motion::default(),
        })
    }

    /// The effects on disc D2 (and wherever else) and on disc D1.
    fn hide(
        &self,
        size: f64,
        scales: &Scales,
        disc1_scales: Option<Scales>,
        mut stream: Stream,
    ) -> (Effects, Effects) {
        let (mut hidden, mut hidden_outer) = (Effects::default(), Effects::default());
        for &(effect, on_disc1) in &self.kind.effects {
            match (&disc1_scales, on_disc1) {
                (Some(scales), true) => {
                    effect.put_to_scale(size, scales, &mut stream, &mut hidden_outer);
                }
                _ => effect.put_to_scale(size, scales, &mut stream, &mut hidden),
            }
        }
        (hidden, hidden_outer)
    }

    /// Simulates the runs to learn from with a step `coarser` times the right one and looks at them.
    fn try_out(&self, case: &DrawnCase, coarser: f64) -> Result<Seen, MakerError> {
        let numerics = case.numerics(coarser);
        let mut motions = Vec::new();
        for index in 0..case.runs.len() - 1 {
            let samples = case
                .simulate(index, &numerics)
                .map_err(|error| error.in_case(&self.name))?;
            motions.push(case.look(&samples, &case.runs[index]));
            // One run is enough to see that a law will not do.
            if case.judge(&motions) == Seen::LoopManyValued {
                return Ok(Seen::LoopManyValued);
            }
        }
        Ok(case.judge(&motions))
    }
}

impl DrawnCase {
    /// Step and scales of the simulation; `coarser` 1 is the right one, below 1 the step alone is finer.
    pub fn numerics(&self, coarser: f64) -> Numerics {
        let closes_a_loop = matches!(self.truth.law, ContactLaw::TwoGaussian(_));
        if self.rig.believed == NOMINAL && coarser == 1.0 {
            return DISSERTATION;
        }
        let finer = if closes_a_loop { FINER_FOR_A_LOOP } else { 1.0 };
        self.rig
            .numerics(self.layout.interval, &self.instruments, coarser / finer)
    }

    /// Simulates the run with this index from rest.
    ///
    /// # Errors
    /// The state leaves the finite numbers.
    pub fn simulate(&self, index: usize, numerics: &Numerics) -> Result<Vec<Sample>, MakerError> {
        let noise = Stream::new(self.seed, Purpose::Contact(index as u64));
        Simulator::with_numerics(&self.truth, numerics, State::default(), noise)
            .run(&self.runs[index].excitation)
    }
}

impl Case for OtherCase {
    fn name(&self) -> &str {
        &self.name
    }

    fn make(&self) -> Result<MadeCase, MakerError> {
        let case = self.draw()?;
        let numerics = case.numerics(1.0);
        let mut files = vec![("model.toml".to_owned(), model_toml(&case))];
        let reads_current = self.measured.sensors.has("i");
        let sensors = case.instruments.toml(reads_current);
        let assumed = self.rig == RigChoice::Dissertation && self.noise == 1.0 && !reads_current;
        if !self.measured.unknown && !assumed {
            files.push(("sensors.toml".to_owned(), sensors.clone()));
        }
        for (index, run) in case.runs.iter().enumerate() {
            let samples = case
                .simulate(index, &numerics)
                .map_err(|error| error.in_case(&self.name))?;
            let recording = Recording {
                excitation: &run.excitation,
                samples: &samples,
                effects: &case.truth.effects,
                disc1_effects: case.truth.disc1.as_ref().map(|disc1| &disc1.effects),
                instruments: &case.instruments,
                sensors: self.measured.sensors,
                interval: case.layout.interval,
                voltage_step: voltage_step(&case.rig),
            };
            let mut stream = Stream::new(self.seed, Purpose::Sensors(index as u64));
            files.push((run.file.to_owned(), recording.csv(&mut stream)));
        }
        Ok(MadeCase {
            files,
            true_sensors: self.measured.unknown.then_some(sensors),
            answer: self.answer(&case),
        })
    }
}

impl OtherCase {
    fn answer(&self, case: &DrawnCase) -> Answer {
        let disc1_effects = case
            .truth
            .disc1
            .as_ref()
            .map(|disc1| disc1.effects.answers());
        let effects = case
            .truth
            .effects
            .answers()
            .into_iter()
            .filter(|(name, _)| name != "load_ref" || case.truth.effects.load_exp != 1.0)
            .chain(disc1_effects.into_iter().flatten())
            .collect();
        let place = |&(effect, on_disc1): &(Effect, bool)| {
            let disc = if on_disc1 { "disc1" } else { "disc2" };
            (effect.name().to_owned(), disc.to_owned())
        };
        let mut places: BTreeMap<String, String> = match self.rig {
            RigChoice::Full => self.kind.effects.iter().map(place).collect(),
            _ => BTreeMap::new(),
        };
        let one = places.len() == 1;
        let place = one.then(|| places.pop_first().map(|(_, place)| place));
        let law_name = |law: &ContactLaw| law.name().to_owned();
        Answer {
            kind: self.kind.name.clone(),
            rough: case.truth.effects.stoch_std,
            seed: self.seed,
            scale: case.size,
            spread: case.spread,
            base: law_name(&case.laws.believed),
            truth: law_name(&case.laws.truth),
            effects,
            parameter_ratio: case.ratios.clone(),
            place: place.flatten(),
            places,
            sensors: self.measured.unknown.then(|| case.instruments.answers()),
            facts: facts(case),
        }
    }
}

/// `value` to a thousandth.
fn thousandth(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}
