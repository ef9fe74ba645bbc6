use super::super::inputs::Input;
use super::*;
use std::fs;

const MARKS: Marks = Marks {
    frames: Mark { count: 3, crc: 0xdead_beef },
    ledger: Mark { count: u64::MAX, crc: 1 },
    series: [Mark { count: 7, crc: 2 }, Mark { count: 0, crc: 0 }],
};

fn origin(title: &str, crc: u32) -> Origin {
    let case = format!("model = \"{title}\"");
    Origin { case, inputs: vec![Input { name: "dem.asc".into(), bytes: 7, crc }] }
}

fn double(values: impl IntoIterator<Item = f64>) -> Numbers<'static> {
    Numbers::Double(values.into_iter().collect())
}

fn sample() -> Checkpoint<'static> {
    Checkpoint {
        origin: origin("x", 9),
        past: Past { commands: vec!["run".into()], events: vec!["went on".into()], mixed: true },
        ended: None,
        step: u64::MAX,
        time: 0.1 + 0.2,
        scalars: vec![("mass".into(), -0.0), ("peak".into(), f64::INFINITY)],
        arrays: vec![
            ("thickness".into(), double([1.0, f64::from_bits(0x7ff8_0000_0000_beef), 5e-324])),
            ("nothing".into(), double([])),
            ("momentum".into(), double((0..70_000).map(|i| f64::from(i).sin()))),
            ("peak_speed".into(), Numbers::Single(Cow::Borrowed(&[0.1, f32::MIN_POSITIVE]))),
        ],
    }
}

#[test]
fn every_bit_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint/state");
    let written = sample();
    written.write(&path, MARKS).unwrap();
    let (mut read, marks, changes) = Checkpoint::read(&path, &written.origin).unwrap();
    assert_eq!((marks, read.ended, &read.origin), (MARKS, None, &written.origin));
    assert_eq!((&read.past, changes), (&written.past, Vec::new()));
    let bytes = |numbers: Option<&Numbers>| {
        let mut bytes = Vec::new();
        numbers.unwrap().encode(&mut bytes);
        bytes
    };
    assert_eq!((read.step, read.time.to_bits()), (u64::MAX, written.time.to_bits()));
    assert_eq!(read.scalar("mass").unwrap().to_bits(), (-0.0_f64).to_bits());
    assert_eq!(read.scalars, written.scalars);
    for name in ["thickness", "nothing", "momentum", "peak_speed"] {
        assert_eq!(bytes(read.array(name)), bytes(written.array(name)), "{name}");
    }
    assert_eq!(read.take("peak_speed").unwrap(), [f64::from(0.1_f32), f64::from(f32::MIN_POSITIVE)]);
    assert!(read.array("absent").is_none());
}

#[test]
fn damage_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state");
    let sample = sample();
    sample.write(&path, MARKS).unwrap();
    let sound = fs::read(&path).unwrap();
    let message = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        Checkpoint::read(&path, &sample.origin).unwrap_err().to_string()
    };
    for cut in [MAGIC.len() + 2, MAGIC.len() + 20, sound.len() / 2, sound.len() - 1] {
        assert!(message(&sound[..cut]).contains("truncated"), "{cut}");
    }
    for at in [MAGIC.len() + 40, sound.len() / 2, sound.len() - 1] {
        let mut bytes = sound.clone();
        bytes[at] ^= 0x10;
        assert!(message(&bytes).contains("checksum"), "{at}");
    }
    assert!(message(b"hello").contains("not a checkpoint"));
    assert!(message(b"granflow checkpoint 9\n").contains("layout"));
    assert!(message(&[&sound[..], b"x"].concat()).contains("checksum"));
}

#[test]
fn another_case_or_version_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state");
    sample().write(&path, MARKS).unwrap();
    let other = Checkpoint::read(&path, &origin("y", 9)).unwrap_err();
    assert!(matches!(other, Error::Mismatch { .. }) && other.to_string().contains("another case"));
    let other = Checkpoint::read(&path, &origin("x", 8)).unwrap_err();
    assert!(matches!(other, Error::Mismatch { .. }) && other.to_string().contains("dem.asc is not what"));
    let mut bytes = fs::read(&path).unwrap();
    let at = bytes.windows(VERSION.len()).position(|window| window == VERSION.as_bytes()).unwrap();
    bytes[at] = b'9';
    let end = bytes.len() - 4;
    let crc = crc32fast::hash(&bytes[..end]);
    bytes[end..].copy_from_slice(&crc.to_le_bytes());
    fs::write(&path, bytes).unwrap();
    let other = Checkpoint::read(&path, &origin("x", 9)).unwrap_err().to_string();
    assert!(other.contains("written by granflow 9"), "{other}");
}
