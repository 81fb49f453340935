//! Memory: what this process has taken, and what it may take.

/// The largest resident size of this process so far, where the system tells it.
pub fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    kilobytes(&status, "VmHWM:")
}

/// Begins anew to look for the largest resident size, where the system lets us.
pub fn forget_peak() {
    _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// The memory that is free or can be freed on this machine, where the system tells it.
pub fn free_bytes() -> Option<u64> {
    let about = std::fs::read_to_string("/proc/meminfo").ok()?;
    kilobytes(&about, "MemAvailable:")
}

/// What a line of the system's tables says, in bytes.
fn kilobytes(table: &str, name: &str) -> Option<u64> {
    let line = table.lines().find_map(|line| line.strip_prefix(name))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}
