//! Checks of `<skinsurface>` and `<bordersurface>`, once all files are read.

use super::context::Context;
use super::graph::Graph;
use super::problem::Problem;
use crate::LossKind;
use std::collections::BTreeSet;

/// Reports attachments of undefined surfaces, and attachments to undefined volumes or placements. Geant4 stops at each of them.
pub(super) fn check(context: &mut Context, graph: &Graph) {
    let surfaces: BTreeSet<&str> =
        graph.surfaces.optical.iter().map(|surface| surface.name.as_str()).collect();
    let volumes: BTreeSet<&str> = graph.volumes.iter().map(|volume| volume.name.as_str()).collect();
    let placements = graph.volumes.iter().flat_map(|volume| &volume.daughters);
    let placements: BTreeSet<&str> = placements.map(|daughter| daughter.name.as_str()).collect();
    for link in &graph.surfaces.links {
        if !surfaces.contains(link.surface.as_str()) {
            let message =
                format!("unknown optical surface `{}`: no `opticalsurface` has this name.", link.surface);
            let problem = Problem::new(message, link.place);
            context.lose(
                LossKind::Undefined,
                link.tag(),
                problem.did_you_mean(&link.surface, surfaces.iter().copied()),
            );
        }
        let known = if link.is_skin { &volumes } else { &placements };
        for (name, place) in link.of.iter().filter(|(name, _)| !known.contains(name.as_str())) {
            // Geant4's name of a placement without one; the detector reports what it does not support
            if !link.is_skin && name.strip_suffix("_PV").is_some_and(|volume| volumes.contains(volume)) {
                continue;
            }
            let message = match (link.is_skin, volumes.contains(name.as_str())) {
                (true, _) => format!("unknown volume `{name}`: no `volume` has this name."),
                (false, false) => format!("unknown placement `{name}`: no `physvol` has this name."),
                (false, true) => {
                    format!("unknown placement `{name}`: it is the name of a volume, not of a `physvol`.")
                }
            };
            let problem = Problem::new(message, *place).did_you_mean(name, known.iter().copied());
            context.lose(LossKind::Undefined, link.tag(), problem);
        }
    }
}
