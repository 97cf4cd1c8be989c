//! Samples from files: tables of steps, of histories and of hits, and arrays of Opticks.

use super::sample::{Alphabet, PhotonSample, SampleTrack, SharedHistories};
use crate::error::PhotonError;
use crate::history::Process;
use rayweave_error::Message;
use rayweave_table::{NpyArray, NpyArrayError, TableReader, TableRow, nearby_sentence, read_npy_words};
use std::collections::HashMap;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// The largest number of words of an array: 16 GiB.
const MAX_NUMBERS: u64 = 1 << 31;

/// The bit SURFACE_DETECT of Opticks' flags (`OpticksPhoton.h`).
const SURFACE_DETECT: u32 = 1 << 6;

/// Reads a sample of photons from a file.
///
/// - A table of steps (columns `photon`, `step`, `process`, ...), of histories (`photon`, `history`, ...) or of hits (`photon`,
///   `sensor`, ...), as `rayweave photons` writes them: .csv, or .npy with the file of names beside it.
/// - Opticks' photons, (n, 4, 4) float32: the detected ones if some have the flag SURFACE_DETECT, else all are hits.
/// - Opticks' sequences, (n, 2, 2) or (n, 2) uint64: the words of the flags are first. Word 0 of all four is that of the first 16 rows.
///
/// # Errors
///
/// [`PhotonError::Table`] and [`PhotonError::Sample`]: the file, the place and the reason.
pub fn read_sample(path: &Path) -> Result<PhotonSample, PhotonError> {
    let name = path.display().to_string();
    let is_csv = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
    if is_csv {
        return table(path, &name);
    }
    match array(path, &name)? {
        Some(sample) => Ok(sample),
        None => table(path, &name),
    }
}

fn unusable(name: &str, reason: impl Into<String>) -> PhotonError {
    let message = Message::new(format!("{name} cannot be compared"), reason);
    PhotonError::Sample(
        message.suggest(
            "Give a table of histories, steps or hits of `rayweave photons`, or an array of Opticks",
        ),
    )
}

/// An array of Opticks; `None` for a table.
fn array(path: &Path, name: &str) -> Result<Option<PhotonSample>, PhotonError> {
    let open = || File::open(path).map_err(|error| unreadable(path, name, &error));
    match read_npy_words(&mut open()?, MAX_NUMBERS) {
        Ok((words, shape)) => return sequences(name, &words, &shape).map(Some),
        Err(NpyArrayError::Type(kind)) if kind.starts_with('[') => return Ok(None),
        Err(NpyArrayError::Type(_)) => {}
        Err(error) => return Err(unusable(name, error.to_string())),
    }
    match NpyArray::read_floats(&mut open()?, MAX_NUMBERS) {
        Ok((array, is_single)) => photons(name, &array, is_single).map(Some),
        Err(NpyArrayError::Type(kind)) => Err(unusable(name, format!("its type is {kind}"))),
        Err(error) => Err(unusable(name, error.to_string())),
    }
}

fn unreadable(path: &Path, name: &str, error: &std::io::Error) -> PhotonError {
    let message = Message::new(format!("{name} cannot be compared"), rayweave_scene::reason(error));
    PhotonError::Sample(match nearby_sentence(path).trim_start() {
        "" => message,
        hint => message.suggest(hint),
    })
}

/// Opticks' sequences.
fn sequences(name: &str, words: &[u64], shape: &[u64]) -> Result<PhotonSample, PhotonError> {
    let size = match shape {
        [_, 2] => 2,
        [_, 2, 2] => 4,
        _ => {
            return Err(unusable(
                name,
                format!("its shape is {shape:?}: sequences have (n, 2, 2) or (n, 2)"),
            ));
        }
    };
    let mut histories = SharedHistories::default();
    let track = |(photon, row): (i64, &[u64])| {
        let slots = (0..32).map(|slot| ((row[slot / 16] >> (4 * (slot % 16))) & 15) as u8);
        let codes: Vec<u8> = slots.take_while(|&code| code != 0).collect();
        SampleTrack { photon, history: histories.share(&codes), ..SampleTrack::default() }
    };
    let tracks: Vec<SampleTrack> = (0..).zip(words.chunks_exact(size)).map(track).collect();
    if let Some(empty) = tracks.iter().position(|track| track.history.is_empty()) {
        return Err(unusable(name, format!("the sequence of row {empty} is empty")));
    }
    Ok(PhotonSample { alphabet: Some(Alphabet::Flags), tracks, ..PhotonSample::new(name) })
}

/// Opticks' photons.
fn photons(name: &str, array: &NpyArray, is_single: bool) -> Result<PhotonSample, PhotonError> {
    let [_, 4, 4] = array.shape[..] else {
        let reason = format!("its shape is {:?}: photons of Opticks have (n, 4, 4)", array.shape);
        return Err(unusable(name, reason));
    };
    let rows: Vec<&[f64]> = array.numbers.chunks_exact(16).collect();
    let is_hit = |row: &&[f64]| is_single && (row[15] as f32).to_bits() & SURFACE_DETECT != 0;
    let is_marked = rows.iter().any(is_hit);
    let mut tracks = Vec::new();
    for (photon, row) in (0..).zip(&rows).filter(|(_, row)| !is_marked || is_hit(row)) {
        let (time, wavelength_nm) = (row[3], row[11]);
        if !(time.is_finite() && wavelength_nm.is_finite()) {
            let reason = format!("photon {photon} has the time {time} and the wavelength {wavelength_nm}");
            return Err(unusable(name, reason));
        }
        tracks.push(SampleTrack { photon, time, wavelength_nm, ..SampleTrack::default() });
    }
    // the rows of a file of hits have no numbers
    let sample = PhotonSample::new(name);
    Ok(PhotonSample { tracks, has_times: true, has_numbers: false, is_single, is_hits: true, ..sample })
}

/// The names of volumes by number.
#[derive(Default)]
struct Names {
    list: Vec<String>,
    numbers: HashMap<String, u32>,
}

impl Names {
    fn number(&mut self, name: &str) -> u32 {
        if let Some(&number) = self.numbers.get(name) {
            return number;
        }
        let number = self.list.len() as u32;
        self.list.push(name.to_owned());
        self.numbers.insert(name.to_owned(), number);
        number
    }
}

/// The columns of a table that are read: by kind of table.
const COLUMNS: [(&str, [&str; 5]); 3] = [
    ("process", ["photon", "process", "volume", "time", "wavelength_nm"]),
    ("history", ["photon", "history", "volume", "time", "wavelength_nm"]),
    ("sensor", ["photon", "sensor", "sensor", "time", "wavelength_nm"]),
];

/// A table of steps, of histories or of hits.
fn table(path: &Path, name: &str) -> Result<PhotonSample, PhotonError> {
    let reader = TableReader::open(path)?;
    let position = |wanted: &str| reader.columns().iter().position(|column| column == wanted);
    let Some((kind, wanted)) = COLUMNS.iter().find(|(own, _)| position(own).is_some()) else {
        return Err(unusable(name, "it has no column `process`, `history` or `sensor`"));
    };
    let column = |wanted: &&str| {
        position(wanted).ok_or_else(|| unusable(name, format!("it has no column `{wanted}` beside `{kind}`")))
    };
    let mut wanted: Vec<usize> = wanted.iter().map(column).collect::<Result<_, _>>()?;
    // tracks of one photon follow each other
    wanted.push(position("track").unwrap_or(wanted[0]));
    let mut builder = Builder { kind, ..Builder::default() };
    reader.read(&wanted, &mut |row| builder.add(row))?;
    builder.end_track();
    let is_hits = *kind == "sensor";
    let mut tracks = builder.tracks;
    tracks.sort_by_key(|track| track.photon);
    Ok(PhotonSample {
        alphabet: (!is_hits).then_some(Alphabet::Processes),
        tracks,
        volumes: Some(builder.volumes.list),
        has_times: true,
        is_hits,
        ..PhotonSample::new(name)
    })
}

/// The tracks of a table so far.
#[derive(Default)]
struct Builder<'a> {
    kind: &'a str,
    tracks: Vec<SampleTrack>,
    /// The track of the last row, and its codes so far.
    last: Option<(i64, i64)>,
    codes: Vec<u8>,
    volumes: Names,
    histories: SharedHistories,
    /// The history of each text that has occurred.
    known: HashMap<String, Arc<[u8]>>,
}

impl Builder<'_> {
    /// Completes the last track of a table of steps.
    fn end_track(&mut self) {
        if let Some(track) = self.tracks.last_mut().filter(|_| !self.codes.is_empty()) {
            track.history = self.histories.share(&self.codes);
            self.codes.clear();
        }
    }

    fn add(&mut self, row: &TableRow<'_>) -> Result<(), rayweave_table::TableError> {
        let (photon, track) = (row.integer(0)?, row.integer(5)?);
        let text = row.text(1)?;
        let end = SampleTrack {
            photon,
            history: Arc::default(),
            volume: self.volumes.number(row.text(2)?),
            time: row.float(3)?,
            wavelength_nm: row.float(4)?,
        };
        match self.kind {
            "process" => {
                let code = code(text).map_err(|reason| row.error(1, &reason))?;
                let is_new = self.last.replace((photon, track)) != Some((photon, track));
                if is_new {
                    self.end_track();
                    self.tracks.push(end);
                } else if let Some(known) = self.tracks.last_mut() {
                    // the last row is the end
                    *known = end;
                }
                self.codes.push(code);
            }
            "history" => {
                if !self.known.contains_key(text) {
                    let codes: Result<Vec<u8>, String> = text.split_whitespace().map(code).collect();
                    let codes = codes.map_err(|reason| row.error(1, &reason))?;
                    if codes.is_empty() {
                        return Err(row.error(1, "the history is empty"));
                    }
                    self.known.insert(text.to_owned(), self.histories.share(&codes));
                }
                self.tracks.push(SampleTrack { history: self.known[text].clone(), ..end });
            }
            _ => self.tracks.push(end),
        }
        Ok(())
    }
}

/// The number of a process.
fn code(name: &str) -> Result<u8, String> {
    let number = Process::ALL.iter().position(|process| process.name() == name);
    number.map(|number| number as u8).ok_or_else(|| format!("no process is called {name:?}"))
}
