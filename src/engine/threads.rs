//! The number of threads that nobody chose.

/// Largest number of threads: beyond it a machine is only kept busy with the threads themselves.
const MOST_THREADS: usize = 1024;

/// Number of threads by default: one per core, or as many as `RAYON_NUM_THREADS` says, at most 1024.
pub fn default_threads() -> usize {
    let said = std::env::var("RAYON_NUM_THREADS").ok();
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    bounded(said.as_deref()).unwrap_or_else(cores)
}

fn bounded(said: Option<&str>) -> Option<usize> {
    let threads = said?.parse().ok().filter(|threads| *threads > 0)?;
    Some(MOST_THREADS.min(threads))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_bounded() {
        assert_eq!(bounded(Some("100000")), Some(1024));
        assert_eq!([bounded(Some("3")), bounded(Some("0")), bounded(None)], [Some(3), None, None]);
    }
}
