//! The numbers that the tables and the kernels share: constants here, and their declarations in the text of the kernels.

/// Kinds of surfaces on the device; the number is the case in the shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Kind {
    /// The CPU decides.
    Other = 0,
    Plane = 1,
    Sphere = 2,
    Cylinder = 3,
    Quadric = 4,
    /// The ball around a leaf that has facets without a kernel.
    Ball = 5,
    /// The first and the second chord of a line in a torus.
    FirstChord = 6,
    SecondChord = 7,
}

impl Kind {
    pub const COUNT: usize = 8;
}

/// Constants, and a function that writes their declarations in WGSL.
macro_rules! shared {
    ($($(#[$doc:meta])* $name:ident = $value:expr;)*) => {
        $($(#[$doc])* pub(crate) const $name: u32 = $value;)*

        /// The declarations of all constants.
        pub(crate) fn declarations() -> String {
            let all = [$((stringify!($name), $name)),*];
            all.iter().map(|(name, value)| format!("const {name}: u32 = {value}u;\n")).collect()
        }
    };
}

shared! {
    /// "None" in tables.
    NONE = u32::MAX;

    /// The bit of a child of a node that is an item.
    ITEM = 1 << 31;

    /// Bits of the first word of an answer: the CPU decides, the ray misses, more than one leaf changes at the crossing.
    UNCERTAIN = 1 << 31;
    MISS = 1 << 30;
    SHARED = 1 << 29;
    /// There are more crossings than rows; the row has the time of the CPU; the bits of the facet.
    MORE = 1 << 28;
    COMPLETED = 1 << 27;
    /// The row of times has events among which the CPU decides: see `Tied`.
    TIED = 1 << 26;
    FACET_BITS = TIED - 1;

    /// The second word of an answer without a crossing from a kernel that takes rays in double precision.
    PASSES = 1;
    DISTANT = 2;

    /// Kinds of surfaces; the last one is the ball around a leaf that has others.
    OTHER = Kind::Other as u32;
    PLANE = Kind::Plane as u32;
    SPHERE = Kind::Sphere as u32;
    CYLINDER = Kind::Cylinder as u32;
    BALL = Kind::Ball as u32;
}
