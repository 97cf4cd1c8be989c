//! Fresnel lenses and lenslet arrays.

use crate::probe::{Probe, assert_close, numbers};
use rayweave_math::Vec3;
use rayweave_optics::component::*;

/// The thickness of a ring from the drop of its surface to its outer edge; the slope is that of the whole surface.
#[test]
fn fresnel_rings() {
    let (r, pitch, thickness) = (30.0, 1.5, 2.0);
    for (conic, diameter) in [(0.0, 40.0), (-1.0, 41.0), (-2.3, 12.4)] {
        let probe = Probe::new(&fresnel_lens(r, conic, pitch, thickness, diameter).unwrap());
        for k in 0..300 {
            let [u, v, ..] = numbers(k);
            let height = 0.5 * diameter * u;
            let outer = (pitch * (height / pitch).ceil()).min(0.5 * diameter);
            let drop = |h: f64| sag(r, conic, h).unwrap();
            let (sin, cos) = (6.3 * v).sin_cos();
            let hits = probe.hits(Vec3::new(height * cos, height * sin, -9.0), Vec3::Z);
            assert_eq!(hits.len(), 2, "{height}");
            assert_eq!((hits[0].t, hits[1].face.as_str()), (8.0, "back.side"));
            assert_close(hits[1].t - hits[0].t, thickness + drop(outer) - drop(height), 2e-14);
            let slope = (drop(height + 1e-6) - drop(height - 1e-6)) / 2e-6;
            let normal = Vec3::new(slope * cos, slope * sin, 1.0).normalize();
            assert!((hits[1].normal - normal).length() < 1e-8);
        }
        // from the side: the rim, and inside the base no wall at all
        let hits = probe.hits(Vec3::new(-50.0, 0.1, 0.5), Vec3::X);
        assert_eq!((hits.len(), hits[0].face.as_str()), (2, "edge.side"));
        let grooves = probe.hits(Vec3::new(-50.0, 0.0, 1.0001), Vec3::X);
        assert!(grooves.iter().any(|hit| hit.face == "draft.side") && grooves.len() > 4);
    }
    let message = |pitch, diameter| fresnel_lens(30.0, 0.0, pitch, 2.0, diameter).unwrap_err().to_string();
    assert!(message(1e-5, 40.0).ends_with("Is the pitch too small?"));
    assert!(message(1.0, 61.0).contains("extends 30.5 from"));
    assert!(message(0.0, 4.0).starts_with("pitch of the Fresnel lens is 0:"));
}

/// Light through many lenslets is not affected by the walls between them.
#[test]
fn lenslets() {
    let error = lenslet_array(4.0, 1.5, 2.0, 65_000, 65_000).unwrap_err().to_string();
    assert!(error.contains("4225000000 lenslets: at most 4194304 are allowed"), "{error}");
    let probe = Probe::new(&lenslet_array(4.0, 1.5, 2.0, 5, 4).unwrap());
    for k in 0..500 {
        let [u, v, w, s] = numbers(k);
        let (x, y) = (9.9 * (u - 0.5), 7.9 * (v - 0.5));
        // lenslet centres lie at even x and odd y
        let (a, b) = (x - 2.0 * (x / 2.0).round(), y - 2.0 * ((y - 1.0) / 2.0).round() - 1.0);
        let thickness = 1.5 - 4.0 + (16.0 - a * a - b * b).sqrt();
        assert_close(probe.chord(x, y), thickness, 1e-13);
        // in the plate below the lowest corner, 0.258 behind the vertex planes, nearly along it
        let from = Vec3::new(-9.0, 4.0 * (w - 0.5), -0.7 + 0.5 * s);
        assert_eq!(probe.crossings(from, Vec3::new(1.0, 0.1, 0.01)).len(), 2, "{from}");
    }
    assert_eq!(probe.program.bounds().hi, Vec3::new(5.0, 4.0, 0.75));
    assert!(
        lenslet_array(4.0, 1.5, 2.0, 0, 4)
            .unwrap_err()
            .to_string()
            .starts_with("columns of the lenslet array is 0:")
    );
    assert!(lenslet_array(1.0, 1.5, 2.0, 3, 4).unwrap_err().to_string().contains("extends 1.414"));
}
