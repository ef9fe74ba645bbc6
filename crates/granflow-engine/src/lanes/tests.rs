//! Every kind of lanes that this machine has gives what one number at a time gives, to the bit.

use super::level::*;
use super::vector::{MAX_LANES, SimdVector};
use granflow_model::real::Real;
use std::array::from_fn;

crate::contexts!();

/// Something to be tried on every kind of lanes.
trait Trial {
    fn with_scalar<L: SimdVector>(&self, inside: impl SimdContext);
}

impl<T: Trial> SimdKernel for &T {
    type Output = ();
    fn run<L: SimdVector>(self, inside: impl SimdContext) {
        self.with_scalar::<L>(inside);
    }
}

/// On every kind that this processor has.
fn everywhere(trial: &impl Trial) {
    for simd in [SimdLevel::Scalar, SimdLevel::Avx2, SimdLevel::Best] {
        simd.run::<Here, _>(trial);
    }
}

/// Random bits (Marsaglia's xorshift).
struct Dice(u64);

impl Dice {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    /// Of the numbers that the doubles are made of: odd ones, sines, sines close to an end, any size at all.
    fn number(&mut self, mood: u64) -> f64 {
        const ODD: [f64; 16] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.5,
            -0.5,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN,
            f64::MIN_POSITIVE,
            5e-324,
            -1e-310,
            1.0 - f64::EPSILON / 2.0,
            1.0 + f64::EPSILON,
        ];
        let sine = (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        match mood {
            0 => ODD[self.bits() as usize % ODD.len()],
            1 => sine,
            2 => 0.5 * sine,
            3 => (1.0 - sine * sine * 1e-9).copysign(sine),
            4 => 1.0_f64.copysign(sine),
            _ => f64::from_bits(self.bits()),
        }
    }
    /// A vector's worth: of one mood, or of two.
    fn numbers(&mut self) -> [f64; MAX_LANES] {
        let moods: [u64; 2] = from_fn(|_| self.bits() % 6);
        let mixed = self.bits().is_multiple_of(2);
        from_fn(|_| {
            let mood = moods[usize::from(mixed) * (self.bits() % 2) as usize];
            self.number(mood)
        })
    }
}

struct Formulas;

impl Formulas {
    /// What is tried; in the first `CHOSEN` one of the numbers is chosen.
    #[inline(always)]
    fn of<R: Real>([x, y, z]: [R; 3]) -> [R; 8] {
        let [arc, root] = x.asin_and_cos();
        [x.min(y), x.max(y), x.mul_add(y, z), arc, root, x.sqrt(), x / y, x.ln()]
    }
    const CHOSEN: usize = 2;
}

impl Trial for Formulas {
    fn with_scalar<L: SimdVector>(&self, inside: impl SimdContext) {
        let mut dice = Dice(0x9e37_79b9_7f4a_7c15);
        for _ in 0..20_000 {
            let numbers: [[f64; MAX_LANES]; 3] = from_fn(|_| dice.numbers());
            let mut in_strip = [[0.0; MAX_LANES]; 8];
            inside.call(
                #[inline(always)]
                || {
                    // SAFETY: no vector is longer.
                    let vectors = from_fn(|k| unsafe { L::load(numbers[k].as_ptr()) });
                    for (place, value) in in_strip.iter_mut().zip(Self::of::<L>(vectors)) {
                        // SAFETY: as above.
                        unsafe { value.store(place.as_mut_ptr()) };
                    }
                },
            );
            for lane in 0..L::WIDTH {
                let operands: [f64; 3] = from_fn(|k| numbers[k][lane]);
                for (formula, expected) in Self::of(operands).into_iter().enumerate() {
                    let found = in_strip[formula][lane];
                    // Which not-a-number an operation gives is nobody's promise; one that was chosen is as it was.
                    let none = formula >= Self::CHOSEN && expected.is_nan() && found.is_nan();
                    assert!(
                        none || found.to_bits() == expected.to_bits(),
                        "formula {formula} of {operands:?} in lane {lane} of {}: {found:e}, not {expected:e}",
                        L::WIDTH
                    );
                }
            }
        }
    }
}

#[test]
fn formulas_on_lanes_are_those_of_one_number() {
    everywhere(&Formulas);
}

struct Masks;

impl Trial for Masks {
    fn with_scalar<L: SimdVector>(&self, inside: impl SimdContext) {
        let mut dice = Dice(0x2545_f491_4f6c_dd1d);
        let numbers: [f64; MAX_LANES] = from_fn(|k| 1.0 + k as f64);
        let whole = (1_u64 << L::WIDTH) - 1;
        let random: [u64; 200] = from_fn(|_| dice.bits());
        for wanted in [0, 1, whole >> 1, whole & !1, whole, u64::MAX].into_iter().chain(random) {
            let (mut read, mut written) = ([9.0; MAX_LANES], [-1.0; MAX_LANES]);
            let (bits, all, any) = inside.call(
                #[inline(always)]
                || {
                    let mask = L::from_bits(wanted);
                    for k in 0..L::WIDTH {
                        assert_eq!(L::holds(mask, k), wanted >> k & 1 == 1);
                    }
                    // SAFETY: no vector is longer.
                    unsafe {
                        L::load_where(mask, numbers.as_ptr()).store(read.as_mut_ptr());
                        L::load(numbers.as_ptr()).store_where(mask, written.as_mut_ptr());
                    }
                    (L::bits(mask), L::all(mask), L::any(mask))
                },
            );
            assert_eq!((bits, all, any), (wanted & whole, bits == whole, bits > 0));
            for k in 0..MAX_LANES {
                let holds = bits >> k & 1 == 1;
                assert_eq!(written[k], if holds { numbers[k] } else { -1.0 });
                let expected = if holds { numbers[k] } else { 0.0 };
                assert_eq!(read[k], if k < L::WIDTH { expected } else { 9.0 });
            }
        }
    }
}

#[test]
fn masks_hold_in_the_lanes_of_their_bits() {
    everywhere(&Masks);
}
