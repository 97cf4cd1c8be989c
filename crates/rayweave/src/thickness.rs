//! How thick a model is, pixel by pixel: path lengths through its media, and radiographs.
//!
//! ```
//! use rayweave::picture::Wishes;
//! use rayweave::render::{Size, View};
//! use rayweave::thickness::{Run, ThicknessMap};
//! use rayweave::{AnyEvaluator, Compiled};
//!
//! let (_, scene) = rayweave::scene::parse(
//!     "rayweave = 1\nunit = \"cm\"\n[solid.ball]\nsphere = { radius = 2 }\n[[region]]\nsolid = \"ball\"\nmedium = \"steel\"\n\
//!      [medium.steel]\nattenuation = 0.5",
//! )?;
//! let compiled = Compiled::new(&scene)?;
//! let evaluator = AnyEvaluator::new(None, compiled.program.clone())?;
//! let wishes = Wishes { size: Some(Size::new(101, 101)?), view: Some(View::Front), ..Wishes::default() };
//! let map = ThicknessMap::new(&scene, &compiled, &evaluator, &wishes, &mut Run::default())?;
//!
//! // through the middle: 4 cm of steel, which let exp(-2) through
//! assert!((map.lengths(50, 50)[1] - 4.0).abs() < 1e-12);
//! let radiograph = map.radiograph(&scene);
//! assert!((radiograph.values()[50 * 101 + 50] - 0.135_335_283_236_612_7).abs() < 1e-12);
//! # Ok::<(), rayweave::Error>(())
//! ```

use crate::picture::{Wishes, arrange};
use crate::{Compiled, Error};
pub use rayweave_analysis::thickness::*;
use rayweave_model::Evaluator;
use rayweave_render::{Plane, Size};
use rayweave_scene::Scene;
use rayweave_table::{Chunk, Column, DType, Schema, TableWriter, Values};
use std::path::Path;

/// Path lengths through each medium along the rays of a camera, one through the centre of each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct ThicknessMap {
    size: Size,
    media: Vec<String>,
    lengths: PathLengths,
}

/// By how much a length weakens. What lets all through does so over any length.
fn faint((length, mu): (&f64, &f64)) -> f64 {
    if *mu == 0.0 { 0.0 } else { length * mu }
}

/// Where no medium has an attenuation, they weaken by their density, or all alike where none has one, such that this part comes
/// through the place that weakens most.
pub const FAINTEST: f64 = 0.05;

impl ThicknessMap {
    /// Asks the rays of a camera: that of the scene, or one that sees all of the model, as for pictures.
    ///
    /// # Errors
    ///
    /// [`crate::ErrorKind::Value`] for a size or field of view out of range, [`crate::ErrorKind::Cancelled`].
    pub fn new<E: Evaluator>(
        scene: &Scene,
        compiled: &Compiled,
        evaluator: &E,
        wishes: &Wishes,
        run: &mut Run<'_>,
    ) -> Result<ThicknessMap, Error> {
        let (camera, settings) = arrange(scene, compiled, wishes)?;
        let size = settings.size;
        let ray = |k: usize| {
            let (x, y) = ((k % size.width()) as f64, (k / size.width()) as f64);
            camera.ray(size, x + 0.5, y + 0.5)
        };
        let media = compiled.media.to_vec();
        let lengths = path_lengths(evaluator, media.len(), size.count(), ray, run);
        Ok(ThicknessMap { size, media, lengths: lengths.map_err(|Cancelled| Error::cancelled())? })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The names of the media.
    pub fn media(&self) -> &[String] {
        &self.media
    }

    /// The path lengths at a pixel, counted from the upper left one, medium by medium: see [`PathLengths::of`].
    pub fn lengths(&self, x: usize, y: usize) -> &[f64] {
        self.lengths.of(y * self.size.width() + x)
    }

    /// All path lengths, pixel by pixel.
    pub fn path_lengths(&self) -> &PathLengths {
        &self.lengths
    }

    /// The path lengths through one medium.
    ///
    /// # Errors
    ///
    /// [`crate::ErrorKind::Name`] if there is no such medium.
    pub fn of_medium(&self, name: &str) -> Result<Plane<f64>, Error> {
        let known = self.media.iter().map(String::as_str);
        let medium = known.clone().position(|own| own == name);
        let medium = medium.ok_or_else(|| Error::unknown("medium", name, known))?;
        Ok(self.plane(|lengths| lengths[medium]))
    }

    /// The part of an X-ray that comes through, from 0 to 1, by the numbers `attenuation` of the media, per length of the model;
    /// a medium without one lets all through. Without any, they weaken by their numbers `density`, or alike: see [`FAINTEST`].
    pub fn radiograph(&self, scene: &Scene) -> Plane<f64> {
        let attenuations = self.attenuations(scene);
        self.plane(|lengths| libm::exp(-lengths.iter().zip(&attenuations).map(faint).sum::<f64>()))
    }

    /// The attenuation of each medium, per length of the model.
    pub fn attenuations(&self, scene: &Scene) -> Vec<f64> {
        if let Some(said) = self.numbers(scene, "attenuation") {
            return said;
        }
        let alike = || (0..self.media.len()).map(|medium| if medium == 0 { 0.0 } else { 1.0 }).collect();
        let weights: Vec<f64> = self.numbers(scene, "density").unwrap_or_else(alike);
        let weighed = |lengths: &[f64]| lengths.iter().zip(&weights).map(faint).sum::<f64>();
        let all = (0..self.lengths.len()).map(|ray| weighed(self.lengths.of(ray)));
        let most = all.filter(|sum| sum.is_finite()).fold(0.0, f64::max);
        let mu = if most > 0.0 { -libm::log(FAINTEST) / most } else { 0.0 };
        weights.into_iter().map(|weight| mu * weight).collect()
    }

    /// A number of each medium, 0 for those that do not have it; `None` if none has.
    fn numbers(&self, scene: &Scene, key: &str) -> Option<Vec<f64>> {
        let of = |name: &String| {
            let medium = scene.media.iter().find(|medium| medium.name == *name)?;
            medium.numbers.iter().find(|(own, _)| own == key).map(|(_, value)| *value)
        };
        let said: Vec<Option<f64>> = self.media.iter().map(of).collect();
        let any = said.iter().any(Option::is_some);
        any.then(|| said.into_iter().map(Option::unwrap_or_default).collect())
    }

    fn plane(&self, of: impl Fn(&[f64]) -> f64) -> Plane<f64> {
        let mut plane = Plane::filled(self.size, 0.0);
        for (ray, value) in plane.values_mut().iter_mut().enumerate() {
            *value = of(self.lengths.of(ray));
        }
        plane
    }

    /// Writes the table of all pixels: `x` and `y`, counted from the upper left one, and the path length through each medium,
    /// under its name, in `unit`. The extension says the format, as for all tables.
    ///
    /// # Errors
    ///
    /// [`crate::ErrorKind::Output`], [`crate::ErrorKind::Format`].
    pub fn write(&self, path: &Path, unit: &str) -> Result<(), Error> {
        let mut columns = vec![Column::new("x", DType::I64), Column::new("y", DType::I64)];
        columns.extend(self.media.iter().map(|name| Column::new(name, DType::F64).unit(unit)));
        let schema = Schema::new(columns).map_err(Error::output)?;
        let mut writer = TableWriter::create(path, &schema).map_err(Error::output)?;
        let width = self.size.width();
        for y in 0..self.size.height() {
            let whole = |of: &dyn Fn(usize) -> i64| Values::from((0..width).map(of).collect::<Vec<_>>());
            let mut values = vec![whole(&|x| x as i64), whole(&|_| y as i64)];
            values.extend((0..self.media.len()).map(|medium| {
                Values::from((0..width).map(|x| self.lengths(x, y)[medium]).collect::<Vec<_>>())
            }));
            let chunk = Chunk::new(values).map_err(Error::output)?;
            writer.write(&chunk).map_err(Error::output)?;
        }
        writer.finish().map_err(Error::output)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AnyEvaluator;
    use rayweave_render::View;

    /// A ball of radius 2 in a box of side 6.
    fn map(water: &str, steel: &str) -> (ThicknessMap, Scene) {
        let text = format!(
            "rayweave = 1\n[solid.tank]\nbox = {{ size = [6, 6, 6] }}\n[solid.ball]\nsphere = {{ radius = 2 }}\n[[region]]\n\
             solid = \"tank\"\nmedium = \"water\"\n[[region]]\nsolid = \"ball\"\nmedium = \"steel\"\n[medium.water]\n{water}\n\
             [medium.steel]\n{steel}"
        );
        let (_, scene) = rayweave_scene::parse(&text).unwrap();
        let compiled = Compiled::new(&scene).unwrap();
        let evaluator = AnyEvaluator::new(None, compiled.program.clone()).unwrap();
        let size = Some(Size::new(41, 41).unwrap());
        let wishes = Wishes { size, view: Some(View::Front), ..Wishes::default() };
        (ThicknessMap::new(&scene, &compiled, &evaluator, &wishes, &mut Run::default()).unwrap(), scene)
    }

    /// Along the middle 2 of water and 4 of steel; near a corner of the box 6 of water alone.
    #[test]
    fn media_weaken_by_attenuation_or_density_or_alike() {
        let corner = (8, 8);
        // the weights along the middle and the corner, and the most of all rays
        for (water, steel, sums, most) in [
            ("", "", [6.0, 6.0], 6.0),
            ("density = 1", "density = 8", [34.0, 6.0], 34.0),
            ("density = 1", "", [2.0, 6.0], 6.0),
        ] {
            let (map, scene) = map(water, steel);
            assert!((map.lengths(corner.0, corner.1)[1] - 6.0).abs() < 1e-12);
            let radiograph = map.radiograph(&scene);
            let found =
                [20 * 41 + 20, corner.1 * 41 + corner.0].map(|pixel| -libm::log(radiograph.values()[pixel]));
            let wanted = sums.map(|sum| sum / most);
            for (found, wanted) in found.into_iter().zip(wanted) {
                assert!(
                    (found / -libm::log(FAINTEST) - wanted).abs() < 1e-9,
                    "{water} {steel} {found} {wanted}"
                );
            }
        }
        let (map, scene) = map("attenuation = 0.1\ndensity = 9", "density = 1");
        let radiograph = map.radiograph(&scene);
        assert!((-libm::log(radiograph.values()[20 * 41 + 20]) - 0.2).abs() < 1e-12);
    }
}
