//! Finishes, actions and sheets.

use super::{BENCH, Run, close, plate, problems, read, read_with};
use rayweave_math::Vec3;

/// The power that a plate with a finish reflects, transmits and absorbs.
fn with_finish(index: f64, finish: &str) -> [f64; 3] {
    let run = Run::new(&read(&format!(
        "{}[optics]\nbranches = 'both'\n[optics.face]\n'plate.z-' = {finish}\n{BENCH}",
        plate(index)
    )));
    ["reflected", "transmitted", "plate"].map(|element| run.absorbed(element))
}

#[test]
fn finishes() {
    let check = |index, finish: &str, expected: [f64; 3]| {
        let found = with_finish(index, finish);
        found.into_iter().zip(expected).for_each(|(found, expected)| {
            assert!((found - expected).abs() < 1e-12, "{finish}: {found} is not {expected}")
        });
    };
    check(1.0, "'polished'", [0.0, 1.0, 0.0]);
    check(1.0, "'absorber'", [0.0, 0.0, 1.0]);
    check(1.0, "{ mirror = 0.9 }", [0.9, 0.0, 0.1]);
    check(1.0, "{ splitter = 0.3 }", [0.3, 0.7, 0.0]);
    check(1.0, "{ rough = 0 }", [0.0, 1.0, 0.0]);
    // a quarter wave of the geometric mean transmits all light into the glass; 0.04 is reflected at
    // its back
    check(1.5, "{ coated = [['sqrt(1.5)', 0, '550 / 4 / sqrt(1.5)']] }", [0.04, 0.96, 0.0]);
    let [_, transmitted, plate] = with_finish(1.0, "{ diffuse = 0.8 }");
    close(transmitted, 0.0);
    close(plate, 0.2);
}

#[test]
fn longer_face_keys_have_precedence() {
    let faces = "[optics.face]\n'plate.plate.z-' = { mirror = 0.5 }\nplate = 'absorber'\n'plate.plate' = { mirror = 0.9 }\n";
    let run = Run::new(&read(&format!("{}{faces}{BENCH}", plate(1.5))));
    close(run.absorbed("reflected"), 0.5);
    let run = Run::new(&read(&format!("{}[optics.face]\nplate = 'absorber'\n{BENCH}", plate(1.5))));
    close(run.absorbed("plate"), 1.0);
}

/// The results of a sheet at the origin with an action.
fn with_action(optics: &str, action: &str) -> Run {
    let sheet = format!("[[optics.sheet]]\nname = 'sheet'\nellipse = [30, 40]\naction = {action}\n");
    Run::new(&read(&format!("{optics}{sheet}{BENCH}")))
}

#[test]
fn actions_that_share_the_power() {
    let check = |action: &str, expected: [f64; 3]| {
        let run = with_action("[optics]\nbranches = 'both'\n", action);
        let found = ["reflected", "transmitted", "sheet"].map(|element| run.absorbed(element));
        found.into_iter().zip(expected).for_each(|(found, expected)| close(found, expected));
        run
    };
    check("'absorb'", [0.0, 0.0, 1.0]);
    let recorded = check("'record'", [0.0, 1.0, 0.0]);
    assert_eq!(recorded.at("sheet").len(), 50);
    check("{ mirror = 0.9 }", [0.9, 0.0, 0.1]);
    check("{ splitter = 0.3 }", [0.3, 0.7, 0.0]);
    check("{ thin_lens = -50 }", [0.0, 1.0, 0.0]);
}

#[test]
fn a_thin_lens_has_its_focus_on_the_screen() {
    let run = with_action("", "{ thin_lens = 20 }");
    assert_eq!(run.at("transmitted").len(), 50);
    run.at("transmitted").iter().for_each(|segment| assert!(segment.end.x.hypot(segment.end.y) < 1e-12));
}

/// The grating equation, with lines per inch in a model in inches.
#[test]
fn gratings_and_the_unit_of_the_document() {
    let sine = 600.0 * 550e-6;
    for (unit, lines) in [("mm", "600"), ("in", "'600 * 25.4'")] {
        for (reflects, screen) in [(false, "transmitted"), (true, "reflected")] {
            let action =
                format!("{{ grating = {{ lines = [0, {lines}], order = -1, reflects = {reflects} }} }}");
            let run = with_action(&format!("unit = '{unit}'\n"), &action);
            assert_eq!(run.at(screen).len(), 50);
            for segment in run.at(screen) {
                assert!(
                    (segment.direction.y.abs() - sine).abs() < 1e-12 && segment.direction.x.abs() < 1e-12
                );
            }
        }
    }
}

/// Malus's law, and a half-wave plate that rotates the polarisation to the axis of the second
/// polariser.
#[test]
fn polarising_sheets() {
    let sheet = |name: &str, z: f64, action: &str| {
        format!(
            "[[optics.sheet]]\nname = '{name}'\ncircle = 30\naction = {{ {action} }}\ntransform = [{{ translate = [0, 0, {z}] }}]\n"
        )
    };
    let passed = |sheets: &str| {
        let said =
            Run::new(&read(&format!("[optics]\npolarised = true\n{sheets}{BENCH}"))).absorbed("transmitted");
        // polarisation is traced by default if a sheet affects it
        close(Run::new(&read(&format!("{sheets}{BENCH}"))).absorbed("transmitted"), said);
        said
    };
    let first = sheet("first", -2.0, "polariser = 0");
    close(passed(&first), 0.5);
    close(passed(&(first.clone() + &sheet("second", 2.0, "polariser = 30"))), 0.375);
    let crossed = first + &sheet("second", 2.0, "polariser = 90");
    close(passed(&crossed), 0.0);
    close(passed(&(crossed.clone() + &sheet("plate", 0.0, "retarder = [180, 45]"))), 0.5);
    close(passed(&(crossed + &sheet("plate", 0.0, "retarder = [90, 45]"))), 0.25);
}

/// A parabola reflects light along its axis through its focus, a stop transmits only the middle of
/// the beam.
#[test]
fn a_parabola_has_its_focus_where_the_file_says() {
    let text = "
        unit = 'cm'
        [parameters]
        f = 25
        [solid.blank]
        cylinder = { radius = 10, height = 4 }
        [solid.bowl]
        paraboloid = { focal_length = 'f' }
        [solid.mirror]
        expr = 'blank - bowl'
        [optics.medium]
        mirror = 'mirror'
        [[optics.sheet]]
        name = 'stop'
        circle = 40
        opening = { circle = 16 }
        action = 'absorb'
        transform = [{ translate = [0, 0, 'f + 1'] }]
        [[optics.sheet]]
        name = 'focus'
        circle = 0.2
        action = 'absorb'
        transform = [{ translate = [0, 0, 'f'] }]
        [[optics.source]]
        beam = { circle = 20, rays = 4000 }
        transform = [{ rotate_x = 180 }, { translate = [0, 0, 90] }]";
    for f in ["25", "40"] {
        let run = Run::new(&read_with(text, &[("f", f)]).unwrap());
        let hits = run.at("focus");
        let focus = Vec3::new(0.0, 0.0, f.parse().unwrap());
        let reflected: Vec<_> = hits.iter().filter(|segment| segment.generation == 1).collect();
        // fractions of the area of a circle of diameter 20: the circle of diameter 16, and the
        // small sheet in the way
        assert!((reflected.len() as f64 / 4000.0 - 0.64).abs() < 2e-3, "{}", reflected.len());
        assert!((run.absorbed("stop") - 0.36).abs() < 1e-3);
        reflected
            .iter()
            .for_each(|segment| assert!((segment.end - focus).length() < 1e-12, "{}", segment.end));
    }
}

/// A curved stop blocks the rays that meet its sphere farther from the axis than the radius of the opening.
#[test]
fn curved_stops() {
    let text = "[optics]
        [[optics.sheet]]
        name = 'stop'
        circle = 30
        opening = { circle = 16 }
        radius = -20
        action = 'absorb'
        transform = [{ translate = [0, 0, 20] }]
        [[optics.source]]
        point = { angle = 40, rays = 1000 }";
    let rows = Run::new(&read(text)).at("stop");
    // the height on the sphere is 20 sin(angle); the rays fill the solid angle evenly, and sin(angle) = 0.4 at the opening
    let cosine = |sine: f64| (1.0 - sine * sine).sqrt();
    let end = 40f64.to_radians().cos();
    let expected = (cosine(0.4) - end) / (1.0 - end);
    assert!((rows.len() as f64 / 1000.0 - expected).abs() < 0.01, "{} and {expected}", rows.len());
    rows.iter().for_each(|row| {
        close(row.end.length(), 20.0);
        assert!(row.end.x.hypot(row.end.y) > 8.0);
    });
}

/// Light from the centre of a spherical screen arrives at right angles, after one radius.
#[test]
fn curved_sheets() {
    let text = "[optics]
        [[optics.sheet]]
        name = 'screen'
        circle = 30
        radius = -20
        action = 'absorb'
        transform = [{ translate = [0, 0, 20] }]
        [[optics.source]]
        point = { angle = 40, rays = 100 }";
    let rows = Run::new(&read(text)).at("screen");
    assert_eq!(rows.len(), 100);
    rows.iter().for_each(|row| close(row.end.length(), 20.0));
    let bad = |keys: &str| {
        problems(&format!("[optics]\n[[optics.sheet]]\nname = 'a'\ncircle = 30\naction = 'absorb'\n{keys}"))
    };
    assert_eq!(bad("conic = -1"), "7:9 the sheet has a conic constant without a `radius`: it is plane.\n");
    assert_eq!(
        bad("radius = 40\nopening = { circle = 32 }"),
        "3:1 opening of the stop is 32 x 32 and its outline 30 x 30: the stop would have no rim. Are the two swapped?\n"
    );
    assert!(
        bad("radius = 10").starts_with("3:1 the aperture of the sheet extends 15 "),
        "{}",
        bad("radius = 10")
    );
}
