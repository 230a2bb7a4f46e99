//! Starts this program again in another environment: a variable must be right before a library reads
//! it, and setting it here would race with threads that read it.

use std::convert::Infallible;
use std::env;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::Command;

/// Starts the program again with the same arguments after `change` has set its environment. Returns
/// only on failure.
pub(super) fn again(change: impl FnOnce(&mut Command)) -> io::Result<Infallible> {
    let mut arguments = env::args_os();
    let name = arguments.next().unwrap_or_else(|| "flipmap".into());
    let mut command = Command::new(env::current_exe()?);
    command.arg0(name).args(arguments);
    change(&mut command);
    Err(command.exec())
}
