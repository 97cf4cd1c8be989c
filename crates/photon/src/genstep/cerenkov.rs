//! The spectrum of Cerenkov photons (Frank and Tamm 1937).
//!
//! A particle of charge z and velocity beta emits alpha z^2 / (hbar c) sin^2 theta photons per length and energy, where
//! cos theta = 1 / (beta n). With n linear between the points of `RINDEX` the integral of sin^2 theta has a closed form, and its
//! inverse is the root of a quadratic equation.

use crate::property::PropertyTable;

/// The fine-structure constant over hbar c, in 1/(MeV mm) (CODATA 2018).
const PHOTONS_PER_MEV_MM: f64 = 7.297_352_569_3e-3 / 1.973_269_804_593_025e-10;

/// The mean number of Cerenkov photons per mm of the path of a particle: its charge in units of that of the positron, and
/// the inverse of its velocity in units of that of light. 0 below the threshold, and for a table of one point.
#[must_use]
pub fn cerenkov_yield(index: &PropertyTable, inverse_beta: f64, charge: f64) -> f64 {
    PHOTONS_PER_MEV_MM * charge * charge * integral(index, inverse_beta, ALL)
}

/// The energies from 0 to infinity.
pub(super) const ALL: [f64; 2] = [0.0, f64::INFINITY];

/// A part of an index table where light is emitted.
#[derive(Clone, Copy)]
struct Piece {
    energies: [f64; 2],
    indices: [f64; 2],
}

impl Piece {
    /// The integral of sin^2 theta over the energy.
    fn integral(&self, inverse_beta: f64) -> f64 {
        let [[e0, e1], [n0, n1]] = [self.energies, self.indices];
        (e1 - e0) * (1.0 - inverse_beta * inverse_beta / (n0 * n1)).max(0.0)
    }

    /// The energy below which `part` of the integral lies, and the index there.
    fn quantile(&self, inverse_beta: f64, part: f64) -> (f64, f64) {
        let [[e0, e1], [n0, n1]] = [self.energies, self.indices];
        // with x from 0 to 1 in the piece: x - b^2 x / (n0 (n0 + s x)) = t
        let (s, t) = (n1 - n0, part / (e1 - e0));
        let (a, c) = (n0 * s, t * n0 * n0);
        let b = (n0 - inverse_beta) * (n0 + inverse_beta) - t * n0 * s;
        let root = (b * b + 4.0 * a * c).max(0.0).sqrt();
        let x = if b >= 0.0 { 2.0 * c / (b + root) } else { (root - b) / (2.0 * a) };
        // 0 / 0 at the threshold
        let x = if x >= 0.0 { x.min(1.0) } else { 0.0 };
        (e0 + x * (e1 - e0), n0 + x * s)
    }
}

/// The parts of an index table between two energies where the index exceeds 1 / beta.
fn pieces(index: &PropertyTable, inverse_beta: f64, [least, most]: [f64; 2]) -> impl Iterator<Item = Piece> {
    let points = index.energies().windows(2).zip(index.values().windows(2));
    points.filter_map(move |(energies, indices)| {
        let [e0, e1, n0, n1] = [energies[0], energies[1], indices[0], indices[1]];
        let at = |energy: f64| if energy == e1 { n1 } else { n0 + (n1 - n0) * ((energy - e0) / (e1 - e0)) };
        let (mut from, mut to) = (e0.max(least), e1.min(most));
        if from >= to {
            return None;
        }
        let [before, after] = [at(from), at(to)];
        if before <= inverse_beta && after <= inverse_beta {
            return None;
        }
        let [mut first, mut last] = [before, after];
        let threshold = from + (to - from) * ((inverse_beta - before) / (after - before));
        if before < inverse_beta {
            (from, first) = (threshold, inverse_beta);
        } else if after < inverse_beta {
            (to, last) = (threshold, inverse_beta);
        }
        (from < to).then_some(Piece { energies: [from, to], indices: [first, last] })
    })
}

/// The integral of sin^2 theta between two energies.
pub(super) fn integral(index: &PropertyTable, inverse_beta: f64, energies: [f64; 2]) -> f64 {
    pieces(index, inverse_beta, energies).map(|piece| piece.integral(inverse_beta)).sum()
}

/// The energy below which a fraction of the photons between two energies lies, and the cosine of the angle of emission.
/// `None` if there are no photons.
pub(super) fn sample(
    index: &PropertyTable,
    inverse_beta: f64,
    energies: [f64; 2],
    fraction: f64,
) -> Option<(f64, f64)> {
    let mut rest = fraction * integral(index, inverse_beta, energies);
    let mut found = None;
    for piece in pieces(index, inverse_beta, energies) {
        let part = piece.integral(inverse_beta);
        found = Some(piece.quantile(inverse_beta, rest.min(part)));
        if rest < part {
            break;
        }
        rest -= part;
    }
    found.map(|(energy, index)| (energy, (inverse_beta / index).min(1.0)))
}
