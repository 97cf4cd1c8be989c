//! The plain view of a program is complete: an interpreter that reads nothing else agrees with an evaluator.

use rayweave_conformance::{Model, Random, Style};
use rayweave_model::plain::{GATE_AT_LEAST, LEAF_INSTANCE, PlainError, PlainProgram, SurfaceKind};
use rayweave_model::{Evaluator, RegionId};
use rayweave_trace::Reference;

type Point = [f64; 3];

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: &[f64], b: &[f64]) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The component of a vector along a unit axis, and the distance from that axis.
fn along_and_across(q: &[f64], axis: &[f64]) -> (f64, f64) {
    let h = dot(q, axis);
    let across = [q[0] - h * axis[0], q[1] - h * axis[1], q[2] - h * axis[2]];
    (h, dot(&across, &across).sqrt())
}

fn torus(q: &[f64], axis: &[f64], major: f64, minor: f64) -> f64 {
    let (z, d) = along_and_across(q, axis);
    (d - major) * (d - major) + z * z - minor * minor
}

/// A brute-force interpreter, written from the documentation of the tables.
struct Interpreter<'p>(&'p PlainProgram);

impl Interpreter<'_> {
    /// The value f of a surface at a point.
    fn value(&self, surface: u32, p: &Point) -> f64 {
        let record = self.0.surfaces[surface as usize];
        let n = &self.0.numbers[record.first as usize..];
        let kind = SurfaceKind::ALL.into_iter().find(|kind| *kind as u32 == record.kind).unwrap();
        let q = minus(p, n);
        match kind {
            SurfaceKind::Plane => dot(n, p) - n[3],
            SurfaceKind::Sphere => dot(&q, &q) - n[3] * n[3],
            SurfaceKind::Cylinder => along_and_across(&q, &n[3..]).1.powi(2) - n[6] * n[6],
            SurfaceKind::Cone => {
                let (h, d) = along_and_across(&q, &n[3..]);
                d * d - (n[6] * h).powi(2)
            }
            SurfaceKind::Quadric => {
                let squares = (0..3).map(|k| n[12 + k] * dot(&n[3 + 3 * k..], &q).powi(2));
                squares.sum::<f64>() + dot(&n[15..], &q) + n[18]
            }
            SurfaceKind::Torus => torus(&q, &n[3..], n[6], n[7]),
            SurfaceKind::AffineTorus => {
                let local = [dot(&n[3..], &q), dot(&n[6..], &q), dot(&n[9..], &q)];
                torus(&local, &n[21..], n[24], n[25])
            }
        }
    }

    fn leaf(&self, leaf: u32, p: &Point) -> bool {
        let leaf = self.0.leaves[leaf as usize];
        if leaf.kind == LEAF_INSTANCE {
            let m = &self.0.maps[leaf.first as usize].local_from_world;
            let local = std::array::from_fn(|k| dot(&m[4 * k..], p) + m[4 * k + 3]);
            return self.outputs(self.0.instances[leaf.first as usize].group, &local)[0];
        }
        let facets = &self.0.facets[leaf.first as usize..][..leaf.count as usize];
        facets.iter().all(|facet| (self.value(facet.surface, p) < 0.0) == (facet.inside == 1))
    }

    /// The outputs of a group at a point of its frame.
    fn outputs(&self, group: u32, p: &Point) -> Vec<bool> {
        let group = self.0.groups[group as usize];
        let mut nodes = vec![false, true];
        nodes.extend((0..group.leaf_count).map(|k| self.leaf(group.first_leaf + k, p)));
        let holds = |nodes: &[bool], edge: u32| nodes[edge as usize / 2] ^ (edge % 2 == 1);
        for gate in &self.0.gates[group.first_gate as usize..][..group.gate_count as usize] {
            let operands = &self.0.operands[gate.first as usize..][..gate.count as usize];
            let count = operands.iter().filter(|&&edge| holds(&nodes, edge)).count() as u32;
            nodes.push(if gate.rule == GATE_AT_LEAST { count >= gate.least } else { count % 2 == 1 });
        }
        let outputs = &self.0.outputs[group.first_output as usize..][..group.output_count as usize];
        outputs.iter().map(|&edge| holds(&nodes, edge)).collect()
    }

    fn region(&self, p: &Point) -> RegionId {
        RegionId::from(self.outputs(0, p).iter().rposition(|&inside| inside).map_or(0, |k| k + 1))
    }
}

#[test]
fn an_interpreter_of_the_plain_view_agrees_with_an_evaluator() {
    let (mut refused, mut points, mut inside) = (0, 0, 0);
    let mut kinds = [0; 8];
    for seed in 0..600 {
        let mut rng = Random::new(seed);
        let style = [Style::Generic, Style::Grid, Style::Planes][seed as usize % 3];
        let model = Model::random(&mut rng, style);
        let program = model.compile().unwrap();
        let plain = match program.plain() {
            Ok(plain) => plain,
            Err(PlainError::Surface { leaf, name, .. }) => {
                assert_eq!(program.leaf(leaf).name(), name);
                refused += 1;
                continue;
            }
            Err(error) => panic!("model {seed}: {error}"),
        };
        plain.surfaces.iter().for_each(|surface| kinds[surface.kind as usize] += 1);
        let media: Vec<u32> = plain.regions.iter().map(|region| region.medium).collect();
        assert_eq!(media, program.regions().iter().map(|region| region.medium).collect::<Vec<u32>>());
        let (reference, interpreter) = (Reference::new(program), Interpreter(&plain));
        let mut scratch = reference.scratch();
        for _ in 0..100 {
            let p = model.frame.point(rng.point(4.0)).to_array();
            let mut expected = [RegionId(0)];
            reference.regions_at([&[p[0]], &[p[1]], &[p[2]]], &mut scratch, &mut expected);
            assert_eq!(interpreter.region(&p), expected[0], "model {seed} at {p:?}\n{model}");
            points += 1;
            inside += usize::from(expected[0] != RegionId(0));
        }
    }
    assert!(refused > 0, "no model has a surface without plain form");
    assert!(points > 30_000 && inside > points / 10, "{inside} of {points} points inside");
    assert!(kinds[1..].iter().all(|&count| count > 0), "surfaces of each kind: {kinds:?}");
}
