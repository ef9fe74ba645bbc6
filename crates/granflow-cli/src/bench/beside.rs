//! A program of somebody else that measures the same on the same machine, to compare with.

use std::io::Read;
use std::process::{Child, Command, Stdio};

use crate::failure::Failure;
use crate::interrupt;

/// When it ran.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// Before our rows.
    Before,
    /// After them.
    After,
}

/// One speed that it printed.
#[derive(Debug, Clone, PartialEq)]
pub struct Yardstick {
    /// When it ran.
    pub when: When,
    /// On how many threads.
    pub threads: usize,
    /// What it is called, with its grid.
    pub name: String,
    /// 10^6 cell updates a second.
    pub mcups: f64,
}

/// Runs the command by the system's shell and gives the speeds that it prints; `None` where a signal asks for the end, which
/// ends the command too.
pub fn yardsticks(command: &str, when: When) -> Result<Option<Vec<Yardstick>>, Failure> {
    let (shell, flag) = if cfg!(windows) { ("cmd", "/C") } else { ("sh", "-c") };
    let failed = |error| Failure::File(format!("cannot run `{command}`: {error}"));
    let mut shell = Command::new(shell);
    shell.args([flag, command]).stdin(Stdio::null()).stdout(Stdio::piped());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut shell, 0);
    let mut child = shell.spawn().map_err(failed)?;
    let mut out = child.stdout.take();
    let printed = interrupt::unless_asked(move || {
        let mut bytes = Vec::new();
        out.as_mut().map_or(Ok(0), |out| out.read_to_end(&mut bytes)).map(|_| bytes)
    });
    let Some(printed) = printed.filter(|_| !interrupt::is_asked()) else {
        end(&mut child);
        return Ok(None);
    };
    let status = child.wait().map_err(failed)?;
    if !status.success() {
        let message = format!("`{command}` failed: {status}");
        return Err(Failure::usage(message, "--beside takes a command that runs by itself"));
    }
    let printed = printed.map_err(failed)?;
    let text = String::from_utf8_lossy(&printed);
    let found: Vec<Yardstick> = text.lines().filter_map(|line| parse(line, when)).collect();
    if found.is_empty() {
        return Err(Failure::usage(
            format!("`{command}` printed no speed"),
            "it must print lines as `threads=2 name 2000x2000 Mcups 99.5`",
        ));
    }
    Ok(Some(found))
}

/// Ends the shell with all that it started.
#[cfg(unix)]
fn end(child: &mut Child) {
    if let Ok(group) = i32::try_from(child.id()) {
        // SAFETY: sends a signal to a group of which our child, not waited for yet, is the leader.
        unsafe { libc::kill(-group, libc::SIGTERM) };
    }
}

#[cfg(not(unix))]
fn end(child: &mut Child) {
    // It may be gone by itself.
    let _ = child.kill();
}

/// `threads=T NAME NxN Mcups X`; other lines say nothing.
fn parse(line: &str, when: When) -> Option<Yardstick> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [threads, name @ .., "Mcups", mcups] = words.as_slice() else { return None };
    let threads = threads.strip_prefix("threads=")?.parse().ok()?;
    let mcups = mcups.parse().ok().filter(|mcups: &f64| mcups.is_finite() && *mcups > 0.0)?;
    (!name.is_empty()).then(|| Yardstick { when, threads, name: name.join(" "), mcups })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_a_speed_or_nothing() {
        let line = "threads=2 kinetic 2000x2000 Mcups 99.5";
        let found = parse(line, When::After).expect("a speed");
        let name = "kinetic 2000x2000".to_owned();
        assert_eq!(found, Yardstick { when: When::After, threads: 2, name, mcups: 99.5 });
        for line in [
            "",
            "threads=1 n=20000000 triad  median 9.5 GB/s best 10.1 GB/s",
            "threads=x kinetic 9x9 Mcups 1",
            "threads=1 kinetic 9x9 Mcups",
            "threads=1 kinetic 9x9 Mcups nan",
            "threads=1 Mcups 5",
        ] {
            assert_eq!(parse(line, When::Before), None, "{line}");
        }
    }
}
