//! `granflow`: where a granular mass comes to rest.

use std::process::ExitCode;

fn main() -> ExitCode {
    granflow_cli::run_command_line(std::env::args_os().collect()).into()
}
