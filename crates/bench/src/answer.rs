//! Results of candidates as lists of times, and comparison of the results of two candidates.

use rayweave::Evaluator;
use rayweave::model::{FirstHitColumns, FirstHits, HitArrayRows, Rays};
use rayweave::{Error, Window};

/// For every ray the times of its crossings, or only of the first.
pub type Lists = Vec<Vec<f64>>;

/// The window t > 0, for the first crossing after t = 0.
pub fn ahead() -> Result<Window, Error> {
    Window::new(0.0, f64::INFINITY).map_err(Error::from)
}

/// The columns of a hit array as lists.
pub fn columns(rows: &[&[f64]], count: usize) -> Lists {
    let column = |ray: usize| rows.iter().map(|row| row[ray]).filter(|t| t.is_finite()).collect();
    (0..count).map(column).collect()
}

/// Buffers of a hit array with faces.
pub struct HitTable {
    times: Vec<f64>,
    faces: Vec<i32>,
    columns: usize,
}

impl HitTable {
    /// Buffers for `rows` entries of each of `rays` rays.
    pub fn new(rows: usize, columns: usize) -> HitTable {
        HitTable { times: vec![0.0; rows * columns], faces: vec![0; rows * columns], columns }
    }

    /// Buffers without faces.
    pub fn of_times(rows: usize, columns: usize) -> HitTable {
        HitTable { faces: Vec::new(), ..HitTable::new(rows, columns) }
    }

    /// The table as rows, for an evaluator to fill.
    pub fn rows(&mut self) -> (Vec<&mut [f64]>, Vec<&mut [i32]>) {
        let columns = self.columns.max(1);
        (self.times.chunks_mut(columns).collect(), self.faces.chunks_mut(columns).collect())
    }

    /// Converts the columns to lists.
    pub fn lists(&self) -> Lists {
        let rows: Vec<&[f64]> = self.times.chunks(self.columns.max(1)).collect();
        columns(&rows, self.columns)
    }
}

/// Buffers of first hits with normals.
#[derive(Default)]
pub struct FirstTable(FirstHitColumns);

impl FirstTable {
    /// Buffers for `rays` rays.
    pub fn new(rays: usize) -> FirstTable {
        FirstTable(FirstHitColumns::new(rays))
    }

    /// The columns, for an evaluator to fill.
    pub fn hits(&mut self) -> FirstHits<'_> {
        self.0.hits()
    }

    /// A list for each ray with the time of its hit, empty for a miss.
    pub fn lists(&self) -> Lists {
        columns(&[&self.0.t], self.0.t.len())
    }
}

/// All crossings by an evaluator.
pub fn full_lists<E: Evaluator>(evaluator: &E, rays: Rays<'_>) -> Lists {
    let mut most = 2;
    loop {
        let mut table = HitTable::new(most, rays.len());
        let (mut times, mut faces) = table.rows();
        let mut rows = HitArrayRows { times: &mut times, faces: &mut faces };
        let needed = evaluator.hits(rays, Window::ALL, &mut evaluator.scratch(), &mut rows);
        if needed <= most {
            return table.lists();
        }
        most = needed;
    }
}

/// The first hits by an evaluator.
pub fn first_lists<E: Evaluator>(evaluator: &E, rays: Rays<'_>) -> Result<Lists, Error> {
    let mut table = FirstTable::new(rays.len());
    evaluator.nearest(rays, ahead()?, &mut evaluator.scratch(), &mut table.hits());
    Ok(table.lists())
}

/// The agreement of the results of two candidates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// The number of rays compared.
    pub rays: usize,
    /// The number of rays whose lists differ in length.
    pub other_count: usize,
    /// The number of rays with lists of equal length in which a time differs by more than 1e-6, relative to the time or
    /// to 1, whichever is larger.
    pub other_time: usize,
    /// The largest difference of two times in lists of equal length, relative to the time or to 1,
    /// whichever is larger.
    pub worst: f64,
}

impl Agreement {
    /// Compares two results.
    pub fn of(ours: &Lists, theirs: &Lists) -> Agreement {
        let rays = ours.len().min(theirs.len());
        let mut agreement =
            Agreement { rays, other_count: ours.len().abs_diff(theirs.len()), other_time: 0, worst: 0.0 };
        for (a, b) in ours.iter().zip(theirs) {
            if a.len() != b.len() {
                agreement.other_count += 1;
                continue;
            }
            let off = a.iter().zip(b).map(|(a, b)| (a - b).abs() / a.abs().max(1.0)).fold(0.0, f64::max);
            agreement.other_time += usize::from(off > 1e-6);
            agreement.worst = agreement.worst.max(off);
        }
        agreement
    }

    /// True if every ray has the same crossings to within a millionth.
    pub fn is_same(&self) -> bool {
        self.other_count == 0 && self.other_time == 0
    }
}

impl std::fmt::Display for Agreement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Agreement { rays, other_count, other_time, worst } = self;
        match (self.is_same(), *worst) {
            (true, 0.0) => write!(f, "{rays} rays: the same"),
            (true, _) => write!(f, "{rays} rays: the same to {worst:.0e}"),
            (false, _) => {
                write!(
                    f,
                    "{rays} rays: {other_count} differ in number, {other_time} in time, by up to {worst:.0e}"
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_counted() {
        let ours = vec![vec![1.0, 2.0], vec![3.0], vec![], vec![100.0]];
        let theirs = vec![vec![1.0, 2.0 + 1e-9], vec![3.1], vec![5.0], vec![100.0 + 1e-5]];
        let agreement = Agreement::of(&ours, &theirs);
        assert_eq!((agreement.other_count, agreement.other_time), (1, 1));
        assert!((agreement.worst - 0.1 / 3.0).abs() < 1e-12);
        assert!(!agreement.is_same() && Agreement::of(&ours, &ours).is_same());
        assert!(!Agreement::of(&ours, &theirs[..3].to_vec()).is_same());
    }
}
