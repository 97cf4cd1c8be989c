//! The property `attenuation` of media.

use crate::AnalysisError;
use rayweave_error::{Message, did_you_mean};
use rayweave_scene::Scene;

/// The key of the attenuation of a medium, per length unit of the model.
pub(super) const ATTENUATION: &str = "attenuation";

/// Checks the attenuations of a scene. Returns remarks in sentences: media without an attenuation beside others that have
/// one, which count as transparent, and keys that look like misspelt ones.
///
/// # Errors
///
/// [`AnalysisError::Value`] for a negative or infinite attenuation.
pub fn check_attenuations(scene: &Scene) -> Result<Vec<String>, AnalysisError> {
    let mut remarks = Vec::new();
    let of = |medium: usize| scene.media[medium].number(ATTENUATION);
    let used: Vec<usize> = {
        let mut media: Vec<usize> = scene.regions.iter().map(|region| region.medium as usize).collect();
        media.sort_unstable();
        media.dedup();
        media.into_iter().filter(|medium| *medium < scene.media.len()).collect()
    };
    for entry in &scene.media {
        if let Some(value) = entry.number(ATTENUATION).filter(|value| !(value.is_finite() && *value >= 0.0)) {
            let problem = format!("the attenuation of the medium '{}' is {value}", entry.name);
            return Err(AnalysisError::Value(Message::new(problem, "it must be finite and at least 0")));
        }
        for (key, _) in entry.numbers.iter().filter(|(key, _)| key != ATTENUATION) {
            if did_you_mean(key, [ATTENUATION]).is_some() {
                remarks.push(format!(
                    "medium '{}': the key '{key}' is not used. Did you mean '{ATTENUATION}'?",
                    entry.name
                ));
            }
        }
    }
    if used.iter().any(|medium| of(*medium).is_some()) {
        for medium in used.into_iter().filter(|medium| of(*medium).is_none()) {
            let name = &scene.media[medium].name;
            remarks.push(format!(
                "medium '{name}' has no attenuation beside media that have one: it counts as transparent, as with attenuation = 0."
            ));
        }
    }
    Ok(remarks)
}

#[cfg(test)]
mod tests {
    use super::check_attenuations;

    fn remarks(media: &str) -> Result<Vec<String>, String> {
        let text = format!(
            "rayweave = 1\n[solid]\na = {{ sphere = {{ radius = 1 }} }}\nb = {{ box = {{ size = [1, 1, 1] }} }}\n\
             [[region]]\nsolid = \"a\"\nmedium = \"steel\"\n[[region]]\nsolid = \"b\"\nmedium = \"bone\"\n{media}"
        );
        let (_, scene) = rayweave_scene::parse(&text).unwrap();
        check_attenuations(&scene).map_err(|error| error.to_string())
    }

    #[test]
    fn missing_misspelt_and_negative_attenuations_are_reported() {
        assert_eq!(remarks("[medium.steel]\nattenuation = 1\n[medium.bone]\nattenuation = 0"), Ok(vec![]));
        assert_eq!(remarks("[medium.steel]\ndensity = 1\n[medium.bone]\ndensity = 2"), Ok(vec![]));
        assert_eq!(
            remarks("[medium.steel]\nattenuation = 1\n[medium.bone]\nattenutation = 2"),
            Ok(vec![
                "medium 'bone': the key 'attenutation' is not used. Did you mean 'attenuation'?".to_owned(),
                "medium 'bone' has no attenuation beside media that have one: it counts as transparent, as with attenuation = 0."
                    .to_owned(),
            ])
        );
        let error = remarks("[medium.steel]\nattenuation = -1\n[medium.bone]\ndensity = 2").unwrap_err();
        assert_eq!(error, "the attenuation of the medium 'steel' is -1: it must be finite and at least 0.");
    }
}
