//! A process that is killed: how long until another one that sleeps has learned of it.

use std::io;
use std::path::Path;
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::Instant;

use container::host::BareDeath;

use super::real_time::{PRIORITY, ask_for_real_time};
use crate::commands::bench::offspring::end_with_parent;

/// A process to be killed.
struct Mortal {
    death: BareDeath,
    process: Child,
}

/// Starts a process, kills it, and waits until its death is known; nanoseconds from just before it
/// was killed.
///
/// # Errors
/// If it cannot be started or does not die.
pub(super) fn time_death() -> io::Result<u64> {
    let death = BareDeath::create()?;
    let process = Command::new(std::env::current_exe()?)
        .args(["bench", "mortal"])
        .arg(death.path())
        .stdin(Stdio::null())
        .spawn()?;
    let mut mortal = Mortal { death, process };
    mortal.death.wait_for_life()?;
    let start = Instant::now();
    mortal.process.kill()?;
    mortal.death.wait_for_death()?;
    Ok(u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX))
}

impl Drop for Mortal {
    fn drop(&mut self) {
        // If it has ended already both fail, which is as well.
        let _ended_already = self.process.kill();
        let _ended_already = self.process.wait();
    }
}

/// Lives, in the process that was started for it, until it is killed.
pub fn run_mortal(path: &Path) -> ExitCode {
    let _without = ask_for_real_time(PRIORITY);
    let lived = end_with_parent().and_then(|()| BareDeath::live(path));
    match lived {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("steadfast bench mortal: {error}");
            ExitCode::from(2)
        }
    }
}
