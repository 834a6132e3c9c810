//! Names that equations and dotted parameter names can carry.

use super::FUNCTIONS;

/// Longest name, in characters.
const LONGEST: usize = 40;

/// Whether effects and their parameters can have this name, where equations know `coordinates`.
///
/// # Errors
/// What would be right.
pub fn check_name(name: &str, coordinates: &[&str]) -> Result<(), &'static str> {
    let is_letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    let is_good = name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(is_letter)
        && name.len() <= LONGEST;
    if !is_good {
        return Err("small letters, digits and _, a letter first, 40 at most");
    }
    if name == "pi" || FUNCTIONS.contains(&name) || coordinates.contains(&name) {
        return Err("another name: equations mean something else by this one");
    }
    Ok(())
}
