//! Picture of one query to the chain of eight balls, decision by decision.

use crate::kit::{Sheet, model};
use rayweave::trace::single_hit::{Entry, Next, Question, Verdict, What};
use rayweave::{Compiled, Program, Query, Ray, SingleHit, Vec3};

const WIDTH: f64 = 960.0;
/// The x of the picture at which x = 0 is drawn, and the length of a millimetre; the same for the balls and
/// for the steps below.
const MIDDLE: f64 = 440.0;
const UNIT: f64 = 5.0;
const BALLS: f64 = 134.0;
const ROW: f64 = 16.5;
/// The height of the ray above the middle plane of the chain.
const HEIGHT: f64 = 2.0;
const BALL: f64 = 10.0;

fn place(t: f64) -> f64 {
    MIDDLE + UNIT * t.clamp(-62.0, 62.0)
}

/// The ray along x; t equals x.
pub fn ray() -> Ray {
    Ray::new(Vec3::new(0.0, 0.0, HEIGHT), Vec3::X)
}

pub fn compiled() -> Compiled {
    Compiled::new(&model("chain")).unwrap()
}

pub fn picture() -> String {
    let compiled = compiled();
    let program = compiled.program.clone();
    let explanation = SingleHit::new(program.clone()).unwrap().explain(ray(), &Query::default());
    let mut sheet = Sheet::default();
    sheet.left("title", 20.0, 28.0, "The next crossing of the chain of eight balls, after its entry");
    balls(&mut sheet, &program);
    // the first query finds the entry into the chain, the second one the next crossing
    let question = &explanation.questions[1];
    line(&mut sheet, question);
    let mut y = 268.0;
    for entry in &question.entries {
        step(&mut sheet, &program, entry, y);
        y += ROW;
    }
    guides(&mut sheet, question, y);
    let answer =
        format!("Answer: inside until t = {:.2}, then outside.", question.answer.t).replace('-', "\u{2212}");
    sheet.left("head", 20.0, y + 18.0, &answer);
    let legend =
        "Arrow: from the time a ball was queried from to its answer. Open: nothing changes. Full: a change.";
    sheet.left("tick", place(-62.0) + 204.0, y + 18.0, legend);
    let description = "Eight overlapping circles with a ray; below it every leaf that is queried and every decision: ball \
                       after ball is left while the next is already entered, so that the union queries again, until ball 4 \
                       is left where no other ball is.";
    sheet.finish([WIDTH, y + 34.0], "Single hits on a chain of eight balls", description)
}

/// The intersections of the chain with the plane of the ray, as circles from the program.
fn balls(sheet: &mut Sheet, program: &Program) {
    for (k, leaf) in program.leaves().enumerate() {
        let bounds = program.leaf_bounds(leaf.id());
        let centre = 0.5 * (bounds.lo + bounds.hi);
        let at = [place(centre.x), BALLS - UNIT * (centre.z - HEIGHT)];
        sheet.svg.circle(if k % 2 == 0 { "a tint" } else { "b tint" }, at, UNIT * BALL, "");
        let class = if k % 2 == 0 { "line of-a" } else { "line of-b" };
        sheet.svg.circle(class, at, UNIT * BALL, "");
        let away = if centre.z < HEIGHT { 22.0 } else { -14.0 };
        sheet.centre("head", at[0], at[1] + away, &(k + 1).to_string());
    }
}

/// The ray through the balls, and the interval of the query.
fn line(sheet: &mut Sheet, question: &Question) {
    sheet.line("line of-n", [place(-61.0), BALLS], [place(61.0), BALLS]);
    sheet.arrow("n", [place(61.5), BALLS]);
    let ends = [question.t_min, question.answer.t].map(place);
    sheet.line("thick of-r", [ends[0], BALLS], [ends[1], BALLS]);
    for x in ends {
        sheet.svg.circle("r", [x, BALLS], 4.0, "");
    }
}

/// Guide lines at the start of the query and at its answer, through all steps.
fn guides(sheet: &mut Sheet, question: &Question, bottom: f64) {
    for t in [question.t_min, question.answer.t] {
        sheet.line("thread of-r", [place(t), BALLS + 5.0], [place(t), bottom - 4.0]);
    }
}

/// The balls below a node, for example "3", "1 | 2" or "1 | ... | 4".
fn name(program: &Program, entry: &Entry) -> String {
    // in the post-order of a binary tree a subtree of n leaves takes 2n - 1 places
    let first = leaf_number(entry.begin);
    let leaves = (entry.node - entry.begin + 2) / 2;
    assert!(first + leaves - 1 <= program.leaves().len());
    match leaves {
        1 => format!("ball {first}"),
        2 => format!("{first} | {}", first + 1),
        _ => format!("{first} | \u{2026} | {}", first + leaves - 1),
    }
}

/// The number, from 1, of the leaf at a place in the post-order of a perfect binary tree.
fn leaf_number(place: usize) -> usize {
    let mut leaves = 0;
    let mut rest = place;
    // the largest perfect trees that fit before the place
    while rest > 0 {
        let height = (rest + 1).ilog2();
        rest -= (1 << height) - 1;
        leaves += 1 << (height - 1);
    }
    leaves + 1
}

fn depth(entry: &Entry) -> f64 {
    let leaves = (entry.node - entry.begin + 2) / 2;
    f64::from(leaves.ilog2())
}

/// The answer of a leaf as an arrow from the start time of its query; a decision as a mark at its time.
fn step(sheet: &mut Sheet, program: &Program, entry: &Entry, y: f64) {
    let middle = y + 0.5 * ROW;
    let title = name(program, entry);
    let class = if matches!(entry.what, What::Leaf { .. }) { "cell" } else { "head" };
    sheet.left(class, 20.0 + 8.0 * depth(entry), middle + 4.0, &title);
    let text = match &entry.what {
        What::Leaf { leaf, t_min, answer, .. } => {
            let side = if leaf.index() % 2 == 0 { "a" } else { "b" };
            query(sheet, side, *t_min, *answer, middle);
            answer_text(*answer)
        }
        What::Gate { verdict, .. } => decided(sheet, *verdict, program, entry, middle),
    };
    sheet.left("tick", 762.0, middle + 4.0, &text.replace('-', "\u{2212}"));
}

fn query(sheet: &mut Sheet, side: &str, t_min: f64, answer: Next, y: f64) {
    let (from, to) = (place(t_min), place(answer.time()));
    sheet.svg.circle(side, [from, y], 2.2, "");
    sheet.line(&format!("thread of-{side}"), [from, y], [to, y]);
    sheet.arrow(side, [to, y]);
}

fn answer_text(answer: Next) -> String {
    match answer {
        Next::Enter(t) => format!("entered at {t:.2}"),
        Next::Exit(t) => format!("left at {t:.2}"),
        Next::Outside => "outside for good".to_owned(),
        Next::Inside => "inside for good".to_owned(),
    }
}

fn decided(sheet: &mut Sheet, verdict: Verdict, program: &Program, entry: &Entry, y: f64) -> String {
    match verdict {
        Verdict::Fixed(_) => "outside for good (rule 1)".to_owned(),
        Verdict::Changes(step) => {
            sheet.svg.circle("r", [place(step.t), y], 5.0, "");
            let way = if step.before < step.after { "entered" } else { "left" };
            format!("{way} at {:.2} (rule 3)", step.t)
        }
        Verdict::QueryAgain { t, first, .. } => {
            sheet.svg.circle("ring of-r", [place(t), y], 4.5, "");
            let What::Gate { operands, .. } = &entry.what else { return String::new() };
            let query = operands[usize::from(!first)].node;
            let inner = Entry { node: query, begin: begin(entry, operands, query), ..entry.clone() };
            format!("nothing changes: ask {} (rule 4)", name(program, &inner))
        }
    }
}

/// The first post-order place of the subtree of an operand.
fn begin(
    entry: &Entry,
    operands: &[rayweave::trace::single_hit::ExplainedOperand; 2],
    query: usize,
) -> usize {
    if query == operands[0].node { entry.begin } else { operands[0].node + 1 }
}
