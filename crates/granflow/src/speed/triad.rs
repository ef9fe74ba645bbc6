//! What the memory can do: STREAM's triad a = b + s c (McCalpin 1995).

use std::time::Instant;

/// Three arrays.
pub struct Triad {
    arrays: [Vec<f64>; 3],
}

impl Triad {
    /// Bytes a number that pass between memory and caches: two are read, one is written and, before that, fetched. (STREAM
    /// itself leaves the last out and counts 24.)
    pub const BYTES: usize = 32;

    /// Three arrays of so many numbers.
    pub fn new(numbers: usize) -> Triad {
        // Fetched from the system here, but not yet touched: the threads that will use a part touch it first.
        Triad { arrays: [(); 3].map(|()| vec![0.0; numbers]) }
    }

    /// Numbers of an array that is as large as the largest cache, so that three are larger; of 64 MiB where that is
    /// unknown or smaller.
    pub fn beyond_caches() -> usize {
        let sizes = (0..8).filter_map(|k| {
            let file = format!("/sys/devices/system/cpu/cpu0/cache/index{k}/size");
            let text = std::fs::read_to_string(file).ok()?;
            text.trim().strip_suffix('K')?.parse::<usize>().ok()
        });
        const LEAST: usize = 64 << 10;
        const MOST: usize = 512 << 10;
        sizes.fold(LEAST, usize::max).min(MOST) * 1024 / size_of::<f64>()
    }

    /// Bytes of one array.
    pub fn size(&self) -> usize {
        self.arrays[0].len() * size_of::<f64>()
    }

    /// Bytes a second ([`Triad::BYTES`] a number) on so many threads, the best of some passes.
    pub fn bandwidth(&mut self, threads: usize, passes: usize) -> f64 {
        let bytes = (self.arrays[0].len() * Self::BYTES) as f64;
        self.pass(threads, |a, b, c| {
            a.fill(0.0);
            b.fill(1.0);
            c.fill(2.0);
        });
        let triad = |a: &mut [f64], b: &mut [f64], c: &mut [f64]| {
            for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                *a = *b + 3.0 * *c;
            }
        };
        (0..passes).map(|_| bytes / self.pass(threads, triad)).fold(0.0, f64::max)
    }

    /// Seconds that the threads take for their parts.
    fn pass(&mut self, threads: usize, work: fn(&mut [f64], &mut [f64], &mut [f64])) -> f64 {
        let part = self.arrays[0].len().div_ceil(threads).max(1);
        let [a, b, c] = self.arrays.each_mut().map(|array| array.chunks_mut(part));
        let clock = Instant::now();
        std::thread::scope(|scope| {
            for ((a, b), c) in a.zip(b).zip(c) {
                scope.spawn(move || work(a, b, c));
            }
        });
        clock.elapsed().as_secs_f64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_computed_on_any_number_of_threads() {
        for threads in [1, 3, 64] {
            let mut triad = Triad::new(1000);
            assert!(triad.bandwidth(threads, 3) > 0.0);
            assert!(triad.arrays[0].iter().all(|a| *a == 7.0), "{threads}");
        }
    }
}
