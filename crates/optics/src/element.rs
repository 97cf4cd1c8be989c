//! Elements of an optical system: solids of a material with surface finishes, and sheets.

use crate::component::{ComponentError, Sheet};
use crate::interface::Film;
use crate::medium::Medium;
use num_complex::Complex64;
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;

/// The material of a solid.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Light is transmitted.
    Transparent(Medium),
    /// Light is absorbed at the surface, except for the part that the finish reflects.
    Opaque,
    /// A metal: reflects light according to the Fresnel equations for the complex refractive index;
    /// the rest is absorbed at the surface.
    Metal(Medium),
}

/// The finish of a face: its effect on light, with the media on both sides.
#[derive(Clone, Debug, PartialEq)]
pub enum Finish {
    /// Polished: reflection and refraction according to the Fresnel equations for the two media.
    Polished,
    /// Reflects a fraction of the power and absorbs the rest.
    Mirror {
        /// The fraction, from 0 to 1.
        reflectance: f64,
    },
    /// Absorbs all light.
    Absorber,
    /// A coating: thin films between the two media, the outermost, farthest from the solid, first.
    Coated(Vec<Film>),
    /// A beam splitter: reflects a fraction of the power and transmits the rest, without a change
    /// of polarisation.
    Splitter {
        /// The fraction, from 0 to 1.
        reflectance: f64,
    },
    /// A diffuse reflector: scatters a fraction of the power back according to Lambert's cosine
    /// law, unpolarised, and absorbs the rest.
    Diffuse {
        /// The fraction, from 0 to 1.
        reflectance: f64,
    },
    /// A rough face: polished microfacets whose slopes have a Gaussian distribution (Beckmann &
    /// Spizzichino, *The Scattering of Electromagnetic Waves from Rough Surfaces*, 1963; Cook &
    /// Torrance, ACM Trans. Graph. 1, 7, 1982).
    Rough {
        /// The standard deviation of the slope along each axis.
        slope: f64,
    },
}

/// The action of a sheet on light that crosses it.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Absorbs all light: a stop, a baffle, a screen.
    Absorb,
    /// Records the light and transmits it unchanged: a detector without thickness.
    Record,
    /// Reflects a fraction of the power and absorbs the rest.
    Mirror {
        /// The fraction, from 0 to 1.
        reflectance: f64,
    },
    /// A beam splitter: reflects a fraction of the power and transmits the rest.
    Splitter {
        /// The fraction, from 0 to 1.
        reflectance: f64,
    },
    /// An ideal thin lens: light that passes at height y above its centre changes slope by -y / f.
    ThinLens {
        /// The focal length; negative for a diverging lens.
        focal_length: f64,
    },
    /// A plane diffraction grating that sends all light into one order.
    Grating {
        /// The vector across the grooves, in the plane of the sheet, in its frame; its length is
        /// the number of lines per unit of length.
        lines: Vec3,
        /// The order.
        order: i32,
        /// True if it reflects.
        reflects: bool,
    },
    /// A linear polariser: transmits light polarised along an axis, absorbs light polarised perpendicular to it.
    Polariser {
        /// The axis of transmission, in the frame of the sheet.
        axis: Vec3,
    },
    /// A retarder (wave plate): light polarised perpendicular to the fast axis lags behind light polarised along it.
    Retarder {
        /// The fast axis, in the frame of the sheet.
        axis: Vec3,
        /// The retardance in degrees: 90 for a quarter wave.
        retardance_degrees: f64,
    },
}

impl Action {
    /// True if the action needs the normal that faces the light.
    pub(crate) fn needs_normal(&self) -> bool {
        match self {
            Action::Mirror { .. } | Action::Splitter { .. } | Action::Grating { .. } => true,
            Action::Absorb | Action::Record | Action::ThinLens { .. } => false,
            Action::Polariser { .. } | Action::Retarder { .. } => false,
        }
    }

    /// The axis of a polariser or retarder and its diagonal Jones matrix: the amplitudes along the
    /// axis and perpendicular to it.
    pub(crate) fn jones(&self) -> Option<(Vec3, [Complex64; 2])> {
        match self {
            Action::Polariser { axis } => Some((*axis, [Complex64::ONE, Complex64::ZERO])),
            Action::Retarder { axis, retardance_degrees } => {
                let phase = retardance_degrees.to_radians();
                let slow = Complex64::new(libm::cos(phase), libm::sin(phase));
                Some((*axis, [Complex64::ONE, slow]))
            }
            _ => None,
        }
    }
}

/// A named element of an optical system.
#[derive(Clone, Debug)]
pub struct Element {
    pub(crate) name: String,
    pub(crate) body: Body,
}

/// The body of an element.
#[derive(Clone, Debug)]
pub enum Body {
    /// A solid.
    Solid {
        /// Its shape.
        solid: Solid,
        /// Its material.
        material: Material,
        /// The finish of all faces without one of their own.
        finish: Finish,
        /// Finishes of individual faces, by name; if a name occurs twice, the last finish wins.
        faces: Vec<(String, Finish)>,
    },
    /// A sheet.
    Sheet {
        /// Its shape.
        sheet: Sheet,
        /// Its action.
        action: Action,
    },
}

impl Element {
    /// A solid of a material, all faces polished.
    pub fn new(name: &str, solid: Solid, material: Material) -> Element {
        let body = Body::Solid { solid, material, finish: Finish::Polished, faces: Vec::new() };
        Element { name: name.to_owned(), body }
    }

    /// A solid of a transparent medium.
    pub fn transparent(name: &str, solid: Solid, medium: &Medium) -> Element {
        Element::new(name, solid, Material::Transparent(medium.clone()))
    }

    /// A solid that reflects all light on all its faces.
    pub fn mirror(name: &str, solid: Solid) -> Element {
        Element::new(name, solid, Material::Opaque).finish(Finish::Mirror { reflectance: 1.0 })
    }

    /// A solid that absorbs all light.
    pub fn absorber(name: &str, solid: Solid) -> Element {
        Element::new(name, solid, Material::Opaque)
    }

    /// A sheet.
    pub fn sheet(name: &str, sheet: Sheet, action: Action) -> Element {
        Element { name: name.to_owned(), body: Body::Sheet { sheet, action } }
    }

    /// Sets the finish of all faces without one of their own; no effect on sheets, which have no finish.
    pub fn finish(mut self, new: Finish) -> Element {
        if let Body::Solid { finish, .. } = &mut self.body {
            *finish = new;
        }
        self
    }

    /// Sets the finish of all faces whose name, or a part of it between dots, is `face`; no effect on sheets.
    pub fn face(mut self, face: &str, finish: Finish) -> Element {
        if let Body::Solid { faces, .. } = &mut self.body {
            faces.push((face.to_owned(), finish));
        }
        self
    }

    /// The element moved by an affine map.
    ///
    /// # Errors
    /// [`ComponentError`] for a map that is singular or not finite.
    pub fn apply(mut self, world_from_local: &Affine) -> Result<Element, ComponentError> {
        match &mut self.body {
            Body::Solid { solid, .. } => *solid = solid.apply(*world_from_local),
            Body::Sheet { sheet, .. } => *sheet = sheet.apply(world_from_local)?,
        }
        Ok(self)
    }

    /// The element with a different name.
    pub fn named(mut self, name: &str) -> Element {
        self.name = name.to_owned();
        self
    }

    /// The solid and its material; `None` for sheets.
    pub fn solid(&self) -> Option<(&Solid, &Material)> {
        match &self.body {
            Body::Solid { solid, material, .. } => Some((solid, material)),
            Body::Sheet { .. } => None,
        }
    }

    /// The sheet; `None` for solids.
    pub fn as_sheet(&self) -> Option<&Sheet> {
        match &self.body {
            Body::Sheet { sheet, .. } => Some(sheet),
            Body::Solid { .. } => None,
        }
    }

    /// True for a sheet that changes the polarisation: a polariser or a retarder.
    pub fn polarises(&self) -> bool {
        matches!(&self.body, Body::Sheet { action, .. } if action.jones().is_some())
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The body: a solid or a sheet.
    pub fn body(&self) -> &Body {
        &self.body
    }
}
