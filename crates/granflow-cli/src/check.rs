//! `granflow check`: what a case would compute, and how large it is.

use granflow::Case;

use crate::failure::{Failure, print};
use crate::progress::LongWork;
use crate::run::SET_UP;

/// Prints the estimates and the case with its defaults.
pub fn check(case: &Case) -> Result<(), Failure> {
    let checked = case.check()?;
    let notes: String = checked.plan().notes.iter().map(|note| format!("note: {note}\n")).collect();
    let work = LongWork::new(false, SET_UP);
    let lines = checked.describe()?;
    drop(work);
    let text: String = lines.iter().map(|(name, value)| format!("{name:16} {value}\n")).collect();
    let resolved = case.to_toml();
    print(&format!("{text}{notes}\nThe case is in order. Resolved (angles in radians):\n\n{resolved}"))
}
