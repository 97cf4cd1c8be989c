//! The four kinds of numbers by which things in a compiled model are known, and two small ones.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            /// The number as an index.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl From<usize> for $name {
            /// Compiling refuses models with more than 2^31 of anything, so that the number fits.
            fn from(index: usize) -> Self {
                $name(index as u32)
            }
        }
    };
}

id! {
    /// An occurrence of a primitive in a model: its name, its faces, its place in the order of declaration.
    LeafId
}
id! {
    /// An equation: faces of several leaves that coincide share one.
    SurfaceId
}
id! {
    /// A node of the boolean expression: 0 is empty, 1 is universe, operands come before what uses them.
    NodeId
}
id! {
    /// An occurrence of a placed solid: 0 is the model itself, then depth first.
    PlacementId
}
id! {
    /// A group of leaves compiled together in one frame: 0 is the model itself.
    PrototypeId
}
id! {
    /// A region in the order of the model, counted from 1: 0 is the world outside all of them.
    RegionId
}
