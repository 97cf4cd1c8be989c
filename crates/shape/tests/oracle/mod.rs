//! Oracle for the tests of the kernels: surfaces in exact rational arithmetic, from their definitions, without rounding.
#![allow(dead_code)] // each test uses a part of it

use dashu::base::Sign;
use dashu::rational::RBig;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::{UNIT_ROUNDOFF, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::surface::Surface;

pub type Point = [RBig; 3];

/// Factor of the number of test cases, from the variable `RAYWEAVE_EFFORT`.
pub fn effort() -> usize {
    std::env::var("RAYWEAVE_EFFORT").ok().and_then(|s| s.parse().ok()).unwrap_or(1)
}

pub fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

pub fn exact(x: f64) -> RBig {
    RBig::try_from(x).expect("a finite number")
}

pub fn approximate(x: &RBig) -> f64 {
    x.to_f64().value()
}

pub fn point(v: Vec3) -> Point {
    v.to_array().map(exact)
}

pub fn dot(a: &Point, b: &Point) -> RBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn minus(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|k| &a[k] - &b[k])
}

fn square(x: RBig) -> RBig {
    &x * &x
}

pub fn sign(x: &RBig) -> i32 {
    match (x == &RBig::ZERO, x.sign()) {
        (true, _) => 0,
        (_, Sign::Negative) => -1,
        _ => 1,
    }
}

/// Exact point of a ray.
pub fn at(ray: &Ray, t: &RBig) -> Point {
    let (o, d) = (point(ray.origin), point(ray.direction));
    std::array::from_fn(|k| &o[k] + t * &d[k])
}

/// A polynomial that vanishes on the surface, of degree 1, 2 or 4, negative inside (for a ring torus), for the solid grown
/// by `grow`: this adds to the radius of a sphere, cylinder or tube, or to the offset of a plane.
pub fn polynomial(surface: &Surface, grow: f64, p: &Point) -> RBig {
    let grow = exact(grow);
    match surface {
        Surface::Plane(s) => dot(&point(s.normal), p) - exact(s.offset) - grow,
        Surface::Sphere(s) => {
            let q = minus(p, &point(s.centre));
            dot(&q, &q) - square(exact(s.radius) + grow)
        }
        Surface::Cylinder(s) => {
            let (q, u) = (minus(p, &point(s.point)), point(s.axis));
            let along = square(dot(&q, &u)) / dot(&u, &u);
            dot(&q, &q) - along - square(exact(s.radius) + grow)
        }
        Surface::Cone(s) => {
            let (q, u) = (minus(p, &point(s.apex)), point(s.axis));
            let along = square(dot(&q, &u)) / dot(&u, &u);
            dot(&q, &q) - &along - square(exact(s.slope)) * along
        }
        Surface::Quadric(s) => {
            let q = minus(p, &point(s.centre));
            let squares: RBig = (0..3)
                .map(|k| exact(s.weights[k]) * square(dot(&point(s.axes[k]), &q)))
                .fold(RBig::ZERO, |a, b| a + b);
            squares + dot(&point(s.linear), &q) + exact(s.constant)
        }
        Surface::Torus(s) => {
            let q = minus(p, &point(s.centre));
            torus(&q, &point(s.axis), s.major, exact(s.minor) + grow)
        }
        Surface::AffineTorus(s) => {
            let (q, m) = (minus(p, &point(s.centre)), s.local_from_world.to_cols_array_2d());
            let local =
                std::array::from_fn(|row| (0..3).fold(RBig::ZERO, |sum, k| sum + exact(m[k][row]) * &q[k]));
            torus(&local, &point(s.torus.axis), s.torus.major, exact(s.torus.minor) + grow)
        }
        Surface::Object(_) => unreachable!("objects have oracles of their own"),
    }
}

/// `(|q|^2 + R^2 - r^2)^2 - 4 R^2 rho^2`.
fn torus(q: &Point, u: &Point, major: f64, minor: RBig) -> RBig {
    let all = dot(q, q);
    let rho = &all - square(dot(q, u)) / dot(u, u);
    let major = square(exact(major));
    square(all + &major - square(minor)) - exact(4.0) * major * rho
}

/// `|F| / |grad F|` at the exact point of the ray: the distance from the surface to first order. The gradient is an exact
/// difference quotient.
pub fn distance(surface: &Surface, ray: &Ray, t: f64) -> f64 {
    let p = at(ray, &exact(t));
    // exact for degree 2; for a torus, small relative to the tube
    let step = exact(match surface {
        Surface::Torus(s) => s.minor * 1e-8,
        Surface::AffineTorus(s) => s.torus.minor * 1e-9,
        _ => 1.0,
    });
    let value = polynomial(surface, 0.0, &p);
    let slope = |k: usize| {
        let moved = |by: &RBig| {
            let mut q = p.clone();
            q[k] = &q[k] + by;
            polynomial(surface, 0.0, &q)
        };
        approximate(&((moved(&step) - moved(&-step.clone())) / (exact(2.0) * &step)))
    };
    let gradient = Vec3::new(slope(0), slope(1), slope(2));
    approximate(&value).abs() / gradient.length()
}

/// Coefficients of F(r(t)) by interpolation at 0, 1, ... n.
pub fn coefficients(surface: &Surface, grow: f64, ray: &Ray, degree: usize) -> Vec<RBig> {
    let nodes: Vec<RBig> = (0..=degree).map(|k| exact(k as f64)).collect();
    let mut differences: Vec<RBig> = nodes.iter().map(|t| polynomial(surface, grow, &at(ray, t))).collect();
    for order in 1..=degree {
        for k in (order..=degree).rev() {
            let step = &nodes[k] - &nodes[k - order];
            differences[k] = (&differences[k] - &differences[k - 1]) / step;
        }
    }
    // from Newton's form to powers of t
    let mut powers = vec![RBig::ZERO; degree + 1];
    for k in (0..=degree).rev() {
        for j in (1..=degree).rev() {
            powers[j] = &powers[j - 1] - &nodes[k] * &powers[j];
        }
        powers[0] = &differences[k] - &nodes[k] * &powers[0];
    }
    powers
}

/// Number of distinct real roots, by Sturm's theorem.
pub fn count_real_roots(coefficients: &[RBig]) -> usize {
    let derivative = |p: &[RBig]| -> Vec<RBig> { (1..p.len()).map(|k| exact(k as f64) * &p[k]).collect() };
    let first = trimmed(coefficients.to_vec());
    let mut chain = vec![first.clone(), trimmed(derivative(&first))];
    while chain[chain.len() - 1].len() > 1 {
        let next = negated_remainder(&chain[chain.len() - 2], &chain[chain.len() - 1]);
        if next.is_empty() {
            break;
        }
        chain.push(next);
    }
    let changes = |at_minus_infinity: bool| {
        let signs: Vec<i32> = chain
            .iter()
            .filter(|p| !p.is_empty())
            .map(|p| {
                let leading = sign(&p[p.len() - 1]);
                if at_minus_infinity && p.len() % 2 == 0 { -leading } else { leading }
            })
            .collect();
        signs.windows(2).filter(|w| w[0] != w[1]).count()
    };
    changes(true) - changes(false)
}

/// Number of distinct real roots between two numbers that are not roots, by Sturm's theorem.
pub fn count_between(coefficients: &[RBig], from: f64, to: f64) -> usize {
    let chain = Sturm::new(coefficients);
    chain.variations(&exact(from)).saturating_sub(chain.variations(&exact(to)))
}

fn trimmed(mut p: Vec<RBig>) -> Vec<RBig> {
    while p.last().is_some_and(|c| c == &RBig::ZERO) {
        p.pop();
    }
    p
}

fn negated_remainder(a: &[RBig], b: &[RBig]) -> Vec<RBig> {
    let mut rest = a.to_vec();
    while rest.len() >= b.len() {
        let factor = &rest[rest.len() - 1] / &b[b.len() - 1];
        let shift = rest.len() - b.len();
        for (k, c) in b.iter().enumerate() {
            rest[shift + k] = &rest[shift + k] - &factor * c;
        }
        rest.pop();
        rest = trimmed(rest);
    }
    rest.into_iter().map(|c| -c).collect()
}

/// `u (|o| + |t| |d| + magnitude)`.
pub fn rounding(surface: &Surface, ray: &Ray, t: f64) -> f64 {
    UNIT_ROUNDOFF * (ray.origin.length() + t.abs() * ray.direction.length() + surface.magnitude())
}

pub fn unit_vector(rng: &mut ChaCha8Rng) -> Vec3 {
    loop {
        let v = Vec3::ZERO.map(|_| rng.random_range(-1.0..1.0));
        if (0.1..1.0).contains(&v.length()) {
            return v / v.length();
        }
    }
}

/// A random number with a uniformly distributed exponent.
pub fn size(rng: &mut ChaCha8Rng, lo: f64, hi: f64) -> f64 {
    libm::exp10(rng.random_range(lo.log10()..hi.log10()))
}

/// A ray towards a point from a distance between 1e-8 and 1e8, with a direction of any length.
pub fn ray_through(target: Vec3, size_of_scene: f64, rng: &mut ChaCha8Rng) -> Ray {
    let far = size_of_scene * size(rng, 1e-2, 1e2);
    let far = if rng.random_range(0..4) == 0 { far * size(rng, 1e-6, 1e6) } else { far };
    let way = far * unit_vector(rng);
    let length = size(rng, 1e-3, 1e3);
    Ray::new(target - way, way * (length / far))
}

/// Sturm chain of a polynomial.
pub struct Sturm(Vec<Vec<RBig>>);

impl Sturm {
    pub fn new(coefficients: &[RBig]) -> Sturm {
        let p = trimmed(coefficients.to_vec());
        let derivative = trimmed(p.iter().enumerate().skip(1).map(|(k, c)| c * exact(k as f64)).collect());
        let mut chain = vec![p, derivative];
        while let [.., a, b] = &chain[..] {
            if b.len() < 2 {
                break;
            }
            let next = negated_remainder(a, b);
            chain.push(next);
        }
        Sturm(chain)
    }

    fn variations(&self, t: &RBig) -> usize {
        let signs = self.0.iter().map(|p| sign(&value(p, t))).filter(|&s| s != 0);
        let signs: Vec<i32> = signs.collect();
        signs.windows(2).filter(|w| w[0] != w[1]).count()
    }

    /// The simple roots between two numbers that are not roots, to a few bits of f64, in order.
    pub fn roots(&self, from: f64, to: f64) -> Vec<RBig> {
        let mut found = Vec::new();
        let ends = [from, to].map(exact);
        let counts = [self.variations(&ends[0]), self.variations(&ends[1])];
        self.isolate(ends, counts, &mut found);
        found
    }

    fn isolate(&self, [a, b]: [RBig; 2], [first, last]: [usize; 2], found: &mut Vec<RBig>) {
        match first.saturating_sub(last) {
            0 => {}
            1 => found.push(self.halved([a, b])),
            _ => {
                let middle = (&a + &b) / exact(2.0);
                let between = self.variations(&middle);
                self.isolate([a, middle.clone()], [first, between], found);
                self.isolate([middle, b], [between, last], found);
            }
        }
    }

    fn halved(&self, [mut a, mut b]: [RBig; 2]) -> RBig {
        let first = sign(&value(&self.0[0], &a));
        for _ in 0..64 {
            let middle = (&a + &b) / exact(2.0);
            match sign(&value(&self.0[0], &middle)) == first {
                true => a = middle,
                false => b = middle,
            }
        }
        (a + b) / exact(2.0)
    }
}

/// Value of a polynomial.
pub fn value(p: &[RBig], t: &RBig) -> RBig {
    p.iter().rev().fold(RBig::ZERO, |sum, c| sum * t + c)
}
