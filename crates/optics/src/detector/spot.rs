//! Spot diagrams: the points at which light arrives.

/// The points at which light arrives at a detector, in bounded memory: some of them, their number, power and centroid.
///
/// ```
/// use rayweave_optics::detector::SpotDiagram;
///
/// let mut spot = SpotDiagram::default();
/// for k in 0..100 {
///     spot.add([(k % 10) as f64, (k / 10) as f64], 550.0, 1.0);
/// }
/// assert_eq!(spot.count(), 100);
/// assert!(spot.centroid().iter().all(|x| (x - 4.5).abs() < 1e-12));
/// // two uniform distributions of ten steps: 2 (10^2 - 1) / 12
/// assert!((spot.rms_radius().powi(2) - 16.5).abs() < 1e-12);
/// ```
#[derive(Clone, Debug)]
pub struct SpotDiagram {
    /// A subset of the points, evenly chosen.
    points: Vec<SpotPoint>,
    /// One point in `every` is kept.
    every: u64,
    count: u64,
    power: f64,
    centroid: [f64; 2],
    /// The sum of the squared distances from the centroid, weighted by power.
    squares: f64,
}

/// A point at which a ray arrives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotPoint {
    /// The point in the coordinates of the detector.
    pub point: [f64; 2],
    /// The wavelength of the ray in vacuum, in nanometres.
    pub wavelength_nm: f64,
    /// The power of the ray.
    pub power: f64,
}

impl Default for SpotDiagram {
    fn default() -> SpotDiagram {
        SpotDiagram { points: Vec::new(), every: 1, count: 0, power: 0.0, centroid: [0.0; 2], squares: 0.0 }
    }
}

impl SpotDiagram {
    /// The maximum number of points that are kept.
    pub const MAX_POINTS: usize = 8192;

    /// Adds the point at which a ray arrives, with its wavelength in nanometres and its power.
    ///
    /// Mean and sum of squares are updated point by point, without cancellation (D. H. D. West, Communications of the ACM
    /// 22, 532, 1979).
    pub fn add(&mut self, point: [f64; 2], wavelength_nm: f64, power: f64) {
        if self.count.is_multiple_of(self.every) {
            if self.points.len() == SpotDiagram::MAX_POINTS {
                self.thin_out();
            }
            if self.count.is_multiple_of(self.every) {
                self.points.push(SpotPoint { point, wavelength_nm, power });
            }
        }
        self.count += 1;
        if power > 0.0 {
            self.update_centroid(point, power);
        }
    }

    /// Drops every other point.
    fn thin_out(&mut self) {
        let mut is_odd = true;
        self.points.retain(|_| {
            is_odd = !is_odd;
            !is_odd
        });
        self.every *= 2;
    }

    fn update_centroid(&mut self, point: [f64; 2], power: f64) {
        let (before, sum) = (self.power, self.power + power);
        for (mean, coordinate) in self.centroid.iter_mut().zip(point) {
            let away = coordinate - *mean;
            *mean += away * (power / sum);
            self.squares += away * away * (power * (before / sum));
        }
        self.power = sum;
    }

    /// The points that are kept: all of them up to [`SpotDiagram::MAX_POINTS`], beyond that an evenly
    /// chosen subset.
    pub fn points(&self) -> &[SpotPoint] {
        &self.points
    }

    /// The number of rays.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The power of all rays.
    pub fn power(&self) -> f64 {
        self.power
    }

    /// The mean of the points, weighted by power.
    pub fn centroid(&self) -> [f64; 2] {
        self.centroid
    }

    /// The root of the mean square distance from the centroid, weighted by power; NaN without light.
    pub fn rms_radius(&self) -> f64 {
        (self.squares / self.power).sqrt()
    }
}
