//! Whether a Linux program is static: it names no program that would load shared libraries for it.

/// The type of the segment that names the loader (ELF specification, "Program Header").
const PT_INTERP: usize = 3;

/// True for a static program; `None` if the bytes are no 64-bit little-endian ELF file.
pub fn is_static(bytes: &[u8]) -> Option<bool> {
    if bytes.get(..6)? != b"\x7fELF\x02\x01" {
        return None;
    }
    let number = |at: usize, size: usize| -> Option<usize> {
        let bytes = bytes.get(at..at + size)?;
        Some(bytes.iter().rev().fold(0, |number, byte| number << 8 | usize::from(*byte)))
    };
    let (start, size, count) = (number(32, 8)?, number(54, 2)?, number(56, 2)?);
    let kinds: Option<Vec<usize>> = (0..count).map(|index| number(start + index * size, 4)).collect();
    Some(!kinds?.contains(&PT_INTERP))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with two segments.
    fn file(kinds: [u8; 2]) -> Vec<u8> {
        let mut bytes = vec![0; 64 + 2 * 56];
        bytes[..6].copy_from_slice(b"\x7fELF\x02\x01");
        (bytes[32], bytes[54], bytes[56]) = (64, 56, 2);
        (bytes[64], bytes[64 + 56]) = (kinds[0], kinds[1]);
        bytes
    }

    #[test]
    fn a_loader_makes_a_program_dynamic() {
        assert_eq!(is_static(&file([1, 2])), Some(true));
        assert_eq!(is_static(&file([1, 3])), Some(false));
        assert_eq!(is_static(&file([1, 3])[..100]), None);
        assert_eq!(is_static(b"MZ a program for Windows"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_program_is_dynamic() {
        let own = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        assert_eq!(is_static(&own), Some(cfg!(target_env = "musl")));
    }
}
