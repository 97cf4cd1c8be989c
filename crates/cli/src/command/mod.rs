//! The sub-commands, one file each.

#[cfg(feature = "bench")]
mod bench;
mod check;
mod completions;
mod convert;
#[cfg(feature = "gpu")]
mod devices;
mod diff;
mod export;
mod infill;
mod info;
mod man;
mod merge;
mod new;
mod optics;
mod photon_compare;
mod photon_drawings;
mod photon_source;
mod photon_tables;
mod photons;
mod probe;
mod render;
mod schema;
mod section;
mod shapes;
mod thickness;
mod trace;
mod tree;
mod volume;
mod watch;

#[cfg(feature = "bench")]
pub use bench::Bench;
pub use check::Check;
pub use completions::Completions;
pub use convert::Convert;
#[cfg(feature = "gpu")]
pub use devices::Devices;
pub use diff::Diff;
pub use export::Export;
pub use infill::Infill;
pub use info::Info;
pub use man::Man;
pub use merge::Merge;
pub use new::New;
pub use optics::Optics;
pub use photons::Photons;
pub use probe::Probe;
pub use render::Render;
pub use schema::Schema;
pub use section::Section;
pub use shapes::Shapes;
pub use thickness::Thickness;
pub use trace::Trace;
pub use volume::Volume;
pub use watch::Watch;
