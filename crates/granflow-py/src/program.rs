//! The program `granflow`, for the script that the package installs.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Does what a command line asks for; returns the exit status.
#[pyfunction]
pub fn program(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| granflow_cli::run_command_line(words))
}
