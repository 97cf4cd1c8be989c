//! Tolerancing, compared with closed forms.

use crate::lenses::near;
use rayweave_lens::design::{DesignParameter, Merit, Spread, Tolerancing, Trials};
use rayweave_lens::prescription::{Behind, Prescription, Surface};
use rayweave_optics::component::{Figure, lensmaker};

const R1: f64 = 60.0;
const R2: f64 = -90.0;
const T: f64 = 5.0;
const N: f64 = 1.6;

fn singlet() -> Prescription {
    let surfaces = vec![Surface::new(R1, T, Behind::Index(N)), Surface::new(R2, 58.0, Behind::Air)];
    Prescription::new(surfaces).entrance_pupil_diameter(5.0)
}

fn paraboloid() -> Prescription {
    Prescription::new(vec![Surface::new(-200.0, -100.0, Behind::Mirror).conic(-1.0)])
        .entrance_pupil_diameter(10.0)
}

/// 1 / f = (n - 1) (c1 - c2 + (n - 1) t c1 c2 / n), differentiated with respect to R1, R2, t and n.
fn slopes() -> [f64; 4] {
    let f = lensmaker(R1, R2, N, T).unwrap();
    let (c1, c2, m) = (1.0 / R1, 1.0 / R2, (N - 1.0) / N);
    let by_n = (c1 - c2) + (N - 1.0) * (N + 1.0) / (N * N) * T * c1 * c2;
    [
        f * f * (N - 1.0) * (1.0 + m * T * c2) * c1 * c1,
        -f * f * (N - 1.0) * (1.0 - m * T * c1) * c2 * c2,
        -f * f * (N - 1.0) * m * c1 * c2,
        -f * f * by_n,
    ]
}

const NAMES: [&str; 4] = ["radius 1", "radius 2", "thickness 1", "index 1"];

#[test]
fn sensitivities_of_the_focal_length_are_those_of_the_lensmaker() {
    let lens = singlet();
    let tolerancing = Tolerancing::new(&lens, Merit::FocalLength);
    near(tolerancing.nominal().unwrap(), lensmaker(R1, R2, N, T).unwrap(), 1e-12);
    let tolerancing =
        NAMES.iter().fold(tolerancing, |all, name| all.add(name.parse().unwrap(), Spread::Uniform(1e-4)));
    for (found, slope) in tolerancing.sensitivities().unwrap().iter().zip(slopes()) {
        near(found.slope, slope, 2e-6 * slope.abs());
        near(found.plus - found.minus, 2e-4 * slope, 1e-9);
    }
}

/// The focal length of a mirror is half its radius: the merit has the distribution of the error.
#[test]
fn one_sided_spreads_have_their_ends_and_their_mean() {
    let mirror =
        Prescription::new(vec![Surface::new(-200.0, -100.0, Behind::Mirror)]).entrance_pupil_diameter(10.0);
    let (low, high) = (-0.1, 0.5);
    let search = |spread: Spread| {
        Tolerancing::new(&mirror, Merit::FocalLength).add("radius 1".parse().unwrap(), spread)
    };
    let trials = search(Spread::Between(low, high)).trials(2000).unwrap();
    let errors = &trials.deviations[0];
    assert!(errors.iter().all(|error| (low..=high).contains(error)));
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    near(mean, 0.2, 4.0 * 0.6 / (12.0 * 2000.0_f64).sqrt());
    let ends = search(Spread::Between(low, high)).sensitivities().unwrap()[0];
    near((ends.minus - trials.nominal).abs(), 0.05, 1e-12);
    near((ends.plus - trials.nominal).abs(), 0.25, 1e-12);
    near(ends.slope.abs(), 0.5, 1e-12);
    for wrong in
        [Spread::Between(0.2, 0.1), Spread::Between(f64::NAN, 0.1), Spread::Between(0.0, f64::INFINITY)]
    {
        assert!(search(wrong).trials(1).is_err(), "{wrong:?}");
    }
}

#[test]
fn american_spellings_have_a_hint() {
    let error = "decenter y 1-2".parse::<DesignParameter>().unwrap_err().to_string();
    assert!(error.ends_with(" Did you mean `decentre y 1-2`?"), "{error}");
    let other = "decent 1".parse::<DesignParameter>().unwrap_err().to_string();
    assert!(!other.contains("Did you mean"), "{other}");
}

#[test]
fn variances_of_small_errors_add_up() {
    let lens = singlet();
    let spreads = [Spread::Uniform(0.02), Spread::Normal(0.01), Spread::Uniform(0.05), Spread::Normal(1e-4)];
    let variance = |spread: Spread| match spread {
        Spread::Uniform(width) => width * width / 3.0,
        Spread::Normal(sigma) => sigma * sigma,
        Spread::Between(low, high) => (high - low) * (high - low) / 12.0,
    };
    let tolerancing =
        NAMES.iter().zip(spreads).fold(Tolerancing::new(&lens, Merit::FocalLength), |all, (name, spread)| {
            all.add(name.parse().unwrap(), spread)
        });
    let trials = tolerancing.trials(4000).unwrap();
    assert_eq!(trials.failures(), 0);
    let parts = spreads.iter().zip(slopes()).map(|(spread, slope)| slope * slope * variance(*spread));
    let sigma = parts.sum::<f64>().sqrt();
    // the standard error of a standard deviation is at most sigma / sqrt(2 n), that of a mean sigma / sqrt(n)
    near(trials.standard_deviation(), sigma, 4.0 * sigma / 8000.0_f64.sqrt());
    near(trials.mean(), trials.nominal, 4.0 * sigma / 4000.0_f64.sqrt());
    for (column, spread) in trials.deviations.iter().zip(spreads) {
        let mean_square = column.iter().map(|value| value * value).sum::<f64>() / 4000.0;
        // the kurtosis of a normal distribution is 3
        near(mean_square, variance(spread), 4.0 * variance(spread) * (2.0_f64 / 4000.0).sqrt());
        if let Spread::Uniform(width) = spread {
            assert!(column.iter().all(|value| value.abs() <= width));
        }
    }
}

#[test]
fn a_tilted_mirror_turns_the_light_by_twice_its_angle() {
    let lens = paraboloid();
    for (name, degrees) in [("tilt x 1", 0.1_f64), ("tilt y 1", -0.3)] {
        let tolerancing = Tolerancing::new(&lens, Merit::ImageShift)
            .rings(0)
            .add(name.parse().unwrap(), Spread::Uniform(degrees.abs()));
        let found = tolerancing.sensitivities().unwrap()[0];
        let expected = 100.0 * (2.0 * degrees.abs()).to_radians().tan();
        near(found.plus, expected, 1e-12);
        near(found.minus, expected, 1e-12);
    }
}

#[test]
fn rotating_a_sphere_about_its_centre_has_no_effect() {
    // a tilt about the vertex shifts the centre by R sin a perpendicular to the axis
    let mirror =
        Prescription::new(vec![Surface::new(-200.0, -100.0, Behind::Mirror)]).entrance_pupil_diameter(10.0);
    let shift = |name: &str, by: f64| {
        let tolerancing =
            Tolerancing::new(&mirror, Merit::ImageShift).add(name.parse().unwrap(), Spread::Uniform(by));
        tolerancing.sensitivities().unwrap()[0].plus
    };
    let angle = 0.01_f64;
    let across = 200.0 * angle.to_radians().sin();
    // the remainder is the shift of the centre along the axis, of second order: 1e-8 of the radius
    near(shift("tilt x 1", angle), shift("decentre y 1", across), 1e-6 * across);
    near(shift("tilt y 1", angle), shift("decentre x 1", across), 1e-6 * across);
}

#[test]
fn a_decentred_system_moves_its_image_with_it() {
    // narrow enough for no spherical aberration
    let lens = singlet().entrance_pupil_diameter(0.05);
    let of = |name: &str, merit: Merit| {
        let tolerancing = Tolerancing::new(&lens, merit).add(name.parse().unwrap(), Spread::Uniform(0.05));
        tolerancing.sensitivities().unwrap()[0]
    };
    // both surfaces as one body, distant object: the focus moves with the lens, and a plane in front of it
    // shows a part of the shift
    let first_order = lens.first_order(587.5618).unwrap();
    let part = 1.0 - (first_order.back_focal_distance - 58.0) / first_order.focal_length;
    near(of("decentre x 1-2", Merit::ImageShift).plus, 0.05 * part, 1e-5 * 0.05);
    // moving a plane along itself changes nothing
    let window =
        Prescription::new(vec![Surface::new(f64::INFINITY, 5.0, Behind::Index(1.5)), Surface::dummy(50.0)])
            .entrance_pupil_diameter(5.0);
    let tolerancing = Tolerancing::new(&window, Merit::ImageShift)
        .add("decentre y 1-2".parse().unwrap(), Spread::Uniform(1.0));
    near(tolerancing.sensitivities().unwrap()[0].plus, 0.0, 1e-13);
    // a tilted plate: t sin a (1 - cos a / sqrt(n^2 - sin^2 a)), Hecht, Optics, problem of section 4.4
    let angle = 10.0_f64;
    let (sin, cos) = angle.to_radians().sin_cos();
    let expected = 5.0 * sin * (1.0 - cos / (1.5_f64 * 1.5 - sin * sin).sqrt());
    let tolerancing = Tolerancing::new(&window, Merit::ImageShift)
        .add("tilt x 1-2".parse().unwrap(), Spread::Uniform(angle));
    near(tolerancing.sensitivities().unwrap()[0].plus, expected, 1e-12);
}

#[test]
fn refocusing_compensates_a_thickness_error() {
    let lens = paraboloid();
    let of = |merit: Merit| {
        Tolerancing::new(&lens, merit).add("thickness 1".parse().unwrap(), Spread::Normal(0.1))
    };
    let trials = of(Merit::SpotRms).refocused().trials(40).unwrap();
    assert!(trials.merits.iter().all(|merit| *merit < 1e-12));
    for (shift, deviation) in trials.shifts.iter().zip(&trials.deviations[0]) {
        near(*shift, -*deviation, 1e-9);
    }
    let without = of(Merit::SpotRms).trials(40).unwrap();
    assert!(
        without.merits.iter().all(|merit| *merit > 0.0) && without.shifts.iter().all(|shift| *shift == 0.0)
    );
    assert_eq!(without.deviations, trials.deviations);
    // a wavefront out of focus by z: W = h^2 / 2 (1 / (f - z) - 1 / f) for a slow mirror; the standard deviation of
    // the squared radius over the unit disk is 1 / sqrt(12)
    let slow = paraboloid().entrance_pupil_diameter(2.0);
    let out = Tolerancing::new(&slow, Merit::WavefrontRms)
        .rings(3)
        .add("thickness 1".parse().unwrap(), Spread::Uniform(0.2));
    let expected = 0.5 * (1.0 / 99.8 - 1.0 / 100.0) / 587.5618e-6 / 12.0_f64.sqrt();
    near(out.sensitivities().unwrap()[0].plus, expected, 1e-3 * expected);
    let back = out.refocused().sensitivities().unwrap()[0].plus;
    assert!(back < 1e-6, "{back}");
}

/// A paraboloid tilted by a has the coma W r^3 cos t with W = a h^3 / (4 f^2) (D. J. Schroeder, Astronomical Optics, 2000,
/// section 5.1): an RMS of W / sqrt(8) about the chief ray and of W / sqrt(72) about the centroid.
#[test]
fn the_coma_of_a_tilted_mirror_moves_the_image() {
    let lens = paraboloid().entrance_pupil_diameter(20.0);
    let angle = 0.02_f64;
    let coma = angle.to_radians() * 1e3 / (4.0 * 1e4) / 587.5618e-6;
    for (merit, squares) in [(Merit::WavefrontRms, 72.0_f64), (Merit::WavefrontRmsAboutChiefRay, 8.0)] {
        let trials = Tolerancing::new(&lens, merit).add("tilt x 1".parse().unwrap(), Spread::Uniform(angle));
        let found = trials.refocused().sensitivities().unwrap()[0];
        near(found.plus, coma / squares.sqrt(), 0.01 * found.plus);
        near(found.minus, found.plus, 1e-6);
    }
}

/// A round lens has no preferred side: moving it by d changes the image of the field f as moving it by -d changes that
/// of -f. A merit over fields on one side is therefore not even in d, one over both sides is.
#[test]
fn an_error_on_either_side_has_the_same_effect() {
    let mut lens = singlet();
    lens.fields = vec![[0.0, 0.0], [0.0, 6.0], [0.0, 9.0]];
    let mut wide = lens.clone();
    wide.fields.extend([[0.0, -6.0], [0.0, -9.0], [0.0, 0.0]]);
    for merit in [Merit::SpotRms, Merit::WavefrontRms] {
        let of = |lens: &Prescription, mirrors: Option<bool>| {
            let all = Tolerancing::new(lens, merit).add("tilt x 2".parse().unwrap(), Spread::Uniform(0.5));
            let all = all.add("decentre y 1".parse().unwrap(), Spread::Uniform(0.2));
            let all = mirrors.into_iter().fold(all, Tolerancing::mirror_fields);
            (all.nominal().unwrap(), all.sensitivities().unwrap(), all.has_one_sided_fields())
        };
        let (nominal, alone, is_default) = of(&lens, None);
        let (one_sided, uneven, _) = of(&lens, Some(false));
        let (twice, both, is_other) = of(&wide, None);
        assert!(is_default && !is_other);
        // the round lens itself is the same on both sides
        near(nominal, one_sided, 1e-12 * nominal);
        near(twice, nominal, 1e-12 * nominal);
        for ((alone, uneven), both) in alone.iter().zip(&uneven).zip(&both) {
            near(alone.plus, alone.minus, 1e-9 * alone.plus);
            near(both.plus, alone.plus, 1e-12 * alone.plus);
            assert!(alone.plus > nominal && (uneven.plus - uneven.minus).abs() > 0.01 * nominal);
        }
    }
}

#[test]
fn fields_are_mirrored_where_an_error_breaks_the_symmetry_of_a_round_lens() {
    let lens = |fields: &[[f64; 2]]| {
        let mut lens = singlet();
        lens.fields = fields.to_vec();
        lens
    };
    let is_default = |lens: &Prescription, name: &str| {
        let errors = Tolerancing::new(lens, Merit::SpotRms).add(name.parse().unwrap(), Spread::Uniform(0.1));
        errors.has_one_sided_fields()
    };
    let one_sided = lens(&[[0.0, 0.0], [0.0, 6.0], [4.0, 0.0]]);
    assert!(is_default(&one_sided, "tilt y 1") && !is_default(&one_sided, "radius 1"));
    assert!(!is_default(&lens(&[[0.0, 0.0]]), "tilt x 1"));
    assert!(!is_default(&lens(&[[0.0, -6.0], [0.0, 6.0]]), "tilt x 1"));
    let mut cylinder = one_sided.clone();
    cylinder.surfaces[1] = cylinder.surfaces[1].clone().figure(Figure::Toroidal { turn: f64::INFINITY });
    assert!(!is_default(&cylinder, "tilt x 1"));
}

#[test]
fn trials_do_not_depend_on_their_number_nor_on_threads() {
    let lens = singlet();
    let tolerancing = |threads: usize| {
        Tolerancing::new(&lens, Merit::SpotRms)
            .rings(2)
            .seed(7)
            .threads(std::num::NonZeroUsize::new(threads))
            .add("radius 1".parse().unwrap(), Spread::Normal(0.1))
            .add("tilt y 2".parse().unwrap(), Spread::Uniform(0.1))
    };
    let all = tolerancing(1).trials(70).unwrap();
    assert_eq!(tolerancing(3).trials(70).unwrap(), all);
    assert_eq!(tolerancing(2).trials(20).unwrap().merits, all.merits[..20]);
    // the errors of a parameter do not depend on other parameters
    let alone = Tolerancing::new(&lens, Merit::FocalLength)
        .seed(7)
        .add("radius 1".parse().unwrap(), Spread::Normal(0.1));
    assert_eq!(alone.trials(70).unwrap().deviations[0], all.deviations[0]);
    assert_ne!(tolerancing(1).seed(8).trials(70).unwrap().deviations, all.deviations);
}

#[test]
fn quantiles_and_failures() {
    let trials = Trials {
        nominal: 0.0,
        parameters: Vec::new(),
        deviations: Vec::new(),
        merits: vec![4.0, f64::NAN, 1.0, 2.0, 3.0],
        shifts: Vec::new(),
        lost: Vec::new(),
    };
    assert_eq!(trials.failures(), 1);
    let found = [0.0, 0.25, 0.5, 1.0].map(|fraction| trials.quantile(fraction));
    assert_eq!(found, [1.0, 1.75, 2.5, 4.0]);
    near(trials.mean(), 2.5, 0.0);
    near(trials.standard_deviation(), (5.0_f64 / 3.0).sqrt(), 1e-15);
}

#[test]
fn refusals() {
    let lens = singlet();
    let refused = |name: &str, spread: Spread| {
        let tolerancing = Tolerancing::new(&lens, Merit::SpotRms).add(name.parse().unwrap(), spread);
        tolerancing.trials(3).unwrap_err().to_string()
    };
    assert!(refused("radius 3", Spread::Normal(0.1)).starts_with("there is no radius 3"));
    assert!(refused("radius 0", Spread::Normal(0.1)).starts_with("there is no radius 0"));
    assert!(refused("tilt x 2-9", Spread::Normal(0.1)).starts_with("there is no tilt x 2-9"));
    assert!(refused("radius 1", Spread::Normal(-1.0)).starts_with("the spread of radius 1 is -1"));
    assert!(Tolerancing::new(&lens, Merit::SpotRms).trials(3).is_err());
    let mirror = paraboloid();
    let index =
        Tolerancing::new(&mirror, Merit::SpotRms).add("index 1".parse().unwrap(), Spread::Normal(0.1));
    assert!(index.nominal().unwrap_err().to_string().contains("the medium behind a mirror"));
}
