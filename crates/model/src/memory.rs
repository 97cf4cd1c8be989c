//! Available memory: what cannot fit is rejected before it is allocated.
//!
//! [`available`] serves input of known size, [`check`] results of known size, [`Growth`] results that grow while they are
//! computed.

use std::fs::read_to_string;

/// The reason why a result cannot be kept: the part of a message that states how much memory is needed, in MiB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{needed} MiB of memory are needed, and {available} MiB are available")]
pub struct Shortage {
    /// The needed memory, in MiB.
    pub needed: u64,
    /// The available memory, in MiB.
    pub available: u64,
}

/// Checks that `items` items of `size` bytes each fit into memory; succeeds if the available memory is unknown.
///
/// # Errors
///
/// [`Shortage`].
pub fn check(items: u64, size: u64) -> Result<(), Shortage> {
    let bytes = items.saturating_mul(size);
    // small results are not worth the system calls
    if bytes < LOOK { Ok(()) } else { compare(bytes, available()) }
}

fn compare(bytes: u64, available: Option<u64>) -> Result<(), Shortage> {
    match available {
        Some(available) if bytes > available => {
            Err(Shortage { needed: bytes.div_ceil(1 << 20), available: available >> 20 })
        }
        _ => Ok(()),
    }
}

/// Size in bytes from which a result is compared with the available memory.
const LOOK: u64 = 64 << 20;

/// A watch on a result that grows while it is computed: it stops the growth before memory runs out.
///
/// A full list is copied to a list of twice the capacity, so at each look one and a half times the size of the result must be
/// available in addition to it. The next look is when the result has grown by a quarter.
#[derive(Clone, Debug)]
pub struct Growth {
    /// The size of the result at the next look, in bytes.
    next: u64,
}

impl Default for Growth {
    fn default() -> Growth {
        Growth { next: LOOK }
    }
}

impl Growth {
    /// Checks that a result that takes `bytes` so far may grow.
    ///
    /// # Errors
    ///
    /// [`Shortage`].
    pub fn check(&mut self, bytes: u64) -> Result<(), Shortage> {
        if bytes < self.next { Ok(()) } else { self.look(bytes, available()) }
    }

    fn look(&mut self, bytes: u64, available: Option<u64>) -> Result<(), Shortage> {
        compare(bytes.saturating_add(bytes / 2), available)?;
        self.next = bytes.saturating_add(bytes / 4);
        Ok(())
    }
}

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
    fn results_that_do_not_fit_are_rejected() {
        assert_eq!(compare(3 << 20, None), Ok(()));
        assert_eq!(compare(3 << 20, Some(3 << 20)), Ok(()));
        assert_eq!(compare((3 << 20) + 1, Some(3 << 20)), Err(Shortage { needed: 4, available: 3 }));
        assert_eq!(check(1, LOOK - 1), Ok(()));
        let mut growth = Growth::default();
        growth.check(LOOK - 1).unwrap();
        growth.look(LOOK, Some(2 * LOOK)).unwrap();
        assert_eq!(growth.next, LOOK + LOOK / 4);
        let refused = growth.look(2 * LOOK, Some(2 * LOOK)).unwrap_err();
        assert_eq!(refused.to_string(), "192 MiB of memory are needed, and 128 MiB are available");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn too_much_is_never_allocated() {
        assert!(check(u64::MAX, u64::MAX).is_err());
        assert!(Growth::default().check(1 << 60).is_err());
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn there_is_some() {
        // this process itself uses more than a megabyte
        assert!(available().is_some_and(|bytes| bytes > 1 << 20));
    }
}
