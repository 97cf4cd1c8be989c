//! Paraxial optics of prescriptions: ray transfer matrices, cardinal points, pupils, Petzval and Seidel sums.
//!
//! A paraxial ray is (y, n u): its height, and its slope times the index of refraction. Over a distance t, y
//! grows by t (n u) / n; at a surface of curvature c, n u falls by y (n' - n) c. Both are matrices of
//! determinant 1, and so is their product (E. Hecht, *Optics*, section 6.2.1). Where light travels towards
//! -z, n and t are negative, and nothing else changes (W. T. Welford, *Aberrations of Optical Systems*, 1986,
//! section 4.2).
//!
//! With the matrix (A, B; C, D) from the first to the last surface, n in front and n' behind:
//!
//! | what | formula |
//! | --- | --- |
//! | power, focal length | K = -C, f = 1 / K |
//! | back focal distance, from the last vertex | n' A / K |
//! | front focal distance, from the first vertex | -n D / K |
//! | back principal plane, from the last vertex | n' (A - 1) / K |
//! | front principal plane, from the first vertex | n (1 - D) / K |
//! | entrance pupil, from the first vertex, with (A, B) up to the stop | n B / A |
//! | exit pupil, from the last vertex, with (B, D) behind the stop | -n' B / D |
//! | Petzval sum | sum of c (1/n' - 1/n), the curvature of the Petzval surface over n' of the image |
//!
//! (Born & Wolf, *Principles of Optics*, 7th edition, section 4.4; Welford, chapters 3, 8 and 10.)

mod matrix;
mod seidel;

pub use matrix::Matrix;
pub use seidel::Seidel;

use crate::prescription::{Prescription, PrescriptionError, Resolved, SystemAperture};

/// A meridian: a plane that contains the axis, for systems that differ along x and y.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Meridian {
    /// The plane of x and z.
    X,
    /// The plane of y and z.
    #[default]
    Y,
}

/// A pupil: the image of the stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pupil {
    /// Its position along z in the coordinates of the prescription, 0 at the vertex of surface 1; infinite if
    /// telecentric.
    pub position: f64,
    /// Its diameter; infinite if telecentric.
    pub diameter: f64,
}

/// First-order data at one wavelength. Lengths that do not exist are infinite or NaN, for example the focal
/// length of an afocal system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrder {
    /// The ray transfer matrix from the first to the last surface.
    pub matrix: Matrix,
    /// 1 / power; positive if collimated light is made to converge.
    pub focal_length: f64,
    /// From the vertex of the last surface to the back focal point, along z.
    pub back_focal_distance: f64,
    /// From the vertex of the first surface to the front focal point, along z.
    pub front_focal_distance: f64,
    /// From the vertex of the last surface to the back principal plane, along z.
    pub back_principal_plane: f64,
    /// From the vertex of the first surface to the front principal plane, along z.
    pub front_principal_plane: f64,
    /// The entrance pupil: the stop seen from the object.
    pub entrance_pupil: Pupil,
    /// The exit pupil: the stop seen from the image.
    pub exit_pupil: Pupil,
    /// The semi-diameter of the stop itself.
    pub stop_semi_diameter: f64,
    /// Focal length over entrance pupil diameter.
    pub f_number: f64,
    /// The lateral magnification between the object and its paraxial image; 0 for distant objects.
    pub magnification: f64,
    /// The angular magnification between the pupils: the slope of the chief ray behind the last surface over that in
    /// front of the first, which is n d / (n' d') with the diameters d of the entrance and d' of the exit pupil
    /// (Born & Wolf, section 4.4.3). In an afocal system it is that of any collimated light.
    pub angular_magnification: f64,
    /// From the vertex of the last surface to the paraxial image, along z.
    pub image_distance: f64,
    /// The Petzval sum; the field is flat at 0.
    pub petzval_sum: f64,
}

impl Prescription {
    /// First-order data at a wavelength in nanometres.
    ///
    /// # Errors
    /// [`PrescriptionError`] for invalid prescriptions and wavelengths at which a medium has no index.
    pub fn first_order(&self, wavelength_nm: f64) -> Result<FirstOrder, PrescriptionError> {
        self.first_order_along(Meridian::Y, wavelength_nm)
    }

    /// First-order data in one meridian; [`Prescription::first_order`] returns those along y. They depend
    /// on the curvatures at the vertices; a term in x y, which rotates the meridians, and linear terms in x
    /// or y, which tilt the surface, are ignored.
    ///
    /// # Errors
    /// As for [`Prescription::first_order`].
    pub fn first_order_along(
        &self,
        meridian: Meridian,
        wavelength_nm: f64,
    ) -> Result<FirstOrder, PrescriptionError> {
        self.paraxial(&self.resolved()?, meridian, wavelength_nm)
    }

    pub(crate) fn first_order_resolved(
        &self,
        resolved: &Resolved,
        wavelength_nm: f64,
    ) -> Result<FirstOrder, PrescriptionError> {
        self.paraxial(resolved, Meridian::Y, wavelength_nm)
    }

    fn paraxial(
        &self,
        resolved: &Resolved,
        meridian: Meridian,
        wavelength_nm: f64,
    ) -> Result<FirstOrder, PrescriptionError> {
        let n = resolved.indices(wavelength_nm)?;
        let last = self.surfaces.len();
        let curvatures = resolved.curvatures(meridian);
        let matrix = |from: usize, to: usize| self.matrix(&curvatures, &n, from, to);
        let (front, back) = (matrix(0, self.stop - 1), matrix(self.stop - 1, last));
        let matrix = front.then(back);
        // without power f is inf, not -inf
        let (a, d, power) = (matrix.a, matrix.d, 0.0 - matrix.c);
        let (n_object, n_image) = (n[0], n[last]);
        // the ratio of index times slope of a ray through the centre of the stop; without power that of any ray
        let chief = if power == 0.0 { d } else { back.d / front.a };
        let last_vertex = resolved.vertices[last - 1];
        let entrance = n_object * front.b / front.a;
        let semi_diameter = self.entrance_semi_diameter(entrance, front.a, 1.0 / power, n_object);
        let stop_semi_diameter = (front.a * semi_diameter).abs();
        let image = self.image_of_object(matrix, n_object, n_image);
        Ok(FirstOrder {
            matrix,
            focal_length: 1.0 / power,
            back_focal_distance: n_image * a / power,
            front_focal_distance: -n_object * d / power,
            back_principal_plane: n_image * (a - 1.0) / power,
            front_principal_plane: n_object * (1.0 - d) / power,
            entrance_pupil: Pupil { position: entrance, diameter: 2.0 * semi_diameter },
            exit_pupil: Pupil {
                position: last_vertex - n_image * back.b / back.d,
                diameter: 2.0 * (stop_semi_diameter / back.d).abs(),
            },
            stop_semi_diameter,
            f_number: (0.5 / (power * semi_diameter)).abs(),
            magnification: image.1,
            angular_magnification: chief * n_object / n_image,
            image_distance: image.0,
            petzval_sum: petzval_sum(&curvatures, &n),
        })
    }

    /// The matrix from in front of surface `from`, counted from 0, to in front of `to`; no propagation behind
    /// the last one.
    fn matrix(&self, curvatures: &[f64], n: &[f64], from: usize, to: usize) -> Matrix {
        (from..to).fold(Matrix::IDENTITY, |matrix, k| {
            let surface = &self.surfaces[k];
            let refracted = matrix.then(Matrix::surface(curvatures[k], n[k], n[k + 1]));
            let is_last = k + 1 == self.surfaces.len();
            if is_last { refracted } else { refracted.then(Matrix::distance(surface.thickness, n[k + 1])) }
        })
    }

    fn entrance_semi_diameter(&self, pupil: f64, to_stop: f64, focal_length: f64, n_object: f64) -> f64 {
        match self.aperture {
            SystemAperture::EntrancePupilDiameter(diameter) => 0.5 * diameter,
            SystemAperture::FNumber(number) => (0.5 * focal_length / number).abs(),
            SystemAperture::StopSemiDiameter(height) => (height / to_stop).abs(),
            SystemAperture::ObjectNumericalAperture(aperture) => {
                let sine = aperture / n_object;
                (pupil + self.object_distance) * sine / (1.0 - sine * sine).sqrt()
            }
        }
    }

    /// The distance of the paraxial image from the last vertex, and its magnification.
    fn image_of_object(&self, matrix: Matrix, n_object: f64, n_image: f64) -> (f64, f64) {
        let from_object = match self.object_distance.is_finite() {
            false => return (n_image * matrix.a / -matrix.c, 0.0),
            true => Matrix::distance(self.object_distance, n_object).then(matrix),
        };
        // at the image, height does not depend on slope
        let distance = -n_image * from_object.b / from_object.d;
        (distance, from_object.then(Matrix::distance(distance, n_image)).a)
    }
}

fn petzval_sum(curvatures: &[f64], n: &[f64]) -> f64 {
    curvatures.iter().zip(n.windows(2)).map(|(c, n)| c * (1.0 / n[1] - 1.0 / n[0])).sum()
}

impl Resolved {
    /// The curvatures of all surfaces at their vertices, without the image.
    pub(crate) fn curvatures(&self, meridian: Meridian) -> Vec<f64> {
        let surfaces = self.forms.iter().take(self.forms.len() - 1);
        surfaces.map(|form| form.curvatures()[meridian as usize]).collect()
    }
}
