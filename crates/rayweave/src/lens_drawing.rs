//! Drawings of the lenses of a prescription.

use rayweave_draw::{DrawError, ElementFace, LensElement, lens_element_drawing};
use rayweave_error::Message;
use rayweave_lens::prescription::{LensOutline, Prescription, PrescriptionError};
use rayweave_optics::Medium;
use rayweave_optics::glass::line_nm;
use rayweave_scene::Unit;

/// The drawing of a lens of a prescription as SVG, in the tabular form of ISO 10110-1; lenses are counted from 1 in the order of
/// the light. Without a title, the drawing has the names of prescription and lens.
///
/// ```
/// use rayweave::lens::prescription::{Behind, Prescription, Surface};
///
/// let lens = Prescription::new(vec![
///     Surface::new(50.0, 5.0, Behind::Glass("N-BK7".to_owned())),
///     Surface::new(-50.0, 46.0, Behind::Air),
/// ])
/// .entrance_pupil_diameter(10.0);
/// let drawing = rayweave::lens_drawing(&lens, 1, "singlet")?;
/// assert!(drawing.contains("R 50 CX") && drawing.contains("nd = 1.516800"));
/// # Ok::<(), rayweave::Error>(())
/// ```
///
/// # Errors
///
/// Prescriptions without solids, or in a unit that [`Unit`] does not have, and numbers of lenses that do not exist.
pub fn lens_drawing(lens: &Prescription, number: usize, title: &str) -> Result<String, crate::Error> {
    let layout = lens.assembly()?;
    let count = layout.lenses.len();
    let found = number.checked_sub(1).and_then(|k| layout.lenses.get(k));
    let Some(outline) = found else {
        let reason = match count {
            0 => "the prescription has no lenses".to_owned(),
            1 => "the prescription has one lens, with the number 1".to_owned(),
            _ => format!("the lenses have the numbers 1 to {count}"),
        };
        return Err(DrawError::Option(Message::new(format!("there is no lens {number}"), reason)).into());
    };
    let Some(unit) = Unit::of_metres(1e-9 * lens.unit_nm) else {
        let problem = format!("the unit of the prescription is {} nm", lens.unit_nm);
        let symbols = Unit::ALL.map(|(_, symbol, _)| symbol).join(", ");
        let message = Message::new(problem, format!("drawings have lengths in {symbols}"));
        return Err(DrawError::Option(message.suggest("Scale the prescription to one of them.")).into());
    };
    let element = element(lens, outline, (&layout.semi_diameters, unit), title)?;
    Ok(lens_element_drawing(&element)?)
}

fn element(
    lens: &Prescription,
    outline: &LensOutline,
    (clear, unit): (&[f64], Unit),
    title: &str,
) -> Result<LensElement, PrescriptionError> {
    let [a, b] = outline.surfaces;
    let first = a.min(b);
    let medium = lens.surfaces[first].behind.medium();
    let medium = medium.map_err(|problem| PrescriptionError::Glass { surface: first + 1, problem })?;
    let medium = medium.unwrap_or_else(Medium::vacuum);
    let face = |side: usize| {
        let k = outline.surfaces[side];
        let surface = &lens.surfaces[k];
        ElementFace {
            form: surface.form(),
            end: outline.ends[side],
            clear: clear[k],
            is_computed: surface.semi_diameter.is_none(),
        }
    };
    Ok(LensElement {
        title: match (title, lens.name.as_str()) {
            ("", "") => outline.name.clone(),
            ("", name) => format!("{name}, {}", outline.name),
            (title, _) => title.to_owned(),
        },
        material: medium.name().to_owned(),
        index: index(&medium),
        faces: [face(0), face(1)],
        thickness: outline.thickness,
        semi_diameter: outline.semi_diameter,
        unit,
    })
}

/// The index at the d line and the Abbe number; none outside the range of the medium.
fn index(medium: &Medium) -> Option<[f64; 2]> {
    let [low, high] = medium.range_nm();
    let indices = ["d", "F", "C"].map(|line| {
        let nm = line_nm(line).filter(|nm| (low..=high).contains(nm))?;
        Some(medium.index(nm).re)
    });
    let [Some(d), Some(f), Some(c)] = indices else { return None };
    Some([d, (d - 1.0) / (f - c)])
}
