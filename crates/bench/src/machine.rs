//! Description of the machine that runs the benchmark, as far as Linux reports it; elsewhere only the number of CPUs.

use std::fs::read_to_string;
use std::thread::available_parallelism;
use std::time::{SystemTime, UNIX_EPOCH};

/// Facts about a machine: pairs of a name and a text.
pub fn description() -> Vec<(&'static str, String)> {
    let facts = [
        ("processor", processor()),
        ("logical CPUs", available_parallelism().ok().map(|n| n.to_string())),
        ("caches", caches()),
        ("memory", memory()),
        ("system", system()),
        ("load at the start", load()),
    ];
    facts.into_iter().filter_map(|(name, text)| Some((name, text?))).collect()
}

/// Today's date as YYYY-MM-DD, in UTC.
pub fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
    let [year, month, day] = date_of_day((seconds / 86400) as i64);
    format!("{year}-{month:02}-{day:02}")
}

/// The year, month and day of a day number counted from 1970-01-01 (Gregorian calendar). In the computation years begin in March, so
/// that the leap day is the last day, and eras of 400 years have 146097 days.
fn date_of_day(day: i64) -> [i64; 3] {
    // from 0000-03-01
    let day = day + 719_468;
    let (era, day_of_era) = (day.div_euclid(146_097), day.rem_euclid(146_097));
    let leap_days = day_of_era / 1460 - day_of_era / 36_524 + day_of_era / 146_096;
    let year_of_era = (day_of_era - leap_days) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    // five months from March have 153 days, and so have the next five
    let month = (5 * day_of_year + 2) / 153;
    let day_of_month = day_of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    [400 * era + year_of_era + i64::from(month <= 2), month, day_of_month]
}

fn processor() -> Option<String> {
    let text = read_to_string("/proc/cpuinfo").ok()?;
    let field = |name: &str| {
        let line = text.lines().find(|line| line.split(':').next().is_some_and(|key| key.trim() == name))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    let model = field("model name")?;
    let numbers = field("cpu family").zip(field("model")).map(|(f, m)| format!(" (family {f}, model {m})"));
    Some(model + &numbers.unwrap_or_default())
}

/// The data and unified caches of the first CPU.
fn caches() -> Option<String> {
    let one = |index: usize| {
        let read = |what: &str| {
            read_to_string(format!("/sys/devices/system/cpu/cpu0/cache/index{index}/{what}")).ok()
        };
        let (level, kind, size) = (read("level")?, read("type")?, read("size")?);
        (kind.trim() != "Instruction").then(|| format!("L{} {}", level.trim(), size.trim()))
    };
    let all: Vec<String> = (0..8).filter_map(one).collect();
    (!all.is_empty()).then(|| all.join(", "))
}

fn memory() -> Option<String> {
    let text = read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("MemTotal:"))?;
    let kibibytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(format!("{:.0} GiB", kibibytes / f64::from(1 << 20)))
}

fn system() -> Option<String> {
    let name = read_to_string("/proc/sys/kernel/ostype").ok()?;
    Some(format!("{} on {}", name.trim(), std::env::consts::ARCH))
}

/// The load average of the last minute.
fn load() -> Option<String> {
    Some(read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_have_their_dates() {
        assert_eq!(date_of_day(0), [1970, 1, 1]);
        assert_eq!(date_of_day(-1), [1969, 12, 31]);
        // 30 years, of which 7 are leap years
        let turn = 30 * 365 + 7;
        assert_eq!(date_of_day(turn), [2000, 1, 1]);
        assert_eq!(date_of_day(turn + 31 + 28), [2000, 2, 29]);
        assert_eq!(date_of_day(turn + 31 + 29), [2000, 3, 1]);
        assert_eq!(date_of_day(turn + 365), [2000, 12, 31]);
        // 2100 is not a leap year
        assert_eq!(date_of_day(turn + 100 * 365 + 25 + 31 + 28), [2100, 3, 1]);
    }

    #[test]
    fn facts_are_not_empty() {
        assert!(description().iter().all(|(_, text)| !text.is_empty()));
    }
}
