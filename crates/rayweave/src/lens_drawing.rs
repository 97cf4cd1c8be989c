//! Drawings of the lenses of a prescription.

use rayweave_draw::{
    DrawError, ElementFace, Indications, LensElement, lens_element_drawing, lens_group_drawing,
};
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
    lens_drawing_with(lens, [number; 2], title, [])
}

/// Like [`lens_drawing`], for one lens (the first number equals the last) or for the cemented lenses from the first to the last
/// number on one sheet, with indications that a prescription does not have: texts by the names of their fields
/// ([`Indications`](crate::draw::Indications)).
///
/// ```
/// use rayweave::lens::prescription::{Behind, Prescription, Surface};
///
/// let lens = Prescription::new(vec![
///     Surface::new(61.4, 6.0, Behind::Glass("N-BK7".to_owned())),
///     Surface::new(-44.35, 2.5, Behind::Glass("N-SF5".to_owned())),
///     Surface::new(-129.6, 95.9, Behind::Air),
/// ])
/// .entrance_pupil_diameter(20.0);
/// let cement = ("cement".to_owned(), "NOA 61".to_owned());
/// let drawing = rayweave::lens_drawing_with(&lens, [1, 2], "doublet", [cement])?;
/// assert!(drawing.contains("R2: R 44.35 CC") && drawing.contains("NOA 61"));
/// # Ok::<(), rayweave::Error>(())
/// ```
///
/// # Errors
///
/// As for [`lens_drawing`], lenses that are not cemented, and fields that do not exist.
pub fn lens_drawing_with(
    lens: &Prescription,
    [first, last]: [usize; 2],
    title: &str,
    indications: impl IntoIterator<Item = (String, String)>,
) -> Result<String, crate::Error> {
    let layout = lens.assembly()?;
    let count = layout.lenses.len();
    let numbers = first..=last;
    let missing =
        numbers.clone().find(|number| !(1..=count).contains(number)).or((first > last).then_some(0));
    if let Some(number) = missing {
        let reason = match count {
            0 => "the prescription has no lenses".to_owned(),
            1 => "the prescription has one lens, with the number 1".to_owned(),
            _ => format!("the lenses have the numbers 1 to {count}"),
        };
        let problem = match first > last {
            true => format!("there are no lenses {first} to {last}"),
            false => format!("there is no lens {number}"),
        };
        return Err(DrawError::Option(Message::new(problem, reason)).into());
    }
    let mut outlines: Vec<&LensOutline> = layout.lenses[first - 1..last].iter().collect();
    // in the order of z, which light that has met a mirror passes backwards
    outlines.sort_by_key(|outline| outline.surfaces[0].min(outline.surfaces[1]));
    if outlines.len() > 1 && outlines[0].surfaces[0] > outlines[0].surfaces[1] {
        outlines.reverse();
    }
    if let Some(pair) = outlines.windows(2).find(|pair| pair[0].surfaces[1] != pair[1].surfaces[0]) {
        let problem = format!("{} and {} are not cemented", pair[0].name, pair[1].name);
        let message = Message::new(problem, "one sheet shows one lens, or lenses that share their surfaces");
        return Err(DrawError::Option(message.suggest("Draw them one by one.")).into());
    }
    let Some(unit) = Unit::of_metres(1e-9 * lens.unit_nm) else {
        let problem = format!("the unit of the prescription is {} nm", lens.unit_nm);
        let symbols = Unit::ALL.map(|(_, symbol, _)| symbol).join(", ");
        let message = Message::new(problem, format!("drawings have lengths in {symbols}"));
        return Err(DrawError::Option(message.suggest("Scale the prescription to one of them.")).into());
    };
    let element = |outline: &&LensOutline| element(lens, outline, (&layout.semi_diameters, unit), title);
    let mut elements = outlines.iter().map(element).collect::<Result<Vec<_>, _>>()?;
    if let [element] = elements.as_mut_slice() {
        element.indications = Indications::of_element(indications)?;
        return Ok(lens_element_drawing(element)?);
    }
    let names: Vec<&str> = outlines.iter().map(|outline| outline.name.as_str()).collect();
    let title = full_title(title, &lens.name, &names.join(" + "));
    Ok(lens_group_drawing(&elements, &title, &Indications::of_group(indications)?)?)
}

/// The given title, or the names of prescription and lens.
fn full_title(given: &str, prescription: &str, lens: &str) -> String {
    match (given, prescription) {
        ("", "") => lens.to_owned(),
        ("", name) => format!("{name}, {lens}"),
        (given, _) => given.to_owned(),
    }
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
        title: full_title(title, &lens.name, &outline.name),
        material: medium.name().to_owned(),
        index: index(&medium),
        faces: [face(0), face(1)],
        thickness: outline.thickness,
        semi_diameter: outline.semi_diameter,
        unit,
        indications: Indications::default(),
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
