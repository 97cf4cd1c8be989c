//! Sides of lenses and mirrors: surfaces of revolution, toric surfaces and sag surfaces.

use super::aperture::solid;
use super::face::{Face, Profile};
use super::form::{Figure, SurfaceForm};
use super::side::{Side, points};
use super::toric::Toric;
use super::{Aperture, ComponentError};
use rayweave_math::Vec3;
use rayweave_model::Solid;

/// A surface of any form at its position, over an aperture.
pub(super) fn form_side(
    part: &'static str,
    name: &'static str,
    (form, vertex): (&SurfaceForm, f64),
    aperture: &Aperture,
    centre: [f64; 2],
) -> Result<Box<dyn Side>, ComponentError> {
    let form = form.clone().checked(part, name)?;
    let [width, height] = aperture.checked()?.size();
    let half = [centre[0].abs() + 0.5 * width, centre[1].abs() + 0.5 * height];
    if let Some(radii) = circles(&form) {
        return Ok(Box::new(Toric::new(part, name, radii, vertex, half)?));
    }
    let reach = aperture.reach(centre);
    if form.is_round() {
        let face = Face { name, vertex, profile: Profile::asphere(&form.asphere) };
        let limit = face.profile.limit();
        return match reach > limit {
            true => Err(ComponentError::ApertureTooLarge { part, surface: name, reach, limit }),
            false => Ok(Box::new(Round { face: face.over(reach), reach })),
        };
    }
    Ok(Box::new(Above::new(part, name, (form, vertex), reach, (half, centre))?))
}

/// The radii along x and y of a toroid whose curve is a circle or a straight line, rotated about an
/// axis that is not nearer than the centre of the circle.
fn circles(form: &SurfaceForm) -> Option<[f64; 2]> {
    let Figure::Toroidal { turn } = form.figure else { return None };
    let along_y = form.asphere.radius;
    let is_circle = form.asphere.conic == 0.0 && form.asphere.even == [0.0; 8];
    let is_turned_farther = along_y.abs() < turn.abs() || along_y == turn || along_y.is_infinite();
    (is_circle && is_turned_farther).then_some([turn, along_y])
}

/// A surface of revolution.
struct Round {
    face: Face,
    reach: f64,
}

impl Side for Round {
    fn name(&self) -> &'static str {
        self.face.name
    }

    fn z(&self, [x, y]: [f64; 2]) -> f64 {
        self.face.z(libm::hypot(x, y)).unwrap_or(self.face.vertex)
    }

    fn range(&self) -> [f64; 2] {
        self.face.range(self.reach)
    }

    fn beyond(&self, until: f64) -> Result<Solid, ComponentError> {
        self.face.beyond(until)
    }

    fn before(&self, from: f64) -> Result<Solid, ComponentError> {
        self.face.before(from)
    }

    fn floor(&self, wanted: f64) -> f64 {
        let low = self.range()[0];
        self.face.floor(low, low - wanted)
    }

    fn ceiling(&self, wanted: f64) -> f64 {
        let high = self.range()[1];
        self.face.ceiling(high, wanted - high)
    }
}

/// A sag surface, with one height above each point.
struct Above {
    name: &'static str,
    vertex: f64,
    form: SurfaceForm,
    range: [f64; 2],
    solid: Solid,
}

impl Above {
    fn new(
        part: &'static str,
        name: &'static str,
        (form, vertex): (SurfaceForm, f64),
        reach: f64,
        (half, centre): ([f64; 2], [f64; 2]),
    ) -> Result<Above, ComponentError> {
        if let Some(limit) = form.end_within(reach) {
            return Err(ComponentError::ApertureTooLarge { part, surface: name, reach, limit });
        }
        let places = points().map(|[u, v]| [half[0] * u, half[1] * v]);
        let heights = places
            .filter(|[x, y]| libm::hypot(x - centre[0], y - centre[1]) <= reach)
            .filter_map(|place| form.sag(place));
        let range = heights.fold([0.0f64; 2], |[low, high], z| [low.min(z), high.max(z)]);
        let range = range.map(|z| vertex + z);
        // the end of the sag surface has to be outside the aperture, and may be the end of the base
        let whole = form.above(part, 1.001 * reach).or_else(|_| form.above(part, reach))?;
        let solid = solid(whole).translate(Vec3::Z * vertex).named(name);
        Ok(Above { name, vertex, form, range, solid })
    }
}

impl Side for Above {
    fn name(&self) -> &'static str {
        self.name
    }

    fn z(&self, point: [f64; 2]) -> f64 {
        self.vertex + self.form.sag(point).unwrap_or(0.0)
    }

    fn range(&self) -> [f64; 2] {
        self.range
    }

    fn beyond(&self, _until: f64) -> Result<Solid, ComponentError> {
        Ok(self.solid.clone())
    }

    fn before(&self, _from: f64) -> Result<Solid, ComponentError> {
        Ok(!self.solid.clone())
    }

    fn floor(&self, wanted: f64) -> f64 {
        wanted
    }

    fn ceiling(&self, wanted: f64) -> f64 {
        wanted
    }
}
