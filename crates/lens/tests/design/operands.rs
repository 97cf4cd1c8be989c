//! Operands of transfer functions and vignetting, and ranges, compared with closed forms.

use crate::lenses::{D_NM, near};
use rayweave_lens::design::{
    Goal, Merit, MtfKind, MtfLines, Operand, Optimiser, Optimum, SeidelTerm, Spread, Target, Tolerancing,
};
use rayweave_lens::prescription::{Behind, Prescription, Surface};

const F: f64 = 100.0;

/// A paraboloid with its image at a distance, perfect on the axis at its focal length.
fn paraboloid(diameter: f64, image: f64) -> Prescription {
    Prescription::new(vec![Surface::new(-2.0 * F, -image, Behind::Mirror).conic(-1.0)])
        .entrance_pupil_diameter(diameter)
}

/// The value of an operand of a prescription.
fn value(lens: &Prescription, operand: Operand, rings: usize) -> f64 {
    let goal = Goal::equal(operand, 0.0);
    let found = Optimiser::new(lens).vary("conic 1".parse().unwrap()).goal(goal).rings(rings);
    found.evaluation_limit(1).run().unwrap().goals[0].values[0]
}

fn mtf(kind: MtfKind, frequency: f64, lines: MtfLines) -> Operand {
    Operand::Mtf { kind, field: 0, frequency, lines }
}

/// Goodman, equation 6-31: 2 / pi (acos v - v sqrt(1 - v^2)) at the frequency v over the cutoff D / (wavelength f).
#[test]
fn the_diffraction_mtf_of_a_perfect_mirror() {
    let lens = paraboloid(10.0, F);
    let cutoff = 10.0 / (D_NM * 1e-6 * F);
    for v in [0.0, 0.1, 0.35, 0.7, 0.95] {
        let expected = 2.0 / std::f64::consts::PI * (libm::acos(v) - v * (1.0 - v * v).sqrt());
        for lines in [MtfLines::Tangential, MtfLines::Sagittal] {
            let found = value(&lens, mtf(MtfKind::Diffraction, v * cutoff, lines), 6);
            near(found, expected, 2e-3);
        }
        let merit = Merit::Mtf { kind: MtfKind::Diffraction, frequency: v * cutoff };
        near(Tolerancing::new(&lens, merit).nominal().unwrap(), expected, 2e-3);
    }
    near(value(&lens, mtf(MtfKind::Diffraction, 1.01 * cutoff, MtfLines::Tangential), 6), 0.0, 1e-15);
}

/// Out of focus by z, geometrically: 2 J1(a) / a with a = 2 pi v r for the spot of radius r = z D / (2 f); with diffraction the
/// integral of cos(8 pi w v x) over the overlap of the pupils, with the defocus w = z D^2 / (8 f^2) in waves (H. H. Hopkins,
/// Proc. R. Soc. A 231, 91, 1955).
#[test]
fn the_mtf_of_defocus() {
    let (diameter, z) = (10.0, 0.3);
    let lens = paraboloid(diameter, F + z);
    let radius = 0.5 * z * diameter / F;
    for frequency in [5.0, 20.0, 40.0, 80.0] {
        let a = std::f64::consts::TAU * frequency * radius;
        let found = value(&lens, mtf(MtfKind::Geometric, frequency, MtfLines::Sagittal), 12);
        near(found, (2.0 * libm::j1(a) / a).abs(), 3e-3);
        let v = frequency * D_NM * 1e-6 * F / diameter;
        let w = z * diameter * diameter / (8.0 * F * F) / (D_NM * 1e-6);
        // the overlap of disks about -v and v, by the trapezoidal rule in thin strips along the shift
        let strips = 200_000;
        let ends = 1.0 - v;
        let strip = |k: i32| {
            let x = ends * (2.0 * (f64::from(k) + 0.5) / f64::from(strips) - 1.0);
            let height = (1.0 - (x.abs() + v).powi(2)).max(0.0).sqrt();
            2.0 * height * (8.0 * std::f64::consts::PI * w * v * x).cos()
        };
        let sum: f64 = (0..strips).map(strip).sum::<f64>() * 2.0 * ends / f64::from(strips);
        let found = value(&lens, mtf(MtfKind::Diffraction, frequency, MtfLines::Tangential), 12);
        near(found, (sum / std::f64::consts::PI).abs(), 5e-3);
    }
}

/// A goal of the transfer function finds the focus.
#[test]
fn the_mtf_is_highest_in_focus() {
    let lens = paraboloid(10.0, F - 0.02);
    let best = Optimiser::new(&lens)
        .vary("thickness 1".parse().unwrap())
        .goal(Goal::equal(mtf(MtfKind::Diffraction, 60.0, MtfLines::Tangential), 1.0))
        .run()
        .unwrap();
    near(best.lens.surfaces[0].thickness, -F, 2e-4);
}

/// A distant field at the angle a, seen through a ring 20 in front of the pupil, passes it at 5 + 20 tan a.
#[test]
fn the_clearance_of_a_field() {
    let surfaces = vec![
        Surface::dummy(20.0).semi_diameter(7.0),
        Surface::new(f64::INFINITY, 5.0, Behind::Index(1.5)),
        Surface::new(-60.0, 100.0, Behind::Air),
    ];
    let mut lens = Prescription::new(surfaces).entrance_pupil_diameter(10.0).field_angles(&[0.0, 3.0, 8.0]);
    lens.stop = 2;
    for (field, angle) in [(0, 0.0_f64), (1, 3.0), (2, 8.0)] {
        let expected = 7.0 - 5.0 - 20.0 * angle.to_radians().tan();
        near(value(&lens, Operand::Clearance { field }, 6), expected, 1e-9);
    }
    let bare = paraboloid(10.0, F);
    let goal = Goal::at_least(Operand::Clearance { field: 0 }, 0.0);
    let refused = Optimiser::new(&bare).vary("conic 1".parse().unwrap()).goal(goal).run().unwrap_err();
    assert!(refused.to_string().contains("stated semi-diameter"), "{refused}");
}

/// Two disks of the radius R whose centres are d apart overlap in the fraction 2 / pi (acos u - u sqrt(1 - u^2)) with u = d / (2 R).
#[test]
fn the_transmitted_fraction_of_a_decentred_lens() {
    let surfaces = vec![
        Surface::new(f64::INFINITY, 5.0, Behind::Index(1.5)).semi_diameter(5.0),
        Surface::new(-60.0, 100.0, Behind::Air),
    ];
    let lens = Prescription::new(surfaces).entrance_pupil_diameter(10.0);
    for d in [0.5, 2.0, 5.0] {
        let trial = Tolerancing::new(&lens, Merit::Transmitted).rings(60);
        let found = trial.add("decentre y 1-2".parse().unwrap(), Spread::Uniform(d)).sensitivities().unwrap();
        let u: f64 = d / 10.0;
        let expected = 2.0 / std::f64::consts::PI * (libm::acos(u) - u * (1.0 - u * u).sqrt());
        near(found[0].plus, expected, 5e-3);
        near(found[0].minus, expected, 5e-3);
    }
}

#[test]
fn ranges_hold_on_both_sides() {
    let surfaces = vec![Surface::new(60.0, 3.0, Behind::Index(1.5)), Surface::new(-60.0, 58.0, Behind::Air)];
    let lens = Prescription::new(surfaces).entrance_pupil_diameter(5.0);
    let thickness = || Operand::Value("thickness 1".parse().unwrap());
    let search = |wanted: f64| -> Optimum {
        Optimiser::new(&lens)
            .vary("thickness 1".parse().unwrap())
            .goal(Goal::equal(thickness(), wanted))
            .goal(Goal::between(thickness(), 2.0, 4.0).weight(1000.0))
            .run()
            .unwrap()
    };
    // the bounds count a million times as much
    for (wanted, expected) in [(9.0, 4.0), (0.5, 2.0), (3.3, 3.3)] {
        near(search(wanted).lens.surfaces[0].thickness, expected, 1e-4);
    }
}

/// The contribution of a goal of any kind is the square of its weight times the distance of its value from the target; for rays,
/// the value is their RMS.
#[test]
fn contributions_follow_their_definition() {
    let mut lens = crate::lenses::doublet();
    lens.surfaces[0].semi_diameter = Some(16.0);
    let lens = lens.wavelengths_nm(&[486.1327, D_NM, 656.2725], 1);
    let operands = [
        Operand::FocalLength,
        Operand::BackFocalDistance,
        Operand::Defocus,
        Operand::Magnification,
        Operand::Seidel(SeidelTerm::Coma),
        Operand::Distortion { field: 1 },
        Operand::Spot { field: 1, wavelength_nm: None },
        Operand::Spot { field: 0, wavelength_nm: Some(D_NM) },
        Operand::Wavefront { field: 1, wavelength_nm: D_NM },
        Operand::WavefrontAboutChiefRay { field: 1, wavelength_nm: D_NM },
        Operand::Mtf { kind: MtfKind::Geometric, field: 0, frequency: 20.0, lines: MtfLines::Sagittal },
        Operand::Clearance { field: 1 },
        Operand::Value("thickness 3".parse().unwrap()),
        Operand::TotalTrack,
        Operand::EdgeThickness { surface: 1, height: None },
    ];
    for operand in operands {
        let v = value(&lens, operand, 6);
        let d = 0.3 * v.abs() + 0.1;
        let targets = [
            (Target::Equal(0.0), v),
            (Target::Equal(v - d), d),
            (Target::Equal(v + d), -d),
            (Target::AtMost(v + d), 0.0),
            (Target::AtMost(v - d), d),
            (Target::AtLeast(v - d), 0.0),
            (Target::AtLeast(v + d), -d),
            (Target::Between(v - d, v + d), 0.0),
            (Target::Between(v + d, v + 2.0 * d), -d),
            (Target::Between(v - 2.0 * d, v - d), d),
        ];
        for (target, off) in targets {
            let goal = Goal { operand, target, weight: 3.0 };
            let search = Optimiser::new(&lens).vary("thickness 3".parse().unwrap()).goal(goal);
            let found = search.evaluation_limit(1).run().unwrap();
            let expected = 9.0 * off * off;
            let own = found.goals[0];
            assert_eq!(own.values[0], v, "{operand:?} {target:?}");
            near(own.contributions[0], expected, 1e-12 * (1.0 + v.abs()) * (1.0 + expected));
            near(found.before, expected.sqrt(), 1e-9 * (1.0 + expected.sqrt()));
            assert!(found.after <= found.before, "{operand:?} {target:?}: {found:?}");
        }
    }
}

/// A paraboloid out of focus by z has the RMS radius z D / (2 f sqrt(2)), to second order in D / f: a bound or a target of that
/// radius gives the focus.
#[test]
fn targets_of_a_spot_are_radii() {
    let (diameter, start) = (2.0, 3.0);
    let lens = paraboloid(diameter, F + start);
    let spot = Operand::Spot { field: 0, wavelength_nm: Some(D_NM) };
    let radius = |z: f64| z.abs() * diameter / (2.0 * F * 2.0_f64.sqrt());
    let wanted = radius(1.0);
    for goal in [
        Goal::equal(spot, wanted),
        Goal::at_most(spot, wanted),
        Goal::between(spot, 0.5 * wanted, wanted),
        Goal::equal(spot, 0.0),
    ] {
        let found = Optimiser::new(&lens).vary("thickness 1".parse().unwrap()).goal(goal).run().unwrap();
        let z = -found.lens.surfaces[0].thickness - F;
        let expected = if goal.target == Target::Equal(0.0) { 0.0 } else { 1.0 };
        near(z, expected, 2e-3);
        near(found.after, 0.0, 1e-6);
        near(found.goals[0].values[1], radius(z), 1e-3 * wanted);
    }
}

/// A ring of the semi-diameter 4 in front of a pupil of 5 cuts off 1 - (4 / 5)^2 of it, which the goals ignore.
#[test]
fn vignetted_fields_are_reported() {
    let surfaces =
        vec![Surface::dummy(20.0).semi_diameter(4.0), Surface::new(-200.0, -100.0, Behind::Mirror)];
    let mut lens = Prescription::new(surfaces).entrance_pupil_diameter(10.0);
    lens.stop = 2;
    let vary = || Optimiser::new(&lens).vary("thickness 2".parse().unwrap()).rings(40);
    let spot = Goal::equal(Operand::Spot { field: 0, wavelength_nm: None }, 0.0);
    let found = vary().goal(spot).run().unwrap().vignetted;
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].0, 0);
    near(found[0].1, 1.0 - 0.64, 0.02);
    let clear = Goal::equal(Operand::TotalTrack, -70.0);
    assert_eq!(vary().goal(clear).run().unwrap().vignetted, []);
}
