//! Surface types of Zemax files and their parameters.
//!
//! Parameter numbers follow the chapters on surface types of the OpticStudio user guide (Ansys, 2024 R2):
//! "Even Asphere", "Odd Asphere", "Extended Asphere", "Biconic", "Toroidal", "Extended Polynomial", "Zernike
//! Standard Sag". The extra data of older files, from `XDAT 1`, are the parameters from 13 in newer ones.

use crate::prescription::{CoordinateBreak, Surface};
use rayweave_math::Affine;
use rayweave_optics::component::{Figure, Zernike};
use std::collections::BTreeMap;

/// The offset of extra data in the parameter numbers.
const EXTRA: usize = 12;

/// Upper limit of parameter numbers; no type has that many.
const MAX_PARAMETER: usize = 500;

/// The parameters of a surface, by number.
#[derive(Clone, Debug, Default)]
pub(super) struct Parameters(BTreeMap<usize, f64>);

impl Parameters {
    /// Stores a `PARM` value.
    pub fn set(&mut self, number: usize, value: f64) -> Result<(), String> {
        if number > MAX_PARAMETER {
            return Err(format!(
                "the surface has parameter {number}: numbers up to {MAX_PARAMETER} are allowed."
            ));
        }
        self.0.insert(number, value);
        Ok(())
    }

    /// Stores an `XDAT` value.
    pub fn set_extra(&mut self, number: usize, value: f64) -> Result<(), String> {
        self.set(number.saturating_add(EXTRA), value)
    }

    fn get(&self, number: usize) -> f64 {
        self.0.get(&number).copied().unwrap_or(0.0)
    }

    fn eight(&self, first: usize) -> [f64; 8] {
        std::array::from_fn(|k| self.get(first + k))
    }

    /// The normalisation radius and the list of the extra data, truncated to the stated number of terms.
    fn list(&self) -> (f64, Vec<f64>) {
        let given = self.0.last_key_value().map_or(0, |(&last, _)| last.saturating_sub(EXTRA + 2));
        let count = (self.get(EXTRA + 1).max(0.0) as usize).min(given);
        (self.get(EXTRA + 2), (1..=count).map(|k| self.get(EXTRA + 2 + k)).collect())
    }

    /// Checks that all other parameters are 0, except flag 0 (extension beyond the norm radius).
    fn only(&self, kind: &str, known: impl Fn(usize) -> bool, read: &str) -> Result<(), String> {
        let odd = self.0.iter().find(|&(&number, &value)| number > 0 && value != 0.0 && !known(number));
        match odd {
            None => Ok(()),
            Some((number, _)) => Err(format!("the {kind} has parameter {number}: {read}.")),
        }
    }
}

/// The frame of a coordinate break: the map from coordinates behind it to those in front.
pub(super) fn broken(parameters: &Parameters) -> Result<Affine, String> {
    parameters.only(
        "coordinate break",
        |number| number <= 6,
        "only 1 to 6 are read, decentres, tilts, their order",
    )?;
    let get = |number| parameters.get(number);
    let (decentre, tilts) = ([get(1), get(2)], [get(3), get(4), get(5)]);
    let made = if get(6) == 0.0 { CoordinateBreak::new } else { CoordinateBreak::tilts_first };
    Ok(made(0, decentre, tilts).map)
}

/// Applies a type and its parameters to a surface.
pub(super) fn shaped(kind: &str, parameters: &Parameters, surface: Surface) -> Result<Surface, String> {
    let get = |number| parameters.get(number);
    let radius = |number| if get(number) == 0.0 { f64::INFINITY } else { get(number) };
    let is_extra = |number: usize| number > EXTRA;
    let is_power = |number: usize| number <= 8;
    let has_list = |number: usize| is_power(number) || is_extra(number);
    Ok(match kind {
        "" | "STANDARD" => surface,
        "EVENASPH" => {
            parameters.only("asphere", is_power, "only 1 to 8 are read, r^2 to r^16")?;
            surface.even(parameters.eight(1))
        }
        "XASPHERE" => {
            parameters.only("extended asphere", is_extra, "only the terms after parameter 12 are read")?;
            surface.even(extended(parameters)?)
        }
        "ODDASPHE" => {
            parameters.only("asphere", is_power, "only 1 to 8 are read, r to r^8")?;
            let every_second = |first| std::array::from_fn(|k| if k < 4 { get(2 * k + first) } else { 0.0 });
            surface.odd(every_second(1)).even(every_second(2))
        }
        "BICONICX" => {
            parameters.only(
                "biconic",
                |number| number <= 2,
                "only 1 and 2 are read, radius and conic along x",
            )?;
            surface.figure(Figure::Biconic { radius_x: radius(1), conic_x: get(2) })
        }
        "TOROIDAL" => {
            let read =
                "only 1 to 8 are read, the radius of rotation and y^2 to y^14, but no Zernike polynomials";
            let is_idle = |number: usize| number == EXTRA + 2 || (is_extra(number) && get(EXTRA + 1) == 0.0);
            parameters.only("toroid", |number| is_power(number) || is_idle(number), read)?;
            let even = std::array::from_fn(|k| if k < 7 { get(k + 2) } else { 0.0 });
            surface.even(even).figure(Figure::Toroidal { turn: radius(1) })
        }
        "XPOLYNOM" => {
            parameters.only("extended polynomial", is_extra, "only those of terms in x and y are read")?;
            let (norm_radius, coefficients) = parameters.list();
            surface.figure(Figure::Polynomial { norm_radius, coefficients })
        }
        "SZERNSAG" | "FZERNSAG" => {
            let read = "only 1 to 8 and those of the polynomials are read, without decentres";
            parameters.only("Zernike surface", has_list, read)?;
            let (norm_radius, coefficients) = parameters.list();
            let order = if kind == "SZERNSAG" { Zernike::Noll } else { Zernike::Fringe };
            surface.even(parameters.eight(1)).figure(Figure::Zernike { order, norm_radius, coefficients })
        }
        other => return Err(unknown(other)),
    })
}

/// The coefficients of r^2 to r^16 from those of an extended asphere, which multiply powers of r
/// divided by the normalisation radius.
fn extended(parameters: &Parameters) -> Result<[f64; 8], String> {
    let (norm_radius, coefficients) = parameters.list();
    if coefficients.iter().skip(8).any(|&c| c != 0.0) {
        return Err("the extended asphere has terms beyond r^16: only r^2 to r^16 are read.".to_owned());
    }
    if coefficients.iter().any(|&c| c != 0.0) && !(norm_radius.is_finite() && norm_radius > 0.0) {
        return Err(format!(
            "the normalisation radius of the extended asphere is {norm_radius}: it must be greater than 0."
        ));
    }
    let scaled = |k: usize| match coefficients.get(k) {
        Some(&c) if c != 0.0 => c / norm_radius.powi(2 * k as i32 + 2),
        _ => 0.0,
    };
    Ok(std::array::from_fn(scaled))
}

/// The reason why a type is not read.
fn unknown(kind: &str) -> String {
    let why = match kind {
        "BICONICZ" => {
            "only a biconic without Zernike polynomials, BICONICX, or the polynomials alone, SZERNSAG, are read"
        }
        "PARAXIAL" => "it has no shape; ideal thin lenses are sheets of a system",
        _ => {
            "STANDARD, EVENASPH, XASPHERE, ODDASPHE, BICONICX, TOROIDAL, XPOLYNOM, SZERNSAG, FZERNSAG and COORDBRK are read"
        }
    };
    format!("the surface is of type {kind}: {why}.")
}

/// The Zemax type of a surface, with its parameters and extra data, or the reason why there is none.
pub(super) fn written(surface: &Surface) -> Result<(&'static str, Vec<String>), &'static str> {
    let parameters = |values: &[f64]| {
        let lines = values.iter().zip(1..).map(|(value, k)| format!("  PARM {k} {value:e}"));
        lines.collect::<Vec<_>>()
    };
    let (even, has_odd) = (surface.even, surface.odd != [0.0; 8]);
    let finite = |radius: f64| if radius.is_infinite() { 0.0 } else { radius };
    match &surface.figure {
        Figure::Round if surface.is_conic() => Ok(("STANDARD", Vec::new())),
        Figure::Round if !has_odd => Ok(("EVENASPH", parameters(&even))),
        Figure::Round if even[4..].iter().chain(&surface.odd[4..]).all(|&c| c == 0.0) => {
            let alternating: [f64; 8] =
                std::array::from_fn(|k| if k % 2 == 0 { surface.odd[k / 2] } else { even[k / 2] });
            Ok(("ODDASPHE", parameters(&alternating)))
        }
        Figure::Round => {
            Err("a surface has odd powers of r, and one beyond r^8, which ODDASPHE cannot represent")
        }
        &Figure::Biconic { radius_x, conic_x } => Ok(("BICONICX", parameters(&[finite(radius_x), conic_x]))),
        Figure::Toroidal { turn } if even[7] == 0.0 => {
            let [a, b, c, d, e, f, g, _] = even;
            Ok(("TOROIDAL", parameters(&[finite(*turn), a, b, c, d, e, f, g])))
        }
        Figure::Toroidal { .. } => Err("a toroid has a term in y^16, which TOROIDAL cannot represent"),
        Figure::Polynomial { norm_radius, coefficients } if even == [0.0; 8] => {
            Ok(("XPOLYNOM", extra(*norm_radius, coefficients)))
        }
        Figure::Polynomial { .. } => {
            Err("a surface has terms in r in addition to those in x and y, which no type can represent")
        }
        Figure::Zernike { order, norm_radius, coefficients } => {
            let kind = match order {
                Zernike::Noll => "SZERNSAG",
                Zernike::Fringe => "FZERNSAG",
                Zernike::Osa => return Err("Zernike polynomials are in OSA order, which no type supports"),
            };
            Ok((kind, [parameters(&even), extra(*norm_radius, coefficients)].concat()))
        }
    }
}

fn extra(norm_radius: f64, coefficients: &[f64]) -> Vec<String> {
    let values = [coefficients.len() as f64, norm_radius].into_iter().chain(coefficients.iter().copied());
    values.zip(1..).map(|(value, k)| format!("  XDAT {k} {value:e} 0 0 1 0 0")).collect()
}
