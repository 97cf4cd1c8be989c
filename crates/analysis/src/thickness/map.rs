//! Thickness maps: path lengths and radiographs, pixel by pixel.

use super::attenuation::ATTENUATION;
use super::{PathLengths, ThicknessRun, path_lengths};
use crate::AnalysisError;
use rayweave_error::Message;
use rayweave_model::{Evaluator, memory};
use rayweave_scene::{Compiled, Scene};
use rayweave_shape::Ray;
use rayweave_table::{Chunk, Column, DType, Part, Schema, TableError, TableWriter, Values};
use std::ops::Range;
use std::path::Path;

/// Path lengths through each medium, one ray per pixel, for example the rays of a camera.
///
/// ```
/// use rayweave_analysis::thickness::{ThicknessRun, ThicknessMap};
/// use rayweave_math::Vec3;
/// use rayweave_scene::Compiled;
/// use rayweave_shape::Ray;
/// use rayweave_trace::Packets;
///
/// let (_, scene) = rayweave_scene::parse(
///     "rayweave = 1\nunit = \"cm\"\n[solid.ball]\nsphere = { radius = 2 }\n[[region]]\nsolid = \"ball\"\nmedium = \"steel\"\n\
///      [medium.steel]\nattenuation = 0.5",
/// )?;
/// let compiled = Compiled::new(&scene)?;
/// let evaluator = Packets::new(compiled.program.clone());
/// let along_y = |x: usize, y: usize| Ray::new(Vec3::new(x as f64 - 2.0, -9.0, 2.0 - y as f64), Vec3::Y);
/// let map = ThicknessMap::new(&compiled, &evaluator, [5, 5], along_y, &mut ThicknessRun::default())?;
///
/// // through the middle: 4 cm of steel, which transmit exp(-2)
/// assert!((map.lengths(2, 2)[1] - 4.0).abs() < 1e-12);
/// assert!((map.radiograph(&scene)[2 * 5 + 2] - 0.135_335_283_236_612_7).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ThicknessMap {
    size: [usize; 2],
    /// The number of the first row in the whole picture.
    first_row: usize,
    media: Vec<String>,
    /// The names of the materials of `media`, which are different if these are regions.
    materials: Vec<String>,
    lengths: PathLengths,
}

/// The attenuation exponent over a length: 0 without attenuation, even over an infinite length.
fn optical_depth((length, mu): (&f64, &f64)) -> f64 {
    if *mu == 0.0 { 0.0 } else { length * mu }
}

/// The transmitted fraction of X-rays, for a line integral of the attenuation.
pub fn transmitted(line_integral: f64) -> f64 {
    libm::exp(-line_integral)
}

/// The maximum number of path lengths of a map, one for each pixel and medium: 2 GiB of memory.
pub const MAX_LENGTHS: usize = 1 << 28;

/// The transmission of the darkest pixel if no medium has an attenuation. The attenuations are then
/// proportional to the densities, or equal if no medium has a density.
pub const FAINTEST: f64 = 0.05;

impl ThicknessMap {
    /// Traces the rays of all pixels; `ray` returns the ray of column x and row y, counted from the upper
    /// left.
    ///
    /// # Errors
    ///
    /// [`AnalysisError::Value`] for more than [`MAX_LENGTHS`] path lengths, or more than fit into memory; [`AnalysisError::Cancelled`].
    pub fn new<E: Evaluator>(
        compiled: &Compiled,
        evaluator: &E,
        [width, height]: [usize; 2],
        ray: impl Fn(usize, usize) -> Ray + Sync,
        run: &mut ThicknessRun<'_>,
    ) -> Result<ThicknessMap, AnalysisError> {
        ThicknessMap::of_rows(compiled, evaluator, width, 0..height, ray, run)
    }

    /// Like [`new`](Self::new), for some rows of pixels of a picture of this width: the map has only these rows, and its table
    /// has their numbers.
    ///
    /// # Errors
    ///
    /// Those of `new`.
    pub fn of_rows<E: Evaluator>(
        compiled: &Compiled,
        evaluator: &E,
        width: usize,
        rows: Range<usize>,
        ray: impl Fn(usize, usize) -> Ray + Sync,
        run: &mut ThicknessRun<'_>,
    ) -> Result<ThicknessMap, AnalysisError> {
        let height = rows.len();
        let media = compiled.media.to_vec();
        let count = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(media.len()));
        if count.is_none_or(|count| count > MAX_LENGTHS) {
            let problem = format!("the size of the map is {width}x{height} with {} media", media.len());
            let reason = format!("a map holds at most {MAX_LENGTHS} path lengths");
            return Err(AnalysisError::Value(Message::new(problem, reason).suggest("Reduce the size.")));
        }
        // each length, and its copy in a table or array
        memory::check(count.unwrap_or(usize::MAX) as u64, 2 * size_of::<f64>() as u64).map_err(
            |shortage| {
                let problem = format!(
                    "a map of {width}x{height} pixels with {} media does not fit into memory",
                    media.len()
                );
                AnalysisError::Value(Message::new(problem, shortage.to_string()).suggest("Reduce the size."))
            },
        )?;
        let ray = |k: usize| ray(k % width, rows.start + k / width);
        let lengths = path_lengths(evaluator, media.len(), width * height, ray, run)?;
        let materials = media.clone();
        Ok(ThicknessMap { size: [width, height], first_row: rows.start, media, materials, lengths })
    }

    /// The map of a scene that was compiled [by region](Compiled::by_region): each region has the attenuation and density of its
    /// medium.
    #[must_use]
    pub fn of_regions(mut self, scene: &Scene) -> ThicknessMap {
        let names = scene.regions.iter().map(|region| scene.media.get(region.medium as usize));
        let world = scene.media.first().map_or(String::new(), |medium| medium.name.clone());
        let names = names.map(|medium| medium.map_or(String::new(), |medium| medium.name.clone()));
        self.materials = std::iter::once(world).chain(names).collect();
        self
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The names of the media.
    pub fn media(&self) -> &[String] {
        &self.media
    }

    /// The path lengths at a pixel, counted from the upper left, medium by medium: see [`PathLengths::of`].
    pub fn lengths(&self, x: usize, y: usize) -> &[f64] {
        self.lengths.of(y * self.size[0] + x)
    }

    /// All path lengths, pixel by pixel.
    pub fn path_lengths(&self) -> &PathLengths {
        &self.lengths
    }

    /// The path lengths through one medium, pixel by pixel.
    ///
    /// # Errors
    ///
    /// [`AnalysisError::Name`] for an unknown medium.
    pub fn of_medium(&self, name: &str) -> Result<Vec<f64>, AnalysisError> {
        let known = self.media.iter().map(String::as_str);
        let medium = known.clone().position(|own| own == name);
        let medium = medium.ok_or_else(|| AnalysisError::Name(Message::unknown("medium", name, known)))?;
        Ok(self.pixels(|lengths| lengths[medium]))
    }

    /// The transmission of X-rays from 0 to 1, pixel by pixel, computed from the property `attenuation` of the
    /// media, per length unit of the model; a medium without it is transparent. If no medium has it, attenuations
    /// are proportional to `density`, or equal: see [`FAINTEST`].
    pub fn radiograph(&self, scene: &Scene) -> Vec<f64> {
        self.line_integrals(scene).into_iter().map(transmitted).collect()
    }

    /// The line integral of the attenuation, pixel by pixel: the negative natural logarithm of the
    /// [radiograph](Self::radiograph), which computed tomography starts from.
    pub fn line_integrals(&self, scene: &Scene) -> Vec<f64> {
        let attenuations = self.attenuations(scene);
        self.pixels(|lengths| lengths.iter().zip(&attenuations).map(optical_depth).sum())
    }

    /// The attenuation of each medium, per length unit of the model.
    pub fn attenuations(&self, scene: &Scene) -> Vec<f64> {
        if let Some(said) = self.numbers(scene, ATTENUATION) {
            return said;
        }
        let alike = || (0..self.media.len()).map(|medium| if medium == 0 { 0.0 } else { 1.0 }).collect();
        let weights: Vec<f64> = self.numbers(scene, "density").unwrap_or_else(alike);
        let weighed = |lengths: &[f64]| lengths.iter().zip(&weights).map(optical_depth).sum::<f64>();
        let all = (0..self.lengths.len()).map(|ray| weighed(self.lengths.of(ray)));
        let most = all.filter(|sum| sum.is_finite()).fold(0.0, f64::max);
        let mu = if most > 0.0 { -libm::log(FAINTEST) / most } else { 0.0 };
        weights.into_iter().map(|weight| mu * weight).collect()
    }

    /// A numeric property of each medium, 0 for media without it; `None` if no medium has it.
    fn numbers(&self, scene: &Scene, key: &str) -> Option<Vec<f64>> {
        let of = |name: &String| {
            let medium = scene.media.iter().find(|medium| medium.name == *name)?;
            medium.number(key)
        };
        let said: Vec<Option<f64>> = self.materials.iter().map(of).collect();
        let any = said.iter().any(Option::is_some);
        any.then(|| said.into_iter().map(Option::unwrap_or_default).collect())
    }

    fn pixels(&self, of: impl Fn(&[f64]) -> f64) -> Vec<f64> {
        (0..self.lengths.len()).map(|ray| of(self.lengths.of(ray))).collect()
    }

    /// Writes the table of all pixels: `x` and `y`, counted from the upper left, and the path length through
    /// each medium, under its name, in `unit`. The extension selects the format, as for all tables.
    ///
    /// # Errors
    ///
    /// [`TableError`] if the table cannot be written.
    pub fn write(&self, path: &Path, unit: &str) -> Result<(), TableError> {
        self.write_part(path, unit, None)
    }

    /// Writes the table like [`write`](Self::write), and the description of the part that it is.
    ///
    /// # Errors
    ///
    /// [`TableError`] if a file cannot be written.
    pub fn write_part(&self, path: &Path, unit: &str, part: Option<&Part>) -> Result<(), TableError> {
        let mut columns = vec![Column::new("x", DType::I64), Column::new("y", DType::I64)];
        columns.extend(self.media.iter().map(|name| Column::new(name, DType::F64).unit(unit)));
        let schema = Schema::new(columns)?;
        let mut writer = TableWriter::create(path, &schema)?;
        let [width, height] = self.size;
        for y in 0..height {
            let whole = |of: &dyn Fn(usize) -> i64| Values::from((0..width).map(of).collect::<Vec<_>>());
            let mut values = vec![whole(&|x| x as i64), whole(&|_| (self.first_row + y) as i64)];
            values.extend((0..self.media.len()).map(|medium| {
                Values::from((0..width).map(|x| self.lengths(x, y)[medium]).collect::<Vec<_>>())
            }));
            let chunk = Chunk::new(values)?;
            writer.write(&chunk)?;
        }
        match part {
            Some(part) => writer.finish_part(part)?,
            None => writer.finish()?,
        };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_math::Vec3;
    use rayweave_trace::AnyEvaluator;

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
        // parallel rays along y, 0.18 apart
        let ray = |x: usize, y: usize| {
            Ray::new(Vec3::new(0.18 * (x as f64 - 20.0), -9.0, 0.18 * (20.0 - y as f64)), Vec3::Y)
        };
        (
            ThicknessMap::new(&compiled, &evaluator, [41, 41], ray, &mut ThicknessRun::default()).unwrap(),
            scene,
        )
    }

    /// Two regions of water, one behind the other, have a column each, and the attenuation of water.
    #[test]
    fn maps_by_region_have_the_materials_of_the_regions() {
        let (_, scene) = rayweave_scene::parse(
            "rayweave = 1\n[solid.a]\nbox = { size = 4 }\n[solid.b]\nbox = { size = 2 }\ntransform = { translate = [0, 9, 0] }\n\
             [[region]]\nsolid = \"a\"\nmedium = \"water\"\n[[region]]\nsolid = \"b\"\nmedium = \"water\"\n[medium.water]\nattenuation = 0.1",
        )
        .unwrap();
        let compiled = Compiled::by_region(&scene).unwrap();
        let evaluator = AnyEvaluator::new(None, compiled.program.clone()).unwrap();
        let ray = |_, _| Ray::new(Vec3::new(0.0, -9.0, 0.0), Vec3::Y);
        let map =
            ThicknessMap::new(&compiled, &evaluator, [1, 1], ray, &mut ThicknessRun::default()).unwrap();
        let map = map.of_regions(&scene);
        assert_eq!(map.media(), ["world", "a", "b"]);
        assert_eq!(
            (map.lengths(0, 0), map.attenuations(&scene)),
            (&[6.0, 4.0, 2.0][..], vec![0.0, 0.1, 0.1])
        );
        assert!((map.line_integrals(&scene)[0] - 0.6).abs() < 1e-12);
    }

    #[test]
    fn maps_beyond_the_limit_are_refused_before_allocation() {
        let (_, scene) =
            rayweave_scene::parse("rayweave = 1\n[solid.ball]\nsphere = { radius = 2 }").unwrap();
        let compiled = Compiled::new(&scene).unwrap();
        let evaluator = AnyEvaluator::new(None, compiled.program.clone()).unwrap();
        for size in [[20_000, 20_000], [usize::MAX, 2]] {
            let ray = |_, _| Ray::new(Vec3::ZERO, Vec3::X);
            let error = ThicknessMap::new(&compiled, &evaluator, size, ray, &mut ThicknessRun::default())
                .unwrap_err();
            assert!(
                error.to_string().ends_with("at most 268435456 path lengths. Reduce the size."),
                "{error}"
            );
        }
    }

    /// Along the centre, 2 of water and 4 of steel; near a corner of the box, 6 of water alone.
    #[test]
    fn media_weaken_by_attenuation_or_density_or_alike() {
        let corner = (8, 8);
        // the exponents along the centre and the corner, and the largest of all rays
        for (water, steel, sums, most) in [
            ("", "", [6.0, 6.0], 6.0),
            ("density = 1", "density = 8", [34.0, 6.0], 34.0),
            ("density = 1", "", [2.0, 6.0], 6.0),
        ] {
            let (map, scene) = map(water, steel);
            assert!((map.lengths(corner.0, corner.1)[1] - 6.0).abs() < 1e-12);
            let radiograph = map.radiograph(&scene);
            let found = [20 * 41 + 20, corner.1 * 41 + corner.0].map(|pixel| -libm::log(radiograph[pixel]));
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
        assert!((-libm::log(radiograph[20 * 41 + 20]) - 0.2).abs() < 1e-12);
    }
}
