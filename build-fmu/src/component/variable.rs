//! A component's variables, whatever the component.

/// The part that a variable plays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Time.
    Time,
    /// Set by the importer at communication points.
    Input,
    /// Meant to be read.
    Output,
    /// Internal, may be read.
    Local,
    /// Set before the run.
    Parameter,
    /// Anything else the standards know, such as calculated parameters, and what only solvers ask for.
    Other,
}

/// Type of a variable's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A real number of 64 bits.
    Real,
    /// True or false.
    Boolean,
    /// Anything else: such a variable is listed and neither read nor set.
    Other,
}

/// A variable of a component.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name as in CSV headers.
    pub name: String,
    /// Value reference of the standards.
    pub reference: u32,
    /// Its part.
    pub role: Role,
    /// Its type.
    pub kind: Kind,
    /// Whether it changes at events only, and holds its value between them.
    pub held: bool,
    /// Whether it is a parameter that may change between steps.
    pub is_tunable: bool,
    /// Its unit, empty where it has none.
    pub unit: String,
    /// Start value in its unit.
    pub start: Option<f64>,
    /// Smallest allowed value.
    pub minimum: Option<f64>,
    /// Largest allowed value.
    pub maximum: Option<f64>,
    /// One line for people.
    pub description: String,
}

/// The name nearest to `wanted` if one is near enough to be what was meant.
pub fn closest<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    names
        .map(|name| (distance(wanted, name), name))
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, _)| *distance <= 1 + wanted.chars().count() / 3)
        .map(|(_, name)| name)
}

/// Number of letters to insert, delete or replace.
fn distance(left: &str, right: &str) -> usize {
    let right: Vec<char> = right.chars().collect();
    let mut row: Vec<usize> = (0..=right.len()).collect();
    for (index, letter) in left.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = index + 1;
        for (column, other) in right.iter().enumerate() {
            let replaced = diagonal + usize::from(letter != *other);
            diagonal = row[column + 1];
            row[column + 1] = replaced.min(diagonal + 1).min(row[column] + 1);
        }
    }
    row[right.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_found_and_far_ones_are_not() {
        let names = ["u", "N2", "contact.mu_s", "contact.mu_c"];
        assert_eq!(
            closest("contact.mus", names.into_iter()),
            Some("contact.mu_s")
        );
        assert_eq!(closest("n2", names.into_iter()), Some("N2"));
        assert_eq!(closest("gearbox.ratio", names.into_iter()), None);
    }
}
