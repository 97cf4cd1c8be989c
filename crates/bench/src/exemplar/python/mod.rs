//! Overhead of calls from Python compared with the same calls from Rust, for the die: each query
//! for a million rays and for one.

mod calls;

use super::{Bench, Exemplar, die, text};
use crate::answer::{Agreement, Lists, first_lists, full_lists};
use crate::batch::incoherent;
use crate::contest::{Contender, contest};
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
enum Asked {
    Hits,
    Surfaces,
    Nearest,
    Crossings,
    Contains,
}

impl Asked {
    const ALL: [(Asked, &'static str); 5] = [
        (Asked::Hits, "hits"),
        (Asked::Surfaces, "surfaces"),
        (Asked::Nearest, "nearest"),
        (Asked::Crossings, "crossings"),
        (Asked::Contains, "contains"),
    ];

    fn about(self) -> &'static str {
        match self {
            Asked::Hits => "Entries and exits, into an array that is given.",
            Asked::Surfaces => "Entries and exits with their faces, into arrays that are given.",
            Asked::Nearest => "The first crossing with point, normal, face and placement, in new arrays.",
            Asked::Crossings => "Every crossing with point, normal, face, leaf and placement, in new arrays.",
            Asked::Contains => "Whether points of the box are inside, in a new array.",
        }
    }

    /// The result of the default evaluator, or of the reference.
    fn lists<E: Evaluator>(self, evaluator: &E, rays: Rays<'_>) -> Result<Lists, String> {
        match self {
            Asked::Hits | Asked::Surfaces | Asked::Crossings => Ok(full_lists(evaluator, rays)),
            Asked::Nearest => first_lists(evaluator, rays).map_err(text),
            Asked::Contains => Ok(insides(evaluator, rays)),
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
    asked: Asked,
    one_by_one: bool,
}

/// All queries: on many rays at a time, and on one.
pub fn all() -> Vec<Box<dyn Exemplar>> {
    let of = |(asked, name): (Asked, &str), one_by_one: bool| -> Box<dyn Exemplar> {
        let (size, kind) = if one_by_one { ("one", "one") } else { ("1e6", "many") };
        let call = if one_by_one { "a call for each ray or point" } else { "a million in a call" };
        Box::new(FromPython {
            name: format!("python/{name}/{size}"),
            task: format!("python.{kind}.{name}"),
            about: format!("{} The die; {call}.", asked.about()),
            asked,
            one_by_one,
        })
    };
    let many = Asked::ALL.map(|asked| of(asked, false));
    let one = [Asked::ALL[0], Asked::ALL[2], Asked::ALL[3]].map(|asked| of(asked, true));
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
        let mut contenders = self.rust(bench, &evaluator, rays)?;
        contenders.extend(self.python(bench, &file, rays.len()));
        let mut section = Section::new(&*self.name, "ray", self.about());
        section.take(contest(contenders, &bench.effort), |_| None);
        let few: RayBatch = (0..COMPARED.min(rays.len())).map(|i| rays.get(i)).collect();
        let expected = self.asked.lists(&Reference::new(program), few.rays())?;
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
        if self.asked != Asked::Contains {
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
    ) -> Result<Vec<Contender<'a>>, String> {
        if self.one_by_one {
            return Ok(vec![calls::one_by_one(self.asked, evaluator, rays)?]);
        }
        let mut contenders = vec![calls::many(self.asked, evaluator, rays, 1)?];
        if bench.threads > 1 {
            contenders.push(calls::many(self.asked, evaluator, rays, bench.threads)?);
        }
        Ok(contenders)
    }

    fn python(&self, bench: &Bench, file: &str, rays: usize) -> Vec<Contender<'static>> {
        let mut contenders = bench.peers.contenders(&self.task, file, rays);
        if bench.threads > 1 && !self.one_by_one {
            let all = bench.peers.contenders(&format!("{}/all", self.task), file, rays);
            contenders.extend(all.into_iter().map(|contender| contender.threads(bench.threads)));
        }
        contenders.into_iter().map(Contender::whole).collect()
    }
}
