//! What an optical system is made of: solids of a material with faces of some finish, and sheets.

use crate::component::{ComponentError, Sheet};
use crate::interface::Film;
use crate::medium::Medium;
use num_complex::Complex64;
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;

/// What a solid is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Light goes through.
    Transparent(Medium),
    /// Light ends at the surface, but for what the finish sends back.
    Opaque,
    /// A metal: light is reflected by Fresnel's formulas for the complex index, the rest is absorbed at the surface.
    Metal(Medium),
}

/// What a face does to light, whatever the media on its two sides.
#[derive(Clone, Debug, PartialEq)]
pub enum Finish {
    /// Polished: what the two media make of it.
    Polished,
    /// Reflects a fraction of the power and absorbs the rest.
    Mirror {
        /// The fraction, from 0 to 1.
        reflectance: f64,
    },
    /// Absorbs all light.
    Absorber,
    /// Thin films between the two media, the outermost, farthest from the solid, first.
    Coated(Vec<Film>),
    /// Reflects a fraction of the power and transmits the rest, without a change of polarisation.
    Splitter {
        /// The fraction, from 0 to 1.
        reflectance: f64,
    },
    /// Scatters a fraction of the power back by Lambert's cosine law, unpolarised, and absorbs the rest.
    Diffuse {
        /// The fraction, from 0 to 1.
        reflectance: f64,
    },
    /// A rough face: polished facets whose slopes have a Gaussian distribution (Beckmann & Spizzichino, *The Scattering of
    /// Electromagnetic Waves from Rough Surfaces*, 1963; Cook & Torrance, ACM Trans. Graph. 1, 7, 1982).
    Rough {
        /// The standard deviation of the slope along each axis.
        slope: f64,
    },
}

/// What a sheet does to light that crosses it.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Ends it: a stop, a baffle, a screen.
    Absorb,
    /// Records it and lets it pass: a detector without substance.
    Record,
    /// Reflects a fraction of the power and absorbs the rest.
    Mirror {
        /// The fraction, from 0 to 1.
        reflectance: f64,
    },
    /// Reflects a fraction of the power and transmits the rest.
    Splitter {
        /// The fraction, from 0 to 1.
        reflectance: f64,
    },
    /// An ideal thin lens: light through the point at the distance y from its centre is bent by y / f in slope.
    ThinLens {
        /// The focal length; negative for a diverging lens.
        focal_length: f64,
    },
    /// A plane grating that sends all light into one order.
    Grating {
        /// Across the grooves, in the plane of the sheet, in its frame; as long as the number of lines per unit of length.
        lines: Vec3,
        /// The order.
        order: i32,
        /// True if it reflects.
        reflects: bool,
    },
    /// Lets the light pass that swings along an axis, absorbs what swings across it.
    Polariser {
        /// The axis of transmission, in the frame of the sheet.
        axis: Vec3,
    },
    /// A wave plate: light across the fast axis falls behind that along it.
    Retarder {
        /// The fast axis, in the frame of the sheet.
        axis: Vec3,
        /// By which part of a wave, in degrees: 90 for a quarter wave.
        retardance_degrees: f64,
    },
}

impl Action {
    /// True if what it does depends on the side from which the light comes.
    pub(crate) fn has_sides(&self) -> bool {
        match self {
            Action::Mirror { .. } | Action::Splitter { .. } | Action::Grating { .. } => true,
            Action::Absorb | Action::Record | Action::ThinLens { .. } => false,
            Action::Polariser { .. } | Action::Retarder { .. } => false,
        }
    }

    /// The amplitudes along the axis and across it of a polarising sheet, and the axis.
    pub(crate) fn polarises(&self) -> Option<(Vec3, [Complex64; 2])> {
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

/// A named part of an optical system.
#[derive(Clone, Debug)]
pub struct Element {
    pub(crate) name: String,
    pub(crate) body: Body,
}

/// What a part is.
#[derive(Clone, Debug)]
pub enum Body {
    /// A solid.
    Solid {
        /// Its shape.
        solid: Solid,
        /// What it is made of.
        material: Material,
        /// The finish of all faces that have none of their own.
        finish: Finish,
        /// The finishes of single faces by their names, the last one of a name counts.
        faces: Vec<(String, Finish)>,
    },
    /// A sheet.
    Sheet {
        /// Its shape.
        sheet: Sheet,
        /// What it does.
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

    /// The same with another finish on all faces that have none of their own; sheets have no finish and stay.
    pub fn finish(mut self, new: Finish) -> Element {
        if let Body::Solid { finish, .. } = &mut self.body {
            *finish = new;
        }
        self
    }

    /// The same with a finish of its own on all faces whose name, or a part of it between dots, is `face`; sheets stay.
    pub fn face(mut self, face: &str, finish: Finish) -> Element {
        if let Body::Solid { faces, .. } = &mut self.body {
            faces.push((face.to_owned(), finish));
        }
        self
    }

    /// The same moved by a map.
    ///
    /// # Errors
    /// A map that is singular or not finite.
    pub fn apply(mut self, world_from_local: &Affine) -> Result<Element, ComponentError> {
        match &mut self.body {
            Body::Solid { solid, .. } => *solid = solid.apply(*world_from_local),
            Body::Sheet { sheet, .. } => *sheet = sheet.apply(world_from_local)?,
        }
        Ok(self)
    }

    /// The same under another name.
    pub fn named(mut self, name: &str) -> Element {
        self.name = name.to_owned();
        self
    }

    /// Its solid and what that is made of; `None` for sheets.
    pub fn solid(&self) -> Option<(&Solid, &Material)> {
        match &self.body {
            Body::Solid { solid, material, .. } => Some((solid, material)),
            Body::Sheet { .. } => None,
        }
    }

    /// The sheet that it is; `None` for solids.
    pub fn as_sheet(&self) -> Option<&Sheet> {
        match &self.body {
            Body::Sheet { sheet, .. } => Some(sheet),
            Body::Solid { .. } => None,
        }
    }

    /// Whether it is a sheet that does not treat all polarisations alike.
    pub fn polarises(&self) -> bool {
        matches!(&self.body, Body::Sheet { action, .. } if action.polarises().is_some())
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it is.
    pub fn body(&self) -> &Body {
        &self.body
    }
}
