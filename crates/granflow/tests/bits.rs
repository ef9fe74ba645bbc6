//! The fields of the cases in `cases/`, at every instant, bit for bit: as the first version of granflow computed them. A
//! change that is meant to change results changes this list and says why in CHANGELOG.md.
#![cfg(all(target_arch = "x86_64", target_os = "linux"))]

use granflow::Case;
use granflow::run::drive;
use granflow::sinks::Memory;

/// Case, and for each of its first two fields the CRC-32 of all instants, in double precision, little endian, x fastest.
/// From commit 05e479a; the larger tables are left out for their time.
const FIELDS: [(&str, [&str; 2], [u32; 2]); 13] = [
    ("constant", FLOW, [0x856d_9764, 0x23ae_e3db]),
    ("inclined_silo", FLOW, [0xa999_e37d, 0xc95e_03ae]),
    ("parabola", FLOW, [0x2970_08bd, 0x56ee_5715]),
    ("plane", FLOW, [0x97ff_1218, 0x5414_b045]),
    ("riemann", FLOW, [0xa57a_6f6f, 0x8dd2_874e]),
    ("silo", FLOW, [0xf320_dd54, 0x5292_1250]),
    ("sine", FLOW, [0x7cea_04fd, 0xd784_0f15]),
    ("sandpile_1d", PILE, [0xf303_6efd, 0xf579_71e8]),
    ("sandpile_l", PILE, [0xed04_9031, 0x501e_df89]),
    ("sandpile_moving", PILE, [0x70d2_463c, 0x72a1_b135]),
    ("sandpile_source", PILE, [0xbf5c_b4a2, 0xfc11_7d28]),
    ("sandpile_switched", PILE, [0x38e1_c077, 0x424f_448d]),
    ("silo_hole", PILE, [0x3f88_bf96, 0x8800_e11d]),
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
