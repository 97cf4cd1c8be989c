//! Twisted solids (`G4TwistedBox`, `G4TwistedTrd`, `G4TwistedTrap`, `G4TwistedTubs`).

use super::faceted::{Trapezoid, ruled};
use super::round::hyperboloid;
use super::{Made, loose_box, of, union_of};
use crate::gdml::attributes::refused;
use rayweave_math::{Vec3, sin_cos_degrees};
use rayweave_model::Solid;
use rayweave_shape::primitive::Quadric;

/// Largest twist of one slice in degrees: vertices then deviate by at most 1 - cos(1 degree), i.e. 1.6e-4, of their
/// distance from the axis.
const STEP: f64 = 2.0;

/// `G4TwistedBox`, `G4TwistedTrd`, `G4TwistedTrap`: sections that rotate linearly along z, by `twist` from end to end.
///
/// The side faces are not algebraic surfaces. The solid is approximated by a stack of slices, each ruled between its end
/// sections.
pub(in crate::gdml) fn twisted(trapezoid: &Trapezoid, twist: f64) -> Made {
    if !(0.0 < twist.abs() && twist.abs() < 90.0) {
        return refused("the twist is not between 0 and 90 degrees");
    }
    let [low, high] = trapezoid.corners();
    let count = (twist.abs() / STEP).ceil();
    let section = |k: f64| {
        let part = k / count;
        let (sin, cos) = sin_cos_degrees(twist * (part - 0.5));
        // the centre of a section is translated, not rotated
        let lean = middle(low, high, part);
        std::array::from_fn(|corner| {
            let at =
                [0, 1].map(|axis| (1.0 - part) * low[corner][axis] + part * high[corner][axis] - lean[axis]);
            [lean[0] + cos * at[0] - sin * at[1], lean[1] + sin * at[0] + cos * at[1]]
        })
    };
    let thickness = trapezoid.z / count;
    let mut slices = Vec::new();
    for k in (0..count as u32).map(f64::from) {
        let middle = -0.5 * trapezoid.z + (k + 0.5) * thickness;
        slices.push(ruled(section(k), section(k + 1.0), 0.5 * thickness)?.translate(Vec3::Z * middle));
    }
    union_of(slices, "it has no inside")
}

/// Centre of the section at a fraction of the height.
fn middle(low: [[f64; 2]; 4], high: [[f64; 2]; 4], part: f64) -> [f64; 2] {
    let mean = |corners: [[f64; 2]; 4], axis: usize| {
        // the midpoint of the line between the midpoints of the two sides along x
        0.25 * corners.iter().map(|corner| corner[axis]).sum::<f64>()
    };
    [0, 1].map(|axis| (1.0 - part) * mean(low, axis) + part * mean(high, axis))
}

/// `G4TwistedTubs`: between two hyperboloids with the given radii at the ends, in a sector whose sides are hyperbolic
/// paraboloids. All faces are exact quadrics or planes.
pub(in crate::gdml) fn twisted_tube(twist: f64, rmin: f64, rmax: f64, z: f64, phi: f64) -> Made {
    let is_possible =
        0.0 < twist.abs() && twist.abs() < 180.0 && (0.0..rmax).contains(&rmin) && 0.0 < phi && phi < 360.0;
    if !is_possible {
        return refused("the twist is not less than 180 degrees, or its radii or sector are empty");
    }
    let (sin, cos) = sin_cos_degrees(0.5 * twist);
    let (half, kappa) = (0.5 * z, sin / cos / (0.5 * z));
    let outer = hyperboloid(rmax * cos, rmax * cos * kappa)? & loose_box(rmax, rmax, half)?;
    let sector = |angle: f64| side(angle, kappa);
    let (first, second) = (sector(-0.5 * phi)?, sector(0.5 * phi)?);
    let sector = match phi {
        180.0 => first,
        _ if phi < 180.0 => first - second,
        _ => !(second - first),
    };
    let whole = outer & sector;
    Ok(if rmin > 0.0 { whole - hyperboloid(rmin * cos, rmin * cos * kappa)? } else { whole })
}

/// The points to the left of the line through the axis at an angle for z = 0, twisted as y = kappa x z.
fn side(angle: f64, kappa: f64) -> Made {
    let (sin, cos) = sin_cos_degrees(angle);
    // along = cos x + sin y, across = cos y - sin x: kappa along z - across < 0
    let mut q = [[0.0; 4]; 4];
    let mut set = |i: usize, j: usize, value: f64| {
        q[i][j] = value;
        q[j][i] = value;
    };
    set(0, 2, 0.5 * kappa * cos);
    set(1, 2, 0.5 * kappa * sin);
    set(0, 3, 0.5 * sin);
    set(1, 3, -0.5 * cos);
    let quadric: Solid = of(Quadric::new(q)?);
    Ok(quadric)
}
