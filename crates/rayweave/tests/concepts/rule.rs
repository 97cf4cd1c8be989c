//! Table of the single-hit decision rule: every pair of operand answers in each order of their times.

use crate::kit::Sheet;
use rayweave::trace::single_hit::seed_view::{Operator, State, Tables};
use rayweave::trace::single_hit::{GateOp, Next, Verdict, decide};

const WIDTH: f64 = 960.0;
const LEFT: f64 = 20.0;
const HEAD: f64 = 74.0;
const CELL: f64 = 94.0;
const LINE: f64 = 19.0;

/// An operation of two solids: its name, the boolean function, and whether the second operand is
/// complemented.
struct Operation {
    name: &'static str,
    op: GateOp,
    complements: bool,
    /// The operator of the original tables, if they have it.
    known: Option<Operator>,
}

fn operations() -> [Operation; 4] {
    let at_least = |least| GateOp::AtLeast { least, most: [1, 1] };
    let row = |name, op, complements, known| Operation { name, op, complements, known };
    [
        row("A | B", at_least(1), false, Some(Operator::Union)),
        row("A & B", at_least(2), false, Some(Operator::Intersection)),
        row("A \u{2212} B", at_least(2), true, Some(Operator::Difference)),
        row("A ^ B", GateOp::Odd, false, None),
    ]
}

/// The four possible answers, at time `t` where they have one.
fn answers(t: f64) -> [Next; 4] {
    [Next::Enter(t), Next::Exit(t), Next::Outside, Next::Inside]
}

const NAMES: [&str; 4] = ["Enter", "Exit", "Outside", "Exit(\u{221e})"];

/// The orders of two times.
const ORDERS: [(&str, f64, f64); 3] = [("A first", 1.0, 2.0), ("tie", 1.0, 1.0), ("B first", 2.0, 1.0)];

impl Operation {
    fn decide(&self, a: Next, b: Next) -> Verdict {
        let taken = if self.complements { b.complement() } else { b };
        decide(self.op, a.into(), taken.into())
    }

    /// True if one of the original nine-entry tables disagrees.
    fn is_disputed(&self, a: Next, b: Next) -> bool {
        let first = a.time() < b.time();
        let (a, b) = (State::of(a), State::of(b));
        let says = |tables: Tables| self.known.map(|operator| tables.look_up(operator, first, a, b));
        says(Tables::original()) != says(Tables::from_rule())
    }
}

/// The label of a verdict and the class of its background.
fn words(verdict: Verdict) -> (&'static str, &'static str) {
    match verdict {
        Verdict::Fixed(0) => ("outside for good", ""),
        Verdict::Fixed(_) => ("inside for good", "n tint"),
        Verdict::Changes(step) if step.before < step.after => ("enter", "b tint"),
        Verdict::Changes(_) => ("exit", "r tint"),
        Verdict::QueryAgain { first: true, second: true, .. } => ("ask both again", "a tint"),
        Verdict::QueryAgain { first: true, .. } => ("ask A again", "a tint"),
        Verdict::QueryAgain { .. } => ("ask B again", "a tint"),
    }
}

pub fn picture() -> String {
    let mut sheet = Sheet::default();
    sheet.left(
        "title",
        LEFT,
        28.0,
        "The next crossing of a combination, from the next crossings of its operands",
    );
    let block = 22.0 + 8.0 * LINE + 28.0;
    for (k, operation) in operations().iter().enumerate() {
        let place = [LEFT + 474.0 * (k % 2) as f64, 52.0 + block * (k / 2) as f64];
        table(&mut sheet, operation, place);
    }
    let y = 52.0 + 2.0 * block;
    sheet.left("tick", LEFT, y, "Rows: A's answer. Columns: B's answer. Where both have a time there is one line for each order of the times.");
    sheet.svg.rectangle("wrong", [LEFT + 1.0, y + 10.0, 22.0, 13.0], r#" rx="3""#);
    let note = "Here the published nine-entry tables return the farther exit instead.";
    sheet.left("tick", LEFT + 32.0, y + 21.0, note);
    let description = "Four tables, for union, intersection, difference and symmetric difference: from the answers Enter, \
                       Exit, Outside and Exit at infinity of A and of B, the answer of the rule or the operand that it queries again.";
    sheet.finish([WIDTH, y + 38.0], "The rule of single hits, tabulated", description)
}

fn table(sheet: &mut Sheet, operation: &Operation, [x, y]: [f64; 2]) {
    sheet.left("head", x, y + 14.0, operation.name);
    for (column, name) in NAMES.iter().enumerate() {
        sheet.centre("head", x + HEAD + CELL * (column as f64 + 0.5), y + 14.0, name);
    }
    let mut top = y + 22.0;
    for row in 0..4 {
        let height = if row < 2 { 3.0 * LINE } else { LINE };
        sheet.line("base", [x, top], [x + HEAD + 4.0 * CELL, top]);
        sheet.right("head", x + HEAD - 12.0, top + 0.5 * height + 4.0, NAMES[row]);
        for column in 0..4 {
            entry(sheet, operation, [row, column], [x + HEAD + CELL * column as f64, top, CELL, height]);
        }
        top += height;
    }
}

/// A cell: one line, or one per order of the times.
fn entry(
    sheet: &mut Sheet,
    operation: &Operation,
    [row, column]: [usize; 2],
    [x, y, width, height]: [f64; 4],
) {
    let both_have_times = row < 2 && column < 2;
    if !both_have_times {
        let (text, ground) = words(operation.decide(answers(1.0)[row], answers(1.0)[column]));
        sheet.cell(ground, [x, y, width, height], "small", text);
        return;
    }
    for (k, (name, ta, tb)) in ORDERS.into_iter().enumerate() {
        let (a, b) = (answers(ta)[row], answers(tb)[column]);
        let (text, ground) = words(operation.decide(a, b));
        let top = y + LINE * k as f64;
        sheet.svg.rectangle(ground, [x + 1.0, top + 1.0, width - 2.0, LINE - 2.0], r#" rx="3""#);
        if ta != tb && operation.is_disputed(a, b) {
            sheet.svg.rectangle("wrong", [x + 1.5, top + 1.5, width - 3.0, LINE - 3.0], r#" rx="3""#);
        }
        let line = format!("{name}: {}", text.trim_end_matches(" again"));
        sheet.centre("small", x + 0.5 * width, top + 13.2, &line);
    }
}
