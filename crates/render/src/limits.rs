//! Limits of pictures.

/// The most pixels along a side of a picture.
pub(crate) const LARGEST_SIDE: u32 = 32_768;

/// The most samples along a side of a pixel.
pub(crate) const MOST_SAMPLES: u32 = 16;
