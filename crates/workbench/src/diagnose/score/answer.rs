//! `ANSWERS.json`: what was hidden. Read for judging alone; nothing of it reaches the engine.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use serde::Deserialize;

use crate::diagnose::catalogue::CATALOGUE;
use inference::body::catalogue as small_plant;

/// What was hidden in one case.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Answer {
    /// Name of the effect, with endings for variants; two joined by `_and_`; `outside_…` is in no catalogue.
    pub kind: String,
    /// Standard deviation of the random friction relative to the friction; 0 for none.
    #[serde(default)]
    pub rough: f64,
    /// Disc on which the effect acts in the full rig, `disc1` or `disc2`.
    #[serde(default)]
    pub place: Option<String>,
    /// Size of the effect over the full one.
    #[serde(default = "full_size")]
    pub scale: f64,
    /// Values of the hidden effects by their short names.
    #[serde(default)]
    pub effects: BTreeMap<String, f64>,
    /// The effect of a file that is the hidden one, which is in no catalogue otherwise.
    #[serde(skip)]
    pub supposed: Option<String>,
}

fn full_size() -> f64 {
    1.0
}

/// What a case is an example of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// One effect of full size.
    Full,
    /// One effect and friction that fluctuates.
    Rough,
    /// One effect of at most a fifth of the full size.
    Small,
    /// One effect of another size.
    OtherSize,
    /// Nothing hidden.
    Clean,
    /// Two effects.
    Pair,
    /// An effect that no catalogue has.
    Outside,
    /// Outside of the catalogue, but a file describes it.
    Supposed,
}

/// Two effects that are nearly the same thing as parameters, and as each other, without a current reading.
pub const NEARLY_PARAMETERS: [&str; 2] = ["motor_viscous", "supply_sag"];

/// Effects with another that does the same where they are taken out of the catalogue: Stribeck's law is stiction where its
/// velocity vanishes.
pub const EQUIVALENT: [(&str, &str); 1] = [("stiction", "stribeck")];

impl Answer {
    /// Reads the answers of a directory of cases.
    ///
    /// # Errors
    /// The file cannot be read, or it is no answers file.
    pub fn read_all(directory: &Path) -> anyhow::Result<BTreeMap<String, Self>> {
        let path = directory.join("ANSWERS.json");
        let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        serde_json::from_str(&text).with_context(|| path.display().to_string())
    }

    /// Looks for the hidden effect among these, which files describe.
    pub fn suppose(&mut self, names: &[String]) {
        let own = self.kind.strip_prefix("outside_");
        self.supposed = own.map(str::to_owned).filter(|own| names.contains(own));
    }

    /// Names of the hidden effects as the catalogue or a file has them; empty for clean cases and those that neither has.
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        if self.group() == Group::Outside {
            return Vec::new();
        }
        if let Some(name) = &self.supposed {
            return vec![name];
        }
        self.kind
            .split("_and_")
            .filter_map(catalogue_name)
            .map(|name| self.on_its_disc(name))
            .collect()
    }

    /// The catalogue's name of this effect where it acts on the disc of this answer.
    fn on_its_disc(&self, name: &'static str) -> &'static str {
        let on_disc1 = self.place.as_deref() == Some("disc1");
        CATALOGUE
            .iter()
            .map(|entry| entry.name)
            .find(|other| on_disc1 && other.strip_suffix('1') == Some(name))
            .unwrap_or(name)
    }

    /// What the case is an example of.
    #[must_use]
    pub fn group(&self) -> Group {
        if self.supposed.is_some() {
            Group::Supposed
        } else if self.kind.starts_with("outside") {
            Group::Outside
        } else if self.kind.starts_with("none") || self.kind.starts_with("clean") {
            Group::Clean
        } else if self.kind.contains("_and_") {
            Group::Pair
        } else if self.rough > 0.0 {
            Group::Rough
        } else if self.scale < 0.25 {
            Group::Small
        } else if (0.55..=1.45).contains(&self.scale) {
            Group::Full
        } else {
            Group::OtherSize
        }
    }
}

/// The catalogue's name behind a kind: variants have endings, members of pairs may be shortened.
fn catalogue_name(kind: &str) -> Option<&'static str> {
    let names = || {
        let small = small_plant::CATALOGUE.iter().map(|entry| entry.name);
        CATALOGUE.iter().map(|entry| entry.name).chain(small)
    };
    names()
        .filter(|name| kind.starts_with(name))
        .max_by_key(|name| name.len())
        .or_else(|| names().find(|name| name.split('_').any(|word| word == kind)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(kind: &str, rough: f64, scale: f64) -> Answer {
        Answer {
            kind: kind.to_owned(),
            rough,
            place: None,
            scale,
            effects: BTreeMap::new(),
            supposed: None,
        }
    }

    #[test]
    fn kinds_become_names_of_the_catalogue() {
        for (kind, names) in [
            ("none_no_brake", vec![]),
            ("bearing_friction_braked", vec!["bearing_friction"]),
            ("normal_force_wobble_gauss", vec!["normal_force_wobble"]),
            ("acceleration_hysteresis_c", vec!["acceleration_hysteresis"]),
            (
                "wobble_and_bearing",
                vec!["normal_force_wobble", "bearing_friction"],
            ),
            ("stiction", vec!["stiction"]),
            ("outside_breathing_inertia", vec![]),
        ] {
            assert_eq!(answer(kind, 0.0, 1.0).names(), names, "{kind}");
        }
    }

    #[test]
    fn an_effect_on_disc_d1_has_a_name_of_its_own() {
        let mut hidden = answer("unbalance", 0.0, 1.0);
        hidden.place = Some("disc2".to_owned());
        assert_eq!(hidden.names(), ["unbalance"]);
        hidden.place = Some("disc1".to_owned());
        assert_eq!(hidden.names(), ["unbalance1"]);
    }

    #[test]
    fn groups_follow_kind_roughness_and_size() {
        assert_eq!(answer("none", 0.04, 1.0).group(), Group::Clean);
        assert_eq!(answer("unbalance", 0.04, 0.5).group(), Group::Rough);
        assert_eq!(answer("unbalance", 0.0, 0.1).group(), Group::Small);
        assert_eq!(answer("unbalance", 0.0, 0.33).group(), Group::OtherSize);
        assert_eq!(answer("unbalance", 0.0, 1.4).group(), Group::Full);
        assert_eq!(
            answer("unbalance_and_backlash", 0.0, 1.0).group(),
            Group::Pair
        );
        assert_eq!(answer("outside_bump", 0.0, 1.0).group(), Group::Outside);
    }
}
