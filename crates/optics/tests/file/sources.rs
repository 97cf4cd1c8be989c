//! Sources of light.

use super::{Run, close, problems, read};
use rayweave_math::Vec3;

#[test]
fn sources() {
    let text = "
        [parameters]
        N = 40
        [[optics.source]]
        line = { length = 8, rays = 'N' }
        wavelength_nm = [[486.1, 1], [656.3, 3]]
        power = 2
        [[optics.source]]
        circle = { diameter = 6, rays = 40 }
        wavelength_nm = { band = [400, 700] }
        transform = [{ rotate_y = 90 }]
        [[optics.source]]
        cone = { angle = 30, rays = 40 }
        wavelength_nm = { black_body = [5772, 400, 700] }
        [[optics.source]]
        wedge = { angle = 60, rays = 40 }
        wavelength_nm = { table = [[400, 0], [700, 1]] }
        [[optics.source]]
        lamp = { width = 2, height = 3, angle = 60, rays = 40 }
        seed = 7
        [[optics.source]]
        point = { angle = 90, rays = 40, random = true }
        [[optics.source]]
        beam = { ellipse = [4, 2], rays = 40, waist = 1 }
        [[optics.source]]
        beam = { rectangle = [4, 2], rays = 40 }
        transform = [{ translate = [0, 0, 5] }, { rotate_x = 180 }]";
    let optics = read(text);
    let sources: Vec<_> = optics.sources.sources().iter().map(|source| source.rays(0..u64::MAX)).collect();
    assert_eq!(sources.iter().map(|rays| rays.len()).collect::<Vec<_>>(), [40; 8]);
    for (number, rays) in sources.iter().enumerate() {
        // for a lamp, whose rays differ, the mean
        let (power, error) = ([2.0, 1.0][number.min(1)], if number == 4 { 0.3 } else { 1e-12 });
        assert!((rays.power.iter().sum::<f64>() - power).abs() < error, "{number}");
    }
    let origins = |number: usize| {
        let [x, y, z] = sources[number].origins.each_ref();
        x.iter().zip(y).zip(z).map(|((&x, &y), &z)| Vec3::new(x, y, z)).collect::<Vec<_>>()
    };
    let directions = |number: usize| {
        let [x, y, z] = sources[number].directions.each_ref();
        x.iter().zip(y).zip(z).map(|((&x, &y), &z)| Vec3::new(x, y, z)).collect::<Vec<_>>()
    };
    assert_eq!((origins(0)[0].y, origins(0)[39].y), (-4.0, 4.0));
    origins(1).iter().for_each(|o| assert!(o.x == 0.0 && (o.length() - 3.0).abs() < 1e-12));
    directions(1).iter().for_each(|d| assert_eq!(*d, Vec3::X));
    directions(2).iter().for_each(|d| close(d.z, 0.75_f64.sqrt()));
    close(directions(3)[39].y, 0.5);
    origins(4).iter().for_each(|o| assert!(o.x.abs() <= 1.0 && o.y.abs() <= 1.5 && o.z == 0.0));
    directions(5).iter().for_each(|d| assert!(d.z >= 0.0));
    origins(6).iter().for_each(|o| assert!((o.x / 2.0).hypot(o.y) <= 1.0));
    origins(7)
        .iter()
        .for_each(|o| assert!(o.x.abs() <= 2.0 && o.y.abs() <= 1.0 && (o.z + 5.0).abs() < 1e-12));
    let red = sources[0].wavelength_nm.iter().filter(|&&wavelength| wavelength == 656.3).count();
    let blue = sources[0].wavelength_nm.iter().filter(|&&wavelength| wavelength == 486.1).count();
    assert!(red + blue == 40 && red > blue, "{red} {blue}");
    for number in 1..4 {
        assert!(sources[number].wavelength_nm.iter().all(|wavelength| (400.0..=700.0).contains(wavelength)));
    }
    assert!(sources[4].wavelength_nm.iter().all(|&wavelength| wavelength == 633.0));
}

/// A grid or rings have their own number of rays; a spiral and random points have any number.
#[test]
fn ways_of_sampling() {
    let count = |way: &str| {
        let text =
            format!("[optics]\n[[optics.source]]\nbeam = {{ circle = 2, rays = 100, sampling = '{way}' }}");
        let optics = read(&text);
        let rays = optics.sources.rays(0..u64::MAX);
        let squares = rays.origins[0].iter().zip(&rays.origins[1]).map(|(x, y)| x * x + y * y);
        // the mean square distance from the centre of a uniform disc
        let mean = squares.zip(&rays.power).map(|(square, power)| square * power).sum::<f64>();
        assert!((mean - 0.5).abs() < if way == "random" { 0.12 } else { 0.03 }, "{way} {mean}");
        rays.len()
    };
    assert_eq!(["fibonacci", "random", "grid", "hexapolar"].map(count), [100, 100, 100, 127]);
    let twice =
        "[optics]\n[[optics.source]]\npoint = { angle = 2, rays = 5, random = true, sampling = 'grid' }";
    assert_eq!(problems(twice), "4:41 `random` is superfluous: `sampling` has precedence.\n");
    let unknown = "[optics]\n[[optics.source]]\npoint = { angle = 2, rays = 5, sampling = 'gird' }";
    assert!(problems(unknown).contains("Did you mean `grid`?"), "{}", problems(unknown));
}

/// Malus's law: a polariser at an angle transmits the square of its cosine of light polarised along
/// x.
#[test]
fn polarised_sources() {
    let through = |stokes: &str, degrees: f64| {
        let text = format!(
            "[optics]
            polarised = true
            [[optics.sheet]]
            name = 'filter'
            circle = 20
            action = {{ polariser = {degrees} }}
            transform = [{{ translate = [0, 0, 5] }}]
            [[optics.sheet]]
            name = 'screen'
            circle = 20
            action = 'absorb'
            transform = [{{ translate = [0, 0, 9] }}]
            [[optics.source]]
            beam = {{ circle = 4, rays = 9 }}
            stokes = {stokes}"
        );
        Run::new(&read(&text)).absorbed("screen")
    };
    for degrees in [0.0, 30.0, 45.0, 90.0] {
        let cosine = f64::to_radians(degrees).cos();
        close(through("[1, 1, 0, 0]", degrees), cosine * cosine);
        close(through("[2, 0, 0, 2]", degrees), 0.5);
    }
    close(through("[1, 0, 1, 0]", 45.0), 1.0);
    close(through("[1, 0, 1, 0]", -45.0), 0.0);
    let bad = "[optics]\n[[optics.source]]\nline = { length = 2, rays = 5 }\nstokes = [1, 1, 1, 0]";
    assert!(
        problems(bad).starts_with("5:10 stokes is [1.0, 1.0, 1.0, 0.0]: i, q, u, v must be finite"),
        "{}",
        problems(bad)
    );
}

/// Lambert's law: half of the power is within 45 degrees; with isotropic emission it is 1 - cos 45
/// degrees.
#[test]
fn light_from_an_outline() {
    let within = |emission: &str| {
        let text = format!(
            "[optics]\n[[optics.source]]\ndisc = {{ rectangle = [2, 1], angle = 90, rays = 20000{emission} }}"
        );
        let rays = read(&text).sources.rays(0..u64::MAX);
        assert!(
            rays.origins[0].iter().all(|x| x.abs() <= 1.0) && rays.origins[1].iter().all(|y| y.abs() <= 0.5)
        );
        rays.directions[2].iter().filter(|&&z| z > 0.5_f64.sqrt()).count() as f64 / 20000.0
    };
    // four standard deviations are 0.014
    assert!((within("") - 0.5).abs() < 0.014);
    assert!((within(", emission = 'isotropic'") - (1.0 - 0.5_f64.sqrt())).abs() < 0.014);
}
