//! Camera and settings of pictures of scenes, from model files and options.

use rayweave_draw::picture::{
    CutAway, Picture, PictureKind, PictureOptions, PictureSheet, SheetKind, WholeModel, arrange,
};
use rayweave_error::{Classified, ErrorKind};
use rayweave_math::Vec3;
use rayweave_render::{
    Background, Camera, LightKind, PALETTE, Projection, RenderOptions, Rgba, Run, Size, Style, View,
};
use rayweave_scene::{Compiled, Scene, parse};
use rayweave_trace::AnyEvaluator;

const TWO: &str = r##"
rayweave = 1
[solid.core]
sphere = { radius = 1 }
[solid.shell]
sphere = { radius = 2 }
[solid.other]
box = { size = 1 }
[[region]]
solid = "shell"
medium = "water"
colour = "#010203"
[[region]]
solid = "core"
colour = "#040506"
[medium.water]
index = 1.33
"##;

fn scene(more: &str) -> Scene {
    parse(&format!("{TWO}{more}")).unwrap().1
}

fn arranged(scene: &Scene, options: &PictureOptions) -> (Camera, RenderOptions) {
    arrange(scene, &Compiled::new(scene).unwrap(), options).unwrap()
}

#[test]
fn options_override_the_file() {
    let said = scene(
        "[camera]\nposition = [9, 0, 0]\nfov = 20\nsize = [40, 30]\n[render]\nshading = \"headlight\"\nedges = false\n\
         samples = 2\nbackground = \"#070809\"\n[[light]]\nposition = [5, 5, 5]\nintensity = 0.5\n",
    );
    let (camera, settings) = arranged(&said, &PictureOptions::default());
    assert_eq!(camera.position(), Vec3::new(9.0, 0.0, 0.0));
    assert_eq!(camera.projection(), Projection::Perspective { field_of_view: 20.0 });
    assert_eq!(settings.size, Size::new(40, 30).unwrap());
    assert_eq!((settings.style, settings.samples), (Style::Headlight, 2));
    assert!(settings.lines.is_none());
    assert_eq!(settings.background, Background::Colour(Rgba::opaque(7, 8, 9)));
    assert_eq!(settings.colours, [Rgba::opaque(1, 2, 3), Rgba::opaque(4, 5, 6)]);
    assert_eq!(settings.lights[0].kind, LightKind::Position(Vec3::splat(5.0)));
    assert_eq!((settings.lights[0].intensity, settings.shadows), (0.5, false));
    let options = PictureOptions {
        size: Some(Size::new(50, 50).unwrap()),
        view: Some(View::Top),
        style: Some(Style::Flat),
        edges: Some(true),
        samples: Some(1),
        ..PictureOptions::default()
    };
    let (camera, settings) = arranged(&said, &options);
    assert_eq!(camera.forward(), Vec3::NEG_Z);
    // the ball of radius 2 with a margin of 4 % on both sides
    assert_eq!(camera.projection(), Projection::Orthographic { height: 4.0 / 0.92 });
    assert_eq!((settings.size, settings.style, settings.samples), (options.size.unwrap(), Style::Flat, 1));
    assert!(settings.lines.is_some());
    let wide = PictureOptions { field_of_view: Some(60.0), ..options };
    let (camera, _) = arranged(&said, &wide);
    assert_eq!(camera.projection(), Projection::Perspective { field_of_view: 60.0 });
}

#[test]
fn shadows_need_a_light() {
    let with = PictureOptions { shadows: Some(true), ..PictureOptions::default() };
    let (camera, settings) = arranged(&scene(""), &with);
    let [light] = &settings.lights[..] else { panic!("{:?}", settings.lights) };
    let LightKind::Direction(along) = light.kind else { panic!("{light:?}") };
    // from behind, from the left, from above
    assert!(along.dot(camera.forward()) > 0.0 && along.dot(camera.right()) > 0.0);
    assert!(along.dot(camera.up()) < 0.0);
    assert!(arranged(&scene(""), &PictureOptions::default()).1.lights.is_empty());
}

#[test]
fn a_solid_alone_keeps_its_colour() {
    let scene = scene("");
    let colours = |name| {
        let compiled = Compiled::solid(&scene, name).unwrap();
        arrange(&scene, &compiled, &PictureOptions::default()).unwrap().1.colours
    };
    assert_eq!(colours("core"), [Rgba::opaque(4, 5, 6)]);
    assert_eq!(colours("shell"), [Rgba::opaque(1, 2, 3)]);
    assert_eq!(colours("other"), [PALETTE[0]]);
}

#[test]
fn kinds_of_pictures_have_names() {
    for (kind, name) in PictureKind::ALL {
        assert_eq!(name.parse::<PictureKind>().unwrap(), kind);
    }
    assert!("color".parse::<PictureKind>().unwrap_err().to_string().contains("Did you mean `colour`?"));
    let scene = scene("");
    let compiled = Compiled::new(&scene).unwrap();
    let options = PictureOptions {
        size: Some(Size::new(9, 9).unwrap()),
        view: Some(View::Front),
        ..PictureOptions::default()
    };
    let (camera, settings) = arrange(&scene, &compiled, &options).unwrap();
    let evaluator = AnyEvaluator::new(None, compiled.program.clone()).unwrap();
    let mut run = Run::default();
    let Picture::Depth(depth) =
        Picture::draw(PictureKind::Depth, &evaluator, &camera, &settings, &mut run).unwrap()
    else {
        panic!("no depth");
    };
    // the centre of the picture shows the centre of the ball, of radius 2
    let expected = camera.position().length() - 2.0;
    assert!((depth.get(4, 4).unwrap() - expected).abs() < 1e-12);
    run.cancel.cancel();
    let cancelled = Picture::draw(PictureKind::Colour, &evaluator, &camera, &settings, &mut run);
    assert_eq!(cancelled.unwrap_err().kind(), ErrorKind::Cancelled);
}

/// The cut scene, compiled, and the evaluators of the cut and of the whole scene.
fn cut_open(scene: &Scene, cut: &CutAway) -> (Scene, Compiled, [AnyEvaluator; 2]) {
    let open = cut.apply(scene).unwrap();
    let compiled = Compiled::new(&open).unwrap();
    let programs = [compiled.program.clone(), Compiled::new(scene).unwrap().program];
    let evaluators = programs.map(|program| AnyEvaluator::new(None, program).unwrap());
    (open, compiled, evaluators)
}

/// Only the views that look onto a cut face are cut: a ball in a box is visible from the right, where x > 50 % is removed, and from
/// the upper right, and hidden in the other views.
#[test]
fn sheets_cut_only_the_views_onto_the_cut_face() {
    let text = "rayweave = 1\n[solid.shell]\nbox = { size = 4 }\n[solid.ball]\nsphere = { radius = 1.5 }\n\
         [[region]]\nsolid = \"shell\"\nmedium = \"steel\"\n[[region]]\nsolid = \"ball\"\nmedium = \"gold\"\n\
         [medium.steel]\ncolour = \"#0000ff\"\n[medium.gold]\ncolour = \"#ff0000\"";
    let (_, scene) = rayweave_scene::parse(text).unwrap();
    let cut: CutAway = "x>50%".parse().unwrap();
    let (open, compiled, [evaluator, whole]) = cut_open(&scene, &cut);
    let options = PictureOptions {
        size: Some(Size::new(320, 240).unwrap()),
        style: Some(Style::Flat),
        ..PictureOptions::default()
    };
    let whole = WholeModel { cut: &cut, evaluator: &whole };
    let run = &mut Run::default();
    let sheet =
        PictureSheet::draw_cut(SheetKind::Views, &open, &compiled, &evaluator, whole, &options, run).unwrap();
    let is_red = |pixel: &[u8; 4]| pixel[0] > 200 && pixel[2] < 60;
    let shows_ball: Vec<bool> =
        sheet.pictures().iter().map(|picture| picture.image.values().iter().any(is_red)).collect();
    // from above, from the upper right, from the front, from the right
    assert_eq!(shows_ball, [false, true, false, true]);
    let svg = sheet.to_svg("box");
    assert!(svg.contains(">right, cut</text>") && svg.contains(">top</text>"), "{}", &svg[..400]);
}

/// No view of a sheet is from behind: a cut of the part there is made in all views, as in a sheet of the cut model.
#[test]
fn sheets_show_a_cut_that_no_view_looks_onto() {
    let text = "rayweave = 1\n[solid.box]\nbox = { size = 4 }\n[[region]]\nsolid = \"box\"\nmedium = \"m\"\n[medium.m]";
    let (_, scene) = rayweave_scene::parse(text).unwrap();
    let cut: CutAway = "y>50%".parse().unwrap();
    let (open, compiled, [evaluator, whole]) = cut_open(&scene, &cut);
    let options = PictureOptions { size: Some(Size::new(320, 240).unwrap()), ..PictureOptions::default() };
    let (kind, run) = (SheetKind::Views, &mut Run::default());
    let whole = WholeModel { cut: &cut, evaluator: &whole };
    let sheet = PictureSheet::draw_cut(kind, &open, &compiled, &evaluator, whole, &options, run).unwrap();
    let expected = PictureSheet::draw(kind, &open, &compiled, &evaluator, &options, run).unwrap();
    let images = |sheet: &PictureSheet| -> Vec<Vec<[u8; 4]>> {
        sheet.pictures().iter().map(|picture| picture.image.values().to_vec()).collect()
    };
    assert!(images(&sheet) == images(&expected));
}
