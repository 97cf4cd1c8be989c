//! The algorithm of the shader on the CPU, over numbers that count or provoke rounding errors.

/// Bound of the rounding error of a component of a unit vector in f32: half of the spacing below 1.
pub(crate) const DIRECTION_ERROR: f32 = 2.9802322e-8 * 1.0001;

/// Constants of the error bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    /// Factor of each bound, for the roundings of the bound itself.
    pub room: f32,
    /// Width of the interval about a root, in units of the bound of f over its slope.
    pub step: f32,
}

impl Default for Bounds {
    fn default() -> Self {
        Bounds { room: 1.00001, step: 1.05 }
    }
}

#[cfg(test)]
mod adversary;
#[cfg(test)]
mod device;
#[cfg(test)]
mod kernels;
#[cfg(test)]
mod pixels;
#[cfg(test)]
mod surfaces;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod torus;
