//! Hypotheses that replace the analyst's friction law by another one.

use std::convert::Infallible;

use super::push;
use crate::hypothesis::{Free, Hypothesis};
use crate::law_start::{self, Scatter};
use crate::numbers::{NARROW, USUAL};
use crate::scales::Scales;
use stickslip::friction::{CoulombStiction, Law, Stribeck, TwoGaussianMu};

pub(super) fn stiction(base: &Hypothesis, scatter: Option<&Scatter>) -> Vec<Hypothesis> {
    let Law::Coulomb(law) = base.rig.law else {
        return Vec::new();
    };
    let mu_c = base.value("contact.mu_c").unwrap_or(law.mu_c);
    let near = 1.03 * mu_c;
    // What cannot be seen to let go may do so anywhere above.
    let unseen = || vec![1.15 * mu_c, 1.5 * mu_c];
    let further = scatter.map(|s| s.breakaway.map_or_else(unseen, |shown| vec![shown]));
    std::iter::once(near)
        .chain(further.into_iter().flatten().filter(|mu_s| *mu_s > near))
        .map(|mu_s| {
            let mut h = base.clone();
            h.rig.law = Law::CoulombStiction(CoulombStiction {
                mu_c: law.mu_c,
                mu_s,
            });
            let of = (law.mu_c, 0.5 * law.mu_c);
            push(&mut h, "contact", "mu_s", of, (0.0, 10.0 * law.mu_c), mu_s);
            h
        })
        .collect()
}

pub(super) fn stribeck(
    base: &Hypothesis,
    scales: &Scales,
    scatter: Option<&Scatter>,
) -> Vec<Hypothesis> {
    let (mu_c, mu_s) = match base.rig.law {
        Law::Coulomb(law) => (law.mu_c, 1.3 * law.mu_c),
        Law::CoulombStiction(law) => (law.mu_c, law.mu_s),
        _ => return Vec::new(),
    };
    let mut starts = vec![[mu_c, mu_s, 0.2 * scales.speed]];
    if let Some(scatter) = scatter {
        starts.extend([0.06, 0.6].map(|share| [mu_c, mu_s, share * scales.speed]));
        starts.extend(law_start::stribeck(scatter, scales));
    }
    starts
        .into_iter()
        .map(|[start_c, start_s, omega_s]| {
            let mut h = without_law(base);
            let start_s = start_s.max(1.02 * start_c);
            h.rig.law = Law::Stribeck(Stribeck {
                mu_c: start_c,
                mu_s: start_s,
                omega_s,
            });
            let range = (0.01 * mu_c, 10.0 * mu_c);
            push(
                &mut h,
                "contact",
                "mu_c",
                (mu_c, USUAL * mu_c),
                range,
                start_c,
            );
            push(
                &mut h,
                "contact",
                "mu_s",
                (mu_s, 0.5 * mu_c),
                range,
                start_s,
            );
            let speed = scales.speed;
            let of = (0.2 * speed, USUAL * speed);
            let range = (NARROW * speed, 3.0 * speed);
            push(&mut h, "contact", "omega_s", of, range, omega_s);
            h
        })
        .collect()
}

/// The keys of Eq. 6-2 in their order.
const HYSTERESIS_KEYS: [&str; 8] = [
    "a1",
    "b1",
    "c1",
    "a2",
    "b2",
    "c2",
    "omega_centre",
    "acceleration_semi_axis",
];

pub(super) fn hysteresis(
    base: &Hypothesis,
    scales: &Scales,
    scatter: Option<&Scatter>,
) -> Vec<Hypothesis> {
    let level = match base.rig.law {
        Law::Coulomb(law) => law.mu_c,
        Law::CoulombStiction(law) => law.mu_c,
        Law::Stribeck(law) => law.mu_c,
        Law::Karnopp(law) => law.mu_c,
        Law::Switch(law) => law.mu_c,
        Law::Wojewoda(_) | Law::TwoGaussianTorque(_) | Law::TwoGaussianMu(_) => return Vec::new(),
    };
    let Some(scatter) = scatter else {
        return Vec::new();
    };
    let (speed, acceleration) = (scales.speed, scales.acceleration);
    // Prior: centre, standard deviation, smallest and largest value.
    let priors = [
        (level, level, -20.0 * level, 20.0 * level),
        (-1.5, 1.5, -6.0, 6.0),
        (1.5, 1.0, 0.15, 12.0),
        (level, level, -20.0 * level, 20.0 * level),
        (1.5, 1.5, -6.0, 6.0),
        (1.5, 1.0, 0.15, 12.0),
        (0.6 * speed, 0.5 * speed, 0.05 * speed, 5.0 * speed),
        (
            acceleration,
            acceleration,
            0.05 * acceleration,
            20.0 * acceleration,
        ),
    ];
    law_start::hysteresis(scatter, scales)
        .into_iter()
        .filter_map(|values| {
            let mut h = without_law(base);
            let mut next = values.iter();
            let law = TwoGaussianMu::from_values(|_| {
                Ok::<f64, Infallible>(next.next().copied().unwrap_or(1.0))
            });
            let Ok(law) = law;
            h.rig.law = Law::TwoGaussianMu(law);
            h.rig.check().ok()?;
            for ((key, (origin, scale, low, high)), value) in
                HYSTERESIS_KEYS.iter().zip(priors).zip(values)
            {
                push(&mut h, "contact", key, (origin, scale), (low, high), value);
            }
            Some(h)
        })
        .collect()
}

/// Takes the friction law's numbers out of what is free.
fn without_law(base: &Hypothesis) -> Hypothesis {
    let mut h = base.clone();
    let (mut x, mut free, mut at) = (Vec::new(), Vec::new(), 0);
    for f in &base.free {
        let is_law = matches!(f, Free::Nominal { name, .. } | Free::Value { name, .. } if name.starts_with("contact."));
        if !is_law {
            free.push(f.clone());
            x.extend_from_slice(&base.x[at..at + f.width()]);
        }
        at += f.width();
    }
    h.free = free;
    h.x = x;
    h
}
