//! Opaque scenes are rendered in columns with shadow rays from the lights, others layer by layer with rays to
//! the lights. A transparent speck that no ray hits switches the method and must not change a picture.

mod common;

use common::{block, run, shape, size, sphere};
use rayweave_conformance::{Model, Random, Style as Tricky};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Program, Region, Solid};
use rayweave_render::{
    Camera, IdKind, Image, Light, Lines, RenderOptions, Rgba, Style, View, depth, geometry, ids, normals,
    render,
};
use rayweave_trace::{Packets, Weave};
use std::sync::Arc;

/// The pictures of a solid by both methods.
fn both_ways(solid: &Solid, camera: &Camera, settings: &RenderOptions) -> [Image; 2] {
    // behind the camera, and too far away to cast a shadow on the model
    let speck = sphere(1e-3).translate(camera.position() - 9.0 * camera.forward());
    let regions = [("speck", speck), ("model", solid.clone())];
    let regions = regions.map(|(name, solid)| Region { name: name.to_owned(), solid, medium: 1 });
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let clear = Rgba { alpha: 100, ..Rgba::WHITE };
    [Rgba::WHITE, clear].map(|speck| {
        let settings = RenderOptions { colours: vec![speck, Rgba::opaque(200, 120, 40)], ..settings.clone() };
        render(&Weave::new(program.clone()), camera, &settings, &mut run(2)).unwrap()
    })
}

fn differing(images: &[Image; 2]) -> usize {
    let pairs = images[0].values().iter().zip(images[1].values());
    pairs.filter(|(a, b)| a != b).count()
}

fn lights() -> Vec<Light> {
    let lamp = Light::at(Vec3::new(4.0, -3.0, 6.0));
    vec![lamp, Light { intensity: 0.4, ..Light::along(Vec3::new(-0.4, -0.9, -0.5)) }]
}

fn lit(style: Style) -> RenderOptions {
    let plain = RenderOptions { samples: 1, style, lines: None, ..RenderOptions::new(size(90, 70)) };
    RenderOptions { lights: lights(), shadows: true, ..plain }
}

fn camera() -> Camera {
    Camera::perspective([5.0, -7.0, 5.0], [0.0; 3], Vec3::Z, 32.0).unwrap()
}

/// Grazed faces, hollows and faces hit twice by the light; copies; a light inside.
fn shapes() -> Vec<Solid> {
    let torus = shape("torus", &[("major", 1.2), ("minor", 0.5)]).rotate_x(50.0);
    let cone = shape("cone", &[("radius1", 1.2), ("radius2", 0.1), ("height", 2.0)]);
    let bowl = sphere(1.8) - sphere(1.6) - block([-2.0, -2.0, 0.4], [2.0, 2.0, 2.0]);
    let bore = shape("cylinder", &[("radius", 0.7)]);
    let cube = block([-1.0; 3], [1.0; 3]);
    let scaled = Affine::scale(Vec3::new(0.5, 0.6, 0.4));
    let places = [-1.5, 0.0, 1.5].map(|x| scaled.then(&Affine::translate(Vec3::new(x, -x, 0.3 * x))));
    let pieces = (&cube - &bore - bore.rotate_x(90.0)).place(places.to_vec());
    let crossed = Solid::symmetric_difference([cube.clone(), sphere(1.3), cone.rotate_y(70.0)]);
    let lamp_house = sphere(1.0).translate([4.0, -3.0, 6.0]) | &cube;
    vec![torus.clone(), cone, bowl, pieces, crossed, lamp_house, torus ^ cube]
}

#[test]
fn columns_and_layers_give_the_same_pictures() {
    for solid in shapes() {
        for style in [Style::Headlight, Style::Gooch, Style::Flat] {
            let pictures = both_ways(&solid, &camera(), &lit(style));
            assert_eq!(differing(&pictures), 0, "{solid}, {style:?}");
        }
        let refined = RenderOptions { samples: 2, lines: Some(Lines::default()), ..lit(Style::Headlight) };
        assert_eq!(differing(&both_ways(&solid, &camera(), &refined)), 0, "{solid}");
    }
}

/// Random trees with touching and intersecting faces. Where a shadow ray passes an edge of two faces within
/// rounding error, either answer is right, and a visible point may lie there.
#[test]
fn columns_and_layers_agree_for_tricky_models() {
    let mut rng = Random::new(11);
    let (mut pixels, mut differ) = (0, 0);
    for k in 0..24 {
        let style = [Tricky::Generic, Tricky::Grid, Tricky::Planes][k % 3];
        let model = Model::random(&mut rng, style);
        let solid = Solid::union(model.regions.iter().map(|region| region.solid.clone()));
        let settings = lit(Style::Headlight);
        let program = Program::compile(&solid).unwrap();
        let camera = View::Iso.fit_perspective(&program, settings.size, 35.0).unwrap();
        differ += differing(&both_ways(&solid, &camera, &settings));
        pixels += settings.size.count();
    }
    assert!(differ * 2000 <= pixels, "{differ} of {pixels}");
}

#[test]
fn models_without_end_cast_shadows_too() {
    let below = rayweave_shape::primitive::HalfSpace::new(Vec3::Z, -1.0).unwrap();
    let solid = Solid::from(rayweave_shape::primitive::Primitive::from(below)) | sphere(1.0);
    for light in lights() {
        let settings = RenderOptions { lights: vec![light], ..lit(Style::Headlight) };
        let pictures = both_ways(&solid, &camera(), &settings);
        assert_eq!(differing(&pictures), 0);
        // there is a shadow, besides the lit surfaces
        let dark = RenderOptions { shadows: false, ..settings };
        assert_ne!(pictures[0], both_ways(&solid, &camera(), &dark)[0]);
    }
}

#[test]
fn one_pass_gives_what_three_give() {
    let solid = Solid::union(shapes().into_iter().take(5));
    let program = Arc::new(Program::compile(&solid).unwrap());
    let (packets, weave) = (Packets::new(program.clone()), Weave::new(program.clone()));
    let size = size(120, 77);
    let camera = View::Iso.fit(&program, size);
    for kind in [IdKind::Region, IdKind::Leaf, IdKind::Face, IdKind::Placement] {
        let all = geometry(&packets, &camera, size, kind, &mut run(2)).unwrap();
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let apart = depth(&weave, &camera, size, &mut run(1)).unwrap();
        assert_eq!(bits(all.depth.values()), bits(apart.values()));
        let apart = normals(&weave, &camera, size, &mut run(1)).unwrap();
        assert_eq!(bits(all.normals.values().as_flattened()), bits(apart.values().as_flattened()));
        assert_eq!(all.ids, ids(&weave, &camera, size, kind, &mut run(1)).unwrap());
        assert!(all.depth.values().iter().filter(|t| t.is_finite()).count() > 500);
    }
}
