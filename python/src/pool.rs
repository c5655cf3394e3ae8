//! The threads that work is done on.

use std::cell::RefCell;
use std::collections::HashMap;
use std::mem;
use std::ops::Deref;
use std::process;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::{PyRecursionError, PyRuntimeError};
use pyo3::{PyErr, PyResult};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::refused;

/// Most threads of a pool.
const MOST: usize = 1024;

/// Most pools at the same time. A function that a run calls, and that starts such a run, would go on until
/// the system has no more threads.
const MOST_POOLS: usize = 128;

/// The pools of a process.
struct Pools {
    /// Which made them.
    process: u32,
    /// Those that nobody uses, by number of threads, 0 standing for one thread a core.
    idle: HashMap<usize, Vec<Threads>>,
    /// How many are in use.
    used: usize,
}

/// Threads, and what a function of the caller's has raised on one of them.
#[derive(Debug)]
struct Threads {
    pool: ThreadPool,
    raised: Raised,
}

type Raised = Arc<Mutex<Option<PyErr>>>;

thread_local! {
    /// Of the pool that this thread is of.
    static RAISED: RefCell<Option<Raised>> = const { RefCell::new(None) };
}

/// Keeps what a function has raised for the caller whose work this thread does, if it is the first.
///
/// Callers have pools of their own: what one's work has raised no other hears, though both use one function.
pub fn raise(error: PyErr) {
    RAISED.with_borrow(|raised| {
        if let Some(raised) = raised {
            raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        }
    });
}

static POOLS: Mutex<Option<Pools>> = Mutex::new(None);

/// A pool that is one caller's own until this is dropped.
#[derive(Debug)]
pub struct Pool {
    wanted: usize,
    process: u32,
    /// There until this is dropped.
    pool: Option<Threads>,
}

impl Pool {
    /// A pool of so many threads; of one a core if nothing is said. Pools are kept for later callers.
    ///
    /// Callers at the same time have pools of their own: a run whose callback starts another one holds a
    /// thread all the while, and a pool that both share might have no other.
    ///
    /// # Errors
    /// A number out of range; too many pools at the same time; a system that gives no more threads.
    pub fn of(threads: Option<usize>) -> PyResult<Self> {
        if let Some(threads) = threads.filter(|threads| !(1..=MOST).contains(threads)) {
            return Err(refused(format!(
                "threads is {threads}: give a number from 1 to {MOST}, or None for all cores"
            )));
        }
        let (threads, process) = (threads.unwrap_or(0), process::id());
        let idle = with_pools(process, |pools| {
            if pools.used == MOST_POOLS {
                return Err(PyRecursionError::new_err(format!(
                    "{MOST_POOLS} runs go on inside of each other or at once: let some end, and see to it \
                     that no function which a run calls starts that run again"
                )));
            }
            pools.used += 1;
            Ok(pools.idle.get_mut(&threads).and_then(Vec::pop))
        })?;
        // Counted from here on, so that what is refused is counted back.
        let mut own = Self { wanted: threads, process, pool: idle };
        if own.pool.is_none() {
            let name = |at| format!("fsot-{at}");
            let raised = Raised::default();
            let of_threads = Arc::clone(&raised);
            let builder = ThreadPoolBuilder::new()
                .num_threads(threads)
                .thread_name(name)
                .start_handler(move |_| RAISED.set(Some(Arc::clone(&of_threads))));
            let pool = builder.build().map_err(|error| {
                PyRuntimeError::new_err(format!(
                    "the system gives no threads: {error}; ask for fewer with threads="
                ))
            })?;
            own.pool = Some(Threads { pool, raised });
        }
        // Work that has panicked may have left one behind.
        own.raised();
        Ok(own)
    }
}

impl Pool {
    /// What a function has raised on these threads since somebody asked.
    pub fn raised(&self) -> Option<PyErr> {
        self.threads().raised.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn threads(&self) -> &Threads {
        self.pool.as_ref().expect("they are there until this is dropped")
    }
}

impl Deref for Pool {
    type Target = ThreadPool;

    fn deref(&self) -> &ThreadPool {
        &self.threads().pool
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        let pool = self.pool.take();
        if self.process != process::id() {
            return mem::forget(pool);
        }
        with_pools(self.process, |pools| {
            pools.used -= 1;
            pools.idle.entry(self.wanted).or_default().extend(pool);
        });
    }
}

/// Looks at the pools of this process.
///
/// One that was forked, as `multiprocessing` does, has none of its parent's threads and would wait for them
/// for ever; it begins with no pool. That is also why nothing here uses rayon's global pool.
fn with_pools<T>(process: u32, look: impl FnOnce(&mut Pools) -> T) -> T {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if pools.as_ref().is_none_or(|pools| pools.process != process) {
        // Dropping a pool would tell threads to end that this process does not have.
        mem::forget(pools.replace(Pools { process, idle: HashMap::new(), used: 0 }));
    }
    look(pools.as_mut().expect("they have just been made"))
}
