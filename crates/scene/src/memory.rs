//! Available memory: files that cannot fit are rejected before they are read.

use std::fs::read_to_string;

/// The number of bytes that this process may still allocate: the minimum of the free memory, the
/// limits of the process, and those of its control group. `None` on operating systems other than
/// Linux.
pub fn available() -> Option<u64> {
    [free(), address_space(), control_group()].into_iter().flatten().min()
}

/// The value of a name in a table of the system, converted from kB to bytes.
fn kilobytes(table: &str, name: &str) -> Option<u64> {
    let line = table.lines().find_map(|line| line.strip_prefix(name))?;
    Some(1024 * line.split_whitespace().next()?.parse::<u64>().ok()?)
}

fn free() -> Option<u64> {
    kilobytes(&read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// The rest of the limit of `ulimit -v`.
fn address_space() -> Option<u64> {
    let limits = read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    let used = kilobytes(&read_to_string("/proc/self/status").ok()?, "VmSize:")?;
    Some(limit.saturating_sub(used))
}

/// The rest of the limit of the control group, version 2 or 1.
fn control_group() -> Option<u64> {
    let groups = read_to_string("/proc/self/cgroup").ok()?;
    let left = |line: &str| {
        let mut fields = line.splitn(3, ':').skip(1);
        let (controllers, path) = (fields.next()?, fields.next()?);
        let (root, limit, used) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max", "memory.current"),
            _ if controllers.split(',').any(|name| name == "memory") => {
                ("/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes")
            }
            _ => return None,
        };
        // within a container, the group is the root of the visible hierarchy
        let number = |folder: &str, name: &str| {
            read_to_string(format!("{root}{folder}/{name}")).ok()?.trim().parse::<u64>().ok()
        };
        let folder = [path, ""].into_iter().find(|folder| number(folder, limit).is_some())?;
        Some(number(folder, limit)?.saturating_sub(number(folder, used)?))
    };
    groups.lines().filter_map(left).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_the_system() {
        let table = "MemTotal:       24000 kB\nMemAvailable:      17 kB\n";
        assert_eq!(kilobytes(table, "MemAvailable:"), Some(17 * 1024));
        assert_eq!(kilobytes(table, "MemFree:"), None);
        assert_eq!(kilobytes("MemFree: many", "MemFree:"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn there_is_some() {
        // this very process holds more than a megabyte
        assert!(available().is_some_and(|bytes| bytes > 1 << 20));
    }
}
