//! The numbers that the tables and the kernel share: constants here, and their declarations in the text of the kernel.

use crate::boundary::BoundaryEvent;
use crate::flight::End;
use crate::philox::Purpose;

/// Constants, and a function that writes their declarations in WGSL.
macro_rules! shared {
    ($($(#[$doc:meta])* $name:ident = $value:expr;)*) => {
        $($(#[$doc])* pub(super) const $name: u32 = $value;)*

        /// The declarations of all constants of the kernel.
        pub(super) fn declarations() -> String {
            let own = [$((stringify!($name).to_owned(), $name)),*].into_iter();
            let ends = End::ALL.into_iter().zip(1..).map(|(end, number)| (end.name().to_uppercase(), number));
            let events = EVENTS.into_iter().zip(0..).map(|((name, _), number)| (name.to_owned(), number));
            own.chain(ends).chain(events).map(|(name, value)| format!("const {name}: u32 = {value}u;\n")).collect()
        }
    };
}

/// The boundary events that the kernel counts, with their names there.
pub(super) const EVENTS: [(&str, BoundaryEvent); 12] = [
    ("REFRACTION", BoundaryEvent::FresnelRefraction),
    ("REFLECTION", BoundaryEvent::FresnelReflection),
    ("TOTAL_REFLECTION", BoundaryEvent::TotalInternalReflection),
    ("LAMBERTIAN", BoundaryEvent::LambertianReflection),
    ("LOBE", BoundaryEvent::LobeReflection),
    ("SPIKE", BoundaryEvent::SpikeReflection),
    ("BACKSCATTER", BoundaryEvent::BackScattering),
    ("ABSORPTION", BoundaryEvent::Absorption),
    ("DETECTION", BoundaryEvent::Detection),
    ("TRANSMISSION", BoundaryEvent::Transmission),
    ("SAME_MATERIAL", BoundaryEvent::SameMaterial),
    ("INDEX_MISSING", BoundaryEvent::NoIndex),
];

/// The place of the first way of ending among the counts, and of the first boundary event; the number of counts. In front of them
/// are the numbers of rows, of photons in flight and of steps.
pub(super) const FIRST_END: usize = 3;
pub(super) const FIRST_EVENT: usize = FIRST_END + HANDED_BACK as usize;
pub(super) const COUNTS: usize = FIRST_EVENT + EVENTS.len();

/// The state of a detected photon.
pub(super) const DETECTED: u32 = End::Detected as u32 + 1;

shared! {
    /// States of a photon: in flight, 1 and the place of a way of ending in [`End::ALL`], or handed back.
    FLYING = 0;
    HANDED_BACK = End::ALL.len() as u32 + 1;

    NO_EVENT = EVENTS.len() as u32;
    FIRST_EVENT_COUNT = FIRST_EVENT as u32;

    /// Purposes of random numbers.
    FREE_PATH = Purpose::FreePath as u32;
    SCATTERING = Purpose::Scattering as u32;
    BOUNDARY = Purpose::Boundary as u32;
    REEMISSION = Purpose::Reemission as u32;

    /// Bits of the rules of a run.
    BY_EFFICIENCY = 1;
    BY_VOLUME = 2;
    EXPONENTIAL = 4;
    /// All photons come back, for tests.
    ALL = 8;

    /// Words of a material, and of a surface.
    MATERIAL_WORDS = 12;
    SURFACE_WORDS = 6;

    /// Processes in materials, and the bits of one.
    PROCESS_BITS = 4;
    ABSORBS = 0;
    RAYLEIGH = 1;
    SHIFTS = 2;
    SHIFTS_AGAIN = 3;
    MIE = 4;
    OTHER_PROCESS = 15;

    /// Kinds of boundaries between two regions, whether the region behind is sensitive, and the place of the number of the surface.
    UNKNOWN = 0;
    SAME = 1;
    INTERFACE = 2;
    MIRROR = 3;
    PAINT = 4;
    METAL = 5;
    COMPLEX_METAL = 6;
    KIND_BITS = 7;
    SENSITIVE = 8;
    SURFACE_SHIFT = 4;

    /// Flags of a surface.
    IS_ROUGH = 1;
    IS_UNIFIED = 2;
    HAS_ROUGHNESS = 4;
}
