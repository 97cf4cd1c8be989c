//! Whether points are inside.

use std::ops::Range;

use numpy::PyArray1;
use numpy::ndarray::ArrayView2;
use pyo3::prelude::*;
use rayweave::model::{Evaluator, RegionId};

use crate::arrays::room;
use crate::engine::{Engine, How, Question, inside};
use crate::rays::{Columns, Vectors};

struct ContainsQuestion<'a>(ArrayView2<'a, f64>);

impl Question for ContainsQuestion<'_> {
    type Answer = Vec<bool>;
    type Scratch = (Columns, Vec<RegionId>);

    fn len(&self) -> usize {
        self.0.nrows()
    }

    fn answer<E: Evaluator>(
        &self,
        evaluator: &E,
        chunk: Range<usize>,
        memory: &mut E::Scratch,
        (columns, regions): &mut Self::Scratch,
    ) -> Vec<bool> {
        regions.clear();
        regions.resize(chunk.len(), RegionId(0));
        evaluator.regions_at(columns.points(self.0, chunk), memory, regions);
        regions.iter().map(|&region| inside(evaluator.program(), region)).collect()
    }
}

/// Whether each point is inside: bool (N,).
pub fn contains<'py>(
    engine: &Engine,
    points: &Bound<'py, PyAny>,
    how: &How,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let vectors = Vectors::new(points, "points")?;
    let question = ContainsQuestion(vectors.view());
    let mut inside = room(question.len())?;
    engine.ask(points.py(), how, &question, |mut chunk| inside.append(&mut chunk))?;
    Ok(PyArray1::from_vec(points.py(), inside))
}
