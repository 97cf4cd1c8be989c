//! Closed curves of DXF files (AutoCAD DXF reference): polylines with arcs, circles, and chains of lines and arcs.

use super::curve::{Contours, Segment, joined, vertex};
use rayweave_math::unit_vector_degrees;
use rayweave_polygon::Vertex;

/// Entities that are no curves.
const IGNORED: [&str; 10] =
    ["TEXT", "MTEXT", "DIMENSION", "POINT", "HATCH", "LEADER", "VIEWPORT", "IMAGE", "ATTDEF", "ATTRIB"];

/// An entity: its kind and its pairs of group codes and values.
struct Entity<'t> {
    kind: &'t str,
    pairs: Vec<(i32, &'t str)>,
}

impl Entity<'_> {
    fn number(&self, code: i32) -> Result<Option<f64>, String> {
        self.pairs.iter().find(|(own, _)| *own == code).map(|(_, text)| number(text)).transpose()
    }

    fn required(&self, code: i32) -> Result<f64, String> {
        self.number(code)?.ok_or_else(|| format!("an entity {} has no group {code}", self.kind))
    }

    fn point(&self, code: i32) -> Result<[f64; 2], String> {
        Ok([self.required(code)?, self.required(code + 10)?])
    }

    fn layer(&self) -> &str {
        self.pairs.iter().find(|(code, _)| *code == 8).map_or("0", |(_, name)| name)
    }

    fn is_closed(&self) -> Result<bool, String> {
        Ok(self.number(70)?.unwrap_or(0.0) as i64 & 1 == 1)
    }
}

fn number(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("`{text}` is not a number")),
    }
}

pub(super) fn read(text: &str, layer: Option<&str>) -> Result<Contours, String> {
    let (mut contours, mut loose) = (Contours::new(), Vec::new());
    // a polyline whose vertices follow as entities
    let mut open: Option<(bool, bool, Vec<Vertex>)> = None;
    for entity in entities(text)? {
        let is_wanted = layer.is_none_or(|layer| entity.layer() == layer);
        match entity.kind {
            "POLYLINE" => open = Some((is_wanted, entity.is_closed()?, Vec::new())),
            "VERTEX" => {
                if let Some((_, _, vertices)) = &mut open {
                    vertices.push(vertex(entity.point(10)?, entity.number(42)?.unwrap_or(0.0)));
                }
            }
            "SEQEND" => {
                if let Some((true, is_closed, vertices)) = open.take() {
                    polyline(vertices, is_closed, &mut contours, &mut loose);
                }
            }
            kind if !is_wanted || IGNORED.contains(&kind) => {}
            "LWPOLYLINE" => polyline(vertices(&entity)?, entity.is_closed()?, &mut contours, &mut loose),
            "CIRCLE" => contours.push(Vertex::circle(entity.point(10)?, entity.required(40)?).to_vec()),
            "LINE" => loose.push(Segment { from: entity.point(10)?, to: entity.point(11)?, bulge: 0.0 }),
            "ARC" => loose.push(arc(&entity)?),
            kind => {
                let advice = "convert it to polylines, arcs and circles in the program that wrote the file";
                return Err(format!("it has an entity {kind}, which is not read: {advice}"));
            }
        }
    }
    contours.extend(joined(loose)?);
    Ok(contours)
}

/// The entities of the section ENTITIES.
fn entities(text: &str) -> Result<Vec<Entity<'_>>, String> {
    if text.starts_with("AutoCAD Binary DXF") {
        return Err("it is a binary DXF file: save it as text".to_owned());
    }
    let mut lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
    let (mut all, mut section, mut is_name) = (Vec::<Entity>::new(), "", false);
    let mut is_complete = false;
    while let (Some(code), Some(value)) = (lines.next(), lines.next()) {
        let code: i32 =
            code.parse().map_err(|_| format!("it is not a DXF file: `{code}` is not a group code"))?;
        match (code, value) {
            (0, "SECTION") => is_name = true,
            (0, "ENDSEC") => section = "",
            (0, "EOF") => {
                is_complete = true;
                break;
            }
            (2, name) if is_name => (section, is_name) = (name, false),
            (0, kind) if section == "ENTITIES" => all.push(Entity { kind, pairs: Vec::new() }),
            (code, value) if section == "ENTITIES" => all.extend_last(code, value),
            _ => {}
        }
    }
    match is_complete {
        true => Ok(all),
        false => Err("it has no EOF at its end: it is incomplete".to_owned()),
    }
}

/// The addition of a pair to the last entity.
trait ExtendLast<'t> {
    fn extend_last(&mut self, code: i32, value: &'t str);
}

impl<'t> ExtendLast<'t> for Vec<Entity<'t>> {
    fn extend_last(&mut self, code: i32, value: &'t str) {
        if let Some(entity) = self.last_mut() {
            entity.pairs.push((code, value));
        }
    }
}

/// The vertices of a light-weight polyline: x, y and bulge in turn.
fn vertices(entity: &Entity<'_>) -> Result<Vec<Vertex>, String> {
    let mut vertices: Vec<Vertex> = Vec::new();
    for (code, value) in &entity.pairs {
        match (code, vertices.last_mut()) {
            (10, _) => vertices.push(vertex([number(value)?, 0.0], 0.0)),
            (20, Some(last)) => last.at[1] = number(value)?,
            (42, Some(last)) => last.bulge = number(value)?,
            _ => {}
        }
    }
    Ok(vertices)
}

/// Adds a closed polyline as a contour, and the edges of an open one to the loose curves.
fn polyline(vertices: Vec<Vertex>, is_closed: bool, contours: &mut Contours, loose: &mut Vec<Segment>) {
    if is_closed {
        return contours.push(vertices);
    }
    let edges = vertices.windows(2).filter(|pair| pair[0].at != pair[1].at);
    loose.extend(edges.map(|pair| Segment { from: pair[0].at, to: pair[1].at, bulge: pair[0].bulge }));
}

/// An arc, counter-clockwise from its start angle to its end angle.
fn arc(entity: &Entity<'_>) -> Result<Segment, String> {
    let (centre, radius) = (entity.point(10)?, entity.required(40)?);
    let (start, end) = (entity.required(50)?, entity.required(51)?);
    let sweep = (end - start).rem_euclid(360.0);
    let at = |degrees: f64| {
        let v = unit_vector_degrees(degrees);
        [centre[0] + radius * v.x, centre[1] + radius * v.y]
    };
    Ok(Segment { from: at(start), to: at(end), bulge: libm::tan((0.25 * sweep).to_radians()) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_polygon::Outline;

    fn file(entities: &str) -> String {
        let pairs = entities.split_whitespace().collect::<Vec<_>>().join("\n");
        format!(
            "0\nSECTION\n2\nHEADER\n9\n$X\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{pairs}\n0\nENDSEC\n0\nEOF\n"
        )
    }

    fn area(entities: &str, layer: Option<&str>) -> f64 {
        Outline::new(&read(&file(entities), layer).unwrap()).unwrap().area()
    }

    #[test]
    fn closed_curves_are_read() {
        let pi = std::f64::consts::PI;
        let slot = "0 LWPOLYLINE 8 cut 90 4 70 1 10 0 20 0 10 4 20 0 42 1 10 4 20 2 10 0 20 2 42 1";
        assert!((area(slot, None) - (8.0 + pi)).abs() < 1e-13);
        let hole = format!("{slot} 0 CIRCLE 8 holes 10 2 20 1 40 0.5 0 TEXT 8 cut 1 note");
        assert!((area(&hole, None) - (8.0 + 0.75 * pi)).abs() < 1e-13);
        assert!((area(&hole, Some("holes")) - 0.25 * pi).abs() < 1e-14);
        // a half disc of a line and an arc, drawn in opposite directions, with ends of six digits
        let half = "0 LINE 10 0.333333 20 0 11 -0.333333 21 0 0 ARC 10 0 20 0 40 0.3333333 50 0 51 180";
        assert!((area(half, None) - 0.5 * pi / 9.0).abs() < 1e-5);
        let old = "0 POLYLINE 70 1 0 VERTEX 10 0 20 0 0 VERTEX 10 2 20 0 0 VERTEX 10 0 20 2 0 SEQEND";
        assert_eq!(area(old, None), 2.0);
    }

    #[test]
    fn problems_are_reported() {
        let fails = |entities: &str| read(&file(entities), None).unwrap_err();
        assert!(fails("0 LINE 10 0 20 0 11 1 21 0").contains("a curve is open: it ends at (1, 0)"));
        assert!(fails("0 SPLINE 70 8").contains("SPLINE, which is not read"));
        assert!(fails("0 CIRCLE 10 0 20 0").contains("no group 40"));
        assert!(fails("0 CIRCLE 10 0 20 x 40 1").contains("`x` is not a number"));
        assert!(read("solid x\nfacet", None).unwrap_err().contains("not a DXF file"));
        let whole = file("0 CIRCLE 10 0 20 0 40 1");
        for line in whole.match_indices('\n').map(|(at, _)| at).filter(|&at| at + 5 < whole.len()) {
            assert!(read(&whole[..line], None).is_err(), "{}", &whole[..line]);
        }
        assert!(read(&format!("\u{feff}{whole}"), None).is_ok());
    }
}
