//! Test regions with integer vertices, and oracles in integer arithmetic.
#![allow(dead_code)]

use rand::{RngExt, rngs::ChaCha8Rng, seq::SliceRandom};
use rayweave_polygon::{Point, PolygonError, Polygons, from_polygons};
use rayweave_rootray::Side;

pub type Lattice = [i64; 2];
pub type Contours = Vec<Vec<Lattice>>;

pub fn points(contour: &[Lattice]) -> Vec<Point> {
    contour.iter().map(|p| p.map(|x| x as f64)).collect()
}

pub fn region(contours: &[Vec<Lattice>], outside: Side) -> Result<Polygons, PolygonError> {
    let contours: Vec<_> = contours.iter().map(|c| points(c)).collect();
    from_polygons(&contours, outside)
}

pub fn cross(a: Lattice, b: Lattice, c: Lattice) -> i128 {
    let d = |p: i64, q: i64| i128::from(p) - i128::from(q);
    d(b[0], a[0]) * d(c[1], a[1]) - d(b[1], a[1]) * d(c[0], a[0])
}

pub fn edges(contour: &[Lattice]) -> impl Iterator<Item = (Lattice, Lattice)> + Clone {
    let n = contour.len();
    (0..n).map(move |k| (contour[k], contour[(k + 1) % n]))
}

/// Containment by the even-odd rule: crossings of the ray towards +x with all given edges, in integers. `None` on an edge.
pub fn is_inside(contours: &[Vec<Lattice>], scale: i64, outside: Side, p: Lattice) -> Option<bool> {
    let mut inside = outside.is_inside();
    for (a, b) in contours.iter().flat_map(|c| edges(c)) {
        let (a, b) = (a.map(|x| x * scale), b.map(|x| x * scale));
        let turn = cross(a, b, p);
        let between = |k: usize| a[k].min(b[k]) <= p[k] && p[k] <= a[k].max(b[k]);
        if turn == 0 && between(0) && between(1) {
            return None;
        }
        if (a[1] > p[1]) != (b[1] > p[1]) && (turn > 0) == (b[1] > a[1]) {
            inside = !inside;
        }
    }
    Some(inside)
}

/// True if two closed segments have a common point.
pub fn intersect((a, b): (Lattice, Lattice), (c, d): (Lattice, Lattice)) -> bool {
    let signs = |p, q, r, s| (cross(p, q, r).signum(), cross(p, q, s).signum());
    let ((s1, s2), (s3, s4)) = (signs(a, b, c, d), signs(c, d, a, b));
    let overlap = |k: usize| a[k].min(b[k]) <= c[k].max(d[k]) && c[k].min(d[k]) <= a[k].max(b[k]);
    s1 * s2 <= 0 && s3 * s4 <= 0 && overlap(0) && overlap(1)
}

/// True if no two edges except neighbours touch; tests all pairs.
pub fn is_clear(contours: &[Vec<Lattice>]) -> bool {
    let all: Vec<_> = contours
        .iter()
        .enumerate()
        .flat_map(|(c, contour)| edges(contour).enumerate().map(move |(k, edge)| (c, k, contour.len(), edge)))
        .collect();
    let apart = |&(c, k, n, e): &(usize, usize, usize, _), &(d, l, _, f): &(usize, usize, usize, _)| {
        let neighbours = c == d && ((k + 1) % n == l || (l + 1) % n == k);
        neighbours || !intersect(e, f)
    };
    (0..all.len()).all(|i| (0..i).all(|j| apart(&all[i], &all[j])))
}

pub fn random_contour(rng: &mut ChaCha8Rng, n: usize, size: i64) -> Vec<Lattice> {
    (0..n).map(|_| [0, 1].map(|_| rng.random_range(-size..=size))).collect()
}

/// A simple counter-clockwise polygon through random lattice points. Crossings are removed by reversing the path between them
/// (2-opt), which shortens the polygon and therefore terminates.
pub fn random_simple(rng: &mut ChaCha8Rng, n: usize, size: i64) -> Vec<Lattice> {
    loop {
        let mut points = random_contour(rng, n, size);
        points.sort();
        points.dedup();
        points.shuffle(rng);
        let n = points.len();
        for _ in 0..200 {
            let proper = |k: usize, l: usize| {
                let (a, b, c, d) = (points[k], points[k + 1], points[l], points[(l + 1) % n]);
                cross(a, b, c).signum() * cross(a, b, d).signum() < 0
                    && cross(c, d, a).signum() * cross(c, d, b).signum() < 0
            };
            let crossing =
                (0..n - 1).flat_map(|k| (k + 2..n).map(move |l| (k, l))).find(|&(k, l)| proper(k, l));
            match crossing {
                Some((k, l)) => points[k + 1..=l].reverse(),
                None => break,
            }
        }
        let corners = corners(&points);
        if corners.len() >= 3 && is_clear(std::slice::from_ref(&corners)) {
            return counter_clockwise(corners);
        }
    }
}

/// The corners of a closed contour, in integers: removes vertices without a turn one by one.
pub fn corners(contour: &[Lattice]) -> Vec<Lattice> {
    let mut kept = contour.to_vec();
    let is_corner = |kept: &[Lattice], k: usize| {
        let n = kept.len();
        cross(kept[(k + n - 1) % n], kept[k], kept[(k + 1) % n]) != 0
    };
    while let Some(k) = (0..kept.len()).find(|&k| !is_corner(&kept, k)) {
        kept.remove(k);
    }
    kept
}

pub fn counter_clockwise(mut contour: Vec<Lattice>) -> Vec<Lattice> {
    let area: i128 = edges(&contour).map(|(a, b)| cross([0, 0], a, b)).sum();
    if area < 0 {
        contour.reverse();
    }
    contour
}

/// The contour with spikes, repeated vertices and collinear vertices at random places, which do not change the area.
pub fn with_redundant_vertices(rng: &mut ChaCha8Rng, contour: &[Lattice]) -> Vec<Lattice> {
    let mut out = Vec::new();
    for (a, b) in edges(contour) {
        out.push(a);
        match rng.random_range(0..6) {
            0 => out.push(a),
            1 => out.extend([random_contour(rng, 1, 20)[0], a]),
            2 => out.extend([[2 * b[0] - a[0], 2 * b[1] - a[1]], b]),
            3 if (b[0] - a[0]) % 2 == 0 && (b[1] - a[1]) % 2 == 0 => {
                out.push([(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]);
            }
            _ => {}
        }
    }
    out
}

pub fn square(half: i64) -> Vec<Lattice> {
    vec![[-half, -half], [half, -half], [half, half], [-half, half]]
}

pub fn comb(teeth: i64) -> Vec<Lattice> {
    let mut contour = vec![[2 * teeth - 1, 0], [2 * teeth - 1, 8]];
    for k in (0..teeth - 1).rev() {
        contour.extend([[2 * k + 2, 8], [2 * k + 2, 2], [2 * k + 1, 2], [2 * k + 1, 8]]);
    }
    contour.extend([[0, 8], [0, 0]]);
    contour
}

pub fn spiral(turns: i64) -> Vec<Lattice> {
    let mut inward = vec![[0, 0]];
    let (mut at, mut length) = ([0, 0], 4 * turns);
    for k in 0..4 * turns {
        let step = [[length, 0], [0, length], [-length, 0], [0, -length]][(k % 4) as usize];
        at = [at[0] + step[0], at[1] + step[1]];
        inward.push(at);
        length -= k % 2;
        if length < 2 {
            break;
        }
    }
    // back along the same path, one unit to the inside: the wall of the spiral
    let n = inward.len();
    let inner = (1..n - 1).map(|k| {
        let (a, b, c) = (inward[k - 1], inward[k], inward[k + 1]);
        let unit = |p: Lattice, q: Lattice| [(q[0] - p[0]).signum(), (q[1] - p[1]).signum()];
        let (u, v) = (unit(a, b), unit(b, c));
        [3 * b[0] - u[0] + v[0], 3 * b[1] - u[1] + v[1]]
    });
    let inner: Vec<Lattice> = inner.rev().collect();
    let mut contour: Vec<Lattice> = inward[..n - 1].iter().map(|p| p.map(|x| 3 * x)).collect();
    contour.extend(inner);
    contour.push([1, 1]);
    contour
}

pub fn star(points: usize) -> Vec<Lattice> {
    (0..2 * points)
        .map(|k| {
            let radius = if k % 2 == 0 { 32.0 } else { 7.0 };
            let (sin, cos) = rayweave_math::sin_cos_degrees(180.0 * k as f64 / points as f64);
            [(radius * cos).round() as i64, (radius * sin).round() as i64]
        })
        .collect()
}

/// Test regions of many kinds with their outside, some with contours without area.
pub fn regions(rng: &mut ChaCha8Rng) -> Vec<(Contours, Side)> {
    let rings = |first: bool| {
        let ring = |k: i64| {
            let mut ring = square(20 - 3 * k);
            if (k % 2 == 1) == first {
                ring.reverse();
            }
            ring
        };
        (0..6).map(ring).collect::<Contours>()
    };
    let mut all = vec![
        (vec![], Side::Outside),
        (vec![], Side::Inside),
        (vec![vec![[3, 4]], vec![[0, 0], [5, 5]]], Side::Outside),
        (vec![square(8)], Side::Outside),
        (rings(true), Side::Outside),
        (rings(false), Side::Inside),
        (vec![comb(6)], Side::Outside),
        (vec![spiral(3)], Side::Outside),
        (vec![star(5)], Side::Outside),
        (vec![star(12)], Side::Outside),
        (vec![vec![[0, 0], [9, 3], [2, 1]], vec![[20, 0], [28, 0], [24, 9]]], Side::Outside),
    ];
    for n in [3, 4, 5, 6, 8, 12, 20] {
        for size in [3, 5, 16] {
            let simple = random_simple(rng, n, size);
            let mut hole = simple.clone();
            hole.reverse();
            all.push((vec![simple.clone()], Side::Outside));
            all.push((vec![hole.clone()], Side::Inside));
            // a hole in a frame, with a separate island
            let frame = vec![square(40), hole, vec![[50, 50], [60, 50], [60, 60]]];
            all.push((frame, Side::Outside));
            all.push((vec![with_redundant_vertices(rng, &simple)], Side::Outside));
        }
    }
    all
}

/// Lines through lattice points, through two vertices (so along edges), and along the axes.
pub fn lines(rng: &mut ChaCha8Rng, contours: &Contours) -> Vec<(Lattice, Lattice)> {
    let vertices: Vec<Lattice> = contours.iter().flatten().copied().collect();
    let mut all = Vec::new();
    for k in 0..90 {
        let (p, mut q) = match (vertices.len(), k % 3) {
            (0, _) | (_, 0) => (random_contour(rng, 1, 30)[0], random_contour(rng, 1, 30)[0]),
            (n, _) => (vertices[rng.random_range(0..n)], vertices[rng.random_range(0..n)]),
        };
        if k % 5 == 0 {
            q[k / 5 % 2] = p[k / 5 % 2];
        }
        if p != q {
            all.push((p, q));
        }
    }
    all
}
