//! Changes to bytes: some blind, some that know what numbers and words look like.

/// Numbers that readers get wrong.
const NUMBERS: [&str; 16] = [
    "0",
    "-1",
    "1e308",
    "-1e308",
    "1e-320",
    "nan",
    "inf",
    "-0.0",
    "2147483647",
    "4294967296",
    "9223372036854775807",
    "18446744073709551616",
    "1e18",
    "0.5",
    "1",
    "99999999",
];
/// Whole numbers that readers get wrong, to be cut to any width.
const WHOLE: [u64; 12] =
    [0, 1, 2, 0x7f, 0xff, 0x7fff, 0xffff, 0x7fff_ffff, 0xffff_ffff, 1 << 40, u64::MAX / 2, u64::MAX];

/// A stream of numbers that its seed decides (splitmix64, Steele, Lea and Flood 2014).
#[derive(Debug, Clone)]
pub struct Dice(pub u64);

impl Dice {
    /// A number below `end`; 0 where `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % end.max(1) as u64) as usize
    }

    /// One of a list.
    pub fn of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
}

/// A changed copy of one of the seeds.
pub fn mutated(seeds: &[Vec<u8>], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = dice.of(seeds).clone();
    for _ in 0..=dice.below(4) {
        change(&mut bytes, seeds, dice);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, seeds: &[Vec<u8>], dice: &mut Dice) {
    let at = dice.below(bytes.len());
    let piece = at..(at + 1 + dice.below(24)).min(bytes.len());
    match dice.below(10) {
        0 => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << dice.below(8)),
        1 => bytes.truncate(at),
        2 => drop(bytes.drain(piece)),
        3 => {
            let copy = bytes[piece].to_vec();
            let times = 1 << dice.below(8);
            bytes.splice(at..at, copy.repeat(times));
        }
        4 | 5 => {
            let whole = dice.of(&WHOLE).wrapping_add(dice.below(3) as u64).wrapping_sub(1);
            let width = 1 << dice.below(4);
            let ends = [whole.to_le_bytes(), whole.to_be_bytes()];
            let new = if dice.below(3) > 0 { &ends[0][..width] } else { &ends[1][8 - width..] };
            let end = (at + width).min(bytes.len());
            bytes.splice(at..end, new.iter().copied());
        }
        6 | 7 => replace_number(bytes, at, NUMBERS[dice.below(NUMBERS.len())]),
        8 => {
            let other = dice.of(seeds);
            let from = dice.below(other.len());
            let end = (from + 1 + dice.below(40)).min(other.len());
            bytes.splice(piece, other[from.min(end)..end].iter().copied());
        }
        _ => bytes.insert(at, *dice.of(b"[](){}\"'=,;:\n\0\x1b-.eE\xff\xc3")),
    }
}

/// Puts `text` in the place of the first number behind `at`.
fn replace_number(bytes: &mut Vec<u8>, at: usize, text: &str) {
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit).map(|start| at + start) else { return };
    let part = |byte: &u8| byte.is_ascii_digit() || b".eE+-_".contains(byte);
    let end = start + bytes[start..].iter().take_while(|byte| part(byte)).count();
    bytes.splice(start..end, text.bytes());
}
