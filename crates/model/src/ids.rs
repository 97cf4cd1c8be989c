//! Typed ids of the parts of a compiled model: leaves, surfaces, nodes, placements, prototypes and regions.

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
            /// Compilation rejects models with more than 2^31 of anything, so that the number fits.
            fn from(index: usize) -> Self {
                $name(index as u32)
            }
        }
    };
}

id! {
    /// An occurrence of a primitive in a model, with a name, faces and a position in the order of
    /// declaration.
    LeafId
}
id! {
    /// An equation; coincident faces of several leaves share one.
    SurfaceId
}
id! {
    /// A node of the boolean expression: 0 is empty, 1 is universe; operands come before the nodes that use
    /// them.
    NodeId
}
id! {
    /// An occurrence of a placed solid: 0 is the model itself, the others follow depth first.
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

impl RegionId {
    /// The world: everything outside all regions.
    pub const WORLD: RegionId = RegionId(0);
}
