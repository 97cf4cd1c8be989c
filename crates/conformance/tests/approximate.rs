//! Tests of the checks for approximate evaluators: they accept an evaluator that rounds to single precision with
//! correct bounds, and detect every kind of violation.

use rayweave_conformance::Effort;
use rayweave_conformance::approximate::{Verdict, against, on_model};
use rayweave_model::{
    ApproximateColumns, ApproximateEvaluator, Crossing, CrossingColumns, Evaluator, LeafId, Program, Query,
    Rays,
};
use rayweave_trace::{Reference, Weave};
use std::sync::Arc;

/// A deliberate fault of the toy evaluator.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    None,
    /// Bounds are 0.
    NoBound,
    /// Bounds are NaN.
    BoundIsNan,
    /// Bounds are infinite.
    BoundIsInfinite,
    /// No ray is uncertain, and crossings that round to one time are joined.
    NeverUncertain,
    /// The last crossing of each ray is missing.
    LastDropped,
    /// The face is a different one of the same leaf.
    OtherFace,
    /// The first two crossings are swapped.
    Reversed,
    /// The region at the start is wrong.
    OtherStart,
    /// The flag of the last ray is missing.
    ShortColumn,
    /// Every ray is uncertain.
    AlwaysUncertain,
}

/// The exact answer rounded to single precision. A ray is uncertain if two of its times, or a time and an end
/// of the window, agree within their bounds.
struct Toy {
    exact: Reference,
    fault: Fault,
}

fn toy(fault: Fault) -> impl Fn(Arc<Program>) -> Toy {
    move |program| Toy { exact: Reference::new(program), fault }
}

/// Upper bound of the rounding error of a time: |t| times the epsilon of f32, at least the smallest f32 above
/// 0.
fn bound(t: f64) -> f64 {
    (t.abs() * f64::from(f32::EPSILON)).max(f64::from(f32::from_bits(1)))
}

impl ApproximateEvaluator for Toy {
    type Scratch = <Reference as Evaluator>::Scratch;

    fn name(&self) -> &'static str {
        "toy"
    }

    fn program(&self) -> &Program {
        self.exact.program()
    }

    fn scratch(&self) -> Self::Scratch {
        self.exact.scratch()
    }

    fn columns(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut Self::Scratch,
        columns: &mut ApproximateColumns,
    ) {
        let mut found = CrossingColumns::default();
        self.exact.columns(rays, query, scratch, &mut found);
        for ray in 0..rays.len() {
            let mut rows: Vec<usize> = found.rows_of(ray).collect();
            let times: Vec<f64> = rows.iter().map(|&row| f64::from(found.t[row] as f32)).collect();
            let ends = [query.window.t_min(), query.window.t_max()];
            let is_near = |a: f64, b: f64| (a - b).abs() <= bound(a) + bound(b);
            let near_an_end =
                times.iter().any(|&t| ends.iter().any(|&end| end.is_finite() && is_near(t, end)));
            let mut uncertain = near_an_end
                || times.iter().any(|t| !t.is_finite())
                || times.windows(2).any(|pair| is_near(pair[0], pair[1]));
            match self.fault {
                Fault::NeverUncertain => {
                    uncertain = false;
                    rows.dedup_by_key(|row| (found.t[*row] as f32).to_bits());
                }
                Fault::AlwaysUncertain => uncertain = true,
                Fault::LastDropped => _ = rows.pop(),
                Fault::Reversed if rows.len() > 1 => rows.swap(0, 1),
                _ => {}
            }
            self.push(&found, ray, &rows, columns);
            columns.uncertain.push(uncertain);
        }
        if self.fault == Fault::ShortColumn {
            columns.uncertain.pop();
        }
    }
}

impl Toy {
    fn push(&self, found: &CrossingColumns, ray: usize, rows: &[usize], columns: &mut ApproximateColumns) {
        let ApproximateColumns { crossings: to, bound: bounds, .. } = columns;
        for &row in rows {
            let t = f64::from(found.t[row] as f32);
            let leaf = self.program().leaf(LeafId(found.leaf[row]));
            let first = self.program().face_number(leaf.id(), 0);
            let face = match self.fault {
                Fault::OtherFace => first + (found.face[row] - first + 1) % leaf.facets().len() as u32,
                _ => found.face[row],
            };
            if let Some((_, crossing)) = found.between.iter().find(|(other, _)| *other == row) {
                to.between.push((to.t.len(), Crossing { t, ..*crossing }));
            }
            to.t.push(t);
            to.face.push(face);
            to.leaf.push(found.leaf[row]);
            to.placement.push(found.placement[row]);
            to.enters.push(found.enters[row]);
            to.before.push(found.before[row]);
            to.after.push(found.after[row]);
            bounds.push(match self.fault {
                Fault::NoBound => 0.0,
                Fault::BoundIsNan => f64::NAN,
                Fault::BoundIsInfinite => f64::INFINITY,
                _ => bound(t),
            });
        }
        let start = found.start[ray];
        to.start.push(if self.fault == Fault::OtherStart { start + 1 } else { start });
        to.offsets.push(to.t.len());
    }
}

fn verdict(fault: Fault) -> Verdict {
    let mut verdict = Verdict::default();
    (0..80).for_each(|seed| verdict.add(on_model(toy(fault), Reference::new, seed, 50)));
    verdict
}

#[test]
fn rounded_answers_with_bounds_are_accepted() {
    let verdict = against(toy(Fault::None), Weave::new, Effort::Short);
    verdict.check(0.2);
    assert!(verdict.crossings > verdict.rays / 2, "{verdict:?}");
    assert!(verdict.uncertain > 0 && verdict.greatest_error > 0.0, "{verdict:?}");
}

#[test]
fn every_false_claim_is_caught() {
    for (fault, what) in [
        (Fault::NoBound, "a time farther from the exact one than its bound"),
        (Fault::BoundIsNan, "a bound that is infinite, NaN or below 0"),
        (Fault::BoundIsInfinite, "a bound that is infinite, NaN or below 0"),
        (Fault::NeverUncertain, "a different number of crossings"),
        (Fault::LastDropped, "a different number of crossings"),
        (Fault::OtherFace, "a different face or region"),
        (Fault::Reversed, "a different face or region"),
        (Fault::OtherStart, "a different region at the start"),
        (Fault::ShortColumn, "columns whose length differs from the batch"),
    ] {
        let verdict = verdict(fault);
        assert!(verdict.wrong > 0, "the violation was not detected: {what}");
        assert!(verdict.failures.contains_key(what), "{what}: {verdict:#?}");
        assert!(std::panic::catch_unwind(|| verdict.check(1.0)).is_err());
    }
}

#[test]
fn saying_nothing_breaks_no_claim_and_passes_no_limit() {
    let verdict = verdict(Fault::AlwaysUncertain);
    assert_eq!((verdict.wrong, verdict.uncertain), (0, verdict.rays));
    assert!(std::panic::catch_unwind(|| verdict.check(0.5)).is_err());
}
