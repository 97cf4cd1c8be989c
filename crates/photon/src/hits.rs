//! Hits: the detected photons as columns.

use crate::detector::Detector;
use crate::error::PhotonError;
use crate::photon::Photon;
use crate::property::wavelength_nm;
use crate::volume::VolumePaths;
use rayweave_error::Message;
use rayweave_model::Face;
use rayweave_table::{Chunk, Column, DType, Schema, TableError, TableRow, TableWriter, Values};
use std::path::Path;
use std::sync::Arc;

/// The genstep of photons of other sources.
const NO_GENSTEP: i64 = -1;

/// The detected photons, in the order of their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hits {
    /// The number of the event.
    pub event: Vec<i64>,
    /// The number of the photon in the event; all photons of a wavelength shifter have that of the absorbed one.
    pub photon: Vec<i64>,
    /// The position in mm: x, y, z.
    pub position: [Vec<f64>; 3],
    /// The time in ns.
    pub time: Vec<f64>,
    /// The direction: a unit vector.
    pub direction: [Vec<f64>; 3],
    /// The polarisation: a unit vector.
    pub polarisation: [Vec<f64>; 3],
    /// The wavelength in nm.
    pub wavelength_nm: Vec<f64>,
    /// The number of steps before the detection.
    pub steps: Vec<i64>,
    /// The path of the sensor: an index into [`Hits::paths`].
    pub sensor: Vec<u32>,
    /// The number of the genstep that emitted the photon, -1 for photons of other sources; `None` for runs without gensteps.
    pub genstep: Option<Vec<i64>>,
    volumes: VolumePaths,
}

/// True if the last steps of a path are those of a text; their numbers may be left out there.
fn ends_with_steps(path: &str, text: &str) -> bool {
    let mut steps = path.rsplit('/');
    text.rsplit('/').all(|wanted| {
        steps.next().is_some_and(|step| {
            step == wanted || step.split_once('[').is_some_and(|(name, _)| name == wanted)
        })
    })
}

impl Hits {
    /// The size of a hit in bytes.
    pub(crate) const ROW: u64 = 14 * 8 + 4;

    /// The number of hits.
    #[must_use]
    pub fn len(&self) -> usize {
        self.photon.len()
    }

    /// True without hits.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.photon.is_empty()
    }

    /// The paths of sensors: the names and copy numbers of the placements that lead to the volume.
    #[must_use]
    pub fn paths(&self) -> &[Arc<str>] {
        self.volumes.names()
    }

    /// The copy number of each path: that of the innermost placement with a number, or -1 without one.
    #[must_use]
    pub fn copies(&self) -> &[i64] {
        self.volumes.copies()
    }

    /// The numbers of the sensors whose path ends with a text, as for sources in volumes: `SiPM[1]` or `Gap[3]/SiPM`, where a step
    /// without a number matches all copies; `all` selects all sensors.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] if there is no such sensor.
    pub fn sensors_named(&self, text: &str) -> Result<Vec<u32>, PhotonError> {
        let found = |path: &str| text == "all" || ends_with_steps(path, text);
        let paths = self.paths().iter().zip(0..);
        let numbers: Vec<u32> = paths.filter(|(path, _)| found(path)).map(|(_, number)| number).collect();
        match numbers.is_empty() {
            true => {
                let paths = self.paths().iter().map(|path| &**path);
                Err(PhotonError::Setting(Message::unknown("sensor", text, paths)))
            }
            false => Ok(numbers),
        }
    }

    /// Some of the hits by their rows, with the numbers of all sensors.
    ///
    /// # Panics
    ///
    /// If a row does not exist.
    #[must_use]
    pub fn select(&self, rows: &[usize]) -> Hits {
        fn of<T: Copy>(rows: &[usize], column: &[T]) -> Vec<T> {
            rows.iter().map(|&row| column[row]).collect()
        }
        let vector = |columns: &[Vec<f64>; 3]| columns.each_ref().map(|column| of(rows, column));
        Hits {
            event: of(rows, &self.event),
            photon: of(rows, &self.photon),
            position: vector(&self.position),
            time: of(rows, &self.time),
            direction: vector(&self.direction),
            polarisation: vector(&self.polarisation),
            wavelength_nm: of(rows, &self.wavelength_nm),
            steps: of(rows, &self.steps),
            sensor: of(rows, &self.sensor),
            genstep: self.genstep.as_ref().map(|column| of(rows, column)),
            volumes: self.volumes.clone(),
        }
    }

    /// Adds a hit in the volume of a region that is entered through a face. The number of its sensor is that in `known`, which
    /// keeps paths for further hits, until [`sort`](Hits::sort).
    pub(crate) fn push(
        &mut self,
        (event, number): (u32, u64),
        steps: u32,
        photon: &Photon,
        (detector, known): (&Detector, &mut VolumePaths),
        (region, face): (u32, Face),
    ) {
        self.event.push(i64::from(event));
        self.photon.push(number as i64);
        let vectors = [
            (&mut self.position, photon.position),
            (&mut self.direction, photon.direction),
            (&mut self.polarisation, photon.polarisation),
        ];
        for (columns, vector) in vectors {
            columns.iter_mut().zip(vector.to_array()).for_each(|(column, value)| column.push(value));
        }
        self.time.push(photon.time);
        self.wavelength_nm.push(wavelength_nm(photon.energy));
        self.steps.push(i64::from(steps));
        self.sensor.push(known.number_entered(detector, region, face, &photon.ray()));
    }

    /// Adds a row of a table with the columns of [`hit_schema`], in this order.
    ///
    /// # Errors
    ///
    /// [`TableError::Table`] for a value that the column cannot have.
    pub(crate) fn push_row(&mut self, row: &TableRow<'_>, has_gensteps: bool) -> Result<(), TableError> {
        self.event.push(row.integer(0)?);
        self.photon.push(row.integer(1)?);
        let vectors = [(&mut self.position, 2), (&mut self.direction, 6), (&mut self.polarisation, 9)];
        for (columns, first) in vectors {
            for (column, k) in columns.iter_mut().zip(first..) {
                column.push(row.float(k)?);
            }
        }
        self.time.push(row.float(5)?);
        self.wavelength_nm.push(row.float(12)?);
        self.steps.push(row.integer(13)?);
        self.sensor.push(self.volumes.number_of(row.text(14)?));
        if has_gensteps {
            self.genstep.get_or_insert_default().push(row.integer(15)?);
        }
        Ok(())
    }

    /// Sorts by the number of the photon, then by steps; equal ones keep their order. `known` are the paths of the sensors.
    pub(crate) fn sort(&mut self, known: &VolumePaths) {
        let mut order: Vec<usize> = (0..self.len()).collect();
        order.sort_by_key(|&row| (self.photon[row], self.steps[row]));
        let vectors = [&mut self.position, &mut self.direction, &mut self.polarisation];
        let columns = vectors.into_iter().flatten().chain([&mut self.time, &mut self.wavelength_nm]);
        columns.for_each(|column| *column = order.iter().map(|&row| column[row]).collect());
        for column in [&mut self.event, &mut self.photon, &mut self.steps] {
            *column = order.iter().map(|&row| column[row]).collect();
        }
        self.sensor = order.iter().map(|&row| self.sensor[row]).collect();
        // in the order of the sorted hits, so that the numbers do not depend on the batches of a run
        self.volumes = known.used_by(&mut self.sensor);
    }

    /// True if the hits of the photons with numbers below `end`, which come first, are others, bit for bit.
    #[cfg(feature = "gpu")]
    pub(crate) fn begins_with(&self, other: &Hits, end: u64) -> bool {
        let count = self.photon.partition_point(|&photon| (photon as u64) < end);
        let numbers = |hits: &Hits, row: usize| {
            let vectors = [&hits.position, &hits.direction, &hits.polarisation].into_iter().flatten();
            let columns = vectors.chain([&hits.time, &hits.wavelength_nm]);
            columns.map(|column| column[row].to_bits()).collect::<Vec<_>>()
        };
        let path = |hits: &Hits, row: usize| hits.paths()[hits.sensor[row] as usize].clone();
        let words = |hits: &Hits, row: usize| (hits.photon[row], hits.steps[row], path(hits, row));
        let is_equal =
            |row| numbers(self, row) == numbers(other, row) && words(self, row) == words(other, row);
        count == other.len() && (0..count).all(is_equal)
    }

    /// Numbers the sensors in the order of the detector ([`Detector::sensor_paths`]), with those without hits: equal numbers in all
    /// runs. The numbers are otherwise in the order of the hits.
    pub fn number_by(&mut self, detector: &Detector) {
        self.volumes.renumber_by(detector.sensor_paths(), &mut self.sensor);
    }

    /// Appends other hits.
    pub fn append(&mut self, mut other: Hits) {
        self.append_gensteps(other.genstep.take(), other.len());
        self.event.append(&mut other.event);
        self.photon.append(&mut other.photon);
        let pairs = [
            (&mut self.position, &mut other.position),
            (&mut self.direction, &mut other.direction),
            (&mut self.polarisation, &mut other.polarisation),
        ];
        for (own, others) in pairs {
            own.iter_mut().zip(others).for_each(|(own, other)| own.append(other));
        }
        self.time.append(&mut other.time);
        self.wavelength_nm.append(&mut other.wavelength_nm);
        self.steps.append(&mut other.steps);
        let numbers = self.volumes.absorb(&other.volumes);
        self.sensor.extend(other.sensor.iter().map(|&sensor| numbers[sensor as usize]));
    }

    /// Appends the gensteps of `rows` other hits, before these are appended.
    fn append_gensteps(&mut self, other: Option<Vec<i64>>, rows: usize) {
        if self.genstep.is_none() && other.is_none() {
            return;
        }
        let count = self.len();
        let own = self.genstep.get_or_insert_with(|| vec![NO_GENSTEP; count]);
        own.extend(other.unwrap_or_else(|| vec![NO_GENSTEP; rows]));
    }

    /// The hits as rows of a table with the columns of [`hit_schema`].
    ///
    /// # Errors
    ///
    /// None: the columns are of equal length.
    pub fn to_rows(&self) -> Result<Chunk, TableError> {
        let mut columns: Vec<Values> = vec![self.event.clone().into(), self.photon.clone().into()];
        columns.extend(self.position.iter().cloned().map(Values::from));
        columns.push(self.time.clone().into());
        columns.extend(self.direction.iter().chain(&self.polarisation).cloned().map(Values::from));
        columns.push(self.wavelength_nm.clone().into());
        columns.push(self.steps.clone().into());
        let path = |&sensor: &u32| self.paths()[sensor as usize].clone();
        columns.push(Values::Text(self.sensor.iter().map(path).collect()));
        columns.extend(self.genstep.iter().cloned().map(Values::from));
        Chunk::new(columns)
    }
}

/// Creates a table of hits with the columns of [`hit_schema`]. In NPY, the file of names lists the sensors of the detector in their
/// order ([`Detector::sensor_paths`]), so that `sensor` has the same numbers in all tables.
///
/// # Errors
///
/// Those of [`TableWriter::create`].
pub fn hit_table(path: &Path, detector: &Detector, has_gensteps: bool) -> Result<TableWriter, TableError> {
    let mut table = TableWriter::create(path, &hit_schema(has_gensteps)?)?;
    table.list_texts("sensor", detector.sensor_paths().iter().map(|(sensor, _)| sensor.as_str()));
    Ok(table)
}

/// The columns of a table of hits: `event`, `photon`; `x`, `y`, `z` in mm; `time` in ns; the direction `dx`, `dy`, `dz`; the
/// polarisation `px`, `py`, `pz`; `wavelength_nm`; `steps`; `sensor`, a path; and for a run of gensteps `genstep`, the number of
/// the genstep. The parts of a run have rows of one table.
///
/// # Errors
///
/// None: the names are fixed.
pub fn hit_schema(has_gensteps: bool) -> Result<Schema, TableError> {
    let mut columns = vec![Column::new("event", DType::I64), Column::new("photon", DType::I64)];
    columns.extend(["x", "y", "z"].map(|name| Column::new(name, DType::F64).unit("mm")));
    columns.push(Column::new("time", DType::F64).unit("ns"));
    columns.extend(["dx", "dy", "dz", "px", "py", "pz"].map(|name| Column::new(name, DType::F64)));
    columns.push(Column::new("wavelength_nm", DType::F64).unit("nm"));
    columns.push(Column::new("steps", DType::I64));
    columns.push(Column::new("sensor", DType::Text));
    columns.extend(has_gensteps.then(|| Column::new("genstep", DType::I64)));
    Schema::new(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sensors_are_found_by_the_ends_of_their_paths() {
        let path = "Matrix/Gap[5]/SiPM[1]";
        for text in ["SiPM", "SiPM[1]", "Gap/SiPM", "Gap[5]/SiPM", "Gap/SiPM[1]", "Matrix/Gap[5]/SiPM[1]"] {
            assert!(ends_with_steps(path, text), "{text}");
        }
        for text in ["", "PM[1]", "SiPM[0]", "Gap", "Gap[4]/SiPM", "World/Matrix/Gap[5]/SiPM[1]", "SiPM/"] {
            assert!(!ends_with_steps(path, text), "{text}");
        }
    }
}
