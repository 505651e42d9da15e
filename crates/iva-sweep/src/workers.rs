//! The worker threads of sweeps.

use std::process;
use std::sync::{Arc, Mutex};
use std::thread;

use iva_core::error::Invalid;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::sweep::SweepError;

/// Largest number of worker threads.
pub const MAX_THREADS: usize = 1024;

/// The threads that share the work of one or more sweeps.
pub struct Workers(Option<Arc<ThreadPool>>);

impl Workers {
    /// The thread that asks for the work: where one thread alone hands out work, this is one worker without
    /// the time that it takes to start and to wake another.
    pub fn caller() -> Self {
        Self(None)
    }

    /// A number of threads; `None`: one per core. They wait for the next sweep of this process with as many
    /// workers.
    ///
    /// # Errors
    /// [`SweepError`] for a count of zero or beyond [`MAX_THREADS`], or threads that do not start.
    pub fn new(threads: Option<usize>) -> Result<Self, SweepError> {
        // Without a number rayon would read it from the environment, without this limit.
        let cores = || thread::available_parallelism().map_or(1, usize::from).min(MAX_THREADS);
        let threads = threads.unwrap_or_else(cores);
        if !(1..=MAX_THREADS).contains(&threads) {
            let allowed = format!("give a whole number, 1 or greater, at most {MAX_THREADS}");
            return Err(Invalid::new("threads", threads, allowed).into());
        }
        Ok(Self(Some(pool(threads)?)))
    }

    /// Number of threads.
    pub fn count(&self) -> usize {
        self.0.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// The results of the work on each of the numbers below `count`, in order.
    pub(crate) fn map<T: Send>(&self, count: u64, work: impl Fn(u64) -> T + Sync + Send) -> Vec<T> {
        match &self.0 {
            None => (0..count).map(work).collect(),
            Some(pool) => pool.install(|| (0..count).into_par_iter().map(work).collect()),
        }
    }

    /// The result for the smallest of the numbers below `count` for which the work gives one.
    pub(crate) fn first<T: Send>(
        &self,
        count: u64,
        work: impl Fn(u64) -> Option<T> + Sync + Send,
    ) -> Option<T> {
        match &self.0 {
            None => (0..count).find_map(work),
            Some(pool) => pool.install(|| (0..count).into_par_iter().find_map_first(work)),
        }
    }
}

/// The stack of a thread that runs scenes: those of 64 members in twice the precision have several copies of 100 kB on it while they are built.
pub const STACK: usize = 16 << 20;

/// The pool that was asked for last, and the process that started its threads: a forked one has none of them.
static LAST: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// A pool of so many threads: the last one, if it fits, else a new one.
fn pool(threads: usize) -> Result<Arc<ThreadPool>, SweepError> {
    let builder = || ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK);
    let start = || Ok(Arc::new(builder().build()?));
    // A process forked while the lock was held would wait for it forever.
    let Ok(mut last) = LAST.try_lock() else { return start() };
    match &*last {
        Some((process, pool))
            if *process == process::id() && pool.current_num_threads() == threads =>
        {
            Ok(Arc::clone(pool))
        }
        _ => {
            let pool = start()?;
            let before = last.replace((process::id(), Arc::clone(&pool)));
            if let Some((process, lost)) = before
                && process != process::id()
            {
                // Its threads live in another process, and cannot be told to end.
                std::mem::forget(lost);
            }
            Ok(pool)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_whatever_the_number_of_workers() {
        let of = |threads| (threads, Workers::new(Some(threads)).unwrap());
        for (threads, workers) in [(1, Workers::caller()), of(1), of(2), of(3)] {
            assert_eq!(workers.count(), threads);
            assert_eq!(workers.map(100, |n| n * n), (0..100).map(|n| n * n).collect::<Vec<_>>());
            assert_eq!(workers.first(100, |n| (n > 41).then_some(n)), Some(42));
            assert_eq!(workers.first(100, |n| (n > 99).then_some(n)), None);
        }
    }

    #[test]
    fn threads_wait_for_the_next_sweep() {
        let of = |workers: &Workers| workers.0.as_ref().map(Arc::as_ptr);
        // Other tests ask for pools of other sizes meanwhile.
        let same = (0..1000).any(|_| {
            let (one, other) = (Workers::new(Some(5)).unwrap(), Workers::new(Some(5)).unwrap());
            of(&one) == of(&other)
        });
        assert!(same);
    }
}
