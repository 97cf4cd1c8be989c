//! Text that several formats write.

use rayweave_math::Vec3;
use std::io::{self, Write};

/// A name without line breaks and other control characters, which text formats cannot represent.
pub(crate) fn printable(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// Writes a line with a prefix and three numbers, as the shortest decimals that read back to the same bits.
pub(crate) fn write_point(to: &mut impl Write, prefix: &str, p: Vec3) -> io::Result<()> {
    writeln!(to, "{prefix}{:?} {:?} {:?}", p.x, p.y, p.z)
}
