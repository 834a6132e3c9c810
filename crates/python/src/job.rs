//! Long work in a thread of its own, watched from Python: it can be waited for, asked how far it is, and stopped.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

use crate::errors::{DefectError, any_error};

/// Stack of the thread [bytes], as the engine's own threads have it: a model with thirty derivatives of every number needs
/// more than the usual 2 MiB.
const STACK: usize = 64 << 20;

/// What work comes to: a value that is made once Python asks for it.
pub type Value = Box<dyn FnOnce(Python<'_>) -> PyResult<Py<PyAny>> + Send>;

/// A value that `make` makes.
pub fn value(make: impl FnOnce(Python<'_>) -> PyResult<Py<PyAny>> + Send + 'static) -> Value {
    Box::new(make)
}

/// What unwinds through work that is stopped; caught in [`Job::start`].
///
/// The engine knows no stopping: it tells what it does, often, and here the telling ends it. salsa cancels its queries in the
/// same way.
struct Stopped;

/// What work and its watchers share.
#[derive(Default)]
pub struct Watch {
    stop: AtomicBool,
    done: AtomicUsize,
    total: AtomicUsize,
    message: Mutex<String>,
}

impl Watch {
    /// Whether the work is to stop.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The flag that stops it.
    pub fn stop_flag(&self) -> &AtomicBool {
        &self.stop
    }

    /// Says what is being done; does not return if the work is to stop.
    pub fn tell(&self, what: &str) {
        if self.is_stopped() {
            resume_unwind(Box::new(Stopped));
        }
        what.clone_into(&mut lock(&self.message));
    }

    /// Sets how many pieces the work has.
    pub fn set_total(&self, pieces: usize) {
        self.total.store(pieces, Ordering::Relaxed);
    }

    /// Sets how many of them are done.
    pub fn set_done(&self, pieces: usize) {
        self.done.store(pieces, Ordering::Relaxed);
    }

    /// One more is done.
    pub fn add_done(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }
}

/// How work ended.
enum End {
    Value(Value),
    Error(anyhow::Error),
    Stopped,
    Panic(String),
}

#[derive(Default)]
struct Shared {
    watch: Watch,
    end: Mutex<Option<End>>,
    ended: Condvar,
}

/// Work that goes on in a thread.
#[pyclass(frozen)]
pub struct Job {
    shared: Arc<Shared>,
}

impl Job {
    /// Starts `work`.
    pub fn start(
        work: impl FnOnce(&Watch) -> anyhow::Result<Value> + Send + 'static,
    ) -> PyResult<Self> {
        Self::start_shared(|shared| work(&shared.watch))
    }

    /// Starts `work` that hands its watch on to what must own it.
    pub fn start_owning(
        work: impl FnOnce(SharedWatch) -> anyhow::Result<Value> + Send + 'static,
    ) -> PyResult<Self> {
        Self::start_shared(|shared| work(SharedWatch(Arc::clone(shared))))
    }

    fn start_shared(
        work: impl FnOnce(&Arc<Shared>) -> anyhow::Result<Value> + Send + 'static,
    ) -> PyResult<Self> {
        let shared = Arc::new(Shared::default());
        let own = Arc::clone(&shared);
        thread::Builder::new()
            .name("stickslip".to_owned())
            .stack_size(STACK)
            .spawn(move || {
                let end = match catch_unwind(AssertUnwindSafe(|| work(&own))) {
                    Ok(Ok(value)) => End::Value(value),
                    Ok(Err(error)) => End::Error(error),
                    Err(reason) if reason.is::<Stopped>() => End::Stopped,
                    Err(reason) => End::Panic(words(reason.as_ref())),
                };
                *lock(&own.end) = Some(end);
                own.ended.notify_all();
            })?;
        Ok(Self { shared })
    }
}

/// A watch that can be kept.
#[derive(Clone)]
pub struct SharedWatch(Arc<Shared>);

impl std::ops::Deref for SharedWatch {
    type Target = Watch;

    fn deref(&self) -> &Watch {
        &self.0.watch
    }
}

#[pymethods]
impl Job {
    /// Waits at most so many seconds; whether the work has ended.
    fn wait(&self, py: Python<'_>, seconds: f64) -> bool {
        let time = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        py.detach(|| {
            let end = lock(&self.shared.end);
            let waited = self
                .shared
                .ended
                .wait_timeout_while(end, time, |end| end.is_none());
            waited.unwrap_or_else(PoisonError::into_inner).0.is_some()
        })
    }

    /// Asks the work to stop.
    fn stop(&self) {
        self.shared.watch.stop.store(true, Ordering::Relaxed);
    }

    /// What is being done.
    #[getter]
    fn message(&self) -> String {
        lock(&self.shared.watch.message).clone()
    }

    /// How many pieces are done, of how many; 0 of 0 where that is not known.
    #[getter]
    fn progress(&self) -> (usize, usize) {
        let watch = &self.shared.watch;
        (
            watch.done.load(Ordering::Relaxed),
            watch.total.load(Ordering::Relaxed),
        )
    }

    /// What the work came to, once; None if it was stopped without a result.
    fn result(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        let end = py.detach(|| lock(&self.shared.end).take());
        match end {
            Some(End::Value(value)) => value(py).map(Some),
            Some(End::Error(error)) => Err(any_error(&error)),
            Some(End::Stopped) | None => Ok(None),
            Some(End::Panic(what)) => Err(DefectError::new_err(format!(
                "stickslip has a defect, please report it: {what}"
            ))),
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a panic says.
fn words(reason: &(dyn Any + Send)) -> String {
    reason
        .downcast_ref::<String>()
        .cloned()
        .or_else(|| reason.downcast_ref::<&str>().map(|text| (*text).to_owned()))
        .unwrap_or_else(|| "a panic without words".to_owned())
}
