//! Drawings of hits: those of a run, and `rayweave photons draw` for a table of hits.

use super::photon_tables::SurfaceTableArguments;
use crate::arguments::ModelArguments;
use crate::drawing;
use crate::failure::Failure;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args};
use rayweave::detector::{Histogram, HitPositions, MapPlane, MapScale, histograms_svg, hit_maps_svg};
use rayweave::photon::{Detector, Hits, read_hits};
use std::borrow::Cow;
use std::collections::HashSet;
use std::path::PathBuf;

/// Maps and spectra of hits.
#[derive(Args)]
pub struct HitDrawings {
    /// Maps of the hits of each sensor, .svg, .pdf, .png or .jpg; the first of several is a projection of all sensors
    #[arg(long, value_name = "DRAWING")]
    pub map: Option<PathBuf>,

    /// Plane of all maps: yz, xz, xy, or sphere for one map of azimuth and cosine of the polar angle as seen from the origin, with a
    /// marker for each sensor if all are small as seen from there [default:
    /// for each sensor the plane in which it extends most if it is flat, or else its hits]
    #[arg(long, value_name = "PLANE", requires = "map")]
    map_plane: Option<MapPlane>,

    /// Number of cells along the longer side of each map; for the plane sphere along the polar angle, and twice as many along the
    /// azimuth [default: for about 10 hits in a cell, from 4 to 64]
    #[arg(long, value_name = "N", requires = "map", value_parser = map_bins)]
    map_bins: Option<usize>,

    /// Scale of the colours of the maps: linear, or log, which shows sensors with few hits beside those with many; cells without hits
    /// are then grey
    #[arg(long, value_name = "SCALE", requires = "map", default_value = "linear", value_parser = map_scale())]
    map_scale: MapScale,

    /// Sensors to draw as maps, each with a map of its own: those whose path ends with this path, such as SiPM[1] or Gap[3]/SiPM, or
    /// all [default: the hits of all sensors, with maps of the 16 with the most hits]
    #[arg(long, value_name = "PATH", requires = "map")]
    map_sensors: Option<String>,

    /// Spectra of the times and wavelengths of the hits, .svg, .pdf, .png or .jpg
    #[arg(long, value_name = "DRAWING")]
    pub spectra: Option<PathBuf>,

    /// Sensors whose hits the spectra count, as for --map-sensors [default: all]
    #[arg(long, value_name = "PATH", requires = "spectra")]
    spectra_sensors: Option<String>,
}

impl HitDrawings {
    /// True if sensors without hits have numbers in the drawings.
    pub fn needs_all_sensors(&self) -> bool {
        self.map.is_some() || self.spectra_sensors.is_some()
    }

    /// The files to write.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        [&self.map, &self.spectra].into_iter().flatten()
    }

    /// Draws hits whose sensors have the numbers of the detector. `name` is that of the model.
    pub fn draw(&self, hits: &Hits, detector: &Detector, name: &str) -> Result<(), Failure> {
        let chosen = |text: &Option<String>| text.as_ref().map(|text| hits.sensors_named(text)).transpose();
        if let Some(path) = &self.map {
            let chosen = chosen(&self.map_sensors)?;
            let [x, y, z] = &hits.position;
            let (names, sensors) = (hits.paths(), &hits.sensor);
            let hits = HitPositions {
                names,
                sensors,
                positions: [x, y, z],
                extents: detector.sensor_extents(),
                cells: self.map_bins,
                plane: self.map_plane,
                scale: self.map_scale,
                chosen: chosen.as_deref(),
            };
            drawing::save(path, &hit_maps_svg(hits, name, "mm"), name)?;
        }
        let Some(path) = &self.spectra else { return Ok(()) };
        let (of_sensors, title) = match (chosen(&self.spectra_sensors)?, &self.spectra_sensors) {
            (Some(chosen), Some(text)) => {
                let chosen: HashSet<u32> = chosen.into_iter().collect();
                let rows = (0..hits.len()).filter(|&row| chosen.contains(&hits.sensor[row]));
                (Cow::Owned(hits.select(&rows.collect::<Vec<_>>())), format!("Hits: {name}, {text}"))
            }
            _ => (Cow::Borrowed(hits), format!("Hits: {name}")),
        };
        let time = Histogram::new("time", "ns", &of_sensors.time);
        let wavelength = Histogram {
            is_wavelength: true,
            ..Histogram::new("wavelength", "nm", &of_sensors.wavelength_nm)
        };
        drawing::save(path, &histograms_svg(&[time, wavelength], &title), &title)
    }
}

/// Reads the name of a scale of colours.
fn map_scale() -> impl TypedValueParser<Value = MapScale> {
    PossibleValuesParser::new(["linear", "log"]).map(|name| name.parse().unwrap_or_default())
}

/// Parses the number of cells of a map.
fn map_bins(text: &str) -> Result<usize, String> {
    match crate::arguments::any_count::<usize>(text)? {
        bins @ 1..=1023 => Ok(bins),
        bins => Err(format!("{bins} cells cannot be drawn: a map can have 1 to 1023 along its longer side")),
    }
}

/// Draw the hits of a table, such as that of `rayweave merge`, as maps and spectra
///
/// HITS is a table of hits of the detector MODEL, .csv or .npy with its file of names, as `rayweave photons -o` and `rayweave merge` write
/// it. The drawings are those of a run with the same hits.
#[derive(Args)]
#[command(group = ArgGroup::new("drawings").args(["map", "spectra"]).required(true).multiple(true))]
#[command(after_help = "\
Examples:
  rayweave merge part*.npy -o hits.npy
  rayweave photons draw detector.gdml hits.npy --map map.svg --spectra spectra.svg")]
pub struct PhotonDraw {
    #[command(flatten)]
    model: ModelArguments,

    /// Table of hits
    #[arg(value_name = "HITS")]
    hits: PathBuf,

    #[command(flatten)]
    tables: SurfaceTableArguments,

    #[command(flatten)]
    drawings: HitDrawings,
}

impl PhotonDraw {
    pub fn run(&self) -> Result<(), Failure> {
        self.drawings.files().try_for_each(|path| drawing::check(path))?;
        let (document, scene, _) = self.model.load_optical_document()?;
        let detector = Detector::with_tables(&scene, &document, &self.tables.tables()?)?;
        let hits = read_hits(&self.hits, &detector)?;
        self.drawings.draw(&hits, &detector, &self.model.name())
    }
}
