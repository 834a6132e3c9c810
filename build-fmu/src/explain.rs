//! Errors as one line for people.

use std::error::Error;

/// What went wrong and why: the error, then each cause that the line does not say already.
pub fn explain(error: &(dyn Error + 'static)) -> String {
    let mut line = error.to_string();
    let mut cause = error.source();
    while let Some(next) = cause {
        let reason = next.to_string();
        if !line.contains(&reason) {
            line.push_str(": ");
            line.push_str(&reason);
        }
        cause = next.source();
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::Source;
    use std::path::Path;

    #[test]
    fn a_reason_is_said_once() {
        let Err(error) = Source::read(Path::new("/nowhere/model.toml")) else {
            panic!("there is no such file");
        };
        let line = explain(&error);
        assert!(line.contains("/nowhere/model.toml"), "{line}");
        assert_eq!(line.matches("No such file").count(), 1, "{line}");
    }

    #[test]
    fn a_cause_that_is_not_said_yet_is_added() {
        let cause = std::io::Error::other("the disk is full");
        let error = anyhow::Error::new(cause).context("the picture is missing");
        assert_eq!(
            explain(error.as_ref()),
            "the picture is missing: the disk is full"
        );
    }
}
