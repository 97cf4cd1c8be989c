//! Picture of the "farther exit" error: the original nine-entry tables on a chain whose odd and even balls
//! are united first.

use crate::chain;
use crate::kit::{Sheet, model, of_model, root_ray};
use rayweave::Weave;
use rayweave::rootray::RootRay;
use rayweave::trace::single_hit::seed_view::{CompleteTree, Limits, Operator, Tables, next};
use rayweave::trace::single_hit::{LeafAnswers, Next};

const WIDTH: f64 = 960.0;
const LEFT: f64 = 236.0;
const UNIT: f64 = 5.9;
const TOP: f64 = 52.0;
const ROW: f64 = 50.0;

fn place(t: f64) -> f64 {
    LEFT + UNIT * (t + 59.0)
}

/// The balls along the ray.
struct Balls(Vec<RootRay>);

impl LeafAnswers for Balls {
    fn next(&self, leaf: u32, t_min: f64) -> Next {
        let ray = &self.0[leaf as usize];
        let passed = ray.times().take_while(|&t| t <= t_min).count();
        Next::new(ray.start().after(passed).is_inside(), ray.times().nth(passed))
    }
}

/// The union of the balls 1, 3, 5, 7 and of the balls 2, 4, 6, 8, united.
fn tree() -> CompleteTree {
    let join = |a: &CompleteTree, b: &CompleteTree| CompleteTree::join(Operator::Union, a, b);
    let leaf = |k| CompleteTree::leaf(k, false);
    let half = |k| join(&join(&leaf(k), &leaf(k + 2)), &join(&leaf(k + 4), &leaf(k + 6)));
    join(&half(0), &half(1))
}

/// The answers of the original state machine, hit by hit, with stacks as deep as the tree needs.
fn steps(balls: &Balls, tables: &Tables) -> Vec<Next> {
    let tree = tree();
    let limits = Limits::for_height(tree.height());
    let mut t_min = f64::NEG_INFINITY;
    let mut steps = Vec::new();
    while t_min < f64::INFINITY {
        let answer = next(&tree, tables, limits, balls, t_min).unwrap();
        t_min = answer.time();
        steps.push(answer);
    }
    steps.pop();
    steps
}

pub fn picture() -> String {
    let scene = model("chain");
    let balls = Balls((1..=8).map(|k| of_model(&scene, &format!("s{k}"), chain::ray())).collect());
    let halves = [0, 1].map(|k| RootRay::union_all(balls.0.iter().skip(k).step_by(2)));
    let truth = root_ray(&Weave::new(chain::compiled().program), chain::ray());
    let [by_rule, by_tables] = [Tables::from_rule(), Tables::original()].map(|tables| steps(&balls, &tables));
    assert!(by_rule.iter().map(|step| step.time()).eq(truth.times()));

    let mut sheet = Sheet::default();
    sheet.left("title", 20.0, 28.0, "(1 | 3 | 5 | 7) | (2 | 4 | 6 | 8), hit by hit");
    spans(&mut sheet, 0, ["balls 1, 3, 5, 7", "A"], "a", &halves[0]);
    spans(&mut sheet, 1, ["balls 2, 4, 6, 8", "B"], "b", &halves[1]);
    spans(&mut sheet, 2, ["A | B", "evaluated exactly"], "r", &truth);
    hits(&mut sheet, 3, ["the rule", "the closer exit: query again"], &by_rule, &truth);
    hits(&mut sheet, 4, ["nine entries", "the farther exit is the answer"], &by_tables, &truth);
    axis(&mut sheet, TOP + 5.0 * ROW + 8.0);
    let wrong = by_tables.iter().filter(|step| is_wrong(step, &truth)).count();
    let missed = truth.times().filter(|&t| by_tables.iter().all(|step| step.time() != t)).count();
    let note = format!(
        "Full: entered. Open: left. Ringed: a crossing that does not exist ({wrong}). Missed by the tables: {missed} of {}.",
        by_rule.len()
    );
    sheet.left("tick", 20.0, TOP + 5.0 * ROW + 52.0, &note);
    let description = "The odd balls and the even balls of the chain along a ray, their union, and the hits that the \
                       rule and the usual tables give; the tables report exits where the other half of the chain goes on.";
    sheet.finish([WIDTH, TOP + 5.0 * ROW + 70.0], "A union that is left too early", description)
}

fn name(sheet: &mut Sheet, row: usize, [name, note]: [&str; 2]) -> f64 {
    let top = TOP + ROW * row as f64;
    sheet.right("head", LEFT - 16.0, top + 15.0, name);
    sheet.right("tick", LEFT - 16.0, top + 30.0, note);
    top
}

fn spans(sheet: &mut Sheet, row: usize, names: [&str; 2], class: &str, ray: &RootRay) {
    let top = name(sheet, row, names);
    sheet.line("base", [place(-59.0), top + 30.0], [place(59.0), top + 30.0]);
    for (start, end) in ray.spans() {
        let rectangle = [place(start), top + 6.0, place(end) - place(start), 24.0];
        sheet.svg.rectangle(&format!("{class} tint"), rectangle, "");
        for x in [place(start), place(end)] {
            sheet.line(&format!("line of-{class}"), [x, top + 6.0], [x, top + 30.0]);
        }
    }
}

/// True if the solid has no crossing of this kind at this time.
fn is_wrong(step: &Next, truth: &RootRay) -> bool {
    let enters = matches!(step, Next::Enter(_));
    !truth.crossings().any(|(root, side)| root.t == step.time() && side.is_inside() == enters)
}

/// Hits as marks: filled on entry, open on exit.
fn hits(sheet: &mut Sheet, row: usize, names: [&str; 2], steps: &[Next], truth: &RootRay) {
    let top = name(sheet, row, names);
    let y = top + 18.0;
    sheet.line("base", [place(-59.0), y], [place(59.0), y]);
    for step in steps {
        let at = [place(step.time()), y];
        let class = if matches!(step, Next::Enter(_)) { "r" } else { "ring of-r" };
        sheet.svg.circle(class, at, 4.2, "");
        if is_wrong(step, truth) {
            sheet.svg.circle("wrong", at, 10.0, "");
        }
    }
}

fn axis(sheet: &mut Sheet, y: f64) {
    sheet.line("axis", [place(-59.0), y], [place(59.0), y]);
    for t in [-40.0, -20.0, 0.0, 20.0, 40.0] {
        sheet.line("axis", [place(t), y], [place(t), y + 5.0]);
        sheet.centre("tick", place(t), y + 17.0, &t.to_string().replace('-', "\u{2212}"));
    }
}
