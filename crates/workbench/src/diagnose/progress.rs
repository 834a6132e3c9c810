//! What a user sees while a diagnosis runs, and what is left when it is interrupted.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};

/// The time gone by and what is being done.
pub struct Progress {
    begun: Instant,
    shown: Shown,
}

enum Shown {
    /// A line on the screen that changes.
    Line(ProgressBar),
    /// Where nobody looks at a screen, a line for every step.
    Lines,
    /// What a program makes of it that has the workbench as its library.
    Told(Box<dyn Fn(&str)>),
}

/// What is finished and kept, in words.
pub type Finished = Arc<Mutex<Vec<&'static str>>>;

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Progress {
    /// Begins to count the time, for a person at a screen.
    #[must_use]
    pub fn new() -> Self {
        let shown = if std::io::stderr().is_terminal() {
            Shown::Line(Self::line())
        } else {
            Shown::Lines
        };
        Self {
            begun: Instant::now(),
            shown,
        }
    }

    /// Begins to count the time, for a program: `tell` hears of every step.
    #[must_use]
    pub fn told(tell: Box<dyn Fn(&str)>) -> Self {
        Self {
            begun: Instant::now(),
            shown: Shown::Told(tell),
        }
    }

    fn line() -> ProgressBar {
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed:>4}  {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(std::time::Duration::from_millis(200));
        bar
    }

    /// Says what is being done from now on.
    pub fn say(&self, what: &str) {
        match &self.shown {
            Shown::Line(bar) => bar.set_message(what.to_owned()),
            Shown::Lines => eprintln!("{:7.1} s  {what}", self.seconds()),
            Shown::Told(tell) => tell(what),
        }
    }

    /// Time since the beginning [s].
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    /// Takes the line away.
    pub fn done(&self) {
        if let Shown::Line(bar) = &self.shown {
            bar.finish_and_clear();
        }
    }
}

/// Keeps what is finished when the user interrupts: a group of files that belong together is written whole or not at all,
/// and what is there is told. The exit code is then 130.
pub struct Interruptible {
    finished: Finished,
}

impl Interruptible {
    /// Waits for interrupts from now on; results go into `out`.
    ///
    /// # Errors
    /// The operating system refuses to tell of interrupts.
    pub fn new(out: &Path) -> anyhow::Result<Self> {
        let finished = Finished::default();
        let (seen, out): (_, PathBuf) = (Arc::clone(&finished), out.to_owned());
        ctrlc::set_handler(move || {
            // Held until the process has ended: nothing is begun any more.
            let finished = seen.lock().unwrap_or_else(PoisonError::into_inner);
            eprintln!("\nstickslip: {}", farewell(&finished, &out));
            std::process::exit(130);
        })
        .context("cannot wait for Ctrl-C")?;
        Ok(Self { finished })
    }

    /// For a program that interrupts in a way of its own, between two writings, and reads in `finished` what is there.
    #[must_use]
    pub fn by_caller(finished: Finished) -> Self {
        Self { finished }
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

/// What is left of an interrupted diagnosis, in one sentence.
#[must_use]
pub fn farewell(finished: &[&str], out: &Path) -> String {
    if finished.is_empty() {
        "interrupted before anything was finished; nothing was written".to_owned()
    } else {
        format!(
            "interrupted; finished and kept in {}: {}",
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
