//! SIMD levels of the processor, by name.

use fearless_simd::Level;

/// The names, from narrow to wide.
pub const NAMES: [&str; 4] = ["sse2", "sse4.2", "avx2", "avx512"];

/// The name of a level.
pub fn name(level: Level) -> String {
    let debug = format!("{level:?}");
    let word = debug.split(['(', ' ']).next().unwrap_or_default().to_lowercase();
    word.replace('_', ".")
}

/// The SIMD levels of this processor, from narrow to wide, up to the given one.
pub fn available(most: Option<&str>) -> Vec<Level> {
    let best = Level::new();
    let mut levels = narrower(best);
    levels.push(best);
    levels.dedup_by_key(|level| name(*level));
    if let Some(end) = levels.iter().position(|level| most == Some(name(*level).as_str())) {
        levels.truncate(end + 1);
    }
    levels
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn narrower(best: Level) -> Vec<Level> {
    let levels = [
        best.as_sse2().map(Level::Sse2),
        best.as_sse4_2().map(Level::Sse4_2),
        best.as_avx2().map(Level::Avx2),
    ];
    levels.into_iter().flatten().collect()
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn narrower(_: Level) -> Vec<Level> {
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_has_its_own_name() {
        let names: Vec<String> = available(None).into_iter().map(name).collect();
        assert!(!names.is_empty());
        let mut unique = names.clone();
        unique.dedup();
        assert_eq!(names, unique);
    }

    #[test]
    fn a_level_can_be_forbidden() {
        let all = available(None);
        let least = name(all[0]);
        assert_eq!(available(Some(&least)).len(), 1);
        assert_eq!(available(Some("no such level")).len(), all.len());
    }
}
