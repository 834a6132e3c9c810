//! Finding the parameters of a friction law that nobody published from what was published about its motions.
//!
//! A [`target`] file states facts at operating points (frequency, range of velocity, sticking or not) with the bar within
//! which each counts as met. A global search ([`evolution`]) looks for the *set* of parameter values that meet all bars, a
//! local one ([`simplex`]) for the best of them. What comes out is the ensemble, not a point with false precision.

pub mod command;
pub mod cost;
pub mod cycle;
pub mod evolution;
pub mod search;
pub mod simplex;
pub mod target;
