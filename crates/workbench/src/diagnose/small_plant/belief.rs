//! What is known of an FMU's parameters, weighed against the records.

use super::case::SmallCase;
use super::showing::balance;
use inference::body::evidence::unit;
use inference::body::model::Model;
use inference::body::motion::root_mean_square;
use inference::body::problem::Problem;
use inference::policy::{DOUBT, is_no_chance};
use stickslip::body::Kind;

/// Said where it is doubted.
const DOUBTED: &str = "what the ports file states of the FMU's parameters contradicts the records, so that all of it counts a tenth as much";

impl SmallCase {
    /// Weighs what is known of an FMU's parameters against residuals as large as `model` leaves.
    pub(super) fn weigh_knowledge(&mut self, model: &Model) {
        if self.kind() == Kind::Fmu {
            let ports = self.chased.as_ref().map_or(1, |own| own.plant.places.len());
            if ports > 1 {
                let all = balance(self).weighing(&[]);
                let noise = (0..ports)
                    .map(|port| root_mean_square(&all.at_port(port).residuals(model).concat()));
                let noise: Vec<f64> = noise.collect();
                self.weights = noise.iter().map(|own| noise[0] / own).collect();
            }
            self.known = unit(&balance(self).residuals(model)).sqrt() / self.doubt;
        }
    }

    /// Whether a model has a parameter of an FMU so far off that what is known of it is no chance.
    #[must_use]
    pub fn contradicts(&self, model: &Model) -> bool {
        let off = balance(self).prior(model).into_iter();
        is_no_chance(&off.map(|own| own / self.known).collect::<Vec<f64>>())
    }

    /// From now on what is known of an FMU's parameters counts less.
    pub fn doubt(&mut self) {
        self.doubt = DOUBT;
        self.known /= DOUBT;
        self.notes.push(DOUBTED.to_owned());
    }
}
