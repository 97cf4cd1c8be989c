//! Light through a lens onto a screen: three segments per ray.

use super::{Bench, Exemplar, text};
use crate::answer::{Agreement, Lists};
use crate::batch::random;
use crate::interleaved::{Candidate, Role, measure_in_turn};
use crate::report::Section;
use rand::RngExt;
use rayweave::math::Affine;
use rayweave::model::RayBatch;
use rayweave::optics::component::{Aperture, Sheet, biconvex};
use rayweave::optics::{
    Action, Assembly, Beam, Element, Keep, Light, Medium, System, Trace, TraceSettings, Tracer,
};
use rayweave::shapes::{box_from_corners, half_space};
use rayweave::{Packets, Ray, Vec3};
use std::num::NonZeroUsize;

/// The number of rays at full effort.
const RAYS: usize = 100_000;

/// The number of rays whose end points are compared.
const COMPARED: usize = 4096;

/// The exemplar, with the end points only or with every segment.
struct Optics {
    name: &'static str,
    about: &'static str,
    keep: Keep,
}

/// With the whole table, and with the end points only.
pub fn all() -> Vec<Box<dyn Exemplar>> {
    vec![
        Box::new(Optics {
            name: "optics/ends",
            about: "The end points of parallel light that passes through a biconvex lens onto a screen, three segments per ray. PyRayT always creates its whole table.",
            keep: Keep::Ends,
        }),
        Box::new(Optics {
            name: "optics/table",
            about: "The same with every segment as a row: its start and end, direction, power, index, optical path and event.",
            keep: Keep::All,
        }),
    ]
}

/// A lens of radii 50, thickness 4 and aperture 20 about the origin, index 1.5, and a screen of 40 by 40 at z = 50.
fn system() -> Result<System, String> {
    let lens = biconvex(50.0, 50.0, 4.0, Aperture::circle(20.0)).map_err(text)?;
    let glass = Medium::constant("glass", 1.5, 0.0).map_err(text)?;
    let trim = box_from_corners([-20.0, -20.0, 49.0], [20.0, 20.0, 51.0]).map_err(text)?;
    let surface = half_space([0.0, 0.0, 1.0], 50.0).map_err(text)?;
    let screen = Sheet { surface, trim, frame: Affine::translate(Vec3::Z * 50.0) };
    let parts = Assembly::new().add(Element::transparent("lens", lens, &glass)).add(Element::sheet(
        "screen",
        screen,
        Action::Absorb,
    ));
    parts.compile().map_err(text)
}

/// Rays along z from z = -20, at random points of a square within the aperture.
fn rays(count: usize) -> RayBatch {
    let mut random = random(11);
    let mut across = || random.random_range(-7.0..7.0);
    (0..count).map(|_| Ray::new(Vec3::new(across(), across(), -20.0), Vec3::Z)).collect()
}

impl Exemplar for Optics {
    fn name(&self) -> &str {
        self.name
    }

    fn about(&self) -> &str {
        self.about
    }

    fn measure(&self, bench: &Bench) -> Result<Vec<Section>, String> {
        let (system, batch) = (system()?, rays(bench.effort.size(RAYS)));
        let (rays, file) = (batch.rays(), self.name.replace('/', "-"));
        let light = |i: usize| Light::new(rays.get(i).origin, rays.get(i).direction, 633.0);
        let beam: Beam = (0..rays.len()).map(light).collect();
        let tracer = Tracer::new(&system, Packets::new);
        let settings = |threads| TraceSettings {
            keep: self.keep,
            threads: NonZeroUsize::new(threads),
            ..TraceSettings::default()
        };
        bench.peers.give_rays(&file, rays).map_err(text)?;
        let ours = |threads: usize| {
            let (settings, tracer, beam) = (settings(threads), &tracer, &beam);
            let run = move || _ = std::hint::black_box(tracer.trace(beam, &settings));
            Candidate::here("Rayweave", Role::Ours, rays.len(), run).threads(threads)
        };
        let again = |threads: usize| {
            let (settings, tracer, beam) = (settings(threads), &tracer, &beam);
            let mut trace = Trace::default();
            let run = move || _ = std::hint::black_box(tracer.trace_into(beam, &settings, &mut trace));
            let name = "Rayweave, into the same memory";
            Candidate::here(name, Role::Ours, rays.len(), run).threads(threads)
        };
        let mut candidates = bench.on_threads(ours);
        candidates.extend(bench.on_threads(again));
        candidates.extend(bench.peers.candidates("optics.trace", &file, rays.len()));
        let mut section = Section::new(self.name, "ray", self.about);
        section.take(measure_in_turn(candidates, &bench.effort), |_| None);
        let count = COMPARED.min(rays.len());
        let few: Beam = (0..count).map(light).collect();
        let ends = TraceSettings { keep: Keep::Ends, ..settings(1) };
        let found = tracer.trace(&few, &ends).map_err(text)?.segments;
        let expected: Lists = (0..count).map(|i| found.get(i).end.to_array().to_vec()).collect();
        for (name, answer) in bench.peers.answers("optics.trace", &file, count) {
            section.agree(&name, answer.map(|found| Agreement::of(&expected, &found)));
        }
        Ok(vec![section])
    }
}
