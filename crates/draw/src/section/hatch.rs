//! Hatching of cut faces (ISO 128-50): thin parallel lines at 45 degrees, in another direction or at another distance for each part.

/// The distance between the lines of the first parts, in pixels.
const SPACING: f64 = 8.0;

/// The directions and relative distances of the first parts; further ones repeat them.
const STYLES: [(bool, f64); 6] =
    [(true, 1.0), (false, 1.0), (true, 0.6), (false, 0.6), (true, 1.6), (false, 1.6)];

/// The hatching of part `number` within closed contours, by the even-odd rule, as an SVG path. Lengths are in pixels, y down.
pub(super) fn path(contours: &[Vec<[f64; 2]>], number: usize) -> String {
    let (rises, factor) = STYLES[number % STYLES.len()];
    let spacing = SPACING * factor;
    // the line through p is the one with this number; both coordinates are times the square root of 2
    let side = |p: [f64; 2]| if rises { p[0] + p[1] } else { p[0] - p[1] };
    let along = |p: [f64; 2]| if rises { p[0] - p[1] } else { p[0] + p[1] };
    let step = spacing * std::f64::consts::SQRT_2;
    let mut hits: Vec<(i64, f64)> = Vec::new();
    for contour in contours {
        for (a, b) in contour.iter().zip(contour.iter().cycle().skip(1)) {
            let (from, to) = (side(*a), side(*b));
            if !(from.is_finite() && to.is_finite()) {
                return String::new();
            }
            // half-open: a line through a corner meets one of the two edges
            let [first, last] = [from.min(to), from.max(to)].map(|x| (x / step).ceil() as i64);
            for line in first..last {
                let t = (line as f64 * step - from) / (to - from);
                hits.push((line, along(*a) + t * (along(*b) - along(*a))));
            }
        }
    }
    hits.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let point = |line: i64, u: f64| {
        let s = line as f64 * step;
        let [x, y] = if rises { [0.5 * (s + u), 0.5 * (s - u)] } else { [0.5 * (s + u), 0.5 * (u - s)] };
        format!("{:.2} {:.2}", x, y)
    };
    let pairs = hits.chunks_exact(2).filter(|pair| pair[0].0 == pair[1].0);
    pairs.map(|pair| format!("M{}L{}", point(pair[0].0, pair[0].1), point(pair[1].0, pair[1].1))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ends of the lines of a path.
    fn lines(path: &str) -> Vec<[[f64; 2]; 2]> {
        let point = |text: &str| {
            let (x, y) = text.split_once(' ').unwrap();
            [x.parse().unwrap(), y.parse().unwrap()]
        };
        let line = |text: &str| {
            let (a, b) = text.split_once('L').unwrap();
            [point(a), point(b)]
        };
        path.split('M').skip(1).map(line).collect()
    }

    #[test]
    fn lines_are_parallel_and_end_at_the_contour() {
        let square = vec![[3.0, 5.0], [103.0, 5.0], [103.0, 105.0], [3.0, 105.0]];
        let hole = vec![[33.0, 35.0], [73.0, 35.0], [73.0, 75.0], [33.0, 75.0]];
        for number in 0..6 {
            let found = lines(&path(&[square.clone(), hole.clone()], number));
            let (rises, factor) = STYLES[number];
            let mut length = 0.0;
            for [a, b] in &found {
                let (x, y) = (b[0] - a[0], b[1] - a[1]);
                assert!((if rises { x + y } else { x - y }).abs() < 0.03, "{a:?} {b:?}");
                length += x.hypot(y);
                let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
                assert!(
                    !(33.5..72.5).contains(&middle[0]) || !(35.5..74.5).contains(&middle[1]),
                    "{middle:?}"
                );
            }
            // the lines cover the area: 100^2 - 40^2 = spacing * length, to the error of the first and last line
            let area = length * SPACING * factor;
            assert!((area - 8400.0).abs() < 0.05 * 8400.0, "{number}: {area}");
        }
        assert_eq!(path(&[vec![[0.0, 0.0], [f64::NAN, 1.0], [2.0, 2.0]]], 0), "");
    }
}
