//! `rayweave devices`: the graphics cards of this machine.

use crate::failure::Failure;
use crate::terminal;
use clap::Args;
use rayweave::gpu::{Adapter, AdapterKind, Gpu, GpuError};
use serde_json::json;

/// List the graphics cards that can trace rays, best first
#[derive(Args)]
pub struct Devices {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Devices {
    pub fn run(&self) -> Result<(), Failure> {
        let gpu = Gpu::new();
        if gpu.adapters().is_empty() {
            return Err(Failure::Run(GpuError::NoAdapter.to_string()));
        }
        if self.json {
            let list: Vec<_> = gpu.adapters().iter().map(as_json).collect();
            return terminal::print(&format!("{:#}\n", json!(list)));
        }
        let rows: Vec<Vec<String>> = gpu.adapters().iter().enumerate().map(row).collect();
        let header = ["number", "device", "kind", "driver", "largest table, MB", "f64"];
        terminal::print(&terminal::table(&header, &rows, &[true, false, false, false, true, false]))
    }
}

fn kind(adapter: &Adapter) -> &'static str {
    match adapter.kind() {
        AdapterKind::Discrete => "card",
        AdapterKind::Integrated => "in the processor",
        AdapterKind::Virtual => "virtual",
        AdapterKind::Other => "unknown",
        AdapterKind::Software => "software",
    }
}

fn row((number, adapter): (usize, &Adapter)) -> Vec<String> {
    vec![
        number.to_string(),
        adapter.name().to_owned(),
        kind(adapter).to_owned(),
        adapter.driver(),
        (adapter.largest_buffer() / 1_000_000).to_string(),
        if adapter.has_f64() { "yes" } else { "no" }.to_owned(),
    ]
}

fn as_json(adapter: &Adapter) -> serde_json::Value {
    json!({
        "name": adapter.name(),
        "kind": kind(adapter),
        "driver": adapter.driver(),
        "largest_table_bytes": adapter.largest_buffer(),
        "f64": adapter.has_f64(),
    })
}
