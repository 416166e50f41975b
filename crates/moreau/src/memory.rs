//! What the system tells of memory \[bytes\]; `None` where it does not.

/// Largest memory that the process has held.
pub(crate) fn peak() -> Option<u64> {
    listed(
        &std::fs::read_to_string("/proc/self/status").ok()?,
        "VmHWM:",
    )
}

/// Memory that a program may take without others being put aside. Linux grants more than there is, and
/// later ends the program that uses it.
pub(crate) fn available() -> Option<u64> {
    let table = std::fs::read_to_string("/proc/meminfo").ok()?;
    listed(&table, "MemAvailable:")
}

/// An entry of a table of Linux.
fn listed(table: &str, entry: &str) -> Option<u64> {
    let line = table.lines().find_map(|l| l.strip_prefix(entry))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_linux_are_read_and_anything_else_says_nothing() {
        let table = "MemTotal:       24736176 kB\nMemAvailable:   23110000 kB\nBuffers: 1 kB\n";
        assert_eq!(listed(table, "MemAvailable:"), Some(1024 * 23_110_000));
        for other in [
            "",
            "MemTotal: 5 kB",
            "MemAvailable: many kB",
            "MemAvailable: 5",
        ] {
            assert_eq!(listed(other, "MemAvailable:"), None, "{other}");
        }
    }
}
