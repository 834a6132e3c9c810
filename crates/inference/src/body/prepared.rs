//! A record with measured force, filtered and thinned for comparison with the force that a model needs.

use std::sync::Arc;

use super::eccentricity::Eccentricity;
use super::filter::LowPass;
use super::model::{AT_ONCE, Model};
use super::motion::{Measurement, Motion};
use super::series::{Key, Memory, Series};
use super::shift::{between, turned};
use super::term::{Formula, Pursued, Sample};

/// Order of the low-pass that both forces go through.
const ORDER: usize = 8;

/// A record, prepared for comparison.
#[derive(Debug, Clone)]
pub struct Prepared {
    motion: Motion,
    filter: Option<LowPass>,
    stride: usize,
    /// Compared moments in a period of the lowest cut-off.
    reach: usize,
    edge: usize,
    /// Which of the thinned moments say something.
    kept: Vec<usize>,
    /// Every moment as it was read: what most models are asked about.
    read: Vec<Sample>,
    /// The measured force after the low-pass.
    passed: Vec<f64>,
    memory: Arc<Memory>,
}

impl Prepared {
    /// Prepares a record.
    #[must_use]
    pub fn new(motion: &Motion, measurement: &Measurement) -> Self {
        let stride = (1.0 / (measurement.compare_rate * motion.interval))
            .round()
            .max(1.0) as usize;
        let compared_below = motion.cut_off.or(measurement.compare_low_pass);
        let filter = compared_below.map(|cut_off| LowPass::new(cut_off, ORDER, motion.interval));
        let interval = motion.interval * stride as f64;
        let lowest = compared_below
            .unwrap_or(0.5 / interval)
            .min(measurement.motion_low_pass);
        let mut prepared = Self {
            motion: motion.clone(),
            filter,
            stride,
            reach: (1.0 / (lowest * interval)).ceil() as usize,
            edge: (measurement.edge / motion.interval).round() as usize,
            kept: Vec::new(),
            read: Vec::new(),
            passed: Vec::new(),
            memory: Arc::default(),
        };
        prepared.kept = prepared.moving();
        prepared.read = (0..motion.len())
            .map(|at| prepared.sample(at, motion.load[at]))
            .collect();
        prepared.passed = prepared.passed(&motion.force);
        prepared
    }

    /// Whether every moment says something.
    fn is_whole(&self) -> bool {
        !self.motion.tells.contains(&false)
    }

    /// The record.
    #[must_use]
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Number of compared moments.
    #[must_use]
    pub fn count(&self) -> usize {
        self.kept.len()
    }

    /// Time between compared moments [s].
    #[must_use]
    pub fn interval(&self) -> f64 {
        self.motion.interval * self.stride as f64
    }

    /// How residuals go on: their products with those so many compared moments later, up to a period of the lowest cut-off, and how many
    /// products each sum has. Noise that the filters pass turns its sign within that time.
    #[must_use]
    pub fn products(&self, residuals: &[f64]) -> Vec<(f64, usize)> {
        (0..=self.reach)
            .map(|later| {
                let of = |(at, own): (usize, &f64)| {
                    let other = self.kept[at..]
                        .binary_search(&(self.kept[at] + later))
                        .ok()?;
                    Some(own * residuals[at + other])
                };
                let products = residuals.iter().enumerate().filter_map(of);
                products.fold((0.0, 0), |(sum, count), own| (sum + own, count + 1))
            })
            .collect()
    }

    /// A compared moment.
    #[must_use]
    pub fn moment(&self, at: usize) -> Sample {
        self.read[self.edge + self.kept[at] * self.stride]
    }

    /// A series after the low-pass, at the moments that are compared.
    fn thinned(&self, series: &[f64]) -> Vec<f64> {
        let known;
        let mut series = series;
        if !self.is_whole() {
            // The filter would spread what friction takes at rest, which nobody knows, over the moments beside.
            let pairs = series.iter().zip(&self.motion.tells);
            known = pairs
                .map(|(value, tells)| if *tells { *value } else { 0.0 })
                .collect::<Vec<f64>>();
            series = &known;
        }
        let series = self.passed(series);
        let at = |kept: &usize| series[self.edge + kept * self.stride];
        self.kept.iter().map(at).collect()
    }

    /// A series after the low-pass, if there is one.
    fn passed(&self, series: &[f64]) -> Vec<f64> {
        let filter = self.filter.as_ref();
        filter.map_or_else(|| series.to_vec(), |own| own.apply(series))
    }

    /// The moments to compare: not at the edges, every so many samples, and where the force that an FMU lacks is known.
    fn moving(&self) -> Vec<usize> {
        let count = self.motion.len().saturating_sub(2 * self.edge);
        let tells = |kept: &usize| self.motion.tells[self.edge + kept * self.stride];
        (0..count.div_ceil(self.stride)).filter(tells).collect()
    }

    /// The motion at sample `at`, under this load.
    fn sample(&self, at: usize, load: f64) -> Sample {
        let motion = &self.motion;
        Sample {
            time: motion.begin + at as f64 * motion.interval,
            position: motion.position[at],
            velocity: motion.velocity[at],
            acceleration: motion.acceleration[at],
            direction: motion.direction[at],
            load,
            predicted: motion.predicted[at],
            voltage: motion.voltage[at],
            connected: motion.connected[at],
            driving: motion.driving[at],
            port: motion.port,
            motor: 0.0,
        }
    }

    /// Inertia that the port of an FMU shows with a model; `None` of the other kinds.
    fn inertia(&self, model: &Model) -> Option<f64> {
        let (pursuit, base) = (self.motion.pursuit.as_ref()?, model.terms().first()?);
        let moved = base
            .values
            .iter()
            .zip(&pursuit.at)
            .zip(&pursuit.inertia_slopes);
        let more: f64 = moved.map(|((value, at), slope)| (value - at) * slope).sum();
        let still = Sample {
            port: self.motion.port,
            ..Sample::default()
        };
        let accelerated = Sample {
            acceleration: 1.0,
            ..still
        };
        let added = model.force(&accelerated) - model.force(&still);
        Some(pursuit.inertia + more + added)
    }

    /// The port's inertia of the FMU over that of a model. Noise is that of the motion, which the inertia makes a
    /// force: without it the lightest plant would be the best, since it leaves no force at all.
    #[must_use]
    pub fn lightness(&self, model: &Model) -> f64 {
        match (&self.motion.pursuit, self.inertia(model)) {
            (Some(pursuit), Some(inertia)) if inertia > 0.0 => pursuit.inertia / inertia,
            (Some(_), Some(_)) => f64::NAN,
            _ => 1.0,
        }
    }

    /// Share by which that grows with a number in which the model is linear.
    #[must_use]
    pub fn lighter(&self, model: &Model, (term, number): (usize, usize)) -> f64 {
        let Some(inertia) = self.inertia(model) else {
            return 0.0;
        };
        let mut moved = model.clone();
        moved.set(term, number, model.value(term, number) + 1.0);
        self.inertia(&moved)
            .map_or(0.0, |heavier| (inertia - heavier) / inertia)
    }

    /// Measured force at the compared moments of a motion that was read as the model says.
    #[must_use]
    pub fn measured(&self, model: &Model) -> Vec<f64> {
        let earlier = self.earlier(model);
        if earlier != 0.0 && self.is_whole() && self.filter.is_some() {
            let first = self.edge as f64 - earlier;
            return between(&self.passed, first, self.stride, self.count());
        }
        self.of_record(earlier, ("measured", 0), &self.motion.force)
    }

    /// The force that a model needs, at the compared moments.
    #[must_use]
    pub fn force(&self, model: &Model) -> Vec<f64> {
        let mut sum = vec![0.0; self.count()];
        for at in model.acting(self.motion.port) {
            let term = &model.terms()[at];
            let series = self.of_term(model, at);
            if let Some(constant) = &series.constant {
                add(&mut sum, constant, 1.0);
            }
            for (number, slope) in term.entry.linear().into_iter().zip(&series.slopes) {
                add(&mut sum, slope, term.values[number]);
            }
        }
        if model.kind.runs_alone() {
            add(&mut sum, &self.acceleration(model).slopes[0], 1.0);
        }
        if let Some(pursuit) = &self.motion.pursuit {
            let earlier = self.earlier(model);
            let later = self.later(model);
            for (at, (later, series)) in later.iter().zip(&pursuit.delayed).enumerate() {
                add(
                    &mut sum,
                    &self.of_record(earlier, ("delayed", at), series),
                    *later,
                );
            }
        }
        sum
    }

    /// What one more of a number adds to that force: the one at this place among those in which the term is linear.
    #[must_use]
    pub fn slope(&self, model: &Model, at: usize, place: usize) -> Vec<f64> {
        self.of_term(model, at).slopes[place].clone()
    }

    /// By how much later a model has the motion at each port read than the record has it [s].
    fn later(&self, model: &Model) -> Vec<f64> {
        match &self.motion.pursuit {
            Some(pursuit) => {
                let delays = pursuit.at_delays.iter().enumerate();
                delays
                    .map(|(at, found_at)| model.delay(at) - found_at)
                    .collect()
            }
            None => vec![model.delay(self.motion.port)],
        }
    }

    /// By how many samples earlier the force and the load were read that go with a motion: its own reading lags behind.
    fn earlier(&self, model: &Model) -> f64 {
        let later = self.later(model).get(self.motion.port).copied();
        later.map_or(0.0, |own| own / self.motion.interval)
    }

    /// A series of the record at the compared moments.
    fn of_record(
        &self,
        earlier: f64,
        (name, number): (&'static str, usize),
        series: &[f64],
    ) -> Vec<f64> {
        let key = Key {
            term: name,
            bits: vec![number as u64, earlier.to_bits()],
        };
        let own = self.memory.get(key, || Series {
            constant: None,
            slopes: vec![self.thinned(&self.moved(series, earlier))],
        });
        own.slopes[0].clone()
    }

    /// Acceleration at the compared moments.
    fn acceleration(&self, model: &Model) -> Arc<Series> {
        let read = Reading {
            earlier: 0.0,
            encoder: model.eccentricity(),
        };
        let key = Key {
            term: "acceleration",
            bits: read.bits(),
        };
        self.memory.get(key, || {
            let mut series = Vec::with_capacity(self.read.len());
            self.each_block(&read, |samples| {
                series.extend(samples.iter().map(|sample| sample.acceleration));
            });
            Series {
                constant: None,
                slopes: vec![self.thinned(&series)],
            }
        })
    }

    /// What a term gives to the force.
    fn of_term(&self, model: &Model, at: usize) -> Arc<Series> {
        let term = &model.terms()[at];
        let is_pursued = matches!(term.entry.formula, Formula::Pursued(_));
        let read = Reading {
            earlier: match is_pursued || model.depends_on_load(at) {
                true => self.earlier(model),
                false => 0.0,
            },
            encoder: model.eccentricity(),
        };
        let linear = term.entry.linear();
        let shapes = (0..term.values.len()).filter(|number| !linear.contains(number));
        let mut bits = read.bits();
        bits.extend(shapes.map(|number| term.values[number].to_bits()));
        bits.extend(model.context(at).into_iter().map(f64::to_bits));
        let key = Key {
            term: term.entry.name,
            bits,
        };
        self.memory.get(key, || {
            let (constant, slopes) = match term.entry.formula {
                Formula::Pursued(what) => self.pursued(what, read.earlier),
                _ => self.forces(model, at, &read),
            };
            let is_nothing = constant.iter().all(|own| *own == 0.0);
            Series {
                slopes: slopes.iter().map(|own| self.thinned(own)).collect(),
                constant: (!is_nothing).then(|| self.thinned(&constant)),
            }
        })
    }

    /// A term's force at every moment with its linear numbers at zero, and what one more of each adds.
    fn forces(&self, model: &Model, at: usize, read: &Reading) -> (Vec<f64>, Vec<Vec<f64>>) {
        let term = &model.terms()[at];
        let linear = term.entry.linear();
        let mut nothing = term.values.clone();
        for number in &linear {
            nothing[*number] = 0.0;
        }
        let one_of = |number: &usize| {
            let mut one = nothing.clone();
            one[*number] = 1.0;
            one
        };
        let numbers = linear.iter().map(one_of).chain([nothing.clone()]);
        let numbers: Vec<Vec<f64>> = numbers.collect();
        let mut series = vec![Vec::with_capacity(self.read.len()); numbers.len()];
        self.each_block(read, |samples| {
            model.add_forces_of(at, &numbers, samples, &mut series);
        });
        let constant = series.pop().unwrap_or_default();
        for own in &mut series {
            for (own, constant) in own.iter_mut().zip(&constant) {
                *own -= constant;
            }
        }
        (constant, series)
    }

    /// The same of what stands in the record of an FMU.
    fn pursued(&self, what: Pursued, earlier: f64) -> (Vec<f64>, Vec<Vec<f64>>) {
        let Some(pursuit) = &self.motion.pursuit else {
            return (Vec::new(), Vec::new());
        };
        let (constant, slopes) = match what {
            Pursued::Parameters => {
                let nominal = pursuit.nominal.iter().map(|own| -own);
                (nominal.collect(), pursuit.slopes.clone())
            }
            Pursued::Drift(number) => {
                let value = pursuit.at[number];
                let grown = |(at, slope): (usize, &f64)| {
                    let time = self.motion.begin + at as f64 * self.motion.interval;
                    slope * value * time / 60.0
                };
                let slopes = pursuit.slopes[number].iter().enumerate();
                (Vec::new(), vec![slopes.map(grown).collect()])
            }
            Pursued::Offset(number) => (Vec::new(), vec![pursuit.offsets[number].clone()]),
        };
        let moved = |series: &Vec<f64>| self.moved(series, earlier);
        (moved(&constant), slopes.iter().map(moved).collect())
    }

    /// A series as it was so many samples earlier.
    fn moved(&self, series: &[f64], earlier: f64) -> Vec<f64> {
        match self.filter {
            _ if earlier == 0.0 || series.is_empty() => series.to_vec(),
            Some(_) => between(series, -earlier, 1, series.len()),
            None => turned(series, earlier),
        }
    }

    /// Every moment as it is read, block by block.
    fn each_block(&self, read: &Reading, of: impl FnMut(&[Sample])) {
        if read.earlier == 0.0 && read.encoder.is_none() {
            self.read.chunks(AT_ONCE).for_each(of);
            return;
        }
        let load = self.moved(&self.motion.load, read.earlier);
        let samples: Vec<Sample> = load
            .into_iter()
            .enumerate()
            .map(|(at, load)| {
                let own = self.sample(at, load);
                read.encoder.map_or(own, |encoder| encoder.motion(&own))
            })
            .collect();
        samples.chunks(AT_ONCE).for_each(of);
    }
}

/// How the motion is read, and the load that goes with it.
struct Reading {
    /// Samples by which the load was read earlier.
    earlier: f64,
    encoder: Option<Eccentricity>,
}

impl Reading {
    fn bits(&self) -> Vec<u64> {
        let encoder = self.encoder.iter().flat_map(|own| [own.cosine, own.sine]);
        let all = [self.earlier].into_iter().chain(encoder);
        all.map(f64::to_bits).collect()
    }
}

fn add(sum: &mut [f64], series: &[f64], times: f64) {
    for (sum, value) in sum.iter_mut().zip(series) {
        *sum += times * value;
    }
}
