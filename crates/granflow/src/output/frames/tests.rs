use super::*;
use std::fs;

fn fields() -> Vec<Field> {
    vec![Field { name: "thickness".into(), length: 3 }, Field { name: "velocity_x".into(), length: 2 }]
}

fn three(path: &Path) -> Frames {
    let mut frames = Frames::create(path, Precision::F64, fields()).unwrap();
    for step in 0..3 {
        let t = f64::from(step);
        frames.append(t, &[&[t, f64::NAN, -0.0], &[t / 3.0, 1e-310]]).unwrap();
    }
    frames
}

#[test]
fn every_bit_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames");
    drop(three(&path));
    let (mut frames, torn) = Frames::open(&path).unwrap();
    assert_eq!((torn, frames.times()), (None, &[0.0, 1.0, 2.0][..]));
    let bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect::<Vec<_>>();
    assert_eq!(bits(frames.read(2, 0).unwrap()), bits(vec![2.0, f64::NAN, -0.0]));
    assert_eq!(frames.read(1, frames.position("velocity_x").unwrap()).unwrap(), [1.0 / 3.0, 1e-310]);
    assert!(frames.read(3, 0).is_err());
}

#[test]
fn a_torn_last_frame_is_dropped_with_a_warning_and_the_store_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames");
    let end = three(&path).end();
    for cut in [1, 30, 51] {
        OpenOptions::new().write(true).open(&path).unwrap().set_len(end - cut).unwrap();
        let (mut frames, torn) = Frames::open(&path).unwrap();
        assert_eq!(torn, Some(Torn { path: path.clone(), bytes: 52 - cut, kept: 2 }));
        frames.append(2.0, &[&[7.0; 3], &[8.0; 2]]).unwrap();
    }
    let (mut frames, torn) = Frames::open(&path).unwrap();
    assert_eq!((torn, frames.read(2, 1).unwrap()), (None, vec![8.0; 2]));
}

#[test]
fn a_wrong_checksum_drops_the_last_frame_but_refuses_an_earlier_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames");
    let end = three(&path).end() as usize;
    let sound = fs::read(&path).unwrap();
    let damage = |at: usize| {
        let mut bytes = sound.clone();
        bytes[at] ^= 1;
        fs::write(&path, bytes).unwrap();
        Frames::open(&path)
    };
    assert_eq!(damage(end - 10).unwrap().1.unwrap().kept, 2);
    let message = damage(end - 100).unwrap_err().to_string();
    assert!(message.contains("frame 1 of 3"), "{message}");
    assert!(damage(25).unwrap_err().to_string().contains("header"));
    assert!(damage(3).unwrap_err().to_string().contains("not a store"));
}

#[test]
fn truncating_goes_back_to_the_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames");
    let mut frames = three(&path);
    let three = frames.mark();
    let two = frames.mark_at(2);
    assert_eq!(frames.truncate_to(two).unwrap(), 1);
    let mut frames = Frames::open(&path).unwrap().0;
    assert_eq!((frames.times(), frames.mark()), (&[0.0, 1.0][..], two));
    let lost = frames.truncate_to(three).unwrap_err().to_string();
    assert!(lost.contains("2 sound frames") && lost.contains("from 3"), "{lost}");
    frames.append(2.0, &[&[7.0; 3], &[8.0; 2]]).unwrap();
    let other = frames.truncate_to(three).unwrap_err().to_string();
    assert!(other.contains("first 3 frames are not those"), "{other}");
    frames.truncate_to(two).unwrap();
}

#[test]
fn wrong_shapes_and_times_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut frames = three(&folder.path().join("frames"));
    assert!(frames.append(3.0, &[&[0.0; 3], &[0.0; 3]]).is_err());
    assert!(frames.append(3.0, &[&[0.0; 3]]).is_err());
    assert!(frames.append(2.0, &[&[0.0; 3], &[0.0; 2]]).is_err());
    assert!(frames.append(f64::NAN, &[&[0.0; 3], &[0.0; 2]]).is_err());
    assert_eq!(frames.times().len(), 3);
}
