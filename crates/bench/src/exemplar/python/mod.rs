//! Overhead of calls from Python compared with the same calls from Rust, for the die: each query
//! for a million rays and for one.

mod calls;

use super::{Bench, Exemplar, die, text};
use crate::answer::{Agreement, Lists, first_lists, full_lists};
use crate::batch::incoherent;
use crate::interleaved::{Candidate, measure_in_turn};
use crate::report::Section;
use rayweave::model::{RayBatch, Rays, RegionId};
use rayweave::{AnyEvaluator, Evaluator, Ray, Reference};
use std::sync::Arc;

/// The number of rays whose results are compared.
const COMPARED: usize = 4096;

/// Rays of the single-ray measurement: many different ones, so that branch predictors cannot learn them.
const TURNS: usize = 1024;

/// A query that is available in both languages.
#[derive(Clone, Copy, Debug, PartialEq)]
enum QueryKind {
    Hits,
    Surfaces,
    Nearest,
    Crossings,
    Contains,
}

impl QueryKind {
    const ALL: [(QueryKind, &'static str); 5] = [
        (QueryKind::Hits, "hits"),
        (QueryKind::Surfaces, "surfaces"),
        (QueryKind::Nearest, "nearest"),
        (QueryKind::Crossings, "crossings"),
        (QueryKind::Contains, "contains"),
    ];

    fn about(self) -> &'static str {
        match self {
            QueryKind::Hits => "Entries and exits, written to an existing array.",
            QueryKind::Surfaces => "Entries and exits with their faces, written to existing arrays.",
            QueryKind::Nearest => "The first crossing with point, normal, face and placement, in new arrays.",
            QueryKind::Crossings => {
                "Every crossing with point, normal, face, leaf and placement, in new arrays."
            }
            QueryKind::Contains => "Whether points of the box are inside, in a new array.",
        }
    }

    /// The result of the default evaluator, or of the reference.
    fn lists<E: Evaluator>(self, evaluator: &E, rays: Rays<'_>) -> Result<Lists, String> {
        match self {
            QueryKind::Hits | QueryKind::Surfaces | QueryKind::Crossings => Ok(full_lists(evaluator, rays)),
            QueryKind::Nearest => first_lists(evaluator, rays).map_err(text),
            QueryKind::Contains => Ok(insides(evaluator, rays)),
        }
    }
}

/// A list with one entry for each point that is inside, and an empty list for other points.
fn insides<E: Evaluator>(evaluator: &E, rays: Rays<'_>) -> Lists {
    let mut regions = vec![RegionId(0); rays.len()];
    evaluator.regions_at(rays.origins, &mut evaluator.scratch(), &mut regions);
    regions.into_iter().map(|region| Vec::from_iter((region.0 != 0).then_some(1.0))).collect()
}

/// One kind of query on `batch` rays at a time.
struct FromPython {
    name: String,
    /// The task of the driver in Python.
    task: String,
    about: String,
    query: QueryKind,
    one_by_one: bool,
}

/// All queries: on many rays at a time, and on one.
pub fn all() -> Vec<Box<dyn Exemplar>> {
    let of = |(query, name): (QueryKind, &str), one_by_one: bool| -> Box<dyn Exemplar> {
        let (size, kind) = if one_by_one { ("one", "one") } else { ("1e6", "many") };
        let call = if one_by_one { "one call per ray or point" } else { "a million per call" };
        Box::new(FromPython {
            name: format!("python/{name}/{size}"),
            task: format!("python.{kind}.{name}"),
            about: format!("{} The die; {call}.", query.about()),
            query,
            one_by_one,
        })
    };
    let many = QueryKind::ALL.map(|query| of(query, false));
    let one = [QueryKind::ALL[0], QueryKind::ALL[2], QueryKind::ALL[3]].map(|query| of(query, true));
    many.into_iter().chain(one).collect()
}

impl Exemplar for FromPython {
    fn name(&self) -> &str {
        &self.name
    }

    fn about(&self) -> &str {
        &self.about
    }

    fn measure(&self, bench: &Bench) -> Result<Vec<Section>, String> {
        let program = Arc::new(die::program().map_err(text)?);
        let evaluator = AnyEvaluator::new(None, program.clone()).map_err(text)?;
        let batch = self.batch(bench);
        let (rays, file) = (batch.rays(), self.name.replace('/', "-"));
        bench.peers.give_rays(&file, rays).map_err(text)?;
        let mut candidates = self.rust(bench, &evaluator, rays)?;
        candidates.extend(self.python(bench, &file, rays.len()));
        let mut section = Section::new(&*self.name, "ray", self.about());
        section.take(measure_in_turn(candidates, &bench.effort), |_| None);
        let few: RayBatch = (0..COMPARED.min(rays.len())).map(|i| rays.get(i)).collect();
        let expected = self.query.lists(&Reference::new(program), few.rays())?;
        for (name, answer) in bench.peers.answers(&self.task, &file, few.rays().len()) {
            section.agree(&name, answer.map(|found| Agreement::of(&expected, &found)));
        }
        Ok(vec![section])
    }
}

impl FromPython {
    /// Rays from a sphere to the die, or points in the cube around it.
    fn batch(&self, bench: &Bench) -> RayBatch {
        let count = if self.one_by_one { TURNS } else { bench.effort.size(1_000_000) };
        let batch = incoherent(count, 3);
        if self.query != QueryKind::Contains {
            return batch;
        }
        let ends = (0..count).map(|i| batch.rays().get(i));
        ends.map(|ray| Ray::new(ray.origin + ray.direction, ray.direction)).collect()
    }

    fn rust<'a>(
        &self,
        bench: &Bench,
        evaluator: &'a AnyEvaluator,
        rays: Rays<'a>,
    ) -> Result<Vec<Candidate<'a>>, String> {
        if self.one_by_one {
            return Ok(vec![calls::one_by_one(self.query, evaluator, rays)?]);
        }
        let mut candidates = vec![calls::many(self.query, evaluator, rays, 1)?];
        if bench.threads > 1 {
            candidates.push(calls::many(self.query, evaluator, rays, bench.threads)?);
        }
        Ok(candidates)
    }

    fn python(&self, bench: &Bench, file: &str, rays: usize) -> Vec<Candidate<'static>> {
        let mut candidates = bench.peers.candidates(&self.task, file, rays);
        if bench.threads > 1 && !self.one_by_one {
            let all = bench.peers.candidates(&format!("{}/all", self.task), file, rays);
            candidates.extend(all.into_iter().map(|candidate| candidate.threads(bench.threads)));
        }
        candidates.into_iter().map(Candidate::whole).collect()
    }
}
