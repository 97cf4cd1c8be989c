//! Time lines: the state of a ray over time, as square waves and bands.

mod scene;
mod svg;

pub use scene::ray_timeline;

use rayweave_error::{Classified, ErrorKind};
use rayweave_rootray::{RootRay, Side, SurfaceCount, surface_count};

/// A drawing of root-rays over time. Its rows from top to bottom: the operands, the number of operands that contain the ray,
/// the results.
///
/// Each root-ray is a square wave, low outside and high inside, labelled with its roots. A wave that stays inside ends in an
/// arrow. A dashed line through all rows marks times at which several operands change. Overlapping numbers are left out, and
/// long names are shortened (a tooltip shows the whole name).
///
/// ```
/// use rayweave_draw::Timeline;
/// use rayweave_rootray::{RootRay, Side};
///
/// let a = RootRay::from_times(Side::Outside, [1.0, 4.0, 5.0, 10.0])?;
/// let b = RootRay::from_times(Side::Outside, [0.0, 2.0, 3.0, 5.0, 6.0, 7.0])?;
/// let mut timeline = Timeline::new();
/// timeline.operand("A", &a).operand("B", &b).result("A & B", &(&a & &b));
/// assert!(timeline.to_svg().starts_with("<svg "));
/// # Ok::<(), rayweave_rootray::RootRayError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timeline {
    title: String,
    operands: Vec<Wave>,
    results: Vec<Row>,
    window: Option<(f64, f64)>,
    hides_count: bool,
}

/// A root-ray under a name.
#[derive(Clone, Debug, PartialEq)]
struct Wave {
    name: String,
    ray: RootRay,
}

/// A row below the operands.
#[derive(Clone, Debug, PartialEq)]
enum Row {
    Wave(Wave),
    Bands(Bands),
}

/// Named intervals of time: the first name, and each time at which the name changes.
#[derive(Clone, Debug, PartialEq)]
struct Bands {
    name: String,
    first: String,
    changes: Vec<(f64, String)>,
}

/// An error in the contents of a time line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TimelineError {
    /// The window is not an interval of time.
    #[error(
        "the window of the time line from {t_min} to {t_max} is invalid: its ends must be finite and increasing."
    )]
    Window {
        /// Its beginning.
        t_min: f64,
        /// Its end.
        t_max: f64,
    },
    /// The changes of a row are out of order.
    #[error("change {index} of `{name}` is at {t}: times must be finite and increasing.")]
    Change {
        /// The row.
        name: String,
        /// The number of the change, from 0.
        index: usize,
        /// Its time.
        t: f64,
    },
}

impl Classified for TimelineError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}

impl Timeline {
    /// Creates a drawing without rows.
    pub fn new() -> Timeline {
        Timeline::default()
    }

    /// Sets the title.
    pub fn title(&mut self, title: &str) -> &mut Timeline {
        title.clone_into(&mut self.title);
        self
    }

    /// Adds a row for an operand.
    pub fn operand<S>(&mut self, name: &str, ray: &RootRay<S>) -> &mut Timeline {
        self.operands.push(Wave::new(name, ray));
        self
    }

    /// Adds a row for a result, below the operands and their count.
    pub fn result<S>(&mut self, name: &str, ray: &RootRay<S>) -> &mut Timeline {
        self.results.push(Row::Wave(Wave::new(name, ray)));
        self
    }

    /// Adds a row of named bands, for regions or media, below the operands and their count: the name as t -> -inf, and each
    /// time at which it changes with the name afterwards. A band with an empty name is not drawn.
    ///
    /// # Errors
    /// Times that are not finite or do not increase.
    pub fn bands<'n>(
        &mut self,
        name: &str,
        first: &str,
        changes: impl IntoIterator<Item = (f64, &'n str)>,
    ) -> Result<&mut Timeline, TimelineError> {
        let changes: Vec<_> = changes.into_iter().map(|(t, band)| (t, band.to_owned())).collect();
        let mut previous = f64::NEG_INFINITY;
        for (index, &(t, _)) in changes.iter().enumerate() {
            if !t.is_finite() || t <= previous {
                let name = name.to_owned();
                return Err(TimelineError::Change { name, index, t });
            }
            previous = t;
        }
        self.results.push(Row::Bands(Bands { name: name.to_owned(), first: first.to_owned(), changes }));
        Ok(self)
    }

    /// Leaves out the row that counts the operands.
    pub fn without_count(&mut self) -> &mut Timeline {
        self.hides_count = true;
        self
    }

    /// Restricts the drawing to a window of time. The default contains all roots, with padding.
    ///
    /// # Errors
    /// Ends that are not finite or do not increase.
    pub fn window(&mut self, t_min: f64, t_max: f64) -> Result<&mut Timeline, TimelineError> {
        if t_min.is_finite() && t_max.is_finite() && t_min < t_max {
            self.window = Some((t_min, t_max));
            Ok(self)
        } else {
            Err(TimelineError::Window { t_min, t_max })
        }
    }

    /// The drawing as an SVG 1.1 document, without scripts or embedded fonts.
    pub fn to_svg(&self) -> String {
        svg::drawing(self)
    }

    /// All waves, operands first.
    fn waves(&self) -> impl Iterator<Item = &Wave> {
        let results = self.results.iter().filter_map(|row| match row {
            Row::Wave(wave) => Some(wave),
            Row::Bands(_) => None,
        });
        self.operands.iter().chain(results)
    }

    /// All distinct times at which a row changes, in order, each with the number of operands that change there.
    fn times(&self) -> Vec<(f64, usize)> {
        let of_bands = self.results.iter().filter_map(|row| match row {
            Row::Bands(bands) => Some(bands.changes.iter().map(|change| (change.0, 0))),
            Row::Wave(_) => None,
        });
        let of_operands = self.operands.iter().flat_map(|wave| wave.ray.times());
        let mut times: Vec<(f64, usize)> = of_operands.map(|t| (t, 1)).collect();
        times.extend(self.waves().flat_map(|wave| wave.ray.times()).map(|t| (t, 0)));
        times.extend(of_bands.flatten());
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        let groups = times.chunk_by(|a, b| a.0 == b.0);
        groups.map(|group| (group[0].0, group.iter().map(|change| change.1).sum())).collect()
    }

    fn count(&self) -> Option<SurfaceCount> {
        (!self.hides_count && self.operands.len() > 1)
            .then(|| surface_count(self.operands.iter().map(|wave| &wave.ray)))
    }
}

impl Wave {
    fn new<S>(name: &str, ray: &RootRay<S>) -> Wave {
        // the times of a root-ray are finite and in order
        let ray = RootRay::from_times(ray.start(), ray.times());
        Wave { name: name.to_owned(), ray: ray.unwrap_or_default() }
    }

    /// The spans of a side: start and end, `None` where the span is unbounded.
    fn spans(&self, side: Side) -> Vec<(Option<f64>, Option<f64>)> {
        let ends = std::iter::once(None).chain(self.ray.times().map(Some)).chain([None]);
        let ends: Vec<Option<f64>> = ends.collect();
        let first = usize::from(self.ray.start() != side);
        ends.windows(2).skip(first).step_by(2).map(|pair| (pair[0], pair[1])).collect()
    }
}
