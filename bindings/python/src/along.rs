//! Crossings of solids and models along curves in space.

use pyo3::prelude::*;
use rayweave::space::trace_curve;

use crate::crossings::{Table, into_python};
use crate::engine::{Chunking, Engine, thread_argument};
use crate::space::follow::follow;

/// All crossings of one curve, or of each in a list of them.
pub fn crossings_along<'py>(
    engine: &Engine,
    curves: &Bound<'py, PyAny>,
    window: [&Bound<'py, PyAny>; 2],
    threads: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let threads = threads.map(thread_argument).transpose()?;
    let program = &*engine.program;
    let mut tables = Vec::new();
    follow::<3, (), Table>(
        curves,
        window,
        threads,
        || (),
        |(), curve, t0, t1| {
            let found = trace_curve(program, curve, t0, t1)?;
            Ok(Table::of_curve(engine, curve, &found))
        },
        |part| {
            tables.push(part);
            Ok(())
        },
    )?;
    let chunking = Chunking::whole(tables.len());
    into_python(curves.py(), engine, tables, chunking)
}
