//! Meshes of several regions that touch along curved faces, in formats without regions.

use rayweave_formats::{Format, WriteOptions, Written, write};
use rayweave_mesh::Mesh;
use rayweave_mesh_io::{MeshFormat, ReadOptions, read_bytes};
use rayweave_scene::Scene;
use std::f64::consts::PI;

fn scene(text: &str) -> Scene {
    rayweave_scene::parse(&format!("rayweave = 1\n{text}")).unwrap_or_else(|e| panic!("{text}: {e:?}")).1
}

fn file(scene: &Scene, format: MeshFormat, tolerance: f64) -> (Written, Mesh) {
    let options = WriteOptions { tolerance: Some(tolerance), ..WriteOptions::default() };
    let file =
        write(scene, None, Format::Mesh(format), &options).unwrap_or_else(|e| panic!("{tolerance}: {e}"));
    let mesh = read_bytes(&file.bytes, format, &ReadOptions::default()).unwrap().mesh;
    (file, mesh)
}

const TOLERANCES: [f64; 9] = [0.1, 0.06, 0.05, 0.04, 0.03, 0.025, 0.02, 0.015, 0.005];

/// A rod in a ring on a cap: circles of one radius have different facets in parts of different size.
#[test]
fn parts_about_one_axis_become_one_shell() {
    for turn in ["", "transform = [{ rotate_x = -90 }, { translate = [1, 2, 3] }]"] {
        let scene = scene(&format!(
            "[solid.ring]
tube = {{ outer_radius = 11, inner_radius = 4, height = 7 }}
{turn}
[solid.cap]
expr = 'flange'
{turn}
[solid.flange]
tube = {{ outer_radius = 14, inner_radius = 9, height = 5 }}
transform = {{ translate = [0, 0, -6] }}
[solid.rod]
cylinder = {{ radius = 4, height = 60 }}
{turn}
[[region]]
solid = 'cap'
[[region]]
solid = 'ring'
[[region]]
solid = 'rod'
"
        ));
        let volume = PI * ((121.0 - 16.0) * 7.0 + (196.0 - 81.0) * 5.0 + 16.0 * 60.0);
        for tolerance in TOLERANCES {
            for format in [MeshFormat::Ply, MeshFormat::Stl] {
                let (_, mesh) = file(&scene, format, tolerance);
                let found = mesh.diagnose();
                assert!(found.is_sound() && found.components.len() == 1, "{tolerance} {format:?}: {found}");
                let error = (mesh.volume() - volume).abs();
                assert!(error <= tolerance * mesh.area(), "{tolerance}: {} {volume}", mesh.volume());
            }
        }
    }
}

/// A bearing in a block whose seat is the arc of an outline: no common profile.
#[test]
fn regions_that_touch_are_written_at_any_tolerance() {
    let scene = scene(
        "[solid.base]
box_from_corners = { lo = [-30, -10, 0], hi = [30, 10, 36] }
[solid.hole.revolve]
outline = [[0, -1], [12.5, -1], [11, 0.5], [11, 7], [9, 7], [9, 30], [0, 30]]
[solid.hollow]
expr = 'hole'
transform = [{ rotate_x = -90 }, { translate = [0, -10, 18] }]
[solid.block]
expr = 'base - hollow'
[solid.ring]
tube = { outer_radius = 11, inner_radius = 4, height = 7 }
transform = [{ rotate_x = 90 }, { translate = [0, -6.5, 18] }]
[solid.rod]
cylinder = { radius = 4, height = 60 }
transform = [{ rotate_x = 90 }, { translate = [0, 0, 18] }]
[[region]]
solid = 'block'
[[region]]
solid = 'ring'
[[region]]
solid = 'rod'
",
    );
    // the chamfer is a frustum of height 1.5 outside, of which the part below y = -10 is cut off
    let frustum = PI / 3.0 * 0.5 * (144.0 + 12.0 * 11.0 + 121.0);
    let bore = frustum + PI * (121.0 * 6.5 + 81.0 * 13.0);
    let volume = 60.0 * 20.0 * 36.0 - bore + PI * ((121.0 - 16.0) * 7.0 + 16.0 * 60.0);
    for tolerance in TOLERANCES {
        let (file, mesh) = file(&scene, MeshFormat::Ply, tolerance);
        let found = mesh.diagnose();
        let remarks: Vec<&str> = file.remarks.iter().map(|remark| remark.what.as_str()).collect();
        println!("{tolerance}: {found}; {remarks:?}");
        let is_divided = remarks.iter().any(|what| what.contains("each region is a closed shell of its own"));
        assert_ne!(found.is_sound(), is_divided, "{tolerance}: {found}");
        assert!(
            found.open_edges == 0 && (!is_divided || found.components.len() == 3),
            "{tolerance}: {found}"
        );
        let error = (mesh.volume() - volume).abs();
        assert!(error <= tolerance * mesh.area(), "{tolerance}: {} {volume}", mesh.volume());
    }
}
