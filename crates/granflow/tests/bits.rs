//! The fields of the cases in `cases/`, at every instant, bit for bit: as they are since no step is cut at an instant. A
//! change that is meant to change results changes this list and says why in CHANGELOG.md.
#![cfg(all(target_arch = "x86_64", target_os = "linux"))]

use granflow::Case;
use granflow::run::drive;
use granflow::sinks::Memory;

/// Case, and for each of its first two fields the CRC-32 of all instants, in double precision, little endian, x fastest.
/// Steps are those of commit 05e479a but for the cuts: without instants between start and end both have the same last state. The
/// larger tables are left out for their time.
const FIELDS: [(&str, [&str; 2], [u32; 2]); 13] = [
    ("constant", FLOW, [0x856d_9764, 0x23ae_e3db]),
    ("inclined_silo", FLOW, [0x7d1c_451d, 0x203e_c4d5]),
    ("parabola", FLOW, [0x18a1_d9ac, 0xa2d7_d245]),
    ("plane", FLOW, [0xa41e_0daa, 0x1d7e_10f9]),
    ("riemann", FLOW, [0xe33e_0436, 0x08c8_6780]),
    ("silo", FLOW, [0x07b1_05a4, 0xf44d_f9c7]),
    ("sine", FLOW, [0x4c03_8cfe, 0x1a74_6ac6]),
    ("sandpile_1d", PILE, [0xa3e6_33fa, 0x9969_e555]),
    ("sandpile_l", PILE, [0x180d_7584, 0xf5e6_7d50]),
    ("sandpile_moving", PILE, [0x3d21_10cd, 0x3342_5eca]),
    ("sandpile_source", PILE, [0x4553_31d8, 0xaba1_8ffd]),
    ("sandpile_switched", PILE, [0xd796_b0bc, 0xb595_7183]),
    ("silo_hole", PILE, [0x26ef_6c23, 0x36c3_9ab7]),
];
const FLOW: [&str; 2] = ["thickness", "velocity_x"];
const PILE: [&str; 2] = ["standing_layer", "rolling_layer"];

#[test]
fn the_cases_have_the_bits_they_had() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases");
    for (name, fields, sums) in FIELDS {
        let checked = Case::read(format!("{folder}/{name}.toml")).unwrap().check().unwrap();
        let plan = checked.plan().clone();
        let mut run = checked.start().unwrap();
        let mut memory = Memory::begin(&mut *run, plan.output.frames, &fields);
        drive(&mut *run, &plan.ends, &mut [&mut memory]).unwrap();
        let recording = memory.finish(&mut *run);
        for (field, expected) in fields.into_iter().zip(sums) {
            let mut sum = crc32fast::Hasher::new();
            for value in recording.field(field).unwrap().iter().flatten() {
                sum.update(&value.to_le_bytes());
            }
            assert_eq!(sum.finalize(), expected, "{field} of {name}, {} instants", recording.times.len());
        }
    }
}
