//! Hits from files: the tables that runs and `rayweave merge` write.

use crate::detector::Detector;
use crate::error::PhotonError;
use crate::hits::{Hits, hit_schema};
use rayweave_error::Message;
use rayweave_table::TableReader;
use std::path::Path;

/// Reads a table of hits with the columns of [`hit_schema`]: .csv, or .npy with the file of names beside it. The sensors are numbered
/// as in a run of the detector ([`Hits::number_by`]).
///
/// # Errors
///
/// [`PhotonError::Table`] for a file that cannot be read or is damaged, [`PhotonError::Sample`] for another table.
pub fn read_hits(path: &Path, detector: &Detector) -> Result<Hits, PhotonError> {
    let reader = TableReader::open(path)?;
    let position = |wanted: &str| reader.columns().iter().position(|column| column == wanted);
    let has_gensteps = position("genstep").is_some();
    let column = |name: &str| {
        position(name).ok_or_else(|| {
            let problem = format!("{} is not a table of hits", path.display());
            let message = Message::new(problem, format!("it has no column `{name}`"));
            PhotonError::Sample(
                message.suggest("Give a file that `rayweave photons -o` wrote, .csv or .npy."),
            )
        })
    };
    let schema = hit_schema(has_gensteps)?;
    let wanted = schema.columns().iter().map(|own| column(&own.name)).collect::<Result<Vec<usize>, _>>()?;
    let mut hits = Hits::default();
    reader.read(&wanted, &mut |row| hits.push_row(row, has_gensteps))?;
    hits.number_by(detector);
    Ok(hits)
}
