//! Reader of whole NPY arrays of floating-point numbers, in constant depth and with a limit on their number.

use std::io::{self, Read};

use crate::npy_header::{self, NpyHeader};

/// An array of float64 numbers in row-major order.
#[derive(Clone, Debug, PartialEq)]
pub struct NpyArray {
    /// The numbers; as many as the product of `shape`.
    pub numbers: Vec<f64>,
    /// The length of each dimension.
    pub shape: Vec<u64>,
}

/// A file that is not an NPY array of float64 numbers in row-major order.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NpyArrayError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The header is damaged, or there is none.
    #[error("not an NPY file: {0}")]
    Header(String),
    /// The numbers are not float64, by their type string.
    #[error("its numbers are {0}, but must be float64")]
    Type(String),
    /// The array is in column-major order.
    #[error("its order is Fortran's, but must be C")]
    Order,
    /// The array is larger than the limit.
    #[error("it holds more than {0} numbers")]
    TooLarge(u64),
}

impl NpyArray {
    /// Reads an array of float32 or float64 numbers like [`read`](Self::read); true if they are float32. The bits of a
    /// float32 number that is not NaN are recovered by conversion.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    pub fn read_floats(source: &mut impl Read, most: u64) -> Result<(NpyArray, bool), NpyArrayError> {
        let header = npy_header::read(source)?.map_err(NpyArrayError::Header)?;
        let single = match header.descr.as_str() {
            "<f4" | "=f4" => f32::from_le_bytes,
            ">f4" => f32::from_be_bytes,
            _ => return Ok((NpyArray::body(source, header, most)?, false)),
        };
        let decode = |bytes: [u8; 4]| f64::from(single(bytes));
        Ok((NpyArray::numbers_of(source, header, most, decode)?, true))
    }

    /// Reads an array of at most `most` numbers, of either byte order. Memory grows with the data that is read, not with the
    /// size that the header states.
    ///
    /// # Errors
    ///
    /// [`NpyArrayError`]; a file that ends too early is an [`io::ErrorKind::UnexpectedEof`].
    pub fn read(source: &mut impl Read, most: u64) -> Result<NpyArray, NpyArrayError> {
        let header = npy_header::read(source)?.map_err(NpyArrayError::Header)?;
        NpyArray::body(source, header, most)
    }

    /// The numbers after a header, float64.
    fn body(source: &mut impl Read, header: NpyHeader, most: u64) -> Result<NpyArray, NpyArrayError> {
        let decode = match header.descr.as_str() {
            "<f8" | "=f8" if !header.structured => f64::from_le_bytes,
            ">f8" if !header.structured => f64::from_be_bytes,
            _ => return Err(NpyArrayError::Type(npy_header::abridged(&header.descr))),
        };
        NpyArray::numbers_of(source, header, most, decode)
    }

    /// The numbers after a header, of `N` bytes each.
    fn numbers_of<const N: usize>(
        source: &mut impl Read,
        header: NpyHeader,
        most: u64,
        decode: impl Fn([u8; N]) -> f64,
    ) -> Result<NpyArray, NpyArrayError> {
        let (numbers, shape) = items(source, header, most, decode)?;
        Ok(NpyArray { numbers, shape })
    }
}

/// Reads an array of at most `most` unsigned integers of 64 bits in row-major order: the numbers and the shape.
///
/// # Errors
///
/// As [`NpyArray::read`]; [`NpyArrayError::Type`] for other types.
pub fn read_npy_words(source: &mut impl Read, most: u64) -> Result<(Vec<u64>, Vec<u64>), NpyArrayError> {
    let header = npy_header::read(source)?.map_err(NpyArrayError::Header)?;
    match header.descr.as_str() {
        "<u8" | "=u8" if !header.structured => items(source, header, most, u64::from_le_bytes),
        _ => Err(NpyArrayError::Type(npy_header::abridged(&header.descr))),
    }
}

/// The items after a header, of `N` bytes each, and the shape.
fn items<T, const N: usize>(
    source: &mut impl Read,
    header: NpyHeader,
    most: u64,
    decode: impl Fn([u8; N]) -> T,
) -> Result<(Vec<T>, Vec<u64>), NpyArrayError> {
    if header.fortran_order {
        return Err(NpyArrayError::Order);
    }
    let count = header.shape.iter().try_fold(1u64, |product, n| product.checked_mul(*n));
    let count = count.filter(|&count| count <= most).ok_or(NpyArrayError::TooLarge(most))?;
    let mut bytes = Vec::new();
    source.take(count.saturating_mul(N as u64)).read_to_end(&mut bytes)?;
    let items: Vec<T> = bytes.as_chunks::<N>().0.iter().map(|&item| decode(item)).collect();
    if (items.len() as u64) < count {
        return Err(io::Error::from(io::ErrorKind::UnexpectedEof).into());
    }
    Ok((items, header.shape))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, numbers: &[f64], encode: fn(f64) -> [u8; 8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(numbers.iter().flat_map(|&number| encode(number)));
        bytes
    }

    fn header(descr: &str, shape: &str) -> String {
        format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n")
    }

    #[test]
    fn arrays_of_both_byte_orders_are_read() {
        let numbers = [1.0, -2.5, 1e300, 0.0, 5.0, 6.0];
        for (descr, encode) in
            [("'<f8'", f64::to_le_bytes as fn(f64) -> [u8; 8]), ("'>f8'", f64::to_be_bytes)]
        {
            let bytes = file(&header(descr, "(2, 3)"), &numbers, encode);
            let array = NpyArray::read(&mut &bytes[..], 6).unwrap();
            assert_eq!(array, NpyArray { numbers: numbers.to_vec(), shape: vec![2, 3] });
            assert!(matches!(NpyArray::read(&mut &bytes[..], 5), Err(NpyArrayError::TooLarge(5))));
        }
    }

    /// Integers as bits in float32, as in gensteps, are recovered.
    #[test]
    fn single_precision_keeps_its_bits() {
        let numbers = [1.5f32, f32::from_bits(15), f32::from_bits(100_000), -0.0, f32::INFINITY, 3e38];
        for (descr, encode) in
            [("'<f4'", f32::to_le_bytes as fn(f32) -> [u8; 4]), ("'>f4'", f32::to_be_bytes)]
        {
            let mut bytes = file(&header(descr, "(3, 2)"), &[], f64::to_le_bytes);
            bytes.extend(numbers.iter().flat_map(|&number| encode(number)));
            let (array, is_single) = NpyArray::read_floats(&mut &bytes[..], 6).unwrap();
            assert!(is_single && array.shape == [3, 2]);
            let bits: Vec<u32> = array.numbers.iter().map(|&number| (number as f32).to_bits()).collect();
            assert_eq!(bits, numbers.map(f32::to_bits));
            assert!(matches!(NpyArray::read(&mut &bytes[..], 6), Err(NpyArrayError::Type(_))));
        }
        let bytes = file(&header("'<f8'", "(1,)"), &[0.1], f64::to_le_bytes);
        let (array, is_single) = NpyArray::read_floats(&mut &bytes[..], 1).unwrap();
        assert!(!is_single && array.numbers == [0.1]);
    }

    /// Nested brackets and huge sizes: parsers that recurse take exponential time for the first, or overflow the stack.
    #[test]
    fn hostile_headers_are_rejected_at_once() {
        for depth in [40, 30_000] {
            let nested = "[".repeat(depth) + &"]".repeat(depth);
            let bytes = file(&header(&nested, "(1,)"), &[1.0], f64::to_le_bytes);
            let error = NpyArray::read(&mut &bytes[..], 100).unwrap_err().to_string();
            assert!(error.contains("must be float64") && error.len() < 200, "{error:.300}");
        }
        for shape in ["(4611686018427387904, 4)", "(99999999999,)"] {
            let bytes = file(&header("'<f8'", shape), &[1.0], f64::to_le_bytes);
            assert!(matches!(NpyArray::read(&mut &bytes[..], 100), Err(NpyArrayError::TooLarge(100))));
        }
        let bytes = file(&header("'<f8'", "(3,)"), &[1.0], f64::to_le_bytes);
        assert!(matches!(NpyArray::read(&mut &bytes[..], 100), Err(NpyArrayError::Io(_))));
    }
}
