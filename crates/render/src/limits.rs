//! Limits of pictures.

/// The greatest number of pixels along a side of a picture.
pub(crate) const MAX_SIDE: u32 = 32_768;

/// The greatest number of samples along a side of a pixel.
pub(crate) const MAX_SAMPLES: u32 = 16;
