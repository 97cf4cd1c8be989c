//! Bounds of the height of sag surfaces against closed forms, and against Zernike polynomials computed by their recurrence.

use super::{Base, Description, Sag, Vec3, Zernike, depth, rng, zernike_terms};
use rand::RngExt;
use std::f64::consts::PI;

const LEVEL: Base = Base::Conic { curvature: 0.0, conic: 0.0 };

fn zernikes(coefficients: &[f64]) -> Description {
    Description { mixed: zernike_terms(Zernike::Noll, coefficients, 1.0), ..Description::new(1.0, LEVEL) }
}

/// Rounding of terms that cancel each other.
fn rounding(of: &Description) -> f64 {
    let mixed = of.mixed.iter().map(|term| term.2.abs());
    1e-13 * mixed.chain(of.even.iter().map(|c| c.abs())).sum::<f64>() + 1e-15
}

/// Asserts that bounds contain the extremes, and exceed them by at most a fraction of their difference.
fn check(of: &Description, [low, high]: [f64; 2], fraction: f64) {
    let (found, rounding) = (Sag::new(of).unwrap().heights(), rounding(of));
    let slack = fraction * (high - low) + rounding;
    assert!(
        found[0] <= low + rounding && high - rounding <= found[1],
        "{found:?}, not around {low} to {high}"
    );
    assert!(low - found[0] <= slack && found[1] - high <= slack, "{found:?} is too wide for {low} to {high}");
}

/// Degree and order of Noll's Zernike polynomials; the order is negative for sines.
fn noll(number: usize) -> (usize, isize) {
    let (mut n, mut rest) = (0, number - 1);
    while rest > n {
        n += 1;
        rest -= n;
    }
    let m = (n % 2 + 2 * ((rest + (n + 1) % 2) / 2)) as isize;
    (n, if number.is_multiple_of(2) { m } else { -m })
}

/// `R_n^m(r)` for n up to 30, by `R_n^m = r (R_(n-1)^|m-1| + R_(n-1)^(m+1)) - R_(n-2)^m`.
fn radial(r: f64) -> Vec<[f64; 32]> {
    let mut all = vec![[0.0; 32]; 31];
    all[0][0] = 1.0;
    for n in 1..=30 {
        for m in (n % 2..=n).step_by(2) {
            let before = if n > 1 { all[n - 2][m] } else { 0.0 };
            all[n][m] = r * (all[n - 1][m.abs_diff(1)] + all[n - 1][m + 1]) - before;
        }
    }
    all
}

/// Extremes on a grid that is fine for degree 30: 480 angles, and 121 radii that are denser towards the rim.
fn sampled(coefficients: &[f64]) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let turns: Vec<[(f64, f64); 31]> = (0..480)
        .map(|k| std::array::from_fn(|m| libm::sincos(m as f64 * f64::from(k) * PI / 240.0)))
        .collect();
    for k in 0..=120 {
        let radial = radial(libm::cos(f64::from(k) * PI / 240.0));
        let mut waves = [(0.0, 0.0); 31];
        for (place, c) in coefficients.iter().enumerate() {
            let (n, m) = noll(place + 1);
            let norm = ((n + 1) as f64 * if m == 0 { 1.0 } else { 2.0 }).sqrt();
            let value = c * norm * radial[n][m.unsigned_abs()];
            let wave = &mut waves[m.unsigned_abs()];
            if m < 0 { wave.0 += value } else { wave.1 += value }
        }
        for turn in &turns {
            let value: f64 = waves.iter().zip(turn).map(|(wave, at)| wave.0 * at.0 + wave.1 * at.1).sum();
            (low, high) = (low.min(value), high.max(value));
        }
    }
    [low, high]
}

/// A single Zernike polynomial with m > 0 lies between plus and minus its norm, which it reaches at the rim.
#[test]
fn single_zernike_terms_lie_between_plus_and_minus_their_norm() {
    for number in (2..=496).step_by(7) {
        let (n, m) = noll(number);
        if m != 0 {
            let mut list = vec![0.0; number];
            list[number - 1] = 0.25;
            let norm = 0.25 * (2.0 * (n + 1) as f64).sqrt();
            check(&zernikes(&list), [-norm, norm], 0.021);
        }
    }
}

/// Up to 496 terms whose powers of x and y cancel each other: the bounds exceeded the height of 200 by up to 2e11.
#[test]
fn bounds_of_zernike_sums_are_close_to_their_extremes() {
    let mut rng = rng(31);
    for count in [4, 20, 36, 66, 120, 300, 496] {
        let alternating: Vec<f64> = (0..count).map(|k| if k % 2 == 0 { 0.1 } else { -0.1 }).collect();
        let random: Vec<f64> = (0..count).map(|_| rng.random_range(-1.0..1.0)).collect();
        for list in [alternating, random] {
            // 2 % each for the bounds and for the grid
            check(&zernikes(&list), sampled(&list), 0.045);
        }
    }
}

/// Chebyshev polynomials of r^2 lie between -1 and 1.
#[test]
fn bounds_of_even_terms_are_close_to_their_extremes() {
    // T_k(2 v - 1) by the recurrence T_(k+1) = (4 v - 2) T_k - T_(k-1)
    let (mut before, mut now) = (vec![1.0], vec![-1.0, 2.0]);
    for k in 1..=12 {
        let at_vertex = if k % 2 == 0 { 1.0 } else { -1.0 };
        let of = Description { even: now[1..].to_vec(), ..Description::new(1.0, LEVEL) };
        check(&of, [-1.0 - at_vertex, 1.0 - at_vertex], 0.021);
        let mut next: Vec<f64> = now.iter().map(|c| -2.0 * c).chain([0.0]).collect();
        (0..now.len()).for_each(|k| next[k + 1] += 4.0 * now[k]);
        before.iter().enumerate().for_each(|(k, c)| next[k] -= c);
        (before, now) = (now, next);
    }
}

/// A base with all kinds of terms: no point is outside the bounds, by the textbook formula.
#[test]
fn bounds_contain_all_heights_of_a_base_with_terms() {
    let mut rng = rng(32);
    for round in 0..40 {
        let mut coefficient = || rng.random_range(-0.3..0.3);
        let [curvature, other] = [2.0 * coefficient(), 2.0 * coefficient()];
        let conic = [0.0, -1.0, -3.0, 0.5][round % 4];
        let base = match round % 3 {
            0 => Base::Biconic { curvatures: [curvature, other], conics: [conic, -1.0] },
            _ => Base::Conic { curvature, conic },
        };
        // the first terms in r^2 cancel most of the base
        let even = vec![-0.5 * curvature, coefficient(), coefficient()];
        let odd = if round % 2 == 0 { vec![coefficient(), coefficient()] } else { Vec::new() };
        let list: Vec<f64> = (0..[0, 6, 21][round % 3]).map(|_| coefficient()).collect();
        let of = Description { base, even, odd, ..zernikes(&list) };
        let [low, high] = Sag::new(&of).unwrap().heights();
        for (i, j) in (0..=60).flat_map(|i| (0..24).map(move |j| (i, j))) {
            let (sin, cos) = libm::sincos(f64::from(j) * PI / 12.0);
            let r = f64::from(i) / 60.0 * (1.0 - 1e-15);
            let height = -depth(&of, Vec3::new(r * cos, r * sin, 0.0));
            assert!(
                low - 1e-14 <= height && height <= high + 1e-14,
                "{height} outside {low} to {high}: {of:?}"
            );
        }
    }
}
