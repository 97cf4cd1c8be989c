//! Depth, normals and ids, compared with closed forms and with expected pictures in letters.

mod common;

use common::{art, block, run, shape, size, sphere, weave, weave_of};
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Solid};
use rayweave_render::{Camera, IdKind, View, depth, ids, normals, section};

const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// The least t > 0 at which a unit ray intersects a sphere, by the textbook formula.
fn sphere_time(origin: Vec3, direction: Vec3, centre: Vec3, radius: f64) -> Option<f64> {
    let offset = origin - centre;
    let half = offset.dot(direction);
    let discriminant = half * half - (offset.length_squared() - radius * radius);
    let root = (discriminant > 0.0).then(|| discriminant.sqrt())?;
    [-half - root, -half + root].into_iter().find(|&t| t > 0.0)
}

#[test]
fn depth_and_normals_of_a_sphere() {
    let (centre, radius) = (Vec3::new(0.3, 0.2, -0.1), 1.5);
    let weave = weave(&sphere(radius).translate(centre));
    let size = size(41, 31);
    let cameras = [
        Camera::perspective([4.0, -5.0, 3.0], [0.0; 3], UP, 40.0).unwrap(),
        Camera::orthographic([4.0, -5.0, 3.0], [0.0; 3], UP, 3.5).unwrap(),
        // from inside
        Camera::perspective([0.5, 0.5, 0.0], [0.0; 3], UP, 100.0).unwrap(),
    ];
    for (camera, least) in cameras.into_iter().zip([250, 500, 41 * 31]) {
        let t = depth(&weave, &camera, size, &mut run(2)).unwrap();
        let n = normals(&weave, &camera, size, &mut run(2)).unwrap();
        let mut hits = 0;
        for y in 0..31 {
            for x in 0..41 {
                let ray = camera.ray(size, x as f64 + 0.5, y as f64 + 0.5);
                let (t, n) = (*t.get(x, y).unwrap(), Vec3::from_array(*n.get(x, y).unwrap()));
                match sphere_time(ray.origin, ray.direction, centre, radius) {
                    Some(expected) => {
                        assert!((t - expected).abs() < 1e-12, "{t} {expected}");
                        // the normal is outward also when seen from inside
                        let outward = (ray.at(t) - centre) / radius;
                        assert!((n - outward).length() < 1e-12, "{n} {outward}");
                        hits += 1;
                    }
                    None => assert!(t == f64::INFINITY && n.is_nan_mask().all()),
                }
            }
        }
        assert!(hits >= least, "{hits}");
    }
}

#[test]
fn regions_leaves_and_faces_of_boxes() {
    let low = block([0.0, 0.0, 0.0], [4.0, 1.0, 2.0]).named("low");
    let tall = block([1.0, -1.0, 0.0], [2.0, 0.5, 4.0]).named("tall");
    let weave = weave_of(&[low, tall]);
    let camera = Camera::orthographic([2.0, -9.0, 2.0], [2.0, 0.0, 2.0], UP, 6.0).unwrap();
    let front = ids(&weave, &camera, size(12, 12), IdKind::Region, &mut run(1)).unwrap();
    let letters = art(&front, |id| if *id == 0 { '.' } else { char::from(b'0' + *id as u8) });
    let expected = [
        "............",
        "............",
        "....22......",
        "....22......",
        "....22......",
        "....22......",
        "..11221111..",
        "..11221111..",
        "..11221111..",
        "..11221111..",
        "............",
        "............",
    ];
    assert_eq!(letters, expected);
    let leaves = ids(&weave, &camera, size(12, 12), IdKind::Leaf, &mut run(1)).unwrap();
    let letters = art(&leaves, |id| if *id < 0 { '.' } else { char::from(b'a' + *id as u8) });
    assert_eq!(letters[6], "..aabbaaaa..");
    let faces = ids(&weave, &camera, size(12, 12), IdKind::Face, &mut run(1)).unwrap();
    let name = |x, y| {
        let face = usize::try_from(*faces.get(x, y).unwrap()).ok()?;
        Some(weave.program().face_name(face as u32))
    };
    assert_eq!(name(0, 0), None);
    assert_eq!(name(2, 8).unwrap(), "low.y-");
    assert_eq!(name(4, 8).unwrap(), "tall.y-");
    let placements = ids(&weave, &camera, size(12, 12), IdKind::Placement, &mut run(1)).unwrap();
    assert_eq!([placements.get(0, 0), placements.get(4, 8)], [Some(&-1), Some(&0)]);
}

#[test]
fn views_show_their_sides() {
    // an L that looks different from all sides; # is the nearest part, + is farther away
    let weave = weave(&(block([0.0; 3], [3.0, 2.0, 1.0]) | block([0.0; 3], [1.0, 1.0, 3.0])));
    let look = |view: View| {
        let camera = view.fit(weave.program(), size(8, 8));
        let plane = depth(&weave, &camera, size(8, 8), &mut run(1)).unwrap();
        let nearest = plane.values().iter().copied().fold(f64::INFINITY, f64::min);
        art(&plane, |t| match *t {
            t if t == f64::INFINITY => '.',
            t if t < nearest + 0.5 => '#',
            _ => '+',
        })
    };
    let rows = |counts: &[(usize, &str)]| -> Vec<String> {
        counts.iter().flat_map(|&(n, row)| vec![row.to_owned(); n]).collect()
    };
    assert_eq!(look(View::Front), rows(&[(5, "###....."), (3, "########")]));
    assert_eq!(look(View::Back), rows(&[(5, ".....+++"), (3, "########")]));
    assert_eq!(look(View::Left), rows(&[(5, "....##.."), (3, "..####..")]));
    assert_eq!(look(View::Right), rows(&[(5, "..++...."), (3, "..####..")]));
    let (none, flat) = (".".repeat(8), "+".repeat(8));
    assert_eq!(look(View::Top), rows(&[(2, &none), (2, &flat), (2, "###+++++"), (2, &none)]));
    assert_eq!(look(View::Bottom), rows(&[(2, &none), (4, "########"), (2, &none)]));
}

#[test]
fn nothing_and_everything() {
    let camera = Camera::perspective([0.0, -5.0, 0.0], [0.0; 3], UP, 40.0).unwrap();
    for solid in [Solid::empty(), Solid::universe(), sphere(1.0) - sphere(2.0)] {
        let weave = weave(&solid);
        let t = depth(&weave, &camera, size(5, 4), &mut run(1)).unwrap();
        assert!(t.values().iter().all(|t| *t == f64::INFINITY));
        let id = ids(&weave, &camera, size(5, 4), IdKind::Region, &mut run(1)).unwrap();
        assert!(id.values().iter().all(|id| *id == 0));
    }
}

#[test]
fn a_camera_inside_an_unbounded_solid_sees_its_cavity() {
    let weave = weave(&!sphere(1.0));
    let camera = Camera::orthographic([0.0, -5.0, 0.0], [0.0; 3], UP, 4.0).unwrap();
    let size = size(20, 20);
    let id = ids(&weave, &camera, size, IdKind::Region, &mut run(1)).unwrap();
    let t = depth(&weave, &camera, size, &mut run(1)).unwrap();
    let n = normals(&weave, &camera, size, &mut run(1)).unwrap();
    for (k, (t, id)) in t.values().iter().zip(id.values()).enumerate() {
        let ray = camera.ray(size, (k % 20) as f64 + 0.5, (k / 20) as f64 + 0.5);
        let expected = sphere_time(ray.origin, ray.direction, Vec3::ZERO, 1.0);
        assert_eq!(*id, i32::from(expected.is_some()));
        assert!((t - expected.unwrap_or(f64::INFINITY)).abs() < 1e-12 || t.is_infinite());
        if expected.is_some() {
            // outward of the solid is into the cavity: along the ray, which leaves the solid
            assert!(Vec3::from_array(n.values()[k]).dot(ray.direction) > 0.0);
        }
    }
}

#[test]
fn sections_show_the_inside() {
    let shell = sphere(2.0) - sphere(1.0);
    let region = rayweave_model::Region { name: "shell".to_owned(), solid: shell, medium: 1 };
    let cut = section(std::slice::from_ref(&region), Vec3::NEG_Y, 0.0).unwrap();
    assert_eq!((cut[0].name.as_str(), cut[0].medium), ("shell", 1));
    let weave = weave(&cut[0].solid);
    let camera = Camera::orthographic([0.0, -9.0, 0.0], [0.0; 3], UP, 5.0).unwrap();
    let t = depth(&weave, &camera, size(25, 25), &mut run(1)).unwrap();
    for (k, t) in t.values().iter().enumerate() {
        let at = camera.ray(size(25, 25), (k % 25) as f64 + 0.5, (k / 25) as f64 + 0.5).origin;
        let r2 = at.x * at.x + at.z * at.z;
        if (r2 - 4.0).abs() < 1e-9 || (r2 - 1.0).abs() < 1e-9 {
            continue; // grazes
        }
        let expected = match r2 {
            r2 if r2 > 4.0 => f64::INFINITY,
            r2 if r2 > 1.0 => 9.0,
            // the far side of the cavity
            r2 => 9.0 + (1.0 - r2).sqrt(),
        };
        assert!((t - expected).abs() < 1e-12 || *t == expected, "{t} {expected}");
    }
    assert!(section(&[region], Vec3::ZERO, 0.0).is_err());
}

#[test]
fn huge_and_tiny_models_far_away() {
    for scale in [1e-8, 1.0, 1e8] {
        let centre = Vec3::new(3.0, -2.0, 1.0) * scale;
        let weave = weave(&sphere(scale).translate(centre));
        for view in View::ALL {
            let camera = view.fit(weave.program(), size(25, 25));
            let id = ids(&weave, &camera, size(25, 25), IdKind::Region, &mut run(1)).unwrap();
            let hits = id.values().iter().filter(|id| **id == 1).count();
            assert!(hits > 140, "{view} {scale}: {hits}");
        }
    }
    let half_space = shape("cone", &[("radius1", 1.0), ("radius2", 0.0), ("height", 1.0)]);
    let weave = weave(&half_space);
    let camera = View::Front.fit(weave.program(), size(9, 9));
    let id = ids(&weave, &camera, size(9, 9), IdKind::Region, &mut run(1)).unwrap();
    let widths: Vec<usize> = id.rows().map(|row| row.iter().filter(|id| **id == 1).count()).collect();
    assert!(widths.windows(2).all(|pair| pair[0] <= pair[1] || pair[1] == 0), "{widths:?}");
}
