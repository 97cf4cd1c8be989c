//! Modulation transfer functions (MTF) of a changed prescription at one frequency, for goals and merits.

use super::DesignError;
use super::variant::Variant;
use crate::analysis::{Arrival, PupilQuadrature, defocused, gauss_legendre, geometric_mtf};

/// The kind of a modulation transfer function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MtfKind {
    /// The transform of the spot, without diffraction ([`geometric_mtf`]).
    Geometric,
    /// The autocorrelation of the pupil function (J. W. Goodman, *Introduction to Fourier Optics*, section 6.3), with equal
    /// amplitudes over a clear pupil. At several wavelengths the transfer functions are added with their phases.
    Diffraction,
}

/// The direction of the lines of a modulation transfer function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MtfLines {
    /// Lines across the direction of the field; across y for a field on the axis.
    Tangential,
    /// Lines along the direction of the field.
    Sagittal,
}

/// The modulation of a field at a frequency in cycles per unit of length, for all wavelengths of the prescription with their
/// weights, on the image plane moved along the axis by `shift`; `None` if a ray that it needs does not arrive.
pub(super) fn modulation(
    variant: &Variant,
    (kind, lines): (MtfKind, MtfLines),
    (field, frequency): (usize, f64),
    pupil: &PupilQuadrature,
    shift: f64,
) -> Result<Option<f64>, DesignError> {
    let along = direction(variant, field, lines);
    if kind == MtfKind::Geometric {
        let rays = defocused(&variant.polychromatic(field, pupil)?, shift);
        let sent = pupil.points.len() * variant.lens.lines.len();
        return Ok((rays.len() == sent).then(|| geometric_mtf(&rays, along, &[frequency])[0]));
    }
    let (mut sum, mut total) = ([0.0; 2], 0.0);
    for line in &variant.lens.lines {
        let vector = along.map(|part| part * frequency);
        let Some(part) = transfer(variant, (field, line.wavelength_nm), vector, pupil, shift)? else {
            return Ok(None);
        };
        sum = [0, 1].map(|k| sum[k] + line.weight * part[k]);
        total += line.weight;
    }
    Ok(Some(libm::hypot(sum[0], sum[1]) / total))
}

/// The unit vector across the lines.
fn direction(variant: &Variant, field: usize, lines: MtfLines) -> [f64; 2] {
    let place = variant.lens.fields.get(field).copied().unwrap_or([0.0; 2]);
    let size = libm::hypot(place[0], place[1]);
    let [x, y] = if size > 0.0 { place.map(|part| part / size) } else { [0.0, 1.0] };
    match lines {
        MtfLines::Tangential => [x, y],
        MtfLines::Sagittal => [y, -x],
    }
}

/// The optical transfer function at a wavelength as a complex number, with the phase of the place of the image.
fn transfer(
    variant: &Variant,
    (field, wavelength_nm): (usize, f64),
    frequency: [f64; 2],
    pupil: &PupilQuadrature,
    shift: f64,
) -> Result<Option<[f64; 2]>, DesignError> {
    let centre = PupilQuadrature::equal(&[[0.0; 2]]);
    let rays = variant.arrivals(field, wavelength_nm, pupil)?;
    let chief = defocused(&variant.arrivals(field, wavelength_nm, &centre)?, shift);
    let (Some(chief), true) = (chief.first(), rays.len() == pupil.points.len()) else { return Ok(None) };
    // a frequency v is a difference of direction cosines of wavelength v / index
    let scale = wavelength_nm / variant.lens.unit_nm / chief.index;
    let Some(offset) = pupil_shift(&rays, pupil, frequency.map(|part| scale * part)) else { return Ok(None) };
    let Some((points, weights)) = overlap(offset, 2 * pupil_rings(pupil) + 4) else {
        return Ok(Some([0.0; 2]));
    };
    let found = variant.wavefront(field, wavelength_nm, &PupilQuadrature::equal(&points), shift)?;
    let Some(waves) = found.map(|found| found.front.waves).filter(|waves| waves.len() == points.len()) else {
        return Ok(None);
    };
    let place = frequency[0] * chief.position.x + frequency[1] * chief.position.y;
    let term = |(pair, weight): (&[f64], &f64)| {
        let (sin, cos) = libm::sincos(-std::f64::consts::TAU * (pair[0] - pair[1] + place));
        [weight * cos, weight * sin]
    };
    let terms = waves.chunks_exact(2).zip(&weights).map(term);
    Ok(Some(terms.fold([0.0; 2], |[a, b], [cos, sin]| [a + cos, b + sin])))
}

/// The number of rings of a Gaussian quadrature with 2 rings (rings + 2) points.
fn pupil_rings(pupil: &PupilQuadrature) -> usize {
    (1..).find(|rings| 2 * rings * (rings + 2) >= pupil.points.len()).unwrap_or(1)
}

/// The shift in the pupil that belongs to a difference of direction cosines at the image, by the linear map from points of the
/// pupil to direction cosines that fits best: over the disk, the coordinates have the mean square 1/4.
fn pupil_shift(rays: &[Arrival], pupil: &PupilQuadrature, difference: [f64; 2]) -> Option<[f64; 2]> {
    let mut map = [[0.0; 2]; 2];
    for ray in rays {
        let (at, weight) = (pupil.points[ray.id], pupil.weights[ray.id]);
        for (row, cosine) in map.iter_mut().zip([ray.direction.x, ray.direction.y]) {
            for (entry, coordinate) in row.iter_mut().zip(at) {
                *entry += 4.0 * weight * cosine * coordinate;
            }
        }
    }
    let [[a, b], [c, d]] = map;
    let determinant = a * d - b * c;
    let [x, y] = difference;
    let shift = [(d * x - b * y) / determinant, (a * y - c * x) / determinant];
    shift.iter().all(|part| part.is_finite()).then_some(shift)
}

/// Pairs of points of the pupil, one after the other, that are `shift` apart, with weights whose sum is the area of the overlap
/// of two pupils over that of one; none beyond the cutoff. Gauss-Legendre quadrature in both directions; across the shift, in
/// the angle whose sine is the coordinate, so that the ends of the overlap are no singularity.
fn overlap(shift: [f64; 2], count: usize) -> Option<(Vec<[f64; 2]>, Vec<f64>)> {
    let half = 0.5 * libm::hypot(shift[0], shift[1]);
    if half >= 1.0 {
        return None;
    }
    let [x, y] = if half > 0.0 { shift.map(|part| 0.5 * part / half) } else { [1.0, 0.0] };
    let (widest, nodes) = ((1.0 - half * half).sqrt(), gauss_legendre(count));
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (node, share) in &nodes {
        let (sin, cos) = libm::sincos(std::f64::consts::PI * (node - 0.5));
        let across = widest * sin;
        let reach = ((1.0 - across * across).sqrt() - half).max(0.0);
        for (other, part) in &nodes {
            let along = reach * (2.0 * other - 1.0);
            for side in [half, -half] {
                points.push([(along + side) * x - across * y, (along + side) * y + across * x]);
            }
            // d across d along / pi
            weights.push(widest * cos * share * 2.0 * reach * part);
        }
    }
    Some((points, weights))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The transfer function of a clear circular pupil: 2 / pi (acos v - v sqrt(1 - v^2)) at the frequency v over the cutoff
    /// (Goodman, equation 6-31). The integrand has a branch point next to the ends of the overlap, at a distance that goes with v: small
    /// shifts converge slowest.
    #[test]
    fn the_overlap_of_two_disks() {
        for (k, (count, tolerance)) in (0..20).flat_map(|k| [(k, (16, 2e-7)), (k, (32, 1e-9))]) {
            let v = f64::from(k) / 20.0;
            let (points, weights) = overlap([1.2 * v, -1.6 * v], count).unwrap();
            let expected = 2.0 / std::f64::consts::PI * (libm::acos(v) - v * (1.0 - v * v).sqrt());
            assert!((weights.iter().sum::<f64>() - expected).abs() < tolerance, "{v}");
            assert!(points.iter().all(|[x, y]| libm::hypot(*x, *y) < 1.0));
            for pair in points.chunks(2) {
                let off = [pair[0][0] - pair[1][0] - 1.2 * v, pair[0][1] - pair[1][1] + 1.6 * v];
                assert!(off.iter().all(|off| off.abs() < 1e-15));
            }
        }
        assert!(overlap([1.2, -1.6], 16).is_none());
    }
}
