//! Camera rays in closed form, and cameras fitted to models.

mod common;

use common::{block, shape, size, sphere, weave};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Solid};
use rayweave_render::{Camera, CameraError, Projection, Size, View};

fn close(a: Vec3, b: Vec3) -> bool {
    (a - b).length() <= 1e-14 * (1.0 + b.length())
}

#[test]
fn rays_of_an_orthographic_camera() {
    // looks along +y: x to the right, z up; 4 units high, so 6 wide
    let camera = Camera::orthographic([1.0, -10.0, 2.0], [1.0, 0.0, 2.0], [0.0, 0.0, 1.0], 4.0).unwrap();
    let size = size(300, 200);
    let cases = [
        ([150.0, 100.0], [1.0, 2.0]),
        ([0.0, 0.0], [-2.0, 4.0]),
        ([300.0, 200.0], [4.0, 0.0]),
        ([0.5, 199.5], [-1.99, 0.01]),
    ];
    for ([x, y], [at_x, at_z]) in cases {
        let ray = camera.ray(size, x, y);
        assert!(close(ray.origin, Vec3::new(at_x, -10.0, at_z)), "{ray:?}");
        assert_eq!(ray.direction, Vec3::Y);
    }
}

#[test]
fn rays_of_a_perspective_camera() {
    // half the field of view is 30 degrees: the upper edge is at slope 1 / sqrt 3
    let camera = Camera::perspective([0.0, 0.0, 5.0], [0.0, 7.0, 5.0], [0.0, 0.3, 9.0], 60.0).unwrap();
    let size = size(400, 200);
    let slope = 1.0 / 3f64.sqrt();
    let cases = [([200.0, 100.0], [0.0, 0.0]), ([200.0, 0.0], [0.0, 1.0]), ([400.0, 200.0], [2.0, -1.0])];
    for ([x, y], [u, v]) in cases {
        let ray = camera.ray(size, x, y);
        assert_eq!(ray.origin, Vec3::new(0.0, 0.0, 5.0));
        assert!(close(ray.direction, Vec3::new(u * slope, 1.0, v * slope).normalize()), "{ray:?}");
    }
}

#[test]
fn places_are_the_inverse_of_rays() {
    let eye = [3.0, -4.0, 5.0];
    let target = [0.2, 0.1, -0.3];
    let cameras = [
        Camera::perspective(eye, target, [0.0, 0.0, 1.0], 35.0).unwrap(),
        Camera::orthographic(eye, target, [1.0, 0.0, 1.0], 3.0).unwrap(),
    ];
    for camera in cameras {
        for (x, y) in [(0.5, 0.5), (31.5, 7.25), (63.0, 47.0), (-10.0, 99.0)] {
            let point = camera.ray(size(64, 48), x, y).at(4.2);
            let (found_x, found_y) = camera.place_of(size(64, 48), point).unwrap();
            assert!((found_x - x).abs() < 1e-11 && (found_y - y).abs() < 1e-11);
        }
        let axes = [camera.right(), camera.up(), -camera.forward()];
        assert!(close(axes[0].cross(axes[1]), axes[2]), "right-handed");
        assert!(axes.iter().all(|axis| (axis.length() - 1.0).abs() < 1e-15));
    }
    let behind = cameras[0].place_of(size(64, 48), Vec3::new(6.0, -8.0, 10.0));
    assert_eq!(behind, None);
}

#[test]
fn views_look_as_their_names_say() {
    let bounds = Bounds::centred(Vec3::ZERO, Vec3::ONE);
    let cases = [
        (View::Front, Vec3::Y, Vec3::X, Vec3::Z),
        (View::Back, Vec3::NEG_Y, Vec3::NEG_X, Vec3::Z),
        (View::Left, Vec3::X, Vec3::NEG_Y, Vec3::Z),
        (View::Right, Vec3::NEG_X, Vec3::Y, Vec3::Z),
        (View::Top, Vec3::NEG_Z, Vec3::X, Vec3::Y),
        (View::Bottom, Vec3::Z, Vec3::X, Vec3::NEG_Y),
    ];
    for (view, forward, right, up) in cases {
        let camera = view.of_bounds(&bounds, size(10, 10));
        assert_eq!([camera.forward(), camera.right(), camera.up()], [forward, right, up], "{view}");
    }
    let iso = View::Iso.of_bounds(&bounds, size(10, 10));
    assert!(close(iso.forward(), Vec3::new(-1.0, 1.0, -1.0) / 3f64.sqrt()));
    assert!(iso.up().z > 0.0 && iso.right().z.abs() < 1e-15 && iso.right().x > 0.0);
    for view in View::ALL {
        assert_eq!(view.name().parse::<View>().unwrap(), view);
    }
    assert!("isometric".parse::<View>().unwrap_err().to_string().contains("front, back"));
}

/// The least distance of the projected corners of a box from the edges, as a fraction of the picture.
fn least_margin(camera: &Camera, bounds: &Bounds, size: Size) -> f64 {
    let (w, h) = (size.width() as f64, size.height() as f64);
    let margin = |corner| {
        let (x, y) = camera.place_of(size, corner).expect("before the camera");
        assert!((corner - camera.position()).dot(camera.forward()) > 0.0);
        (x / w).min(1.0 - x / w).min(y / h).min(1.0 - y / h)
    };
    bounds.corners().map(margin).into_iter().fold(f64::INFINITY, f64::min)
}

#[test]
fn fitted_cameras_see_all_corners_with_the_margin() {
    let boxes = [
        block([-1.0, -2.0, -3.0], [4.0, 5.0, 6.0]),
        block([1e6, 0.0, 0.0], [1e6 + 1.0, 100.0, 0.1]),
        block([-1e-6, -1e-7, 0.0], [1e-6, 2e-7, 3e-6]),
        block([-1e8, -1e8, -1e8], [1e8, 1e8, -9e7]),
    ];
    for solid in boxes {
        let weave = weave(&solid);
        let bounds = weave.program().bounds();
        for view in View::ALL {
            for size in [size(640, 480), size(100, 900), size(1000, 10)] {
                let mut cameras = vec![view.fit(weave.program(), size)];
                for field_of_view in [1.0, 35.0, 120.0] {
                    cameras.push(view.fit_perspective(weave.program(), size, field_of_view).unwrap());
                }
                for camera in cameras {
                    let margin = least_margin(&camera, &bounds, size);
                    assert!((margin - View::MARGIN).abs() < 1e-6, "{view} {size:?} {camera:?}: {margin}");
                }
            }
        }
    }
}

#[test]
fn models_without_bounds_are_seen_as_far_as_they_are_finite() {
    let shape_of = |name, arguments: &[(&str, f64)]| shape(name, arguments);
    let solids = [
        Solid::empty(),
        Solid::universe(),
        !sphere(3.0),
        shape_of("cylinder", &[("radius", 2.0)]),
        sphere(1.0) | shape_of("cylinder", &[("radius", 0.1)]),
    ];
    for solid in solids {
        let weave = weave(&solid);
        for view in View::ALL {
            for camera in [
                view.fit(weave.program(), size(40, 30)),
                view.fit_perspective(weave.program(), size(40, 30), 40.0).unwrap(),
            ] {
                assert!(camera.position().is_finite() && camera.up().is_finite());
            }
        }
    }
    // the finite extent is fully visible: the pillar is 4 wide, and as high as its ball
    let pillar = weave(&shape_of("cylinder", &[("radius", 2.0)]));
    let camera = View::Front.fit(pillar.program(), size(40, 40));
    let seen = Bounds::centred(Vec3::ZERO, Vec3::new(2.0, 2.0, 0.0));
    assert!(least_margin(&camera, &seen, size(40, 40)) >= View::MARGIN - 1e-12);
}

#[test]
fn bad_cameras_are_refused() {
    let (origin, y, z) = ([0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let error = Camera::perspective([f64::NAN, 0.0, 0.0], y, z, 40.0).unwrap_err();
    assert_eq!(error, CameraError::NotFinite { what: "position" });
    assert_eq!(Camera::perspective(y, y, z, 40.0).unwrap_err(), CameraError::NoDirection);
    for degrees in [0.0, 180.0, -3.0, f64::NAN] {
        let error = Camera::perspective(origin, y, z, degrees).unwrap_err();
        assert!(matches!(error, CameraError::FieldOfView { .. }));
    }
    for height in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        let error = Camera::orthographic(origin, y, z, height).unwrap_err();
        assert!(matches!(error, CameraError::Height { .. }));
    }
    // `up` need not be perpendicular
    for up in [y, [0.0; 3], [0.0, -1e300, 0.0], [1e-300, 0.0, 0.0]] {
        let camera = Camera::perspective(origin, y, up, 40.0).unwrap();
        assert!(camera.right().dot(camera.forward()).abs() < 1e-15);
        assert!((camera.up().length() - 1.0).abs() < 1e-15);
    }
    let far = Camera::new(Vec3::MAX, Vec3::MIN, Vec3::Z, Projection::Orthographic { height: 1.0 });
    assert!(far.is_err() || far.unwrap().forward().is_finite());
}
