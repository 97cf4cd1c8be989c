//! Crossings in columns: the same rows for any batch size, and the same crossings as the lists.

use rayweave_conformance::rays::{batch, rays};
use rayweave_conformance::{Model, Random, Style};
use rayweave_model::{CrossingColumns, Evaluator, Query, Rays};
use rayweave_trace::{Packets, Reference, Weave};

#[test]
fn columns_do_not_depend_on_the_size_of_batches() {
    for seed in 0..60 {
        let mut rng = Random::new(seed);
        let style = [Style::Generic, Style::Grid, Style::Planes][seed as usize % 3];
        let model = Model::random(&mut rng, style);
        let program = model.compile().unwrap();
        let rays = batch(&rays(&mut rng, style, &model.frame, 300));
        check_columns(&Reference::new(program.clone()), rays.rays(), seed);
        check_columns(&Weave::new(program.clone()), rays.rays(), seed);
        check_columns(&Packets::new(program), rays.rays(), seed);
    }
}

fn check_columns<E: Evaluator>(evaluator: &E, rays: Rays<'_>, seed: u64) {
    let (query, mut scratch) = (Query::default(), evaluator.scratch());
    let list = evaluator.collect(rays, &query).unwrap();
    let mut whole = CrossingColumns::default();
    evaluator.columns(rays, &query, &mut scratch, &mut whole);
    let bits = |columns: &CrossingColumns| columns.t.iter().map(|t| t.to_bits()).collect::<Vec<u64>>();
    for size in [1, 7, 64, 4096] {
        let mut columns = CrossingColumns::default();
        for start in (0..rays.len()).step_by(size) {
            let range = start..rays.len().min(start + size);
            evaluator.columns(rays.slice(range.clone()), &query.slice(range), &mut scratch, &mut columns);
        }
        assert_eq!(columns, whole, "model {seed}, {}, batches of {size}", evaluator.name());
        assert_eq!(bits(&columns), bits(&whole));
    }
    for ray in 0..rays.len() {
        let rows = whole.rows_of(ray).map(|row| whole.crossing(evaluator.program(), row));
        assert!(rows.eq(list.of(ray).iter().copied()), "model {seed}, ray {ray}");
        assert_eq!(whole.start[ray], list.starts[ray].0);
    }
    assert!(whole.enters.iter().zip(&whole.after).all(|(&enters, &after)| enters == (after != 0)));
}
