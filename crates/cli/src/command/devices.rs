//! `rayweave devices`: the graphics cards of this machine.

use crate::failure::Failure;
use crate::terminal;
use clap::Args;
use rayweave::device::{self, DeviceInfo};
use rayweave::gpu::GpuError;
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
        let devices = device::list()?;
        if devices.is_empty() {
            return Err(Failure::Run(GpuError::NoAdapter.to_string()));
        }
        if self.json {
            let list: Vec<_> = devices.iter().map(as_json).collect();
            return terminal::print(&format!("{:#}\n", json!(list)));
        }
        let rows: Vec<Vec<String>> = devices.iter().enumerate().map(row).collect();
        let header = ["number", "device", "kind", "driver", "largest table, MB", "f64"];
        terminal::print(&terminal::table(&header, &rows, &[true, false, false, false, true, false]))
    }
}

fn row((number, device): (usize, &DeviceInfo)) -> Vec<String> {
    vec![
        number.to_string(),
        device.name.clone(),
        device.kind.to_owned(),
        device.driver.clone(),
        (device.largest_table_bytes / 1_000_000).to_string(),
        if device.has_f64 { "yes" } else { "no" }.to_owned(),
    ]
}

fn as_json(device: &DeviceInfo) -> serde_json::Value {
    json!({
        "name": device.name,
        "kind": device.kind,
        "driver": device.driver,
        "largest_table_bytes": device.largest_table_bytes,
        "f64": device.has_f64,
    })
}
