//! Records of fixed size and their serialisation.

/// A row of a plain table: only `u32` or only `f64` fields, without padding.
///
/// The bytes of a record are its fields in the order of declaration, little-endian, each as wide as in
/// memory. On a little-endian machine they equal the memory of the record.
pub trait Record: Copy {
    /// The number of bytes of a record.
    const SIZE: usize;

    /// Appends the bytes of the record.
    fn put(&self, bytes: &mut Vec<u8>);

    /// Reads a record from the front of a slice and advances it; `None` if there are too few bytes.
    fn get(bytes: &mut &[u8]) -> Option<Self>;
}

impl Record for u32 {
    const SIZE: usize = 4;

    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn get(bytes: &mut &[u8]) -> Option<Self> {
        let (first, rest) = bytes.split_first_chunk()?;
        *bytes = rest;
        Some(u32::from_le_bytes(*first))
    }
}

impl Record for f64 {
    const SIZE: usize = 8;

    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn get(bytes: &mut &[u8]) -> Option<Self> {
        let (first, rest) = bytes.split_first_chunk()?;
        *bytes = rest;
        Some(f64::from_le_bytes(*first))
    }
}

impl<const N: usize> Record for [f64; N] {
    const SIZE: usize = 8 * N;

    fn put(&self, bytes: &mut Vec<u8>) {
        self.iter().for_each(|number| number.put(bytes));
    }

    fn get(bytes: &mut &[u8]) -> Option<Self> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = f64::get(bytes)?;
        }
        Some(numbers)
    }
}

/// Defines a record with the given size, which must be the sum of the sizes of its fields.
macro_rules! record {
    ($(#[$doc:meta])* $name:ident: $size:literal { $($(#[$field_doc:meta])* $field:ident: $kind:ty,)* }) => {
        $(#[$doc])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: $kind,)*
        }

        const _: () = assert!(size_of::<$name>() == $size && 0 $(+ size_of::<$kind>())* == $size);

        impl Record for $name {
            const SIZE: usize = $size;

            fn put(&self, bytes: &mut Vec<u8>) {
                $(self.$field.put(bytes);)*
            }

            fn get(bytes: &mut &[u8]) -> Option<Self> {
                Some($name { $($field: <$kind>::get(bytes)?,)* })
            }
        }
    };
}

pub(super) use record;
