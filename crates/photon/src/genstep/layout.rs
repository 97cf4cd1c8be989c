//! Layouts of arrays of gensteps and photons.

use super::{EmissionProcess, Genstep};
use crate::error::PhotonError;
use crate::photon::{Photon, transverse};
use crate::property::{HC_MEV_NM, LIGHT_SPEED};
use rayweave_error::Message;
use rayweave_math::Vec3;

const CERENKOV: u32 = 15;
const SCINTILLATION: u32 = 16;
/// The kinds whose arrays have the same fields as those of [`CERENKOV`] and [`SCINTILLATION`]: Opticks writes them from
/// JUNO's own processes (`G4Cerenkov_modified` and `DsG4Scintillation_r4695` of `OpticksGenstep.h`).
const CERENKOV_MODIFIED: u32 = 18;
const SCINTILLATION_OF_JUNO: u32 = 5;

/// The numbers of an array of gensteps, row by row.
#[derive(Clone, Copy, Debug)]
pub enum GenstepNumbers<'a> {
    /// Numbers of type float32, which may hold the bits of integers.
    Single(&'a [f32]),
    /// Numbers of type float64.
    Double(&'a [f64]),
}

/// Reads an array of gensteps, whose shape determines the layout.
///
/// The layout of Opticks has the shape (N, 6, 4) and numbers of type float32, some of which hold the bits of integers:
///
/// | row | columns |
/// | --- | --- |
/// | 0 | kind (15 or 18 Cerenkov, 16 or 5 scintillation), track, number of the material, number of photons: integers |
/// | 1 | position in mm, time in ns |
/// | 2 | displacement in mm, length of the step in mm |
/// | 3 | code (integer), charge, weight, velocity in mm/ns: before the step (Cerenkov), or its mean (scintillation) |
/// | 4 | Cerenkov: 1/beta, shortest and longest wavelength in nm (0 for all of `RINDEX`), largest cosine; scintillation: component (integer; 0 to choose one by the yields) |
/// | 5 | Cerenkov: largest sin^2, mean numbers of photons before and after the step, velocity after it; scintillation: time constant in ns (0 for that of the material) |
///
/// The track, the code, the weight, the largest cosine and the largest sin^2 are not used.
///
/// Arrays of shape (N, 16) have the fields of the offload interface of Geant4 11.4 (`G4QuasiOpticalData`,
/// `G4CerenkovQuasiTrackInfo`, `G4ScintillationQuasiTrackInfo`):
///
/// | column | contents |
/// | --- | --- |
/// | 0 | kind: 15 Cerenkov, 16 scintillation |
/// | 1 to 4 | position of the track in mm, its time in ns |
/// | 5 | index of the material |
/// | 6 | number of photons |
/// | 7 | charge |
/// | 8 | length of the step in mm |
/// | 9, 10 | velocity before the step in mm/ns, and its change |
/// | 11 to 13 | displacement in mm |
/// | 14, 15 | Cerenkov: mean numbers of photons before and after the step; scintillation: time constant and rise time in ns |
///
/// The mean velocity of the step gives 1/beta. A component of scintillation is found by its time constant.
///
/// # Errors
///
/// [`PhotonError::Setting`]: another shape, float64 numbers in the layout of Opticks, another number of numbers than that of the
/// shape; and with the number of the genstep, an unknown kind or a number out of range.
pub fn gensteps_from_array(
    shape: &[usize],
    numbers: GenstepNumbers<'_>,
) -> Result<Vec<Genstep>, PhotonError> {
    let length = match numbers {
        GenstepNumbers::Single(numbers) => numbers.len(),
        GenstepNumbers::Double(numbers) => numbers.len(),
    };
    if !matches!(shape, [_, 6, 4] | [_, 16]) {
        let problem = format!("the array of gensteps has shape {}", shape_text(shape));
        return Err(PhotonError::setting(problem, "it must be (N, 6, 4) or (N, 16)"));
    }
    check_count("gensteps", shape, length)?;
    match (shape.len(), numbers) {
        (2, GenstepNumbers::Double(numbers)) => from_geant4(numbers),
        (2, GenstepNumbers::Single(numbers)) => {
            from_geant4(&numbers.iter().map(|&number| f64::from(number)).collect::<Vec<f64>>())
        }
        (_, GenstepNumbers::Single(numbers)) => from_opticks(numbers),
        (_, GenstepNumbers::Double(_)) => {
            let problem = "gensteps of shape (N, 6, 4) are not float32";
            let message = Message::new(problem, "they hold integers in the bits of float32");
            Err(PhotonError::Setting(message.suggest("Give the array as it was written.")))
        }
    }
}

/// An error if an array of a shape has another number of numbers.
fn check_count(what: &str, shape: &[usize], length: usize) -> Result<(), PhotonError> {
    if shape.iter().try_fold(1, |product: usize, own| product.checked_mul(*own)) == Some(length) {
        return Ok(());
    }
    let problem = format!("the array of {what} of shape {} has {length} numbers", shape_text(shape));
    Err(PhotonError::setting(problem, "there must be as many as the product of its lengths"))
}

/// A shape as NumPy prints it.
fn shape_text(shape: &[usize]) -> String {
    match shape {
        [length] => format!("({length},)"),
        _ => format!("({})", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// Gensteps in the layout of Opticks.
fn from_opticks(numbers: &[f32]) -> Result<Vec<Genstep>, PhotonError> {
    let read = |(row, values): (usize, &[f32; 24])| {
        let real = |k: usize| f64::from(values[k]);
        let vector = |k: usize| Vec3::new(real(k), real(k + 1), real(k + 2));
        let integer = |k: usize| values[k].to_bits();
        let velocity = real(15);
        let (process, velocity) = match integer(0) {
            CERENKOV | CERENKOV_MODIFIED => {
                let [shortest, longest] = [real(17), real(18)];
                let wavelengths =
                    [shortest, if longest == 0.0 && shortest == 0.0 { f64::INFINITY } else { longest }];
                let density = [real(21), real(22)];
                let process = EmissionProcess::Cerenkov { inverse_beta: real(16), wavelengths, density };
                (process, [velocity, real(23)])
            }
            SCINTILLATION | SCINTILLATION_OF_JUNO => {
                let component = Some(integer(16)).filter(|&component| component > 0);
                let process = EmissionProcess::Scintillation { component, time: real(20), rise_time: None };
                (process, [velocity; 2])
            }
            kind => return Err(unknown_opticks_kind(row, kind)),
        };
        Ok(Genstep {
            process,
            material: integer(2),
            photons: integer(3),
            position: vector(4),
            time: real(7),
            displacement: vector(8),
            step_length: real(11),
            charge: real(13),
            velocity,
        })
    };
    numbers.as_chunks::<24>().0.iter().enumerate().map(read).collect()
}

/// Gensteps in the layout of Geant4.
fn from_geant4(numbers: &[f64]) -> Result<Vec<Genstep>, PhotonError> {
    let read = |(row, values): (usize, &[f64; 16])| {
        let vector = |k: usize| Vec3::new(values[k], values[k + 1], values[k + 2]);
        let whole = |k: usize, what: &str| {
            let value = values[k];
            if value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value) {
                return Ok(value as u32);
            }
            let problem = format!("the {what} of genstep {row} is {value}");
            Err(PhotonError::setting(problem, "it must be a whole number from 0 to 4294967295"))
        };
        let (before, change) = (values[9], values[10]);
        let pair = [values[14], values[15]];
        let process = match values[0] {
            kind if kind == f64::from(CERENKOV) => EmissionProcess::Cerenkov {
                inverse_beta: LIGHT_SPEED / (before + 0.5 * change),
                wavelengths: [0.0, f64::INFINITY],
                density: pair,
            },
            kind if kind == f64::from(SCINTILLATION) => {
                EmissionProcess::Scintillation { component: None, time: pair[0], rise_time: Some(pair[1]) }
            }
            kind => return Err(unknown_kind(row, kind)),
        };
        Ok(Genstep {
            process,
            material: whole(5, "material")?,
            photons: whole(6, "number of photons")?,
            position: vector(1),
            time: values[4],
            displacement: vector(11),
            step_length: values[8],
            charge: values[7],
            velocity: [before, before + change],
        })
    };
    numbers.as_chunks::<16>().0.iter().enumerate().map(read).collect()
}

fn unknown_kind(row: usize, kind: f64) -> PhotonError {
    let problem = format!("genstep {row} is of the kind {kind}");
    PhotonError::setting(problem, "the kinds are 15 (Cerenkov) and 16 (scintillation)")
}

/// The error of a kind of `OpticksGenstep.h` without particles, of one in another layout, or of a number stored as a float.
fn unknown_opticks_kind(row: usize, kind: u32) -> PhotonError {
    let as_float = f32::from_bits(kind);
    if (1.0..256.0).contains(&as_float) && as_float.fract() == 0.0 {
        let message = Message::new(
            format!("genstep {row} has the kind {as_float} as a floating-point number"),
            "the kind, the track, the material and the number of photons are the bits of 32-bit integers",
        );
        return PhotonError::Setting(message.suggest("In NumPy: array.view(np.int32)[:, 0] = integers."));
    }
    let message = Message::new(
        format!("genstep {row} is of the kind {kind}"),
        "the kinds are 15 and 18 (Cerenkov), and 16 and 5 (scintillation)",
    );
    PhotonError::Setting(match kind {
        1..=4 => {
            message.suggest("Kinds 1 to 4 are of an older layout with other fields: write the present one.")
        }
        6..=8 | 19 => {
            message.suggest("It has no particle: use a source, such as a point, or give the photons.")
        }
        _ => message,
    })
}

/// The largest deviation of directions and polarisations in float32 from unit vectors that are perpendicular to each other.
const LOOSE: f64 = 1e-3;

/// Reads an array of photons in the layout of Opticks, of shape (N, 4, 4), in row-major order: position in mm and time in ns; direction and weight;
/// polarisation and wavelength in nm; four flags. Weight and flags are not used.
///
/// Directions and polarisations are made unit vectors that are perpendicular to each other; a polarisation of 0 0 0 means
/// unpolarised.
///
/// # Errors
///
/// [`PhotonError::Setting`]: another shape, another number of numbers than that of the shape; and with the number of the photon,
/// a number that is not finite, a wavelength that is not positive, a direction or polarisation that deviates by more than 1e-3.
pub fn photons_from_opticks(shape: &[usize], numbers: &[f64]) -> Result<Vec<Photon>, PhotonError> {
    if !matches!(shape, [_, 4, 4]) {
        let problem = format!("the array of photons has shape {}", shape_text(shape));
        return Err(PhotonError::setting(problem, "it must be (N, 4, 4)"));
    }
    check_count("photons", shape, numbers.len())?;
    let (rows, _) = numbers.as_chunks::<16>();
    let read = |(row, values): (usize, &[f64; 16])| {
        let bad = |reason: &str| PhotonError::setting(format!("photon {row} is invalid"), reason);
        let vector = |k: usize| Vec3::new(values[k], values[k + 1], values[k + 2]);
        let [position, direction, polarisation] = [0, 4, 8].map(vector);
        let is_unit = |vector: Vec3| (vector.length() - 1.0).abs() <= LOOSE;
        if !position.is_finite() || !values[3].is_finite() {
            return Err(bad("its position and time must be finite"));
        }
        if !is_unit(direction) {
            return Err(bad("its direction must have length 1"));
        }
        let direction = direction.normalize();
        let polarisation = if polarisation == Vec3::ZERO {
            polarisation
        } else {
            if !is_unit(polarisation) {
                return Err(bad("its polarisation must have length 1, or 0 if it is unpolarised"));
            }
            let part =
                (polarisation.dot(direction).abs() <= LOOSE).then(|| transverse(polarisation, direction));
            part.flatten().ok_or_else(|| bad("its polarisation must be perpendicular to its direction"))?
        };
        let wavelength = values[11];
        if !(wavelength > 0.0 && wavelength.is_finite()) {
            return Err(bad("its wavelength must be positive and finite"));
        }
        Ok(Photon { position, direction, polarisation, energy: HC_MEV_NM / wavelength, time: values[3] })
    };
    rows.iter().enumerate().map(read).collect()
}
