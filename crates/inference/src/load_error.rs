//! What the load cell's noise leaves open: each level of the normal force is known no better than its noise lets the mean of so many
//! samples be, and that error is the same in all windows of the level. Friction is in proportion to it.

use std::collections::BTreeMap;

use nalgebra::DVector;

use crate::data::FOLDS;
use crate::loss::weight;
use crate::marginal::Reduced;
use crate::record::Run;
use crate::window::Window;

/// A level of the normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadLevel {
    /// Which record.
    pub run: usize,
    /// First sample.
    pub first: usize,
    /// Standard deviation of its error in one fold of its windows, relative to it: that of the mean of all folds is what the load
    /// cell's noise leaves.
    pub deviation: f64,
}

impl LoadLevel {
    /// The level at a sample of a record; `None` where the force changes from sample to sample or is known exactly.
    #[must_use]
    pub fn at(number: usize, run: &Run, sample: usize) -> Option<Self> {
        let force = run.normal_force.get(sample).copied()?;
        let before = run.normal_force[..sample].iter().rev();
        let behind = run.normal_force[sample..].iter();
        let first = sample - before.take_while(|own| **own == force).count();
        let samples = sample - first + behind.take_while(|own| **own == force).count();
        let of_mean = run.load_deviations[0] / (samples as f64).sqrt() / force;
        let deviation = of_mean * (FOLDS as f64).sqrt();
        let is_level = samples > 1 && force > 0.0 && deviation > 0.0;
        is_level.then_some(Self {
            run: number,
            first,
            deviation,
        })
    }
}

/// Quadratic form of a level's error, in standard deviations, that is left of one window.
#[derive(Clone, Debug)]
pub struct LoadError {
    /// Curvature with respect to it.
    pub curvature: f64,
    /// Descent direction: derivative of −½ × the form.
    pub gradient: f64,
    /// Mixed curvature with the free numbers.
    pub cross: DVector<f64>,
}

/// Integrates the errors of all levels out, one for each fold of a level, so that no fold knows of the other.
///
/// What that changes is shared among the windows of a level, so that sums over them are exact. The loss counts it beside the
/// residuals: a window that is far off for another reason is weighed by all that it leaves.
pub(crate) fn integrate_out(
    windows: &[Window],
    folds: &[usize],
    forms: &mut [Option<Reduced>],
    errors: &[Option<LoadError>],
) {
    let mut levels: BTreeMap<(usize, usize, usize), Vec<usize>> = BTreeMap::new();
    for (j, window) in windows.iter().enumerate() {
        if let (Some(level), Some(_), Some(_)) = (window.load, &forms[j], &errors[j]) {
            let level = (level.run, level.first, folds[j]);
            levels.entry(level).or_default().push(j);
        }
    }
    for members in levels.into_values() {
        let of = |j: usize| forms[j].as_ref().zip(errors[j].as_ref());
        let (mut curvature, mut gradient, mut cross) = (1.0, 0.0, None);
        for (form, error) in members.iter().filter_map(|&j| of(j)) {
            let weight = weight(form.square, form.residuals);
            curvature += weight * error.curvature;
            gradient += weight * error.gradient;
            let own = &error.cross * weight;
            cross = Some(cross.map_or(own.clone(), |sum: DVector<f64>| sum + own));
        }
        let Some(cross) = cross else { continue };
        let best = gradient / curvature;
        for &j in &members {
            let (Some(form), Some(error)) = (&mut forms[j], &errors[j]) else {
                continue;
            };
            let explained = best * (2.0 * error.gradient - best * error.curvature);
            form.left = (form.square - explained).max(0.0);
            let gained = weight(form.square, form.residuals) * error.gradient * best;
            form.log_determinant += curvature.ln() / members.len() as f64 - gained;
            let mixed = &error.cross * cross.transpose() / (2.0 * curvature);
            form.curvature -= &mixed + mixed.transpose();
            form.gradient -= (&error.cross * best + &cross * (error.gradient / curvature)) * 0.5;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gram::{Gram, Pieces, Place};
    use crate::loss::normal_equations;
    use crate::marginal::{Disturbance, load_direction, reduce};
    use crate::random::Random;
    use crate::structure::augment;
    use crate::window::STARTS;
    use nalgebra::DMatrix;
    use stickslip::plant::STATES;

    const DEVIATION: f64 = 0.03;
    const FREE: usize = 2;

    /// A window of two start components, two pieces and two free numbers, with residuals too small for a noise of its own.
    fn gram(random: &mut Random) -> Gram {
        let place = |friction: f64| Place {
            time: 0.0,
            speed: 1.0,
            acceleration: 0.0,
            alpha: 0.0,
            disc_angle: 0.0,
            gear_angle: 0.0,
            gear_speed: 0.0,
            twist: 0.0,
            normal_force: 1.0,
            current: 0.0,
            friction,
            sliding: true,
        };
        let rows = DMatrix::from_fn(40, 7, |_, _| 0.5 * random.normal());
        Gram {
            products: rows.transpose() * rows,
            starts: 2,
            pieces: 2,
            divided: Pieces {
                length: 0.5,
                on_motor: false,
            },
            residuals: 40,
            places: vec![place(0.8), place(1.1)],
            end: [0.0; STATES],
        }
    }

    fn window(load: Option<LoadLevel>) -> Window {
        Window {
            run: 0,
            first: 0,
            last: 40,
            anchor: [0.0; STATES],
            accelerations: [0.0; 2],
            deviations: [1.0; STARTS],
            load,
        }
    }

    #[test]
    fn an_error_that_windows_share_is_a_free_number_integrated_out() {
        let mut random = Random::new(1);
        let grams: Vec<Gram> = (0..3).map(|_| gram(&mut random)).collect();
        let fluctuating = Disturbance {
            relative: 0.05,
            ..Disturbance::NONE
        };
        let offset = [0.1; STARTS];
        let whole = |gram: &Gram, deviation: f64| {
            reduce(gram, &offset, &[1.0; STARTS], &fluctuating, deviation).unwrap()
        };
        let level = LoadLevel {
            run: 0,
            first: 0,
            deviation: DEVIATION,
        };
        let windows: Vec<Window> = grams.iter().map(|_| window(Some(level))).collect();
        let (mut forms, errors): (Vec<_>, Vec<_>) = grams
            .iter()
            .map(|gram| {
                let (form, error) = whole(gram, DEVIATION);
                (Some(form), Some(error))
            })
            .unzip();
        integrate_out(&windows, &[0; 3], &mut forms, &errors);
        let (curvature, gradient) =
            normal_equations(forms.iter().flatten(), &[0.0; FREE], &[0.0; FREE]);

        let explicit: Vec<Reduced> = grams
            .iter()
            .map(|gram| {
                let with = augment(gram, |place| vec![(-DEVIATION * place.friction, 0.0)]);
                whole(&with, 0.0).0
            })
            .collect();
        let (all, pull) = normal_equations(explicit.iter(), &[0.0, 0.0, 1.0], &[0.0; FREE + 1]);
        let own = all[(FREE, FREE)];
        let cross = all.view((0, FREE), (FREE, 1)).clone_owned();
        let left = all.view((0, 0), (FREE, FREE)) - &cross * cross.transpose() / own;
        let pulled = pull.rows(0, FREE) - cross.column(0) * (pull[FREE] / own);
        assert!((curvature - left).norm() < 1e-10);
        assert!((gradient - pulled).norm() < 1e-10);

        let loss = |form: &Reduced| form.square + form.log_determinant;
        let integrated: f64 = forms.iter().flatten().map(loss).sum();
        let expected: f64 =
            explicit.iter().map(loss).sum::<f64>() + own.ln() - pull[FREE] * pull[FREE] / own;
        assert!((integrated - expected).abs() < 1e-10);
    }

    #[test]
    fn windows_are_left_without_what_the_error_of_their_level_explains() {
        let mut random = Random::new(2);
        let level = LoadLevel {
            run: 0,
            first: 0,
            deviation: DEVIATION,
        };
        let windows: Vec<Window> = (0..6).map(|_| window(Some(level))).collect();
        let (mut forms, errors): (Vec<_>, Vec<_>) = windows
            .iter()
            .map(|_| {
                let mut gram = gram(&mut random);
                // What the windows leave is that error's, and many times their noise.
                let slope = 400.0;
                gram.products *= slope * slope;
                let residual = gram.residual();
                let direction = load_direction(&gram, 1.5 * DEVIATION);
                let mut on_error = &gram.products * &direction;
                on_error[residual] = on_error.dot(&direction);
                gram.products.set_column(residual, &on_error);
                gram.products.set_row(residual, &on_error.transpose());
                let starts = [1.0; STARTS];
                let none = Disturbance::NONE;
                let (form, error) =
                    reduce(&gram, &[0.0; STARTS], &starts, &none, DEVIATION).unwrap();
                assert!(form.square > 2.0 * form.residuals as f64);
                (Some(form), Some(error))
            })
            .unzip();
        integrate_out(&windows, &[0; 6], &mut forms, &errors);
        for form in forms.iter().flatten() {
            assert!(form.left < 0.1 * form.residuals as f64, "{}", form.left);
        }
    }

    #[test]
    fn a_level_is_known_as_well_as_its_mean() {
        let mut normal_force = vec![10.0; 25];
        normal_force.extend([30.0; 100]);
        normal_force.extend([0.0; 10]);
        let run = Run {
            name: "stairs".to_owned(),
            time: Vec::new(),
            voltage: Vec::new(),
            normal_force,
            normal_force_1: Vec::new(),
            load_deviations: [0.2, 0.0],
            readings: Default::default(),
            traces: crate::trace::Traces::default(),
        };
        let level = LoadLevel::at(3, &run, 60).unwrap();
        assert_eq!((level.run, level.first), (3, 25));
        assert!((level.deviation / 2_f64.sqrt() - 0.02 / 30.0).abs() < 1e-15);
        assert_eq!(LoadLevel::at(3, &run, 130), None);
    }
}
