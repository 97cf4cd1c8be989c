//! Heights of layers.

use super::InfillError;
use rayweave_math::Bounds;

/// The largest coordinate: scan lines may pass the origin at four times this distance, and the tracer of
/// plane regions accepts up to 1e60.
pub(super) const MAX_REACH: f64 = 1e59;

/// The heights of layers.
#[derive(Clone, Debug, PartialEq)]
pub enum Layers {
    /// At these heights, in this order.
    At(Vec<f64>),
    /// In the middle of layers of this thickness, stacked from the lowest point of the solid upwards: layer j
    /// is at `lo + (j + 1/2) height`, as long as that is below the highest point.
    Every(f64),
}

/// The maximum number of layers of one run.
pub const MAX_LAYERS: u64 = 1_000_000;

impl Layers {
    /// The heights of the layers; `bounds` are the extent of the solid, and `name` is its name.
    ///
    /// # Errors
    ///
    /// `Height`, `LayerHeight` for a number out of its range, `TooManyLayers`, `Unbounded` in z if the layers
    /// depend on the bounds.
    pub fn heights(&self, name: &str, bounds: &Bounds) -> Result<Vec<f64>, InfillError> {
        match self {
            Layers::At(heights) => match heights.iter().position(|z| !(-MAX_REACH..=MAX_REACH).contains(z)) {
                Some(index) => Err(InfillError::Height { index, value: heights[index] }),
                None => Ok(heights.clone()),
            },
            &Layers::Every(height) => {
                let (lo, hi) = (bounds.lo.z, bounds.hi.z);
                match () {
                    () if !(height > 0.0 && height.is_finite()) => {
                        return Err(InfillError::LayerHeight(height));
                    }
                    () if !(hi - lo).is_finite() => {
                        return Err(InfillError::Unbounded { name: name.to_owned(), axes: "z".to_owned() });
                    }
                    () => {}
                }
                let layers = ((hi - lo) / height + 0.5).floor();
                if layers > MAX_LAYERS as f64 {
                    return Err(InfillError::TooManyLayers { height, layers, most: MAX_LAYERS });
                }
                let heights = (0..=layers as u64).map(|j| lo + (j as f64 + 0.5) * height);
                Ok(heights.take_while(|&z| z < hi).collect())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_math::Vec3;

    fn between(lo: f64, hi: f64) -> Bounds {
        Bounds::new(Vec3::new(0.0, 0.0, lo), Vec3::new(1.0, 1.0, hi))
    }

    #[test]
    fn layers_lie_on_each_other_from_below() {
        let heights = |lo, hi, height| Layers::Every(height).heights("x", &between(lo, hi)).unwrap();
        assert_eq!(heights(-1.0, 1.0, 0.5), [-0.75, -0.25, 0.25, 0.75]);
        // the middle of the last layer is just inside or just outside
        assert_eq!(heights(0.0, 1.6, 1.0), [0.5, 1.5]);
        assert_eq!(heights(0.0, 1.5, 1.0), [0.5]);
        assert_eq!(heights(0.0, 1.0, 5.0), [0.0; 0]);
        assert_eq!(heights(0.0, 10.0, 0.1).len(), 100);
    }

    #[test]
    fn bad_numbers() {
        let message = |layers: Layers, bounds| layers.heights("ball", &bounds).unwrap_err().to_string();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(message(Layers::Every(bad), between(0.0, 1.0)).contains("layer height is"), "{bad}");
        }
        let text = message(Layers::At(vec![1.0, f64::NAN]), between(0.0, 1.0));
        assert_eq!(
            text,
            "height 1 of the layers is NaN: a height must be finite and at most 1e59 in magnitude."
        );
        let text = message(Layers::At(vec![1e300]), Bounds::ALL);
        assert!(text.starts_with("height 0 of the layers is 1e300: "), "{text}");
        let text = message(Layers::Every(1.0), Bounds::ALL);
        assert!(text.starts_with("ball is unbounded in z"), "{text}");
        assert!(message(Layers::Every(1e-9), between(0.0, 1.0)).contains("at most 1000000"));
    }
}
