//! Structural similarity (SSIM) of two pictures.

use rayweave::render::Image;

/// The half width of the window and its standard deviation, in pixels.
const REACH: usize = 5;
const DEVIATION: f64 = 1.5;

/// The mean structural similarity of the luma of two pictures of the same size; 1 if they are equal. (Wang,
/// Bovik, Sheikh, Simoncelli: "Image quality assessment: from error visibility to structural similarity",
/// IEEE TIP 13(4), 2004: Gaussian window of 11 x 11 pixels, K1 = 0.01, K2 = 0.03.)
pub fn structural(a: &Image, b: &Image) -> f64 {
    let (width, height) = (a.width(), a.height());
    let (x, y) = (luma(a), luma(b));
    let smooth =
        |of: &dyn Fn(usize) -> f64| blurred(&(0..x.len()).map(of).collect::<Vec<_>>(), width, height);
    let (mean_x, mean_y) = (smooth(&|k| x[k]), smooth(&|k| y[k]));
    let (square_x, square_y) = (smooth(&|k| x[k] * x[k]), smooth(&|k| y[k] * y[k]));
    let product = smooth(&|k| x[k] * y[k]);
    let (c1, c2) = ((0.01 * 255.0_f64).powi(2), (0.03 * 255.0_f64).powi(2));
    let at = |k: usize| {
        let (mx, my) = (mean_x[k], mean_y[k]);
        let (vx, vy) = (square_x[k] - mx * mx, square_y[k] - my * my);
        let covariance = product[k] - mx * my;
        (2.0 * mx * my + c1) * (2.0 * covariance + c2) / ((mx * mx + my * my + c1) * (vx + vy + c2))
    };
    (0..mean_x.len()).map(at).sum::<f64>() / mean_x.len() as f64
}

/// Rec. 601 luma, as in the paper's program.
fn luma(image: &Image) -> Vec<f64> {
    let weights = [0.298_936, 0.587_043, 0.114_021];
    let of = |pixel: &[u8; 4]| (0..3).map(|c| weights[c] * f64::from(pixel[c])).sum();
    image.values().iter().map(of).collect()
}

/// The weighted means over all windows inside the picture.
fn blurred(values: &[f64], width: usize, height: usize) -> Vec<f64> {
    let side = 2 * REACH + 1;
    let weight = |k: usize| {
        let z = (k as f64 - REACH as f64) / DEVIATION;
        (-0.5 * z * z).exp()
    };
    let total: f64 = (0..side).map(weight).sum();
    let weights: Vec<f64> = (0..side).map(|k| weight(k) / total).collect();
    let columns = width.saturating_sub(2 * REACH);
    let sum = |at: &dyn Fn(usize) -> f64| (0..side).map(|k| weights[k] * at(k)).sum::<f64>();
    let mut rows = Vec::with_capacity(columns * height);
    for row in values.chunks(width) {
        rows.extend((0..columns).map(|x| sum(&|k| row[x + k])));
    }
    let inner = height.saturating_sub(2 * REACH);
    (0..inner * columns).map(|at| sum(&|k| rows[at + k * columns])).collect()
}
