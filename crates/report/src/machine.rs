//! The machine that a report was measured on.

use serde::Serialize;

/// The machine, the program and the day.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Machine {
    /// The processor's model.
    pub cpu: String,
    /// Cores that this process may use.
    pub cores: usize,
    /// Operating system and architecture.
    pub os: String,
    /// The engines with their adapters and drivers, SIMD width and threads.
    pub engines: Vec<String>,
    /// Version of flipmap.
    pub flipmap: String,
    /// Year-month-day, UTC, of the measurement.
    pub date: String,
}

impl Machine {
    /// The machine that this process runs on, with the engines found on it.
    pub(crate) fn here(engines: Vec<String>) -> Self {
        Machine {
            cpu: cpu_model(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            os: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            engines,
            flipmap: env!("CARGO_PKG_VERSION").to_string(),
            date: jiff::Timestamp::now().strftime("%Y-%m-%d").to_string(),
        }
    }
}

/// The processor's name on Linux and Windows; elsewhere its architecture.
fn cpu_model() -> String {
    let listed = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = listed.lines().find_map(|line| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == "model name").then(|| value.trim().to_string())
    });
    model
        .or_else(|| std::env::var("PROCESSOR_IDENTIFIER").ok())
        .unwrap_or_else(|| std::env::consts::ARCH.to_string())
}
