//! The command `rayweave`.

fn main() {}
