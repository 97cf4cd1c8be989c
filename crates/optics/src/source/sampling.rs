//! Sampling of an area or of directions: grid, hexapolar, Fibonacci, random.

use super::SourceError;
use super::random::Numbers;
use rayweave_error::Message;
use rayweave_math::unit_fraction;

/// Sampling of an area or of directions. Each ray represents an equal part, except for the weights
/// of hexapolar sampling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// The centres of `columns` x `rows` equal cells; over a disc by the concentric map (P. Shirley
    /// and K. Chiu, *A low distortion map between disk and square*, 1997).
    Grid {
        /// The number of cells along x.
        columns: u32,
        /// The number of cells along y.
        rows: u32,
    },
    /// The centre and rings of 6, 12, 18, ... rays, the last on the rim: `3 rings (rings + 1) + 1`
    /// rays. The weight of the rays of a ring is the area nearer to it than to other rings. Only
    /// for discs and cones.
    Hexapolar {
        /// The number of rings.
        rings: u32,
    },
    /// A Fibonacci lattice; over a disc Vogel's spiral (H. Vogel, *A better way to construct the
    /// sunflower head*, 1979).
    Fibonacci {
        /// The number of rays.
        count: u64,
    },
    /// Random points.
    Random {
        /// The number of rays.
        count: u64,
    },
}

/// A point of a disc of area 1, or of any set of directions about an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// The fraction of the area that is nearer to the centre.
    pub area: f64,
    /// The azimuth in turns, from +x towards +y.
    pub turn: f64,
    /// The weight of the ray; 1 on average.
    pub weight: f64,
}

impl Sampling {
    /// The names of the kinds of sampling.
    pub const NAMES: [&str; 4] = ["fibonacci", "random", "grid", "hexapolar"];

    /// The sampling of this name with roughly `about` rays: those of the nearest square grid, or of
    /// the nearest number of rings. `None` for an unknown name.
    pub fn named(name: &str, about: u64) -> Option<Sampling> {
        let root = (about as f64).sqrt();
        match name {
            "fibonacci" => Some(Sampling::Fibonacci { count: about }),
            "random" => Some(Sampling::Random { count: about }),
            "grid" => {
                let side = root.round().max(1.0) as u32;
                Some(Sampling::Grid { columns: side, rows: side })
            }
            // 3 r (r + 1) + 1 rays
            "hexapolar" => Some(Sampling::Hexapolar { rings: (root / 3f64.sqrt()).round().max(1.0) as u32 }),
            _ => None,
        }
    }

    /// The number of rays.
    pub fn count(&self) -> u64 {
        match *self {
            Sampling::Grid { columns, rows } => u64::from(columns) * u64::from(rows),
            Sampling::Hexapolar { rings } => {
                let half = u64::from(rings) * (u64::from(rings) + 1);
                half.saturating_mul(3).saturating_add(1)
            }
            Sampling::Fibonacci { count } | Sampling::Random { count } => count,
        }
    }

    pub(super) fn is_random(&self) -> bool {
        matches!(self, Sampling::Random { .. })
    }

    /// Rejects hexapolar sampling, which cannot cover a rectangle.
    pub(super) fn checked_for_rectangle(&self, part: &'static str) -> Result<(), SourceError> {
        match self {
            Sampling::Hexapolar { .. } => {
                let problem = format!("{part} has hexapolar sampling of a rectangle");
                let message = Message::new(problem, "its rings are circles").suggest("Use a grid");
                Err(SourceError::Inconsistent(message))
            }
            _ => Ok(()),
        }
    }

    /// The point of ray `k` in the unit square.
    pub(super) fn in_square(&self, k: u64, numbers: &Numbers) -> [f64; 2] {
        match *self {
            Sampling::Grid { columns, .. } => {
                let (column, row) = (k % u64::from(columns), k / u64::from(columns));
                let rows = self.count() / u64::from(columns);
                [(column as f64 + 0.5) / f64::from(columns), (row as f64 + 0.5) / rows as f64]
            }
            Sampling::Fibonacci { count } => {
                [(k as f64 + 0.5) / count as f64, unit_fraction(k.wrapping_mul(GOLDEN))]
            }
            Sampling::Random { .. } => [numbers[0], numbers[1]],
            // rejected by `checked_for_rectangle`
            Sampling::Hexapolar { .. } => [0.5, 0.5],
        }
    }

    /// The point of ray `k` in a disc.
    pub(super) fn in_disc(&self, k: u64, numbers: &Numbers) -> Place {
        if let Sampling::Hexapolar { rings } = *self {
            return hexapolar(k, rings);
        }
        let [u, v] = self.in_square(k, numbers);
        let (area, turn) = match self {
            Sampling::Grid { .. } => concentric(u, v),
            _ => (u, v),
        };
        Place { area, turn, weight: 1.0 }
    }
}

/// 2^64 times the fractional part of the golden ratio, so that multiples wrap around exactly.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// The concentric map from the unit square to the disc: squares about the centre become circles.
fn concentric(u: f64, v: f64) -> (f64, f64) {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let (radius, eighths) = match a.abs() > b.abs() {
        true => (a, b / a),
        false if b == 0.0 => (0.0, 0.0),
        false => (b, 2.0 - a / b),
    };
    let half_turn = if radius < 0.0 { 0.5 } else { 0.0 };
    (radius * radius, 0.125 * eighths + half_turn)
}

/// Ring j begins with ray 3 j (j - 1) + 1.
fn hexapolar(k: u64, rings: u32) -> Place {
    let (rings, total) = (f64::from(rings), Sampling::Hexapolar { rings }.count() as f64);
    let square = |radius: f64| (radius / rings) * (radius / rings);
    if k == 0 {
        return Place { area: 0.0, turn: 0.0, weight: total * square(0.5) };
    }
    let before = |ring: u64| 3 * ring * (ring - 1) + 1;
    let guess = ((k as f64 / 3.0).sqrt() + 0.5) as u64;
    // the square root may be off by a rounding
    let ring =
        (guess.saturating_sub(1).max(1)..=guess + 1).rev().find(|&ring| before(ring) <= k).unwrap_or(1);
    let (inner, outer) = (square(ring as f64 - 0.5), square((ring as f64 + 0.5).min(rings)));
    let on_ring = 6.0 * ring as f64;
    Place {
        area: square(ring as f64),
        turn: (k - before(ring)) as f64 / on_ring,
        weight: total * (outer - inner) / on_ring,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexapolar_rings() {
        let sampling = Sampling::Hexapolar { rings: 50 };
        let places: Vec<Place> = (0..sampling.count()).map(|k| sampling.in_disc(k, &[0.0; 8])).collect();
        assert_eq!(places.len(), 1 + 6 * 50 * 51 / 2);
        let mut expected = vec![(0, 0)];
        (1..=50).for_each(|ring| expected.extend((0..6 * ring).map(|step| (ring, step))));
        for (place, (ring, step)) in places.iter().zip(expected) {
            assert!((place.area.sqrt() * 50.0 - f64::from(ring)).abs() < 1e-12);
            assert!((place.turn * 6.0 * f64::from(ring) - f64::from(step)).abs() < 1e-9);
        }
        let weight: f64 = places.iter().map(|place| place.weight).sum();
        assert!((weight / places.len() as f64 - 1.0).abs() < 1e-12);
        // at high ray numbers, where a square root has lost digits
        let far = Sampling::Hexapolar { rings: 4_000_000 };
        let first = 3 * 3_999_999 * 3_999_998 + 1;
        assert_eq!(far.in_disc(first, &[0.0; 8]).turn, 0.0);
        assert!(far.in_disc(first - 1, &[0.0; 8]).turn > 0.999);
    }

    #[test]
    fn counts_do_not_overflow() {
        assert_eq!(Sampling::Hexapolar { rings: u32::MAX }.count(), u64::MAX);
        assert_eq!(Sampling::Grid { columns: u32::MAX, rows: u32::MAX }.count(), 0xffff_fffe_0000_0001);
    }

    /// The concentric map preserves areas: moments of a fine grid are those of the disc.
    #[test]
    fn discs_are_covered_evenly() {
        for (sampling, error) in [
            (Sampling::Grid { columns: 300, rows: 300 }, 1e-5),
            (Sampling::Fibonacci { count: 90_000 }, 1e-4),
        ] {
            let mut moments = [0.0; 5];
            for k in 0..sampling.count() {
                let Place { area, turn, .. } = sampling.in_disc(k, &[0.0; 8]);
                let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
                let [x, y] = [area.sqrt() * cos, area.sqrt() * sin];
                [x, y, x * x, y * y, x * y]
                    .into_iter()
                    .zip(&mut moments)
                    .for_each(|(m, sum)| *sum += m / 9e4);
            }
            for (found, exact) in moments.into_iter().zip([0.0, 0.0, 0.25, 0.25, 0.0]) {
                assert!((found - exact).abs() < error, "{sampling:?} {moments:?}");
            }
        }
    }

    /// The corners of the square go to the diagonals of the rim, the middles of its sides to its axes.
    #[test]
    fn the_concentric_map() {
        let close = |(area, turn): (f64, f64), at: (f64, f64)| {
            assert!((area - at.0).abs() < 1e-15 && (turn - at.1).abs() < 1e-15, "{area} {turn}");
        };
        close(concentric(1.0, 0.5), (1.0, 0.0));
        close(concentric(0.5, 1.0), (1.0, 0.25));
        close(concentric(0.0, 0.5), (1.0, 0.5));
        close(concentric(0.5, 0.0), (1.0, 0.75));
        close(concentric(1.0, 1.0), (1.0, 0.125));
        close(concentric(0.0, 0.0), (1.0, 0.625));
        close(concentric(0.5, 0.5), (0.0, 0.0));
        close(concentric(0.75, 0.5), (0.25, 0.0));
    }
}
