//! Suggestions for files that do not exist.

use rayweave_error::did_you_mean;
use std::path::{Path, PathBuf};

/// The greatest number of files of a folder that are examined, and of those that are listed.
const MAX_EXAMINED: usize = 10_000;
const MAX_LISTED: usize = 5;

/// A suggestion for a file that does not exist, as a clause or question: a file in its folder with a similar name or the same name and
/// another extension, or else the files there with its extension. `None` if the file exists.
pub fn nearby_files(path: &Path) -> Option<String> {
    if !matches!(path.try_exists(), Ok(false)) {
        return None;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let entries = match std::fs::read_dir(folder.unwrap_or(Path::new("."))) {
        Ok(entries) => entries,
        Err(_) => return Some(format!("check the folder `{}`: it cannot be read", folder?.display())),
    };
    let name = path.file_name()?.to_string_lossy().into_owned();
    let names = entries.take(MAX_EXAMINED).filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> = names.collect();
    names.sort();
    let stem_of = |name: &str| Path::new(name).file_stem().map(ToOwned::to_owned);
    let ending_of = |name: &str| Path::new(name).extension().map(|ending| ending.to_ascii_lowercase());
    let same_stem = || names.iter().find(|own| stem_of(own) == stem_of(&name)).map(String::as_str);
    if let Some(near) = did_you_mean(&name, names.iter().map(String::as_str)).or_else(same_stem) {
        let near = folder.map_or_else(|| PathBuf::from(near), |folder| folder.join(near));
        return Some(format!("did you mean `{}`?", near.display()));
    }
    let alike: Vec<&String> = names.iter().filter(|own| ending_of(own) == ending_of(&name)).collect();
    let place = folder.map_or_else(|| "this folder".to_owned(), |folder| format!("`{}`", folder.display()));
    let listed = alike.iter().take(MAX_LISTED).map(|own| format!("`{own}`")).collect::<Vec<_>>().join(", ");
    Some(match alike.len() {
        0 => format!("check the path: {place} has no such files"),
        count if count > MAX_LISTED => format!("{place} has {listed} and {} more", count - MAX_LISTED),
        _ => format!("{place} has {listed}"),
    })
}

/// [`nearby_files`] as a sentence after a space, for the end of a message; empty if the file exists.
pub fn nearby_sentence(path: &Path) -> String {
    let Some(hint) = nearby_files(path) else { return String::new() };
    let full_stop = if hint.ends_with('?') { "" } else { "." };
    let mut letters = hint.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    format!(" {}{}{full_stop}", first.map(String::from).unwrap_or_default(), letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_suggested_first() {
        let folder = std::env::temp_dir().join(format!("rayweave-nearby-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let said = |name: &str| {
            nearby_files(&folder.join(name)).map(|text| text.replace(&folder.display().to_string(), "F"))
        };
        assert_eq!(said("plate.toml").unwrap(), "check the path: `F` has no such files");
        for name in ["plate.toml", "lens.toml", "cube.stl"] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        let sep = std::path::MAIN_SEPARATOR;
        assert_eq!(said("plat.toml").unwrap(), format!("did you mean `F{sep}plate.toml`?"));
        assert_eq!(said("cube.toml").unwrap(), format!("did you mean `F{sep}cube.stl`?"));
        assert_eq!(said("engine.toml").unwrap(), "`F` has `lens.toml`, `plate.toml`");
        assert_eq!(said("plate.toml"), None);
        let sentence =
            |name: &str| nearby_sentence(&folder.join(name)).replace(&folder.display().to_string(), "F");
        assert_eq!(sentence("plat.toml"), format!(" Did you mean `F{sep}plate.toml`?"));
        assert_eq!(sentence("wheel.stl"), " `F` has `cube.stl`.");
        assert_eq!(sentence("plate.toml"), "");
        let nowhere = nearby_files(&folder.join("none").join("a.toml")).unwrap();
        assert!(
            nowhere.starts_with("check the folder `") && nowhere.ends_with("`: it cannot be read"),
            "{nowhere}"
        );
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
