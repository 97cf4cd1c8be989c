//! From the tree of a dump to a scene: every item after its children, without using the call stack for depth.

use super::arguments::{Arguments, Refusal};
use super::boolean::{Operation, join_solids};
use super::part::{Part, Piece};
use super::syntax::{Node, Tree};
use super::{primitive, transform};
use crate::{LossKind, Options, Report};
use rayweave_scene::{
    Colour, Diagnostic, Diagnostics, Medium, RenderSettings, Scene, SceneRegion, Source, Unit,
};
use std::sync::Arc;

pub(super) struct Reader<'a> {
    source: &'a Arc<Source>,
    options: &'a Options,
    tree: &'a Tree,
    /// What each node stands for, as far as it has been found out and not been used.
    parts: Vec<Part>,
    report: Report,
}

impl<'a> Reader<'a> {
    pub fn new(source: &'a Arc<Source>, options: &'a Options, tree: &'a Tree) -> Reader<'a> {
        let parts = vec![Part::Empty; tree.nodes.len()];
        Reader { source, options, tree, parts, report: Report::default() }
    }

    /// The scene of all items: a region for each colour.
    pub fn scene(mut self) -> (Scene, Report) {
        let mut live = self.live();
        let root = self.tree.nodes.iter().zip(&live).position(|(node, live)| node.modifiers.root && *live);
        self.keep_below(root.unwrap_or(0), &mut live);
        // children have greater numbers than their parents
        for number in (0..self.tree.nodes.len()).rev().filter(|number| live[*number]) {
            self.parts[number] = self.part(&self.tree.nodes[number]);
        }
        let part = std::mem::replace(&mut self.parts[root.unwrap_or(0)], Part::Empty);
        let pieces = match part {
            Part::Solid(pieces) => pieces,
            Part::Empty | Part::Refused => Vec::new(),
        };
        if pieces.is_empty() {
            let nothing = Diagnostic::warning("the model is empty").why("no item of it has a volume");
            self.report.add(LossKind::Dropped, "model", nothing.in_file(self.source));
        }
        (scene(pieces), self.report)
    }

    /// Which nodes are there at all: not those below a `*` or a `%`.
    fn live(&mut self) -> Vec<bool> {
        let mut live = vec![true; self.tree.nodes.len()];
        for (number, node) in self.tree.nodes.iter().enumerate() {
            let modifiers = node.modifiers;
            let is_shadow = modifiers.background && !modifiers.root;
            if live[number] && is_shadow && !modifiers.disabled {
                let why = Diagnostic::warning("an item in the background is left out")
                    .why("% shows it in previews only");
                self.report.add(LossKind::Dropped, &node.name, why.at(self.source, node.span));
            }
            live[number] &= !modifiers.disabled && !is_shadow;
            if !live[number] {
                node.children.iter().for_each(|child| live[*child as usize] = false);
            }
        }
        live
    }

    /// Leaves only what stands below a node.
    fn keep_below(&self, root: usize, live: &mut [bool]) {
        let mut below = vec![false; live.len()];
        below[root] = true;
        for (number, node) in self.tree.nodes.iter().enumerate() {
            live[number] &= below[number];
            node.children.iter().for_each(|child| below[*child as usize] |= below[number]);
        }
    }

    fn part(&mut self, node: &Node) -> Part {
        match self.read(node) {
            Ok(part) => part,
            Err(why) => {
                self.report.add(LossKind::Refused, &format!("{}()", node.name), *why);
                Part::Refused
            }
        }
    }

    fn read(&mut self, node: &Node) -> Result<Part, Refusal> {
        let arguments = Arguments::new(self.source, node);
        let facets = self.options.facets;
        match node.name.as_str() {
            "group" | "union" | "render" => self.joined(node, Operation::Union),
            "difference" => self.joined(node, Operation::Difference),
            "intersection" => self.joined(node, Operation::Intersection),
            "multmatrix" => self.transformed(node, &arguments),
            "color" => {
                let part = self.joined(node, Operation::Union)?;
                Ok(match transform::colour(&arguments)? {
                    Some(colour) => transform::coloured(part, colour),
                    None => part,
                })
            }
            "cube" => primitive::cube(&arguments),
            "sphere" => primitive::sphere(&arguments, facets),
            "cylinder" => primitive::cylinder(&arguments, facets),
            _ => Err(arguments.refusal("items of this name cannot be read")),
        }
    }

    /// The children, joined.
    fn joined(&mut self, node: &Node, operation: Operation) -> Result<Part, Refusal> {
        let mut solids = Vec::with_capacity(node.children.len());
        for (position, child) in node.children.iter().enumerate() {
            match (std::mem::replace(&mut self.parts[*child as usize], Part::Empty), operation) {
                // what the others are taken from, or would be
                (Part::Refused, Operation::Difference) if position == 0 => return Ok(Part::Refused),
                (Part::Empty, Operation::Difference) if position == 0 => return Ok(Part::Empty),
                (Part::Empty, Operation::Intersection) => return Ok(Part::Empty),
                (Part::Refused | Part::Empty, _) => {}
                (Part::Solid(pieces), _) => solids.push(pieces),
            }
        }
        Ok(join_solids(operation, solids))
    }

    fn transformed(&mut self, node: &Node, arguments: &Arguments) -> Result<Part, Refusal> {
        let map = transform::matrix(arguments)?;
        let part = self.joined(node, Operation::Union)?;
        if map.inverse().is_err() && matches!(part, Part::Solid(_)) {
            let why = arguments.approximation("leaves nothing (its matrix has no inverse: a scale of 0?)");
            self.report.add(LossKind::Dropped, "multmatrix()", why);
            return Ok(Part::Empty);
        }
        Ok(transform::transformed(part, &map))
    }
}

/// A scene of pieces: a region for each, of a medium of its own.
fn scene(pieces: Vec<Piece>) -> Scene {
    let names = names(&pieces);
    let mut media = vec![Medium { name: "world".to_owned(), ..Medium::default() }];
    let mut regions = Vec::new();
    for (number, (piece, name)) in pieces.into_iter().zip(names).enumerate() {
        media.push(Medium { name: name.clone(), ..Medium::default() });
        let palette = Colour::PALETTE[number % Colour::PALETTE.len()];
        let (medium, colour) = (number as u32 + 1, piece.colour.unwrap_or(palette));
        // as it is read back from a native file
        let solid = piece.solid.named(&name);
        regions.push(SceneRegion { name, solid, medium, colour });
    }
    let solids = regions.iter().map(|region| (region.name.clone(), region.solid.clone())).collect();
    Scene {
        // a dump does not say its unit; those who print take it for this one
        unit: Unit::Millimetre,
        parameters: Vec::new(),
        solids,
        regions,
        media,
        camera: None,
        lights: Vec::new(),
        render: RenderSettings::default(),
        warnings: Diagnostics::default(),
    }
}

/// `model` for the piece without a colour, the colour for others.
fn names(pieces: &[Piece]) -> Vec<String> {
    let name = |piece: &Piece| match piece.colour {
        None => "model".to_owned(),
        Some(colour) => format!("colour_{}", colour.to_string().trim_start_matches('#')),
    };
    pieces.iter().map(name).collect()
}
