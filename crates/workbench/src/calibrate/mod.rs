//! Finding the parameters of a friction law that nobody published from what was published about its motions.
//!
//! A [`target`] file states facts at operating points (frequency, range of velocity, sticking or not) with the bar within
//! which each counts as met, and the [`transition`]s at which stick-slip begins or ends. A global search ([`evolution`])
//! looks for the *set* of parameter values that meet all of them, a local one ([`simplex`]) for the best. What comes out is
//! the ensemble, not a point with false precision. A [`journal`] lets an interrupted search go on.

mod check;
pub mod command;
pub mod cost;
pub mod cycle;
pub mod evolution;
pub mod journal;
mod picture;
mod report;
pub mod search;
pub mod simplex;
pub mod target;
pub mod transition;
