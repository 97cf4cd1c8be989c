//! Errors of this crate.

use rayweave_error::{Classified, ErrorKind};
use rayweave_model::BadRay;

/// The reason why a query cannot run on a GPU.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no adapter.
    #[error(
        "no GPU was found: no Vulkan driver offers an adapter. Install the driver of the card or, for tests without one, the Debian \
         packages `libvulkan1` and `mesa-vulkan-drivers`."
    )]
    NoAdapter,
    /// No adapter has this number.
    #[error("GPU {number} does not exist: {count} were found. Choose a number below that.")]
    UnknownAdapter {
        /// The number that was asked for.
        number: usize,
        /// The number of adapters.
        count: usize,
    },
    /// The best adapter is a program on the processor.
    #[error(
        "no graphics card was found: the only adapter, `{adapter}`, is a program on the processor. To use it, give its number."
    )]
    OnlySoftware {
        /// The name of the adapter.
        adapter: String,
    },
    /// The driver refused to open the device.
    #[error("the GPU `{adapter}` cannot be opened: {reason}. Is it in use or out of memory?")]
    Open {
        /// The name of the adapter.
        adapter: String,
        /// The message of the driver.
        reason: String,
    },
    /// The device stopped working.
    #[error("the GPU `{adapter}` was lost: {reason}. Open it again, or trace on the CPU.")]
    Lost {
        /// The name of the adapter.
        adapter: String,
        /// The message of the driver.
        reason: String,
    },
    /// The device has no double precision.
    #[error("the GPU `{adapter}` cannot follow photons: it has no numbers in double precision. Use the CPU.")]
    NoDouble {
        /// The name of the adapter.
        adapter: String,
    },
    /// The device rounds otherwise than the CPU.
    #[error(
        "the GPU `{adapter}` cannot follow photons: it rounds numbers in double precision otherwise than the CPU. Use the CPU."
    )]
    Rounding {
        /// The name of the adapter.
        adapter: String,
    },
    /// The CPU has other results for some photons.
    #[error(
        "the GPU `{adapter}` computes other photons than the CPU: its driver changes results in double precision. Use the CPU, and \
         please report this."
    )]
    Contradicted {
        /// The name of the adapter.
        adapter: String,
    },
    /// The device cannot hold the model.
    #[error(
        "the model does not fit on the GPU: {what} needs {bytes} bytes, the limit is {limit}. Trace it on the CPU."
    )]
    TooLarge {
        /// The table.
        what: &'static str,
        /// Its size in bytes.
        bytes: u64,
        /// The largest buffer of the device, in bytes.
        limit: u64,
    },
    /// The model has a form that the kernels do not support.
    #[error("the model has no form for the GPU: {0}. Trace it on the CPU.")]
    Unsupported(Unsupported),
    /// A ray is out of range.
    #[error(transparent)]
    Ray(#[from] BadRay),
}

/// The property of a model that the kernels do not support.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Unsupported {
    /// A part has too many leaves and gates.
    #[error("a part that is not a union of smaller ones has more than {limit} leaves and gates")]
    Nodes {
        /// The greatest number.
        limit: usize,
    },
    /// A gate has the same operand twice.
    #[error("a k-of-n gate has the same operand twice")]
    Repeated,
    /// Placed solids are nested too deeply.
    #[error("solids are placed within each other more than {limit} deep")]
    Depth {
        /// The greatest depth.
        limit: usize,
    },
    /// A model without bounds.
    #[error("it is unbounded")]
    Unbounded,
    /// Region numbers have 16 bits on the device.
    #[error("it has more than 65534 regions")]
    Regions,
    /// The device has a table of all pairs of volumes.
    #[error("it has more than {limit} volumes")]
    Pairs {
        /// The greatest number.
        limit: usize,
    },
}

impl Classified for GpuError {
    fn kind(&self) -> ErrorKind {
        match self {
            GpuError::TooLarge { .. } | GpuError::Unsupported(_) => ErrorKind::Compile,
            _ => ErrorKind::Value,
        }
    }
}
