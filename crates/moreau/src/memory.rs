//! What the system tells of memory \[bytes\], and how much of it this process may take: the least of
//! what is free, what a limit on the process (`ulimit -v`) leaves and what its control groups leave.

use std::fs;
use std::path::Path;

/// A process that may not take what one thread needs.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "this process may take {} MB more of address space, and needs {} MB at least: raise the limit \
     (ulimit -v), or run without",
    .left >> 20,
    .needed.div_ceil(1 << 20)
)]
pub struct TooLittle {
    /// What is left of the limit \[bytes\].
    pub left: u64,
    /// What a run on one thread needs besides its factor \[bytes\].
    pub needed: u64,
}

/// Largest memory that the process has held.
pub(crate) fn peak() -> Option<u64> {
    listed(&own("status")?, "VmHWM:")
}

/// Memory that the process may take without others being put aside. Linux grants more than there is, and
/// later ends the program that uses it.
pub(crate) fn available() -> Option<u64> {
    let table = fs::read_to_string("/proc/meminfo").ok();
    let free = table.and_then(|table| listed(&table, "MemAvailable:"));
    let groups = own("cgroup").and_then(|g| in_groups(Path::new("/sys/fs/cgroup"), &g));
    // The factor comes beside what every run takes.
    let limited = address_space().map(|left| left.saturating_sub(needed()));
    [free, groups, limited].into_iter().flatten().min()
}

/// Threads, of so many that are wanted, for which a limited address space has room; 0 is as many as
/// there are processors. The results do not depend on it.
///
/// # Errors
/// [`TooLittle`] if there is none for one.
pub fn threads(wanted: usize) -> Result<usize, TooLittle> {
    match address_space() {
        None => Ok(wanted),
        Some(left) => fitting(wanted, left),
    }
}

fn fitting(wanted: usize, left: u64) -> Result<usize, TooLittle> {
    let needed = needed();
    let Some(rest) = left.checked_sub(needed) else {
        return Err(TooLittle { left, needed });
    };
    let wanted = match wanted {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        some => some,
    };
    // Half of what is left is for the problem.
    let more = rest / 2 / (workspace() + ARENA + STACK);
    Ok(wanted.min(1 + usize::try_from(more).unwrap_or(usize::MAX)))
}

/// Address space that the allocator sets apart for a thread.
const ARENA: u64 = 64 << 20;
/// That of its stack.
const STACK: u64 = 8 << 20;
/// What the smallest problem takes.
const SMALLEST: u64 = 16 << 20;

/// Address space that a run on one thread takes: what its dense products set apart, and a thread beside it
/// that waits for signals.
fn needed() -> u64 {
    SMALLEST + workspace() + ARENA + STACK
}

/// What dense products set apart on each thread: twice the largest cache.
fn workspace() -> u64 {
    let size = |k: usize| {
        let path = format!("/sys/devices/system/cpu/cpu0/cache/index{k}/size");
        let text = fs::read_to_string(path).ok()?;
        let kilobytes: u64 = text.trim().strip_suffix('K')?.parse().ok()?;
        Some(kilobytes << 10)
    };
    2 * (0..5).filter_map(size).max().unwrap_or(32 << 20)
}

/// What the limits of the process leave of its address space; `None` without a limit.
fn address_space() -> Option<u64> {
    let (limits, status) = (own("limits")?, own("status")?);
    let left = |limit: &str, taken: &str| {
        let limit = limits.lines().find_map(|l| l.strip_prefix(limit))?;
        let limit: u64 = limit.split_whitespace().next()?.parse().ok()?;
        Some(limit.saturating_sub(listed(&status, taken)?))
    };
    let space = left("Max address space", "VmSize:");
    let data = left("Max data size", "VmData:");
    space.into_iter().chain(data).min()
}

/// What the control groups of a process and those above them leave, by the table of its groups; those
/// of the second version are below the root, those of the first in a folder of it.
fn in_groups(root: &Path, table: &str) -> Option<u64> {
    let left = |line: &str| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?);
        let (root, names) = match controllers {
            "" => (root.to_owned(), ["memory.max", "memory.current"]),
            some if some.split(',').any(|c| c == "memory") => (
                root.join("memory"),
                ["memory.limit_in_bytes", "memory.usage_in_bytes"],
            ),
            _ => return None,
        };
        let number = |folder: &Path, name: &str| -> Option<u64> {
            let text = fs::read_to_string(folder.join(name)).ok()?;
            text.trim().parse().ok()
        };
        let group = |folder: &Path| {
            let own = root.join(folder);
            let (limit, used) = (number(&own, names[0])?, number(&own, names[1])?);
            // Files that are only kept at hand are given back.
            let kept = fs::read_to_string(own.join("memory.stat")).unwrap_or_default();
            let kept = kept.lines().find_map(|l| l.strip_prefix("inactive_file "));
            let kept = kept.and_then(|k| k.trim().parse().ok()).unwrap_or(0);
            Some(limit.saturating_sub(used.saturating_sub(kept)))
        };
        let folders = Path::new(path.trim_start_matches('/')).ancestors();
        folders.filter_map(group).min()
    };
    table.lines().filter_map(left).min()
}

/// A table of Linux about this process.
fn own(name: &str) -> Option<String> {
    fs::read_to_string(Path::new("/proc/self").join(name)).ok()
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

    /// The narrowest of a group and those above it counts, in both versions, without files at hand.
    #[test]
    fn a_control_group_leaves_what_the_narrowest_above_it_leaves() {
        let root = std::env::temp_dir().join(format!("moreau-{}-groups", std::process::id()));
        // Nothing may be there yet.
        let _ = fs::remove_dir_all(&root);
        let put = |folder: &str, files: &[(&str, &str)]| {
            let folder = root.join(folder);
            fs::create_dir_all(&folder).expect("a folder");
            for (name, text) in files {
                fs::write(folder.join(name), text).expect("a file");
            }
        };
        assert_eq!(in_groups(&root, "0::/a/b\n4:memory:/a\n"), None);
        put(
            "a/b",
            &[("memory.max", "max\n"), ("memory.current", "70\n")],
        );
        assert_eq!(in_groups(&root, "0::/a/b\n"), None);
        put(
            "a",
            &[("memory.max", "1000\n"), ("memory.current", "300\n")],
        );
        assert_eq!(in_groups(&root, "0::/a/b\n"), Some(700));
        put("a", &[("memory.stat", "anon 200\ninactive_file 50\n")]);
        assert_eq!(in_groups(&root, "9:cpu,cpuacct:/\n0::/a/b\n"), Some(750));
        let first = [
            ("memory.limit_in_bytes", "500\n"),
            ("memory.usage_in_bytes", "600\n"),
        ];
        put("memory/c", &first);
        assert_eq!(in_groups(&root, "3:cpuset,memory:/c/d\n"), Some(0));
        assert_eq!(in_groups(&root, "3:cpuset:/c/d\n"), None);
        fs::remove_dir_all(&root).expect("removed");
    }

    #[test]
    fn threads_are_as_many_as_a_limited_address_space_has_room_for() {
        let one = needed();
        assert_eq!(fitting(8, one), Ok(1));
        assert_eq!(fitting(8, u64::MAX), Ok(8));
        assert!(fitting(0, u64::MAX).is_ok_and(|n| n > 0));
        assert_eq!(fitting(8, one + 4 * (workspace() + ARENA + STACK)), Ok(3));
        let refused = fitting(1, one - 1).expect_err("too little");
        assert!(refused.to_string().contains("ulimit -v"));
    }
}
