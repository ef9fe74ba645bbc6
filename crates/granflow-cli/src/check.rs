//! `granflow check`: what a case would compute, and how large it is.

use granflow::Checked;

use crate::failure::{Failure, print};

/// Prints the resolved case and the estimates.
pub fn check(case: Checked) -> Result<(), Failure> {
    let notes: String = case.plan().notes.iter().map(|note| format!("note: {note}\n")).collect();
    let resolved = case.plan().resolved();
    let lines = case.describe()?;
    let text: String = lines.iter().map(|(name, value)| format!("{name:16} {value}\n")).collect();
    print(&format!("{text}{notes}\nThe case is in order. Resolved (angles in radians):\n\n{resolved}"))
}
