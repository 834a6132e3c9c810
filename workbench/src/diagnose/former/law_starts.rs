//! From where fits start that replace the friction law.

use std::convert::Infallible;

use stickslip::friction::{CoulombStiction, Law, Stribeck, TwoGaussianMu};

use super::hypothesis::{Free, Hypothesis};

/// Parameter sets of Eq. 6-2 from which fits start, for a friction coefficient of about 0.15.
const HYSTERESIS_STARTS: [[f64; 8]; 2] = [
    [
        0.271_15, -3.072_46, 1.289_46, 0.185_67, 0.479_60, 2.623_03, 7.159_56, 58.287_3,
    ],
    [
        0.488_6, -1.935_1, 0.556_3, 0.105_2, 2.349_0, 2.518_1, 6.902_4, 37.769,
    ],
];

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

const HYSTERESIS_SCALES: [f64; 8] = [0.2, 1.0, 1.0, 0.2, 1.0, 1.0, 6.0, 50.0];

/// Breakaway above the base's sliding friction.
pub fn stiction(base: &Hypothesis) -> Vec<Hypothesis> {
    let sliding = base.rig.parameter("contact.mu_c");
    [1.02, 1.1, 1.5]
        .iter()
        .filter_map(|ratio| stiction_at(base, ratio * sliding?))
        .collect()
}

/// Breakaway at `mu_s` above the base's sliding friction; `None` where its law is not Coulomb's.
pub fn stiction_at(base: &Hypothesis, mu_s: f64) -> Option<Hypothesis> {
    let Law::Coulomb(law) = base.rig.law else {
        return None;
    };
    let mut h = base.clone();
    h.rig.law = Law::CoulombStiction(CoulombStiction {
        mu_c: law.mu_c,
        mu_s,
    });
    push_value(&mut h, "mu_s", 0.1, (0.0, 2.0), mu_s);
    Some(h)
}

/// Sliding friction that falls with speed, in place of the base's.
pub fn stribeck(base: &Hypothesis) -> Vec<Hypothesis> {
    let (mu_c, mu_s, less) = match base.rig.law {
        Law::Coulomb(law) => (law.mu_c, 1.3 * law.mu_c, 1.03 * law.mu_c),
        Law::CoulombStiction(law) => (law.mu_c, law.mu_s, law.mu_s),
        _ => return Vec::new(),
    };
    [(0.5, mu_s), (1.5, mu_s), (4.0, mu_s), (1.5, less)]
        .into_iter()
        .map(|(omega_s, mu_s)| {
            let mut h = without_law(base);
            // What the base takes for sliding friction is between the two.
            let mu_c = mu_c - 0.2 * (mu_s - mu_c).max(0.0);
            h.rig.law = Law::Stribeck(Stribeck {
                mu_c,
                mu_s,
                omega_s,
            });
            push_value(&mut h, "mu_c", 0.1, (0.0, 2.0), mu_c);
            push_value(&mut h, "mu_s", 0.1, (0.0, 2.0), mu_s);
            push_value(&mut h, "omega_s", 1.0, (0.05, 20.0), omega_s);
            h
        })
        .collect()
}

/// Eq. 6-2 at the base's level of sliding friction.
pub fn hysteresis(base: &Hypothesis) -> Vec<Hypothesis> {
    let level = match base.rig.law {
        Law::Coulomb(law) => law.mu_c,
        Law::CoulombStiction(law) => law.mu_c,
        Law::Stribeck(law) => law.mu_c,
        Law::Karnopp(law) => law.mu_c,
        Law::Switch(law) => law.mu_c,
        Law::Wojewoda(_) | Law::TwoGaussianTorque(_) | Law::TwoGaussianMu(_) => return Vec::new(),
    };
    // The published sets belong to a sliding level of about 0.12.
    let scaled = HYSTERESIS_STARTS.iter().flat_map(|start| {
        [0.72, 0.8, 0.87, 0.93, 1.0, 1.07, 1.15, 1.25].map(|factor| (start, factor * level / 0.12))
    });
    scaled
        .map(|(start, factor)| {
            let mut h = without_law(base);
            let mut values = *start;
            values[0] *= factor;
            values[3] *= factor;
            let mut next = values.iter();
            let Ok(law) = TwoGaussianMu::from_values(|_| {
                Ok::<f64, Infallible>(next.next().copied().unwrap_or(1.0))
            });
            h.rig.law = Law::TwoGaussianMu(law);
            for ((key, scale), value) in HYSTERESIS_KEYS.iter().zip(HYSTERESIS_SCALES).zip(values) {
                let range = match *key {
                    "a1" | "a2" => (-1.0, 2.0),
                    "b1" | "b2" => (-6.0, 6.0),
                    "c1" | "c2" => (0.15, 12.0),
                    "omega_centre" => (0.5, 40.0),
                    _ => (3.0, 600.0),
                };
                push_value(&mut h, key, scale, range, value);
            }
            h
        })
        .collect()
}

/// Takes the friction law's numbers out of what is free.
fn without_law(base: &Hypothesis) -> Hypothesis {
    let mut h = base.clone();
    let mut x = Vec::new();
    let mut free = Vec::new();
    let mut at = 0;
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

fn push_value(h: &mut Hypothesis, key: &str, scale: f64, range: (f64, f64), value: f64) {
    let name = format!("contact.{key}");
    h.free.push(Free::Value {
        name,
        scale,
        low: range.0,
        high: range.1,
    });
    h.x.push(value / scale);
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::friction::Coulomb;
    use stickslip::plant::ModelFile;

    #[test]
    fn no_start_and_no_step_breaks_away_below_sliding() {
        let text = include_str!("../../../../modelDescription/reduced-rig.toml");
        let mut model = ModelFile::parse(text, "rig").unwrap();
        model.rig.law = Law::Coulomb(Coulomb { mu_c: 0.13 });
        let base = Hypothesis::base(&model);
        for mut start in stiction(&base).into_iter().chain(stribeck(&base)) {
            let sliding = start.value("contact.mu_c").unwrap();
            let breakaway = start.free.iter().position(
                |free| matches!(free, Free::Value { name, .. } if name == "contact.mu_s"),
            );
            let at: usize = start.free[..breakaway.unwrap()]
                .iter()
                .map(Free::width)
                .sum();
            let (furthest_down, _) = start.step_ranges()[at];
            start.x[at] += furthest_down;
            assert!(start.value("contact.mu_s").unwrap() > sliding - 1e-12);
            start.x[at] = 0.0;
            start.clamp();
            assert!((start.value("contact.mu_s").unwrap() - sliding).abs() < 1e-12);
        }
    }
}
