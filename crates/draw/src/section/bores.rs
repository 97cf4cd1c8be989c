//! Centre lines and diameters of the holes that a section cuts along their axes.

use crate::dimension;
use crate::plan::Plan;
use crate::svg::Svg;
use rayweave_analysis::features::CylindricalFace;
use rayweave_analysis::section::Cut;

/// The length of centre lines beyond the ends, in pixels.
const BEYOND: f64 = 7.0;

/// The places of the diameters of holes on one axis, as parts of the lengths of the holes: one beside the other.
const PLACES: [f64; 4] = [0.38, 0.55, 0.24, 0.71];

/// Draws a centre line for each axis in the plane, and the diameters of its holes. `resolution` is that of the diameters.
pub fn draw(svg: &mut Svg, plan: &Plan, cut: &Cut, cylinders: &[CylindricalFace], resolution: f64) {
    let size = cylinders.iter().map(CylindricalFace::length).fold(0.0, f64::max);
    let tolerance = 1e-7 * size;
    let is_in_plane = |face: &&CylindricalFace| {
        let off = face.ends.map(|end| cut.normal().dot(end - cut.point([0.0; 2])).abs());
        face.share > 0.5 && off[0].max(off[1]) < tolerance && face.length() > tolerance
    };
    let mut axes: Vec<Vec<&CylindricalFace>> = Vec::new();
    for face in cylinders.iter().filter(is_in_plane) {
        let is_coaxial = |other: &CylindricalFace| {
            let off = |k: usize| other.axis().cross(face.ends[k] - other.ends[0]).length();
            off(0).max(off(1)) < tolerance
        };
        match axes.iter_mut().find(|group| is_coaxial(group[0])) {
            Some(group) => group.push(face),
            None => axes.push(vec![face]),
        }
    }
    for group in axes.iter().filter(|group| group.iter().any(|face| face.is_hole)) {
        let along = group[0].axis();
        let ends = group.iter().flat_map(|face| face.ends).map(|end| along.dot(end - group[0].ends[0]));
        let [from, to] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], t| [lo.min(t), hi.max(t)]);
        let beyond = BEYOND / plan.scale;
        let line = [from - beyond, to + beyond].map(|t| cut.place(group[0].ends[0] + t * along));
        svg.path("centre", plan.path(&line, false), "");
        let mut texts: Vec<String> = Vec::new();
        for face in group.iter().filter(|face| face.is_hole) {
            let diameter = crate::axis::format_number(2.0 * face.radius, resolution);
            let text = format!("\u{2300}{diameter}");
            if texts.len() < PLACES.len() && !texts.contains(&text) {
                let at = face.ends[0] + PLACES[texts.len()] * (face.ends[1] - face.ends[0]);
                let out = cut.normal().cross(along).normalize_or_zero();
                let ends = [-1.0, 1.0].map(|sign| plan.position(cut.place(at + sign * face.radius * out)));
                dimension::across(svg, ends, &text);
                texts.push(text);
            }
        }
    }
}
