//! The device of a sub-command: the CPU or a graphics card.

use crate::failure::Failure;
use crate::terminal;
use clap::Args;
use clap::builder::PossibleValuesParser;
use rayweave::device::{Device, DeviceEvaluator, DeviceOptions};
use rayweave::model::Program;
use rayweave::photon::Detector;
use rayweave::photon_simulator::PhotonSimulator;
use std::sync::{Arc, Once};

/// The device that answers ray queries.
#[derive(Args)]
pub struct DeviceArguments {
    /// Device: cpu, gpu (a graphics card; in programs built with the feature `gpu`) or auto (a graphics card if there is one that
    /// can hold the model); all return the same answers, bit for bit
    #[arg(long, value_name = "NAME", default_value = Device::NAMES[0], value_parser = PossibleValuesParser::new(Device::NAMES))]
    device: String,

    /// Number of the graphics card, as listed by `rayweave devices`; in programs built with the feature `gpu` [default: the best]
    #[arg(long, value_name = "K")]
    adapter: Option<usize>,
}

/// An evaluator on the chosen device.
pub struct Chosen {
    pub evaluator: DeviceEvaluator,
    quiet: bool,
}

impl DeviceArguments {
    /// Compiles a program for the device; `evaluator` is the name of an evaluator of the CPU. If `auto` chooses the CPU, a note
    /// says so once.
    pub fn choose(
        &self,
        evaluator: Option<&str>,
        program: Arc<Program>,
        quiet: bool,
    ) -> Result<Chosen, Failure> {
        let evaluator = DeviceEvaluator::new(self.options()?, evaluator, program)?;
        note(evaluator.notice(), quiet);
        Ok(Chosen { evaluator, quiet })
    }

    /// The device for the photons of a detector. `records` states whether histories are recorded.
    pub fn choose_for_photons(
        &self,
        detector: &Detector,
        records: bool,
        quiet: bool,
    ) -> Result<PhotonSimulator, Failure> {
        let simulator = PhotonSimulator::new(self.options()?, detector, records)?;
        note(simulator.notice(), quiet);
        Ok(simulator)
    }

    /// The choice.
    fn options(&self) -> Result<DeviceOptions, Failure> {
        let options = DeviceOptions { device: self.device.parse()?, adapter: self.adapter };
        if options.device == Device::Cpu && self.adapter.is_some() {
            let text = "--adapter selects a graphics card, and the device is `cpu`: add --device gpu.";
            return Err(Failure::Usage(text.to_owned()));
        }
        Ok(options)
    }
}

impl Chosen {
    /// Checks after the queries that the device has answered them, and fails with `--device gpu` if it has not.
    pub fn finish(&self) -> Result<(), Failure> {
        note(self.evaluator.finish()?.as_deref(), self.quiet);
        Ok(())
    }

    /// The line of a summary with the share of the card; empty on the CPU.
    pub fn summary(&self) -> String {
        self.evaluator.report().map_or(String::new(), |report| format!("{report}\n"))
    }
}

/// Prints, once, the reason why the CPU computes everything.
pub fn note(reason: Option<&str>, quiet: bool) {
    static SAID: Once = Once::new();
    if let Some(reason) = reason.filter(|_| !quiet) {
        SAID.call_once(|| terminal::note(&format!("the CPU is used: {reason}")));
    }
}
