//! The threads that work is done on.

use std::collections::HashMap;
use std::mem;
use std::ops::Deref;
use std::process;
use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::PyResult;
use pyo3::exceptions::PyRuntimeError;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::refused;

/// Most threads of a pool.
const MOST: usize = 1024;

/// Pools that nobody uses, by number of threads, 0 standing for one thread a core, and the process that made
/// them.
type Idle = (u32, HashMap<usize, Vec<ThreadPool>>);

static IDLE: Mutex<Option<Idle>> = Mutex::new(None);

/// A pool that is one caller's own until this is dropped.
#[derive(Debug)]
pub struct Pool {
    threads: usize,
    process: u32,
    /// There until this is dropped.
    pool: Option<ThreadPool>,
}

impl Pool {
    /// A pool of so many threads; of one a core if nothing is said. Pools are kept for later callers.
    ///
    /// Callers at the same time have pools of their own: a run whose callback starts another one holds a
    /// thread all the while, and a pool that both share might have no other.
    ///
    /// # Errors
    /// A number out of range; a system that gives no more threads.
    pub fn of(threads: Option<usize>) -> PyResult<Self> {
        if let Some(threads) = threads.filter(|threads| !(1..=MOST).contains(threads)) {
            return Err(refused(format!(
                "threads is {threads}: give a number from 1 to {MOST}, or None for all cores"
            )));
        }
        let (threads, process) = (threads.unwrap_or(0), process::id());
        if let Some(pool) = idle(process).as_mut().and_then(|(_, pools)| pools.get_mut(&threads)?.pop()) {
            return Ok(Self { threads, process, pool: Some(pool) });
        }
        let pool =
            ThreadPoolBuilder::new().num_threads(threads).thread_name(|at| format!("fsot-{at}")).build();
        let pool = pool.map_err(|error| {
            PyRuntimeError::new_err(format!(
                "the system gives no threads: {error}; ask for fewer with threads="
            ))
        })?;
        Ok(Self { threads, process, pool: Some(pool) })
    }
}

impl Deref for Pool {
    type Target = ThreadPool;

    fn deref(&self) -> &ThreadPool {
        self.pool.as_ref().expect("it is there until it is dropped")
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        let Some(pool) = self.pool.take() else { return };
        if self.process != process::id() {
            return mem::forget(pool);
        }
        if let Some((_, pools)) = &mut *idle(self.process) {
            pools.entry(self.threads).or_default().push(pool);
        }
    }
}

/// The idle pools of this process.
///
/// One that was forked, as `multiprocessing` does, has none of its parent's threads and would wait for them
/// for ever; it begins with no pool. That is also why nothing here uses rayon's global pool.
fn idle(process: u32) -> MutexGuard<'static, Option<Idle>> {
    let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
    if idle.as_ref().is_none_or(|(made_by, _)| *made_by != process) {
        // Dropping a pool would tell threads to end that this process does not have.
        mem::forget(idle.replace((process, HashMap::new())));
    }
    idle
}
