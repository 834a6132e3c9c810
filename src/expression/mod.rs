//! Equations that people write in files, evaluated exactly: as power series, with every kink a place where a mode changes.
//!
//! A text such as `-torque * cos(angle - phase)` is parsed once into a [`Program`], a list of operations each of which has a
//! recurrence for its Taylor coefficients. `sign`, `abs`, `min`, `max` and the knots of tables make *sites*: a site is on one
//! branch as long as its mode lasts, and tells by a series when that ends. Units and poles are checked through the whole
//! expression before anything runs.

mod bounds;
mod coordinate;
mod dimension;
mod error;
mod name;
mod parse;
mod program;
mod recurrence;
mod table;

pub(crate) use coordinate::COORDINATES;
pub use coordinate::{Coordinate, Quantity};
pub use dimension::Dimension;
pub use error::ExpressionError;
pub use name::check_name;
pub use parse::{FUNCTIONS, Names, parse};
pub use program::{ExpressionJet, MOST_PARAMETERS, Program, SITES, Site};
pub use table::{Interpolation, Table, TableError};
