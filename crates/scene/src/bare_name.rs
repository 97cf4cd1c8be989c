//! Removal of pointer suffixes from GDML names.

/// A name without the pointer suffix that Geant4 appends to make it unique: `World0x55f3c0` becomes `World`. Regions and
/// occurrence paths use these names.
pub fn bare_name(name: &str) -> &str {
    match name.rsplit_once("0x") {
        Some((bare, suffix))
            if !bare.is_empty()
                && !suffix.is_empty()
                && suffix.bytes().all(|byte| byte.is_ascii_hexdigit()) =>
        {
            bare
        }
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::bare_name;

    #[test]
    fn pointer_suffixes_are_removed() {
        assert_eq!(bare_name("World0x55f3c0"), "World");
        assert_eq!(bare_name("World"), "World");
        assert_eq!(bare_name("0xff"), "0xff");
        assert_eq!(bare_name("a0x"), "a0x");
        assert_eq!(bare_name("box0xg1"), "box0xg1");
    }
}
