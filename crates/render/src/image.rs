//! Images: rectangles of pixels.

use crate::RenderError;
use crate::limits::MAX_SIDE;

/// Width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    width: u32,
    height: u32,
}

impl Size {
    /// The greatest number of pixels on a side.
    pub const MAX_SIDE: u32 = MAX_SIDE;

    /// A size.
    ///
    /// # Errors
    /// [`RenderError::Size`] if a side is 0 or greater than [`Size::MAX_SIDE`].
    pub fn new(width: u32, height: u32) -> Result<Size, RenderError> {
        let legal = 1..=Size::MAX_SIDE;
        if legal.contains(&width) && legal.contains(&height) {
            Ok(Size { width, height })
        } else {
            Err(RenderError::Size { width, height })
        }
    }

    /// The number of columns.
    pub fn width(self) -> usize {
        self.width as usize
    }

    /// The number of rows.
    pub fn height(self) -> usize {
        self.height as usize
    }

    /// The number of pixels.
    pub fn count(self) -> usize {
        self.width() * self.height()
    }
}

/// A two-dimensional array with a value per pixel, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelGrid<T> {
    size: Size,
    values: Vec<T>,
}

/// A picture: red, green, blue, opacity; sRGB, 8 bits each, not premultiplied.
pub type Image = PixelGrid<[u8; 4]>;

impl<T: Clone> PixelGrid<T> {
    /// A plane with the same value everywhere.
    pub fn filled(size: Size, value: T) -> PixelGrid<T> {
        PixelGrid { size, values: vec![value; size.count()] }
    }
}

impl<T> PixelGrid<T> {
    /// A plane of given values, row by row from the top; `None` if their number differs from `size.count()`.
    pub fn from_values(size: Size, values: Vec<T>) -> Option<PixelGrid<T>> {
        (values.len() == size.count()).then_some(PixelGrid { size, values })
    }

    /// Width and height.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The number of columns.
    pub fn width(&self) -> usize {
        self.size.width()
    }

    /// The number of rows.
    pub fn height(&self) -> usize {
        self.size.height()
    }

    /// The values, row by row from the top.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The values, mutable.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// Consumes the plane and returns its values.
    pub fn into_values(self) -> Vec<T> {
        self.values
    }

    /// The value in column `x` and row `y`; `None` outside the picture.
    pub fn get(&self, x: usize, y: usize) -> Option<&T> {
        (x < self.width() && y < self.height()).then(|| &self.values[y * self.width() + x])
    }

    /// The rows, from the top.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[T]> {
        self.values.chunks_exact(self.width())
    }
}
