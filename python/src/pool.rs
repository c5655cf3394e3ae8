//! The threads that work is done on.

use std::collections::HashMap;
use std::process;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::PyResult;
use pyo3::exceptions::PyRuntimeError;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::refused;

/// Most threads of a pool.
const MOST: usize = 1024;

/// Pools by number of threads, 0 standing for one thread a core, with the process that made them.
type Pools = (u32, HashMap<usize, Arc<ThreadPool>>);

static POOLS: Mutex<Option<Pools>> = Mutex::new(None);

/// The pool of so many threads; of one a core if nothing is said.
///
/// A pool is kept from call to call. A process that was forked, as `multiprocessing` does, has none of its
/// parent's threads and would wait for them for ever: it gets pools of its own, and so rayon's global pool is
/// not used at all.
pub fn pool(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    if let Some(threads) = threads.filter(|threads| !(1..=MOST).contains(threads)) {
        return Err(refused(format!(
            "threads is {threads}: give a number from 1 to {MOST}, or None for all cores"
        )));
    }
    let threads = threads.unwrap_or(0);
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let here = process::id();
    match &*pools {
        Some((process, _)) if *process == here => {}
        // Dropping a pool would tell threads to end that this process does not have.
        _ => std::mem::forget(pools.replace((here, HashMap::new()))),
    }
    let pools = &mut pools.get_or_insert_with(|| (here, HashMap::new())).1;
    if let Some(pool) = pools.get(&threads) {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).thread_name(|at| format!("fsot-{at}")).build();
    let pool = pool.map_err(|error| {
        PyRuntimeError::new_err(format!("the system gives no threads: {error}; ask for fewer with threads="))
    })?;
    Ok(Arc::clone(pools.entry(threads).or_insert(Arc::new(pool))))
}
