//! Media and their gradients.

use super::{BENCH, Run, close, plate, problems, read, read_with};
use rayweave_math::Vec3;

#[test]
fn media() {
    let with = |media: &str| {
        let text = format!("{}[optics]\nbranches = 'both'\n[optics.medium]\n{media}\n{BENCH}", plate(1.7));
        let run = Run::new(&read(&text));
        ["reflected", "transmitted", "plate"].map(|element| run.absorbed(element))
    };
    // two polished faces of reflectance r reflect 2 r / (1 + r)
    let plates = |n: f64| {
        let r = ((n - 1.0) / (n + 1.0)).powi(2);
        2.0 * r / (1.0 + r)
    };
    let check = |media: &str, expected: f64| {
        let [reflected, transmitted, plate] = with(media);
        assert!(
            (reflected - expected).abs() < 1e-9 && plate < 1e-12,
            "{media}: {reflected} {transmitted} {plate}"
        );
        assert!((transmitted - (1.0 - expected)).abs() < 1e-9, "{media}: {transmitted}");
    };
    check("", plates(1.7));
    check("plate = 1.5", plates(1.5));
    check("plate = '3 / 2'", plates(1.5));
    check("world = 1.7", 0.0);
    // Schott's data sheet of N-BK7 has 1.51872 at 546.07 nm and 1.5168 at 587.56 nm; hardly any light stays inside
    let [reflected, ..] = with("plate = 'N-BK7'");
    assert!((reflected - plates(1.5185)).abs() < 1e-4, "{reflected}");
    close(with("plate = 'absorber'")[2], 1.0);
    close(with("plate = 'mirror'")[0], 1.0);
    // a metal reflects |(n - 1) / (n + 1)|^2 with n = 0.2 + 3 i
    close(with("plate = { n = 0.2, k = 3 }")[0], (0.64 + 9.0) / (1.44 + 9.0));
    // and a faint dye absorbs according to the Beer-Lambert law: 2 mm of it transmit exp(-4 pi k d
    // / wavelength)
    let [_, transmitted, _] = with("plate = { n = 1.7, k = 1e-5 }\nworld = 1.7");
    let through = (-4.0 * std::f64::consts::PI * 1e-5 * 2e6 / 550.0_f64).exp();
    assert!((transmitted - through).abs() < 1e-4, "{transmitted} {through}");
}

#[test]
fn media_without_an_index() {
    let text = "[solid.lens]\nsphere = { radius = 5 }\n[[region]]\nsolid = 'lens'\nmedium = 'glass'\n[medium.glass]\n[optics]\n";
    assert_eq!(
        problems(text),
        "6:10 the medium `glass` has no index: it is neither in [optics.medium] nor, with an `index`, in \
         [medium].\n"
    );
    assert_eq!(
        problems("[solid.lens]\nsphere = { radius = 5 }\n"),
        "0:0 the model has no [optics] table: it defines sources and materials.\n"
    );
}

/// A rod of a quarter pitch focuses parallel light on its far end.
#[test]
fn gradients_of_media() {
    let text = |medium: &str| {
        format!(
            r#"
[solid.rod]
cylinder = {{ radius = 2, height = 10 }}
transform = [{{ rotate_x = 90 }}]
[optics.medium]
rod = {medium}
[[optics.source]]
line = {{ length = 0.02, rays = 3 }}
wavelength_nm = 550
transform = [{{ rotate_x = -90 }}, {{ translate = [0, -20, 0] }}]
"#
        )
    };
    let turned = "transform = [{ rotate_x = 90 }]";
    let run =
        Run::new(&read(&text(&format!("{{ n = 1.6, gradient = {{ selfoc = 'pi / 20' }}, {turned} }}"))));
    for row in run.trace.segments.iter().filter(|row| row.event == rayweave_optics::Event::Escaped) {
        assert!((row.start - Vec3::Y * 5.0).length() < 1e-6, "{}", row.start);
    }
    for medium in [
        "{ glass = 'N-BK7', gradient = { radial = [1, -0.01, 1e-4] } }",
        "{ n = 1.5, k = 1e-9, gradient = { axial = [1, 0.01] } }",
        "{ n = 1.5, gradient = { squared = [1, -0.01] } }",
        "{ n = 1, gradient = { fish_eye = 20 } }",
        "{ n = 1, gradient = { luneburg = 20 } }",
    ] {
        Run::new(&read(&text(medium)));
    }
    for (medium, said) in [
        ("{ n = 1.6, gradient = { selfok = 0.1 } }", "selfok"),
        ("{ n = 1.6, gradient = { luneburg = 0 } }", "radius of the gradient is 0"),
        ("{ n = 1.6, gradient = { axial = [] } }", "gradient has no axial coefficients"),
        ("{ gradient = { selfoc = 0.1 } }", "n"),
        ("{ glass = 'N-BK77', gradient = { selfoc = 0.1 } }", "N-BK77"),
    ] {
        let problems = read_with(&text(medium), &[]).unwrap_err().to_string();
        assert!(problems.contains(said), "{problems}");
    }
}
