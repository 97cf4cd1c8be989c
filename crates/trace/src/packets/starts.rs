//! Start surfaces of ray bundles. Lanes handle rays that start on at most one surface; the weave traces the
//! others.

use super::group::Row;
use rayweave_model::{PlacementId, Query, Start, SurfaceId};
use rayweave_shape::lanes::LANES;

/// The starts of eight rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Begin {
    /// The numbers of the start surfaces; -1 for none.
    pub surface: Row,
    /// Bit mask of the rays with f < 0 just after the start.
    pub inside: u64,
    /// The lower bounds of the rays' intervals of t.
    pub from: Row,
    /// The upper bound for all rays.
    pub t_max: f64,
    /// Bit mask of the rays that start on several surfaces or on a placed one.
    pub uncertain: u64,
}

impl Begin {
    /// The starts of the rays `at..at + count` of a batch; the remaining lanes are arbitrary.
    pub fn new(query: &Query<'_>, at: usize, count: usize) -> Begin {
        let window = query.window;
        let mut begin = Begin {
            surface: Row([-1.0; LANES]),
            inside: 0,
            from: Row([window.t_min(); LANES]),
            t_max: window.t_max(),
            uncertain: 0,
        };
        let Some(lists) = query.starts else { return begin };
        for lane in 0..count.min(LANES) {
            let list = lists.of(at + lane);
            if list.is_empty() {
                continue;
            }
            if window.t_min() <= 0.0 {
                // t = 0 is included: see `Query::is_past`
                begin.from.0[lane] = -f64::from_bits(1);
            }
            match *list {
                [Start { surface: SurfaceId(surface), placement: PlacementId(0), inside }] => {
                    begin.surface.0[lane] = f64::from(surface);
                    begin.inside |= u64::from(inside) << lane;
                }
                _ => begin.uncertain |= 1 << lane,
            }
        }
        begin
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_model::{StartLists, Window};

    #[test]
    fn rays_begin_where_their_lists_say() {
        let start =
            |surface, inside| Start { surface: SurfaceId(surface), placement: PlacementId(0), inside };
        let entries = [start(7, true), start(1, true), start(2, false), start(3, false)];
        let starts = Some(StartLists { first: &[0, 0, 0, 1, 3, 4], entries: &entries });
        let window = Window::new(-1.0, 5.0).unwrap();
        let begin = Begin::new(&Query { window, starts, ..Query::nearest() }, 1, 4);
        assert_eq!(begin.surface.0[..5], [-1.0, 7.0, -1.0, 3.0, -1.0]);
        assert_eq!((begin.inside, begin.uncertain, begin.t_max), (0b10, 0b100, 5.0));
        assert_eq!(begin.from.0[0], -1.0);
        assert!(begin.from.0[1] < 0.0 && begin.from.0[1].next_up() == 0.0);
        let later = Window::new(2.0, 5.0).unwrap();
        let begin = Begin::new(&Query { window: later, starts, ..Query::nearest() }, 1, 4);
        assert_eq!(begin.from.0, [2.0; LANES]);
    }
}
