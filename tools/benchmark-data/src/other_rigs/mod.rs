//! Cases on rigs of any size: rig, law, loads, instruments and sizes of effects are drawn anew.
//!
//! Everything is drawn without dimension first (shares of the period, of the friction torque, of
//! the top speed) and given its size by inertia and frequency last.

pub mod case;
pub mod contact;
pub mod disc1;
pub mod drawing;
pub mod motion;
pub mod plan;
pub mod runs;
pub mod sizes;
pub mod text;
