//! `granflow schema`: the JSON Schema of the case file.

use crate::failure::{Failure, print};

/// Prints the JSON Schema.
pub fn schema() -> Result<(), Failure> {
    print(&format!("{:#}\n", granflow::case::json_schema()))
}
