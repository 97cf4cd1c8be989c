//! Solids that use the same parts many times, and empty placements.

mod everyone;

use rayweave_math::{Affine, Vec3};
use rayweave_model::{Program, Solid};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use std::sync::Arc;

fn ball() -> Solid {
    Solid::from(build("sphere", &[("radius", Value::Number(1.0))]).unwrap())
}

fn times(solid: &Solid) -> Vec<f64> {
    let program = Arc::new(Program::compile(solid).unwrap());
    let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
    everyone::trace(&program, ray).crossings.iter().map(|c| c.t).collect()
}

/// Each level uses the one below twice, through a handle that is itself shared: 2^60 visits without
/// memoisation.
#[test]
fn nested_sharing_is_walked_once() {
    let other = ball().translate([3.0, 0.0, 0.0]);
    let mut s = ball();
    for k in 0..60 {
        let below = match k % 4 {
            0 => !&s,
            1 => s.named("again"),
            2 => s.translate([0.0, 0.0, 0.0]),
            _ => s.clone() | other.clone(),
        };
        drop(s);
        s = (&below & &other) ^ (&below | &other);
    }
    let program = Program::compile(&s).unwrap();
    assert!(program.leaves().len() <= 200, "{}", program.leaves().len());
}

/// The same for nested gates of one kind, which must not be merged into each of their users.
#[test]
fn merged_gates_are_walked_once() {
    let balls: Vec<Solid> = (0..4).map(|k| ball().translate([3.0 * f64::from(k), 0.0, 0.0])).collect();
    let mut s = &balls[0] | &balls[1];
    for _ in 0..30 {
        let below = (&s | &balls[2]) & (&s | &balls[3]);
        s = ((&below & &balls[2]) ^ (&below & &balls[3])) | balls[1].clone();
    }
    let program = Program::compile(&s).unwrap();
    assert_eq!(program.leaves().len(), 4);
    assert!(program.prototypes()[0].expression.nodes().len() < 1000);
}

/// Every union of a chain is also a solid of its own: a flat gate for each of them would be quadratic.
#[test]
fn chains_whose_members_are_all_used_stay_linear() {
    let mut chain = vec![ball()];
    for k in 1..2000 {
        let next = chain[k - 1].clone() | ball().translate([3.0 * k as f64, 0.0, 0.0]);
        chain.push(next);
    }
    let program = Program::compile(&Solid::symmetric_difference(chain)).unwrap();
    let operands = |gate: rayweave_model::Gate<'_>| match gate {
        rayweave_model::Gate::Join(_, operands) => operands.len(),
        _ => 0,
    };
    let edges: usize = program.prototypes()[0].expression.nodes().map(operands).sum();
    assert!(edges < 8000, "{edges}");
}

#[test]
fn placing_nothing_is_empty_and_shifts_no_other_placement() {
    let pair = [Affine::translate(Vec3::X * -3.0), Affine::translate(Vec3::X * 3.0)];
    assert_eq!(times(&ball().place([])), [0.0; 0]);
    assert_eq!(times(&(ball().place([]) | ball().place(pair))), [1.0, 3.0, 7.0, 9.0]);
    assert_eq!(times(&(!ball().place([]) - ball().place(pair))), [1.0, 3.0, 7.0, 9.0]);
}

#[test]
fn a_placed_solid_met_twice_is_one() {
    let pair = ball().place([Affine::translate(Vec3::X * -3.0), Affine::translate(Vec3::X * 3.0)]);
    let program = Program::compile(&((&pair | &ball()) - !&pair)).unwrap();
    assert_eq!(program.leaves().filter(|leaf| leaf.name().starts_with("place")).count(), 2);
    assert_eq!(times(&(&pair ^ &pair)), [0.0; 0]);
}

/// A face shared with one that was translated far has the uncertainty of that one: boxes must not be tighter
/// than the faces.
#[test]
fn a_shared_face_is_as_far_as_the_farthest() {
    let sizes: [(&str, Value); 3] = [("sides", 3u32.into()), ("radius", 2.0.into()), ("height", 3.0.into())];
    let block = Solid::from(build("prism", &sizes).unwrap()).translate([6.0, 0.0, 1.5]);
    let plane: [(&str, Value); 2] = [("normal", Vec3::X.into()), ("offset", 5.0.into())];
    let left = Solid::from(build("half_space", &plane).unwrap());
    let ray = Ray::new(Vec3::ZERO, Vec3::ONE);
    for far in [0.0, 1e10, 1e40, 1e80] {
        let moved = left.translate([0.0, 0.0, far]);
        for solid in [&block - &moved, &block | &moved, &moved - &block] {
            let found = everyone::trace(&Arc::new(Program::compile(&solid).unwrap()), ray);
            assert!(far > 0.0 || found.crossings.len() < 2, "{found:?}");
        }
    }
}
