//! What a run takes from the machine.

use miette::{IntoDiagnostic, Result};

/// Works with so many threads from here on; one per processor if none are named.
pub fn choose_threads(threads: Option<usize>) -> Result<()> {
    let Some(threads) = threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().into_diagnostic()
}

/// Most memory the program held at once, MiB; none where the system does not tell in a file.
pub fn peak_memory_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    parse_peak_kib(&status).map(|kib| kib / 1024.0)
}

/// Lets [`peak_memory_mib`] count from here on: 5 resets the high-water mark to what is held now (Linux, proc(5),
/// `clear_refs`). Whether it did.
pub fn forget_peak_memory() -> bool {
    std::fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// The line `VmHWM:   123456 kB` of Linux's process status; its "kB" are KiB (proc(5)).
fn parse_peak_kib(status: &str) -> Option<f64> {
    let value = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    value.trim().strip_suffix("kB")?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_high_water_mark_is_found() {
        assert_eq!(parse_peak_kib("Name:\tcutis\nVmPeak:\t 9000 kB\nVmHWM:\t    2048 kB\n"), Some(2048.0));
        assert_eq!(parse_peak_kib("Name:\tcutis\n"), None);
    }
}
