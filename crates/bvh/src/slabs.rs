//! The slab test of one ray against the eight boxes of a node (Kay and Kajiya 1986).

use crate::frame::Probe;
use crate::node::{Node32, WIDTH};
use fearless_simd::{Simd, SimdBase, SimdFrom, SimdMask, f32x8};

/// A ray in SIMD registers.
pub(crate) struct RaySlabs<S: Simd> {
    simd: S,
    near: [usize; 3],
    far: [usize; 3],
    near_origin: [f32x8<S>; 3],
    far_origin: [f32x8<S>; 3],
    inverse: [f32x8<S>; 3],
    window: [f32x8<S>; 2],
}

impl<S: Simd> RaySlabs<S> {
    #[inline(always)]
    pub fn new(simd: S, probe: &Probe) -> Self {
        let [begin, end] = probe.window;
        RaySlabs {
            simd,
            near: probe.near,
            far: probe.far,
            near_origin: splat(simd, probe.near_origin),
            far_origin: splat(simd, probe.far_origin),
            inverse: splat(simd, probe.inverse),
            window: [f32x8::splat(simd, begin), f32x8::splat(simd, end)],
        }
    }

    /// Bit mask of the boxes that the ray passes within its window, and the entry times. The ray enters an
    /// unused box at +inf and leaves it at -inf.
    #[inline(always)]
    pub fn passed(&self, node: &Node32) -> (u32, f32x8<S>) {
        let [mut enter, mut leave] = self.window;
        for k in 0..3 {
            let near = f32x8::simd_from(self.simd, node.planes[self.near[k]].0);
            let far = f32x8::simd_from(self.simd, node.planes[self.far[k]].0);
            enter = enter.max((near - self.near_origin[k]) * self.inverse[k]);
            leave = leave.min((far - self.far_origin[k]) * self.inverse[k]);
        }
        (enter.simd_le(leave).to_bitmask() as u32, enter)
    }

    #[inline(always)]
    pub fn entered(&self, node: &Node32) -> (u32, [f32; WIDTH]) {
        let (passed, enter) = self.passed(node);
        let mut times = [0.0; WIDTH];
        enter.store_slice(&mut times);
        (passed, times)
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, [x, y, z]: [f32; 3]) -> [f32x8<S>; 3] {
    [f32x8::splat(simd, x), f32x8::splat(simd, y), f32x8::splat(simd, z)]
}
