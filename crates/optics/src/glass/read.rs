//! Shared parts of the readers of glass files: problems with line numbers, numbers, wavelengths in
//! micrometres.

use super::Glass;

/// A problem in a line of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileProblem {
    /// Counted from 1.
    pub line: usize,
    /// The problem, as "problem: reason. Suggestion."
    pub text: String,
}

impl std::fmt::Display for FileProblem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "line {}: {}", self.line, self.text)
    }
}

/// All problems of a file, in the order of its lines.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", listed(problems))]
pub struct GlassFileError {
    problems: Vec<FileProblem>,
    readable: Vec<Glass>,
}

fn listed(problems: &[FileProblem]) -> String {
    problems.iter().map(FileProblem::to_string).collect::<Vec<_>>().join("\n")
}

impl GlassFileError {
    /// The problems, line by line; at least one.
    pub fn problems(&self) -> &[FileProblem] {
        &self.problems
    }

    /// The materials without problems, to continue without the others.
    pub fn into_readable(self) -> Vec<Glass> {
        self.readable
    }
}

/// The materials, if there are no problems.
pub(super) fn finish(
    readable: Vec<Glass>,
    mut problems: Vec<FileProblem>,
) -> Result<Vec<Glass>, GlassFileError> {
    if problems.is_empty() {
        return Ok(readable);
    }
    problems.sort_by_key(|problem| problem.line);
    Err(GlassFileError { problems, readable })
}

/// Converts micrometres to nanometres, rounded to a millionth: 2.325 µm is exactly 2325 nm.
pub(super) fn nm_from_um(um: f64) -> f64 {
    let nm = um * 1e3;
    let rounded = (um * 1e9).round() / 1e6;
    if (rounded - nm).abs() < 1e-12 * nm { rounded } else { nm }
}

/// A finite number.
pub(super) fn number(word: &str) -> Result<f64, String> {
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{word:?} is not a number.")),
    }
}

/// Numbers separated by white space.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split_whitespace().map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn micrometres_in_decimals_give_nanometres_in_decimals() {
        assert_eq!(nm_from_um(1.001), 1001.0);
        assert_eq!(nm_from_um(0.5875618), 587.5618);
        assert_eq!(nm_from_um(1.0 / 3.0), 1000.0 / 3.0);
    }

    #[test]
    fn only_finite_numbers_are_numbers() {
        assert_eq!(numbers(" 1.5E+000\t-2 ").unwrap(), [1.5, -2.0]);
        for bad in ["nan", "inf", "1,5", "x"] {
            assert_eq!(number(bad).unwrap_err(), format!("{bad:?} is not a number."));
        }
    }
}
