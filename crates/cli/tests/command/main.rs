//! The command line program as a separate process, with real files: output, exit codes, messages.

mod bench;
mod check;
mod convert;
mod diff;
mod export;
mod formats;
mod infill;
mod info;
mod interrupt;
mod memory;
mod new;
mod optics;
mod pages;
mod parts;
mod photon_compare;
mod photons;
mod probe;
mod reference;
mod render;
mod section;
mod thickness;
mod trace;
mod tutorials;
mod usage;
mod volume;
mod watch;
