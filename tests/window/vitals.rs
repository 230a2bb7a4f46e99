//! Memory, file handles and threads of a running process.

use std::fs;
use std::time::{Duration, Instant};

/// Measurements of a process at one time.
#[derive(Clone, Copy, Debug)]
struct Vitals {
    resident_mib: u64,
    handles: u64,
    threads: u64,
}

impl Vitals {
    fn of(id: u32) -> Self {
        let status = fs::read_to_string(format!("/proc/{id}/status")).unwrap();
        let number = |key: &str| -> u64 {
            let line = status.lines().find_map(|line| line.strip_prefix(key)).expect(key);
            line.split_whitespace().next().expect(key).parse().expect(key)
        };
        let handles = fs::read_dir(format!("/proc/{id}/fd")).unwrap().count() as u64;
        Vitals { resident_mib: number("VmRSS:") >> 10, handles, threads: number("Threads:") }
    }
}

/// Measures a process forty times while it is watched.
pub(crate) struct Watch {
    id: u32,
    begun: Instant,
    every: Duration,
    looks: Vec<Vitals>,
}

impl Watch {
    /// Number of handles or threads by which a process may vary without a leak: those of a lost
    /// graphics device stay open for a moment after its successor has opened its own.
    const LOOSE: u64 = 24;
    /// Duration from which on memory does not grow any more.
    const STEADY: Duration = Duration::from_secs(60);

    pub(crate) fn new(id: u32, duration: Duration) -> Self {
        Watch { id, begun: Instant::now(), every: duration / 40, looks: Vec::new() }
    }

    /// Measures if it is time; prints every fourth measurement.
    pub(crate) fn look(&mut self) {
        let taken = self.looks.len() as u32;
        if self.begun.elapsed() < self.every * (taken + 1) {
            return;
        }
        let now = Vitals::of(self.id);
        self.looks.push(now);
        if taken % 4 == 3 {
            let Vitals { resident_mib, handles, threads } = now;
            let secs = self.begun.elapsed().as_secs();
            println!("{secs} s: {resident_mib} MiB resident, {handles} handles, {threads} threads");
        }
    }

    /// Panics if the second half of the time used more handles or threads than the first, or, over
    /// minutes, half as much memory again: in half a minute a window still opens things that it keeps.
    pub(crate) fn check(&self) {
        let (first, second) = self.looks.split_at(self.looks.len() / 2);
        for (what, of) in [
            ("handles", (|look| look.handles) as fn(&Vitals) -> u64),
            ("threads", |look| look.threads),
        ] {
            let [before, after] = [first, second].map(|half| half.iter().map(of).max());
            assert!(after <= before.map(|most| most + Self::LOOSE), "{what}: {:?}", self.looks);
        }
        if self.begun.elapsed() < Self::STEADY {
            return;
        }
        let [before, after] =
            [first, second].map(|half| half.iter().map(|look| look.resident_mib).max());
        assert!(after <= before.map(|most| most + most / 2), "memory: {:?}", self.looks);
    }
}
