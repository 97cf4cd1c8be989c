//! Seidel sums: third-order aberrations, surface by surface.

use crate::paraxial::{Matrix, Meridian};
use crate::prescription::{Prescription, PrescriptionError};
use rayweave_optics::component::SurfaceForm;

/// The Seidel sums S_I to S_V and the chromatic sums C_I and C_II of one surface or of a system, in the unit
/// of lengths: twice to eight times the wavefront coefficients. The marginal ray goes from the axis through
/// the rim of the pupil, the chief (principal) ray from the last field through its centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seidel {
    /// S_I; the wavefront at the rim of the pupil is S_I / 8.
    pub spherical: f64,
    /// S_II; the wavefront is S_II / 2.
    pub coma: f64,
    /// S_III; the wavefront is S_III / 2.
    pub astigmatism: f64,
    /// S_IV, the contribution of the Petzval sum; the wavefront is S_IV / 4.
    pub petzval: f64,
    /// S_V; the wavefront is S_V / 2.
    pub distortion: f64,
    /// C_I between the first and the last wavelength, axial colour; the wavefront is C_I / 2.
    pub axial_colour: f64,
    /// C_II, lateral colour; the wavefront is C_II.
    pub lateral_colour: f64,
}

impl Seidel {
    fn plus(self, other: Seidel) -> Seidel {
        Seidel {
            spherical: self.spherical + other.spherical,
            coma: self.coma + other.coma,
            astigmatism: self.astigmatism + other.astigmatism,
            petzval: self.petzval + other.petzval,
            distortion: self.distortion + other.distortion,
            axial_colour: self.axial_colour + other.axial_colour,
            lateral_colour: self.lateral_colour + other.lateral_colour,
        }
    }

    /// The sum over surfaces.
    pub fn sum(parts: &[Seidel]) -> Seidel {
        parts.iter().fold(Seidel::default(), |sum, &part| sum.plus(part))
    }
}

/// The data of one surface in Welford's formulas.
struct At {
    /// The curvature at the vertex, and the departure from its sphere: 8 times the difference in r^4.
    curvature: f64,
    asphericity: f64,
    /// Indices before and behind, and their differences between the first and the last wavelength.
    n: [f64; 2],
    dispersion: [f64; 2],
    /// Marginal ray and chief ray: height, then index times slope before and behind.
    rim: [f64; 3],
    principal: [f64; 3],
}

impl At {
    /// W. T. Welford, *Aberrations of Optical Systems*, 1986, chapters 8 (sums and aspheric surfaces) and 10
    /// (colour).
    ///
    /// Welford writes S_V = (A' / A) (S_III + S_IV) with the refraction invariants A = n (u + y c) of the
    /// marginal ray and A' of the chief ray. With the difference of u/n, A (1/n'^2 - 1/n^2) - y P, P = c
    /// (1/n' - 1/n), and H = A y' - A' y, the division by A, which may be 0, cancels: S_V = -A' (A'^2 y
    /// (1/n'^2 - 1/n^2) + (H - A' y) y' P).
    fn sums(&self) -> Seidel {
        let ([n0, n1], c) = (self.n, self.curvature);
        let ([y, nu0, nu1], [y_bar, nu0_bar, _]) = (self.rim, self.principal);
        let (a, a_bar) = (nu0 + n0 * y * c, nu0_bar + n0 * y_bar * c);
        let invariant = nu0 * y_bar - nu0_bar * y;
        let bend = y * (nu1 / (n1 * n1) - nu0 / (n0 * n0));
        let petzval = c * (1.0 / n1 - 1.0 / n0);
        let squares = 1.0 / (n1 * n1) - 1.0 / (n0 * n0);
        let asphere = self.asphericity * y * y * y * y * (n1 - n0);
        let ratio = y_bar / y;
        let [d0, d1] = self.dispersion;
        let colour = y * (d1 / n1 - d0 / n0);
        Seidel {
            spherical: -a * a * bend + asphere,
            coma: -a * a_bar * bend + ratio * asphere,
            astigmatism: -a_bar * a_bar * bend + ratio * ratio * asphere,
            petzval: -invariant * invariant * petzval,
            distortion: -a_bar * (a_bar * a_bar * squares * y + (invariant - a_bar * y) * y_bar * petzval)
                + ratio * ratio * ratio * asphere,
            axial_colour: a * colour,
            lateral_colour: a_bar * colour,
        }
    }
}

impl Prescription {
    /// The Seidel sums of every surface at the primary wavelength.
    ///
    /// # Errors
    /// As for [`Prescription::first_order`]; also an infinitely distant pupil, a surface that is not of
    /// revolution, and coordinate breaks.
    pub fn seidel(&self) -> Result<Vec<Seidel>, PrescriptionError> {
        let resolved = self.resolved()?;
        if !resolved.forms.iter().all(SurfaceForm::is_round) {
            let why = "a surface is not of revolution";
            return Err(PrescriptionError::Undefined { what: "Seidel sums", why });
        }
        if !self.breaks.is_empty() {
            let why = "its surfaces are not on one axis";
            return Err(PrescriptionError::Undefined { what: "Seidel sums", why });
        }
        let curvatures = resolved.curvatures(Meridian::Y);
        let n = resolved.indices(self.primary_nm())?;
        let of_line = |k: usize| resolved.indices(self.lines[k].wavelength_nm);
        let (first, last) = (of_line(0)?, of_line(self.lines.len() - 1)?);
        let [mut rim, mut principal] = self.paraxial_rays(n[0])?;
        let mut parts = Vec::with_capacity(self.surfaces.len());
        for (k, surface) in self.surfaces.iter().enumerate() {
            let matrix = Matrix::surface(curvatures[k], n[k], n[k + 1]);
            let at = At {
                curvature: curvatures[k],
                asphericity: surface.asphericity(),
                n: [n[k], n[k + 1]],
                dispersion: [first[k] - last[k], first[k + 1] - last[k + 1]],
                rim: [rim[0], rim[1], matrix.apply(rim)[1]],
                principal: [principal[0], principal[1], matrix.apply(principal)[1]],
            };
            parts.push(at.sums());
            let on = matrix.then(Matrix::distance(surface.thickness, n[k + 1]));
            (rim, principal) = (on.apply(rim), on.apply(principal));
        }
        Ok(parts)
    }

    /// The marginal ray of the axis and the chief ray of the last field, at the first surface.
    fn paraxial_rays(&self, n: f64) -> Result<[[f64; 2]; 2], PrescriptionError> {
        let resolved = self.resolved()?;
        let first_order = self.first_order_resolved(&resolved, self.primary_nm())?;
        let (pupil, height) =
            (first_order.entrance_pupil.position, 0.5 * first_order.entrance_pupil.diameter);
        let direction = self.launch(&resolved, self.fields.len() - 1)?.ray([0.0; 2]).direction;
        let slope = libm::hypot(direction.x, direction.y).copysign(direction.y) / direction.z;
        let principal = [-slope * pupil, n * slope];
        let rim = match self.object_distance.is_finite() {
            false => [height, 0.0],
            true => {
                let slope = height / (pupil + self.object_distance);
                [slope * self.object_distance, n * slope]
            }
        };
        Ok([rim, principal])
    }
}
