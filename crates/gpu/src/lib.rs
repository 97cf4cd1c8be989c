//! Nearest crossings of models on graphics cards, through Vulkan, with the answers of the CPU.
//!
//! [`Gpu`] lists the adapters of the machine, [`GpuProgram`] is a compiled model on one of them, and
//! [`GpuProgram::nearest`] finds the first crossing of each ray of a batch. The device computes in single precision, with error
//! bounds that hold under the rounding rules of WGSL. A ray whose answer they do not settle is traced by the CPU. The time of every
//! other crossing is computed in f64 by the kernel of the face that the device names: on the device if it has f64 and rounds like
//! the CPU, for planes, spheres and cylinders, else on the CPU. So all answers are those of [`rayweave_trace::Packets`], bit for
//! bit. [`GpuReport`] counts the rays that the CPU traced.
//!
//! The page `docs/concepts/gpu.md` derives the bounds.

mod adapter;
mod carrier;
mod codes;
mod double;
mod error;
mod evaluator;
mod flat;
mod frame;
mod kernel;
mod layout;
mod next;
mod prepared;
mod program;
mod shader;
mod terms;
mod tied;
mod trial;
mod twin;

pub use adapter::{Adapter, AdapterKind, Gpu};
pub use carrier::{Carried, Carrier, CarrierForm, CarrierSlot};
pub use error::{GpuError, Unsupported};
pub use evaluator::GpuDevice;
pub use next::NextTables;
pub use program::{GpuProgram, GpuReport};
