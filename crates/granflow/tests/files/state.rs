//! The state of a run that somebody holds, on the disk and back.

use super::*;
use granflow::Inputs;
use granflow::session::{restore, save};

fn thickness(run: &dyn Run) -> Vec<u64> {
    run.field("thickness").unwrap().iter().map(f64::to_bits).collect()
}

#[test]
fn a_state_goes_on_with_the_same_bits_and_only_for_its_case() {
    let folder = tempfile::tempdir().unwrap();
    let case = slope(folder.path(), "[\"netcdf\"]");
    let path = folder.path().join("states/one.bin");
    let checked = case.check().unwrap();
    let made_of = origin(checked.plan(), &Inputs::default()).unwrap();
    let mut run = checked.start().unwrap();
    run.until(3.0).unwrap();
    save(&mut *run, &made_of, &path).unwrap();
    run.to_rest(200.0).unwrap();
    let mut again = case.check().unwrap().start().unwrap();
    assert_eq!(restore(&mut *again, &made_of, &path).unwrap().len(), 0);
    assert_eq!(again.time(), 3.0);
    again.to_rest(200.0).unwrap();
    assert_eq!((again.steps(), thickness(&*again)), (run.steps(), thickness(&*run)));

    let mu = ["material.friction.coulomb.mu=0.3".to_owned()];
    let softer = Case::read_with(folder.path().join("case.toml"), &mu).unwrap().check().unwrap();
    let other = origin(softer.plan(), &Inputs::default()).unwrap();
    let changes = restore(&mut *again, &other, &path).unwrap();
    assert!(changes[0].to_string().contains("mu = 0.3"), "{changes:?}");
    fs::write(folder.path().join("slope.asc"), "another mountain").unwrap();
    let moved = origin(softer.plan(), &Inputs::default()).unwrap();
    let refused = restore(&mut *again, &moved, &path).unwrap_err().to_string();
    assert!(refused.contains("one.bin") && refused.contains("slope.asc is not what"), "{refused}");
}

/// A resume looked every number of a layer or a forest up by its name: what a checkpoint names grows with the case, not with its cells.
#[test]
fn a_layer_and_a_forest_are_saved_as_arrays() {
    let folder = tempfile::tempdir().unwrap();
    slope(folder.path(), "[\"netcdf\"]");
    let changes = [
        "entrainment={ layer = 0.3, law = \"plough\" }",
        "material.forest=0.02",
        "material.forest_breaks_at=1.0",
    ];
    let case = with(&folder.path().join("case.toml"), &changes);
    let path = folder.path().join("one.bin");
    let checked = case.check().unwrap();
    let made_of = origin(checked.plan(), &Inputs::default()).unwrap();
    let mut run = checked.start().unwrap();
    run.until(6.0).unwrap();
    save(&mut *run, &made_of, &path).unwrap();
    let bytes = fs::read(&path).unwrap();
    let begin = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    let length = u32::from_le_bytes(bytes[begin..begin + 4].try_into().unwrap());
    assert!(length < 5000, "the head has {length} bytes for {} cells", 30 * 60);
    run.to_rest(200.0).unwrap();
    let mut again = case.check().unwrap().start().unwrap();
    assert_eq!(restore(&mut *again, &made_of, &path).unwrap().len(), 0);
    again.to_rest(200.0).unwrap();
    assert_eq!((again.steps(), thickness(&*again)), (run.steps(), thickness(&*run)));
}
