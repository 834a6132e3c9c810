//! The built library under fire: random and hostile calls, long runs, many instances.
//!
//! | module | is |
//! |---|---|
//! | `standard` | which call is legal in which state, from the standards' tables |
//! | `call`, `generate` | a call as data; random ones |
//! | `expectation` | what an instance must do, by the standards and the native model |
//! | `call_sequence` | carries out calls on library and expectation and compares |
//! | `campaign` | many sequences; shortens one that fails |
//! | `endurance` | many instances, long runs, several components in one process |
//! | `program`, `kills` | the project's programs, watched or killed while they run |
//! | `rig` | a well-behaved importer |
//! | `library`, `component`, `log`, `invoke`, `saved_states` | an importer in a few lines |

mod call;
mod call_sequence;
pub mod campaign;
pub mod component;
pub mod endurance;
mod expectation;
mod generate;
mod invoke;
pub mod kills;
pub mod library;
mod log;
pub mod program;
pub mod random;
pub mod rig;
mod saved_states;
pub mod standard;
