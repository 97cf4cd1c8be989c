//! Resolved prescriptions: numbers checked, media looked up, vertices placed.

use super::error::{bad, positive};
use super::pose::Pose;
use super::{Behind, FieldKind, Prescription, PrescriptionError, Surface, SystemAperture};
use rayweave_math::Vec3;
use rayweave_optics::Medium;
use rayweave_optics::component::SurfaceForm;

/// Vertices, forms and media along the axis.
#[derive(Clone, Debug)]
pub(crate) struct Resolved {
    /// The z of each vertex; the last is the image.
    pub vertices: Vec<f64>,
    /// The form of each surface; the last is the image.
    pub forms: Vec<SurfaceForm>,
    /// The medium in front of each surface; the last is in front of the image.
    pub media: Vec<Medium>,
    /// True where light travels towards +z in front of the surface.
    pub forward: Vec<bool>,
    /// The poses of the surfaces; empty if all are on the axis.
    pub poses: Vec<Pose>,
}

impl Prescription {
    /// Checks all numbers and looks up all media.
    pub(crate) fn resolved(&self) -> Result<Resolved, PrescriptionError> {
        self.check()?;
        let mut resolved = Resolved {
            vertices: vec![0.0],
            forms: self.surfaces.iter().map(Surface::form).chain([self.image_as_surface().form()]).collect(),
            media: vec![Medium::vacuum()],
            forward: vec![true],
            poses: Vec::new(),
        };
        let (mut z, mut medium, mut forward) = (0.0, Medium::vacuum(), true);
        for (k, surface) in self.surfaces.iter().enumerate() {
            z += surface.thickness;
            let found = surface.behind.medium();
            match found.map_err(|problem| PrescriptionError::Glass { surface: k + 1, problem })? {
                Some(behind) => medium = behind,
                None => forward = !forward,
            }
            resolved.vertices.push(z);
            resolved.media.push(medium.clone());
            resolved.forward.push(forward);
        }
        resolved.poses = self.poses(&resolved.vertices);
        Ok(resolved)
    }

    /// The image as a surface, with air behind it.
    pub(super) fn image_as_surface(&self) -> Surface {
        Surface {
            conic: self.image.conic,
            semi_diameter: self.image.semi_diameter,
            ..Surface::new(self.image.radius, 0.0, Behind::Air)
        }
    }

    fn check(&self) -> Result<(), PrescriptionError> {
        let lists = [
            ("surface", self.surfaces.is_empty()),
            ("field", self.fields.is_empty()),
            ("wavelength", self.lines.is_empty()),
        ];
        if let Some((what, _)) = lists.iter().find(|(_, is_empty)| *is_empty) {
            return Err(PrescriptionError::None(what));
        }
        let count = self.surfaces.len();
        if !(1..=count).contains(&self.stop) {
            return Err(PrescriptionError::NoSuch { what: "stop", number: self.stop, first: 1, last: count });
        }
        if self.primary >= self.lines.len() {
            let (what, number, last) = ("primary wavelength", self.primary, self.lines.len() - 1);
            return Err(PrescriptionError::NoSuch { what, number, first: 0, last });
        }
        let is_near = self.object_distance.is_finite();
        if !(is_near || self.object_distance == f64::INFINITY) {
            return Err(bad("the distance of the object", self.object_distance, "a number or infinity"));
        }
        if self.field_kind == FieldKind::ObjectHeight && !is_near {
            let why = "the object is infinitely far; give angles";
            return Err(PrescriptionError::Undefined { what: "height of the object", why });
        }
        positive("the unit in nm", self.unit_nm)?;
        let (SystemAperture::EntrancePupilDiameter(size)
        | SystemAperture::FNumber(size)
        | SystemAperture::ObjectNumericalAperture(size)
        | SystemAperture::StopSemiDiameter(size)) = self.aperture;
        positive("the aperture", size)?;
        if matches!(self.aperture, SystemAperture::ObjectNumericalAperture(_)) && !is_near {
            let why = "the object is infinitely far; give the entrance pupil";
            return Err(PrescriptionError::Undefined { what: "numerical aperture at the object", why });
        }
        for line in &self.lines {
            positive("a wavelength", line.wavelength_nm)?;
            if !(line.weight >= 0.0 && line.weight.is_finite()) {
                return Err(bad("the weight of a wavelength", line.weight, "at least 0 and finite"));
            }
        }
        if let Some(place) = self.fields.iter().flatten().find(|place| !place.is_finite()) {
            return Err(bad("a field", *place, "finite"));
        }
        let is_angle = self.field_kind == FieldKind::Angle;
        if let Some(angle) = self.fields.iter().flatten().find(|angle| is_angle && angle.abs() >= 90.0) {
            return Err(bad("the angle of a field", *angle, "between -90 and 90 degrees"));
        }
        self.check_breaks()?;
        self.image_as_surface().check(count + 1)?;
        self.surfaces.iter().enumerate().try_for_each(|(k, surface)| surface.check(k + 1))
    }
}

impl Surface {
    fn check(&self, number: usize) -> Result<(), PrescriptionError> {
        let named = |what: &str| format!("{what} of surface {number}");
        if self.radius == 0.0 || self.radius.is_nan() {
            return Err(bad(named("the radius"), self.radius, "other than 0, infinite for a plane"));
        }
        let finite = [("the thickness", self.thickness), ("the conic constant", self.conic)];
        if let Some((what, value)) = finite.into_iter().find(|(_, value)| !value.is_finite()) {
            return Err(bad(named(what), value, "finite"));
        }
        if let Some(value) = self.even.into_iter().chain(self.odd).find(|c| !c.is_finite()) {
            return Err(bad(named("a coefficient"), value, "finite"));
        }
        let form = self.form().checked("prescription", "the surface");
        form.map_err(|problem| PrescriptionError::Component { surface: number, problem })?;
        if let Some(semi_diameter) = self.semi_diameter {
            positive(named("the semi-diameter"), semi_diameter)?;
        }
        match self.hole >= 0.0 && self.hole.is_finite() {
            true => Ok(()),
            false => Err(bad(named("the hole"), self.hole, "at least 0 and finite")),
        }
    }
}

impl Resolved {
    /// Maps a point to coordinates in which a surface, counted from 0, is on the axis.
    pub fn local(&self, k: usize, point: Vec3) -> Vec3 {
        self.poses.get(k).map_or(point, |pose| pose.local(point, Vec3::ZERO).0)
    }

    /// True if two surfaces, counted from 0, have a common axis.
    pub fn are_aligned(&self, one: usize, other: usize) -> bool {
        let poses = self.poses.get(one).zip(self.poses.get(other));
        poses.is_none_or(|(one, other)| one.is_near(other))
    }

    /// The index in front of a surface at a wavelength; negative where light travels towards -z, the sign
    /// convention of paraxial formulas (Welford, *Aberrations of Optical Systems*, 1986, section 4.2).
    pub fn index(&self, space: usize, wavelength_nm: f64) -> f64 {
        let n = self.media[space].index(wavelength_nm).re;
        if self.forward[space] { n } else { -n }
    }

    /// The indices of all spaces; an error if the wavelength is outside the range of a medium.
    pub fn indices(&self, wavelength_nm: f64) -> Result<Vec<f64>, PrescriptionError> {
        let index = |space: usize| {
            let medium = &self.media[space];
            let range_nm = medium.range_nm();
            if !(range_nm[0]..=range_nm[1]).contains(&wavelength_nm) {
                let medium = medium.name().to_owned();
                return Err(PrescriptionError::Wavelength { medium, wavelength_nm, range_nm });
            }
            Ok(self.index(space, wavelength_nm))
        };
        (0..self.media.len()).map(index).collect()
    }
}
