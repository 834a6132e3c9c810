//! Which physical effect a stick-slip model lacks: evidence, search and verdict, without files or screens.
//!
//! Everything is computed in the plant's own units ([`units`]), so that no number of one rig is in the engine. Records are cut
//! into windows from whose measured start the model runs ([`data`], [`fit`]); a set of effects is a [`hypothesis`]; sets are
//! compared by their log evidence ([`search`]).

pub mod body;
pub mod bristle_start;
mod certainty;
pub mod check;
pub mod data;
pub mod diagnosis;
pub mod effects;
pub mod evidence;
pub mod fit;
pub mod gram;
pub mod hypothesis;
pub mod instruments;
pub mod law_start;
pub mod learned;
pub mod load_error;
pub mod loss;
mod lost_starts;
pub mod marginal;
pub mod missed;
pub mod numbers;
pub mod policy;
pub mod problem;
pub mod random;
pub mod record;
pub mod replica;
pub mod scales;
pub mod search;
pub mod sets;
pub mod structure;
pub mod trace;
pub mod units;
pub mod window;
