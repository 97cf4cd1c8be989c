//! Contour simplification: removal of repeated vertices, collinear vertices and spikes.

use crate::Point;
use crate::exact::orientation;
use std::collections::VecDeque;

/// A vertex with its index in the given contour.
pub type Corner = (Point, usize);

/// The corners of a closed contour, in its order: no two neighbours are equal, no three are collinear.
///
/// Removes repeated vertices, collinear vertices and spikes. A contour without area (a point, a segment, a tree of segments)
/// has no corners. Removed parts have no area exactly, since orientations are exact. Takes O(n) time.
pub fn corners(contour: impl IntoIterator<Item = Point>) -> VecDeque<Corner> {
    let mut kept: VecDeque<Corner> = VecDeque::new();
    for (number, point) in contour.into_iter().enumerate() {
        while last_is_redundant(&kept, point) {
            kept.pop_back();
        }
        if kept.back().is_none_or(|last| last.0 != point) {
            kept.push_back((point, number));
        }
    }
    close(&mut kept);
    if kept.len() < 3 { VecDeque::new() } else { kept }
}

/// True if the last corner is redundant before `next`.
fn last_is_redundant(kept: &VecDeque<Corner>, next: Point) -> bool {
    let n = kept.len();
    n >= 2 && kept[n - 1].0 != next && orientation(kept[n - 2].0, kept[n - 1].0, next) == 0
}

/// Removes redundant corners at the seam between end and beginning.
fn close(kept: &mut VecDeque<Corner>) {
    while let Some((&(first, _), &(last, _))) = kept.front().zip(kept.back())
        && kept.len() >= 2
    {
        let n = kept.len();
        if first == last || orientation(kept[n - 2].0, last, first) == 0 {
            kept.pop_back();
        } else if orientation(last, first, kept[1].0) == 0 {
            kept.pop_front();
        } else {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(contour: &[Point]) -> Vec<usize> {
        corners(contour.iter().copied()).into_iter().map(|(_, number)| number).collect()
    }

    #[test]
    fn contours_without_area_have_no_corners() {
        let none: [&[Point]; 8] = [
            &[],
            &[[1.0, 2.0]],
            &[[1.0, 2.0], [1.0, 2.0], [1.0, 2.0]],
            &[[0.0, 0.0], [3.0, 1.0]],
            &[[0.0, 0.0], [3.0, 1.0], [0.0, 0.0]],
            &[[0.0, 0.0], [6.0, 2.0], [3.0, 1.0], [9.0, 3.0]],
            // a bent path and back, subdivided differently on the way back
            &[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [4.0, 2.0], [4.0, 0.0], [1.0, 0.0]],
            // a tree
            &[[0.0, 0.0], [2.0, 0.0], [3.0, 1.0], [2.0, 0.0], [3.0, -1.0], [2.0, 0.0]],
        ];
        for contour in none {
            assert_eq!(numbers(contour), [0; 0], "{contour:?}");
        }
    }

    #[test]
    fn redundant_vertices_are_removed() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        assert_eq!(numbers(&square), [0, 1, 2, 3]);
        // the first vertex again at the end, repeated vertices, a vertex on an edge, and spikes outward and inward
        let redundant = [
            [2.0, 0.0],
            [2.0, 0.0],
            [3.0, 0.0],
            [3.0, -7.0],
            [3.0, 0.0],
            [4.0, 0.0],
            [4.0, 0.0],
            [4.0, 9.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [2.0, 2.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [2.0, 0.0],
        ];
        let points: Vec<Point> = corners(redundant).into_iter().map(|(point, _)| point).collect();
        assert_eq!(points, [[4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]]);
    }

    #[test]
    fn rotations_and_the_reverse_have_the_same_corners() {
        let contour = [
            [0.0, 0.0],
            [5.0, 0.0],
            [9.0, 0.0],
            [5.0, 0.0],
            [5.0, 2.5],
            [5.0, 5.0],
            [5.0, 5.0],
            [0.0, 5.0],
            [-3.0, 8.0],
            [0.0, 5.0],
        ];
        for by in 0..contour.len() {
            let mut rotated = contour;
            rotated.rotate_left(by);
            for reversed in [false, true] {
                if reversed {
                    rotated.reverse();
                }
                let mut points: Vec<[i32; 2]> =
                    corners(rotated).into_iter().map(|(p, _)| p.map(|x| x as i32)).collect();
                points.sort();
                assert_eq!(points, [[0, 0], [0, 5], [5, 0], [5, 5]], "{by} {reversed}");
            }
        }
    }
}
