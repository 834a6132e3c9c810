//! What the author of a small plant's model knows of its numbers, and when the records contradict it.

use super::case::SmallCase;
use inference::body::known::deviations;
use inference::body::model::Model;
use inference::policy::{DOUBT, is_no_chance};

/// Said where it is doubted.
const DOUBTED: &str = "what the model states of its numbers contradicts the records, so that all of it counts a tenth as much";

impl SmallCase {
    /// Whether a model has numbers so far off that what is known of them is no chance.
    #[must_use]
    pub fn contradicts(&self, model: &Model) -> bool {
        is_no_chance(&deviations(&self.known, model))
    }

    /// From now on what is known of the numbers counts less.
    pub fn doubt(&mut self) {
        for known in &mut self.known {
            known.deviation *= DOUBT;
        }
        self.notes.push(DOUBTED.to_owned());
    }
}
