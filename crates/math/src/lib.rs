//! Numbers under Rayweave: affine maps, bounds, intervals and polynomial roots.
