//! What a fork does not copy: threads, and the right to write the files of the parent process.

use std::process::id;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The process that created an object.
#[derive(Debug, Clone, Copy)]
pub struct Owner(u32);

impl Owner {
    /// Returns the current process.
    pub fn this() -> Self {
        Self(id())
    }

    /// Returns true in the process that created the object.
    pub fn is_this(self) -> bool {
        self.0 == id()
    }

    /// Refuses to use the object in another process, such as one that was forked. A thread of the parent may have held a
    /// lock during the fork, and would hold it for ever.
    ///
    /// # Errors
    /// RuntimeError in another process.
    pub fn check(self, what: &str) -> PyResult<()> {
        match self.is_this() {
            true => Ok(()),
            false => Err(PyRuntimeError::new_err(format!(
                "{what} belongs to process {}, and this is process {}, a fork of it: make one in each process",
                self.0,
                id()
            ))),
        }
    }
}

/// Returns the threads of this process for batches of robots. A forked process starts its own.
///
/// # Errors
/// RuntimeError if the threads cannot be started.
pub fn threads(_: Python<'_>) -> PyResult<Arc<ThreadPool>> {
    // Locked only while holding Python's lock, without which no process forks.
    static THREADS: Mutex<Option<(Owner, Arc<ThreadPool>)>> = Mutex::new(None);
    let mut threads = THREADS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((owner, pool)) = threads.as_ref()
        && owner.is_this()
    {
        return Ok(pool.clone());
    }
    let pool = ThreadPoolBuilder::new().build();
    let pool = pool.map_err(|fault| PyRuntimeError::new_err(fault.to_string()))?;
    let pool = Arc::new(pool);
    // Dropping the threads of the parent would wait for them.
    std::mem::forget(threads.replace((Owner::this(), pool.clone())));
    Ok(pool)
}
