//! Conversion of prescriptions to solids.

use crate::lenses::{D_NM, at_image, cassegrain, disk, doublet, index, near, trace, triplet};
use rayweave_lens::prescription::{Behind, Prescription, Surface, SystemAperture};
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Program, Query};
use rayweave_optics::{Body, Event};
use rayweave_shape::Ray;
use rayweave_trace::Packets;
use std::sync::Arc;

/// The same rays by sequential tracing and through the solids.
#[test]
fn solids_and_the_sequence_of_surfaces_agree() {
    for lens in [doublet(), triplet(), cassegrain()] {
        let layout = lens.assembly().unwrap();
        for field in 0..lens.fields.len() {
            let pupil: Vec<_> = disk(400, 0.98).into_iter().filter(|p| p[0].hypot(p[1]) > 0.3).collect();
            let beam = lens.beam(field, D_NM, &pupil).unwrap();
            let rows = at_image(&layout, &beam);
            assert_eq!(rows.len(), beam.len(), "{:?}", layout.assembly.compile().unwrap().element_names());
            for (k, row) in rows.iter().enumerate() {
                let passes = lens.follow(&beam.get(k).ray, D_NM).unwrap();
                let last = passes.last().unwrap();
                near((row.end - last.point).length(), 0.0, 1e-10);
                near((row.direction - last.direction).length(), 0.0, 1e-12);
                near(row.path, last.path, 1e-10);
            }
        }
    }
}

#[test]
fn cemented_elements_have_no_gap() {
    let lens = doublet();
    let layout = lens.assembly().unwrap();
    let beam = lens.beam(1, D_NM, &disk(20_000, 1.0)).unwrap();
    let found = trace(&layout, &beam);
    let mut met = vec![Vec::new(); beam.len()];
    found.segments.iter().for_each(|row| met[row.id as usize].push(row.element));
    let names = layout.assembly.compile().unwrap().element_names().to_vec();
    assert_eq!(names, ["lens 1-2", "lens 2-3", "image"]);
    assert!(met.iter().all(|met| *met == [0, 1, 1, 2, -1]), "{:?}", met[0]);
    assert_eq!(layout.sequence, [0, 1, 1, 2]);
}

#[test]
fn a_perfect_telescope_has_a_perfect_focus() {
    let lens = cassegrain();
    let layout = lens.assembly().unwrap();
    let pupil: Vec<_> = disk(500, 0.99).into_iter().filter(|p| p[0].hypot(p[1]) > 0.25).collect();
    let rows = at_image(&layout, &lens.beam(0, D_NM, &pupil).unwrap());
    assert_eq!(rows.len(), pupil.len());
    for row in &rows {
        near(row.end.x.hypot(row.end.y), 0.0, 1e-10);
        near(row.path, rows[0].path, 1e-10);
    }
}

/// A concave surface that is no wider than its ball, with a much wider front.
#[test]
fn lenses_have_flat_rims_where_one_surface_is_narrow() {
    let lens = Prescription::new(vec![
        Surface::new(30.0, 4.0, index(1.6)).semi_diameter(12.0),
        Surface::new(7.0, 30.0, Behind::Air).semi_diameter(6.0),
    ])
    .entrance_pupil_diameter(10.0);
    let layout = lens.assembly().unwrap();
    let beam = lens.beam(0, D_NM, &disk(300, 0.9)).unwrap();
    let rows = at_image(&layout, &beam);
    assert_eq!(rows.len(), 300);
    for (k, row) in rows.iter().enumerate() {
        let passes = lens.follow(&beam.get(k).ray, D_NM).unwrap();
        near((row.end - passes[2].point).length(), 0.0, 1e-11);
    }
    // outside the narrow surface, light hits the rim, which absorbs
    let wide = Prescription { aperture: SystemAperture::EntrancePupilDiameter(22.0), ..lens };
    let outer: Vec<_> = disk(300, 0.99).into_iter().filter(|p| p[0].hypot(p[1]) > 0.7).collect();
    let found = trace(&layout, &wide.beam(0, D_NM, &outer).unwrap());
    let system = layout.assembly.compile().unwrap();
    let ends = found.segments.iter().filter(|row| row.event == Event::Absorbed);
    let names: Vec<_> = ends.map(|row| system.surface_name(row.surface as usize).to_owned()).collect();
    assert_eq!(names.len(), outer.len());
    assert!(names.iter().all(|name| name == "lens 1-2.flat.back.plane"), "{names:?}");
}

/// The thickness along the axis of the solid of the first lens at a height.
fn solid_thickness(lens: &Prescription, height: f64) -> f64 {
    let layout = lens.assembly().unwrap();
    let Body::Solid { solid, .. } = layout.assembly.elements()[0].body() else { panic!("no solid") };
    let ray = Ray::new(Vec3::new(0.6 * height, 0.8 * height, -50.0), Vec3::Z);
    let program = Arc::new(Program::compile(solid).unwrap());
    let crossings = Packets::new(program).one(ray, &Query::default()).unwrap().crossings;
    crossings.chunks(2).map(|pair| pair[1].t - pair[0].t).sum()
}

#[test]
fn mechanical_semi_diameters_widen_the_solids() {
    let biconvex = |thickness: f64, edges: [Option<f64>; 2]| {
        let mut lens = Prescription::new(vec![
            Surface::new(50.0, thickness, index(1.5)).semi_diameter(8.0),
            Surface::new(-50.0, 46.0, Behind::Air).semi_diameter(7.0),
        ])
        .entrance_pupil_diameter(10.0);
        lens.surfaces.iter_mut().zip(edges).for_each(|(own, edge)| own.mechanical_semi_diameter = edge);
        lens
    };
    let sag = |height: f64| 50.0 - (2500.0 - height * height).sqrt();
    let outline = |lens: &Prescription| lens.assembly().unwrap().lenses[0].clone();
    // both surfaces reach the edge; one that is narrower than the light has no effect
    let wide = outline(&biconvex(6.0, [None, Some(10.0)]));
    assert_eq!((wide.ends, wide.semi_diameter), ([10.0; 2], 10.0));
    let idle = outline(&biconvex(6.0, [Some(3.0), None]));
    assert_eq!((idle.ends, idle.semi_diameter), ([8.0; 2], 8.0));
    assert_eq!(biconvex(6.0, [None, Some(10.0)]).assembly().unwrap().semi_diameters[..2], [8.0, 7.0]);
    // the surfaces would cross before the edge: one side is flat beyond the clear semi-diameters, or both are
    let thin = biconvex(3.0, [Some(13.0), Some(12.0)]);
    let found = outline(&thin);
    assert_eq!((found.ends, found.semi_diameter), ([8.0, 13.0], 13.0));
    let thinner = biconvex(1.5, [Some(13.0), None]);
    let both = outline(&thinner);
    assert_eq!((both.ends, both.semi_diameter), ([8.0; 2], 13.0));
    let expected = [
        (&thin, 5.0, 3.0 - 2.0 * sag(5.0)),
        (&thin, 7.5, 3.0 - 2.0 * sag(7.5)),
        (&thin, 12.5, 3.0 - sag(8.0) - sag(12.5)),
        (&thinner, 5.0, 1.5 - 2.0 * sag(5.0)),
        (&thinner, 7.5, 1.5 - 2.0 * sag(7.5)),
        (&thinner, 12.5, 1.5 - 2.0 * sag(8.0)),
    ];
    for (lens, height, thickness) in expected {
        near(solid_thickness(lens, height), thickness, 1e-12);
    }
    let refused = biconvex(6.0, [Some(-1.0), None]).assembly().unwrap_err().to_string();
    assert!(refused.starts_with("the mechanical semi-diameter of surface 1 is -1: "), "{refused}");
}

/// Light beyond the clear semi-diameters is absorbed, on curved and on flat rims; light within is that of the lens without a rim.
#[test]
fn mechanical_rims_absorb() {
    for (thickness, face) in [(9.0, "lens 1-2.rim.front.side"), (1.5, "lens 1-2.rim.front.plane")] {
        let mut lens = Prescription::new(vec![
            Surface::new(50.0, thickness, index(1.5)).semi_diameter(8.0),
            Surface::new(-50.0, 46.0, Behind::Air).semi_diameter(8.0),
        ])
        .entrance_pupil_diameter(13.0);
        let plain = at_image(&lens.assembly().unwrap(), &lens.beam(0, D_NM, &disk(200, 1.0)).unwrap());
        assert_eq!(plain.len(), 200);
        lens.surfaces[0].mechanical_semi_diameter = Some(13.0);
        let layout = lens.assembly().unwrap();
        let rows = at_image(&layout, &lens.beam(0, D_NM, &disk(200, 1.0)).unwrap());
        assert_eq!(rows.len(), plain.len());
        for (one, other) in rows.iter().zip(&plain) {
            near((one.end - other.end).length(), 0.0, 1e-12);
        }
        let wide = Prescription { aperture: SystemAperture::EntrancePupilDiameter(25.0), ..lens };
        let outer: Vec<_> = disk(500, 1.0).into_iter().filter(|p| p[0].hypot(p[1]) > 0.66).collect();
        let found = trace(&layout, &wide.beam(0, D_NM, &outer).unwrap());
        let system = layout.assembly.compile().unwrap();
        let ends = found.segments.iter().filter(|row| row.event == Event::Absorbed);
        let names: Vec<_> = ends.map(|row| system.surface_name(row.surface as usize).to_owned()).collect();
        assert_eq!(names.len(), outer.len());
        assert!(names.iter().all(|name| name == face), "{names:?}");
    }
}

#[test]
fn stops_block_light() {
    let mut lens = triplet();
    lens.surfaces[4].semi_diameter = Some(1.5);
    let layout = lens.assembly().unwrap();
    let beam = lens.beam(0, D_NM, &disk(500, 1.0)).unwrap();
    let rows = at_image(&layout, &beam);
    let passes = |k: usize| lens.follow(&beam.get(k).ray, D_NM).unwrap()[4].point;
    let expected: Vec<i64> =
        (0..500).filter(|&k| passes(k).x.hypot(passes(k).y) < 1.5).map(|k| k as i64).collect();
    assert!(expected.len() > 50 && expected.len() < 450);
    assert_eq!(rows.iter().map(|row| row.id).collect::<Vec<_>>(), expected);
}

#[test]
fn double_passes_use_one_lens() {
    // a Mangin mirror: glass in front of a mirror, passed twice
    let lens = Prescription::new(vec![
        Surface::new(-150.0, 5.0, index(1.5168)),
        Surface::new(-230.0, -5.0, Behind::Mirror),
        Surface::new(-150.0, -150.0, Behind::Air),
    ])
    .entrance_pupil_diameter(40.0);
    let layout = lens.assembly().unwrap();
    let names = layout.assembly.compile().unwrap().element_names().to_vec();
    // the stop is the first face of a lens that is as wide as its mirror
    assert_eq!(names, ["lens 1-2", "mirror 2", "stop", "image"]);
    assert_eq!(layout.sequence, [0, 1, 0, 3]);
    let pupil: Vec<_> = disk(300, 0.99);
    let beam = lens.beam(0, D_NM, &pupil).unwrap();
    for (k, row) in at_image(&layout, &beam).iter().enumerate() {
        near((row.end - lens.follow(&beam.get(k).ray, D_NM).unwrap()[3].point).length(), 0.0, 1e-10);
    }
}

#[test]
fn errors_name_the_problem() {
    let message = |lens: Prescription| lens.assembly().unwrap_err().to_string();
    let biconvex = |t: f64, semi_diameter: f64| {
        Prescription::new(vec![
            Surface::new(50.0, t, index(1.5)).semi_diameter(semi_diameter),
            Surface::new(-50.0, 40.0, Behind::Air).semi_diameter(semi_diameter),
        ])
    };
    // two sags of 50 - sqrt(50^2 - h^2) are 1 at h = sqrt(50^2 - 49.5^2) = 7.0534
    let crossing = message(biconvex(1.0, 12.5));
    assert!(crossing.starts_with("surfaces 1 and 2 cross 7.05"), "{crossing}");
    assert!(crossing.contains(": their clear semi-diameters reach 12.5."), "{crossing}");
    // semi-diameters that are computed from the rays
    let free =
        Prescription::new(vec![Surface::new(50.0, 1.0, index(1.5)), Surface::new(-50.0, 40.0, Behind::Air)]);
    let crossing = message(free.entrance_pupil_diameter(20.0));
    assert!(crossing.starts_with("surfaces 1 and 2 cross 7.05"), "{crossing}");
    assert!(crossing.contains("since none is stated. State smaller ones"), "{crossing}");
    assert!(message(biconvex(-1.0, 5.0)).starts_with("surfaces 1 and 2 cross 0 from the axis"));
    assert_eq!(
        message(biconvex(5.0, 60.0)),
        "the semi-diameter of surface 1 is 60: the surface ends 50 from the axis."
    );
    // surfaces that intersect in the air between two lenses
    let close = Prescription::new(vec![
        Surface::new(f64::INFINITY, 2.0, index(1.5)).semi_diameter(10.0),
        Surface::new(-30.0, 0.9, Behind::Air).semi_diameter(10.0),
        Surface::new(-20.0, 2.0, index(1.5)).semi_diameter(10.0),
        Surface::new(f64::INFINITY, 2.0, Behind::Air).semi_diameter(10.0),
    ]);
    assert!(message(close).starts_with("surfaces 2 and 3 cross "));
    let unknown = Prescription::new(vec![Surface::new(50.0, 5.0, Behind::Glass("N-BK8".to_owned()))]);
    assert!(message(unknown).starts_with("surface 1: no glass is named \"N-BK8\""));
    assert_eq!(message(Prescription::new(vec![])), "the prescription has no surface: it needs at least one.");
    assert_eq!(message(biconvex(5.0, 5.0).stop_at(3)), "the stop is 3: it must be from 1 to 2.");
    let zero = Prescription::new(vec![Surface::new(0.0, 5.0, Behind::Air)]);
    assert_eq!(
        message(zero),
        "the radius of surface 1 is 0: it has to be other than 0, infinite for a plane."
    );
    let far = doublet().wavelengths_nm(&[200.0], 0);
    // Schott's data sheet of N-BK7
    assert!(
        message(far)
            .starts_with("the wavelength is 200 nm: the index of `N-BK7` is known from 300 nm to 2500 nm.")
    );
    // a beam too wide for lenses of these radii
    let wide = Prescription { fields: vec![[0.0; 2]], ..biconvex(5.0, 5.0) }.entrance_pupil_diameter(500.0);
    let unsized_surfaces =
        wide.surfaces.iter().map(|s| Surface { semi_diameter: None, ..s.clone() }).collect();
    assert_eq!(
        message(Prescription { surfaces: unsized_surfaces, ..wide }),
        "the ray does not reach the image: no intersection at surface 1."
    );
    let sideways = Prescription { fields: vec![[0.0, 90.0]], ..biconvex(5.0, 5.0) };
    assert_eq!(message(sideways), "the angle of a field is 90: it has to be between -90 and 90 degrees.");
}
