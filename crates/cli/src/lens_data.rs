//! The surfaces and the first-order data of lens files.

use crate::terminal::{self, rounded, short};
use rayweave::Packets;
use rayweave::lens::analysis::Study;
use rayweave::lens::paraxial::{FirstOrder, Pupil};
use rayweave::lens::prescription::{Behind, Prescription, PrescriptionError, Surface};
use rayweave::optics::Tracer;
use rayweave::optics::component::Figure;
use serde_json::{Value, json};

/// The first-order data of a lens at its primary wavelength, and the distortion of its outermost field.
pub struct LensData {
    wavelength_nm: f64,
    unit: &'static str,
    first_order: FirstOrder,
    is_finite: bool,
    /// The distance from the last vertex to the image surface.
    image_surface: f64,
    /// The coordinates of the outermost field, as text, and the relative distortion there; none for a field on the axis.
    distortion: Option<(String, f64)>,
}

impl LensData {
    /// The data of a lens. `fields` are the coordinates of its fields as text.
    pub fn new(
        lens: &Prescription,
        fields: &[String],
        unit: &'static str,
    ) -> Result<LensData, PrescriptionError> {
        let nm = lens.primary_nm();
        let height = |field: usize| libm::hypot(lens.fields[field][0], lens.fields[field][1]);
        let outermost = (0..lens.fields.len()).max_by(|&a, &b| height(a).total_cmp(&height(b)));
        let outermost = outermost.filter(|&field| height(field) > 0.0);
        let distortion = outermost.and_then(|field| Some((fields[field].clone(), distortion(lens, field)?)));
        Ok(LensData {
            wavelength_nm: nm,
            unit,
            first_order: lens.first_order(nm)?,
            is_finite: lens.object_distance.is_finite(),
            image_surface: lens.surfaces.last().map_or(f64::NAN, |last| last.thickness),
            distortion,
        })
    }

    /// The radius of the first dark ring of a lens without aberrations, 1.22 times wavelength and F-number; none for a near object
    /// and for lenses without focus.
    pub fn airy_radius(&self, unit_nm: f64) -> Option<f64> {
        // the first zero of J1 over pi (Born & Wolf, Principles of Optics, section 8.5.2)
        let radius = 1.219_669_891_266_504_5 * self.wavelength_nm / unit_nm * self.first_order.f_number.abs();
        Some(radius).filter(|radius| !self.is_finite && radius.is_finite())
    }

    /// The data as a table.
    pub fn text(&self) -> String {
        let FirstOrder { focal_length, back_focal_distance, f_number, magnification, image_distance, .. } =
            self.first_order;
        let six = |value: f64| if value.is_finite() { short(rounded(value, 6)) } else { "-".to_owned() };
        let length = |value: f64| format!("{} {}", six(value), self.unit);
        let mut rows = vec![
            ["focal length".to_owned(), length(focal_length)],
            ["back focal distance".to_owned(), length(back_focal_distance)],
            ["paraxial image distance".to_owned(), length(image_distance)],
            ["actual image distance".to_owned(), length(self.image_surface)],
            ["defocus".to_owned(), length(self.defocus())],
            ["F-number".to_owned(), six(f_number)],
        ];
        if self.is_finite {
            rows.push(["magnification".to_owned(), six(magnification)]);
        }
        if let Some((field, distortion)) = &self.distortion {
            let percent = format!("{} %", short(rounded(100.0 * distortion, 3)));
            rows.push([format!("distortion at {field}"), percent]);
        }
        let rows: Vec<Vec<String>> = rows.into_iter().map(Vec::from).collect();
        let head = format!("first-order data at {} nm", short(self.wavelength_nm));
        terminal::table(&[&head, "value"], &rows, &[false, false])
    }

    /// The distance from the image surface to the paraxial image.
    fn defocus(&self) -> f64 {
        let far = self.image_surface.abs();
        let defocus = self.first_order.image_distance - self.image_surface;
        // the difference of equal distances is a rounding error
        if defocus.abs() <= 1e-12 * far { 0.0 } else { defocus }
    }

    /// The data as JSON; numbers that do not exist are null.
    pub fn json(&self) -> Value {
        let found = &self.first_order;
        let pupil = |pupil: &Pupil| json!({ "position": pupil.position, "diameter": pupil.diameter });
        json!({
            "wavelength_nm": self.wavelength_nm,
            "focal_length": found.focal_length,
            "back_focal_distance": found.back_focal_distance,
            "front_focal_distance": found.front_focal_distance,
            "f_number": found.f_number,
            "magnification": found.magnification,
            "image_distance": found.image_distance,
            "image_surface_distance": self.image_surface,
            "defocus": self.defocus(),
            "entrance_pupil": pupil(&found.entrance_pupil),
            "exit_pupil": pupil(&found.exit_pupil),
            "distortion": self.distortion.as_ref().map(|(_, distortion)| distortion),
        })
    }
}

/// The relative distortion of a field at the primary wavelength; `None` if its chief ray does not arrive.
fn distortion(lens: &Prescription, field: usize) -> Option<f64> {
    let layout = lens.assembly().ok()?;
    let system = layout.assembly.compile().ok()?;
    let tracer = Tracer::new(&system, Packets::new);
    let study = Study::new(lens, &layout, &tracer);
    let relative = study.distortion(field, lens.primary_nm()).ok()?.relative();
    relative.is_finite().then_some(relative)
}

/// The surfaces of a lens as a table. `semi_diameters` are the clear ones; there are none for a lens without solids.
pub fn prescription_text(lens: &Prescription, semi_diameters: &[f64], unit: &str) -> String {
    let number = |value: f64| if value.is_finite() { short(rounded(value, 8)) } else { "inf".to_owned() };
    let size = |place: usize| semi_diameters.get(place).map_or("-".to_owned(), |&r| short(rounded(r, 5)));
    let row = |name: String, surface: &Surface, size: String, remarks: String| {
        let behind = if name == "image" { String::new() } else { behind_text(&surface.behind) };
        let thickness = if name == "image" { String::new() } else { number(surface.thickness) };
        let conic = if surface.conic == 0.0 { String::new() } else { short(surface.conic) };
        vec![name, number(surface.radius), thickness, behind, size, conic, remarks]
    };
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (place, surface) in lens.surfaces.iter().enumerate() {
        let remarks = remarks(lens, place + 1, surface).join(", ");
        rows.push(row((place + 1).to_string(), surface, size(place), remarks));
    }
    let image = Surface::new(lens.image.radius, 0.0, Behind::Air).conic(lens.image.conic);
    let last = remarks(lens, lens.surfaces.len() + 1, &image).join(", ");
    // the image of the solids is wider than its light, so that it catches stray light
    let stated = lens.image.semi_diameter.map_or(String::new(), |r| short(rounded(r, 5)));
    rows.push(row("image".to_owned(), &image, stated, last));
    let lengths = ["radius", "thickness", "semi-diameter"].map(|what| format!("{what} / {unit}"));
    let [radius, thickness, semi_diameter] = lengths.each_ref().map(String::as_str);
    let head = ["surface", radius, thickness, "behind", semi_diameter, "conic", "remarks"];
    terminal::table(&head, &rows, &[false, true, true, false, true, true, false])
}

/// Contents of a lens file beside the columns of a prescription.
fn remarks(lens: &Prescription, number: usize, surface: &Surface) -> Vec<String> {
    let has = [
        (number == lens.stop, "stop"),
        (surface.even != [0.0; 8] || surface.odd != [0.0; 8], "aspheric terms"),
        (surface.figure != Figure::Round, "not of revolution"),
        (surface.hole > 0.0, "hole"),
        (lens.breaks.iter().any(|own| own.before == number), "coordinate break before it"),
    ];
    let edge = surface.mechanical_semi_diameter;
    let edge = edge.map(|radius| format!("mechanical semi-diameter {}", short(rounded(radius, 5))));
    has.into_iter().filter_map(|(has, text)| has.then_some(text.to_owned())).chain(edge).collect()
}

/// The medium behind a surface.
fn behind_text(behind: &Behind) -> String {
    match behind {
        Behind::Air => String::new(),
        Behind::Mirror => "mirror".to_owned(),
        Behind::Glass(name) => name.clone(),
        Behind::Index(n) => short(*n),
        Behind::Abbe { n_d, v_d } => format!("{} {}", short(*n_d), short(*v_d)),
        Behind::Medium(medium) => medium.name().to_owned(),
    }
}

/// The surfaces of a lens as JSON.
pub fn prescription_json(lens: &Prescription, semi_diameters: &[f64]) -> Value {
    let row = |(place, surface): (usize, &Surface)| {
        json!({
            "surface": place + 1,
            "radius": surface.radius,
            "thickness": surface.thickness,
            "behind": behind_text(&surface.behind),
            "semi_diameter": semi_diameters.get(place),
            "mechanical_semi_diameter": surface.mechanical_semi_diameter,
            "conic": surface.conic,
            "is_stop": place + 1 == lens.stop,
        })
    };
    lens.surfaces.iter().enumerate().map(row).collect()
}
