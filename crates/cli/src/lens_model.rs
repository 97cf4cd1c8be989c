//! Lens files as model files: the solids of a prescription, with its stop, its image and the light of its fields as `[optics]` tables.

use crate::lens_input;
use rayweave::lens::prescription::{IMAGE, Prescription, PrescriptionLayout};
use rayweave::math::Affine;
use rayweave::optics::component::{Asphere, Sheet, SurfaceForm};
use rayweave::optics::{Body, Finish, Material, Medium};
use rayweave::scene::{self, Colour, Scene, SceneRegion, Unit};
use rayweave::{Error, Vec3};
use std::fmt::Write;

/// The number of rays of each field.
const RAYS: u32 = 1000;

/// The solids of a lens, the `[optics]` tables of its stop, image and light, and what they do not hold, in sentences.
pub struct LensModel {
    pub scene: Scene,
    pub optics: String,
    pub losses: Vec<String>,
}

impl LensModel {
    /// The model of a lens.
    pub fn of(lens: &Prescription) -> Result<LensModel, Error> {
        let layout = lens.assembly()?;
        let mut losses = Vec::new();
        let (mut media, mut regions) =
            (vec![scene::Medium { name: "world".to_owned(), ..scene::Medium::default() }], Vec::new());
        let (mut materials, mut faces, mut sheets) = (String::new(), String::new(), String::new());
        for element in layout.assembly.elements() {
            match element.body() {
                Body::Solid { solid, material, faces: own, .. } => {
                    let (medium, text) = entry(material, lens, &mut losses);
                    let known = media.iter().position(|known| known.name == medium);
                    let number = known.unwrap_or_else(|| {
                        media.push(scene::Medium { name: medium.clone(), ..scene::Medium::default() });
                        line(&mut materials, format_args!("{medium:?} = {text}"));
                        media.len() - 1
                    });
                    let name = element.name();
                    for (face, _) in own.iter().filter(|(_, finish)| matches!(finish, Finish::Absorber)) {
                        // names of faces begin with that of the region
                        let face = face.strip_prefix(&format!("{name}.")).unwrap_or(face);
                        line(&mut faces, format_args!("{:?} = \"absorber\"", format!("{name}.{face}")));
                    }
                    let colour = Colour::numbered(regions.len());
                    let solid = solid.named(name);
                    regions.push(SceneRegion { name: name.to_owned(), solid, medium: number as u32, colour });
                }
                Body::Sheet { sheet, .. } => {
                    sheets += &sheet_text(element.name(), sheet, (lens, &layout), &mut losses)
                }
            }
        }
        let unit = Unit::of_metres(1e-9 * lens.unit_nm).unwrap_or_default();
        let scene = Scene::from_regions(unit, regions, media);
        let sources = sources(lens)?;
        let optics =
            format!("\n[optics]\n\n[optics.medium]\n{materials}\n[optics.face]\n{faces}{sheets}{sources}");
        Ok(LensModel { scene, optics, losses })
    }
}

/// The name of the medium of a material, and its entry in `[optics.medium]`.
fn entry(material: &Material, lens: &Prescription, losses: &mut Vec<String>) -> (String, String) {
    let Material::Transparent(medium) = material else {
        return ("mirror".to_owned(), "\"mirror\"".to_owned());
    };
    let name = medium.name().to_owned();
    let nm = lens.primary_nm();
    let is_same = |other: &Medium| {
        lens.lines.iter().all(|line| other.index(line.wavelength_nm) == medium.index(line.wavelength_nm))
    };
    if Medium::glass(&name).is_ok_and(|glass| is_same(&glass)) {
        return (name.clone(), format!("{name:?}"));
    }
    let index = medium.index(nm);
    if medium.as_constant().is_none() {
        losses.push(format!(
            "the dispersion of {name} is lost: it is no glass of the catalogue, and has its index at {nm} nm at all wavelengths."
        ));
    }
    (name, format!("{{ n = {:?}, k = {:?} }}", index.re, index.im))
}

/// Adds a line; writing to a string cannot fail.
fn line(text: &mut String, line: std::fmt::Arguments<'_>) {
    let _ = writeln!(text, "{line}");
}

/// The transform of a frame.
fn matrix(frame: &Affine) -> String {
    let columns = [frame.linear.x_axis, frame.linear.y_axis, frame.linear.z_axis, frame.translation];
    let row = |k: usize| {
        format!("[{:?}, {:?}, {:?}, {:?}]", columns[0][k], columns[1][k], columns[2][k], columns[3][k])
    };
    format!("[{{ matrix = [{}, {}, {}, [0, 0, 0, 1]] }}]", row(0), row(1), row(2))
}

fn sheet_text(
    name: &str,
    sheet: &Sheet,
    (lens, layout): (&Prescription, &PrescriptionLayout),
    losses: &mut Vec<String>,
) -> String {
    let mut text = format!("\n[[optics.sheet]]\nname = {name:?}\n");
    if let Some(stop) = layout.stop.iter().find(|stop| stop.name == name) {
        let Asphere { radius, conic, .. } = stop.form.asphere;
        if stop.form != SurfaceForm::from(Asphere::conic(radius, conic)) {
            losses.push(format!(
                "the {name} is left out: it lies on surface {}, and files have sheets on planes and conics only.",
                lens.stop
            ));
            return String::new();
        }
        let [circle, opening] = [2.0 * stop.outline, 2.0 * stop.opening];
        line(
            &mut text,
            format_args!("circle = {circle:?}\nopening = {{ circle = {opening:?} }}\naction = \"absorb\""),
        );
        if radius.is_finite() {
            line(&mut text, format_args!("radius = {radius:?}\nconic = {conic:?}"));
        }
    }
    if name == IMAGE {
        let radius = layout.semi_diameters.last().copied().unwrap_or_default();
        line(&mut text, format_args!("circle = {:?}\naction = \"record\"", 2.0 * radius));
        if lens.image.radius.is_finite() {
            line(&mut text, format_args!("radius = {:?}\nconic = {:?}", lens.image.radius, lens.image.conic));
        }
    }
    line(&mut text, format_args!("transform = {}", matrix(&sheet.frame)));
    text
}

/// A source for each field: a beam as wide as the entrance pupil, or a point.
fn sources(lens: &Prescription) -> Result<String, Error> {
    let lines: Vec<String> =
        lens.lines.iter().map(|line| format!("[{:?}, {:?}]", line.wavelength_nm, line.weight)).collect();
    let lines = lines.join(", ");
    let mut text = String::new();
    for field in 0..lens.fields.len() {
        // the centre of the pupil and four points of its rim
        let rim = [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
        let beam = lens.beam(field, lens.primary_nm(), &rim)?;
        let rays = [0, 1, 2, 3, 4].map(|k| beam.get(k).ray);
        let chief = rays[0];
        let along = chief.direction.normalize_or_zero();
        let pattern = match lens.object_distance.is_finite() {
            // rays of a distant field are parallel and begin on one wavefront
            false => {
                // the pupil, a circle across the axis, is narrower in the plane of the axis and the field
                let targets = [1, 2]
                    .map(|k| rays[k].origin - rays[k].direction * (rays[k].origin.z / rays[k].direction.z));
                let wide = (targets[0] - targets[1]).length();
                let high = wide * along.z.abs();
                format!("beam = {{ ellipse = [{wide:?}, {high:?}], rays = {RAYS} }}")
            }
            true => {
                let angle = |ray: &rayweave::Ray| {
                    let other = ray.direction.normalize_or_zero();
                    angle_between(along, other)
                };
                let widest = rays[1..].iter().map(angle).fold(0.0, f64::max);
                format!("point = {{ angle = {widest:?}, rays = {RAYS} }}")
            }
        };
        let (origin, tilt, turn) =
            (chief.origin, libm::acos(along.z).to_degrees(), libm::atan2(-along.x, along.y).to_degrees());
        line(
            &mut text,
            format_args!(
                "\n# field {field}: {}\n[[optics.source]]\n{pattern}\nwavelength_nm = [{lines}]\n\
                 transform = [{{ rotate_x = {:?} }}, {{ rotate_z = {:?} }}, {{ translate = [{:?}, {:?}, {:?}] }}]",
                lens_input::field_texts(lens)[field],
                0.0 - tilt,
                if tilt == 0.0 { 0.0 } else { turn },
                origin.x,
                origin.y,
                origin.z
            ),
        );
    }
    Ok(text)
}

/// The angle between unit vectors in degrees.
fn angle_between(a: Vec3, b: Vec3) -> f64 {
    libm::atan2(a.cross(b).length(), a.dot(b)).to_degrees()
}
