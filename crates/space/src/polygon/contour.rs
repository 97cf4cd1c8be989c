//! What remains of a contour: its corners, without anything of no area.

use super::exact::turn;
use crate::Point;
use std::collections::VecDeque;

/// A vertex with its number in the contour that was given.
pub type Corner = (Point<2>, usize);

/// The corners of a closed contour, in its order: no two neighbours are equal, no three in a line.
///
/// Repeated vertices, vertices on a straight run and ways there and back vanish, and a contour of nothing else
/// (a point, a segment, a tree of segments) vanishes as a whole. What is taken away has no area exactly: turns
/// are decided without rounding. O(n).
pub fn corners(contour: impl IntoIterator<Item = Point<2>>) -> VecDeque<Corner> {
    let mut kept: VecDeque<Corner> = VecDeque::new();
    for (number, point) in contour.into_iter().enumerate() {
        while needs_no_back(&kept, point) {
            kept.pop_back();
        }
        if kept.back().is_none_or(|last| last.0 != point) {
            kept.push_back((point, number));
        }
    }
    close(&mut kept);
    if kept.len() < 3 { VecDeque::new() } else { kept }
}

/// True if the last corner is none on the way on to `next`.
fn needs_no_back(kept: &VecDeque<Corner>, next: Point<2>) -> bool {
    let n = kept.len();
    n >= 2 && kept[n - 1].0 != next && turn(kept[n - 2].0, kept[n - 1].0, next) == 0
}

/// The same where the end meets the beginning.
fn close(kept: &mut VecDeque<Corner>) {
    while let Some((&(first, _), &(last, _))) = kept.front().zip(kept.back())
        && kept.len() >= 2
    {
        let n = kept.len();
        if first == last || turn(kept[n - 2].0, last, first) == 0 {
            kept.pop_back();
        } else if turn(last, first, kept[1].0) == 0 {
            kept.pop_front();
        } else {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(contour: &[Point<2>]) -> Vec<usize> {
        corners(contour.iter().copied()).into_iter().map(|(_, number)| number).collect()
    }

    #[test]
    fn nothing_of_no_area_remains() {
        let none: [&[Point<2>]; 8] = [
            &[],
            &[[1.0, 2.0]],
            &[[1.0, 2.0], [1.0, 2.0], [1.0, 2.0]],
            &[[0.0, 0.0], [3.0, 1.0]],
            &[[0.0, 0.0], [3.0, 1.0], [0.0, 0.0]],
            &[[0.0, 0.0], [6.0, 2.0], [3.0, 1.0], [9.0, 3.0]],
            // a bent way there and back, divided differently on the way back
            &[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [4.0, 2.0], [4.0, 0.0], [1.0, 0.0]],
            // a tree
            &[[0.0, 0.0], [2.0, 0.0], [3.0, 1.0], [2.0, 0.0], [3.0, -1.0], [2.0, 0.0]],
        ];
        for contour in none {
            assert_eq!(numbers(contour), [0; 0], "{contour:?}");
        }
    }

    #[test]
    fn corners_remain_whatever_is_added() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        assert_eq!(numbers(&square), [0, 1, 2, 3]);
        // closed by its first vertex, with repeated vertices, a vertex on an edge, and spikes out and in
        let dressed = [
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
        let points: Vec<Point<2>> = corners(dressed).into_iter().map(|(point, _)| point).collect();
        assert_eq!(points, [[4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]]);
    }

    #[test]
    fn every_rotation_and_the_reverse_leave_the_same_corners() {
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
            let mut turned = contour;
            turned.rotate_left(by);
            for reversed in [false, true] {
                if reversed {
                    turned.reverse();
                }
                let mut points: Vec<[i32; 2]> =
                    corners(turned).into_iter().map(|(p, _)| p.map(|x| x as i32)).collect();
                points.sort();
                assert_eq!(points, [[0, 0], [0, 5], [5, 0], [5, 5]], "{by} {reversed}");
            }
        }
    }
}
