//! Simplification of polylines.

/// The points of a polyline that suffice to stay within a tolerance of it, its ends included (D. H. Douglas
/// and T. K. Peucker, *Cartographica* 10, 2, 1973).
pub fn line(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut is_kept = vec![false; points.len()];
    (is_kept[0], is_kept[last]) = (true, true);
    let mut pieces = Vec::new();
    let mut from = 0;
    for [begin, end] in straight_runs(points, tolerance) {
        (is_kept[begin], is_kept[end]) = (true, true);
        pieces.push((from, begin));
        from = end;
    }
    pieces.push((from, last));
    while let Some((from, to)) = pieces.pop() {
        let off = |k: usize| distance(points[k], points[from], points[to]);
        let farthest = (from + 1..to).max_by(|&a, &b| off(a).total_cmp(&off(b)));
        if let Some(k) = farthest.filter(|&k| off(k) > tolerance) {
            is_kept[k] = true;
            pieces.extend([(from, k), (k, to)]);
        }
    }
    points.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept).map(|(point, _)| *point).collect()
}

/// The length of a straight run in tolerances, and the largest distance of its points from a line through its begin. An arc as long
/// as such a run is straight within this distance only if its radius is half a billion times the tolerance.
const LONG: f64 = 20.0;
const STRAIGHT: f64 = 1e-7;

/// The begins and ends of the long straight runs of a polyline, in order. Without them a piece from a straight edge to an adjacent
/// arc could replace both, within the tolerance but not straight.
fn straight_runs(points: &[[f64; 2]], tolerance: f64) -> Vec<[usize; 2]> {
    let (mut runs, mut begin) = (Vec::new(), 0);
    while begin + 2 < points.len() {
        let end = straight_until(&points[begin..], STRAIGHT * tolerance) + begin;
        let [a, b] = [points[begin], points[end]];
        if end >= begin + 2 && libm::hypot(b[0] - a[0], b[1] - a[1]) >= LONG * tolerance {
            runs.push([begin, end]);
            begin = end;
        } else {
            begin += 1;
        }
    }
    runs
}

/// The last of the first points that lie within a distance of a half line from the first point, in order along it.
fn straight_until(points: &[[f64; 2]], width: f64) -> usize {
    let a = points[0];
    // the half line, as the direction to a point, and the slopes against it that pass all points so far
    let (mut axis, mut slopes) = (None, [f64::NEG_INFINITY, f64::INFINITY]);
    let mut last = 0.0;
    for (k, p) in points.iter().enumerate().skip(1) {
        let d = [p[0] - a[0], p[1] - a[1]];
        let length = libm::hypot(d[0], d[1]);
        if length <= width {
            continue;
        }
        let [x, y]: [f64; 2] = *axis.get_or_insert([d[0] / length, d[1] / length]);
        let (along, off) = (d[0] * x + d[1] * y, d[1] * x - d[0] * y);
        let [lo, hi] = [(off - width) / along, (off + width) / along];
        if along <= last || lo > slopes[1] || hi < slopes[0] {
            return k - 1;
        }
        slopes = [slopes[0].max(lo), slopes[1].min(hi)];
        last = along;
    }
    points.len() - 1
}

/// The distance of a point from a segment.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, off) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = along[0] * along[0] + along[1] * along[1];
    let part = if square > 0.0 { (along[0] * off[0] + along[1] * off[1]) / square } else { 0.0 };
    let part = part.clamp(0.0, 1.0);
    libm::hypot(off[0] - part * along[0], off[1] - part * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_stay_and_points_between_go() {
        let path = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.05], [3.0, 0.0], [3.0, 1.0], [3.0, 2.0]];
        assert_eq!(line(&path, 0.1), [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0]]);
        assert_eq!(line(&path, 0.01), [path[0], path[1], path[2], path[3], path[5]]);
        assert_eq!(line(&path[..1], 1.0), [[0.0, 0.0]]);
        assert!(line(&[], 1.0).is_empty());
    }

    /// A straight edge with a fillet and another straight edge: the tangent points are kept, so that both edges are exact.
    #[test]
    fn straight_edges_keep_their_ends() {
        let line_in = (0..=100).map(|k| [-10.0 + 0.1 * f64::from(k), 0.3]);
        let arc = (1..200).map(|k| f64::from(k) * 0.005).map(|a| [a.sin(), 1.3 - a.cos()]);
        let end = |s: f64| [1.0f64.sin() + s * 1.0f64.cos(), 1.3 - 1.0f64.cos() + s * 1.0f64.sin()];
        let line_out = (0..=90).map(|k| end(0.1 * f64::from(k)));
        let path: Vec<[f64; 2]> = line_in.chain(arc).chain(line_out).collect();
        let found = line(&path, 1e-3);
        assert_eq!(found[..2], [[-10.0, 0.3], [0.0, 0.3]]);
        assert_eq!(found[found.len() - 2..], [end(0.0), end(9.0)]);
        assert!(found.len() < 30, "{}", found.len());
    }

    #[test]
    fn an_arc_keeps_to_its_tolerance() {
        let arc: Vec<[f64; 2]> =
            (0..=1000).map(|k| f64::from(k) * 1e-3).map(|a| [a.cos(), a.sin()]).collect();
        let short = line(&arc, 1e-4);
        // a chord of angle a stays within 1 - cos(a / 2) of the arc
        assert!(short.len() > 30 && short.len() < 80, "{}", short.len());
        let worst = short.windows(2).map(|p| 1.0 - 0.5 * (p[0][0] + p[1][0]).hypot(p[0][1] + p[1][1]));
        assert!(worst.fold(0.0, f64::max) < 1.01e-4);
    }
}
