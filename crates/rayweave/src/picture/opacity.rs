//! Regions that one can see through.

use crate::Error;
use rayweave_scene::Scene;
use std::str::FromStr;

/// How much of what is behind them some regions hide, from 0 (nothing) to 1 (all).
///
/// As text: the name of a region or a medium with the opacity, as in `glass=0.3`, or the opacity alone for all regions.
///
/// ```
/// use rayweave::picture::Opacity;
/// use rayweave::scene;
///
/// let (_, mut scene) = scene::parse("rayweave = 1\n[solid.lens]\nsphere = { radius = 2 }")?;
/// "lens=0.2".parse::<Opacity>()?.apply(&mut scene)?;
/// assert_eq!(scene.regions[0].colour.alpha, 51);
/// assert!("lense=0.2".parse::<Opacity>()?.apply(&mut scene).unwrap_err().is_name());
/// # Ok::<(), rayweave::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Opacity {
    name: Option<String>,
    alpha: u8,
}

impl Opacity {
    /// An opacity from 0 to 1 of the regions of a name or made of a medium of that name, or of all.
    ///
    /// # Errors
    ///
    /// [`crate::ErrorKind::Value`] for an opacity out of range.
    pub fn new(name: Option<&str>, opacity: f64) -> Result<Opacity, Error> {
        if !(0.0..=1.0).contains(&opacity) {
            return Err(Error::wish(format!("an opacity of {opacity} (it must be from 0 to 1)")));
        }
        Ok(Opacity { name: name.map(str::to_owned), alpha: (255.0 * opacity).round() as u8 })
    }

    /// Gives it to the regions of a scene.
    ///
    /// # Errors
    ///
    /// [`crate::ErrorKind::Name`] if neither a region nor a medium of a region has the name.
    pub fn apply(&self, scene: &mut Scene) -> Result<(), Error> {
        let media: Vec<String> = scene.media.iter().map(|medium| medium.name.clone()).collect();
        let of = |medium: u32| media.get(medium as usize).map_or("", String::as_str);
        let mut found = self.name.is_none();
        for region in &mut scene.regions {
            let is_meant = |name: &String| region.name == *name || of(region.medium) == *name;
            if self.name.as_ref().is_none_or(is_meant) {
                region.colour.alpha = self.alpha;
                found = true;
            }
        }
        match &self.name {
            Some(name) if !found => {
                let regions = scene.regions.iter().map(|region| region.name.as_str());
                let known = regions.chain(scene.regions.iter().map(|region| of(region.medium)));
                let mut known: Vec<&str> = known.collect();
                known.sort_unstable();
                known.dedup();
                Err(Error::unknown("region or medium", name, known.into_iter()))
            }
            _ => Ok(()),
        }
    }
}

impl FromStr for Opacity {
    type Err = Error;

    fn from_str(text: &str) -> Result<Opacity, Error> {
        let (name, opacity) = match text.rsplit_once('=') {
            Some((name, opacity)) => (Some(name.trim()), opacity),
            None => (None, text),
        };
        let number = opacity.trim().parse();
        let problem = |_| Error::wish(format!("`{text}` is no opacity (as in glass=0.3, or 0.3 for all)"));
        Opacity::new(name, number.map_err(problem)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opacities_are_read() {
        assert_eq!("a=b=0.5".parse::<Opacity>().unwrap(), Opacity { name: Some("a=b".into()), alpha: 128 });
        assert_eq!("1".parse::<Opacity>().unwrap(), Opacity { name: None, alpha: 255 });
        for text in ["", "glass", "glass=", "glass=2", "glass=-0.1", "glass=nan"] {
            assert!(text.parse::<Opacity>().unwrap_err().is_value(), "{text}");
        }
    }
}
