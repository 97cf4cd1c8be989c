//! Times in double precision on devices that have it: the tables of surfaces and maps with the numbers of the CPU.

use crate::codes::{CYLINDER, OTHER, PLANE, SPHERE};
use crate::frame::Sender;
use crate::layout::Layout;
use rayweave_model::{PlacementId, Program};
use rayweave_shape::surface::Surface;
use std::collections::HashMap;

/// The tables for times in double precision.
#[derive(Clone, Debug, Default)]
pub(crate) struct Doubles {
    /// The centre and the scale of the frame and the magnitude of the model, then surfaces and maps.
    pub exact: Vec<f64>,
    /// A row per facet: kind, first number of the surface, first number of the maps, number of maps. Then a row per item: first
    /// number of the maps, number of maps.
    pub lookup: Vec<[u32; 4]>,
    /// The row of the first item, if items have maps.
    pub items: Option<u32>,
}

impl Doubles {
    /// The tables of a program.
    pub fn new(program: &Program, layout: &Layout, sender: &Sender) -> Doubles {
        let mut doubles = Doubles::default();
        let frame = sender.frame;
        doubles.exact.extend(frame.centre.to_array());
        doubles.exact.extend([frame.scale, sender.magnitude]);
        let surfaces: Vec<(u32, u32)> =
            program.surfaces().iter().map(|entry| doubles.surface(&entry.surface)).collect();
        let mut known = HashMap::new();
        for face in &layout.faces {
            let (kind, surface) = surfaces[face.surface.0 as usize];
            // the maps of a solid within a placed one depend on the item
            let kind = if layout.placed_items && face.placement.0 != 0 { OTHER } else { kind };
            let [maps, count] = doubles.maps(program, face.placement, &mut known);
            doubles.lookup.push([kind, surface, maps, count]);
        }
        if layout.placed_items {
            doubles.items = Some(doubles.lookup.len() as u32);
            for &placement in &layout.placements {
                let [maps, count] = doubles.maps(program, PlacementId(placement), &mut known);
                doubles.lookup.push([maps, count, 0, 0]);
            }
        }
        doubles
    }

    /// Adds the numbers of a surface; returns its kind and the first of them.
    fn surface(&mut self, surface: &Surface) -> (u32, u32) {
        let at = self.exact.len() as u32;
        let kind = match surface {
            Surface::Plane(s) => {
                self.exact.extend(s.normal.to_array());
                self.exact.push(s.offset);
                PLANE
            }
            Surface::Sphere(s) => {
                self.exact.extend(s.centre.to_array());
                self.exact.push(s.radius * s.radius);
                SPHERE
            }
            Surface::Cylinder(s) => {
                self.exact.extend(s.point.to_array());
                self.exact.extend(s.axis.to_array());
                self.exact.push(s.radius * s.radius);
                CYLINDER
            }
            _ => OTHER,
        };
        (kind, at)
    }

    /// The maps that lead into the frame of a placement, outermost first: the first number and how many there are.
    fn maps(
        &mut self,
        program: &Program,
        placement: PlacementId,
        known: &mut HashMap<u32, [u32; 2]>,
    ) -> [u32; 2] {
        if placement.0 == 0 {
            return [0, 0];
        }
        *known.entry(placement.0).or_insert_with(|| {
            let at = self.exact.len() as u32;
            for place in program.descend(placement) {
                let map = place.local_from_world;
                let columns = [map.linear.x_axis, map.linear.y_axis, map.linear.z_axis, map.translation];
                columns.iter().for_each(|column| self.exact.extend(column.to_array()));
            }
            [at, (self.exact.len() as u32 - at) / 12]
        })
    }
}
