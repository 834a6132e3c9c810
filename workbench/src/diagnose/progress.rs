//! What a user sees while a diagnosis runs, and what is left when it is interrupted.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};

/// A line with the time gone by and what is being done; where nobody looks at a screen, a line for every step.
pub struct Progress {
    bar: ProgressBar,
    begun: Instant,
    lines: bool,
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Progress {
    /// Begins to count the time.
    #[must_use]
    pub fn new() -> Self {
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed:>4}  {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(std::time::Duration::from_millis(200));
        Self {
            bar,
            begun: Instant::now(),
            lines: !std::io::stderr().is_terminal(),
        }
    }

    /// Says what is being done from now on.
    pub fn say(&self, what: &str) {
        if self.lines {
            eprintln!("{:7.1} s  {what}", self.seconds());
        } else {
            self.bar.set_message(what.to_owned());
        }
    }

    /// Time since the beginning [s].
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    /// Takes the line away.
    pub fn done(&self) {
        self.bar.finish_and_clear();
    }
}

/// Keeps what is finished when the user interrupts: a group of files that belong together is written whole or not at all,
/// and what is there is told. The exit code is then 130.
pub struct Interruptible {
    finished: Arc<Mutex<Vec<&'static str>>>,
}

impl Interruptible {
    /// Waits for interrupts from now on; results go into `out`.
    ///
    /// # Errors
    /// The operating system refuses to tell of interrupts.
    pub fn new(out: &Path) -> anyhow::Result<Self> {
        let finished = Arc::new(Mutex::new(Vec::new()));
        let (seen, out): (_, PathBuf) = (Arc::clone(&finished), out.to_owned());
        ctrlc::set_handler(move || {
            // Held until the process has ended: nothing is begun any more.
            let finished = seen.lock().unwrap_or_else(PoisonError::into_inner);
            eprintln!("\n{}", farewell(&finished, &out));
            std::process::exit(130);
        })
        .context("cannot wait for Ctrl-C")?;
        Ok(Self { finished })
    }

    /// Writes files that belong together; an interrupt waits until they are there.
    ///
    /// # Errors
    /// That of `write`.
    pub fn write<T>(
        &self,
        what: &'static str,
        write: impl FnOnce() -> anyhow::Result<T>,
    ) -> anyhow::Result<T> {
        let mut finished = self.finished.lock().unwrap_or_else(PoisonError::into_inner);
        let written = write()?;
        finished.push(what);
        Ok(written)
    }
}

fn farewell(finished: &[&str], out: &Path) -> String {
    if finished.is_empty() {
        "stickslip: interrupted before anything was finished; nothing was written".to_owned()
    } else {
        format!(
            "stickslip: interrupted; finished and kept in {}: {}",
            out.display(),
            finished.join(", ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_finished_is_told() {
        let text = farewell(&["finding.json", "model.amended.toml"], Path::new("out"));
        assert!(
            text.ends_with("kept in out: finding.json, model.amended.toml"),
            "{text}"
        );
        assert!(farewell(&[], Path::new("out")).contains("nothing was written"));
    }
}
