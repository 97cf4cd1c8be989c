//! Rows of tables without content.

/// For each row the nearest row that is not empty; of two equally near ones the smaller. `None` if all are empty.
pub(super) fn nearest_rows(filled: &[bool]) -> Option<Vec<usize>> {
    let nearest = |row: usize| {
        let distance = |other: &usize| other.abs_diff(row);
        (0..filled.len()).filter(|other| filled[*other]).min_by_key(distance)
    };
    (0..filled.len()).map(nearest).collect()
}
