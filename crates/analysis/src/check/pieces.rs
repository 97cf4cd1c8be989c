//! Checks with rays through the whole model: thin walls, gaps, contacts, hidden regions.

use super::connected;
use super::edges::{Grid, Hits};
use super::facing::{Between, Facing, Search, is_crease, touches};
use super::narrow::{Narrow, RAYS_PER_SIDE, SEARCHED};
use super::pairs::Intersecting;
use super::places::{Place, distinct};
use super::probe::{Budget, FEW, IN_EDGES, Probe, leaves_of, rays_of};
use super::subject::Subject;
use super::{Finding, FindingKind, Scope};
use crate::AnalysisError;
use crate::error::Cancelled;
use crate::survey::{Across, Faces, Piece};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Program, RegionId};
use rayweave_shape::surface::delta_of;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The contact of two regions.
#[derive(Clone, Copy, Debug)]
struct Contact {
    area: f64,
    at: Vec3,
}

/// A pair of regions, the lower number first.
type Two = [RegionId; 2];

/// The observations of a set of rays.
#[derive(Default)]
struct Seen {
    regions: BTreeSet<RegionId>,
    /// The number of pieces in regions.
    chords: u64,
    thin: BTreeMap<RegionId, Narrow>,
    gaps: BTreeMap<Two, Narrow>,
    contacts: BTreeMap<Two, Contact>,
    hits: Hits,
}

/// The kind of a way between two faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Wall(RegionId),
    Gap(Two),
}

/// The kind of a way through a region; `is_mother(a, b)` is true if region a contains region b.
fn kind(between: &Between, is_mother: &impl Fn(RegionId, RegionId) -> bool) -> Option<Kind> {
    let Between { region, beyond: [a, b] } = *between;
    let (world, pair) = (RegionId(0), [a.min(b), a.max(b)]);
    match region == world {
        true => (a != world && b != world).then_some(Kind::Gap(pair)),
        // the space between daughters is a gap, regardless of its region
        false if is_mother(region, a) && is_mother(region, b) => Some(Kind::Gap(pair)),
        false => Some(Kind::Wall(region)),
    }
}

impl Seen {
    /// Adds a piece of a ray; `is_mother(a, b)` is true if region a contains region b.
    fn piece(
        &mut self,
        piece: &Piece<'_>,
        [thin, narrow, searched]: [f64; 3],
        is_mother: &impl Fn(RegionId, RegionId) -> bool,
    ) {
        let (region, beyond, world) = (piece.region(), piece.neighbours(), RegionId(0));
        let after = beyond[1];
        if region != world {
            self.regions.insert(region);
            self.chords += 1;
        }
        let limit = thin.max(narrow);
        if width(piece, limit.max(searched)).is_some() {
            let is_thin = || width(piece, limit).is_some_and(|width| width < SEARCHED * thin);
            match kind(&Between { region, beyond }, is_mother) {
                Some(Kind::Gap(pair)) => self.narrow(piece, pair, searched),
                Some(Kind::Wall(_)) if is_thin() => self.thin.entry(region).or_default().add(piece),
                _ => {}
            }
        }
        if region == world {
            return;
        }
        if after != world && after != region {
            self.touch(piece, [region.min(after), region.max(after)]);
        }
    }

    /// Adds a contact: the end of a piece at another region.
    fn touch(&mut self, piece: &Piece<'_>, pair: Two) {
        let chord = piece.chord();
        let cosine = piece.normals()[1].dot((chord.to - chord.from).normalize_or_zero());
        let contact = Contact { area: piece.area * cosine.abs(), at: chord.to };
        self.contacts.entry(pair).and_modify(|known| known.area += contact.area).or_insert(contact);
    }

    fn narrow(&mut self, piece: &Piece<'_>, pair: Two, searched: f64) {
        if width(piece, searched).is_some_and(|width| width < searched) {
            self.gaps.entry(pair).or_default().add(piece);
        }
    }

    /// Adds the observations of later rays; only rays through the whole model measure contacts.
    fn add(&mut self, other: Seen, has_contacts: bool) {
        self.regions.extend(other.regions);
        self.hits.append(other.hits);
        self.chords += other.chords;
        for (region, narrow) in other.thin {
            self.thin.entry(region).or_default().append(narrow);
        }
        for (pair, narrow) in other.gaps {
            self.gaps.entry(pair).or_default().append(narrow);
        }
        for (pair, contact) in other.contacts.into_iter().filter(|_| has_contacts) {
            self.contacts.entry(pair).and_modify(|known| known.area += contact.area).or_insert(contact);
        }
    }

    /// Drops the widest places of walls and gaps whose search is not affordable; returns their number.
    fn shorten(&mut self, leaves: u64, budget: &mut Budget) -> u64 {
        let lists = || self.thin.values().chain(self.gaps.values());
        let mut widths: Vec<(f64, usize)> = Vec::new();
        for (list, narrow) in lists().enumerate() {
            widths.extend(narrow.widths().map(|width| (width, list)));
        }
        widths.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut most = vec![0; lists().count()];
        let mut left_out = 0;
        for (_, list) in widths {
            match budget.affords(RAYS_PER_SIDE, leaves) {
                true => most[list] += 1,
                false => left_out += 1,
            }
        }
        for (narrow, most) in self.thin.values_mut().chain(self.gaps.values_mut()).zip(most) {
            narrow.shorten(most);
        }
        left_out
    }
}

/// The estimated width of a wall or gap, if it may be below a limit.
fn width(piece: &Piece<'_>, less_than: f64) -> Option<f64> {
    // much longer pieces run along a face; other rays cross it
    let is_near = piece.length() < 64.0 * less_than;
    is_near.then(|| piece.wall()).flatten().filter(|width| *width < SEARCHED * less_than)
}

/// The rounding error of a width, by which limits are lowered: a wall exactly as thick as the limit is not below it. A width is the
/// distance of two points of a ray, so this is the tolerance of such a point. Origins of rays and magnitudes of
/// surfaces are at most the distance of the farthest corner of the frame from the origin plus the diagonal of the frame, times are at
/// most this diagonal.
fn rounding(frame: &Bounds) -> f64 {
    let (far, diagonal) = (frame.lo.abs().max(frame.hi.abs()).length(), frame.size().length());
    delta_of(2.0 * far + 3.0 * diagonal)
}

/// The number of rays through the whole model and through the box of each region.
pub fn planned_rays<E: Evaluator>(subject: &Subject<'_>, program: &Program, probe: &Probe<'_, E>) -> u64 {
    let cells = Cells::new(program, &probe.frame, &subject.boxes, probe.settings.across);
    let boxes = if cells.in_box > 0 { subject.boxes.len() as u64 } else { 0 };
    rays_of(cells.in_frame) + boxes * rays_of(cells.in_box)
}

/// Findings of rays through the whole model and through the box of each region.
pub fn findings<E: Evaluator>(
    subject: &Subject<'_>,
    program: Arc<Program>,
    known: &Intersecting,
    probe: &mut Probe<'_, E>,
) -> Result<Vec<Finding>, AnalysisError> {
    let evaluator = (probe.make)(program)?;
    // the default looks for faces that ought to touch; a given limit also for gaps whose narrowest place is beside the chord
    let factor = if probe.settings.gap.is_some() { SEARCHED } else { 1.0 };
    let limits = [probe.scope.wall, probe.scope.gap, factor * probe.scope.gap];
    let is_mother =
        |mother: RegionId, daughter: RegionId| match [mother, daughter].map(|r| r.index().checked_sub(1)) {
            [Some(mother), Some(daughter)] => {
                subject.hierarchy.is_some_and(|known| known.is_within(daughter, mother))
            }
            _ => false,
        };
    let (mut seen, frame) = (Seen::default(), probe.frame);
    let cells = Cells::new(evaluator.program(), &frame, &subject.boxes, probe.settings.across);
    (probe.scope.cells, probe.scope.cells_in_regions) = (cells.in_frame, cells.in_box);
    probe.scope.reached = cells.reached;
    let leaves = (cells.work * cells.reached).ceil() as u64;
    let mut search = Search::new(evaluator.program(), frame, limits[0].max(limits[1]), leaves);
    let mut scratch = evaluator.scratch();
    let matters = |between: &Between| kind(between, &is_mother).is_some();
    let sampled = if cells.in_box > 0 { subject.boxes.as_slice() } else { &[] };
    let boxes = sampled.iter().map(|bounds| (bounds, cells.in_box));
    let [mut in_frame, mut in_boxes] = [IN_EDGES; 2].map(Budget::of);
    for (number, (bounds, across)) in std::iter::once((&frame, cells.in_frame)).chain(boxes).enumerate() {
        let grid = Grid::new(&bounds.intersection(&frame), &frame);
        let visit = |seen: &mut Seen, piece: &Piece<'_>| {
            seen.piece(piece, limits, &is_mother);
            seen.hits.add(piece, &grid, evaluator.program());
        };
        probe.begin(rays_of(across));
        probe.survey(&evaluator, bounds, across, visit, |some: Seen| seen.add(some, number == 0))?;
        let hits = std::mem::take(&mut seen.hits);
        // each box may use what the ones before have left
        let budget = match number {
            0 => &mut in_frame,
            _ => &mut in_boxes.part((sampled.len() + 1 - number) as u64),
        };
        search.add(&evaluator, &hits, &grid, &matters, budget, &mut scratch);
        if number > 0 {
            in_boxes.add(budget.part(1));
        }
    }
    probe.scope.chords = seen.chords;
    let limits = limits.map(|limit| limit - rounding(&frame));
    let least = |between: &Between| match kind(between, &is_mother) {
        Some(Kind::Wall(_)) => limits[0],
        Some(Kind::Gap(_)) => limits[1],
        None => 0.0,
    };
    let mut at_edges: Vec<(Kind, Facing)> = Vec::new();
    for facing in search.found(&evaluator, &least, &mut scratch) {
        let Some(kind) = kind(&facing.between, &is_mother) else { continue };
        match (facing.is_contact, kind) {
            (false, _) => at_edges.push((kind, facing)),
            (true, Kind::Gap(pair)) if pair[0] != pair[1] => {
                let at = facing.across.middle();
                seen.contacts.entry(pair).or_insert(Contact { area: 0.0, at });
            }
            _ => {}
        }
    }
    cancelled(probe)?;
    search.left_out += seen.shorten(leaves, &mut probe.in_walls);
    let mut found = walls(subject, &evaluator, &seen, &at_edges, &mut search, limits[0]);
    found.extend(gaps(subject, &evaluator, &mut seen, &at_edges, &mut search, limits[1]));
    cancelled(probe)?;
    found.extend(contacts(subject, &seen, known, &probe.scope));
    (probe.scope.edges, probe.scope.edges_left_out) = (search.count, search.left_out);
    found.extend(missed(subject, &seen, &evaluator, probe)?);
    if subject.hierarchy.is_none() {
        let names: Vec<&str> = (0..subject.regions.len()).map(|region| subject.name(region)).collect();
        found.extend(connected::findings(&names, &evaluator, leaves, probe)?);
    }
    Ok(found)
}

fn cancelled<E>(probe: &Probe<'_, E>) -> Result<(), Cancelled> {
    if probe.settings.cancel.is_cancelled() { Err(Cancelled) } else { Ok(()) }
}

/// The numbers of cells along the edges of cross-sections: of the model, and of the box of each region.
struct Cells {
    in_frame: u32,
    in_box: u32,
    /// The mean number of leaves that a ray through the model reaches.
    reached: f64,
    /// The mean work for each of them.
    work: f64,
}

/// The mean number of leaves that a ray may reach before there are fewer rays.
const MANY_LEAVES: f64 = 32.0;

/// The most boxes times leaves that are compared with each other to estimate the number of leaves that a ray reaches.
const MOST_COMPARED: usize = 1 << 26;

impl Cells {
    /// `cells` along the edges of the whole model, and the same number of rays again, shared among the boxes of the regions; fewer
    /// where many leaves overlap, so that the work stays below that of as many rays with [`MANY_LEAVES`] simple leaves each.
    fn new(program: &Program, frame: &Bounds, boxes: &[Bounds], cells: u32) -> Cells {
        let (load, work) = (program.ray_load(), program.work_per_leaf());
        let in_model = load.through(frame);
        // the work grows with the square of the number of cells
        let factor = |load: f64| (MANY_LEAVES / (work * load)).sqrt().min(1.0);
        let fewer = |cells: u32, factor: f64| (f64::from(cells) * factor) as u32;
        let share = (f64::from(cells) / (boxes.len() as f64).sqrt()) as u32;
        let share = share.clamp(FEW, 64);
        let loads: Vec<f64> = match boxes.len().saturating_mul(load.len()) <= MOST_COMPARED {
            true => boxes.iter().map(|own| load.through(own)).collect(),
            false => vec![in_model; boxes.len()],
        };
        // the rays in boxes together may take as much as those through the whole model
        let all = f64::from(share).powi(2) * loads.iter().map(|load| load.max(1.0)).sum::<f64>();
        let per_ray = all / f64::from(cells).powi(2);
        let in_frame = fewer(cells, factor(in_model)).max(1);
        Cells { in_frame, in_box: fewer(share, factor(per_ray)), reached: in_model, work }
    }
}

/// The number of thin walls that are reported for each region, and of gaps for each two; further ones are counted.
const MAX_PLACES: usize = 20;

/// The findings of walls or gaps of one region or two.
fn listed(
    kind: FindingKind,
    names: &[&str],
    (places, program): (&[Place], &Program),
    one: String,
    more: impl Fn(usize) -> String,
) -> Vec<Finding> {
    let mut found: Vec<Finding> = Vec::new();
    for place in places.iter().take(MAX_PLACES) {
        let finding = Finding::new(kind, names, one.clone()).seen(place.width, place.across.chord);
        found.push(Finding { faces: place.face_names(program), ..finding });
    }
    let rest = places.len().saturating_sub(MAX_PLACES);
    if rest > 0 {
        found.push(Finding::new(kind, names, more(rest)));
    }
    found
}

fn walls<E: Evaluator>(
    subject: &Subject<'_>,
    evaluator: &E,
    seen: &Seen,
    at_edges: &[(Kind, Facing)],
    search: &mut Search<'_>,
    thin: f64,
) -> Vec<Finding> {
    let (mut found, mut scratch) = (Vec::new(), evaluator.scratch());
    for region in &seen.regions {
        let mut is_edge =
            |across: &Across, scratch: &mut E::Scratch| search.is_edge(evaluator, across, scratch);
        let narrow = seen.thin.get(region);
        let measured = narrow.map(|own| own.measured_by_side(evaluator, &mut is_edge, &mut scratch));
        let mut places = Vec::new();
        for across in measured.into_iter().flatten().filter(|across| across.width(Faces::Wall) < thin) {
            if !is_edge(&across, &mut scratch) {
                places.push(Place::of_faces(&across));
            }
        }
        let own = at_edges.iter().filter(|(kind, _)| *kind == Kind::Wall(*region));
        places.extend(own.map(|(_, facing)| Place::of_edges(facing)));
        let name = subject.name(region.index() - 1);
        let more = |rest: usize| match rest {
            1 => format!("{name} has 1 more thin wall"),
            _ => format!("{name} has {rest} more thin walls"),
        };
        found.extend(listed(
            FindingKind::Thin,
            &[name],
            (&distinct(places), evaluator.program()),
            format!("{name} is thin"),
            more,
        ));
    }
    found
}

/// The narrow gaps. Where two regions touch, there is a contact instead.
fn gaps<E: Evaluator>(
    subject: &Subject<'_>,
    evaluator: &E,
    seen: &mut Seen,
    at_edges: &[(Kind, Facing)],
    search: &mut Search<'_>,
    narrow: f64,
) -> Vec<Finding> {
    let mut scratch = evaluator.scratch();
    let mut places: BTreeMap<Two, Vec<Place>> = BTreeMap::new();
    for (pair, candidates) in &seen.gaps {
        for across in candidates.measured_by_side(evaluator, &mut |_, _| false, &mut scratch) {
            let place = search.between_faces(evaluator, across.chord, &mut scratch);
            if let Some((place, region)) = place.filter(|(place, _)| place.distance <= place.tolerance) {
                let (at, between) =
                    (0.5 * (place.ends[0] + place.ends[1]), Between { region, beyond: *pair });
                // two faces of one region that meet in an edge are no contact, like those of a wall
                if pair[0] == pair[1]
                    && !place.is_tangent
                    && is_crease(evaluator, at, (&across, pair[0]), place.tolerance, &mut scratch)
                {
                    continue;
                }
                if touches(evaluator, at, between, place.tolerance, &mut scratch) {
                    seen.contacts.entry(*pair).or_insert(Contact { area: 0.0, at });
                    continue;
                }
            }
            // as for walls; contacts are found above
            if pair[0] == pair[1] && search.is_edge(evaluator, &across, &mut scratch) {
                continue;
            }
            let better = place.filter(|(place, _)| place.distance > place.tolerance);
            let better = better.map(|(place, _)| Place::of_faces(&across).with_chord(place.chord()));
            let own = Place::of_faces(&across);
            places.entry(*pair).or_default().push(match better {
                Some(better) if better.width < own.width => better,
                _ => own,
            });
        }
    }
    for (kind, facing) in at_edges {
        if let Kind::Gap(pair) = kind {
            places.entry(*pair).or_default().push(Place::of_edges(facing));
        }
    }
    let mut found = Vec::new();
    for ([a, b], mut places) in places {
        places.retain(|place| place.width < narrow);
        let names = [a, b].map(|region| subject.name(region.index() - 1));
        let (one, regions, names) = match a == b {
            true => (format!("{} is divided by a narrow gap", names[0]), names[0].to_owned(), &names[..1]),
            false => {
                let both = format!("{} and {}", names[0], names[1]);
                (format!("{both} are separated by a narrow gap"), both, &names[..])
            }
        };
        let have = if a == b { "has" } else { "have" };
        let more = |rest: usize| match rest {
            1 => format!("{regions} {have} 1 more narrow gap"),
            _ => format!("{regions} {have} {rest} more narrow gaps"),
        };
        found.extend(listed(FindingKind::Gap, names, (&distinct(places), evaluator.program()), one, more));
    }
    found
}

/// Contacts of regions that are not mother and daughter and do not intersect. If not all pairs were examined, those
/// whose boxes overlap are left out: they may overlap.
fn contacts(subject: &Subject<'_>, seen: &Seen, known: &Intersecting, scope: &Scope) -> Vec<Finding> {
    let mut found = Vec::new();
    for ([a, b], contact) in &seen.contacts {
        let (k, j) = (a.index() - 1, b.index() - 1);
        let names = [subject.name(k), subject.name(j)];
        let common = subject.boxes[k].intersection(&subject.boxes[j]);
        let is_common = !common.is_empty() && common.size().min_element() > scope.distance;
        let may_overlap = scope.left_out > 0 && is_common;
        if known.pairs.contains(&(k, j)) || may_overlap || subject.are_kin(k, j) {
            continue;
        }
        let (text, names) = match a == b {
            true => (format!("{} touches itself", names[0]), &names[..1]),
            false => (format!("{} and {} touch", names[0], names[1]), &names[..]),
        };
        let finding = Finding::new(FindingKind::Touch, names, text);
        found.push(Finding { area: Some(contact.area), at: Some(contact.at), ..finding });
    }
    found
}

/// Examines a region that is empty within the sampled box; `None` if the region exists outside the box.
fn nothing<E: Evaluator>(
    subject: &Subject<'_>,
    region: usize,
    probe: &mut Probe<'_, E>,
) -> Result<Option<Finding>, AnalysisError> {
    let name = subject.name(region);
    let proved = || {
        let finding = Finding::new(FindingKind::Empty, &[name], format!("{name} is empty"));
        Ok(Some(Finding { is_proved: true, ..finding }))
    };
    let Some(whole) = subject.beyond(region) else {
        if subject.boxes[region].is_empty() {
            return proved();
        }
        return Ok(Some(Finding::new(
            FindingKind::Empty,
            &[name],
            format!("no ray found any part of {name}"),
        )));
    };
    let bounds = Program::compile(whole)?.bounds();
    if bounds.is_empty() {
        return proved();
    }
    // a region outside the sampled box is not missing
    if !bounds.is_finite() || probe.thickest(whole, &bounds, 3 * FEW)?.is_some() {
        return Ok(None);
    }
    Ok(Some(Finding::new(FindingKind::Empty, &[name], format!("no ray found any part of {name}"))))
}

/// Reports the regions that no ray crossed.
fn missed<E: Evaluator>(
    subject: &Subject<'_>,
    seen: &Seen,
    evaluator: &E,
    probe: &mut Probe<'_, E>,
) -> Result<Vec<Finding>, AnalysisError> {
    let mut found = Vec::new();
    for region in 0..subject.regions.len() {
        if !seen.regions.contains(&RegionId::from(region + 1)) {
            found.extend(unseen(subject, region, evaluator, probe)?);
        }
    }
    Ok(found)
}

/// Reports a region that no ray crossed.
fn unseen<E: Evaluator>(
    subject: &Subject<'_>,
    region: usize,
    evaluator: &E,
    probe: &mut Probe<'_, E>,
) -> Result<Option<Finding>, AnalysisError> {
    let (name, bounds) = (subject.name(region), subject.boxes[region]);
    let solid = &subject.regions[region].solid;
    // a few rays find a solid that fills a part of its box
    let across = if probe.in_unseen.affords(rays_of(3 * FEW), leaves_of(solid)) { 3 * FEW } else { 3 };
    let Some(met) = probe.thickest(solid, &bounds, across)? else {
        return nothing(subject, region, probe);
    };
    let at = 0.5 * (met.chord.from + met.chord.to);
    let mut owner = [RegionId(0)];
    evaluator.regions_at([&[at.x], &[at.y], &[at.z]], &mut evaluator.scratch(), &mut owner);
    let Some(owner) = owner[0].index().checked_sub(1).filter(|&owner| owner != region) else {
        // the region exists, but the rays missed it
        return Ok(None);
    };
    let by = subject.name(owner);
    let text = format!("{name} is completely covered by the later region {by}");
    Ok(Some(Finding::new(FindingKind::Hidden, &[name, by], text).seen(met.thickness, met.chord)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_math::Vec3;
    use rayweave_model::Solid;
    use rayweave_shape::primitive::{Primitive, Sphere};

    /// The leaves that all rays reach: through the model, and through the boxes of the regions.
    fn work(centres: &[Vec3]) -> [f64; 2] {
        let ball = Solid::from(Primitive::from(Sphere::new(1.0).unwrap()));
        let all = Solid::union(centres.iter().map(|&centre| ball.translate(centre)));
        let program = Program::compile(&all).unwrap();
        let boxes: Vec<Bounds> =
            centres.iter().map(|&centre| Bounds::new(centre, centre).grown(1.0)).collect();
        let (frame, load) = (program.bounds(), program.ray_load());
        let cells = Cells::new(&program, &frame, &boxes, 128);
        let rays = |across: u32| 6.0 * f64::from(across).powi(2);
        let in_boxes = boxes.iter().map(|own| rays(cells.in_box) * load.through(own));
        [rays(cells.in_frame) * load.through(&frame), in_boxes.sum()]
    }

    /// With 98,304 rays through each of two thousand balls in one place, and 600 more for each ball, it would be 200 million and 2.4 billion.
    #[test]
    fn the_work_of_rays_is_limited() {
        let apart: Vec<Vec3> = (0..1000)
            .map(|k| 3.0 * Vec3::new(f64::from(k % 10), f64::from(k / 10 % 10), f64::from(k / 100)))
            .collect();
        let [in_frame, in_boxes] = work(&apart);
        // all rays: a thousand squares of 2 x 2 in each square of 29 x 29
        assert!(
            (in_frame / 98_304.0 - 4.76).abs() < 0.05 && (in_boxes / 600_000.0 - 1.0).abs() < 0.1,
            "{in_frame} {in_boxes}"
        );
        let together: Vec<Vec3> =
            (0..2000).map(|k| 1e-3 * Vec3::new(f64::from(k % 10), f64::from(k / 10 % 10), 0.0)).collect();
        let [in_frame, in_boxes] = work(&together);
        assert!(in_frame < 3.2e6 && in_boxes < 3.2e6, "{in_frame} {in_boxes}");
    }
}
