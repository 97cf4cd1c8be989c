//! Truth table of the boolean operations, with the counts behind it.

use crate::kit::Sheet;
use rayweave::rootray::{RootRay, surface_count};

const LEFT: f64 = 24.0;
const TOP: f64 = 64.0;
const ROW: f64 = 34.0;

/// A column: its two lines of heading, its width, and its values.
struct Column {
    head: [&'static str; 2],
    width: f64,
    value: fn(&RootRay, &RootRay) -> usize,
}

const fn column(head: [&'static str; 2], width: f64, value: fn(&RootRay, &RootRay) -> usize) -> Column {
    Column { head, width, value }
}

/// 1 inside, 0 outside.
fn side(ray: &RootRay) -> usize {
    usize::from(ray.start().is_inside())
}

fn count(rays: [&RootRay; 2]) -> usize {
    surface_count(rays).start
}

const COLUMNS: [Column; 9] = [
    column(["A", ""], 64.0, |a, _| side(a)),
    column(["B", ""], 64.0, |_, b| side(b)),
    column(["count", "of A, B"], 110.0, |a, b| count([a, b])),
    column(["A | B", "count \u{2265} 1"], 110.0, |a, b| side(&(a | b))),
    column(["A & B", "count = 2"], 110.0, |a, b| side(&(a & b))),
    column(["A ^ B", "count odd"], 110.0, |a, b| side(&(a ^ b))),
    column(["~B", ""], 80.0, |_, b| side(&!b)),
    column(["count", "of A, ~B"], 110.0, |a, b| count([a, &!b])),
    column(["A \u{2212} B", "count = 2"], 110.0, |a, b| side(&(a - b))),
];

pub fn picture() -> String {
    let mut sheet = Sheet::default();
    let title = "The operations, and the counts that decide them (1 inside, 0 outside)";
    sheet.left("title", LEFT, 30.0, title);
    let [empty, universe] = [RootRay::empty(), RootRay::universe()];
    let rows = [(&empty, &empty), (&universe, &empty), (&empty, &universe), (&universe, &universe)];
    let mut x = LEFT;
    for (k, column) in COLUMNS.iter().enumerate() {
        let is_result = k > 2 && !matches!(k, 6 | 7);
        let middle = x + 0.5 * column.width;
        sheet.centre("head", middle, TOP, column.head[0]);
        sheet.centre("tick", middle, TOP + 15.0, column.head[1]);
        for (row, (a, b)) in rows.iter().enumerate() {
            let value = (column.value)(a, b);
            let place = [x, TOP + 24.0 + ROW * row as f64, column.width, ROW];
            sheet.cell(ground(column.head, is_result, value), place, "cell", &value.to_string());
        }
        x += column.width;
    }
    let bottom = TOP + 24.0 + 4.0 * ROW;
    for row in 0..=4 {
        let y = TOP + 24.0 + ROW * f64::from(row);
        sheet.line("base", [LEFT, y], [x, y]);
    }
    let description = "Four rows for the four ways to be inside or outside of A and B, with the count of solids around \
                       the point, union, intersection, symmetric difference, the complement of B and the difference.";
    sheet.finish([x + LEFT, bottom + 20.0], "Truth table of the boolean operations", description)
}

/// The background of a value: coloured where it is inside.
fn ground(head: [&str; 2], is_result: bool, value: usize) -> &'static str {
    match head[0] {
        _ if value == 0 => "",
        "A" => "a tint",
        "B" | "~B" => "b tint",
        _ if is_result => "r tint",
        _ => "n tint",
    }
}
