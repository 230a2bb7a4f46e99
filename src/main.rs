//! The `flipmap` program: runs the command line and turns errors into exit codes.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

mod cli;

use std::process::ExitCode;

use flipmap_engine::threads::default_threads;

fn main() -> ExitCode {
    env_logger::Builder::from_env(
        env_logger::Env::default().default_filter_or("error,arboard=off,wgpu_hal=off"),
    )
    .init();
    #[cfg(unix)]
    cli::stop::outlive_full_files();
    #[cfg(unix)]
    cli::driver_cache::do_without_on_a_full_disk();
    let threads = rayon::ThreadPoolBuilder::new().num_threads(default_threads());
    // A failure is ignored here: an engine that cannot start its own threads reports the reason.
    let _ = threads.build_global();
    match cli::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => cli::exit::report(&error),
    }
}
