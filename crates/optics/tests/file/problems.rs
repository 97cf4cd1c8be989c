//! Messages for invalid tables.

use super::{BENCH, problems, read_with};

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
    let expected = format!("9:12 unknown branches `boht`: the choices are ideal, both, random. Did you mean `both`?
10:1 unknown key `polarized` in `optics`: the keys are branches, polarised, generation_limit, threshold, seed, medium, face, sheet, source. Did you mean `polarised`?
11:13 `threshold` is -1: it must be finite and at least 0.
13:9 no glass is named \"N-BK77\": the catalogue has {} glasses. Did you mean N-BK7?
14:1 unknown medium `water`: the choices are world, glass.
16:1 unknown face `lens.frnt`: the choices are lens.lens. Did you mean `lens.lens`?
17:1 unknown region `lesn`: the choices are lens. Did you mean `lens`?
18:26 `mirror` is 1.5: it must be from 0 to 1.
19:20 `coated` is a list of 2 values: it must be a list of 3 numbers.
21:8 two elements are called `lens`: element names must be unique, since results refer to them. Rename one of them.
22:10 diameter of the aperture is -40: it must be finite and greater than 0. Did you mean 40?
23:10 unknown action `absorbed`: the choices are absorb, record, mirror, splitter, thin_lens, grating, polariser, retarder. Did you mean `absorb`?
24:1 `optics.sheet` has no `name`: it is required.
24:1 opening of the stop is 20 x 20 and its outline 10 x 10: the stop would have no rim. Are the two swapped?
27:24 `thin_lens` is 0: it must be finite and not 0.
28:14 the transform is singular: it has no inverse. Check for a scale factor of 0.
30:8 `beam` has no `rays`: it is required.
30:23 unknown key `ray` in `beam`: the keys are rays, circle, rectangle, ellipse, waist, random, sampling. Did you mean `rays`?
31:18 unknown parameter `lambda`: it is not defined in [parameters].
32:9 `power` is 0: it must be finite and greater than 0.
35:1 `wedge` conflicts with another key: `optics.source` has exactly one of beam, line, circle, cone, wedge, lamp, point, disc, rays.
37:1 unknown key `baem` in `optics.source`: the keys are beam, line, circle, cone, wedge, lamp, point, disc, rays, wavelength_nm, power, stokes, seed, transform. Did you mean `beam`?
38:17 wavelength 400 nm of the spectrum follows 700 nm: wavelengths must increase. Are they swapped?
", rayweave_optics::glass::glasses().len());
    assert_eq!(problems(text), expected);
}

/// A sheet needs an outline, regardless of its other keys.
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
`rays` is 0: it must be a whole number from 1 to 9007199254740992.
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
