//! Rendered pictures compared with closed forms: coverage, light, shadows, lines, opacity; reproducibility.

mod common;

use common::{art, block, draw, run, shape, size, sphere, weave, weave_of};
use rayweave_math::Vec3;
use rayweave_model::{Collected, Evaluator, FirstHits, Query, Rays, RegionId, Solid, Window};
use rayweave_render::{
    Background, Camera, Image, Light, Lines, RenderError, RenderOptions, Rgba, Run, Size, Style, View, render,
};
use rayweave_trace::{Accelerated, RayDevice, Weave};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const UP: [f64; 3] = [0.0, 0.0, 1.0];
const BLACK: Rgba = Rgba::opaque(0, 0, 0);

/// No lines, one sample, flat: every pixel has the colour of the region at its centre.
fn plain(size: Size) -> RenderOptions {
    RenderOptions { samples: 1, style: Style::Flat, lines: None, ..RenderOptions::new(size) }
}

fn front(height: f64) -> Camera {
    Camera::orthographic([0.0, -20.0, 0.0], [0.0; 3], UP, height).unwrap()
}

fn letter(pixel: &[u8; 4]) -> char {
    match pixel {
        [255, 255, 255, 255] => '.',
        [0, 0, 0, 255] => '#',
        _ => 'o',
    }
}

/// Linear light of a level, according to the formula of IEC 61966-2-1.
fn light(level: u8) -> f64 {
    let level = f64::from(level) / 255.0;
    if level <= 0.04045 { level / 12.92 } else { ((level + 0.055) / 1.055).powf(2.4) }
}

/// The area of the square [x, x+1] x [y, y+1] inside a disc about the origin, by strips.
fn covered(x: f64, y: f64, radius: f64) -> f64 {
    let strips = 2000;
    let strip = |k: i32| {
        let at = x + (f64::from(k) + 0.5) / f64::from(strips);
        let half = (radius * radius - at * at).max(0.0).sqrt();
        ((y + 1.0).min(half) - y.max(-half)).max(0.0)
    };
    (0..strips).map(strip).sum::<f64>() / f64::from(strips)
}

#[test]
fn anti_aliasing_converges_to_the_covered_part() {
    let weave = weave(&sphere(7.3));
    for samples in [1, 2, 4, 8, 16] {
        let settings = RenderOptions { samples, colours: vec![BLACK], ..plain(size(20, 20)) };
        let image = draw(&weave, &front(20.0), &settings);
        let mut worst: f64 = 0.0;
        let mut sum = 0.0;
        for (k, pixel) in image.values().iter().enumerate() {
            let (x, y) = ((k % 20) as f64 - 10.0, (k / 20) as f64 - 10.0);
            let error = (1.0 - light(pixel[0])) - covered(x, y, 7.3);
            worst = worst.max(error.abs());
            sum += error;
        }
        // of n^2 samples, only those next to the circle, about n, can differ
        let n = f64::from(samples);
        assert!(worst <= 0.75 / n + 0.006, "{samples}: {worst}");
        assert!(sum.abs() / 400.0 < 0.02 / n + 0.001, "{samples}: {sum}");
    }
}

#[test]
fn headlight_shading_follows_the_cosine() {
    let weave = weave(&sphere(1.0));
    let settings =
        RenderOptions { style: Style::Headlight, colours: vec![Rgba::WHITE], ..plain(size(64, 64)) };
    let settings = RenderOptions { background: Background::Colour(BLACK), ..settings };
    let image = draw(&weave, &front(2.5), &settings);
    for (k, pixel) in image.values().iter().enumerate() {
        let ray = front(2.5).ray(size(64, 64), (k % 64) as f64 + 0.5, (k / 64) as f64 + 0.5);
        let r2 = ray.origin.x.powi(2) + ray.origin.z.powi(2);
        if r2 >= 1.0 {
            assert_eq!(*pixel, [0, 0, 0, 255]);
            continue;
        }
        // the ambient fraction is 0.18
        let expected = 0.18 + 0.82 * (1.0 - r2).sqrt();
        assert!((light(pixel[0]) - expected).abs() < 0.005, "{pixel:?} {expected}");
    }
}

/// Closed form of occlusion between a point and a light: whether it is hidden, and the distance from the
/// shadow boundary.
type Hides<'a> = &'a dyn Fn(Vec3) -> (bool, f64);

/// Compares the shadows on the plate z = 0 with a closed form, away from the shadow boundary.
fn check_shadows(weave: &Weave, light: Light, hides: Hides<'_>) {
    let camera = Camera::perspective([0.0, -3.0, 30.0], [0.0; 3], UP, 35.0).unwrap();
    let size = size(80, 80);
    let colours = vec![Rgba::WHITE, BLACK];
    let settings = RenderOptions { style: Style::Headlight, colours, shadows: true, ..plain(size) };
    let settings = RenderOptions { lights: vec![light], background: Background::Transparent, ..settings };
    let image = draw(weave, &camera, &settings);
    let (mut dark, mut bright) = (0, 0);
    for (k, pixel) in image.values().iter().enumerate() {
        let ray = camera.ray(size, (k % 80) as f64 + 0.5, (k / 80) as f64 + 0.5);
        let point = ray.at(-ray.origin.z / ray.direction.z);
        let sees_plate = pixel[3] == 255 && pixel[0] > 0;
        let (hidden, margin) = hides(point);
        if !sees_plate || margin < 1e-6 {
            continue;
        }
        // the ambient fraction is 0.18
        let is_dark = (self::light(pixel[0]) - 0.18).abs() < 0.005;
        assert_eq!(is_dark, hidden, "{point} {pixel:?}");
        dark += usize::from(is_dark);
        bright += usize::from(!is_dark);
    }
    assert!(dark > 50 && bright > 1000, "{dark} {bright}");
}

/// The distance of a point from the segment or ray that starts at `from` along `way`.
fn distance(point: Vec3, from: Vec3, way: Vec3, longest: f64) -> f64 {
    let t = ((point - from).dot(way) / way.length_squared()).clamp(0.0, longest);
    (from + t * way - point).length()
}

#[test]
fn a_sphere_casts_its_shadow() {
    let plate = block([-8.0, -8.0, -1.0], [8.0, 8.0, 0.0]);
    let centre = Vec3::new(1.0, 0.5, 3.0);
    let weave = weave_of(&[plate, sphere(1.5).translate(centre)]);
    let sun = Vec3::new(0.5, 0.3, -1.0);
    check_shadows(&weave, Light::along(sun), &|point| {
        let gap = distance(centre, point, -sun, f64::INFINITY) - 1.5;
        (gap < 0.0, gap.abs())
    });
    let lamp = Vec3::new(-2.0, -1.0, 9.0);
    check_shadows(&weave, Light::at(lamp), &|point| {
        let gap = distance(centre, point, lamp - point, 1.0) - 1.5;
        (gap < 0.0, gap.abs())
    });
    // a sphere beyond a light between plate and sphere casts no shadow
    let below = Vec3::new(1.0, 0.5, 1.2);
    let image = |lights| {
        let camera = Camera::perspective([0.0, -3.0, 30.0], [0.0; 3], UP, 35.0).unwrap();
        let settings =
            RenderOptions { style: Style::Headlight, lights, shadows: true, ..plain(size(40, 40)) };
        let without = RenderOptions { shadows: false, ..settings.clone() };
        (draw(&weave, &camera, &settings), draw(&weave, &camera, &without))
    };
    let (with, without) = image(vec![Light::at(below)]);
    assert_eq!(with, without);
}

#[test]
fn nothing_shades_itself() {
    // every surface that faces the light is lit, exactly as without shadows: at any size, far from the
    // origin, under any map
    let torus = shape("torus", &[("major", 1.0), ("minor", 0.45)]);
    for scale in [1e-8, 1.0, 1e8] {
        let convex = [
            sphere(1.0).scale(Vec3::splat(scale)),
            sphere(1.0).scale(Vec3::new(1.0, 0.3, 2.0) * scale).rotate_x(33.0),
            block([-1.0; 3], [1.0; 3]).scale(Vec3::splat(scale)).translate(Vec3::splat(900.0 * scale)),
            shape("cone", &[("radius1", 1.0), ("radius2", 0.2), ("height", 2.0)]).scale(Vec3::splat(scale)),
            // the outer half of the ring casts no shadow on itself from the side
            (&torus - shape("cylinder", &[("radius", 1.0)])).scale(Vec3::splat(scale)),
        ];
        for (k, solid) in convex.into_iter().enumerate() {
            let weave = weave(&solid);
            let camera = View::Iso.fit(weave.program(), size(90, 70));
            let along = camera.forward() + 0.3 * camera.right();
            let lights = vec![Light::along(if k == 4 { camera.forward() } else { along })];
            let settings =
                RenderOptions { style: Style::Headlight, lights, shadows: true, ..plain(size(90, 70)) };
            let without = RenderOptions { shadows: false, ..settings.clone() };
            let (with, without) = (draw(&weave, &camera, &settings), draw(&weave, &camera, &without));
            let differing = with.values().iter().zip(without.values()).filter(|(a, b)| a != b).count();
            assert_eq!(differing, 0, "solid {k} at scale {scale}");
        }
    }
}

#[test]
fn outlines_surround_the_visible_region() {
    let weave = weave(&block([-2.0, 0.0, -1.0], [2.0, 1.0, 1.0]));
    let lines = Some(Lines { width: 1.0, colour: BLACK, ..Lines::default() });
    let settings = RenderOptions { lines, colours: vec![Rgba::opaque(9, 200, 9)], ..plain(size(12, 8)) };
    let image = draw(&weave, &front(8.0), &settings);
    // one sample per pixel: a line of one pixel, on the upper or left side of the edge
    let expected = [
        "............",
        "............",
        "....####....",
        "...#ooo#....",
        "...#####....",
        "............",
        "............",
        "............",
    ];
    assert_eq!(art(&image, letter), expected);
}

/// The number of dark line pixels, without the outline of the whole.
fn inner_lines(weave: &Weave, camera: &Camera, colours: &[Rgba]) -> usize {
    let size = size(60, 60);
    let lines = Some(Lines { width: 1.0, colour: BLACK, ..Lines::default() });
    let settings = RenderOptions { lines, samples: 2, colours: colours.to_vec(), ..plain(size) };
    let image = draw(weave, camera, &settings);
    let dark = |x: usize, y: usize| image.get(x, y).is_some_and(|pixel| pixel[1] < 210);
    let is_inner = |x: usize, y: usize| {
        (-3..=3).all(|dx: isize| {
            (-3..=3).all(|dy: isize| {
                let at = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
                image.get(at.0, at.1).is_some_and(|pixel| *pixel != [255; 4])
            })
        })
    };
    (0..60 * 60).filter(|k| dark(k % 60, k / 60) && is_inner(k % 60, k / 60)).count()
}

#[test]
fn lines_mark_changes_of_region_depth_and_angle() {
    let green = [Rgba::opaque(0, 220, 0); 2];
    let (left, right) = (block([-2.0, 0.0, -2.0], [0.0, 1.0, 2.0]), block([0.0, 0.0, -2.0], [2.0, 1.0, 2.0]));
    let camera = front(5.0);
    // one region of two touching boxes: one face
    assert_eq!(inner_lines(&weave(&(&left | &right)), &camera, &green), 0);
    // two regions: a line between them
    let parts = inner_lines(&weave_of(&[left.clone(), right.clone()]), &camera, &green);
    assert!((35..=130).contains(&parts), "{parts}");
    // a step in depth between parallel faces
    let step = inner_lines(&weave(&(&left | right.translate([0.0, 0.3, 0.0]))), &camera, &green);
    assert!((35..=130).contains(&step), "{step}");
    // a fold: faces that meet at 160 degrees, 20 less than flat
    let wing = |degrees: f64| {
        let half = block([0.0, 0.0, -2.0], [2.0, 1.0, 2.0]).rotate_z(degrees);
        &half | half.mirror(Vec3::X)
    };
    assert!(inner_lines(&weave(&wing(10.0)), &camera, &green) > 35);
    // below the crease angle: no line
    assert_eq!(inner_lines(&weave(&wing(3.0)), &camera, &green), 0);
    // smooth surfaces have no lines, neither within nor where they touch tangentially
    assert_eq!(inner_lines(&weave(&sphere(2.2)), &camera, &green), 0);
    let rod = shape("cylinder", &[("radius", 1.6), ("height", 2.0)]);
    let end = |z: f64| sphere(1.6).translate([0.0, 0.0, z]);
    let pill = rod | end(1.0) | end(-1.0);
    assert_eq!(inner_lines(&weave(&pill), &front(6.0), &green), 0);
    // a ring that hides a part of itself: the same face twice, seen from slightly above
    let ring = weave(&shape("torus", &[("major", 1.5), ("minor", 0.6)]));
    let above = Camera::orthographic([0.0, -20.0, 8.0], [0.0; 3], UP, 4.5).unwrap();
    let hiding = inner_lines(&ring, &above, &green);
    assert!(hiding > 10, "{hiding}");
}

#[test]
fn light_passes_translucent_regions() {
    let glass = block([-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]);
    let wall = block([-2.0, 3.0, -2.0], [2.0, 4.0, 2.0]);
    let weave = weave_of(&[glass, wall]);
    let half = Rgba { red: 255, green: 0, blue: 0, alpha: 102 };
    let colours = vec![half, Rgba::opaque(0, 255, 0)];
    let settings = RenderOptions { colours, ..plain(size(5, 5)) };
    let image = draw(&weave, &front(5.0), &settings);
    // through both faces of the glass: 0.6 * 0.6 of the wall, the rest red
    let [red, green, blue, alpha] = *image.get(2, 2).unwrap();
    assert!((light(red) - 0.64).abs() < 0.005 && (light(green) - 0.36).abs() < 0.005);
    assert_eq!((blue, alpha), (0, 255));
    assert_eq!(image.get(0, 2), Some(&[0, 255, 0, 255]));

    let alone = weave_of(&[block([-1.0, 0.0, -1.0], [1.0, 1.0, 1.0])]);
    let settings = RenderOptions { background: Background::Transparent, ..settings };
    let image = draw(&alone, &front(5.0), &settings);
    assert_eq!(image.get(2, 2), Some(&[255, 0, 0, 163]));
    assert_eq!(image.get(0, 0), Some(&[0; 4]));
}

#[test]
fn lines_show_through_translucent_regions() {
    let glass = block([-2.0, 0.0, -2.0], [2.0, 1.0, 2.0]);
    let wall = block([-1.0, 3.0, -1.0], [1.0, 4.0, 1.0]);
    let weave = weave_of(&[glass, wall]);
    let lines = Some(Lines { width: 1.0, colour: BLACK, ..Lines::default() });
    let white = |alpha| Rgba { alpha, ..Rgba::WHITE };
    let darkest = |alpha| {
        let colours = vec![white(alpha), Rgba::WHITE];
        let settings = RenderOptions { lines, samples: 4, colours, ..plain(size(50, 50)) };
        let image = draw(&weave, &front(5.0), &settings);
        // all is white except lines; those of the wall are at least 5 pixels inside those of the glass
        let within = (0..2500).filter(|k| (10..40).contains(&(k % 50)) && (10..40).contains(&(k / 50)));
        within.map(|k| image.values()[k][0]).min().map_or(1.0, light)
    };
    // a line of one pixel covers half of two pixels, and three quarters of those in corners; two faces of the
    // glass are in front
    for (alpha, transparency) in [(0, 1.0), (102, 0.36), (204, 0.04), (255, 0.0)] {
        let expected = 1.0 - 0.75 * transparency;
        assert!((darkest(alpha) - expected).abs() < 0.01, "{alpha}: {}", darkest(alpha));
    }
}

#[test]
fn backgrounds() {
    let weave = weave(&Solid::empty());
    let (top, bottom) = (Rgba::opaque(255, 255, 255), Rgba::opaque(0, 0, 255));
    let settings =
        RenderOptions { background: Background::Gradient { top, bottom }, ..RenderOptions::new(size(3, 4)) };
    let image = draw(&weave, &front(1.0), &settings);
    for (y, row) in image.rows().enumerate() {
        let part = (y as f64 + 0.5) / 4.0;
        assert!(row.iter().all(|pixel| pixel[2] == 255 && (light(pixel[0]) - (1.0 - part)).abs() < 0.005));
    }
    let settings = RenderOptions { background: Background::Transparent, ..RenderOptions::new(size(3, 4)) };
    assert!(draw(&weave, &front(1.0), &settings).values().iter().all(|pixel| *pixel == [0; 4]));
}

/// A scene with all features: instances, a translucent region, shadows, lines.
fn busy() -> (Weave, RenderOptions) {
    let ball = sphere(1.3);
    let rod = shape("cylinder", &[("radius", 0.6), ("height", 4.0)]);
    let cube = block([-1.0; 3], [1.0; 3]);
    let classic = (&ball & &cube) - (&rod | rod.rotate_x(90.0) | rod.rotate_y(90.0));
    let spots: Vec<_> = (0..9).map(|k| Vec3::new(f64::from(k % 3), f64::from(k / 3), 0.0)).collect();
    let maps: Vec<_> = spots.into_iter().map(rayweave_math::Affine::translate).collect();
    let tiles = block([-0.5; 3], [0.5; 3]).place(maps).translate([-1.0, -1.0, -2.0]);
    let lamp = Light { intensity: 0.4, ..Light::at([4.0, -3.0, 2.0]) };
    let settings = RenderOptions {
        lights: vec![Light::along([-1.0, 2.0, -3.0]), lamp],
        shadows: true,
        colours: vec![Rgba { alpha: 120, ..Rgba::WHITE }],
        ..RenderOptions::new(size(97, 61))
    };
    (weave_of(&[classic, tiles]), settings)
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let (weave, settings) = busy();
    let camera = View::Iso.fit_perspective(weave.program(), settings.size, 30.0).unwrap();
    let pictures: Vec<Image> =
        (1..=4).map(|n| render(&weave, &camera, &settings, &mut run(n)).unwrap()).collect();
    assert!(pictures.iter().all(|picture| *picture == pictures[0]));
    let colours: std::collections::HashSet<_> = pictures[0].values().iter().collect();
    assert!(colours.len() > 300, "{}", colours.len());
}

#[test]
fn progress_rises_to_one_and_runs_can_be_stopped() {
    let (weave, settings) = busy();
    let camera = View::Front.fit(weave.program(), settings.size);
    let mut parts = Vec::new();
    let mut progress = |part| parts.push(part);
    let mut watched = Run { progress: Some(&mut progress), ..run(2) };
    render(&weave, &camera, &settings, &mut watched).unwrap();
    assert!(parts.windows(2).all(|pair| pair[0] <= pair[1]));
    assert!((parts[parts.len() - 1] - 1.0).abs() < 1e-12);
    for threads in [1, 3] {
        let stopped = run(threads);
        let cancel = stopped.cancel.clone();
        let mut calls = 0;
        let mut progress = |_| {
            calls += 1;
            if calls == 5 {
                cancel.cancel();
            }
        };
        let mut stopped = Run { progress: Some(&mut progress), ..stopped };
        assert_eq!(render(&weave, &camera, &settings, &mut stopped), Err(RenderError::Cancelled));
        assert_eq!(calls, 5);
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let weave = weave(&sphere(1.0));
    let refuse = |change: &dyn Fn(&mut RenderOptions)| {
        let mut settings = RenderOptions::new(size(4, 4));
        change(&mut settings);
        render(&weave, &front(3.0), &settings, &mut run(1)).unwrap_err().to_string()
    };
    assert!(refuse(&|s| s.samples = 0).contains("from 1 to 16"));
    assert!(refuse(&|s| s.samples = 17).contains("17 samples"));
    let lines = |width, crease_degrees| Some(Lines { width, crease_degrees, ..Lines::default() });
    assert!(refuse(&|s| s.lines = lines(f64::NAN, 10.0)).contains("width of lines is NaN"));
    assert!(refuse(&|s| s.lines = lines(1.0, 181.0)).contains("angle of creases is 181"));
    assert!(refuse(&|s| s.lights = vec![Light::at(UP), Light::along([0.0; 3])]).contains("light 1 has "));
    assert!(refuse(&|s| s.lights = vec![Light::at([f64::NAN; 3])]).contains("not finite"));
    let dim = Light { intensity: -1.0, ..Light::at(UP) };
    assert!(refuse(&|s| s.lights = vec![dim]).contains("intensity"));
    assert!(refuse(&|s| s.lights = vec![Light::at(UP); 33]).contains("number of lights is 33"));
    for (width, height) in [(0, 5), (5, 0), (32_769, 1)] {
        assert_eq!(Size::new(width, height), Err(RenderError::Size { width, height }));
    }
}

#[test]
fn pictures_of_one_pixel_and_one_row() {
    let weave = weave(&sphere(1.0));
    for (width, height) in [(1, 1), (301, 1), (1, 301)] {
        let settings = RenderOptions::new(size(width, height));
        let camera = View::Iso.fit(weave.program(), settings.size);
        let image = draw(&weave, &camera, &settings);
        assert!(image.values().iter().any(|pixel| *pixel != [255; 4]), "{width} x {height}");
    }
}

/// A device that prefers batches of a size, counts the rays, and answers no more queries after a number of them.
#[derive(Debug)]
struct Counting {
    weave: Weave,
    batch: usize,
    queries: AtomicUsize,
    most_queries: usize,
    rays: AtomicUsize,
}

impl Counting {
    fn answers(&self, rays: usize) -> bool {
        let answers = self.queries.fetch_add(1, Ordering::Relaxed) < self.most_queries;
        self.rays.fetch_add(if answers { rays } else { 0 }, Ordering::Relaxed);
        answers
    }
}

impl RayDevice for Counting {
    fn batch(&self) -> NonZeroUsize {
        NonZeroUsize::new(self.batch).unwrap()
    }

    fn nearest(&self, rays: Rays<'_>, window: Window, hits: &mut FirstHits<'_>) -> bool {
        let answers = self.answers(rays.len());
        if answers {
            self.weave.nearest(rays, window, &mut self.weave.scratch(), hits);
        }
        answers
    }

    fn crossings(&self, rays: Rays<'_>, query: &Query<'_>) -> Option<Collected> {
        self.answers(rays.len()).then(|| self.weave.collect(rays, query).unwrap())
    }

    fn regions_at(&self, _: [&[f64]; 3], _: &mut [RegionId]) -> bool {
        false
    }
}

/// Pictures do not depend on the size of tiles that a device prefers, nor on a device that fails.
#[test]
fn a_device_changes_no_pixel() {
    let solids = [sphere(7.3), block([-6.0, -9.0, -6.0], [2.0, 9.0, 1.0])];
    let camera = Camera::perspective([9.0, -30.0, 12.0], [0.0; 3], UP, 35.0).unwrap();
    let clear = vec![Rgba::opaque(200, 10, 10), Rgba { alpha: 90, ..BLACK }];
    for (shadows, colours) in [(false, Vec::new()), (true, Vec::new()), (false, clear)] {
        let lights = vec![Light::at([4.0, -30.0, 20.0])];
        let settings = RenderOptions { shadows, lights, colours, ..RenderOptions::new(size(61, 47)) };
        let weave = weave_of(&solids);
        let cpu = draw(&weave, &camera, &settings);
        for (batch, most_queries) in [(1, usize::MAX), (700, usize::MAX), (1 << 16, usize::MAX), (700, 3)] {
            let (queries, rays) = Default::default();
            let device = Arc::new(Counting { weave: weave.clone(), batch, queries, most_queries, rays });
            let program = Arc::new(weave.program().clone());
            let evaluator = Accelerated::new(program, device.clone());
            let picture = render(&evaluator, &camera, &settings, &mut run(2)).unwrap();
            assert!(picture == cpu, "{batch}, {most_queries}");
            let (queries, rays) =
                (device.queries.load(Ordering::Relaxed), device.rays.load(Ordering::Relaxed));
            match (batch, most_queries) {
                (_, 3) => assert!(rays > 0 && queries > 3, "{rays} rays of {queries} queries"),
                // all rays of the first pass at once, then those of the edges, each with its shadow rays
                (65536, _) => assert!(queries <= 6 && rays > 3000, "{rays} rays of {queries} queries"),
                _ => assert!(rays > 3000, "{rays} rays"),
            }
        }
    }
}
