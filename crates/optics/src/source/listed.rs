//! Sources with a list of rays, also from ray files.

use super::SourceError;
use super::rays::LocalRay;
use rayweave_error::Message;
use rayweave_math::Vec3;
use rayweave_model::memory::Growth;
use rayweave_table::{AllowedFiles, RAYS_PER_CHUNK, RayChunk, RayReader, TableError};
use std::path::Path;
use std::sync::Arc;

/// A list of rays, optionally with wavelengths and powers.
///
/// A shared handle: a clone increments a reference count.
#[derive(Clone, Debug, PartialEq)]
pub struct ListedRays(Arc<Columns>);

#[derive(Debug, PartialEq)]
struct Columns {
    origins: Vec<Vec3>,
    /// Of unit length.
    directions: Vec<Vec3>,
    wavelength_nm: Option<Vec<f64>>,
    power: Option<Vec<f64>>,
    mean_power: f64,
}

impl ListedRays {
    /// Rays from origins and directions, which need not be of unit length.
    ///
    /// Wavelengths, in nanometres, replace the spectrum of the source. Powers multiply the power of
    /// a ray, which is then 1 unless the source sets it.
    ///
    /// # Errors
    /// Columns of different lengths, numbers that are not finite, directions of length zero,
    /// wavelengths that are not positive, powers that are negative or all zero.
    pub fn new(
        origins: Vec<Vec3>,
        directions: Vec<Vec3>,
        wavelength_nm: Option<Vec<f64>>,
        power: Option<Vec<f64>>,
    ) -> Result<ListedRays, SourceError> {
        let expected = origins.len();
        for (column, found) in [
            ("directions", directions.len()),
            ("wavelength_nm", wavelength_nm.as_ref().map_or(expected, Vec::len)),
            ("power", power.as_ref().map_or(expected, Vec::len)),
        ] {
            if found != expected {
                return Err(SourceError::Column { column, found, expected });
            }
        }
        check("origins", &origins, "coordinates must be finite", |origin| origin.is_finite())?;
        check("directions", &directions, "its length must not be 0 and must not overflow", |direction| {
            rayweave_math::unit(*direction).is_finite()
        })?;
        let (wavelengths, powers) =
            (wavelength_nm.as_deref().unwrap_or(&[]), power.as_deref().unwrap_or(&[]));
        check("wavelength_nm", wavelengths, "wavelengths must be finite and greater than 0", |&value| {
            value > 0.0 && value.is_finite()
        })?;
        check("power", powers, "powers must be finite and not negative", |&value| {
            value >= 0.0 && value.is_finite()
        })?;
        let mean_power =
            if powers.is_empty() { 1.0 } else { powers.iter().sum::<f64>() / powers.len() as f64 };
        if mean_power == 0.0 {
            let message = Message::new("all powers of the rays are 0", "a source needs power");
            return Err(SourceError::Inconsistent(message));
        }
        let directions = directions.into_iter().map(rayweave_math::unit).collect();
        Ok(ListedRays(Arc::new(Columns { origins, directions, wavelength_nm, power, mean_power })))
    }

    /// The rays of a file, `.csv` with the columns `ox,oy,oz,dx,dy,dz` and optionally
    /// `wavelength_nm` and `power`, or `.npy` of the shape (N, 6), (N, 7) with wavelengths or
    /// (N, 8) with both.
    ///
    /// # Errors
    /// [`SourceError::File`] with all problems of the file, and their lines;
    /// [`SourceError::Inconsistent`] for a file without rays.
    pub fn read(path: impl AsRef<Path>) -> Result<ListedRays, SourceError> {
        ListedRays::from_reader(RayReader::open_light(path).map_err(unreadable)?)
    }

    /// The rays of a file that a model names, if it is among the given files; see [`read`](Self::read).
    ///
    /// # Errors
    /// As for [`read`](Self::read), and [`SourceError::File`] for a file that is not allowed.
    pub fn read_allowed(path: impl AsRef<Path>, files: &AllowedFiles) -> Result<ListedRays, SourceError> {
        ListedRays::from_reader(RayReader::open_allowed_light(path, files).map_err(unreadable)?)
    }

    fn from_reader(mut reader: RayReader) -> Result<ListedRays, SourceError> {
        let (mut chunk, mut all) = (RayChunk::default(), RayChunk::default());
        let (mut origins, mut directions, mut growth) = (Vec::new(), Vec::new(), Growth::default());
        while reader.read(&mut chunk, RAYS_PER_CHUNK).map_err(unreadable)? > 0 {
            let vector =
                |columns: &[Vec<f64>; 3], k: usize| Vec3::new(columns[0][k], columns[1][k], columns[2][k]);
            origins.extend((0..chunk.len()).map(|k| vector(&chunk.origin, k)));
            directions.extend((0..chunk.len()).map(|k| vector(&chunk.direction, k)));
            all.wavelength_nm.append(&mut chunk.wavelength_nm);
            all.power.append(&mut chunk.power);
            // origin, direction, wavelength and power
            growth.check(8 * 8 * origins.len() as u64).map_err(|shortage| {
                let problem = "the rays of the file do not fit into memory";
                SourceError::Inconsistent(Message::new(problem, shortage.to_string()))
            })?;
        }
        if origins.is_empty() {
            let message = Message::new("the file has no rays", "a source needs at least one");
            return Err(SourceError::Inconsistent(message));
        }
        let given = |column: Vec<f64>| (!column.is_empty()).then_some(column);
        ListedRays::new(origins, directions, given(all.wavelength_nm), given(all.power))
    }

    /// The shortest and the longest wavelength in nanometres, if the rays have wavelengths.
    pub fn range_nm(&self) -> Option<[f64; 2]> {
        let lengths = self.0.wavelength_nm.as_ref()?;
        let grow = |[lo, hi]: [f64; 2], &nm: &f64| [lo.min(nm), hi.max(nm)];
        Some(lengths.iter().fold([f64::INFINITY, f64::NEG_INFINITY], grow))
    }

    /// The sum of the powers, if the rays have powers.
    pub fn power(&self) -> Option<f64> {
        self.0.power.as_ref().map(|column| column.iter().sum())
    }

    /// The number of rays.
    pub fn len(&self) -> usize {
        self.0.origins.len()
    }

    /// True if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(super) fn has_powers(&self) -> bool {
        self.0.power.is_some()
    }

    pub(super) fn mean_power(&self) -> f64 {
        self.0.mean_power
    }

    pub(super) fn wavelength_nm(&self, ray: usize) -> Option<f64> {
        self.0.wavelength_nm.as_ref().map(|column| column[ray])
    }

    pub(super) fn ray(&self, ray: usize) -> LocalRay {
        LocalRay {
            origin: self.0.origins[ray],
            direction: self.0.directions[ray],
            weight: self.0.power.as_ref().map_or(1.0, |column| column[ray]),
        }
    }
}

fn unreadable(error: TableError) -> SourceError {
    SourceError::File { problem: error.to_string() }
}

/// An error for the first invalid value.
fn check<T: std::fmt::Display>(
    column: &'static str,
    values: &[T],
    why: &'static str,
    is_sound: impl Fn(&T) -> bool,
) -> Result<(), SourceError> {
    match values.iter().position(|value| !is_sound(value)) {
        None => Ok(()),
        Some(ray) => Err(SourceError::BadRay { column, ray, value: values[ray].to_string(), why }),
    }
}
