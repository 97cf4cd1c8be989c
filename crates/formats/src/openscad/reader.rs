//! Conversion of the syntax tree of a dump to a scene: bottom-up and without recursion.

use super::arguments::{Arguments, Refusal};
use super::body;
use super::boolean::{join, join_solids, whole};
use super::drawing::TOLERANCE;
use super::extent::Way;
use super::extrude::extruded;
use super::flat::{self, Flat, Leaf};
use super::fold::{Start, is_union, turned_region};
use super::hull::Generator;
use super::import::Imported;
use super::mesh::Twist;
use super::operation::Operation;
use super::part::{Part, Piece};
use super::revolve::Turn;
use super::shell::{Shell, one_item, one_item_with};
use super::state::Reader;
use super::syntax::Node;
use super::text::text;
use super::{gather, hull, import, mesh, offset, primitive, projection, region, relief, sum, transform};
use crate::kernel::Body;
use crate::{LossKind, Report};
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_scene::{Colour, Diagnostic, Diagnostics, Medium, Scene, SceneRegion, Severity, Unit};

impl<'a> Reader<'a> {
    /// The scene of all items, with one region per colour.
    ///
    /// # Errors
    ///
    /// The dump names files that it may not read, or an item exceeds the budget of the file.
    pub fn scene(mut self) -> Result<(Scene, Report), Diagnostics> {
        self.find_live();
        let mut roots = self.tree.nodes.iter().zip(&self.live);
        let root = roots.position(|(node, live)| node.modifiers.root && *live).unwrap_or(0);
        self.keep_below(root);
        // children have greater indices than their parents
        for number in (0..self.tree.nodes.len()).rev() {
            if self.live[number] {
                self.parts[number] = self.part(number);
            }
            if let Some(limit) = self.budget.exceeded() {
                return Err(Diagnostics::new(vec![limit]));
            }
        }
        let pieces = match std::mem::replace(&mut self.parts[root], Part::Empty) {
            Part::Solid(pieces) => pieces,
            Part::Flat(pieces) => self.plates(&pieces),
            Part::Empty | Part::Refused => Vec::new(),
        };
        if pieces.is_empty() {
            let nothing = Diagnostic::warning("the model is empty").why("no item of it has a volume");
            self.report.add(LossKind::Dropped, "model", nothing.in_file(self.source));
        }
        if let Some(limit) = self.budget.exceeded() {
            self.errors.push(limit);
        }
        match self.errors.is_empty() {
            true => Ok((scene(pieces), self.report)),
            false => Err(Diagnostics::new(self.errors)),
        }
    }

    /// Marks the nodes that take part in the model: those that are not below a `*` or a `%`.
    fn find_live(&mut self) {
        for (number, node) in self.tree.nodes.iter().enumerate() {
            let modifiers = node.modifiers;
            let is_shadow = modifiers.background && !modifiers.root;
            if self.live[number] && is_shadow && !modifiers.disabled {
                let why = Diagnostic::warning("an item in the background is left out")
                    .why("`%` shows it in previews only");
                self.report.add(LossKind::Dropped, &node.name, why.at(self.source, node.span));
            }
            self.live[number] &= !modifiers.disabled && !is_shadow;
            if !self.live[number] {
                node.children.iter().for_each(|child| self.live[*child as usize] = false);
            }
        }
    }

    /// Restricts the model to the subtree of a node.
    fn keep_below(&mut self, root: usize) {
        let mut below = vec![false; self.live.len()];
        below[root] = true;
        for (number, node) in self.tree.nodes.iter().enumerate() {
            self.live[number] &= below[number];
            node.children.iter().for_each(|child| below[*child as usize] |= below[number]);
        }
    }

    fn part(&mut self, number: usize) -> Part {
        let node = &self.tree.nodes[number];
        for warning in self.arguments(number).unused() {
            self.report.add(LossKind::Dropped, &item(node), warning);
        }
        let part = self.read(number, node);
        if self.flats.has_chords.take() {
            let arguments = self.arguments(number);
            let why = format!(
                "has chords instead of circles, which deviate by at most {TOLERANCE:e} of the radius"
            );
            self.report.add(LossKind::Approximated, &item(node), arguments.approximation(&why));
        }
        match part {
            Ok(Part::Refused) => {}
            Ok(part) => return part,
            Err(why) if why.severity() == Severity::Error => self.errors.push(*why),
            Err(why) => self.report.add(LossKind::Refused, &item(node), *why),
        }
        // traversals of the subtree of an ancestor skip refused nodes
        self.live[number] = false;
        Part::Refused
    }

    fn read(&mut self, number: usize, node: &'a Node) -> Result<Part, Refusal> {
        let arguments = self.arguments(number);
        let facets = self.is_faceted(&arguments);
        match node.name.as_str() {
            "group" | "union" | "render" => self.combine(&arguments, node, Operation::Union),
            "difference" => self.combine(&arguments, node, Operation::Difference),
            "intersection" => self.combine(&arguments, node, Operation::Intersection),
            "multmatrix" => self.transformed(node, &arguments),
            "color" => self.coloured(node, &arguments),
            "cube" => primitive::cube(&arguments),
            "sphere" => primitive::sphere(&arguments, facets),
            "cylinder" => primitive::cylinder(&arguments, facets),
            "square" => Ok(self.leaf(flat::square(&arguments)?)),
            "circle" => Ok(self.leaf(flat::circle(&arguments, facets)?)),
            "polygon" => Ok(self.leaf(flat::polygon(&arguments)?)),
            "text" => self.text(&arguments),
            "linear_extrude" => self.linear_extrude(number, node, &arguments),
            "rotate_extrude" => self.rotate_extrude(number, node, &arguments),
            "hull" => self.hull(number, node, &arguments),
            "minkowski" => self.minkowski(number, node, &arguments),
            "offset" => self.offset(node, &arguments),
            "polyhedron" => self.polyhedron(&arguments),
            "import" => self.import(number, &arguments),
            "surface" => {
                let relief::Relief { shell, short_rows } = relief::surface(&arguments, &self.files)?;
                if short_rows > 0 {
                    let rows = if short_rows == 1 { "row" } else { "rows" };
                    let why = format!("pads {short_rows} short {rows} of its file with zeros");
                    self.report.add(LossKind::Approximated, "surface()", arguments.approximation(&why));
                }
                self.within(number, &arguments, shell)
            }
            "projection" => self.projection(number, node, &arguments),
            "resize" => self.resize(number, node, &arguments),
            _ => Err(arguments.refusal("items of this name cannot be read")),
        }
    }

    fn polyhedron(&mut self, arguments: &Arguments) -> Result<Part, Refusal> {
        let part = mesh::polyhedron(arguments)?;
        if mesh::bent_faces(arguments)? > 0 {
            let why = "has faces that are not planar, divided into triangles in one of several ways";
            self.report.add(LossKind::Approximated, "polyhedron()", arguments.approximation(why));
        }
        Ok(part)
    }

    fn leaf(&mut self, leaf: Option<Leaf>) -> Part {
        leaf.map_or(Part::Empty, |leaf| self.flats.leaf(leaf).into())
    }

    /// The boolean combination of the children of a node.
    fn combine(&mut self, arguments: &Arguments, node: &Node, operation: Operation) -> Result<Part, Refusal> {
        let count =
            node.children.iter().map(|child| self.parts[*child as usize].piece_count()).sum::<usize>();
        arguments.spend(200 * (node.children.len() + count))?;
        Ok(self.combine_parts(node, operation))
    }

    fn combine_parts(&mut self, node: &Node, operation: Operation) -> Part {
        let (mut solids, mut flats) = (Vec::new(), Vec::new());
        let (mut other_dimension, mut is_first) = (false, true);
        for child in &node.children {
            let part = std::mem::replace(&mut self.parts[*child as usize], Part::Empty);
            let is_live = self.live[*child as usize];
            if matches!(part, Part::Empty) && !is_live {
                // disabled or in the background: the next child takes its place
                continue;
            }
            match (part, operation) {
                // without its first operand, a difference is empty
                (part @ (Part::Refused | Part::Empty), Operation::Difference) if is_first => return part,
                (Part::Empty, Operation::Intersection) => return Part::Empty,
                (Part::Refused | Part::Empty, _) => {}
                (Part::Solid(pieces), _) if flats.is_empty() => solids.push(pieces),
                (Part::Flat(pieces), _) if solids.is_empty() => flats.push(pieces),
                _ => other_dimension = true,
            }
            is_first = false;
        }
        if other_dimension {
            let why = Diagnostic::warning("three- and two-dimensional objects are mixed")
                .why("as in OpenSCAD, only objects with the dimension of the first one are kept");
            self.report.add(LossKind::Dropped, &item(node), why.at(self.source, node.span));
            if operation == Operation::Intersection && !solids.is_empty() {
                // the omitted operand is not a solid, so the intersection is empty
                return Part::Empty;
            }
        }
        if !solids.is_empty() {
            return Part::Solid(join(operation, solids, &mut join_solids));
        }
        if !flats.is_empty() {
            let all = &mut self.flats;
            return Part::Flat(join(operation, flats, &mut |operation, flats| all.join(operation, flats)));
        }
        Part::Empty
    }

    fn transformed(&mut self, node: &Node, arguments: &Arguments) -> Result<Part, Refusal> {
        let map = transform::matrix(arguments)?;
        let part = self.combine(arguments, node, Operation::Union)?;
        let map = if matches!(part, Part::Flat(_)) { transform::restricted_to_xy(&map) } else { map };
        if map.inverse().is_err() && matches!(part, Part::Solid(_) | Part::Flat(_)) {
            let why =
                arguments.approximation("leaves nothing, because its matrix has no inverse. Is a scale 0?");
            self.report.add(LossKind::Dropped, "multmatrix()", why);
            return Ok(Part::Empty);
        }
        if map == Affine::IDENTITY {
            return Ok(part);
        }
        arguments.spend(500 * part.piece_count())?;
        Ok(match part {
            Part::Solid(pieces) => Part::Solid(mapped(pieces, |solid| solid.apply(map))),
            Part::Flat(pieces) => Part::Flat(mapped(pieces, |flat| self.flats.transformed(map, flat))),
            other => other,
        })
    }

    fn coloured(&mut self, node: &Node, arguments: &Arguments) -> Result<Part, Refusal> {
        let colour = transform::colour(arguments)?;
        let part = self.combine(arguments, node, Operation::Union)?;
        if colour.is_none() {
            return Ok(part);
        }
        Ok(match part {
            Part::Solid(pieces) => Part::Solid(vec![Piece { colour, body: whole(pieces, &mut join_solids) }]),
            Part::Flat(pieces) => Part::Flat(vec![Piece { colour, body: self.whole(pieces) }]),
            other => other,
        })
    }

    /// The union of the pieces of a plane region.
    fn whole(&mut self, pieces: Vec<Piece<Flat>>) -> Flat {
        let all = &mut self.flats;
        whole(pieces, &mut |operation, flats| all.join(operation, flats))
    }

    fn text(&mut self, arguments: &Arguments) -> Result<Part, Refusal> {
        let letters = text(arguments, &mut self.fonts)?;
        if let Some(stand_in) = letters.stand_in {
            self.report.add(LossKind::Approximated, "text()", arguments.approximation(&stand_in));
        }
        let leaves: Vec<Flat> = letters.leaves.into_iter().map(|leaf| self.flats.leaf(leaf)).collect();
        match leaves.is_empty() {
            true => Ok(Part::Empty),
            false => Ok(self.flats.join(Operation::Union, leaves).into()),
        }
    }

    /// The profile below a node, or the resulting part if there is none.
    fn profile(
        &mut self,
        number: usize,
        node: &Node,
        arguments: &Arguments,
    ) -> Result<Result<Flat, Part>, Refusal> {
        // older dumps name the drawing in the extrusion itself
        let part = match import::word(arguments, "file")? {
            Some("") | None => self.combine(arguments, node, Operation::Union)?,
            _ => self.import(number, arguments)?,
        };
        match part {
            Part::Flat(pieces) => {
                let flat = self.whole(pieces);
                self.extruded.insert(number, flat);
                Ok(Ok(flat))
            }
            Part::Solid(_) => Err(arguments.refusal("its children are solids, not regions of the plane")),
            other => Ok(Err(other)),
        }
    }

    fn linear_extrude(&mut self, number: usize, node: &Node, arguments: &Arguments) -> Result<Part, Refusal> {
        let flat = match self.profile(number, node, arguments)? {
            Ok(flat) => flat,
            Err(part) => return Ok(part),
        };
        let Some(way) = Way::of(arguments)? else {
            return Ok(Part::Empty);
        };
        let is_twisted = arguments.number("twist", 0.0)? != 0.0;
        if !is_twisted && (way.is_even() || !self.options.facets) {
            return Ok(one_item(&extruded(arguments, &self.flats, flat, &way)?).into());
        }
        if !self.options.facets {
            let why = arguments.approximation("is twisted in slices, with the facets of OpenSCAD");
            self.report.add(LossKind::Approximated, "linear_extrude()", why);
        }
        let twist = Twist::new(arguments, &self.flats, flat, &way)?;
        Ok(twist.solid(arguments, &self.flats, flat)?.into())
    }

    fn rotate_extrude(&mut self, number: usize, node: &Node, arguments: &Arguments) -> Result<Part, Refusal> {
        let flat = match self.profile(number, node, arguments)? {
            Ok(flat) => flat,
            Err(part) => return Ok(part),
        };
        let facets = self.is_faceted(arguments);
        let Some(mut turn) = Turn::new(arguments, facets, &self.flats, flat)? else {
            return Ok(Part::Empty);
        };
        let solid = turn.solid(&self.flats, flat)?;
        for message in turn.approximations {
            self.report.add(LossKind::Approximated, "rotate_extrude()", arguments.approximation(message));
        }
        if !facets {
            return Ok(one_item(&solid).into());
        }
        let shell = turned_region(self, arguments, flat);
        Ok(shell.map_or_else(|_| one_item(&solid), |shell| one_item_with(&solid, shell)).into())
    }

    fn hull(&mut self, number: usize, node: &Node, arguments: &Arguments) -> Result<Part, Refusal> {
        match self.combine(arguments, node, Operation::Union)? {
            Part::Solid(_) => {
                let generators = self.generators(number)?;
                arguments.spend(hull::cost(&generators))?;
                let found = hull::hull(arguments, &generators)?;
                if !found.is_exact && !self.options.facets {
                    let why = arguments.approximation("is the hull of the facets of its parts");
                    self.report.add(LossKind::Approximated, "hull()", why);
                }
                self.keep(number, arguments, &[generators])?;
                Ok(found.solid.map_or(Part::Empty, |solid| one_item(&solid).into()))
            }
            Part::Flat(pieces) => {
                let flat = self.whole(pieces);
                let discs = gather::round(arguments, &self.flats, flat)?;
                gather::hull_of_discs(arguments, &mut self.flats, &discs)
            }
            other => Ok(other),
        }
    }

    /// Generators of the hull of a node; the vertices of the facets if some part is not convex.
    fn generators(&self, number: usize) -> Result<Vec<Generator>, Refusal> {
        if let Ok(found) = gather::generators(self, number, Affine::IDENTITY) {
            return Ok(found);
        }
        let points = projection::corner_points(self, number)?;
        Ok(points.into_iter().map(Generator::point).collect())
    }

    /// Stores the hulls of generators as shells, if an ancestor needs them.
    fn keep(
        &mut self,
        number: usize,
        arguments: &Arguments,
        parts: &[Vec<Generator>],
    ) -> Result<(), Refusal> {
        if self.wanted[number] {
            let points = |part: &Vec<Generator>| part.iter().flat_map(Generator::vertices).collect();
            let shells = parts.iter().map(|part| Shell::hull(arguments, points(part)));
            self.shells.insert(number, shells.collect::<Result<_, _>>()?);
        }
        Ok(())
    }

    /// The solid inside a shell. The shell is stored if an ancestor needs it.
    fn within(&mut self, number: usize, arguments: &Arguments, shell: Shell) -> Result<Part, Refusal> {
        if self.wanted[number] {
            self.shells.insert(number, vec![shell.clone()]);
        }
        match shell.triangles.is_empty() {
            true => Ok(Part::Empty),
            false => Ok(mesh::within(arguments, shell.vertices, shell.triangles)?.into()),
        }
    }

    fn import(&mut self, number: usize, arguments: &Arguments) -> Result<Part, Refusal> {
        let facets = self.options.facets;
        match import::import(arguments, &self.files, facets, &mut self.flats, &mut self.report)? {
            Imported::Drawing(part) => Ok(part),
            Imported::Mesh(shell) => self.within(number, arguments, shell),
        }
    }

    fn projection(&mut self, number: usize, node: &Node, arguments: &Arguments) -> Result<Part, Refusal> {
        match self.combine(arguments, node, Operation::Union)? {
            Part::Solid(_) => {}
            Part::Flat(_) => {
                return Err(arguments.refusal("its children are regions of the plane, not solids"));
            }
            other => return Ok(other),
        }
        let contours = match arguments.boolean("cut", false)? {
            true => projection::section(self, number)?,
            false => projection::shadow(self, number)?,
        };
        arguments.hold(contours.iter().map(Vec::len).sum())?;
        match contours.is_empty() {
            true => Ok(Part::Empty),
            false => Ok(self.flats.leaf(Leaf::Outline(contours)).into()),
        }
    }

    fn resize(&mut self, number: usize, node: &Node, arguments: &Arguments) -> Result<Part, Refusal> {
        let part = self.combine(arguments, node, Operation::Union)?;
        let mut kept = None;
        let size = match &part {
            Part::Flat(pieces) => {
                let flat = self.whole(pieces.clone());
                let bounds = self.flat_bounds(arguments, flat)?;
                bounds.map(|[lo, hi]| vec![hi[0] - lo[0], hi[1] - lo[1]])
            }
            Part::Solid(_) => match self.solid_extent(number)? {
                Extent::Box(bounds) => bounds.map(|[lo, hi]| (hi - lo).to_array().to_vec()),
                Extent::Body(body) => {
                    let shell = Shell::of_body(&body);
                    let points = shell.vertices.iter().map(|p| [*p; 2]);
                    let bounds = points.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
                    kept = Some(shell);
                    bounds.map(|[lo, hi]| (hi - lo).to_array().to_vec())
                }
            },
            _ => return Ok(part),
        };
        let Some(size) = size else { return Ok(Part::Empty) };
        let map = transform::resizing(arguments, &size)?;
        self.resized.insert(number, map);
        if let Some(mut shell) = kept.filter(|_| self.wanted[number]) {
            shell.vertices.iter_mut().for_each(|p| *p = map.point(*p));
            self.shells.insert(number, vec![shell]);
        }
        Ok(match part {
            Part::Solid(pieces) => Part::Solid(mapped(pieces, |solid| solid.apply(map))),
            Part::Flat(pieces) => Part::Flat(mapped(pieces, |flat| self.flats.transformed(map, flat))),
            other => other,
        })
    }

    fn flat_bounds(&self, arguments: &Arguments, flat: Flat) -> Result<Option<[[f64; 2]; 2]>, Refusal> {
        let [lo, hi] = match self.flats.is_union(arguments, flat)? {
            true => self.flats.bounds(arguments, flat)?,
            false => {
                let contours = region::boundary(arguments, &self.flats, flat)?;
                Leaf::Outline(contours).bounds(&Affine::IDENTITY)
            }
        };
        Ok((lo[0] < hi[0] && lo[1] < hi[1]).then_some([lo, hi]))
    }

    /// The bounding box of the children of a node, or the body that has it.
    fn solid_extent(&self, number: usize) -> Result<Extent, Refusal> {
        let arguments = self.arguments(number);
        if let Ok(all) = gather::generators(self, number, Affine::IDENTITY) {
            let all = all.iter().map(Generator::bounds);
            return Ok(Extent::Box(all.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])));
        }
        // an exceeded limit is not a reason to try a different method
        arguments.spend(0)?;
        if !is_union(self, number)? {
            return Ok(body::body(self, Start::Below(number))?
                .map_or(Extent::Box(None), |body| Extent::Body(Box::new(body))));
        }
        let points = projection::corner_points(self, number)?;
        let points = points.iter().map(|p| [*p; 2]);
        Ok(Extent::Box(points.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])))
    }

    fn minkowski(&mut self, number: usize, node: &Node, arguments: &Arguments) -> Result<Part, Refusal> {
        let (mut solids, mut flats) = (Vec::new(), Vec::new());
        for child in &node.children {
            match std::mem::replace(&mut self.parts[*child as usize], Part::Empty) {
                Part::Refused => return Ok(Part::Refused),
                Part::Empty => {}
                Part::Solid(_) => solids.push(*child as usize),
                Part::Flat(pieces) => flats.push(self.whole(pieces)),
            }
        }
        match (solids.is_empty(), flats.is_empty()) {
            (true, true) => Ok(Part::Empty),
            (true, false) => self.flat_sum(arguments, &flats),
            (false, false) => Err(arguments.refusal("solids and regions of the plane have no sum")),
            (false, true) => {
                let parts = solids.iter().map(|solid| gather::convex_parts(self, *solid));
                match parts.collect::<Result<Vec<_>, _>>() {
                    Ok(parts) if sum::pairs(&parts) <= gather::MAX_SUMS => {
                        self.sum_of_convex(number, arguments, parts)
                    }
                    _ => self.sum_of_facets(number, arguments, &solids),
                }
            }
        }
    }

    /// Minkowski sum of unions of convex parts.
    fn sum_of_convex(
        &mut self,
        number: usize,
        arguments: &Arguments,
        parts: Vec<Vec<Vec<Generator>>>,
    ) -> Result<Part, Refusal> {
        let found = sum::sum(arguments, parts)?;
        if !found.is_exact && !self.options.facets {
            let why = arguments.approximation("is the sum of the facets of its parts");
            self.report.add(LossKind::Approximated, "minkowski()", why);
        }
        self.keep(number, arguments, &found.parts)?;
        Ok(found.solid.map_or(Part::Empty, |solid| one_item(&solid).into()))
    }

    /// Minkowski sum of arbitrary solids, in facets.
    fn sum_of_facets(
        &mut self,
        number: usize,
        arguments: &Arguments,
        solids: &[usize],
    ) -> Result<Part, Refusal> {
        match body::sum(self, arguments, solids)? {
            Some(sum) => self.within(number, arguments, Shell::of_body(&sum)),
            None => Ok(Part::Empty),
        }
    }

    /// Minkowski sum of plane regions; discs stay exact if all operands but the first are convex.
    fn flat_sum(&mut self, arguments: &Arguments, operands: &[Flat]) -> Result<Part, Refusal> {
        let mut flat = operands[0];
        for other in &operands[1..] {
            let part = match gather::is_convex(arguments, &self.flats, *other)? {
                true => {
                    let discs = gather::round(arguments, &self.flats, *other)?;
                    let flat = offset::plain(arguments, &mut self.flats, flat)?;
                    let flat = offset::few(arguments, &mut self.flats, flat)?;
                    sum::flat_sum(arguments, &mut self.flats, flat, &discs)?
                }
                false => {
                    let [a, b] = [flat, *other].map(|flat| region::boundary(arguments, &self.flats, flat));
                    self.flats.leaf(Leaf::Outline(region::sum(arguments, &a?, &b?)?)).into()
                }
            };
            let Part::Flat(pieces) = part else { return Ok(part) };
            flat = self.whole(pieces);
        }
        Ok(flat.into())
    }

    fn offset(&mut self, node: &Node, arguments: &Arguments) -> Result<Part, Refusal> {
        match self.combine(arguments, node, Operation::Union)? {
            Part::Flat(pieces) => {
                let flat = self.whole(pieces);
                offset::offset(arguments, &mut self.flats, flat)
            }
            Part::Solid(_) => Err(arguments.refusal("its children are solids, not regions of the plane")),
            other => Ok(other),
        }
    }

    /// Plane regions as plates of thickness 1, as in OpenSCAD's preview.
    fn plates(&mut self, pieces: &[Piece<Flat>]) -> Vec<Piece<Solid>> {
        let arguments = self.arguments(0);
        let way = Way { bottom: -0.5, top: 0.5, scale: [1.0; 2] };
        let mut plates = Vec::new();
        for Piece { colour, body } in pieces {
            match extruded(&arguments, &self.flats, *body, &way) {
                Ok(body) => plates.push(Piece { colour: *colour, body }),
                Err(why) => self.report.add(LossKind::Refused, "model", *why),
            }
        }
        let why = Diagnostic::warning("the model is a region of the plane")
            .why("it is taken as a plate from z = -0.5 to 0.5, as OpenSCAD shows it");
        self.report.add(LossKind::Approximated, "model", why.in_file(self.source));
        plates
    }
}

/// The extent of a solid.
enum Extent {
    Box(Option<[Vec3; 2]>),
    /// A body of facets.
    Body(Box<Body>),
}

fn mapped<T>(pieces: Vec<Piece<T>>, mut map: impl FnMut(T) -> T) -> Vec<Piece<T>> {
    pieces.into_iter().map(|Piece { colour, body }| Piece { colour, body: map(body) }).collect()
}

/// Name of a node in reports.
fn item(node: &Node) -> String {
    format!("{}()", node.name)
}

/// A scene with one region per piece, each with its own medium.
fn scene(pieces: Vec<Piece<Solid>>) -> Scene {
    let names = names(&pieces);
    let mut media = vec![Medium { name: "world".to_owned(), ..Medium::default() }];
    let mut regions = Vec::new();
    for (number, (piece, name)) in pieces.into_iter().zip(names).enumerate() {
        media.push(Medium { name: name.clone(), ..Medium::default() });
        let palette = Colour::numbered(number);
        let (medium, colour) = (number as u32 + 1, piece.colour.unwrap_or(palette));
        // the same tree as after reading a native file
        let solid = piece.body.named(&name);
        regions.push(SceneRegion { name, solid, medium, colour });
    }
    // a dump has no unit; 3D printing assumes millimetres
    Scene::from_regions(Unit::Millimetre, regions, media)
}

/// `model` for the piece without a colour, else the colour.
fn names(pieces: &[Piece<Solid>]) -> Vec<String> {
    let name = |piece: &Piece<Solid>| match piece.colour {
        None => "model".to_owned(),
        Some(colour) => format!("colour_{}", colour.to_string().trim_start_matches('#')),
    };
    pieces.iter().map(name).collect()
}
