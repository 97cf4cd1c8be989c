//! Errors of writers.

use crate::Format;
use rayweave_error::{Classified, ErrorKind, short_number};
use rayweave_math::Vec3;
use rayweave_mesh::Diagnosis;
use rayweave_mesh_io::FileError;
use rayweave_model::CompileError;
use rayweave_table::TableError;

/// The reason why a scene cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The format has a reader only.
    #[error("files of the format {0} are not written: the format has a reader only. Choose another format.")]
    NotWritten(Format),
    /// The tolerance is not a positive finite length.
    #[error("the tolerance is {0}: it must be finite and greater than 0.")]
    Tolerance(f64),
    /// A solid cannot be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// A region is unbounded.
    #[error(
        "region `{region}` is unbounded: the format {format} needs bounded solids. Intersect it with a box."
    )]
    Unbounded {
        /// Name of the region.
        region: String,
        /// Format of the file.
        format: Format,
    },
    /// The model has no volume, and no reader accepts a mesh without triangles as a solid.
    #[error(
        "the model is empty: a file of the format {0} needs a solid. Check that no part of the model is missing."
    )]
    Empty(Format),
    /// The text or the number of triangles of a region becomes too large.
    #[error("region `{region}` becomes too large: {why}. Increase the tolerance.")]
    TooLarge {
        /// Name of the region.
        region: String,
        /// Limit that is exceeded.
        why: String,
    },
    /// A region has too many shapes for a format without repeated solids.
    #[error(
        "region `{region}` has more than {most} shapes and operators: every copy counts, because the format has no repeated \
         solids. Write the native format (.toml)."
    )]
    Copies {
        /// Name of the region.
        region: String,
        /// Limit that is exceeded.
        most: usize,
    },
    /// No triangles remain of a solid at the tolerance.
    #[error(
        "the solid vanishes at the tolerance {}: no triangles within it enclose a volume. Reduce `--tolerance` (in Python \
         tolerance).", short_number(*.0)
    )]
    Vanished(f64),
    /// A boolean operation on triangle meshes failed.
    #[error("the triangles of region `{region}` cannot be combined: {why}.")]
    Kernel {
        /// Name of the region.
        region: String,
        /// Message of the mesh kernel.
        why: String,
    },
    /// The mesh of a region is not the boundary of a solid.
    #[error(
        "the mesh of region `{region}` is not sound: {defects}{}. Choose another tolerance, make parts that touch regions \
         of their own, as in 3MF files, or write it anyway with --allow-unsound (in Python allow_unsound=True).", place(.at)
    )]
    Unsound {
        /// Name of the region.
        region: String,
        /// The numbers of defects of each kind.
        defects: String,
        /// The position of the first defect that has one, in the unit of the model.
        at: Option<Vec3>,
    },
    /// The mesh writer failed.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file cannot be written.
    #[error(transparent)]
    Output(#[from] TableError),
}

/// The end of a sentence about defects: the position of the first one.
fn place(at: &Option<Vec3>) -> String {
    at.map(|at| format!("; the first is at ({}, {}, {})", at.x, at.y, at.z)).unwrap_or_default()
}

impl WriteError {
    /// The error about a mesh with these defects.
    pub(super) fn unsound(region: &str, found: &Diagnosis) -> WriteError {
        let inside_out = found.components.iter().filter(|shell| shell.is_inside_out()).count();
        let one_sided = found.components.iter().filter(|shell| !shell.is_orientable).count();
        let counts = [
            (found.open_edges, "edges with an odd number of triangles"),
            (found.non_manifold_edges.count, "edges with more than two triangles"),
            (found.crossings.count + found.overlaps.count, "pairs of triangles that intersect"),
            (found.duplicates.count, "pairs of equal triangles"),
            (found.flipped.count, "flipped triangles"),
            (inside_out, "shells inside out"),
            (one_sided, "shells without an orientation"),
            (usize::from(found.is_flat), "mesh without volume"),
            (usize::from(found.uncompared.is_some()), "search for intersections that was given up"),
        ];
        let counts = counts.iter().filter(|(count, _)| *count > 0);
        let defects: Vec<String> = counts.map(|(count, what)| format!("{count} {what}")).collect();
        let at = found
            .non_manifold_edges
            .first
            .first()
            .copied()
            .or(found.holes.first.first().map(|hole| hole.centre))
            .or(found.crossings.first.first().map(|pair| pair.at))
            .or(found.overlaps.first.first().map(|pair| pair.at));
        WriteError::Unsound { region: region.to_owned(), defects: defects.join(", "), at }
    }
}

impl Classified for WriteError {
    fn kind(&self) -> ErrorKind {
        match self {
            WriteError::Compile(error) => error.kind(),
            WriteError::Output(error) => error.kind(),
            // the file is not written
            WriteError::Unsound { .. } | WriteError::Copies { .. } => ErrorKind::Output,
            WriteError::Unbounded { .. }
            | WriteError::Empty(_)
            | WriteError::Vanished(_)
            | WriteError::Kernel { .. } => ErrorKind::Solid,
            _ => ErrorKind::Value,
        }
    }
}
