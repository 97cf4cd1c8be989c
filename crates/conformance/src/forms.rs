//! Equivalent boolean trees: the crossings are the same for every form of a tree, bit for bit.

use crate::laws::nothing_of;
use crate::models::{compiled, motion, solid};
use crate::rays::{batch, rays};
use crate::{Effort, Random, Style, Tally, list};
use rayweave_math::Affine;
use rayweave_model::{Collected, Crossing, Evaluator, Program, Query, RegionId, Solid};
use std::sync::Arc;

/// A boolean expression over parts.
#[derive(Clone, Debug)]
enum Form {
    Part(usize),
    Not(Box<Form>),
    Or(Vec<Form>),
    And(Vec<Form>),
    Odd(Box<Form>, Box<Form>),
    Minus(Box<Form>, Box<Form>),
}

impl Form {
    fn random(rng: &mut Random, parts: std::ops::Range<usize>) -> Form {
        if parts.len() == 1 {
            let part = Form::Part(parts.start);
            return if rng.chance(0.2) { Form::Not(Box::new(part)) } else { part };
        }
        let middle = parts.start + 1 + rng.below(parts.len() - 1);
        let (a, b) = (Form::random(rng, parts.start..middle), Form::random(rng, middle..parts.end));
        match rng.below(7) {
            0..2 => Form::Or(vec![a, b]),
            2..4 => Form::And(vec![a, b]),
            4 => Form::Odd(Box::new(a), Box::new(b)),
            5 => Form::Not(Box::new(Form::Or(vec![a, b]))),
            _ => Form::Minus(Box::new(a), Box::new(b)),
        }
    }

    fn solid(&self, parts: &[Solid]) -> Solid {
        let all = |forms: &[Form]| forms.iter().map(|form| form.solid(parts)).collect::<Vec<_>>();
        match self {
            Form::Part(k) => parts[*k].clone(),
            Form::Not(a) => !a.solid(parts),
            Form::Or(forms) => all(forms).into_iter().reduce(|a, b| a | b).unwrap_or_else(Solid::empty),
            Form::And(forms) => all(forms).into_iter().reduce(|a, b| a & b).unwrap_or_else(Solid::universe),
            Form::Odd(a, b) => a.solid(parts) ^ b.solid(parts),
            Form::Minus(a, b) => a.solid(parts) - b.solid(parts),
        }
    }

    /// The positive form (De Morgan): unions and intersections, complements at the parts only; of the
    /// complement if `flipped`.
    fn positive(&self, flipped: bool) -> Form {
        let all = |forms: &[Form]| forms.iter().map(|form| form.positive(flipped)).collect::<Vec<_>>();
        let join = |is_or: bool, forms| if is_or != flipped { Form::Or(forms) } else { Form::And(forms) };
        match self {
            Form::Part(k) if flipped => Form::Not(Box::new(Form::Part(*k))),
            Form::Part(k) => Form::Part(*k),
            Form::Not(a) => a.positive(!flipped),
            Form::Or(forms) => join(true, all(forms)),
            Form::And(forms) => join(false, all(forms)),
            Form::Minus(a, b) => join(false, vec![a.positive(flipped), b.positive(!flipped)]),
            Form::Odd(a, b) => {
                let both = |one: bool, other: bool| Form::And(vec![a.positive(one), b.positive(other)]);
                Form::Or(vec![both(flipped, true), both(!flipped, false)])
            }
        }
    }
}

/// The parts under one operator, in equivalent forms: n-ary, as chains and as trees, in any order.
fn joined(rng: &mut Random, parts: &[Solid], join: fn(Vec<Solid>) -> Solid) -> Vec<(&'static str, Solid)> {
    let two = |a: Solid, b: Solid| join(vec![a, b]);
    let left = |all: &[Solid]| all.iter().cloned().reduce(two).unwrap_or_else(Solid::empty);
    let right = parts.iter().rev().cloned().reduce(|rest, a| two(a, rest)).unwrap_or_else(Solid::empty);
    let shuffled: Vec<Solid> = rng.order(parts.len()).into_iter().map(|k| parts[k].clone()).collect();
    vec![
        ("n-ary", join(parts.to_vec())),
        ("left-deep", left(parts)),
        ("right-deep", right),
        ("balanced", balanced(parts, two)),
        ("shuffled n-ary", join(shuffled.clone())),
        ("shuffled left-deep", left(&shuffled)),
        ("shuffled balanced", balanced(&shuffled, two)),
    ]
}

fn balanced(parts: &[Solid], two: impl Fn(Solid, Solid) -> Solid + Copy) -> Solid {
    match parts {
        [one] => one.clone(),
        _ => {
            let (a, b) = parts.split_at(parts.len() / 2);
            two(balanced(a, two), balanced(b, two))
        }
    }
}

/// Tests left-deep, right-deep, balanced, shuffled and n-ary trees of one operator, and trees of all
/// operators with their positive forms.
pub fn of_trees<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("crossings unchanged by the form of a tree");
    let rounds = 60 * effort.times();
    for seed in 0..rounds {
        let mut rng = Random::new(15_000_000 + seed);
        let style = [Style::Generic, Style::Grid, Style::Planes][seed as usize % 3];
        let frame = if rng.chance(0.5) { Affine::IDENTITY } else { motion(&mut rng) };
        let count = 2 + rng.below(7);
        let parts: Vec<Solid> = (0..count).map(|_| solid(&mut rng, style, seed as usize % 2)).collect();
        let rays = rays(&mut rng, style, &frame, 30);
        // every form has the same leaves, and therefore the same ball and shared surfaces
        let nothing = Solid::union(parts.iter().map(nothing_of));
        let trace = |solid: &Solid| {
            let program = compiled(Program::compile(&(solid | &nothing).apply(frame)));
            make(program).collect(batch(&rays).rays(), &Query::default()).unwrap_or_default()
        };
        for forms in forms(&mut rng, &parts) {
            let lists: Vec<Collected> = forms.iter().map(|(_, solid)| trace(solid)).collect();
            for ((name, _), found) in forms.iter().zip(&lists).skip(1) {
                for (i, ray) in rays.iter().enumerate() {
                    let same =
                        found.starts[i] == lists[0].starts[i] && bits(found.of(i)) == bits(lists[0].of(i));
                    tally.check(same, || {
                        let (l, r) = (list(lists[0].of(i)), list(found.of(i)));
                        format!("seed {seed}, {name}, {ray:?}\n{parts:?}{l}\nagainst{r}")
                    });
                }
            }
        }
    }
    tally.finish(rounds * 500);
}

/// Groups of equivalent solids.
fn forms(rng: &mut Random, parts: &[Solid]) -> Vec<Vec<(&'static str, Solid)>> {
    let form = Form::random(rng, 0..parts.len());
    let positive = vec![
        ("as it is", form.solid(parts)),
        ("positive", form.positive(false).solid(parts)),
        ("complement of the positive complement", !form.positive(true).solid(parts)),
    ];
    vec![
        joined(rng, parts, Solid::union),
        joined(rng, parts, Solid::intersection),
        joined(rng, parts, Solid::symmetric_difference),
        positive,
    ]
}

/// The part of a list that does not depend on the order in which leaves are declared.
fn bits(crossings: &[Crossing]) -> Vec<(u64, RegionId, RegionId)> {
    crossings.iter().map(|c| (c.t.to_bits(), c.before, c.after)).collect()
}
