//! How much memory is free; not what needs it.

/// Memory that a program may take without others being put aside \[bytes\]; `None` where the system
/// does not tell. Linux grants more than there is and ends the program that uses it.
pub(crate) fn available() -> Option<u64> {
    listed(&std::fs::read_to_string("/proc/meminfo").ok()?)
}

/// The entry of Linux's table of memory.
fn listed(table: &str) -> Option<u64> {
    let entry = table
        .lines()
        .find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = entry.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_linux_is_read_and_anything_else_says_nothing() {
        let table = "MemTotal:       24736176 kB\nMemAvailable:   23110000 kB\nBuffers: 1 kB\n";
        assert_eq!(listed(table), Some(1024 * 23_110_000));
        for other in [
            "",
            "MemTotal: 5 kB",
            "MemAvailable: many kB",
            "MemAvailable: 5",
        ] {
            assert_eq!(listed(other), None, "{other}");
        }
    }
}
