//! The seed's single-hit algorithm, with counts of the errors caused by its original table and limits.
//!
//! Leaves are root-rays, so that the algebra of root-rays gives the correct answers; "ours" is the evaluator.

use rayweave_conformance::Random;
use rayweave_model::{Edge, Gate, LeafId, NodeId, Rule};
use rayweave_rootray::{Root, RootRay, Side};
use rayweave_trace::single_hit::seed_view::{
    Action, CompleteTree, Fault, Limits, Operator, Slot, State, Tables, next, silent,
};
use rayweave_trace::single_hit::{LeafAnswers, MAX_NODES, Next, NoObserver, Stacks, Tree};

// ---- complete trees ----

fn chain(leaves: u32) -> CompleteTree {
    let mut tree = CompleteTree::leaf(0, false);
    for k in 1..leaves {
        tree = CompleteTree::join(Operator::Union, &tree, &CompleteTree::leaf(k, false));
    }
    tree
}

fn perfect(height: u32) -> CompleteTree {
    (0..height).fold(CompleteTree::leaf(0, false), |t, _| CompleteTree::join(Operator::Union, &t, &t))
}

#[test]
fn post_order_by_bits() {
    let three = perfect(3);
    let order: Vec<u32> = three.post_order().collect();
    assert_eq!(order, [8, 9, 4, 10, 11, 5, 2, 12, 13, 6, 14, 15, 7, 3, 1]);
    // the definition: children before their parent, the first before the second
    fn visit(i: u32, size: u32, out: &mut Vec<u32>) {
        if i <= size {
            visit(2 * i, size, out);
            visit(2 * i + 1, size, out);
            out.push(i);
        }
    }
    for height in 0..=10 {
        let tree = perfect(height);
        let (size, mut wanted) = ((2 << height) - 1, Vec::new());
        visit(1, size, &mut wanted);
        assert!(tree.post_order().eq(wanted.iter().copied()), "height {height}");
        assert_eq!(tree.slots().len() as u32, size);
    }
}

#[test]
fn slices_are_the_sub_trees() {
    for height in 1..=8 {
        let tree = perfect(height);
        let order: Vec<u32> = tree.post_order().collect();
        let place = |i: u32| order.iter().position(|&x| x == i).unwrap();
        for i in 1..1u32 << height {
            let half = (1 << tree.elevation(i)) - 1;
            let (left, right, at) = (tree.left_slice(i), tree.right_slice(i), place(i));
            assert_eq!((place(left.start), place(left.end)), (at - 2 * half, at - half));
            assert_eq!((place(right.start), right.end), (at - half, i));
        }
    }
}

#[test]
fn shapes_that_are_not_perfect_have_empty_slots() {
    let tree = chain(4);
    assert_eq!((tree.height(), tree.slots().len()), (3, 15));
    let used: Vec<u32> = tree.post_order().filter(|&i| tree.get(i) != Slot::Empty).collect();
    assert_eq!(used, [8, 9, 4, 5, 2, 3, 1]);
    assert_eq!(tree.get(9), Slot::Leaf { leaf: 1, complemented: false });
    assert_eq!(tree.get(3), Slot::Leaf { leaf: 3, complemented: false });
    assert_eq!((tree.get(0), tree.get(16)), (Slot::Empty, Slot::Empty));
}

// ---- tables ----

#[test]
fn tables_of_the_rule_and_the_original_differ_in_one_place() {
    let (ours, original) = (Tables::from_rule(), Tables::original());
    let differ: Vec<_> = Tables::keys()
        .filter(|&(o, c, a, b)| ours.look_up(o, c, a, b) != original.look_up(o, c, a, b))
        .collect();
    let exits = |closer| (Operator::Union, closer, State::Exit, State::Exit);
    assert_eq!(differ, [exits(true), exits(false)], "of {} entries", Tables::keys().count());
    assert_eq!(Tables::keys().count(), 54);
    let of = |tables: &Tables, closer| tables.look_up(Operator::Union, closer, State::Exit, State::Exit);
    assert_eq!([of(&ours, true), of(&ours, false)], [Action::LoopFirst, Action::LoopSecond]);
    assert_eq!([of(&original, true), of(&original, false)], [Action::Second, Action::First]);
}

/// The numbers in the source of Opticks, and the corrected ones.
#[test]
fn tables_are_packed_as_published() {
    let published = [[0x22121141, 0x00014014, 0x00141141], [0x22115122, 0x00022055, 0x00133155]];
    assert_eq!(Tables::original().packed(), published);
    let mended = [[0x22141141, 0x00014014, 0x00141141], [0x22155122, 0x00022055, 0x00133155]];
    assert_eq!(Tables::from_rule().packed(), mended);
}

// ---- trees over lines ----

struct Lines(Vec<RootRay>);

impl LeafAnswers for Lines {
    fn next(&self, leaf: u32, t_min: f64) -> Next {
        next_of(&self.0[leaf as usize], t_min)
    }
}

fn next_of(line: &RootRay, t_min: f64) -> Next {
    let passed = line.times().filter(|&t| t <= t_min).count();
    Next::new(line.start().after(passed).is_inside(), line.times().nth(passed))
}

fn line(times: &[f64]) -> RootRay {
    RootRay::new(Side::Outside, times.iter().map(|&t| Root { t, surface: () }).collect()).unwrap()
}

/// One tree in the three forms that are compared.
#[derive(Clone)]
struct Tried {
    complete: CompleteTree,
    edge: Edge,
    truth: RootRay,
}

struct Forms {
    gates: Vec<Gate<'static>>,
    lines: Lines,
}

impl Forms {
    fn new(lines: Vec<RootRay>) -> Forms {
        let mut gates = vec![Gate::Empty, Gate::Universe];
        gates.extend((0..lines.len() as u32).map(|k| Gate::Leaf(LeafId(k))));
        Forms { gates, lines: Lines(lines) }
    }

    fn leaf(&self, k: u32) -> Tried {
        let edge = Edge::new(NodeId(k + 2), false);
        Tried { complete: CompleteTree::leaf(k, false), edge, truth: self.lines.0[k as usize].clone() }
    }

    fn join(&mut self, operator: Operator, a: &Tried, b: &Tried) -> Tried {
        let (rule, second, truth) = match operator {
            Operator::Union => (1, b.edge, a.truth.union(&b.truth)),
            Operator::Intersection => (2, b.edge, a.truth.intersection(&b.truth)),
            Operator::Difference => (2, b.edge.complement(), a.truth.difference(&b.truth)),
        };
        self.gates.push(Gate::Join(Rule::AtLeast(rule), vec![a.edge, second].into()));
        let edge = Edge::new(NodeId(self.gates.len() as u32 - 1), false);
        Tried { complete: CompleteTree::join(operator, &a.complete, &b.complete), edge, truth }
    }

    fn ours(&self, tried: &Tried, t_min: f64) -> Next {
        let tree = Tree::new(&self.gates, &[tried.edge], MAX_NODES).unwrap();
        Stacks::new(tree.height()).next_change(&tree, &self.lines, t_min, &mut NoObserver).next()
    }

    fn seed(&self, tried: &Tried, tables: &Tables, limits: Limits, t_min: f64) -> Result<Next, Fault> {
        next(&tried.complete, tables, limits, &self.lines, t_min)
    }
}

/// Numbers of wrong answers: of the original tables with the original limits and with wide ones, of the
/// corrected tables with wide limits, and ours.
#[derive(Debug, Default, PartialEq)]
struct Wrong {
    seed: usize,
    original: usize,
    mended: usize,
    ours: usize,
}

impl Wrong {
    fn count(&mut self, forms: &Forms, tried: &Tried, t_min: f64) {
        let truth = next_of(&tried.truth, t_min);
        let wide = Limits::for_height(tried.complete.height());
        let (original, mended) = (Tables::original(), Tables::from_rule());
        let wrong = |answer: Next| usize::from(answer != truth);
        self.seed += wrong(silent(forms.seed(tried, &original, Limits::SEED, t_min)));
        self.original += wrong(silent(forms.seed(tried, &original, wide, t_min)));
        self.mended += wrong(silent(forms.seed(tried, &mended, wide, t_min)));
        self.ours += wrong(forms.ours(tried, t_min));
    }
}

/// A box from -50 to 50 with two balls about its ends, from inside the left ball: the seed returns the box's
/// own exit, 50, inside the right ball.
#[test]
fn the_farther_exit_is_wrong_where_the_closer_operand_is_entered_again() {
    let lines = vec![line(&[-50.0, 50.0]), line(&[-60.0, -40.0]), line(&[40.0, 60.0])];
    let mut forms = Forms::new(lines);
    let balls = forms.join(Operator::Union, &forms.leaf(1), &forms.leaf(2));
    for (a, b) in [(forms.leaf(0), balls.clone()), (balls, forms.leaf(0))] {
        let all = forms.join(Operator::Union, &a, &b);
        let seed = |forms: &Forms, tables| forms.seed(&all, &tables, Limits::SEED, -45.0);
        assert_eq!(seed(&forms, Tables::original()), Ok(Next::Exit(50.0)));
        assert_eq!(seed(&forms, Tables::from_rule()), Ok(Next::Exit(60.0)));
        assert_eq!(forms.ours(&all, -45.0), Next::Exit(60.0));
        assert_eq!(next_of(&all.truth, -45.0), Next::Exit(60.0));
    }
}

/// A left-deep union of leaves in a row, each overlapping the next.
fn row(leaves: u32, reversed: bool) -> (Forms, Tried) {
    let at = |k: u32| f64::from(if reversed { leaves - 1 - k } else { k });
    let mut forms = Forms::new((0..leaves).map(|k| line(&[at(k), at(k) + 1.5])).collect());
    let mut all = forms.leaf(0);
    for k in 1..leaves {
        let leaf = forms.leaf(k);
        all = forms.join(Operator::Union, &all, &leaf);
    }
    (forms, all)
}

#[test]
fn four_slices_lose_rays_on_five_overlapping_leaves_in_a_row() {
    for leaves in 2..=8 {
        let mut faults = 0;
        for reversed in [false, true] {
            let (forms, all) = row(leaves, reversed);
            let truth = next_of(&all.truth, 0.25);
            assert_eq!(truth, Next::Exit(f64::from(leaves) + 0.5));
            let tables = Tables::from_rule();
            match forms.seed(&all, &tables, Limits::SEED, 0.25) {
                Ok(answer) => assert_eq!(answer, truth),
                Err(fault) => {
                    // the original reports it as a miss
                    assert_eq!((fault, silent(Err(fault))), (Fault::SlicesFull, Next::Outside));
                    faults += 1;
                }
            }
            assert_eq!(forms.seed(&all, &tables, Limits::for_height(leaves - 1), 0.25), Ok(truth));
            assert_eq!(forms.ours(&all, 0.25), truth);
        }
        assert_eq!(faults, u32::from(leaves >= 5), "{leaves} leaves, in one of the two directions");
    }
}

#[test]
fn one_slice_or_value_less_than_derived_is_not_enough() {
    for leaves in 3..=12 {
        let enough = Limits::for_height(leaves - 1);
        let short = [
            Limits { slices: enough.slices - 1, ..enough },
            Limits { index_bits: enough.index_bits - 1, ..enough },
        ];
        for limits in short {
            let faults = [false, true].map(|reversed| {
                let (forms, all) = row(leaves, reversed);
                forms.seed(&all, &Tables::from_rule(), limits, 0.25).is_err()
            });
            assert!(faults.contains(&true), "{leaves} leaves, {limits:?}");
        }
    }
}

#[test]
fn eight_bits_lose_every_ray_at_height_eight() {
    for leaves in [8, 9, 10] {
        let (mut lost, mut hits) = (0, 0);
        for reversed in [false, true] {
            let (forms, all) = row(leaves, reversed);
            let limits = Limits { slices: 100, values: 100, ..Limits::SEED };
            for k in 0..20 {
                let t_min = -1.0 + 0.4 * f64::from(k);
                let truth = next_of(&all.truth, t_min);
                hits += usize::from(truth != Next::Outside);
                let answer = silent(forms.seed(&all, &Tables::from_rule(), limits, t_min));
                lost += usize::from(truth != Next::Outside && answer == Next::Outside);
                assert_eq!(forms.ours(&all, t_min), truth);
            }
        }
        assert!(hits > 20);
        assert_eq!(lost, if leaves <= 8 { 0 } else { hits }, "{leaves} leaves");
    }
}

/// Two boxes side by side: a tie at which the tables query only one operand again.
#[test]
fn tables_leak_on_ties() {
    // A exits where B is entered: their union continues
    let mut forms = Forms::new(vec![line(&[0.0, 1.0]), line(&[1.0, 2.0])]);
    let both = forms.join(Operator::Union, &forms.leaf(0), &forms.leaf(1));
    assert_eq!(next_of(&both.truth, 0.5), Next::Exit(2.0));
    assert_eq!(forms.ours(&both, 0.5), Next::Exit(2.0));
    let wide = Limits::for_height(1);
    assert_eq!(forms.seed(&both, &Tables::from_rule(), wide, 0.5), Ok(Next::Exit(1.0)));
    assert_eq!(forms.seed(&both, &Tables::original(), wide, 0.5), Ok(Next::Exit(1.0)));
}

// ---- counts ----

fn random_line(rng: &mut Random, ties: bool) -> RootRay {
    let mut time = || if ties { rng.below(9) as f64 } else { rng.between(0.0, 9.0) };
    let (a, b) = (time(), time());
    if a == b { line(&[]) } else { line(&[a.min(b), a.max(b)]) }
}

fn random_tree(rng: &mut Random, leaves: u32, operators: &[Operator], ties: bool) -> (Forms, Tried) {
    let mut forms = Forms::new((0..leaves).map(|_| random_line(rng, ties)).collect());
    let mut pool: Vec<Tried> = (0..leaves).map(|k| forms.leaf(k)).collect();
    while pool.len() > 1 {
        let a = pool.swap_remove(rng.below(pool.len()));
        let b = pool.swap_remove(rng.below(pool.len()));
        let joined = forms.join(rng.pick(operators), &a, &b);
        pool.push(joined);
    }
    let all = pool.remove(0);
    (forms, all)
}

/// Wrong answers in `trees` random trees, each queried from before its start and from four random times.
fn count_wrong(trees: u64, leaves: std::ops::Range<u32>, operators: &[Operator], ties: bool) -> Wrong {
    let mut wrong = Wrong::default();
    for seed in 0..trees {
        let mut rng = Random::new(seed);
        let n = leaves.start + rng.below((leaves.end - leaves.start) as usize) as u32;
        let (forms, all) = random_tree(&mut rng, n, operators, ties);
        for _ in 0..4 {
            wrong.count(&forms, &all, rng.between(-1.0, 8.0));
        }
        wrong.count(&forms, &all, -1.0);
    }
    println!("{wrong:?} of {}: {leaves:?} leaves, {operators:?}, ties: {ties}.", 5 * trees);
    wrong
}

const UNION: [Operator; 1] = [Operator::Union];

#[test]
fn without_ties_the_corrected_tables_are_right_and_the_original_ones_are_not() {
    for operators in [&UNION[..], &Operator::ALL] {
        let wrong = count_wrong(4000, 2..9, operators, false);
        assert!(wrong.original > 0, "{wrong:?}");
        assert!(wrong.seed >= wrong.original, "{wrong:?}");
        assert_eq!((wrong.mended, wrong.ours), (0, 0));
    }
    // the original entry is right for two convex leaves
    let wrong = count_wrong(4000, 2..3, &Operator::ALL, false);
    assert_eq!(wrong, Wrong::default());
}

#[test]
fn with_ties_all_tables_are_wrong() {
    let wrong = count_wrong(4000, 2..9, &Operator::ALL, true);
    assert!(wrong.seed > 500 && wrong.original > 500 && wrong.mended > 500, "{wrong:?}");
    assert_eq!(wrong.ours, 0);
}

#[test]
fn the_limits_of_the_seed_lose_rays_that_wide_ones_find() {
    let mut lost = 0;
    for seed in 0..400 {
        let mut rng = Random::new(seed);
        let (forms, all) = random_tree(&mut rng, 12, &Operator::ALL, false);
        let tables = Tables::from_rule();
        let wide = Limits::for_height(all.complete.height());
        let t_min = rng.between(-1.0, 8.0);
        assert_eq!(forms.seed(&all, &tables, wide, t_min), Ok(next_of(&all.truth, t_min)));
        lost += usize::from(forms.seed(&all, &tables, Limits::SEED, t_min).is_err());
    }
    assert!(lost > 0);
}

// ---- the view of a tree ----

#[test]
fn a_positive_view_of_any_tree_without_symmetric_differences() {
    for seed in 0..2000 {
        let mut rng = Random::new(seed);
        let (mut forms, all) = random_tree(&mut rng, 6, &Operator::ALL, false);
        let edge = if rng.chance(0.5) { all.edge.complement() } else { all.edge };
        let truth = if edge == all.edge { all.truth.clone() } else { all.truth.complement() };
        let tree = Tree::new(&forms.gates, &[edge], MAX_NODES).unwrap();
        let complete = CompleteTree::view(&tree).unwrap();
        assert!(!complete.slots().contains(&Slot::Operator(Operator::Difference)));
        let t_min = rng.between(-1.0, 8.0);
        let limits = Limits::for_height(complete.height());
        let answer = next(&complete, &Tables::from_rule(), limits, &forms.lines, t_min);
        assert_eq!(answer, Ok(next_of(&truth, t_min)), "seed {seed}");
        // no view of a tree with a symmetric difference
        forms.gates.push(Gate::Join(Rule::Odd, vec![edge, Edge::new(NodeId(2), false)].into()));
        let odd = Edge::new(NodeId(forms.gates.len() as u32 - 1), false);
        assert_eq!(CompleteTree::view(&Tree::new(&forms.gates, &[odd], MAX_NODES).unwrap()), None);
    }
}
