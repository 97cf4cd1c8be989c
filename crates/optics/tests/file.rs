//! The `[optics]` tables of model files: results against closed forms, and messages for invalid
//! tables.

use rayweave_math::Vec3;
use rayweave_optics::file::{OpticalScene, optics_of};
use rayweave_optics::{Segment, System, Trace, Tracer};
use rayweave_scene::{Diagnostics, parse_with};
use rayweave_trace::Packets;

fn read_with(text: &str, definitions: &[(&str, &str)]) -> Result<OpticalScene, Diagnostics> {
    let owned = |(name, value): &(&str, &str)| ((*name).to_owned(), (*value).to_owned());
    let definitions: Vec<_> = definitions.iter().map(owned).collect();
    let (document, scene) = parse_with(&format!("rayweave = 1\n{text}"), &definitions)?;
    optics_of(&document, &scene)
}

fn read(text: &str) -> OpticalScene {
    read_with(text, &[]).unwrap_or_else(|problems| panic!("{problems}\n{text}"))
}

struct Run {
    system: System,
    trace: Trace,
}

impl Run {
    fn new(optics: &OpticalScene) -> Run {
        let system = optics.assembly.compile().unwrap();
        let trace = Tracer::new(&system, Packets::new).trace(&optics.sources, &optics.settings).unwrap();
        assert!(trace.balance.error().abs() < 1e-12 * trace.balance.emitted);
        Run { system, trace }
    }

    /// The power that ends at an element.
    fn absorbed(&self, element: &str) -> f64 {
        self.trace.balance.absorbed[self.number(element)]
    }

    fn number(&self, element: &str) -> usize {
        self.system.element_names().iter().position(|name| name == element).unwrap()
    }

    /// The segments that end at an element.
    fn at(&self, element: &str) -> Vec<Segment> {
        let number = self.number(element) as i32;
        self.trace.segments.iter().filter(|segment| segment.element == number).collect()
    }
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
}

/// Light along z from z = -10, with two screens: `reflected` behind the source at z = -20, and `transmitted`
/// before it at z = 20, for reflected and transmitted light. Each case adds its element at the origin.
const BENCH: &str = r#"
[[optics.source]]
beam = { circle = 2, rays = 50 }
wavelength_nm = 550
transform = [{ translate = [0, 0, -10] }]
[[optics.sheet]]
name = "reflected"
rectangle = [400, 400]
action = "absorb"
transform = [{ translate = [0, 0, -20] }]
[[optics.sheet]]
name = "transmitted"
circle = 400
action = "absorb"
transform = [{ translate = [0, 0, 20] }]
"#;

/// A plate of an index about the origin.
fn plate(index: f64) -> String {
    format!("[solid.plate]\nbox = {{ size = [60, 60, 2] }}\n[medium.plate]\nindex = {index}\n")
}

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
fn longer_names_of_faces_say_more() {
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
        // polarisation is traced by default if a sheet polarises
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
    // and a faint dye absorbs by the Beer-Lambert law: 2 mm of it transmit exp(-4 pi k d /
    // wavelength)
    let [_, transmitted, _] = with("plate = { n = 1.7, k = 1e-5 }\nworld = 1.7");
    let through = (-4.0 * std::f64::consts::PI * 1e-5 * 2e6 / 550.0_f64).exp();
    assert!((transmitted - through).abs() < 1e-4, "{transmitted} {through}");
}

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

#[test]
fn settings() {
    use rayweave_optics::Branches;
    let text = "[optics]\nbranches = 'random'\npolarised = true\ngeneration_limit = 12\nthreshold = 1e-3\nseed = 5\n";
    let found = read(text).settings;
    assert_eq!((found.branches, found.polarised, found.seed), (Branches::Random, true, 5));
    assert_eq!((found.generation_limit, found.threshold), (12, 1e-3));
    assert_eq!(read("[optics]\n").settings.branches, Branches::Ideal);
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
        // the fractions of the area of a circle of 20: of the circle of 16, and of the small sheet
        // in the way
        assert!((reflected.len() as f64 / 4000.0 - 0.64).abs() < 2e-3, "{}", reflected.len());
        assert!((run.absorbed("stop") - 0.36).abs() < 1e-3);
        reflected
            .iter()
            .for_each(|segment| assert!((segment.end - focus).length() < 1e-12, "{}", segment.end));
    }
}

/// Line, column and message of each problem, one per line.
fn problems(text: &str) -> String {
    let problems = read_with(text, &[]).map(|_| ()).unwrap_err();
    let line = |problem: &rayweave_scene::Diagnostic| {
        let (line, column) = problem.line_column().unwrap_or_default();
        format!("{line}:{column} {}\n", problem.message())
    };
    problems.iter().map(line).collect()
}

#[test]
fn all_problems_at_once() {
    let text = "[solid.lens]
sphere = { radius = 5 }
[[region]]
solid = 'lens'
medium = 'glass'
[medium.glass]
[optics]
branches = 'boht'
polarized = true
threshold = -1
[optics.medium]
glass = 'N-BK77'
water = 1.33
[optics.face]
'lens.frnt' = 'absorber'
'lesn.front' = 'absorber'
'lens.side' = { mirror = 1.5 }
lens = { coated = [[1.38, 0]] }
[[optics.sheet]]
name = 'lens'
circle = -40
action = 'absorbed'
[[optics.sheet]]
circle = 10
opening = { circle = 20 }
action = { thin_lens = 0 }
transform = [{ scale = 0 }]
[[optics.source]]
beam = { circle = 20, ray = 1000 }
wavelength_nm = 'lambda'
power = 0
[[optics.source]]
cone = { angle = 200, rays = 1.5 }
wedge = { angle = 20, rays = 2 }
[[optics.source]]
baem = { circle = 20, rays = 5 }
wavelength_nm = { band = [700, 400] }
";
    let expected = format!("9:12 unknown branches `boht`: it may be ideal, both, random. Did you mean `both`?
10:1 unknown key `polarized` in `optics`: the keys are branches, polarised, generation_limit, threshold, seed, medium, face, sheet, source. Did you mean `polarised`?
11:13 `threshold` is -1: it must be finite and at least 0.
13:9 no glass is named \"N-BK77\": the catalogue has {} glasses. Did you mean N-BK7?
14:1 unknown medium `water`: it may be world, glass.
16:1 unknown face `lens.frnt`: it may be lens.lens. Did you mean `lens.lens`?
17:1 unknown region `lesn`: it may be lens. Did you mean `lens`?
18:26 `mirror` is 1.5: it must be from 0 to 1.
19:20 `coated` is a list of 2 values: it must be a list of 3 numbers.
21:8 two elements are called `lens`: element names must be unique, since results refer to them. Rename one of them.
22:10 diameter of the aperture is -40: it must be finite and greater than 0. Did you mean 40?
23:10 unknown action `absorbed`: it may be absorb, record, mirror, splitter, thin_lens, grating, polariser, retarder. Did you mean `absorb`?
24:1 `optics.sheet` has no `name`: it is required.
24:1 opening of the stop is 20 x 20 and its outline 10 x 10: the stop would have no rim. Are the two exchanged?
27:24 `thin_lens` is 0: it must be finite and not 0.
28:14 the transform is singular: it has no inverse. Check for a scale factor of 0.
30:8 `beam` has no `rays`: it is required.
30:23 unknown key `ray` in `beam`: the keys are rays, circle, rectangle, ellipse, waist, random, sampling. Did you mean `rays`?
31:18 unknown parameter `lambda`: it does not stand in [parameters].
32:9 `power` is 0: it must be finite and greater than 0.
35:1 `wedge` is one too many: `optics.source` has one of beam, line, circle, cone, wedge, lamp, point, disc, rays.
37:1 unknown key `baem` in `optics.source`: the keys are beam, line, circle, cone, wedge, lamp, point, disc, rays, wavelength_nm, power, stokes, seed, transform. Did you mean `beam`?
38:17 wavelength 400 nm of the spectrum follows 700 nm: wavelengths must increase. Are they exchanged?
", rayweave_optics::glass::glasses().len());
    assert_eq!(problems(text), expected);
}

/// A sheet needs an outline, whatever its other keys are.
#[test]
fn outlines_and_values_that_are_missing() {
    let sheet = |rest: &str| problems(&format!("{BENCH}[[optics.sheet]]\nname = 'a'\n{rest}\n"));
    let no_outline = "`optics.sheet` has no `circle` or `rectangle` or `ellipse`: it is required.";
    assert!(sheet("action = 'absorb'").contains(no_outline));
    assert!(sheet("action = 'absorb'\nopening = { circle = 1 }").contains(no_outline));
    // a misspelt key is reported once
    let slip = sheet("action = 'absorb'\ncircel = 3");
    assert!(slip.contains("circle`?") && slip.lines().count() == 1, "{slip}");
    let disc = problems("[optics]\n[[optics.source]]\ndisc = { angle = 10, rays = 5 }\n");
    assert!(disc.contains("`disc` has no `circle` or"), "{disc}");
    assert!(sheet("circle = 3\naction = 'mirror'").contains("action `mirror` has no value"));
    assert!(sheet("circle = 3\naction = { absorb = 1 }").contains("action `absorb` takes no value"));
}

#[test]
fn problems_are_underlined() {
    let text = "[optics]\n[[optics.source]]\nline = { length = 2, rays = 0 }\n";
    let expected = "\
error: `rays` is 0: it must be a whole number from 1 to 9007199254740992.
 --> <text>:4:29
  |
4 | line = { length = 2, rays = 0 }
  |                             ^";
    assert_eq!(read_with(text, &[]).unwrap_err().to_string(), expected);
}

#[test]
fn light_outside_the_range_of_a_medium() {
    let text = "[solid.lens]
sphere = { radius = 5 }
[optics.medium]
lens = 'N-BK7'
[[optics.source]]
line = { length = 2, rays = 2 }
wavelength_nm = [[486.1, 1], [6563, 1]]
";
    let expected = "8:17 the source emits at 486.1 nm to 6563 nm: the index of `N-BK7` is known from 300 nm to 2500 nm.\n";
    assert_eq!(problems(text), expected);
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

/// A grid or rings have their own number of rays; a spiral and random points have any number.
#[test]
fn ways_of_sampling() {
    let count = |way: &str| {
        let text =
            format!("[optics]\n[[optics.source]]\nbeam = {{ circle = 2, rays = 100, sampling = '{way}' }}");
        let optics = read(&text);
        let rays = optics.sources.rays(0..u64::MAX);
        let squares = rays.origins[0].iter().zip(&rays.origins[1]).map(|(x, y)| x * x + y * y);
        // the mean square distance from the middle of an even disc
        let mean = squares.zip(&rays.power).map(|(square, power)| square * power).sum::<f64>();
        assert!((mean - 0.5).abs() < if way == "random" { 0.12 } else { 0.03 }, "{way} {mean}");
        rays.len()
    };
    assert_eq!(["fibonacci", "random", "grid", "hexapolar"].map(count), [100, 100, 100, 127]);
    let twice =
        "[optics]\n[[optics.source]]\npoint = { angle = 2, rays = 5, random = true, sampling = 'grid' }";
    assert_eq!(problems(twice), "4:41 `random` is one too many: `sampling` has precedence.\n");
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
    assert_eq!(bad("conic = -1"), "7:9 a conic constant without a `radius`: the sheet is plane.\n");
    assert_eq!(
        bad("radius = 40\nopening = { circle = 2 }"),
        "8:11 a curved sheet has no opening: only plane stops are supported.\n"
    );
    assert!(
        bad("radius = 10").starts_with("3:1 the aperture of the sheet extends 15 "),
        "{}",
        bad("radius = 10")
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

/// A model in a folder of its own with other files.
fn read_in_folder(name: &str, text: &str, files: &[(&str, &[u8])]) -> Result<OpticalScene, Diagnostics> {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("optics-file-{name}"));
    std::fs::create_dir_all(&folder).unwrap();
    files.iter().for_each(|(file, bytes)| std::fs::write(folder.join(file), bytes).unwrap());
    let model = folder.join("model.toml");
    std::fs::write(&model, format!("rayweave = 1\n{text}")).unwrap();
    let (document, scene) = rayweave_scene::load(&model, &Vec::<(String, String)>::new())?;
    rayweave_optics::file::optics_of(&document, &scene)
}

#[test]
fn rays_from_files() {
    let light = b"power,ox,oy,oz,dx,dy,dz,wavelength_nm\n3,0,0,0,0,0,2,486.1\n1,1,0,0,0,1,0,656.3\n";
    let plain = b"ox,oy,oz,dx,dy,dz\n0,0,0,0,0,1\n0,5,0,0,0,1\n";
    let text = "[optics]
        [[optics.source]]
        rays = { file = 'light.csv' }
        [[optics.source]]
        rays = { file = 'light.csv' }
        power = 8
        transform = [{ translate = [0, 0, 7] }]
        [[optics.source]]
        rays = { file = 'plain.csv' }
        wavelength_nm = 500";
    let files: [(&str, &[u8]); 2] = [("light.csv", light), ("plain.csv", plain)];
    let rays = read_in_folder("rays", text, &files).unwrap().sources.rays(0..u64::MAX);
    assert_eq!(rays.power, [3.0, 1.0, 6.0, 2.0, 0.5, 0.5]);
    assert_eq!(rays.wavelength_nm, [486.1, 656.3, 486.1, 656.3, 500.0, 500.0]);
    assert_eq!(rays.origins[2], [0.0, 0.0, 7.0, 7.0, 0.0, 0.0]);
    assert_eq!(rays.directions[2], [1.0, 0.0, 1.0, 0.0, 1.0, 1.0]);
    assert_eq!(rays.origins[1][5], 5.0);
}

#[test]
fn problems_of_files_of_rays() {
    let problems = |source: &str, csv: &[u8]| {
        let text = format!(
            "[solid.a]\nsphere = {{ radius = 1 }}\n[optics.medium]\na = 'N-BK7'\n[[optics.source]]\n{source}"
        );
        read_in_folder("problems", &text, &[("rays.csv", csv)]).map(|_| ()).unwrap_err().to_string()
    };
    let rays = "rays = { file = 'rays.csv' }";
    let missing = problems("rays = { file = 'none.csv' }", b"");
    assert!(missing.contains("none.csv") && missing.contains("7 |"), "{missing}");
    assert!(problems(rays, b"").contains("the file is empty"));
    assert!(
        problems(rays, b"ox,oy,oz,dx,dy,dz\n").contains("the file has no rays: a source needs at least one.")
    );
    let bad = problems(
        rays,
        b"ox,oy,oz,dx,dy,dz,power\n0,0,0,0,0,1,nan\n0,0,nan,0,0,1,1\n0,0,0,0,0,1,-2\n0,0,0,0,0,1\n",
    );
    for problem in [
        "power is NaN",
        "oz is NaN",
        "power is -2: it must be finite and nonnegative",
        "6 fields: a ray has seven",
    ] {
        assert!(bad.contains(problem), "{bad}");
    }
    let own = problems(
        &format!("{rays}\nwavelength_nm = 500"),
        b"ox,oy,oz,dx,dy,dz,wavelength_nm\n0,0,0,0,0,1,500\n",
    );
    assert!(own.contains("the rays have their own wavelengths"), "{own}");
    let beyond = problems(rays, b"ox,oy,oz,dx,dy,dz,wavelength_nm\n0,0,0,0,0,1,500\n0,0,0,0,0,1,5000\n");
    assert!(beyond.contains("the source emits at 500 nm to 5000 nm"), "{beyond}");
    let slip = problems(rays, b"ox,oy,oz,dx,dy,dz,powr\n0,0,0,0,0,1,500\n");
    assert!(slip.contains("Did you mean power?"), "{slip}");
}
