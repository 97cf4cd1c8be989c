//! Aspheric terms in prescriptions: odd powers, files, tolerancing and optimisation.

use crate::lenses::{D_NM, at_image, near};
use rayweave_lens::analysis::PupilQuadrature;
use rayweave_lens::design::{Goal, Merit, Operand, Optimiser, Spread, Tolerancing};
use rayweave_lens::prescription::{Behind, Prescription, Surface, read_zmx, write_zmx};
use rayweave_math::Vec3;
use rayweave_shape::Ray;

const N: f64 = 1.5;

fn odd(terms: &[f64]) -> [f64; 8] {
    std::array::from_fn(|k| terms.get(k).copied().unwrap_or(0.0))
}

/// Light that leaves glass through a hyperboloid, k = -n^2: collimated inside, it converges to a point (R.
/// Descartes, 1637).
fn plano_convex(radius: f64, conic: f64, even: [f64; 8]) -> Prescription {
    let focus = radius / (N - 1.0);
    Prescription::new(vec![
        Surface::new(f64::INFINITY, 8.0, Behind::Index(N)),
        Surface::new(-radius, focus, Behind::Air).conic(conic).even(even),
    ])
    .entrance_pupil_diameter(20.0)
}

fn spot_goal() -> Goal {
    Goal::equal(Operand::Spot { field: 0, wavelength_nm: Some(D_NM) }, 0.0)
}

/// An axicon given by its term in r: light along the axis is refracted to the same slope everywhere.
#[test]
fn a_term_in_r_is_an_axicon() {
    let slope = 0.1;
    let lens = Prescription::new(vec![
        Surface::new(f64::INFINITY, 5.0, Behind::Index(N)),
        Surface::new(f64::INFINITY, 100.0, Behind::Air).odd(odd(&[-slope])),
    ])
    .entrance_pupil_diameter(20.0);
    let angle = slope.atan();
    let bent = (N * angle.sin()).asin() - angle;
    for (x, y) in [(1e-3, 0.0), (3.0, -4.0), (0.0, 9.0)] {
        let passes = lens.follow(&Ray::new(Vec3::new(x, y, -7.0), Vec3::Z), D_NM).unwrap();
        let (r, end) = (f64::hypot(x, y), passes[2]);
        near(passes[1].point.z, 5.0 - slope * r, 1e-14);
        let outward = (end.direction.x * x + end.direction.y * y) / r;
        near(outward, -bent.sin(), 1e-14);
    }
    // the solids agree
    let layout = lens.assembly().unwrap();
    let beam = lens.beam(0, D_NM, &[[0.0, 0.5], [0.3, -0.4], [-0.9, 0.1]]).unwrap();
    let rows = at_image(&layout, &beam);
    assert_eq!(rows.len(), 3);
    for row in rows {
        near(row.direction.truncate().length(), bent.sin(), 1e-13);
    }
}

/// The odd asphere of Zemax: `z = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + b1 r + b2 r^2 + ... + b8 r^8`
/// (OpticStudio user guide, "Odd asphere surface"), `PARM 1` to `PARM 8`.
#[test]
fn odd_aspheres_are_read_and_written() {
    let file = "ENPD 10\nYFLN 0\nWAVM 1 0.55 1\nSURF 0\n DISZ INFINITY\nSURF 1\n STOP\n TYPE ODDASPHE\n CURV 0.02\n CONI -0.5\n \
                PARM 1 0.001\n PARM 2 2e-4\n PARM 3 -3e-5\n PARM 4 4e-6\n PARM 7 7e-10\n PARM 8 -8e-11\n PARM 9 0\n DISZ 4\n \
                GLAS N-BK7\nSURF 2\n DISZ 95\nSURF 3\n";
    let lens = read_zmx(file.as_bytes()).unwrap().prescription;
    let surface = &lens.surfaces[0];
    assert_eq!(surface.odd, odd(&[0.001, -3e-5, 0.0, 7e-10]));
    assert_eq!(surface.even, odd(&[2e-4, 4e-6, 0.0, -8e-11]));
    let r: f64 = 3.0;
    let base = 0.02 * r * r / (1.0 + (1.0 - 0.5 * 0.0004 * r * r).sqrt());
    let terms = [0.001, 2e-4, -3e-5, 4e-6, 0.0, 0.0, 7e-10, -8e-11];
    let sag = base + terms.iter().zip(1..).map(|(b, n)| b * r.powi(n)).sum::<f64>();
    let pass = lens.follow(&Ray::new(Vec3::new(0.0, r, -1.0), Vec3::Z), D_NM).unwrap()[0];
    near(pass.point.z, sag, 1e-15);
    let text = write_zmx(&lens).unwrap();
    assert!(text.contains("TYPE ODDASPHE") && text.contains("PARM 3 -3e-5"), "{text}");
    assert_eq!(read_zmx(text.as_bytes()).unwrap().prescription, lens);
    let beyond = lens.surfaces[0].clone().even(odd(&[0.0, 0.0, 0.0, 0.0, 1e-12]));
    let error = write_zmx(&Prescription { surfaces: vec![beyond], ..lens }).unwrap_err();
    assert!(error.to_string().contains("beyond r^8"), "{error}");
    for (kind, why) in [
        ("BICONICX", "biconic has parameter 3"),
        ("XPOLYNOM", "polynomial has parameter 1"),
        ("TILTSURF", "TILTSURF: STANDARD"),
    ] {
        let error = read_zmx(file.replace("ODDASPHE", kind).as_bytes()).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
}

/// Started from a sphere, the search for the conic constant converges to the hyperboloid k = -n^2, whose spot
/// is a point.
#[test]
fn a_search_finds_the_conic_without_spherical_aberration() {
    let start = plano_convex(30.0, 0.0, odd(&[]));
    let found = Optimiser::new(&start).vary("conic 2".parse().unwrap()).goal(spot_goal()).run().unwrap();
    assert!(found.has_converged, "{}", found.reason);
    near(found.values[0].1, -N * N, 1e-7);
    assert!(found.after < 1e-8 && found.before > 0.1, "{} {}", found.before, found.after);
}

/// With the sphere fixed, terms replace the conic constant: that in r^4 converges to the coefficient of the
/// hyperboloid's series, `k c^3 / 8` more than the sphere's, for a small pupil.
#[test]
fn a_search_finds_the_terms_of_the_same_surface() {
    let start = plano_convex(30.0, 0.0, odd(&[])).entrance_pupil_diameter(6.0);
    let search = ["r^4 2", "r^6 2", "r^8 2"];
    let optimiser = search.iter().fold(Optimiser::new(&start), |all, name| all.vary(name.parse().unwrap()));
    let found = optimiser.goal(spot_goal()).run().unwrap();
    let c = -1.0 / 30.0_f64;
    let exact = -N * N * c.powi(3) / 8.0;
    near(found.values[0].1, exact, 1e-3 * exact);
    // (1 + k)^2 c^5 / 16 of the conic minus that of the sphere
    let exact = ((1.0 - N * N).powi(2) - 1.0) * c.powi(5) / 16.0;
    near(found.values[1].1, exact, 0.05 * exact.abs());
    assert!(found.after < 1e-6 * found.before, "{} {}", found.before, found.after);
}

/// The term in r^2 is half a curvature: 1 / f = (n - 1) (1 / R - 2 a) where the surface faces back, so df/da
/// = 2 f^2 (n - 1). An error of the hyperboloid's term in r^4 gives the wavefront (n - 1) a r^4 plus the
/// refocusing term.
#[test]
fn sensitivities_of_terms_are_their_derivatives() {
    let lens = plano_convex(30.0, -N * N, odd(&[]));
    let f = 30.0 / (N - 1.0);
    let by_square =
        Tolerancing::new(&lens, Merit::FocalLength).add("r^2 2".parse().unwrap(), Spread::Uniform(1e-9));
    near(by_square.sensitivities().unwrap()[0].slope, 2.0 * f * f * (N - 1.0), 1e-2);

    let narrow = lens.clone().entrance_pupil_diameter(4.0);
    let (a, r) = (1e-6, 2.0_f64);
    let trial = Tolerancing::new(&narrow, Merit::WavefrontRms).refocused().rings(4);
    let found = trial.add("r^4 2".parse().unwrap(), Spread::Uniform(a)).sensitivities().unwrap()[0];
    let w040 = (N - 1.0) * a * r.powi(4) / (D_NM * 1e-6);
    // W (rho^4 - q rho^2) has the smallest spot at the least mean of (4 rho^3 - 2 q rho)^2; means over the
    // disk of rho^p are 2 / (p + 2)
    let mean = |power: i32| 2.0 / f64::from(power + 2);
    let q = 2.0 * mean(4) / mean(2);
    let square = mean(8) - 2.0 * q * mean(6) + q * q * mean(4);
    let expected = w040 * (square - (mean(4) - q * mean(2)).powi(2)).sqrt();
    near(found.plus, expected, 0.01 * expected);
    near(found.minus, expected, 0.01 * expected);
}

/// Rays vignetted by a stated semi-diameter are counted: a lens shifted by a part of its semi-diameter.
#[test]
fn lost_rays_are_counted() {
    let mut lens = plano_convex(30.0, -N * N, odd(&[])).entrance_pupil_diameter(10.0);
    lens.surfaces[0].semi_diameter = Some(5.0);
    let trials = |lens: &Prescription, vignette: bool| {
        let all = Tolerancing::new(lens, Merit::SpotRms).rings(60);
        let all = if vignette { all.vignetted() } else { all };
        all.add("decentre y 1-2".parse().unwrap(), Spread::Uniform(2.0)).trials(3).unwrap()
    };
    let (open, clipped) = (trials(&lens, false), trials(&lens, true));
    assert_eq!(open.lost, [0; 3]);
    let points = PupilQuadrature::gaussian(60).points;
    for (lost, shift) in clipped.lost.iter().zip(&clipped.deviations[0]) {
        // collimated light: a ray meets the plane surface at its point of the pupil
        let beyond = |[x, y]: &&[f64; 2]| (5.0 * x).hypot(5.0 * y - shift) > 5.0;
        assert_eq!(*lost, points.iter().filter(beyond).count());
        assert!(*lost > 0);
    }
    lens.surfaces[0].semi_diameter = Some(5.1);
    let none =
        Tolerancing::new(&lens, Merit::FocalLength).add("r^4 1".parse().unwrap(), Spread::Uniform(1e-9));
    assert_eq!(none.trials(2).unwrap().lost, [0; 2]);
}
