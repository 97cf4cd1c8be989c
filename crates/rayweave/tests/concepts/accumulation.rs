//! Picture of the accumulation of two hit arrays: concatenate, sort, +-1, cumulative sum, mask.

use crate::kit::{Sheet, number, operands};
use rayweave::draw::svg::Pixels;
use rayweave::rootray::hit_array::{CsgOptions, HitArray, Operation, array_csg_1d, count_array, to_column};

const WIDTH: f64 = 960.0;
const LEFT: f64 = 150.0;
const COLUMN: f64 = 56.0;
const ROW: f64 = 26.0;

/// The concatenated entries and their sorted order.
struct Merged {
    first: usize,
    times: Vec<f64>,
    order: Vec<usize>,
}

impl Merged {
    fn new([a, b]: [&[f64]; 2]) -> Merged {
        let times = [a, b].concat();
        let mut order: Vec<usize> = (0..times.len()).collect();
        // the sort is stable: entries of the first array precede equal times of the second
        order.sort_by(|&i, &j| times[i].total_cmp(&times[j]));
        Merged { first: a.len(), times, order }
    }

    fn colour(&self, k: usize) -> &'static str {
        if k < self.first { "a" } else { "b" }
    }

    /// +1 where a solid is entered, -1 where it is left; the opposite for the second array if it is inverted.
    fn step(&self, k: usize, inverts: bool) -> i32 {
        let leaves = (k % 2 == 1) != (inverts && k >= self.first);
        if leaves { -1 } else { 1 }
    }
}

/// A row of the picture and its height.
struct Rows {
    sheet: Sheet,
    y: f64,
}

impl Rows {
    fn row(&mut self, name: &str, cells: impl Iterator<Item = (String, String, &'static str)>) {
        self.sheet.right("name", LEFT - 14.0, self.y + 0.5 * ROW + 4.5, name);
        for (k, (ground, text, class)) in cells.enumerate() {
            let place = [LEFT + COLUMN * k as f64, self.y, COLUMN, ROW];
            self.sheet.cell(&ground, place, class, &text);
        }
        self.y += ROW + 2.0;
    }

    fn note(&mut self, text: &str) {
        self.y += 20.0;
        self.sheet.left("head", 20.0, self.y, text);
        self.y += 8.0;
    }

    /// Lines from the concatenated entries to their sorted places.
    fn threads(&mut self, merged: &Merged) {
        let middle = |k: usize| LEFT + COLUMN * (k as f64 + 0.5);
        let height = 52.0;
        for (to, &from) in merged.order.iter().enumerate() {
            let [x1, x2, y1, y2] = [middle(from), middle(to), self.y, self.y + height].map(Pixels);
            let [above, below] = [self.y + 0.5 * height, self.y + 0.5 * height].map(Pixels);
            let class = format!("thread of-{}", merged.colour(from));
            self.sheet.svg.path(&class, format_args!("M{x1} {y1}C{x1} {above} {x2} {below} {x2} {y2}"), "");
        }
        self.y += height + 2.0;
    }

    fn steps(&mut self, name: &str, order: &[usize], merged: &Merged, inverts: bool) {
        let text = |step| if step > 0 { "+1".to_owned() } else { "\u{2212}1".to_owned() };
        self.row(name, order.iter().map(|&k| (String::new(), text(merged.step(k, inverts)), "cell")));
    }
}

pub fn picture() -> String {
    let columns = operands().map(|ray| to_column(&ray));
    let arrays = [columns[0].as_slice(), columns[1].as_slice()];
    let merged = Merged::new(arrays);
    let mut rows = Rows { sheet: Sheet::default(), y: 8.0 };
    rows.note("1  Put the hits of A and B end to end; note +1 for each entry and \u{2212}1 for each exit");
    let entry = |&k: &usize| (format!("{} tint", merged.colour(k)), number(merged.times[k]), "cell");
    let concatenated: Vec<usize> = (0..merged.times.len()).collect();
    rows.steps("step", &concatenated, &merged, false);
    rows.row("hits", concatenated.iter().map(entry));
    rows.threads(&merged);
    rows.row("sorted hits", merged.order.iter().map(entry));
    rows.steps("sorted steps", &merged.order, &merged, false);
    rows.note("2  Sort both by time (stable: A first where times are equal), and add the steps up");
    counts(&mut rows, arrays, &merged, Operation::Intersect);
    rows.note("3  Keep the hits where the answer changes");
    kept(&mut rows, "A | B", arrays, Operation::Union);
    kept(&mut rows, "A & B", arrays, Operation::Intersect);
    rows.note(
        "4  For A \u{2212} B invert the steps of B and begin at 1: the ray starts inside of the complement",
    );
    rows.steps("sorted steps", &merged.order, &merged, true);
    counts(&mut rows, arrays, &merged, Operation::Difference);
    kept(&mut rows, "A \u{2212} B", arrays, Operation::Difference);
    let description = "Fourteen hits of two solids, coloured by owner, are sorted; the running sum of their steps counts \
                       the solids around the ray; the results keep the hits at which the count reaches or leaves a threshold.";
    let height = rows.y + 14.0;
    rows.sheet.finish([WIDTH, height], "From two hit arrays to the results", description)
}

/// The cumulative sum, which is the count of the engine.
fn counts(rows: &mut Rows, [a, b]: [&[f64]; 2], merged: &Merged, operation: Operation) {
    let inverts = operation == Operation::Difference;
    let counted = count_array(HitArray::single(a), HitArray::single(b), operation).unwrap();
    let mut sum = i32::from(inverts);
    for (&k, &count) in merged.order.iter().zip(&counted.counts) {
        sum += merged.step(k, inverts);
        assert_eq!(sum, i32::from(count));
    }
    let ground = |count: u8| if count == 2 { "r tint" } else { ["", "n tint"][usize::from(count)] };
    let cells = counted.counts.iter().map(|&count| (ground(count).to_owned(), count.to_string(), "cell"));
    rows.row("count", cells);
}

/// The hits kept by an operation, in their places.
fn kept(rows: &mut Rows, name: &str, [a, b]: [&[f64]; 2], operation: Operation) {
    let options = CsgOptions { sort_output: false, ..CsgOptions::default() };
    let masked = array_csg_1d(a, b, operation, options).unwrap();
    let cells = masked.into_iter().map(|t| {
        if t.is_finite() {
            ("r on".to_owned(), number(t), "head")
        } else {
            (String::new(), "\u{221e}".to_owned(), "faint")
        }
    });
    rows.row(name, cells);
}
