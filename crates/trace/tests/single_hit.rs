//! The single-hit evaluator: its rule against the algebra of root-rays, its stacks against their bounds, its
//! answers against the reference.

use rayweave_conformance::rays::rays;
use rayweave_conformance::{Model, Random, Style};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{
    Crossing, Edge, Evaluator, Gate, LeafId, Limit, NodeId, Program, PrototypeId, Query, Region, Rule, Solid,
    Window,
};
use rayweave_rootray::{Root, RootRay, Side};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::single_hit::{
    ExplainedOperand, LeafAnswers, MAX_ENTRIES, MAX_LINES, MAX_NODES, Next, NoObserver, Observer, Stacks,
    TooLarge, Tree, TreeNodeKind, ValueStep, Verdict, What,
};
use rayweave_trace::{Reference, SingleHit};
use std::sync::Arc;

const FOREVER: f64 = f64::INFINITY;

// ---- leaves that are root-rays: the rule without geometry ----

struct Lines(Vec<RootRay>);

impl LeafAnswers for Lines {
    fn next(&self, leaf: u32, t_min: f64) -> Next {
        let line = &self.0[leaf as usize];
        let passed = line.times().filter(|&t| t <= t_min).count();
        Next::new(line.start().after(passed).is_inside(), line.times().nth(passed))
    }
}

fn line(start: bool, times: &[f64]) -> RootRay {
    let roots = times.iter().map(|&t| Root { t, surface: () }).collect();
    RootRay::new(Side::from_inside(start), roots).unwrap()
}

fn between(a: f64, b: f64) -> RootRay {
    line(false, &[a, b])
}

/// Gates in topological order over `leaves` leaves: empty, universe, the leaves, then joins.
struct Skeleton {
    gates: Vec<Gate<'static>>,
}

impl Skeleton {
    fn new(leaves: u32) -> Skeleton {
        let mut gates = vec![Gate::Empty, Gate::Universe];
        gates.extend((0..leaves).map(|k| Gate::Leaf(LeafId(k))));
        Skeleton { gates }
    }

    fn leaf(k: u32) -> Edge {
        Edge::new(NodeId(k + 2), false)
    }

    fn join(&mut self, rule: Rule, operands: Vec<Edge>) -> Edge {
        self.gates.push(Gate::Join(rule, operands.into()));
        Edge::new(NodeId(self.gates.len() as u32 - 1), false)
    }

    fn or(&mut self, a: Edge, b: Edge) -> Edge {
        self.join(Rule::AtLeast(1), vec![a, b])
    }

    fn tree(&self, outputs: &[Edge]) -> Tree {
        Tree::new(&self.gates, outputs, MAX_NODES).unwrap()
    }

    /// The root-rays of edges, by the algebra.
    fn root_rays(&self, lines: &[RootRay], outputs: &[Edge]) -> Vec<RootRay> {
        let mut known: Vec<RootRay> = Vec::new();
        let of = |known: &[RootRay], edge: &Edge| {
            let ray = &known[edge.node().index()];
            if edge.is_complemented() { ray.complement() } else { ray.clone() }
        };
        for gate in &self.gates {
            let ray = match gate {
                Gate::Empty => RootRay::empty(),
                Gate::Universe => RootRay::universe(),
                Gate::Leaf(leaf) => lines[leaf.index()].clone(),
                Gate::Join(rule, operands) => {
                    let operands: Vec<RootRay> = operands.iter().map(|edge| of(&known, edge)).collect();
                    match *rule {
                        Rule::Odd => RootRay::symmetric_difference_all(&operands),
                        Rule::AtLeast(least) => RootRay::at_least(least as usize, &operands),
                    }
                }
            };
            known.push(ray);
        }
        outputs.iter().map(|edge| of(&known, edge)).collect()
    }
}

fn complement_sometimes(rng: &mut Random, edge: Edge) -> Edge {
    if rng.chance(0.25) { edge.complement() } else { edge }
}

/// A random skeleton, its outputs, and lines for its leaves. With `ties`, times are small integers.
fn random_case(rng: &mut Random, ties: bool) -> (Skeleton, Vec<Edge>, Vec<RootRay>) {
    let leaves = 1 + rng.below(9) as u32;
    let mut skeleton = Skeleton::new(leaves);
    let mut pool: Vec<Edge> = (0..leaves).map(Skeleton::leaf).collect();
    if rng.chance(0.1) {
        pool.push(rng.pick(&[Edge::EMPTY, Edge::UNIVERSE]));
    }
    for _ in 0..1 + rng.below(10) {
        let arity = [2, 2, 2, 3, 4, 5, 1, 0][rng.below(8)];
        let operands: Vec<Edge> = (0..arity)
            .map(|_| {
                let at = rng.below(pool.len());
                // most operands are used once, so that the last gates depend on most of the others
                let edge = if pool.len() > 1 && rng.chance(0.8) { pool.swap_remove(at) } else { pool[at] };
                complement_sometimes(rng, edge)
            })
            .collect();
        let rule = match rng.below(4) {
            0 => Rule::AtLeast(1),
            1 => Rule::AtLeast(arity as u32),
            2 => Rule::AtLeast(rng.below(arity + 2) as u32),
            _ => Rule::Odd,
        };
        pool.push(skeleton.join(rule, operands));
    }
    let outputs = (0..[1, 1, 1, 2, 3, 4][rng.below(6)]).map(|k| {
        let edge = pool[pool.len() - 1 - k % pool.len()];
        complement_sometimes(rng, edge)
    });
    let outputs: Vec<Edge> = outputs.collect();
    let lines = (0..leaves).map(|_| random_line(rng, ties)).collect();
    (skeleton, outputs, lines)
}

fn random_line(rng: &mut Random, ties: bool) -> RootRay {
    let mut times: Vec<f64> = (0..rng.below(6))
        .map(|_| if ties { rng.below(7) as f64 - 3.0 } else { rng.between(-3.0, 3.0) })
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    line(rng.chance(0.25), &times)
}

/// The number of the last output that is inside just after `t`, from 1.
fn owner(outputs: &[RootRay], t: f64) -> u32 {
    let inside = |ray: &RootRay| ray.start().after(ray.times().filter(|&x| x <= t).count()).is_inside();
    outputs.iter().rposition(inside).map_or(0, |k| k as u32 + 1)
}

/// All changes of the owner after `t_min`, by the algebra.
fn expected(outputs: &[RootRay], t_min: f64) -> (u32, Vec<(f64, u32)>) {
    let mut times: Vec<f64> = outputs.iter().flat_map(|ray| ray.times()).filter(|&t| t > t_min).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let start = owner(outputs, t_min);
    let mut now = start;
    let mut changes = Vec::new();
    for t in times {
        let after = owner(outputs, t);
        if after != now {
            changes.push((t, after));
        }
        now = after;
    }
    (start, changes)
}

/// All changes after `t_min`, by repeated queries.
fn all_changes(
    tree: &Tree,
    lines: &Lines,
    t_min: f64,
    observer: &mut impl Observer,
) -> (u32, Vec<(f64, u32)>) {
    let mut stacks = Stacks::new(tree.height());
    let mut step = stacks.next_change(tree, lines, t_min, observer);
    let start = step.before;
    let (mut now, mut changes) = (start, Vec::new());
    while step.t < FOREVER {
        assert_eq!(step.before, now, "the side before is not the side after the last change");
        now = step.after;
        changes.push((step.t, now));
        step = stacks.next_change(tree, lines, step.t, observer);
    }
    assert_eq!((step.before, step.after), (now, now));
    (start, changes)
}

/// The largest numbers of slices and values, and the number of leaf queries.
#[derive(Default)]
struct Depths {
    slices: usize,
    values: usize,
    leaves: usize,
}

impl Observer for Depths {
    fn leaf(&mut self, _: usize, _: f64, _: Next) {
        self.leaves += 1;
    }

    fn depth(&mut self, slices: usize, values: usize) {
        self.slices = self.slices.max(slices);
        self.values = self.values.max(values);
    }
}

#[test]
fn random_trees_agree_with_the_algebra() {
    let (mut changes, mut tied) = (0usize, 0usize);
    for seed in 0..150_000 {
        let mut rng = Random::new(seed);
        let ties = seed % 3 > 0;
        let (skeleton, outputs, lines) = random_case(&mut rng, ties);
        let tree = skeleton.tree(&outputs);
        let rays = skeleton.root_rays(&lines, &outputs);
        let t_min = rng.pick(&[f64::NEG_INFINITY, f64::NEG_INFINITY, -1.0, 0.0, 0.5]);
        let mut depths = Depths::default();
        let lines = Lines(lines);
        let ours = all_changes(&tree, &lines, t_min, &mut depths);
        assert_eq!(ours, expected(&rays, t_min), "seed {seed}");
        let most = tree.height() as usize + 1;
        assert!(depths.slices <= most && depths.values <= most, "seed {seed}");
        changes += ours.1.len();
        tied += usize::from(ties && !ours.1.is_empty());
    }
    assert!(changes > 150_000 && tied > 35_000, "{changes} changes, {tied} trees with ties");
}

#[test]
fn every_rule_fires_and_is_explained() {
    struct Count([usize; 3]);
    impl Observer for Count {
        fn gate(&mut self, _: usize, operands: [ValueStep; 2], verdict: Verdict) {
            match verdict {
                Verdict::Fixed(_) => self.0[0] += 1,
                Verdict::Changes(step) => {
                    assert_eq!(step.t, operands[0].t.min(operands[1].t));
                    self.0[1] += 1;
                }
                Verdict::QueryAgain { t, first, second } => {
                    assert_eq!((first, second), (operands[0].t == t, operands[1].t == t));
                    self.0[2] += 1;
                }
            }
        }
    }
    let mut count = Count([0; 3]);
    for seed in 0..2000 {
        let (skeleton, outputs, lines) = random_case(&mut Random::new(seed), true);
        all_changes(&skeleton.tree(&outputs), &Lines(lines), f64::NEG_INFINITY, &mut count);
    }
    assert!(count.0.iter().all(|&n| n > 1000), "{:?}", count.0);
}

// ---- the stacks ----

/// A one-sided union of `n` lines, each of which begins in the one before and outlasts it.
fn overlapping(n: u32, leans_right: bool, reversed: bool) -> (Tree, Lines) {
    let mut skeleton = Skeleton::new(n);
    let order: Vec<u32> = if reversed { (0..n).rev().collect() } else { (0..n).collect() };
    let mut all = Skeleton::leaf(order[0]);
    for &k in &order[1..] {
        let leaf = Skeleton::leaf(k);
        all = if leans_right { skeleton.or(leaf, all) } else { skeleton.or(all, leaf) };
    }
    let lines = (0..n).map(|k| between(f64::from(k), f64::from(k) + 1.5)).collect();
    (skeleton.tree(&[all]), Lines(lines))
}

#[test]
fn the_bounds_of_both_stacks_are_reached_and_never_exceeded() {
    for n in 2..40 {
        let mut reached = Depths::default();
        for (leans_right, reversed) in [(false, false), (false, true), (true, false), (true, true)] {
            let (tree, lines) = overlapping(n, leans_right, reversed);
            assert_eq!(tree.height(), n - 1);
            let mut depths = Depths::default();
            let answer = all_changes(&tree, &lines, f64::NEG_INFINITY, &mut depths);
            assert_eq!(answer, (0, vec![(0.0, 1), (f64::from(n) + 0.5, 0)]));
            reached.slices = reached.slices.max(depths.slices);
            reached.values = reached.values.max(depths.values);
        }
        assert_eq!(reached.slices, n as usize, "slices of height + 1 = {n}");
        assert_eq!(reached.values, n as usize, "values of height + 1 = {n}");
    }
}

#[test]
fn wide_gates_are_balanced() {
    let n = 1000;
    let lines: Vec<RootRay> = (0..n).map(|k| between(f64::from(k), f64::from(k) + 1.5)).collect();
    for rule in [Rule::AtLeast(1), Rule::AtLeast(n), Rule::AtLeast(2), Rule::Odd] {
        let mut skeleton = Skeleton::new(n);
        let all = skeleton.join(rule, (0..n).map(Skeleton::leaf).collect());
        let tree = skeleton.tree(&[all]);
        assert_eq!((tree.height(), tree.nodes().len()), (10, 1999));
        let leaves = tree.nodes().iter().filter_map(|node| match node.kind {
            TreeNodeKind::Leaf(leaf) => Some(leaf),
            _ => None,
        });
        assert!(leaves.eq(0..n), "leaves stay in order");
        let answer = all_changes(&tree, &Lines(lines.clone()), f64::NEG_INFINITY, &mut NoObserver);
        assert_eq!(answer, expected(&skeleton.root_rays(&lines, &[all]), f64::NEG_INFINITY));
    }
}

#[test]
fn balance_spares_questions() {
    let n = 1000u32;
    let lines = || Lines((0..n).map(|k| between(f64::from(k), f64::from(k) + 1.5)).collect());
    let mut skeleton = Skeleton::new(n);
    let all = skeleton.join(Rule::AtLeast(1), (0..n).map(Skeleton::leaf).collect());
    let mut balanced = Depths::default();
    Stacks::new(10).next_change(&skeleton.tree(&[all]), &lines(), 0.0, &mut balanced);
    let (leaning, same) = overlapping(n, false, false);
    let mut depths = Depths::default();
    Stacks::new(leaning.height()).next_change(&leaning, &same, 0.0, &mut depths);
    assert!(balanced.leaves < 12_000 && depths.leaves > 500_000, "{} {}", balanced.leaves, depths.leaves);
}

/// A chain of all operations, 100,000 gates high, on a stack of 256 KiB: no function recurses.
#[test]
fn depth_needs_no_call_stack() {
    let work = || {
        let n = 100_000u32;
        let mut skeleton = Skeleton::new(n);
        let mut all = Skeleton::leaf(0);
        for k in 1..n {
            let leaf = Skeleton::leaf(k);
            let (rule, operands) = match k % 4 {
                0 => (Rule::AtLeast(1), vec![all, leaf]),
                1 => (Rule::AtLeast(2), vec![leaf.complement(), all]),
                2 => (Rule::Odd, vec![all, leaf]),
                _ => (Rule::AtLeast(2), vec![all.complement(), leaf.complement()]),
            };
            all = skeleton.join(rule, operands);
        }
        let mut lines = vec![RootRay::empty(); n as usize];
        for (k, times) in [(0, [0.0, 9.0]), (5, [1.0, 2.0]), (50_000, [3.0, 5.0]), (n - 2, [4.0, 5.0])] {
            lines[k as usize] = between(times[0], times[1]);
        }
        let tree = skeleton.tree(&[all]);
        assert_eq!(tree.height(), n - 1);
        let wanted = expected(&skeleton.root_rays(&lines, &[all]), f64::NEG_INFINITY);
        assert!(wanted.1.len() > 2);
        assert_eq!(all_changes(&tree, &Lines(lines), f64::NEG_INFINITY, &mut NoObserver), wanted);
        // both stacks full: every gate of the chain waits at once
        let (tree, lines) = overlapping(2000, true, true);
        let mut depths = Depths::default();
        Stacks::new(tree.height()).next_change(&tree, &lines, 0.0, &mut depths);
        assert!(depths.slices.max(depths.values) == 2000);
    };
    std::thread::Builder::new().stack_size(256 << 10).spawn(work).unwrap().join().unwrap();
}

#[test]
fn too_much_sharing_is_rejected() {
    let mut skeleton = Skeleton::new(2);
    let mut all = Skeleton::leaf(0);
    for _ in 0..80 {
        let not = all.complement();
        let both = skeleton.or(all, Skeleton::leaf(1));
        all = skeleton.join(Rule::Odd, vec![both, not]);
    }
    let refused = Tree::new(&skeleton.gates, &[all], MAX_NODES);
    assert_eq!(refused.unwrap_err(), TooLarge { nodes: u64::MAX, most: MAX_NODES });
    // the size is computed exactly, and a tree of exactly that size is accepted
    let mut skeleton = Skeleton::new(2);
    let both = skeleton.or(Skeleton::leaf(0), Skeleton::leaf(1));
    let twice = skeleton.join(Rule::Odd, vec![both, both.complement(), Skeleton::leaf(1)]);
    assert_eq!(Tree::new(&skeleton.gates, &[twice, both], 12).unwrap_err().nodes, 13);
    assert_eq!(Tree::new(&skeleton.gates, &[twice, both], 13).unwrap().nodes().len(), 13);
}

// ---- models ----

fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<_> = arguments.iter().map(|&(n, v)| (n, Value::Number(v))).collect();
    Solid::from(build(name, &arguments).unwrap())
}

fn ball(name: &str, x: f64) -> Solid {
    shape("sphere", &[("radius", 1.0)]).named(name).translate([x, 0.0, 0.0])
}

fn single_hit(program: Arc<Program>) -> SingleHit {
    SingleHit::new(program).unwrap()
}

/// Nested placements: queries within queries.
#[test]
fn placed_solids_are_evaluated_in_their_turn() {
    let pair = |step: f64| [0.0, step].map(|x| Affine::translate(Vec3::new(x, 0.0, 0.0)));
    let two = (ball("a", 0.0) - ball("b", 0.5)).place(pair(3.0));
    let four = (&two | &ball("c", 1.0)).place(pair(10.0));
    let eight = (four ^ ball("d", 4.0)).place(pair(20.0));
    let program = Arc::new(Program::compile(&eight).unwrap());
    let ray = Ray::new(Vec3::new(-5.0, 0.25, 0.0), Vec3::X);
    let found = single_hit(program.clone()).one(ray, &Query::default()).unwrap();
    assert_eq!(found, Reference::new(program).one(ray, &Query::default()).unwrap());
    assert!(found.crossings.len() >= 16, "{}", found.crossings.len());
}

#[test]
fn models_with_too_much_sharing_are_rejected_with_a_reason() {
    let mut s = ball("a", 0.0);
    for k in 1..40 {
        let other = ball("b", f64::from(k));
        s = (&s & &other) ^ (&s | &other);
    }
    let refused = SingleHit::new(Arc::new(Program::compile(&s).unwrap())).unwrap_err();
    assert!(refused.nodes > 1 << 39 && refused.most == MAX_NODES);
    let text = refused.to_string();
    assert!(text.contains("4194304: shared parts are duplicated at each use."), "{text}");
}

// ---- explanations ----

/// `((a | b) - c | d | e - f) | g | h`, each ball overlapping the next.
fn eight_spheres() -> Arc<Program> {
    let mut s = ball("a", 0.0);
    for (k, name) in ["b", "c", "d", "e", "f", "g", "h"].into_iter().enumerate() {
        let next = ball(name, 1.5 * (k as f64 + 1.0));
        s = if k % 3 == 1 { s - next } else { s | next };
    }
    Arc::new(Program::compile(&s).unwrap())
}

fn along_x() -> Ray {
    Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X)
}

#[test]
fn the_chain_of_eight_spheres_reads_like_an_explanation() {
    let text = single_hit(eight_spheres()).explain(along_x(), &Query::default()).to_string();
    for line in [
        "The next change after t = 4:",
        "a is left at 6, through a.side.",
        "a | b stays inside at 5.5: b is entered, but the ray is inside a until 6. So b is queried again. (rule 4)",
        "a | b is left at 7.5: b is left, and the ray is outside a for good. (rule 3)",
        "(a | b) - c is left at 7: c is entered, and the ray is inside a | b until 7.5. (rule 3)",
        "(a ... e) - f is outside for good: the ray is outside ((a | b) - c) | d | e for good, regardless of f. (rule 1)",
        "So the ray is in solid until t = 11.5, then in the world.",
        "At t = 7 it passes from solid into the world, through c.side.",
        "(7 questions, 131 steps.)",
    ] {
        assert!(text.lines().any(|found| found.trim() == line), "{line}\n{text}");
    }
    // a constant node is printed once, and not at all below a larger constant node
    assert_eq!(text.matches("  a is outside for good.\n").count(), 1);
    assert_eq!(text.matches(" is outside for good.").count(), 3, "{text}");
}

/// `(((s0 | s1) - s2) | s3) - ...`: balls in a row, in a tree as deep as it is long.
fn deep_chain(count: u32) -> Arc<Program> {
    let mut s = ball("s0", 0.0);
    for k in 1..count {
        let next = ball(&format!("s{k}"), 4.0 * f64::from(k));
        s = if k % 2 == 0 { s - next } else { s | next };
    }
    Arc::new(Program::compile(&s).unwrap())
}

#[test]
fn long_explanations_are_cut_and_say_so() {
    let explanation = single_hit(deep_chain(1_000)).explain(along_x(), &Query::default());
    let kept: usize = explanation.questions.iter().map(|question| question.entries.len()).sum();
    assert!(kept == MAX_ENTRIES && explanation.questions.iter().any(|question| question.left_out > 0));
    assert!(explanation.steps() > 10 * MAX_ENTRIES);
    let lines =
        |text: &str| text.lines().filter(|line| line.contains("(rule ") || line.contains("through")).count();
    for most in [10, MAX_LINES] {
        let text = explanation.text(most).to_string();
        assert!(lines(&text) <= most + 100, "{}", lines(&text));
        assert!(text.len() < 1 << 20 && text.contains(" lines are left out ..."), "{text}");
        assert!(text.contains(" more questions are left out.\n"), "{text}");
        assert!(text.contains("At t = 4 it passes from the world into solid, through s0.side.\n"), "{text}");
        assert!(
            text.contains(&format!("... and so on: {} crossings in all.\n", explanation.crossings.len())),
            "{text}"
        );
    }
    assert!(explanation.crossings.len() == 2 * 501);
}

#[test]
fn resolved_parts_of_large_models_take_one_line() {
    let far = (0..4096)
        .map(|k| ball("far", 10.0 * f64::from(k)).apply(Affine::translate(Vec3::new(0.0, 9.0, 0.0))));
    let near = ball("near", 0.0);
    let s = Solid::union(far.chain([near]));
    let explanation =
        single_hit(Arc::new(Program::compile(&s).unwrap())).explain(along_x(), &Query::default());
    let text = explanation.to_string();
    assert!(explanation.steps() > 3 * 8192);
    // entries of constant nodes are kept once
    let kept: usize = explanation.questions.iter().map(|question| question.entries.len()).sum();
    assert!(kept < 8250, "{kept}");
    assert!(text.lines().count() < 120, "{text}");
    assert!(text.contains("near is entered at 4, through near.side."), "{text}");
    assert!(!text.contains("left out"), "{text}");
}

#[test]
fn times_are_printed_with_as_many_digits_as_distinguish_them() {
    let text = |x: f64| {
        let s = ball("a", 1.0 / 3.0) | ball("b", x);
        single_hit(Arc::new(Program::compile(&s).unwrap())).explain(along_x(), &Query::default()).to_string()
    };
    assert!(text(2.0 / 3.0).contains("At t = 4.33333 it passes"), "{}", text(2.0 / 3.0));
    let near = text(1.0 / 3.0 + 1e-9);
    assert!(
        near.contains("a is entered at 4.333333333,") && near.contains("b is entered at 4.333333334,"),
        "{near}"
    );
}

#[test]
fn regions_have_words_of_their_own() {
    let two = ball("a", 0.0) ^ ball("b", 1.0);
    let region = |name: &str, medium, solid| Region { name: name.to_owned(), solid, medium };
    let regions = [region("pair", 1, two), region("core", 2, ball("e", 1.5))];
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let text = single_hit(program).explain(along_x(), &Query::default()).to_string();
    for line in [
        "among pair and core the ray passes from the world into pair at 4: a ^ b is entered, and the ray is outside e until 5.5. (rule 3)",
        "among pair and core the ray stays in core at 6: a ^ b is entered, but the ray is inside e until 7.5. So a ^ b is queried again. (rule 4)",
        "among pair and core the ray is in the world for good: the ray is outside a ^ b and e for good. (rule 1)",
        "  So the ray is in core until t = 7.5, then in the world.",
    ] {
        assert!(text.contains(line), "{line}\n{text}");
    }
}

#[test]
fn explanations_hold_every_decision_and_end_in_the_answer() {
    let mut rules = [0usize; 4];
    for seed in 0..300 {
        let mut rng = Random::new(seed);
        let style = [Style::Generic, Style::Grid, Style::Planes][seed as usize % 3];
        let model = Model::random(&mut rng, style);
        let Ok(program) = model.compile() else { continue };
        let evaluator = single_hit(program);
        let ray = rays(&mut rng, style, &model.frame, 1)[0];
        let window = Window::new(rng.pick(&[f64::NEG_INFINITY, -1.0]), rng.pick(&[FOREVER, 2.0])).unwrap();
        let limit = rng.pick(&[Limit::All, Limit::First]);
        let query = Query { window, limit, starts: None };
        let explanation = evaluator.explain(ray, &query);
        let answer = evaluator.one(ray, &query).unwrap();
        assert_eq!(explanation.start, answer.starts[0]);
        let crossings: Vec<Crossing> = explanation.crossings.iter().map(|found| found.crossing).collect();
        assert_eq!(crossings, answer.crossings, "seed {seed}");
        for entry in explanation.questions.iter().flat_map(|question| &question.entries) {
            if let What::Gate { operands, verdict, .. } = &entry.what {
                check_decision(evaluator.tree(PrototypeId(0)), entry.node, operands, *verdict);
                rules[usize::from(entry.what.rule().unwrap()) - 1] += 1;
            }
        }
        assert!(explanation.to_string().ends_with("steps.)\n"));
    }
    assert!([0, 2, 3].iter().all(|&k| rules[k] > 100), "{rules:?}");
}

/// Checks a decision against the text of the rule.
fn check_decision(tree: &Tree, gate: usize, operands: &[ExplainedOperand; 2], verdict: Verdict) {
    let TreeNodeKind::Gate(op) = tree.nodes()[gate].kind else { panic!("not a gate") };
    let [a, b] = operands.each_ref().map(|operand| operand.answer);
    let value = |t: f64| [a, b].map(|step| if step.t <= t { step.after } else { step.before });
    let f = |[a, b]: [u32; 2]| op.of(a, b);
    match verdict {
        Verdict::Fixed(fixed) => {
            assert!(a.t == FOREVER || b.t == FOREVER);
            assert_eq!(f(value(a.t.min(b.t).next_down())), fixed);
            assert_eq!(f(value(f64::MAX)), fixed);
        }
        Verdict::Changes(step) => {
            assert_eq!((f(value(step.t.next_down())), f(value(step.t))), (step.before, step.after));
            assert_ne!(step.before, step.after);
        }
        Verdict::QueryAgain { t, .. } => {
            assert_eq!(t, a.t.min(b.t));
            assert_eq!(f(value(t.next_down())), f(value(t)));
        }
    }
}
