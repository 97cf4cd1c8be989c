//! The extension module of the Python package `rayweave`: exact ray queries on NumPy arrays.
//!
//! This is the compiled part, `rayweave._core`; the part written in Python contains the code that
//! is not performance-critical.

mod along;
mod answer;
mod arrays;
mod build;
mod camera;
mod check;
mod crossings;
mod device;
mod diff;
mod distance;
mod drawing;
mod engine;
mod error;
mod explain;
mod files;
mod hit_array;
mod hits;
mod infill;
mod interrupt;
mod layout;
mod measure;
mod model;
mod nearest;
mod occurrences;
mod optics;
mod outline;
mod photons;
mod pickle;
mod points;
mod polygons;
mod progress;
mod rays;
mod render;
mod repr;
mod rootray;
mod save;
mod section;
mod shapes;
mod solid;
mod solid_scene;
mod space;
mod subject;
mod thickness;
mod timeline;
mod to_mesh;
mod triangulate;
mod vectors;

use mimalloc::MiMalloc;
use pyo3::pymodule;

#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// The compiled half of the package: import from `rayweave` instead.
#[pymodule]
mod _core {
    use crate::space::solid::PySpaceSolid;
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::arrays::number_list;
    #[pymodule_export]
    use crate::check::check_rows;
    #[pymodule_export]
    use crate::device::devices;
    #[pymodule_export]
    use crate::diff::diff_columns;
    #[pymodule_export]
    use crate::error::{RayweaveError, require_input};
    #[pymodule_export]
    use crate::explain::PyExplanation;
    #[pymodule_export]
    use crate::files::PyAtomicFile;
    #[pymodule_export]
    use crate::hit_array::{array_csg, count_array};
    #[pymodule_export]
    use crate::infill::infill_columns;
    #[pymodule_export]
    use crate::measure::measure_columns;
    #[pymodule_export]
    use crate::model::{PyModel, load_model, loads};
    #[pymodule_export]
    use crate::optics::arrivals::PyArrivals;
    #[pymodule_export]
    use crate::optics::component::{PySheet, lensmaker, optical_component};
    #[pymodule_export]
    use crate::optics::design::{optimise, tolerance};
    #[pymodule_export]
    use crate::optics::element::PyElement;
    #[pymodule_export]
    use crate::optics::file::{load_optics, loads_optics};
    #[pymodule_export]
    use crate::optics::glass::{PyGlass, glass_names};
    #[pymodule_export]
    use crate::optics::medium::PyGradedMedium;
    #[pymodule_export]
    use crate::optics::prescription::{PyPrescription, coordinate_break, pupil_points};
    #[pymodule_export]
    use crate::optics::segments::event_names;
    #[pymodule_export]
    use crate::optics::source::PySource;
    #[pymodule_export]
    use crate::optics::stream::PyStream;
    #[pymodule_export]
    use crate::optics::system::PySystem;
    #[pymodule_export]
    use crate::optics::zernike::{zernike_fit, zernike_term, zernike_values};
    #[pymodule_export]
    use crate::outline::{extrude_outline, revolve_outline};
    #[pymodule_export]
    use crate::photons::compare::compare_photons;
    #[pymodule_export]
    use crate::photons::curves::photon_property_svg;
    #[pymodule_export]
    use crate::photons::detector::{PyDetector, load_detector, loads_detector};
    #[pymodule_export]
    use crate::photons::histories::PyHistories;
    #[pymodule_export]
    use crate::photons::hits::PyPhotonHits;
    #[pymodule_export]
    use crate::photons::run::PyPhotonRun;
    #[pymodule_export]
    use crate::photons::source::PyPhotonSource;
    #[pymodule_export]
    use crate::photons::tables::PyTables;
    #[pymodule_export]
    use crate::polygons::{PyPolygons, region_from_polygons};
    #[pymodule_export]
    use crate::render::{notebook_picture, render_array, sheet_svg, technical_svg};
    #[pymodule_export]
    use crate::rootray::{PyRootRay, count_surfaces, least_separation, root_problems};
    #[pymodule_export]
    use crate::section::{PySection, section_from_parts, section_list, section_text};
    #[pymodule_export]
    use crate::shapes::{manuals, shape};
    #[pymodule_export]
    use crate::solid::{PySolid, empty, intersection, place, solid_from_bytes, union, universe};
    #[pymodule_export]
    use crate::space::curve::{PyArc, PyCurve, PyHelix, PyLine, PyParabola, PySpline};
    #[pymodule_export]
    use crate::space::solid::{
        space_join, space_shape, space_solid_from_steps, space_trace, space_trace_along,
    };
    #[pymodule_export]
    use crate::thickness::thickness_maps;
    #[pymodule_export]
    use crate::timeline::{ray_timeline_svg, timeline_svg};
    #[pymodule_export]
    use crate::triangulate::{exact_volume, mesh_defects, mesh_file_parts, mesh_parts};

    /// Registers the class `Solid` of another module under a different name.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("SpaceSolid", module.py().get_type::<PySpaceSolid>())
    }
}
