//! Pools of threads, and their number by default and at most.

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::EngineError;

/// Largest number of threads for each core: more would only keep the machine busy with switching
/// between them.
const MAX_THREADS_PER_CORE: usize = 2;

/// Starts a pool of `threads` threads, or of one per core, each named after the pool.
pub(crate) fn thread_pool(
    name: &'static str,
    threads: Option<usize>,
) -> Result<ThreadPool, EngineError> {
    ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or_else(default_threads))
        .thread_name(move |index| format!("{name}-{index}"))
        .build()
        .map_err(|error| EngineError::Unsupported(format!("cannot start threads: {error}")))
}

/// Returns the default number of threads of a pool: one per core, or as many as `RAYON_NUM_THREADS`
/// says, at most two per core. Several pools can run at the same time: those of the engine, of deep
/// starts, and of the whole program.
pub fn default_threads() -> usize {
    let said = std::env::var("RAYON_NUM_THREADS").ok();
    bounded(said.as_deref(), cores()).unwrap_or_else(cores)
}

/// Returns the number of threads of a pool that runs beside one of `chosen` threads: the same
/// number, but at most two per core.
pub fn threads_beside(chosen: Option<usize>) -> Option<usize> {
    chosen.map(|threads| threads.min(MAX_THREADS_PER_CORE * cores()))
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

fn bounded(said: Option<&str>, cores: usize) -> Option<usize> {
    let threads: usize = said?.parse().ok().filter(|threads| *threads > 0)?;
    Some(threads.min(MAX_THREADS_PER_CORE * cores))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_bounded() {
        assert_eq!(bounded(Some("18446744073709551615"), 2), Some(4));
        assert_eq!(bounded(Some("3"), 64), Some(3));
        assert_eq!([bounded(Some("0"), 2), bounded(Some("all"), 2), bounded(None, 2)], [None; 3]);
        assert_eq!(threads_beside(None), None);
        assert!(threads_beside(Some(1024)).is_some_and(|threads| threads <= 2 * cores()));
    }
}
