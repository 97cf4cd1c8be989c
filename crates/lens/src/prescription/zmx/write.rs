//! Writer of Zemax files.

use super::curvature::curvature;
use super::decimal;
use super::glas::{C_NM, D_NM, F_NM};
use super::kind::written;
use crate::prescription::{Behind, FieldKind, Prescription, PrescriptionError, Surface, SystemAperture};
use rayweave_optics::Medium;
use rayweave_optics::glass::{Glass, GlassError, glass as catalogue_glass};

/// Writes a prescription as a Zemax file, in UTF-8 with line feeds. Reading it back gives the same
/// prescription, with two exceptions: a [`Behind::Medium`] becomes a model glass, and a stop that sets the aperture
/// gets a semi-diameter. Files state curvatures, with as many digits as radii from
/// 1 to 1e5 need to come back; others come back to 16 digits.
///
/// # Errors
/// [`PrescriptionError::Glass`] for unknown media; [`PrescriptionError::Undefined`] for a surface that no
/// type represents, such as one with odd powers of r and any beyond r^8, and for coordinate breaks.
pub fn write_zmx(lens: &Prescription) -> Result<String, PrescriptionError> {
    if !lens.breaks.is_empty() {
        let why = "coordinate breaks are read, but not written";
        return Err(PrescriptionError::Undefined { what: "Zemax file", why });
    }
    let mut file = head(lens);
    let thickness = if lens.object_distance.is_finite() {
        lens.object_distance.to_string()
    } else {
        "INFINITY".to_owned()
    };
    file.extend(["SURF 0".to_owned(), "  TYPE STANDARD".to_owned(), "  CURV 0".to_owned()]);
    file.push(format!("  DISZ {thickness}"));
    for (k, surface) in lens.surfaces.iter().enumerate() {
        let number = k + 1;
        file.push(format!("SURF {number}"));
        file.extend((number == lens.stop).then(|| "  STOP".to_owned()));
        let glass = glass(&surface.behind);
        let glass = glass.map_err(|problem| PrescriptionError::Glass { surface: number, problem })?;
        let semi_diameter = match lens.aperture {
            SystemAperture::StopSemiDiameter(radius) if number == lens.stop => Some(radius),
            _ => surface.semi_diameter,
        };
        file.extend(surface_lines(&Surface { semi_diameter, ..surface.clone() }, glass)?);
    }
    file.push(format!("SURF {}", lens.surfaces.len() + 1));
    file.extend(surface_lines(&lens.image_as_surface(), None)?);
    Ok(file.join("\n") + "\n")
}

/// The lines before the surfaces.
fn head(lens: &Prescription) -> Vec<String> {
    let mut file = vec!["MODE SEQ".to_owned(), format!("NAME {}", lens.name)];
    file.extend(lens.notes.iter().map(|note| format!("NOTE 0 {note}")));
    file.push(format!("UNIT {} X W X CM MR CPMM", unit(lens.unit_nm)));
    file.push(match lens.aperture {
        SystemAperture::EntrancePupilDiameter(diameter) => format!("ENPD {diameter}"),
        SystemAperture::FNumber(number) => format!("FNUM {number} 0"),
        SystemAperture::ObjectNumericalAperture(aperture) => format!("OBNA {aperture} 0"),
        SystemAperture::StopSemiDiameter(_) => "FLOA".to_owned(),
    });
    let kind = match lens.field_kind {
        FieldKind::Angle => 0,
        FieldKind::ObjectHeight => 1,
        FieldKind::ImageHeight => 2,
    };
    file.extend(makers(lens));
    file.push(format!("FTYP {kind} 0 {} {} 0 0 0", lens.fields.len(), lens.lines.len()));
    for (keyword, axis) in [("XFLN", 0), ("YFLN", 1)] {
        let values: Vec<String> = lens.fields.iter().map(|field| field[axis].to_string()).collect();
        file.push(format!("{keyword} {}", values.join(" ")));
    }
    let line = |(k, line): (usize, &crate::prescription::WeightedWavelength)| {
        format!("WAVM {} {} {}", k + 1, decimal(line.wavelength_nm / 1e3), line.weight)
    };
    file.extend(lens.lines.iter().enumerate().map(line));
    file.push(format!("PWAV {}", lens.primary + 1));
    file
}

/// The name of the unit; millimetres if it has none.
fn unit(unit_nm: f64) -> &'static str {
    super::read::UNITS.iter().find(|(_, nm)| *nm == unit_nm).map_or("MM", |(name, _)| name)
}

fn surface_lines(surface: &Surface, glass: Option<String>) -> Result<Vec<String>, PrescriptionError> {
    let (kind, parameters) =
        written(surface).map_err(|why| PrescriptionError::Undefined { what: "Zemax file", why })?;
    let mut lines = vec![format!("  TYPE {kind}"), format!("  CURV {}", curvature(surface.radius))];
    lines.extend(parameters);
    lines.extend((surface.conic != 0.0).then(|| format!("  CONI {}", surface.conic)));
    lines.push(format!("  DISZ {}", surface.thickness));
    lines.extend(glass.map(|glass| format!("  GLAS {glass}")));
    lines.extend(surface.semi_diameter.map(|radius| format!("  DIAM {radius} 1 0 0 1 \"\"")));
    lines.extend(surface.mechanical_semi_diameter.map(|radius| format!("  MEMA {radius} 1 0 0 1 \"\"")));
    if surface.hole > 0.0 {
        lines.push(format!("  CLAP {} {} 0", surface.hole, surface.semi_diameter.unwrap_or(0.0)));
    }
    Ok(lines)
}

/// The arguments of `GLAS`; none for air.
fn glass(behind: &Behind) -> Result<Option<String>, GlassError> {
    Ok(match behind {
        Behind::Air => None,
        Behind::Mirror => Some("MIRROR 0 0 1.5 40".to_owned()),
        Behind::Index(n) => Some(format!("___BLANK 1 0 {n} 0")),
        Behind::Abbe { n_d, v_d } => Some(format!("___BLANK 1 0 {n_d} {v_d}")),
        Behind::Glass(name) => {
            let name = own_name(name).map_or(name.clone(), |(_, own)| own);
            behind.medium()?.map(|medium| named(&name, &medium))
        }
        Behind::Medium(medium) => Some(named("___BLANK", medium)),
    })
}

/// Maker and name of a glass that is stated with its maker, as a name in a file has no blank.
fn own_name(name: &str) -> Option<(String, String)> {
    let found = catalogue_glass(name).ok().filter(|_| name.contains(char::is_whitespace))?;
    Some((found.maker().to_owned(), found.name().split_whitespace().collect::<Vec<_>>().join("_")))
}

/// The line of the makers of all glasses, so that other programs take these and not glasses of the same names.
fn makers(lens: &Prescription) -> Option<String> {
    let mut glasses: Vec<Glass> = Vec::new();
    for surface in &lens.surfaces {
        let Behind::Glass(name) = &surface.behind else { continue };
        let found = catalogue_glass(name).ok().filter(|found| !found.maker().is_empty());
        glasses.extend(found);
    }
    let mut left: Vec<&str> = Vec::new();
    for glass in &glasses {
        if !left.contains(&glass.maker()) {
            left.push(glass.maker());
        }
    }
    let mut ordered = Vec::new();
    while !left.is_empty() {
        // a maker hides the glasses of later ones that have the name of one of its own
        let hides = |maker: &str| {
            glasses.iter().any(|glass| {
                let is_later = glass.maker() != maker && left.contains(&glass.maker());
                is_later && catalogue_glass(&format!("{maker} {}", glass.name())).is_ok()
            })
        };
        let next = left.iter().position(|maker| !hides(maker)).unwrap_or(0);
        ordered.push(left.remove(next).to_uppercase());
    }
    (!ordered.is_empty()).then(|| format!("GCAT {}", ordered.join(" ")))
}

/// Name, index and Abbe number, to six and four digits as in catalogues.
fn named(name: &str, medium: &Medium) -> String {
    let [f, d, c] = [F_NM, D_NM, C_NM].map(|line| medium.index(line).re);
    let (n_d, v_d) = (format!("{d:.6}"), format!("{:.4}", (d - 1.0) / (f - c)));
    let kind = if name == "___BLANK" { 1 } else { 0 };
    format!("{name} {kind} 0 {n_d} {v_d}")
}
