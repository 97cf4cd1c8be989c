//! The source of `rayweave photons`: torches, gensteps and lists of photons.

use crate::arguments::{point, time};
use crate::failure::{Failure, unreadable};
use clap::{Args, ValueEnum};
use rayweave::photon::{
    Detector, Directions, GenstepNumbers, Gensteps, LinearDensity, Origin, Photon, PhotonError, Pulse,
    ScintillationLight, Source, SourceVolume, Torch, WavelengthDistribution, gensteps_from_array,
    photons_from_opticks,
};
use rayweave::table::NpyArray;
use rayweave::{Packets, Vec3};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// The arguments that describe a source.
#[derive(Args)]
pub struct SourceArguments {
    /// Kind of the source
    #[arg(long, value_name = "KIND", default_value = "point")]
    source: SourceKind,

    /// Position of the source in mm: the point, the centre of the disc, or the start of the line
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    at: Option<[f64; 3]>,

    /// End of the line, in mm
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    to: Option<[f64; 3]>,

    /// Radius of the disc, in mm
    #[arg(long, value_name = "MM")]
    radius: Option<f64>,

    /// Normal of the disc [default: the direction --towards]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    normal: Option<[f64; 3]>,

    /// Volume of the sources `surface` and `volume`, without its daughters: all of its copies, or those whose path ends with a path,
    /// such as `Crystal[3]` or `Module[1]/Crystal`
    #[arg(long, value_name = "NAME|PATH")]
    volume: Option<String>,

    /// Direction of the photons [default: all directions with equal probability]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    towards: Option<[f64; 3]>,

    /// Largest angle between the photons and the direction --towards, in degrees; those within have equal probability
    #[arg(long, value_name = "DEGREES", requires = "towards", default_value_t = 0.0)]
    cone: f64,

    /// Wavelength in vacuum in nm, or a range A:B with a uniform distribution
    #[arg(long, value_name = "NM", value_parser = interval, allow_hyphen_values = true)]
    wavelength: Option<[f64; 2]>,

    /// Spectrum: a CSV file of wavelengths in nm and densities per nm, linear between them
    #[arg(long, value_name = "FILE", conflicts_with = "wavelength")]
    spectrum: Option<PathBuf>,

    /// Spectrum of a black body with this temperature in K, within the range --wavelength A:B
    #[arg(long, value_name = "K", requires = "wavelength")]
    black_body: Option<f64>,

    /// Scintillation light of this material: its spectrum (SCINTILLATIONCOMPONENT1 and others) and its times, which are added to the
    /// time of emission
    #[arg(long, value_name = "MATERIAL", conflicts_with_all = ["wavelength", "spectrum"])]
    scintillation: Option<String>,

    /// Linear polarisation along the part of this vector that is perpendicular to the photon [default: random]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    polarisation: Option<[f64; 3]>,

    /// Time of emission in ns, or a range A:B with a uniform distribution
    #[arg(long, value_name = "NS", value_parser = interval, allow_hyphen_values = true, default_value = "0")]
    time: [f64; 2],

    /// Standard deviation of a normal distribution that is added to the time of emission, in ns
    #[arg(long, value_name = "NS", value_parser = time, default_value_t = 0.0)]
    time_deviation: f64,

    /// Mean of an exponential distribution that is added to the time of emission, in ns
    #[arg(long, value_name = "NS", value_parser = time, default_value_t = 0.0)]
    time_decay: f64,

    /// Gensteps: Cerenkov and scintillation photons along steps of particles, a NPY file of shape (n, 6, 4) in the layout of
    /// Opticks, or (n, 16) with the fields of Geant4 11.4
    #[arg(long, value_name = "FILE", conflicts_with_all = TORCH_OPTIONS, conflicts_with = "photons")]
    gensteps: Option<PathBuf>,

    /// Name of the material with this number in the gensteps [default: the material that all of their steps are in]. May be
    /// repeated
    #[arg(long = "material", value_name = "NUMBER=NAME", value_parser = material, requires = "gensteps")]
    materials: Vec<(u32, String)>,

    /// Photons: a NPY file of shape (n, 4, 4) in the layout of Opticks
    #[arg(long, value_name = "FILE", conflicts_with_all = TORCH_OPTIONS)]
    photons: Option<PathBuf>,
}

/// The options that describe a torch.
const TORCH_OPTIONS: [&str; 16] = [
    "source",
    "at",
    "to",
    "radius",
    "normal",
    "volume",
    "towards",
    "cone",
    "wavelength",
    "spectrum",
    "black_body",
    "scintillation",
    "polarisation",
    "time",
    "time_deviation",
    "time_decay",
];

/// The kinds of sources.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum SourceKind {
    /// The point --at
    Point,
    /// A flat disc about --at with --radius
    Disc,
    /// The straight line from --at to --to
    Line,
    /// The boundary of --volume; photons start 1 nm inside it
    Surface,
    /// The inside of --volume
    Volume,
}

impl SourceArguments {
    /// True for scintillation light of a material.
    pub fn is_scintillation(&self) -> bool {
        self.scintillation.is_some()
    }

    /// The source. Notes about it are passed to `note`.
    pub fn source(
        &self,
        detector: &Detector,
        evaluator: &Packets,
        note: impl Fn(&str),
    ) -> Result<Source, Failure> {
        match (&self.gensteps, &self.photons) {
            (Some(path), _) => {
                let names: BTreeMap<u32, String> = self.materials.iter().cloned().collect();
                let gensteps = read_gensteps(path)?;
                let gensteps = Gensteps::new(detector, evaluator, &gensteps, &names);
                let gensteps = gensteps.map_err(|error| in_file(path, &error))?;
                gensteps.notes().iter().for_each(|text| note(text));
                Ok(Source::Gensteps(gensteps))
            }
            (None, Some(path)) => read_photons(path).map(Source::Photons),
            (None, None) => self.torch(detector, evaluator).map(Source::Torch),
        }
    }

    fn torch(&self, detector: &Detector, evaluator: &Packets) -> Result<Torch, Failure> {
        let mut torch = Torch::new(self.origin(detector, evaluator)?, self.wavelengths(detector)?)?;
        if let Some(axis) = self.towards {
            torch = torch.towards(Directions::Cone { axis: axis.into(), half_angle: self.cone })?;
        }
        if let Some(vector) = self.polarisation {
            torch = torch.polarised(vector.into())?;
        }
        let (interval, deviation, decay) = (self.time, self.time_deviation, self.time_decay);
        Ok(torch.pulsed(Pulse { interval, deviation, decay })?)
    }

    fn origin(&self, detector: &Detector, evaluator: &Packets) -> Result<Origin, Failure> {
        use SourceKind::{Disc, Line, Point, Surface, Volume};
        let used: [(&str, bool, &[SourceKind]); 5] = [
            ("--at", self.at.is_some(), &[Point, Disc, Line]),
            ("--to", self.to.is_some(), &[Line]),
            ("--radius", self.radius.is_some(), &[Disc]),
            ("--normal", self.normal.is_some(), &[Disc]),
            ("--volume", self.volume.is_some(), &[Surface, Volume]),
        ];
        if let Some((option, ..)) =
            used.iter().find(|(_, is_given, kinds)| *is_given && !kinds.contains(&self.source))
        {
            let kind = self.source.to_possible_value();
            let kind = kind.as_ref().map_or("", |value| value.get_name());
            return Err(Failure::Usage(format!("{option} has no effect on the source `{kind}`.")));
        }
        let missing = |option: &str, kind: &str| {
            Failure::Usage(format!("{option} is missing: the source `{kind}` needs it."))
        };
        let at = |kind: &str| Ok::<Vec3, Failure>(self.at.ok_or_else(|| missing("--at", kind))?.into());
        let volume = |kind: &str| self.volume.as_deref().ok_or_else(|| missing("--volume", kind));
        Ok(match self.source {
            Point => Origin::Point(at("point")?),
            Disc => {
                let axis = self.normal.or(self.towards).ok_or_else(|| missing("--normal", "disc"))?;
                let radius = self.radius.ok_or_else(|| missing("--radius", "disc"))?;
                Origin::Disc { centre: at("disc")?, axis: axis.into(), radius }
            }
            Line => Origin::Line(at("line")?, self.to.ok_or_else(|| missing("--to", "line"))?.into()),
            Surface => Origin::Volume(SourceVolume::boundary(detector, evaluator, volume("surface")?)?),
            Volume => Origin::Volume(SourceVolume::inside(detector, evaluator, volume("volume")?)?),
        })
    }

    fn wavelengths(&self, detector: &Detector) -> Result<WavelengthDistribution, Failure> {
        if let Some(name) = &self.scintillation {
            let light = ScintillationLight::new(detector.named_material(name)?)?;
            return Ok(WavelengthDistribution::Scintillation(light));
        }
        if let Some(path) = &self.spectrum {
            return read_spectrum(path);
        }
        let Some([from, to]) = self.wavelength else {
            let text = "the wavelength is missing: state --wavelength NM, --spectrum FILE or --scintillation MATERIAL.";
            return Err(Failure::Usage(text.to_owned()));
        };
        Ok(match self.black_body {
            Some(temperature) => WavelengthDistribution::black_body(temperature, from, to)?,
            None if from == to => WavelengthDistribution::Single(from),
            None => WavelengthDistribution::uniform(from, to)?,
        })
    }
}

fn bad_file(path: &Path, text: &str) -> Failure {
    Failure::Input(format!("{}: {text}", path.display()))
}

fn in_file(path: &Path, error: &PhotonError) -> Failure {
    bad_file(path, &error.to_string())
}

/// The shape and the numbers of an array; true if they are float32.
fn read_npy(path: &Path) -> Result<(Vec<usize>, Vec<f64>, bool), Failure> {
    let file = File::open(path).map_err(|error| unreadable(path, &error))?;
    let read = NpyArray::read_floats(&mut BufReader::new(file), u64::from(u32::MAX) << 4);
    let (NpyArray { shape, numbers }, is_single) = read.map_err(|error| match error {
        rayweave::table::NpyArrayError::Type(name) => {
            bad_file(path, &format!("its numbers are {name}: they must be float32 or float64."))
        }
        // whole sentences
        rayweave::table::NpyArrayError::Header(text) => bad_file(path, &text),
        error => bad_file(path, &format!("the array cannot be read: {error}.")),
    })?;
    // the numbers are in memory, so that their number is no larger than usize
    let shape = shape.into_iter().map(|own| usize::try_from(own).unwrap_or(usize::MAX)).collect();
    Ok((shape, numbers, is_single))
}

fn read_gensteps(path: &Path) -> Result<Vec<rayweave::photon::Genstep>, Failure> {
    let (shape, numbers, is_single) = read_npy(path)?;
    let read = match is_single {
        true => {
            let numbers: Vec<f32> = numbers.into_iter().map(|number| number as f32).collect();
            gensteps_from_array(&shape, GenstepNumbers::Single(&numbers))
        }
        false => gensteps_from_array(&shape, GenstepNumbers::Double(&numbers)),
    };
    read.map_err(|error| in_file(path, &error))
}

fn read_photons(path: &Path) -> Result<Vec<Photon>, Failure> {
    let (shape, numbers, _) = read_npy(path)?;
    photons_from_opticks(&shape, &numbers).map_err(|error| in_file(path, &error))
}

/// The largest spectrum that is read, in bytes.
const MAX_BYTES: u64 = 1 << 26;

/// Reads a CSV file of two columns, with an optional line of names.
fn read_spectrum(path: &Path) -> Result<WavelengthDistribution, Failure> {
    // pipes and devices state no size
    let file = File::open(path).map_err(|error| unreadable(path, &error))?;
    let mut text = String::new();
    file.take(MAX_BYTES + 1).read_to_string(&mut text).map_err(|error| unreadable(path, &error))?;
    if text.len() as u64 > MAX_BYTES {
        return Err(bad_file(path, &format!("the spectrum has more than {MAX_BYTES} bytes.")));
    }
    let mut points = Vec::new();
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let fields: Vec<Option<f64>> = line.split(',').map(|field| field.trim().parse().ok()).collect();
        match fields[..] {
            [Some(wavelength), Some(value)] => points.push((wavelength, value)),
            // names of columns
            _ if points.is_empty() && number == 0 && fields.iter().all(Option::is_none) => {}
            _ => {
                let text =
                    format!("line {}: two numbers are needed: a wavelength in nm and a density.", number + 1);
                return Err(bad_file(path, &text));
            }
        }
    }
    let area = |pair: &[(f64, f64)]| 0.5 * (pair[1].0 - pair[0].0) * (pair[0].1 + pair[1].1);
    let problem = match points[..] {
        [] => Some("the file has no points: a spectrum has lines of a wavelength in nm and a density."),
        [_] => {
            Some("the file has one point: a spectrum needs two. One wavelength is given with --wavelength.")
        }
        _ if points.windows(2).map(area).sum::<f64>() == f64::INFINITY => {
            Some("the integral of the spectrum overflows: reduce its densities.")
        }
        _ => None,
    };
    if let Some(problem) = problem {
        return Err(bad_file(path, problem));
    }
    let density = LinearDensity::new(points);
    Ok(WavelengthDistribution::Density(
        density.map_err(|error| bad_file(path, &format!("the spectrum is invalid: {error}")))?,
    ))
}

/// Parses one number, or two as A:B.
fn interval(text: &str) -> Result<[f64; 2], String> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let ends = match text.split_once(':') {
        Some((from, to)) => number(from).zip(number(to)),
        None => number(text).map(|number| (number, number)),
    };
    match ends {
        Some((from, to)) if from <= to => Ok([from, to]),
        _ => Err("give one number, or two as A:B, with A at most B".to_owned()),
    }
}

/// Parses `NUMBER=NAME`.
fn material(text: &str) -> Result<(u32, String), String> {
    let pair =
        text.split_once('=').and_then(|(number, name)| Some((number.trim().parse().ok()?, name.trim())));
    match pair {
        Some((number, name)) if !name.is_empty() => Ok((number, name.to_owned())),
        _ => Err("give the number of a material and its name, as in 3=Water".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_and_materials() {
        assert_eq!(interval("420"), Ok([420.0, 420.0]));
        assert_eq!(interval("-1:2.5"), Ok([-1.0, 2.5]));
        for bad in ["", "5:4", "a", "1:inf", "1:2:3"] {
            assert!(interval(bad).is_err(), "{bad}");
        }
        assert_eq!(material("3=Heavy water"), Ok((3, "Heavy water".to_owned())));
        for bad in ["Water", "-1=Water", "3=", "x=Water"] {
            assert!(material(bad).is_err(), "{bad}");
        }
    }
}
