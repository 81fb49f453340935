//! Memory: what this process has taken, what it may take, and what work is expected to take. Work that does not fit is
//! refused before it begins. Estimates, from what was measured; nothing is cut off that takes more than was thought.

use std::sync::OnceLock;

/// What `--memory-limit` says.
static LIMIT: OnceLock<u64> = OnceLock::new();

/// Takes so many bytes for the most that this process may have.
pub fn limit(bytes: u64) {
    _ = LIMIT.set(bytes);
}

/// What `--memory-limit` says, if it was given.
pub fn told_limit() -> Option<u64> {
    LIMIT.get().copied()
}

/// Work that takes more memory than there is.
#[derive(Debug, thiserror::Error)]
#[error("{what} takes about {needed}, and {allowed}; {way_out}")]
pub struct TooMuch {
    what: String,
    needed: String,
    allowed: String,
    way_out: &'static str,
}

/// Refuses work that is expected to take more than may be taken: what was said, or else what is free now.
pub fn allow(what: &str, bytes: u64) -> Result<(), TooMuch> {
    let refuse = |allowed, way_out| Err(TooMuch { what: what.to_owned(), needed: text(bytes), allowed, way_out });
    match (LIMIT.get(), free_bytes()) {
        (Some(&limit), _) if bytes > limit => {
            refuse(format!("--memory-limit allows {}", text(limit)), "allow more, or take a smaller mesh")
        }
        (None, Some(free)) if bytes > free => {
            refuse(format!("{} are free", text(free)), "--memory-limit with more lets it try all the same")
        }
        _ => Ok(()),
    }
}

fn text(bytes: u64) -> String {
    match bytes {
        0..10_000_000 => format!("{:.1} MB", bytes as f64 / 1e6),
        10_000_000..10_000_000_000 => format!("{:.0} MB", bytes as f64 / 1e6),
        _ => format!("{:.1} GB", bytes as f64 / 1e9),
    }
}

/// A number of bytes, as in `900M`, `1.5G`, `4GiB` or `2000000`.
pub fn parse_bytes(text: &str) -> Result<u64, String> {
    let end = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let factor = match unit.to_ascii_uppercase().as_str() {
        "" | "B" => 1u64,
        "K" | "KB" => 1000,
        "M" | "MB" => 1_000_000,
        "G" | "GB" => 1_000_000_000,
        "T" | "TB" => 1_000_000_000_000,
        "KIB" => 1 << 10,
        "MIB" => 1 << 20,
        "GIB" => 1 << 30,
        "TIB" => 1 << 40,
        _ => 0,
    };
    match number.parse::<f64>().map(|number| number * factor as f64) {
        Ok(bytes) if bytes >= 1.0 && bytes < u64::MAX as f64 => Ok(bytes as u64),
        _ => Err(format!("`{text}` is no number of bytes, such as 900M, 1.5G or 4GiB")),
    }
}

/// What a process has before it works on anything.
const AT_REST: u64 = 16 << 20;

/// What loading a mesh is expected to take, guessed rather too high: the file, what it is read into, and the mesh with the tables of its repair.
pub fn of_loading_mesh(file_bytes: u64) -> u64 {
    file_bytes.saturating_mul(6).saturating_add(AT_REST)
}

/// What loading a model is expected to take, guessed rather too high: the file, its arrays, and what follows from these.
pub fn of_loading_model(file_bytes: u64, unpacked: u64) -> u64 {
    unpacked.saturating_mul(3).saturating_add(file_bytes).saturating_add(AT_REST)
}

/// What coarsening takes at most, the input included, as measured (`mtess bench`): by regions from 80,000 to 16
/// million triangles, as a whole on the armadillo alone.
pub fn of_coarsening(triangles: usize, by_regions: bool, keeps_cells: bool) -> u64 {
    // Regions that are worked on at a time take the same whatever the mesh.
    let (at_rest, each) = match (by_regions, keeps_cells) {
        (true, true) => (3 * AT_REST, 330),
        (true, false) => (3 * AT_REST, 250),
        (false, true) => (AT_REST, 450),
        (false, false) => (AT_REST, 390),
    };
    at_rest + triangles as u64 * each
}

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
    let machine = kilobytes(&about, "MemAvailable:")?;
    // A container may have less.
    let of_group =
        |name: &str| std::fs::read_to_string(format!("/sys/fs/cgroup/{name}")).ok()?.trim().parse::<u64>().ok();
    let group = of_group("memory.max").zip(of_group("memory.current")).map(|(most, now)| most.saturating_sub(now));
    Some(group.map_or(machine, |group| machine.min(group)))
}

/// What a line of the system's tables says, in bytes.
fn kilobytes(table: &str, name: &str) -> Option<u64> {
    let line = table.lines().find_map(|line| line.strip_prefix(name))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

/// What a study of a mesh takes: it is coarsened as a whole and kept in both forms, and distances are measured.
pub fn of_study(triangles: usize) -> u64 {
    AT_REST + triangles as u64 * 1200
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_read_with_their_units() {
        for (text, bytes) in [
            ("2000000", 2_000_000),
            ("900M", 900_000_000),
            ("1.5G", 1_500_000_000),
            ("64KiB", 65_536),
            ("2tb", 2_000_000_000_000),
        ] {
            assert_eq!(parse_bytes(text), Ok(bytes), "{text}");
        }
        for wrong in ["", "G", "-1G", "0", "0.1", "ten", "1e999", "NaN", "1GBB", "1 G", "99999999T"] {
            assert!(parse_bytes(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn what_is_more_than_there_is_is_refused() {
        assert!(allow("nothing", 0).is_ok());
        let told = allow("all of it", u64::MAX).unwrap_err().to_string();
        assert!(
            told.starts_with("all of it takes about 18446744073.7 GB, and ") && told.contains("--memory-limit"),
            "{told}"
        );
    }
}
