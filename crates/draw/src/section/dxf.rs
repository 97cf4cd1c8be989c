//! Cross-sections as DXF (Drawing Interchange Format), release 12 (AC1009) in ASCII, which all CAD programs read.
//!
//! Source: *AutoCAD Release 12 Customization Manual*, chapter 11, Drawing Interchange and File Formats.

use super::arcs::{Corner, Shape};
use rayweave_analysis::section::{CrossSection, SectionPart};
use std::collections::HashMap;
use std::fmt::Write;

/// The maximum length of the name of a layer.
const NAME: usize = 31;

/// Draws sections as DXF: each contour is a closed POLYLINE in the coordinates of its plane, at the height given by the offset of
/// the plane, on a layer with the name of its part. Where its points lie on a circle, within a fiftieth of the tolerance of the section,
/// it has an arc (a bulge); a whole circle is a CIRCLE. Lengths are in `unit`.
pub fn section_dxf(sections: &[CrossSection], unit: &str) -> String {
    let layers = Layers::new(sections);
    let mut text = String::new();
    let mut put = |code: u32, value: &dyn std::fmt::Display| {
        // writing to a string cannot fail
        let _ = writeln!(text, "{code}\n{value}");
    };
    put(999, &format!("rayweave section, lengths in {unit}"));
    header(&mut put);
    layers.table(&mut put);
    put(0, &"SECTION");
    put(2, &"ENTITIES");
    for section in sections {
        for part in &section.parts {
            let layer = layers.name(part);
            for contour in &part.contours {
                match Shape::of(contour, section.tolerance) {
                    Shape::Circle { centre, radius } => {
                        circle(layer, section.plane.offset(), (centre, radius), &mut put);
                    }
                    Shape::Outline(corners) => polyline(layer, section.plane.offset(), &corners, &mut put),
                }
            }
        }
    }
    put(0, &"ENDSEC");
    put(0, &"EOF");
    text
}

/// A writer of a group code with its value.
type Put<'a> = dyn FnMut(u32, &dyn std::fmt::Display) + 'a;

fn header(put: &mut Put<'_>) {
    put(0, &"SECTION");
    put(2, &"HEADER");
    put(9, &"$ACADVER");
    put(1, &"AC1009");
    put(0, &"ENDSEC");
}

fn circle(layer: &str, height: f64, (centre, radius): ([f64; 2], f64), put: &mut Put<'_>) {
    put(0, &"CIRCLE");
    put(8, &layer);
    put(10, &centre[0]);
    put(20, &centre[1]);
    put(30, &height);
    put(40, &radius);
}

fn polyline(layer: &str, height: f64, corners: &[Corner], put: &mut Put<'_>) {
    let point = |[x, y]: [f64; 2], put: &mut Put<'_>| {
        put(10, &x);
        put(20, &y);
        put(30, &height);
    };
    put(0, &"POLYLINE");
    put(8, &layer);
    put(66, &1);
    point([0.0; 2], put);
    // a closed polyline
    put(70, &1);
    for corner in corners {
        put(0, &"VERTEX");
        put(8, &layer);
        point(corner.at, put);
        if corner.bulge != 0.0 {
            put(42, &corner.bulge);
        }
    }
    put(0, &"SEQEND");
    put(8, &layer);
}

/// The layers of the parts, in their order.
struct Layers {
    names: Vec<String>,
    by_part: HashMap<String, usize>,
}

impl Layers {
    fn new(sections: &[CrossSection]) -> Layers {
        let mut layers = Layers { names: Vec::new(), by_part: HashMap::new() };
        for part in sections.iter().flat_map(|section| &section.parts) {
            if !layers.by_part.contains_key(&part.name) {
                layers.by_part.insert(part.name.clone(), layers.names.len());
                layers.names.push(layers.unused(&part.name));
            }
        }
        layers
    }

    /// An unused layer name with characters that DXF allows: capitals, digits, `$`, `-`, `_`.
    fn unused(&self, name: &str) -> String {
        let letter = |c: char| {
            if c.is_ascii_alphanumeric() || "$-_".contains(c) { c.to_ascii_uppercase() } else { '_' }
        };
        let base: String = name.chars().map(letter).take(NAME).collect();
        let base = if base.is_empty() { "PART".to_owned() } else { base };
        let numbered = |k: usize| match k {
            1 => base.clone(),
            k => format!("{}_{k}", &base[..base.len().min(NAME - 8)]),
        };
        let mut candidates = (1..).map(numbered);
        candidates.find(|name| !self.names.contains(name)).unwrap_or_default()
    }

    fn name(&self, part: &SectionPart) -> &str {
        self.by_part.get(&part.name).map_or("0", |&k| &self.names[k])
    }

    fn table(&self, put: &mut Put<'_>) {
        put(0, &"SECTION");
        put(2, &"TABLES");
        put(0, &"TABLE");
        put(2, &"LAYER");
        put(70, &self.names.len());
        for (k, name) in self.names.iter().enumerate() {
            put(0, &"LAYER");
            put(2, name);
            put(70, &0);
            // the first six colours of the format: red, yellow, green, cyan, blue, magenta
            put(62, &(1 + k % 6));
            put(6, &"CONTINUOUS");
        }
        put(0, &"ENDTAB");
        put(0, &"ENDSEC");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_scene::Colour;

    fn part(name: &str, contours: Vec<Vec<[f64; 2]>>) -> SectionPart {
        SectionPart { name: name.to_owned(), colour: Colour::WHITE, area: 0.0, perimeter: 0.0, contours }
    }

    /// The pairs of a group code and its value.
    fn pairs(text: &str) -> Vec<(u32, &str)> {
        let lines: Vec<&str> = text.lines().collect();
        lines.chunks(2).map(|pair| (pair[0].parse().unwrap(), pair[1])).collect()
    }

    #[test]
    fn polylines_on_layers() {
        let square = vec![[0.0, 0.0], [2.5, 0.0], [2.5, 2.0], [0.0, 2.0]];
        let plane = "z=1.5".parse().unwrap();
        let parts = vec![part("Glas, grün", vec![square]), part("glas__gr_n", vec![vec![[0.0, 0.0]; 3]; 2])];
        let section =
            CrossSection { plane, parts, lo: [0.0; 2], hi: [1.0; 2], tolerance: 0.1, in_face: false };
        let text = section_dxf(&[section], "mm");
        let all = pairs(&text);
        let values = |code: u32| -> Vec<&str> { all.iter().filter(|p| p.0 == code).map(|p| p.1).collect() };
        assert_eq!(values(0).iter().filter(|kind| **kind == "POLYLINE").count(), 3);
        let layers: Vec<&str> =
            all.windows(2).filter(|p| p[0] == (0, "LAYER") && p[1].0 == 2).map(|p| p[1].1).collect();
        assert_eq!(layers, ["GLAS__GR_N", "GLAS__GR_N_2"]);
        let first = all.iter().position(|pair| *pair == (0, "VERTEX")).unwrap();
        assert_eq!(all[first + 1..first + 5], [(8, "GLAS__GR_N"), (10, "0"), (20, "0"), (30, "1.5")]);
        assert_eq!(all[all.len() - 1], (0, "EOF"));
        assert_eq!(values(999), ["rayweave section, lengths in mm"]);
    }
}
