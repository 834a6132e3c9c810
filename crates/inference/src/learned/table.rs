//! A learned function as an effect by equation.

use std::convert::Infallible;
use stickslip::parameter::ParameterInfo;
use stickslip::plant::{Port, Rig, Supposition};

/// A function of one coordinate as a table of an effect, SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct TableEffect {
    /// Name of the effect.
    pub name: String,
    /// Where it acts.
    pub port: Port,
    /// Its equation, which calls the function `term` and has a factor `share`.
    pub equation: String,
    /// Units of knots and values.
    pub units: [String; 2],
    /// Period of the coordinate, if it has one.
    pub period: Option<f64>,
    /// Knots.
    pub knots: Vec<f64>,
    /// Values at the knots.
    pub values: Vec<f64>,
}

impl TableEffect {
    /// The section `[[effect]]` that describes it.
    #[must_use]
    pub fn section(&self) -> String {
        let list = |numbers: &[f64]| {
            let texts: Vec<String> = numbers.iter().map(|v| format!("{v:?}")).collect();
            texts.join(", ")
        };
        let period = self
            .period
            .map_or(String::new(), |p| format!("period = {p:?}\n"));
        let Self {
            name,
            equation,
            units: [x_unit, y_unit],
            ..
        } = self;
        format!(
            "[[effect]]\nname = \"{name}\"\ntitle = \"a function learned from the records, of which no effect of the catalogue is the cause\"\n\
             port = \"{}\"\nequation = \"{equation}\"\n\
             parameters.share = {{ value = 1.0, unit = \"1\", description = \"Share of the learned function\" }}\n\
             [effect.tables.term]\nx = [{}]\ny = [{}]\nx_unit = \"{x_unit}\"\ny_unit = \"{y_unit}\"\n\
             interpolation = \"spline\"\n{period}",
            self.port.name(),
            list(&self.knots),
            list(&self.values),
        )
    }

    /// `rig` with the function; `None` where it cannot have it.
    #[must_use]
    pub fn added_to(&self, rig: &Rig<f64>) -> Option<Rig<f64>> {
        let read = Supposition::read_all(&self.section(), &self.name).ok()?;
        let definition = read.first()?.definition;
        let mut rig = *rig;
        rig.equations.add(definition).ok()?;
        let whole = |_: &'static ParameterInfo| Ok::<f64, Infallible>(1.0);
        rig.insert_effect(definition.name(), whole)?.ok()?;
        Some(rig)
    }
}
