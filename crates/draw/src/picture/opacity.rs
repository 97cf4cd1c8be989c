//! Transparent regions.

use crate::DrawError;
use rayweave_error::Message;
use rayweave_scene::Scene;
use std::str::FromStr;

/// The opacity of regions, from 0 (transparent) to 1 (opaque).
///
/// Parses the name of a region or a medium with its opacity, such as `glass=0.3`, or an opacity alone for all regions.
///
/// ```
/// use rayweave_draw::picture::Opacity;
/// use rayweave_error::{Classified, ErrorKind};
///
/// let (_, mut scene) = rayweave_scene::parse("rayweave = 1\n[solid.lens]\nsphere = { radius = 2 }")?;
/// "lens=0.2".parse::<Opacity>()?.apply(&mut scene)?;
/// assert_eq!(scene.regions[0].colour.alpha, 51);
/// assert!("lense=0.2".parse::<Opacity>()?.apply(&mut scene).unwrap_err().kind() == ErrorKind::Name);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Opacity {
    name: Option<String>,
    alpha: u8,
}

impl Opacity {
    /// Creates the opacity of the regions with this name or medium, or of all regions without a name.
    ///
    /// # Errors
    ///
    /// [`DrawError::Option`] for an opacity that is not from 0 to 1.
    pub fn new(name: Option<&str>, opacity: f64) -> Result<Opacity, DrawError> {
        if !(0.0..=1.0).contains(&opacity) {
            let problem = format!("the opacity {opacity} is out of range");
            return Err(DrawError::Option(Message::new(problem, "it must be from 0 to 1")));
        }
        Ok(Opacity { name: name.map(str::to_owned), alpha: (255.0 * opacity).round() as u8 })
    }

    /// Sets the opacity of regions of a scene.
    ///
    /// # Errors
    ///
    /// [`DrawError::UnknownName`] if neither a region nor a medium of a region has the name.
    pub fn apply(&self, scene: &mut Scene) -> Result<(), DrawError> {
        let media: Vec<String> = scene.media.iter().map(|medium| medium.name.clone()).collect();
        let medium_name = |medium: u32| media.get(medium as usize).map_or("", String::as_str);
        let mut found = self.name.is_none();
        for region in &mut scene.regions {
            let is_meant = |name: &String| region.name == *name || medium_name(region.medium) == *name;
            if self.name.as_ref().is_none_or(is_meant) {
                region.colour.alpha = self.alpha;
                found = true;
            }
        }
        match &self.name {
            Some(name) if !found => {
                let regions = scene.regions.iter().map(|region| region.name.as_str());
                let known = regions.chain(scene.regions.iter().map(|region| medium_name(region.medium)));
                let mut known: Vec<&str> = known.collect();
                known.sort_unstable();
                known.dedup();
                Err(DrawError::UnknownName(Message::unknown("region or medium", name, known)))
            }
            _ => Ok(()),
        }
    }
}

impl FromStr for Opacity {
    type Err = DrawError;

    fn from_str(text: &str) -> Result<Opacity, DrawError> {
        let (name, opacity) = match text.rsplit_once('=') {
            Some((name, opacity)) => (Some(name.trim()), opacity),
            None => (None, text),
        };
        let number = opacity.trim().parse();
        let problem = |_| {
            let reason = "write glass=0.3, for example, or 0.3 for all regions";
            DrawError::Option(Message::new(format!("`{text}` is not an opacity"), reason))
        };
        Opacity::new(name, number.map_err(problem)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_error::{Classified, ErrorKind};

    #[test]
    fn opacities_are_read() {
        assert_eq!("a=b=0.5".parse::<Opacity>().unwrap(), Opacity { name: Some("a=b".into()), alpha: 128 });
        assert_eq!("1".parse::<Opacity>().unwrap(), Opacity { name: None, alpha: 255 });
        for text in ["", "glass", "glass=", "glass=2", "glass=-0.1", "glass=nan"] {
            assert!(text.parse::<Opacity>().unwrap_err().kind() == ErrorKind::Value, "{text}");
        }
    }
}
