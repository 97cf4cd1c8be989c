//! Moving solids as solids at rest in space-time: `cargo run -p rayweave-space --example space_time`.
//!
//! The coordinates are x, y, z and time (for example in metres and seconds). A solid at rest is a cylinder along time; a
//! solid with velocity v is that cylinder sheared by v, `(x, t) -> (x + v t, t)`. A solid that exists for a limited time is
//! intersected with a slab of time. A particle of constant velocity is a straight line, whose parameter is time: a trace gives the
//! times at which it is inside each solid.
//!
//! ```text
//!        A          the particle flies along x at 2 m/s
//!        |     |plate    ball A, radius 1, crosses its path upward (+y) at x = 4, t = 2
//!  o---->+--+--|-->      ball B, radius 1, downward at x = 5, t = 2.5: they pass through each other
//!           |  |         the plate, 8 < x < 8.5, has a round shutter that is open for 3.9 < t < 4.3
//!           B
//! ```
//!
//! Three particles are launched 0.25 s apart. The first passes the open shutter, the second is inside the plate when the shutter
//! closes, and the third arrives after it has closed.

use rayweave_space::{Point, Solid, SpaceError, Tracer};

/// An event of space-time.
type Event = Point<4>;

const SPEED: f64 = 2.0;

/// A ball with this centre at time 0 and this velocity.
fn moving_ball(radius: f64, centre: [f64; 3], velocity: [f64; 3]) -> Result<Solid<4>, SpaceError> {
    let [u, v, w] = velocity;
    let shear = [[1.0, 0.0, 0.0, u], [0.0, 1.0, 0.0, v], [0.0, 0.0, 1.0, w], [0.0, 0.0, 0.0, 1.0]];
    let [x, y, z] = centre;
    Solid::cylinder(3, radius)?.affine(shear, [x, y, z, 0.0])
}

/// All obstacles of the particles.
fn scene() -> Result<Solid<4>, SpaceError> {
    let a = moving_ball(1.0, [4.0, -2.0, 0.0], [0.0, 1.0, 0.0])?.named("ball A");
    let b = moving_ball(1.0, [5.0, 2.5, 0.0], [0.0, -1.0, 0.0])?.named("ball B");
    let plate = Solid::slab(0, 8.0, 8.5)?.named("plate");
    // round in y and z, unbounded along x and in time: a cylinder over the first two axes, rotated to y and z
    let hole = Solid::cylinder(2, 0.5)?.rotate(0, 2, 90.0)?.named("rim");
    let open = Solid::slab(3, 3.9, 4.3)?.named("shutter");
    Ok(a | b | (plate - (hole & open)))
}

/// The times at which a particle launched at `launch` enters and leaves a ball: `|relative
/// position| < 1` by the quadratic formula.
fn in_ball(launch: f64, x: f64, y: f64, vy: f64) -> Option<(f64, f64)> {
    // relative to the ball: (2 (t - launch) - x, -(y + vy t))
    let (a, half_b) = (SPEED * SPEED + vy * vy, vy * y - SPEED * (SPEED * launch + x));
    let c = (SPEED * launch + x) * (SPEED * launch + x) + y * y - 1.0;
    let discriminant = half_b * half_b - a * c;
    (discriminant > 0.0).then(|| {
        let root = discriminant.sqrt();
        ((-half_b - root) / a, (-half_b + root) / a)
    })
}

/// The intervals of time in which the particle is inside the scene, by hand.
fn by_hand(launch: f64) -> Vec<(f64, f64)> {
    let balls = [in_ball(launch, 4.0, -2.0, 1.0), in_ball(launch, 5.0, 2.5, -1.0)];
    let mut spans: Vec<(f64, f64)> = balls.into_iter().flatten().collect();
    let (enters, leaves) = (launch + 8.0 / SPEED, launch + 8.5 / SPEED);
    // the plate, less the time in which the shutter is open
    spans.extend([(enters, leaves.min(3.9)), (enters.max(4.3), leaves)]);
    spans.retain(|(from, to)| from < to);
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    // joins overlapping intervals
    let mut joined: Vec<(f64, f64)> = Vec::new();
    for (from, to) in spans {
        match joined.last_mut() {
            Some(last) if from <= last.1 => last.1 = last.1.max(to),
            _ => joined.push((from, to)),
        }
    }
    joined
}

fn main() -> Result<(), SpaceError> {
    let mut tracer = Tracer::new(&scene()?)?;
    let program = tracer.program().clone();
    println!("{:>6}  {:>8}  {:<7} {:<8} {:>8} {:>8}", "launch", "time", "", "face of", "x", "v normal");
    for launch in [0.0, 0.25, 0.5] {
        // t = 0 and t = 1 of the line are the times 0 and 1, regardless of the time of launch
        let at = |time: f64| -> Event { [SPEED * (time - launch), 0.0, 0.0, time] };
        let ray = tracer.trace(at(0.0), at(1.0))?.clip(launch, 10.0)?;
        for (root, side) in ray.crossings() {
            let face = &root.surface;
            let name = program.leaf_name(face.leaf).unwrap_or("?");
            let what = if side.is_inside() { "enters" } else { "leaves" };
            println!(
                "{launch:>6}  {:>8.4}  {what:<7} {name:<8} {:>8.4} {:>8.4}",
                root.t,
                face.point[0],
                speed(&face.normal)
            );
        }
        let want = by_hand(launch);
        let got: Vec<(f64, f64)> = ray.spans().collect();
        assert_eq!(got.len(), want.len(), "{got:?} {want:?}");
        let close = |a: f64, b: f64| (a - b).abs() < 1e-13;
        assert!(got.iter().zip(&want).all(|(g, w)| close(g.0, w.0) && close(g.1, w.1)), "{got:?} {want:?}");
    }
    println!("all times are those of the closed forms within 1e-13");
    Ok(())
}

/// The speed of a face along its own normal in space: a point stays on it if `n . v + n_t = 0`. Infinite for a face
/// of time alone, such as that of a shutter that closes everywhere at once.
fn speed(normal: &Event) -> f64 {
    let space = normal[..3].iter().map(|n| n * n).sum::<f64>().sqrt();
    // no negative zero in the table
    -normal[3] / space + 0.0
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_table_is_that_of_the_closed_forms() {
        assert_eq!(super::main(), Ok(()));
    }
}
