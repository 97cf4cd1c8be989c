//! The two ways to build the command and the Python package for their tests.

/// A profile of Cargo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// The profile of the Rust tests: the crates that these compiled are used again (a release build of the command takes ten minutes
    /// of processor time), and the arithmetic is checked for overflow. The Python tests take a quarter longer than with optimisation.
    Dev,
    /// The profile of users.
    Release,
}

impl Profile {
    /// The name in Cargo's option `--profile`.
    pub fn name(self) -> &'static str {
        match self {
            Profile::Dev => "dev",
            Profile::Release => "release",
        }
    }

    /// The name of the folder of the programs, below the target folder.
    pub fn folder(self) -> &'static str {
        match self {
            Profile::Dev => "debug",
            Profile::Release => "release",
        }
    }
}
