//! How much memory there is, so that what cannot fit is refused before it is asked for.

/// Bytes that a program may still take: what the system says is available, swap too, within the limit of a container; `None`
/// where the system does not tell.
#[must_use]
pub fn available() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let free = free(&text)?;
    let limit = std::fs::read_to_string("/sys/fs/cgroup/memory.max").ok();
    Some(limit.and_then(|limit| limit.trim().parse().ok()).map_or(free, |limit: u64| limit.min(free)))
}

/// What is available after `/proc/meminfo`.
fn free(text: &str) -> Option<u64> {
    let of = |name: &str| -> Option<u64> {
        let rest = text.lines().find_map(|line| line.strip_prefix(name))?;
        rest.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kilo| 1024 * kilo)
    };
    Some(of("MemAvailable:")? + of("SwapFree:").unwrap_or(0))
}

/// A number of bytes in words, as in "1.5 GB".
#[must_use]
pub fn in_words(bytes: f64) -> String {
    let (value, unit) = match bytes {
        ..1e6 => (bytes / 1e3, "kB"),
        ..1e9 => (bytes / 1e6, "MB"),
        ..1e12 => (bytes / 1e9, "GB"),
        _ => (bytes / 1e12, "TB"),
    };
    format!("{value:.1} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn available_memory_is_that_of_the_system_with_its_swap() {
        let text = "MemTotal:       24684032 kB\nMemAvailable:   1000 kB\nSwapFree:          24 kB\n";
        assert_eq!(free(text), Some(1024 * 1024));
        assert_eq!(free("MemTotal: 1 kB\n"), None);
        if cfg!(target_os = "linux") {
            assert!(available().unwrap() > 1 << 20);
        }
    }

    #[test]
    fn bytes_are_said_in_words() {
        assert_eq!([8e3, 2.34e8, 1e9, 3e13].map(in_words), ["8.0 kB", "234.0 MB", "1.0 GB", "30.0 TB"]);
    }
}
