//! The diagnosis in a thread of its own: watched, held, let go on, stopped.
//!
//! The engine tells what it does, often. Here the telling also waits while the diagnosis is held, and unwinds out of the engine
//! when it is stopped. What a diagnosis finished is in its folder, and a diagnosis that goes on later begins behind it.

use std::any::Any;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use serde::Deserialize;
use serde_json::{Value, json};

use super::choices::Asked;
use super::error::StudioError;
use super::session::{Session, lock};
use crate::diagnose::case::STACK;
use crate::diagnose::finding;
use crate::diagnose::material::Material;
use crate::diagnose::progress::Finished;
use crate::diagnose::request::{Diagnosed, Request, Stages};
use crate::diagnose::{amend, report};
use crate::outcome::Outcome;

/// What the engine says while it tries an effect.
const TRYING: &str = "trying ";

/// What the page may want of a diagnosis.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Wish {
    /// Begin; with what is finished of the same diagnosis, go on behind it.
    Start,
    /// Hold it.
    Pause,
    /// Let it go on.
    Continue,
    /// End it.
    Stop,
    /// Fit the model with these effects and no others.
    ByHand {
        /// Names in the catalogue.
        effects: Vec<String>,
    },
}

/// What unwinds through a diagnosis that is stopped.
struct Stopped;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    Go,
    Hold,
    Stop,
}

#[derive(Debug, Clone, PartialEq)]
enum State {
    Running,
    Stopped,
    Done { settled: bool, screen: String },
    Failed(String),
}

#[derive(Debug)]
struct Watched {
    order: Order,
    state: State,
    now: String,
    told: usize,
    tried: BTreeMap<String, usize>,
    /// Time that it ran before it was last held.
    ran: Duration,
    since: Instant,
}

impl Watched {
    /// Counts the time since it last went on.
    fn count(&mut self) {
        let more = self.since.elapsed();
        self.ran += more;
    }
}

/// A diagnosis, or a fit by hand.
#[derive(Debug)]
pub struct Job {
    /// Effects chosen by hand; `None` for a diagnosis.
    effects: Option<Vec<String>>,
    finished: Finished,
    watched: Mutex<Watched>,
    changed: Condvar,
}

impl Job {
    fn new(effects: Option<Vec<String>>) -> Self {
        Self {
            effects,
            finished: Finished::default(),
            watched: Mutex::new(Watched {
                order: Order::Go,
                state: State::Running,
                now: "reading the records".to_owned(),
                told: 0,
                tried: BTreeMap::new(),
                ran: Duration::ZERO,
                since: Instant::now(),
            }),
            changed: Condvar::new(),
        }
    }

    /// Hears what is being done; waits while the diagnosis is held, and does not return where it is to stop.
    fn tell(&self, what: &str) {
        let mut watched = lock(&self.watched);
        what.clone_into(&mut watched.now);
        watched.told += 1;
        if let Some(name) = what.strip_prefix(TRYING) {
            *watched.tried.entry(name.to_owned()).or_default() += 1;
        }
        watched = self
            .changed
            .wait_while(watched, |watched| watched.order == Order::Hold)
            .unwrap_or_else(PoisonError::into_inner);
        if watched.order == Order::Stop {
            drop(watched);
            resume_unwind(Box::new(Stopped));
        }
    }

    fn order(&self, order: Order) {
        let mut watched = lock(&self.watched);
        if watched.state != State::Running || watched.order == Order::Stop {
            return;
        }
        match (watched.order, order) {
            (Order::Go, Order::Hold) => watched.count(),
            (Order::Hold, Order::Go) => watched.since = Instant::now(),
            _ => {}
        }
        watched.order = order;
        self.changed.notify_all();
    }

    fn is_running(&self) -> bool {
        lock(&self.watched).state == State::Running
    }

    fn end(&self, state: State) {
        let mut watched = lock(&self.watched);
        if watched.order != Order::Hold {
            watched.count();
        }
        watched.state = state;
    }

    /// How far it is, for the page.
    fn told(&self) -> Value {
        let watched = lock(&self.watched);
        let (phase, text) = match (&watched.state, watched.order) {
            (State::Running, Order::Go) => ("running", ""),
            (State::Running, Order::Hold) => ("held", ""),
            (State::Running, Order::Stop) => ("stopping", ""),
            (State::Stopped, _) => ("stopped", ""),
            (State::Done { screen, .. }, _) => ("done", screen.as_str()),
            (State::Failed(problem), _) => ("failed", problem.as_str()),
        };
        let runs = watched.state == State::Running && watched.order != Order::Hold;
        let more = if runs {
            watched.since.elapsed()
        } else {
            Duration::ZERO
        };
        let settled = matches!(watched.state, State::Done { settled: true, .. });
        json!({
            "phase": phase,
            "text": text,
            "settled": settled,
            "by_hand": self.effects,
            "now": watched.now,
            "told": watched.told,
            "tried": watched.tried,
            "seconds": (watched.ran + more).as_secs_f64(),
            "finished": *lock(&self.finished),
        })
    }
}

impl Session {
    /// Does what the page wants.
    ///
    /// # Errors
    /// Something runs already, the folder is gone, or an effect is unknown.
    pub fn wish(self: &Arc<Self>, wish: Wish) -> Result<(), StudioError> {
        match wish {
            Wish::Start => self.begin(None),
            Wish::ByHand { effects } => self.begin(Some(effects)),
            Wish::Pause => self.order(Order::Hold),
            Wish::Continue => self.order(Order::Go),
            Wish::Stop => self.order(Order::Stop),
        }
    }

    fn order(&self, order: Order) -> Result<(), StudioError> {
        match lock(&self.job).as_ref() {
            Some(job) if job.is_running() => {
                job.order(order);
                Ok(())
            }
            _ => Err(StudioError::Busy("no diagnosis runs")),
        }
    }

    /// How far the diagnosis is, or how it ended.
    pub fn progress(&self) -> Value {
        if let Some(job) = lock(&self.job).as_ref() {
            return job.told();
        }
        let asked = self.choices().asked;
        let was_cut_off = asked.is_some_and(|asked| !asked.is_done);
        json!({"phase": if was_cut_off { "cut off" } else { "idle" }})
    }

    /// Whether a diagnosis runs.
    pub fn is_busy(&self) -> bool {
        lock(&self.job).as_ref().is_some_and(|job| job.is_running())
    }

    fn begin(self: &Arc<Self>, effects: Option<Vec<String>>) -> Result<(), StudioError> {
        self.folder.check()?;
        let material = self.material()?;
        if material.records.is_empty() {
            return Err(StudioError::Input(
                "there is no record to learn from: drop one onto the page, or give one of those there this role".to_owned(),
            ));
        }
        let mut current = lock(&self.job);
        if current.as_ref().is_some_and(|job| job.is_running()) {
            return Err(StudioError::Busy(
                "a diagnosis runs already: wait for its end, or stop it",
            ));
        }
        let job = Arc::new(Job::new(effects));
        let work = match &job.effects {
            Some(effects) => Work::ByHand(self.by_hand_folder(effects)?),
            None if self.is_half_done() => Work::GoOn,
            None => Work::All,
        };
        let inputs = self.inputs();
        self.change(false, |choices| match &work {
            Work::ByHand(folder) => {
                let name = folder.file_name().unwrap_or_default();
                choices
                    .fitted
                    .insert(name.to_string_lossy().into_owned(), inputs);
            }
            Work::All | Work::GoOn => {
                choices.asked = Some(Asked {
                    inputs,
                    is_done: false,
                });
            }
        })?;
        *current = Some(Arc::clone(&job));
        drop(current);
        let session = Arc::clone(self);
        let own = Arc::clone(&job);
        let begun = thread::Builder::new()
            .name("diagnosis".to_owned())
            .stack_size(STACK)
            .spawn(move || session.run(&own, &material, &work));
        if let Err(error) = begun {
            job.end(State::Failed(format!("no thread could be had: {error}")));
        }
        Ok(())
    }

    /// Whether there is a finding of just what is asked now, of which later stages are missing.
    fn is_half_done(&self) -> bool {
        let there = |name| self.folder.result(None, name).is_ok();
        let asked = self.choices().asked;
        asked.is_some_and(|asked| !asked.is_done && asked.inputs == self.inputs())
            && there(finding::FILE)
            && !there(report::FILE)
    }

    fn by_hand_folder(&self, effects: &[String]) -> Result<PathBuf, StudioError> {
        let is_plain = |name: &String| {
            !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        };
        if let Some(wrong) = effects.iter().find(|name| !is_plain(name)) {
            return Err(StudioError::Input(format!(
                "{wrong}: is no effect of the catalogue"
            )));
        }
        let mut names = effects.to_vec();
        names.sort();
        names.dedup();
        let name = if names.is_empty() {
            "no_effect".to_owned()
        } else {
            names.join("+")
        };
        Ok(self.folder.by_hand().join(name))
    }

    fn run(self: &Arc<Self>, job: &Arc<Job>, material: &Material, work: &Work) {
        let told = Arc::clone(job);
        let tell: Box<dyn Fn(&str)> = Box::new(move |what| told.tell(what));
        let out = self.folder.path();
        let ended = catch_unwind(AssertUnwindSafe(|| {
            work.run(material, job, out, self.library.as_deref(), tell)
        }));
        let state = match ended {
            Ok(Ok(diagnosed)) => State::Done {
                settled: diagnosed.outcome == Outcome::Done,
                screen: diagnosed.screen,
            },
            Ok(Err(error)) => State::Failed(StudioError::from(error).to_string()),
            Err(reason) if reason.is::<Stopped>() => State::Stopped,
            Err(reason) => State::Failed(format!(
                "stickslip has a defect, please report it: {}",
                words(reason.as_ref())
            )),
        };
        if job.effects.is_none() && matches!(state, State::Done { .. }) {
            // Where it cannot be kept, the finding tells it all the same; the next save says what is wrong.
            let _ = self.change(false, |choices| {
                if let Some(asked) = &mut choices.asked {
                    asked.is_done = true;
                }
            });
        }
        job.end(state);
    }
}

/// What is to be done.
enum Work {
    All,
    /// What comes after the finding.
    GoOn,
    /// A model with effects chosen by hand, into this folder.
    ByHand(PathBuf),
}

impl Work {
    fn run(
        &self,
        material: &Material,
        job: &Job,
        out: &Path,
        library: Option<&Path>,
        tell: Box<dyn Fn(&str)>,
    ) -> anyhow::Result<Diagnosed> {
        let request = |out| Request {
            material,
            out,
            library,
            tell,
            finished: Arc::clone(&job.finished),
        };
        match (self, &job.effects) {
            (Self::ByHand(folder), Some(effects)) => request(folder).run(Stages::With {
                effects,
                earlier: out,
            }),
            (Self::GoOn, _) => request(out).run(Stages::AfterFinding),
            _ => {
                // What is there is of an earlier diagnosis, and would look like this one's.
                for name in [finding::FILE, report::FILE, amend::FILE] {
                    match std::fs::remove_file(out.join(name)) {
                        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                            return Err(error.into());
                        }
                        _ => {}
                    }
                }
                request(out).run(Stages::All)
            }
        }
    }
}

/// What a panic says.
fn words(reason: &(dyn Any + Send)) -> String {
    let text = reason.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| reason.downcast_ref::<&str>().copied())
        .unwrap_or("a panic without words")
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagnosis_is_held_goes_on_and_stops() {
        let job = Arc::new(Job::new(None));
        let own = Arc::clone(&job);
        job.order(Order::Hold);
        let thread = thread::spawn(move || {
            let ended = catch_unwind(AssertUnwindSafe(|| {
                loop {
                    own.tell("trying unbalance");
                    thread::sleep(Duration::from_millis(1));
                }
            }));
            let () = ended
                .unwrap_err()
                .downcast::<Stopped>()
                .map(|_| ())
                .unwrap();
        });
        let count = || job.told()["told"].as_u64().unwrap();
        while count() == 0 {
            thread::yield_now();
        }
        thread::sleep(Duration::from_millis(20));
        assert_eq!((count(), job.told()["phase"].as_str()), (1, Some("held")));
        job.order(Order::Go);
        while count() < 3 {
            thread::yield_now();
        }
        job.order(Order::Stop);
        job.order(Order::Go);
        thread.join().unwrap();
        assert!(job.told()["tried"]["unbalance"].as_u64().unwrap() >= 3);
    }
}
