//! Explanation of a query result, as a Python class.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};
use rayweave::model::{Program, Window};
use rayweave::shape::Ray;
use rayweave::trace::single_hit::{
    Entry, ExplainedOperand, Explanation, ExplanationText, Found, MAX_LINES, Question, ValueStep, Verdict,
    What,
};

use crate::error::bad_value;
use crate::vectors::{direction, vector};

/// Creates an instance of a class of `rayweave._explain`.
macro_rules! record {
    ($py:expr, $class:literal, $fields:expr) => {{
        static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
        CLASS.import($py, "rayweave._explain", $class)?.call((), Some(&$fields))
    }};
}

/// Explanation of the answer for one ray: printed as text, with the same contents as data in its attributes.
///
/// >>> import rayweave as rw
/// >>> explanation = rw.box(2).named("die").explain([-3, 0, 0], [1, 0, 0])
/// >>> [(passage.t, passage.face) for passage in explanation.crossings]
/// [(2.0, 'die.x-'), (4.0, 'die.x+')]
/// >>> explanation.start == "the world"
/// True
#[pyclass(frozen, module = "rayweave", name = "Explanation")]
pub struct PyExplanation {
    explanation: Explanation,
    questions: PyOnceLock<Py<PyTuple>>,
    /// The solid or model, and the window of the query: they suffice to compute the explanation again.
    subject: Py<PyAny>,
    window: [f64; 2],
}

/// A function that explains the answer of a solid or model, and its argument.
type Again<'py> = (Bound<'py, PyAny>, (Bound<'py, PyAny>,));

/// Explains the crossings of one ray.
pub fn explain(
    program: &Arc<Program>,
    subject: &Bound<'_, PyAny>,
    [origin, along]: [&Bound<'_, PyAny>; 2],
    [t_min, t_max]: [f64; 2],
) -> PyResult<PyExplanation> {
    let window = Window::new(t_min, t_max)
        .map_err(|error| bad_value(format!("t_min = {t_min}, t_max = {t_max}: {error}")))?;
    let ray = Ray::new(vector(origin, "origin")?, direction(along, "direction")?);
    let explanation = origin.py().detach(|| rayweave::explain(program, ray, window)).map_err(bad_value)?;
    let (subject, window) = (subject.clone().unbind(), [t_min, t_max]);
    Ok(PyExplanation { explanation, questions: PyOnceLock::new(), subject, window })
}

#[pymethods]
impl PyExplanation {
    /// The pickle has the solid or model, and the question: the answer is the same, bit for bit.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Again<'py>> {
        let (ray, [t_min, t_max]) = (&self.explanation.ray, self.window);
        let arguments = ("explain", ray.origin.to_array(), ray.direction.to_array(), t_min, t_max);
        let again = py.import("operator")?.getattr("methodcaller")?.call1(arguments)?;
        Ok((again, (self.subject.bind(py).clone(),)))
    }

    /// The name of the region just after t_min: "the world" where there is none.
    #[getter]
    fn start(&self) -> String {
        self.region(self.explanation.start.0).to_string()
    }

    /// Queries to the model, in order: see `Question`.
    #[getter]
    #[cfg_attr(false, stub("() -> tuple[Question, ...]"))]
    fn questions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let make = || -> PyResult<Py<PyTuple>> {
            let text = self.explanation.text(usize::MAX);
            let questions =
                self.explanation.questions.iter().map(|question| self.question(py, &text, question));
            Ok(PyTuple::new(py, questions.collect::<PyResult<Vec<_>>>()?)?.unbind())
        };
        Ok(self.questions.get_or_try_init(py, make)?.bind(py).clone())
    }

    /// The crossings, which are the answer: see `Passage`.
    #[getter]
    #[cfg_attr(false, stub("() -> tuple[Passage, ...]"))]
    fn crossings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let passage = |Found { crossing, face }: &Found| {
            let fields = PyDict::new(py);
            fields.set_item("t", crossing.t)?;
            fields.set_item("before", &**self.region(crossing.before.0))?;
            fields.set_item("after", &**self.region(crossing.after.0))?;
            fields.set_item("face", &**face)?;
            record!(py, "Passage", fields)
        };
        PyTuple::new(py, self.explanation.crossings.iter().map(passage).collect::<PyResult<Vec<_>>>()?)
    }

    /// Number of changes of medium that were welded with their neighbours, because the ray stays within `delta` of both
    /// surfaces between them.
    #[getter]
    fn welded(&self) -> usize {
        self.explanation.welded
    }

    /// Number of shapes queried and decisions made, over all queries.
    #[getter]
    fn steps(&self) -> usize {
        self.explanation.steps()
    }

    /// The text with at most `lines` lines of decisions, None for all of them; omitted lines are counted.
    #[pyo3(signature = (lines = Some(MAX_LINES)))]
    fn story(&self, py: Python<'_>, lines: Option<usize>) -> PyResult<String> {
        match lines {
            Some(0) => Err(bad_value("lines is 0: it must be at least 1.")),
            lines => Ok(py.detach(|| self.explanation.text(lines.unwrap_or(usize::MAX)).to_string())),
        }
    }

    fn __str__(&self) -> String {
        self.explanation.to_string()
    }

    fn __repr__(&self) -> String {
        let (questions, crossings) = (self.explanation.questions.len(), self.explanation.crossings.len());
        format!(
            "<Explanation: {questions} questions, {} steps, {crossings} crossings>",
            self.explanation.steps()
        )
    }
}

impl PyExplanation {
    fn region(&self, number: u32) -> &Arc<str> {
        &self.explanation.regions[number as usize]
    }

    fn question<'py>(
        &self,
        py: Python<'py>,
        text: &ExplanationText<'_>,
        question: &Question,
    ) -> PyResult<Bound<'py, PyAny>> {
        let entries = question.entries.iter().map(|entry| self::entry(py, text, entry));
        let fields = PyDict::new(py);
        fields.set_item("t_min", question.t_min)?;
        fields.set_item("entries", PyTuple::new(py, entries.collect::<PyResult<Vec<_>>>()?)?)?;
        fields.set_item("repeated", question.repeated)?;
        fields.set_item("left_out", question.left_out)?;
        fields.set_item("t", question.answer.t)?;
        fields.set_item("before", &**self.region(question.answer.before))?;
        fields.set_item("after", &**self.region(question.answer.after))?;
        record!(py, "Question", fields)
    }
}

fn entry<'py>(py: Python<'py>, text: &ExplanationText<'_>, entry: &Entry) -> PyResult<Bound<'py, PyAny>> {
    let fields = PyDict::new(py);
    fields.set_item("node", &*entry.name)?;
    fields.set_item("depth", entry.depth)?;
    fields.set_item("rule", entry.what.rule())?;
    let (verdict, step, face, operands) = match &entry.what {
        What::Leaf { answer, face_name, .. } => {
            ("leaf", ValueStep::from(*answer), face_name.as_deref(), &[][..])
        }
        What::Gate { operands, value, verdict } => {
            let (verdict, step) = match *verdict {
                Verdict::Fixed(value) => ("settled", ValueStep::constant(value)),
                Verdict::Changes(step) => ("changes", step),
                Verdict::QueryAgain { t, .. } => {
                    ("ask again", ValueStep { before: *value, after: *value, t })
                }
            };
            (verdict, step, None, &operands[..])
        }
    };
    fields.set_item("verdict", verdict)?;
    answer(&fields, step)?;
    fields.set_item("face", face)?;
    let operands = operands.iter().map(|operand| self::operand(py, operand));
    fields.set_item("operands", PyTuple::new(py, operands.collect::<PyResult<Vec<_>>>()?)?)?;
    fields.set_item("text", text.sentence(entry))?;
    record!(py, "Entry", fields)
}

fn operand<'py>(py: Python<'py>, operand: &ExplainedOperand) -> PyResult<Bound<'py, PyAny>> {
    let fields = PyDict::new(py);
    fields.set_item("node", &*operand.name)?;
    fields.set_item("complemented", operand.complemented)?;
    answer(&fields, operand.own_answer())?;
    record!(py, "Operand", fields)
}

fn answer(fields: &Bound<'_, PyDict>, step: ValueStep) -> PyResult<()> {
    fields.set_item("before", step.before)?;
    fields.set_item("after", step.after)?;
    fields.set_item("t", step.t)
}
