//! Simplification of polylines.

/// The points of a polyline that suffice to stay within a tolerance of it, its ends included (D. H. Douglas
/// and T. K. Peucker, *Cartographica* 10, 2, 1973).
pub fn line(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut is_kept = vec![false; points.len()];
    (is_kept[0], is_kept[last]) = (true, true);
    let mut pieces = vec![(0, last)];
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
