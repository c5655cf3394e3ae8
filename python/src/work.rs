//! Work without the interpreter's lock, under the eyes of who may interrupt it.

use std::io;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::marker::Ungil;
use pyo3::prelude::*;

use crate::pool::Pool;

/// How soon Ctrl-C is noticed, and how often progress is told.
const NOTICE: Duration = Duration::from_millis(50);

/// Runs on a pool of so many threads, without the interpreter's lock. Nothing can interrupt it; Ctrl-C is
/// heard afterwards.
///
/// # Errors
/// A number of threads out of range; what a function of the caller's has raised during the work.
pub fn detached<T: Ungil + Send>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce() -> T + Ungil + Send,
) -> PyResult<T> {
    let pool = Pool::of(threads)?;
    let result = py.detach(|| pool.install(work));
    pool.raised().map_or(Ok(result), Err)
}

/// The same for work that Ctrl-C leaves alone: it cannot be stopped, and goes on until it has ended or the
/// process does, on a thread and a pool of its own. It must not write what would surprise its caller then.
///
/// # Errors
/// A number of threads out of range; what a signal's handler raises, `KeyboardInterrupt` for Ctrl-C; what a
/// function of the caller's has raised during the work.
pub fn left_alone<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let pool = Pool::of(threads)?;
    let (tell, told) = channel();
    let work = move || {
        let result = pool.install(work);
        let raised = pool.raised();
        drop(pool);
        // Nobody listens any more after a signal.
        let _ = tell.send(raised.map_or(Ok(result), Err));
    };
    let worker = thread::Builder::new().name("fsot".into()).spawn(work).map_err(no_thread)?;
    let told = Mutex::new(told);
    loop {
        match next(py, &told) {
            Ok(result) => return result,
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    let ended = py.detach(|| worker.join());
    resume_unwind(ended.expect_err("work that ends tells its result"))
}

fn no_thread(error: io::Error) -> PyErr {
    PyRuntimeError::new_err(format!("the system gives no thread: {error}; end some other work first"))
}

/// What the worker asks of the thread that called.
pub enum Event<Message> {
    /// Something to look at, with the interpreter's lock.
    Message(Message),
    /// Nothing for a while.
    Nothing,
}

/// The worker's side.
pub struct Caller<'a, Message> {
    messages: Sender<Message>,
    stop: &'a AtomicBool,
}

impl<Message> Caller<'_, Message> {
    /// Whether the caller wants an end, for Ctrl-C or an exception.
    pub fn wants_an_end(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Tells the caller; false if it doesn't listen any more.
    pub fn tell(&self, message: Message) -> bool {
        self.messages.send(message).is_ok()
    }
}

/// Runs `work` on a pool, without the interpreter's lock, while this thread looks after signals and calls
/// `look` with every message of the work, and from time to time with none. The first exception, of a signal
/// handler or of `look`, asks the work to end, and is given back beside its result; so is what a function of
/// the caller's has raised during the work.
///
/// # Errors
/// A number of threads out of range.
pub fn watched<T: Send, Message: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce(&Caller<'_, Message>) -> T + Send,
    mut look: impl FnMut(Event<Message>) -> PyResult<()>,
) -> PyResult<(T, Option<PyErr>)> {
    let pool = Pool::of(threads)?;
    let stop = AtomicBool::new(false);
    let (messages, heard) = channel();
    let caller = Caller { messages, stop: &stop };
    thread::scope(|scope| {
        let on_pool = &pool;
        let worker = scope.spawn(move || on_pool.install(|| work(&caller)));
        let mut exception = None;
        let mut heard = Some(Mutex::new(heard));
        while let Some(messages) = &heard {
            let event = match next(py, messages) {
                Ok(message) => Event::Message(message),
                Err(RecvTimeoutError::Timeout) => Event::Nothing,
                Err(RecvTimeoutError::Disconnected) => break,
            };
            if let Err(error) = py.check_signals().and_then(|()| look(event)) {
                stop.store(true, Ordering::Relaxed);
                exception = Some(error);
                // Who waits for an answer hears that there is none.
                heard = None;
            }
        }
        let result = py.detach(|| worker.join()).unwrap_or_else(|panic| resume_unwind(panic));
        // Asked in any case: the next caller's threads start with none.
        let raised = pool.raised();
        Ok((result, exception.or(raised)))
    })
}

/// The next message; the mutex is there for the compiler, which knows of one thread that waits.
fn next<Message: Send>(
    py: Python<'_>,
    messages: &Mutex<Receiver<Message>>,
) -> Result<Message, RecvTimeoutError> {
    py.detach(|| messages.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(NOTICE))
}
