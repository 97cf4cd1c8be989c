//! The words of a line.

/// The finite number at a place of a line.
pub(super) fn number(words: &[&str], place: usize) -> Result<f64, String> {
    let word = words.get(place).ok_or_else(|| format!("number {} of the line is missing", place + 1))?;
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{word:?} is not a number")),
    }
}
