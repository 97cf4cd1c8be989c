//! Circles, polygons, fillets and chamfers of a view with their sizes.

use crate::axis::format_number;
use rayweave_analysis::features::{
    CornerFace, CornerPlace, CornerSize, CylindricalFace, PolygonalFace, sides_of_rectangle,
};
use rayweave_analysis::section::Cut;
use rayweave_math::Vec3;

type Point = [f64; 2];

/// The outline of a face, seen along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    Round,
    /// A regular polygon; one corner lies at this angle.
    Regular {
        sides: usize,
        angle: f64,
    },
    /// The longer and the shorter side, the angle of the longer one, and the radius of the corners, 0 if they are sharp.
    Rectangle {
        size: [f64; 2],
        angle: f64,
        corner_radius: f64,
    },
    /// A chamfer, seen along its edge: its length along an axis and its angle to it, in degrees.
    Chamfer {
        length: f64,
        angle: f64,
    },
}

/// A cylindrical or polygonal face, seen along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    pub shape: Shape,
    pub centre: Point,
    /// The radius, that of the circumscribed circle for polygons.
    pub radius: f64,
    pub is_hole: bool,
    /// True if more than half of the circle is there; it has a diameter, and others have a radius.
    pub is_full: bool,
    /// Of an arc, the direction from the centre to its middle, and half of its angle.
    pub arc: Option<(Point, f64)>,
    /// True if a hole is open at both ends.
    pub is_through: bool,
    pub depth: Option<f64>,
    /// The width of a groove, a hole that is closed at both ends.
    pub width: Option<f64>,
}

/// Half of the step of the angles of arcs, in radians: ends of arcs are no places for arrows.
const HALF_STEP: f64 = std::f64::consts::PI / 24.0;

/// The number of lines of a round corner.
const ARC: u32 = 12;

/// Circles with the same text.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    pub circles: Vec<Circle>,
    pub text: String,
    /// The centre and the radius of the circle on which they lie at equal distances.
    pub ring: Option<(Point, f64)>,
}

impl Circle {
    pub fn new(face: &CylindricalFace, plane: &Cut) -> Circle {
        Circle {
            shape: Shape::Round,
            centre: plane.place(0.5 * (face.ends[0] + face.ends[1])),
            radius: face.radius,
            is_hole: face.is_hole,
            is_full: face.share > 0.5,
            arc: (face.share < 1.0)
                .then(|| (plane.axes().map(|axis| axis.dot(face.middle)), std::f64::consts::PI * face.share)),
            is_through: face.is_through,
            depth: face.depth,
            width: (face.is_hole && !face.is_through && face.depth.is_none()).then(|| face.length()),
        }
    }

    /// The outline of a polygonal face; `tolerance` is the error of equal lengths.
    pub fn of_polygon(face: &PolygonalFace, plane: &Cut, tolerance: f64) -> Circle {
        let corners: Vec<Point> = face.corners.iter().map(|&corner| plane.place(corner)).collect();
        let mean = |k: usize| corners.iter().map(|p| p[k]).sum::<f64>() / corners.len() as f64;
        let centre = [mean(0), mean(1)];
        let angle = |a: Point, b: Point| libm::atan2(b[1] - a[1], b[0] - a[0]);
        let shape = match sides_of_rectangle(&corners, tolerance) {
            Some(size) => {
                let length = libm::hypot(corners[1][0] - corners[0][0], corners[1][1] - corners[0][1]);
                let first = usize::from((length - size[0]).abs() > (length - size[1]).abs());
                let angle = angle(corners[first], corners[first + 1]);
                Shape::Rectangle { size, angle, corner_radius: face.corner_radius }
            }
            None => Shape::Regular { sides: corners.len(), angle: angle(centre, corners[0]) },
        };
        Circle {
            shape,
            centre,
            radius: libm::hypot(corners[0][0] - centre[0], corners[0][1] - centre[1]),
            is_hole: face.is_hole,
            is_full: true,
            arc: None,
            is_through: face.is_hole && face.depth.is_none(),
            depth: face.depth,
            width: None,
        }
    }

    /// A fillet or a chamfer in a view in which it is seen along its edge, at the right or the upper side of a part around an axis.
    pub fn of_corner(face: &CornerFace, plane: &Cut) -> Circle {
        let (across, [u, v]) = (plane.normal(), plane.axes());
        let along = |direction: Vec3| [u.dot(direction), v.dot(direction)];
        let out = match face.place {
            CornerPlace::Ring { axis, .. } => {
                let out = across.cross(axis).normalize_or_zero();
                let [x, y] = along(out);
                if x + 0.5 * y < 0.0 { -out } else { out }
            }
            CornerPlace::Edge { .. } => Vec3::ZERO,
        };
        let centre = plane.place(match face.place {
            CornerPlace::Ring { centre, radius, .. } => centre + radius * out,
            CornerPlace::Edge { middle, .. } => middle,
        });
        let arc = match (face.size, face.place) {
            (CornerSize::Fillet { middle, half_angle, .. }, CornerPlace::Ring { axis, .. }) => {
                Some((along(middle[0] * out + middle[1] * axis), half_angle))
            }
            _ => None,
        };
        let (shape, radius) = match face.size {
            CornerSize::Fillet { radius, .. } => (Shape::Round, radius),
            CornerSize::Chamfer { length, angle } => (Shape::Chamfer { length, angle }, 0.0),
        };
        Circle {
            shape,
            centre,
            radius,
            is_hole: false,
            is_full: false,
            arc,
            is_through: false,
            depth: None,
            width: None,
        }
    }

    /// The slot whose ends two half circles are.
    fn slot(&self, other: &Circle, tolerance: f64) -> Option<Circle> {
        let (Some((out, half)), Some((back, other_half))) = (self.arc, other.arc) else { return None };
        let is_half = |half: f64| (half - std::f64::consts::FRAC_PI_2).abs() < HALF_STEP;
        let apart = [0, 1].map(|k| self.centre[k] - other.centre[k]);
        let length = libm::hypot(apart[0], apart[1]);
        let along = |towards: Point| (apart[0] * towards[0] + apart[1] * towards[1]) / length.max(1e-300);
        let is_slot = self.is_hole
            && self.is_like(other, tolerance)
            && self.is_through == other.is_through
            && is_half(half)
            && is_half(other_half)
            && length > tolerance
            && along(out) > libm::cos(HALF_STEP)
            && along(back) < -libm::cos(HALF_STEP);
        let size = [length + 2.0 * self.radius, 2.0 * self.radius];
        let (corner_radius, angle) = (self.radius, libm::atan2(apart[1], apart[0]));
        is_slot.then(|| Circle {
            shape: Shape::Rectangle { size, angle, corner_radius },
            centre: [0, 1].map(|k| 0.5 * (self.centre[k] + other.centre[k])),
            radius: 0.5 * libm::hypot(size[0], size[1]),
            is_full: true,
            arc: None,
            ..*self
        })
    }

    /// The direction from the centre to the tip of an arrow from a text in a direction. The tip is on the circle; that of an arc on its
    /// near side or, through its centre, on its far side, or else in its middle.
    pub fn tip(&self, towards: Point) -> Point {
        let Some((middle, half)) = self.arc else { return towards };
        let is_on =
            |to: Point| to[0] * middle[0] + to[1] * middle[1] > libm::cos((half - HALF_STEP).max(0.0));
        let far = towards.map(|part| -part);
        [towards, far].into_iter().find(|to| is_on(*to)).unwrap_or(middle)
    }

    /// The outline of a polygon with round corners as lines, without the last one; empty for a circle.
    pub fn outline(&self) -> Vec<Point> {
        let corners = self.corners();
        let Shape::Rectangle { corner_radius, .. } = self.shape else { return corners };
        if corner_radius == 0.0 {
            return corners;
        }
        let count = corners.len();
        let round = |k: usize| {
            let [before, at, after] = [k + count - 1, k, k + 1].map(|k| corners[k % count]);
            // the unit vectors from the corner along its sides
            let to = |p: Point| {
                let length = libm::hypot(p[0] - at[0], p[1] - at[1]);
                [0, 1].map(|i| (p[i] - at[i]) / length)
            };
            let (a, b) = (to(before), to(after));
            (0..=ARC).map(move |step| {
                let turn = std::f64::consts::FRAC_PI_2 * f64::from(step) / f64::from(ARC);
                let (sin, cos) = (libm::sin(turn), libm::cos(turn));
                [0, 1].map(|i| at[i] + corner_radius * ((1.0 - sin) * a[i] + (1.0 - cos) * b[i]))
            })
        };
        (0..count).flat_map(round).collect()
    }

    /// The radius and the centres of the round corners of a rectangle.
    fn round_corners(&self) -> Vec<(f64, Point)> {
        let Shape::Rectangle { size, angle, corner_radius } = self.shape else { return Vec::new() };
        // the corners of a smaller rectangle, along the same sides
        let size = size.map(|side| side - 2.0 * corner_radius);
        let inner = Circle { shape: Shape::Rectangle { size, angle, corner_radius: 0.0 }, ..*self };
        match corner_radius > 0.0 {
            true => inner.corners().into_iter().map(|centre| (corner_radius, centre)).collect(),
            false => Vec::new(),
        }
    }

    /// The corners of a polygon, or of its sides, extended, in order; none of a circle.
    pub fn corners(&self) -> Vec<Point> {
        let at = |angle: f64, [x, y]: Point| {
            let (sin, cos) = (libm::sin(angle), libm::cos(angle));
            [self.centre[0] + cos * x - sin * y, self.centre[1] + sin * x + cos * y]
        };
        match self.shape {
            Shape::Round | Shape::Chamfer { .. } => Vec::new(),
            Shape::Regular { sides, angle } => {
                let of =
                    |k| at(angle + std::f64::consts::TAU * f64::from(k) / sides as f64, [self.radius, 0.0]);
                (0..sides as u32).map(of).collect()
            }
            Shape::Rectangle { size: [long, short], angle, .. } => {
                [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]
                    .map(|[x, y]| at(angle, [0.5 * x * long, 0.5 * y * short]))
                    .into()
            }
        }
    }

    /// The distance of the outline from the centre in a direction.
    pub fn reach(&self, towards: Point) -> f64 {
        let corners = self.outline();
        let of = |k: usize| {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            let across = [b[1] - a[1], a[0] - b[0]];
            let slope = across[0] * towards[0] + across[1] * towards[1];
            let away = across[0] * (a[0] - self.centre[0]) + across[1] * (a[1] - self.centre[1]);
            if slope * away > 0.0 { away / slope } else { f64::INFINITY }
        };
        (0..corners.len()).map(of).fold(self.radius, f64::min)
    }

    fn is_like(&self, other: &Circle, tolerance: f64) -> bool {
        let is_alike = match (self.shape, other.shape) {
            (Shape::Round, Shape::Round) => true,
            (Shape::Regular { sides: a, .. }, Shape::Regular { sides: b, .. }) => a == b,
            (
                Shape::Rectangle { size: a, corner_radius: r, .. },
                Shape::Rectangle { size: b, corner_radius: s, .. },
            ) => [a[0] - b[0], a[1] - b[1], r - s].iter().all(|difference| difference.abs() < tolerance),
            // their ends are found to the distance of the lines beside them
            (Shape::Chamfer { length: a, angle: r }, Shape::Chamfer { length: b, angle: s }) => {
                (a - b).abs() < 10.0 * tolerance && (r - s).abs() < 1e-3
            }
            _ => false,
        };
        let is_near = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() < tolerance,
            (None, None) => true,
            _ => false,
        };
        is_alike
            && (self.is_hole || !self.is_full, self.is_full)
                == (other.is_hole || !other.is_full, other.is_full)
            && (self.radius - other.radius).abs() < tolerance
            && is_near(self.depth, other.depth)
            && is_near(self.width, other.width)
    }
}

/// Groups circles of the same size, kind and depth, the largest first. `size` is that of the model; the texts have lengths to
/// `resolution`.
pub fn groups(circles: Vec<Circle>, size: f64, resolution: f64) -> Vec<Group> {
    let tolerance = 1e-7 * size;
    let distance = |a: Point, b: Point| libm::hypot(a[0] - b[0], a[1] - b[1]);
    let mut circles = with_slots(circles, tolerance);
    // their radius is in the text of the rectangle
    let round: Vec<(f64, Point)> = circles.iter().flat_map(Circle::round_corners).collect();
    circles.retain(|own| {
        let is_corner = |(radius, centre): &(f64, Point)| {
            (own.radius - radius).abs() < tolerance && distance(own.centre, *centre) < tolerance
        };
        own.is_full || !round.iter().any(is_corner)
    });
    let mut groups: Vec<Vec<Circle>> = Vec::new();
    for circle in circles {
        match groups.iter_mut().find(|group| group[0].is_like(&circle, tolerance)) {
            // one behind the other, as in both arms of a fork
            Some(group) if group.iter().any(|own| distance(own.centre, circle.centre) < tolerance) => {}
            Some(group) => group.push(circle),
            None => groups.push(vec![circle]),
        }
    }
    let centres: Vec<Point> = groups.iter().flatten().map(|circle| circle.centre).collect();
    let group = |circles: Vec<Circle>| {
        let is_at = |p: Point| centres.iter().any(|centre| distance(*centre, p) < tolerance);
        let ring = ring(&circles, tolerance).filter(|(centre, _)| circles.len() != 4 || is_at(*centre));
        let text = text(&circles, ring, resolution);
        Group { circles, text, ring }
    };
    groups.into_iter().map(group).collect()
}

/// The circles, with one slot in place of each pair of half circles that are its ends.
fn with_slots(mut circles: Vec<Circle>, tolerance: f64) -> Vec<Circle> {
    let mut k = 0;
    while k < circles.len() {
        let own = circles[k];
        let distance =
            |other: &Circle| libm::hypot(own.centre[0] - other.centre[0], own.centre[1] - other.centre[1]);
        // in a row of slots, the nearest end
        let pair = (k + 1..circles.len())
            .filter_map(|other| Some((other, own.slot(&circles[other], tolerance)?)))
            .min_by(|a, b| distance(&circles[a.0]).total_cmp(&distance(&circles[b.0])));
        if let Some((other, slot)) = pair {
            circles.remove(other);
            circles[k] = slot;
        }
        k += 1;
    }
    circles
}

/// The circle on which at least three circles lie at equal angles.
fn ring(circles: &[Circle], tolerance: f64) -> Option<(Point, f64)> {
    let count = circles.len();
    if count < 3 || !circles.iter().all(|circle| circle.is_full) {
        return None;
    }
    let mean = |k: usize| circles.iter().map(|circle| circle.centre[k]).sum::<f64>() / count as f64;
    let centre = [mean(0), mean(1)];
    let offsets = circles.iter().map(|circle| [circle.centre[0] - centre[0], circle.centre[1] - centre[1]]);
    let offsets: Vec<Point> = offsets.collect();
    let radius = libm::hypot(offsets[0][0], offsets[0][1]);
    let mut angles: Vec<f64> = offsets.iter().map(|p| libm::atan2(p[1], p[0])).collect();
    angles.sort_by(f64::total_cmp);
    let step = std::f64::consts::TAU / count as f64;
    let is_even =
        angles.iter().enumerate().all(|(k, angle)| (angle - angles[0] - step * k as f64).abs() < 1e-6);
    let is_round = offsets.iter().all(|p| (libm::hypot(p[0], p[1]) - radius).abs() < tolerance);
    (is_even && is_round && radius > tolerance).then_some((centre, radius))
}

/// The text of a group: number, diameter or radius, depth, and the circle on which they lie.
fn text(circles: &[Circle], ring: Option<(Point, f64)>, resolution: f64) -> String {
    let number = |value: f64| format_number(value, resolution);
    let first = &circles[0];
    let mut text = if circles.len() > 1 { format!("{}\u{d7} ", circles.len()) } else { String::new() };
    let (diameter, square) = (format!("\u{2300}{}", number(2.0 * first.radius)), "\u{25a1}");
    text += &match first.shape {
        Shape::Round if !first.is_full => format!("R{}", number(first.radius)),
        Shape::Round => diameter,
        Shape::Rectangle { size: [a, b], corner_radius, .. } if 2.0 * corner_radius > 0.999_999 * b => {
            format!("slot {} \u{d7} {}", number(b), number(a))
        }
        Shape::Chamfer { length, angle } => {
            format!("{} \u{d7} {}\u{b0}", number(length), format_number(angle, 0.01))
        }
        Shape::Rectangle { size: [a, b], .. } if number(a) == number(b) => format!("{square}{}", number(a)),
        Shape::Rectangle { size: [a, b], .. } => format!("{} \u{d7} {}", number(a), number(b)),
        Shape::Regular { sides, .. } => {
            let flats = number(2.0 * first.radius * libm::cos(std::f64::consts::PI / sides as f64));
            match sides {
                3 => format!("triangle in {diameter}"),
                4 => format!("{square}{}", number(first.radius * 2f64.sqrt())),
                5 => format!("pentagon in {diameter}"),
                6 => format!("hexagon {flats} across flats"),
                8 => format!("octagon {flats} across flats"),
                // round, as triangles
                _ => diameter,
            }
        }
    };
    if first.is_full && first.is_hole {
        text += &match (first.depth, first.width) {
            (Some(depth), _) => format!(" \u{d7} {} deep", number(depth)),
            (None, Some(width)) => format!(" \u{d7} {} wide", number(width)),
            (None, None) => " through".to_owned(),
        };
    }
    if let Shape::Rectangle { corner_radius, size: [_, b], .. } = first.shape
        && corner_radius > 0.0
        && 2.0 * corner_radius <= 0.999_999 * b
    {
        text += &format!(", R{}", number(corner_radius));
    }
    if let Some((_, radius)) = ring {
        text += &format!(" on \u{2300}{}", number(2.0 * radius));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(centre: Point, radius: f64, depth: Option<f64>) -> Circle {
        let (arc, is_through) = (None, depth.is_none());
        Circle {
            shape: Shape::Round,
            centre,
            radius,
            is_hole: true,
            is_full: true,
            arc,
            is_through,
            depth,
            width: None,
        }
    }

    /// Arrows end on arcs: from outside, or from inside through the centre.
    #[test]
    fn arrows_end_on_arcs() {
        let diagonal = 0.5f64.sqrt();
        let fillet = Circle {
            is_full: false,
            arc: Some(([-diagonal, -diagonal], std::f64::consts::FRAC_PI_4)),
            ..circle([18.0, 11.0], 3.0, None)
        };
        for (towards, tip) in [
            ([diagonal, diagonal], [-diagonal, -diagonal]),
            ([-diagonal, -diagonal], [-diagonal, -diagonal]),
            ([1.0, 0.0], [-diagonal, -diagonal]),
            ([0.8, 0.6], [-0.8, -0.6]),
            ([-0.6, 0.8], [-diagonal, -diagonal]),
        ] {
            assert_eq!(fillet.tip(towards), tip, "{towards:?}");
        }
        assert_eq!(circle([0.0; 2], 3.0, None).tip([0.6, 0.8]), [0.6, 0.8]);
    }

    #[test]
    fn half_circles_that_face_away_are_a_slot() {
        let end = |x: f64, out: f64| Circle {
            is_full: false,
            arc: Some(([out, 0.0], std::f64::consts::FRAC_PI_2)),
            ..circle([x, 5.0], 2.75, None)
        };
        // two slots in a row: the ends of one are nearer than those of neighbours
        let row = [end(-25.0, -1.0), end(25.0, 1.0), end(-23.0, 1.0), end(23.0, -1.0)];
        assert_eq!(texts(&row), ["2\u{d7} slot 5.5 \u{d7} 7.5 through"]);
        let blind = row.map(|own| Circle { depth: Some(4.0), is_through: false, ..own });
        assert_eq!(texts(&blind), ["2\u{d7} slot 5.5 \u{d7} 7.5 \u{d7} 4 deep"]);
        // a waist, which narrows between both arcs
        assert_eq!(texts(&[end(-2.0, 1.0), end(2.0, -1.0)]), ["2\u{d7} R2.75"]);
    }

    fn texts(circles: &[Circle]) -> Vec<String> {
        groups(circles.to_vec(), 100.0, 1e-3).into_iter().map(|group| group.text).collect()
    }

    #[test]
    fn equal_circles_share_a_text() {
        let at = |angle: f64| [47.5 * angle.to_radians().cos(), 47.5 * angle.to_radians().sin()];
        let ring: Vec<Circle> = (0..8).map(|k| circle(at(45.0 * f64::from(k) + 10.0), 4.5, None)).collect();
        assert_eq!(texts(&ring), ["8\u{d7} \u{2300}9 through on \u{2300}95"]);
        // without the last one they are not at equal angles
        assert_eq!(texts(&ring[..7]), ["7\u{d7} \u{2300}9 through"]);
        let square = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[x, y]| [20.0 * x, 20.0 * y]);
        let mut corners = square.map(|at| circle(at, 3.3, Some(12.0))).to_vec();
        assert_eq!(texts(&corners), ["4\u{d7} \u{2300}6.6 \u{d7} 12 deep"]);
        corners.push(circle([0.0, 0.0], 10.0, None));
        let on = format!(
            "4\u{d7} \u{2300}6.6 \u{d7} 12 deep on \u{2300}{}",
            format_number(40.0 * 2f64.sqrt(), 1e-3)
        );
        assert_eq!(texts(&corners), [on.as_str(), "\u{2300}20 through"]);
        let round = Circle { is_hole: false, is_full: false, ..circle([0.0; 2], 5.0, None) };
        assert_eq!(texts(&[round, Circle { centre: [9.0, 0.0], is_hole: true, ..round }]), ["2\u{d7} R5"]);
        assert_eq!(texts(&[Circle { is_full: true, ..round }]), ["\u{2300}10"]);
    }

    /// The outline of a polygon is nearest to the centre at the middle of an edge, and farthest at a corner.
    #[test]
    fn polygons_have_their_sizes() {
        let hexagon =
            Circle { shape: Shape::Regular { sides: 6, angle: 0.0 }, ..circle([1.0, 2.0], 10.0, Some(5.0)) };
        let flats = format_number(10.0 * 3f64.sqrt(), 1e-3);
        assert_eq!(texts(&[hexagon]), [format!("hexagon {flats} across flats \u{d7} 5 deep")]);
        assert!((hexagon.reach([1.0, 0.0]) - 10.0).abs() < 1e-12);
        assert!((hexagon.reach([0.0, 1.0]) - 75f64.sqrt()).abs() < 1e-12);
        let size = [20.0, 8.0];
        let slot = Circle {
            shape: Shape::Rectangle { size, angle: 0.0, corner_radius: 0.0 },
            radius: 116f64.sqrt(),
            ..hexagon
        };
        assert_eq!(
            texts(&[slot, Circle { depth: None, ..slot }]),
            ["20 \u{d7} 8 \u{d7} 5 deep", "20 \u{d7} 8 through"]
        );
        assert_eq!([slot.reach([1.0, 0.0]), slot.reach([0.0, -1.0])], [10.0, 4.0]);
        // the radius of the corners of a pocket is in its text, and other round edges have their own
        let pocket = Circle { shape: Shape::Rectangle { size, angle: 0.0, corner_radius: 3.0 }, ..slot };
        let edge = |centre| Circle { is_full: false, ..circle(centre, 3.0, None) };
        let edges = [[8.0, 3.0], [-6.0, 3.0], [-6.0, 1.0], [8.0, 1.0], [30.0, 0.0]].map(edge);
        assert_eq!(texts(&[&[pocket][..], &edges].concat()), ["20 \u{d7} 8 \u{d7} 5 deep, R3", "R3"]);
        let outline = pocket.outline();
        let of = |[x, y]: Point| libm::hypot((x - 1.0).abs().max(7.0) - 7.0, (y - 2.0).abs().max(1.0) - 1.0);
        assert!(outline.iter().all(|&at| (of(at) - 3.0).abs() < 1e-12), "{outline:?}");
        let facets = Circle { shape: Shape::Regular { sides: 30, angle: 0.2 }, ..hexagon };
        assert_eq!(texts(&[facets]), ["\u{2300}20 \u{d7} 5 deep"]);
    }

    #[test]
    fn holes_one_behind_the_other_count_once() {
        assert_eq!(texts(&[circle([1.0, 2.0], 3.0, None); 2]), ["\u{2300}6 through"]);
    }
}
