//! Diagnostics of invalid files.

use rayweave_scene::{Diagnostics, Severity, load, parse, parse_with};
use std::path::PathBuf;

/// The head of every file below, on one line so that the line numbers stay small.
const HEAD: &str = "rayweave = 1\n";

fn problems(text: &str) -> Diagnostics {
    match parse(&format!("{HEAD}{text}")) {
        Ok((_, scene)) => scene.warnings,
        Err(problems) => problems,
    }
}

/// Line, column and message of each problem, one per line.
fn listed(problems: &Diagnostics) -> String {
    let line = |problem: &rayweave_scene::Diagnostic| {
        let (line, column) = problem.line_column().unwrap_or_default();
        let mark = match problem.severity() {
            Severity::Error => "",
            Severity::Warning => "warning: ",
        };
        format!("{line}:{column} {mark}{}", problem.message())
    };
    problems.iter().map(line).collect::<Vec<_>>().join("\n")
}

fn check(text: &str, expected: &str) {
    assert_eq!(listed(&problems(text)), expected, "{text}");
}

#[test]
fn rendered_with_the_line_underlined() {
    let text = "[solid.front]\nsphere = { radius = -5 }\n[solid.lens]\nexpr = 'frnt & front'\n";
    let expected = "\
error: sphere: radius is -5: radius must be finite and greater than 0. Did you mean 5?
 --> <text>:3:21
  |
3 | sphere = { radius = -5 }
  |                     ^^

error: unknown solid `frnt`: there is no [solid.frnt]. Did you mean `front`?
 --> <text>:5:9
  |
5 | expr = 'frnt & front'
  |         ^^^^";
    assert_eq!(problems(text).render(false), expected);
    // programs print `error: ` before the text of any error
    assert_eq!(format!("error: {}", problems(text)), expected);
    let coloured = problems(text).render(true);
    assert!(coloured.contains("\u{1b}[") && !expected.contains('\u{1b}'));
}

#[test]
fn an_unknown_parameter_does_not_hide_other_problems() {
    check(
        "[solid.a]\ncylinder = { radius = -2, heigth = 'H*2', length = 3 }",
        "3:23 cylinder: radius is -2: radius must be finite and greater than 0. Did you mean 2?\n\
         3:27 cylinder: unknown parameter `heigth`: the parameters are radius, height. Did you mean `height`?\n\
         3:43 cylinder: unknown parameter `length`: the parameters are radius, height. Did you mean `height`?",
    );
    check(
        "[solid.a]\ntube = { outer = 3, inner = 2 }",
        "3:10 tube: unknown parameter `outer`: the parameters are outer_radius, inner_radius, height. Did you mean `outer_radius`?\n\
         3:21 tube: unknown parameter `inner`: the parameters are outer_radius, inner_radius, height. Did you mean `inner_radius`?",
    );
}

#[test]
fn rendered_with_another_place() {
    let text = "[solid.a]\nsphere = { radius = 1 }\n[[region]]\nsolid = 'a'\n[[region]]\nsolid = 'a'\n";
    let expected = "\
error: there are two regions called `a`: results refer to regions by name. Give one of them a different `name`.
 --> <text>:7:9
  |
7 | solid = 'a'
  |         ^^^
  |
 ::: <text>:5:9
  |
5 | solid = 'a'
  |         --- the first one";
    assert_eq!(problems(text).render(false), expected);
    let list = problems(text);
    let notes: Vec<_> = list.iter().next().unwrap().notes().collect();
    assert_eq!(notes, [(5, 9, "the first one")]);
}

#[test]
fn syntax() {
    check(
        "a = \nb == 2\n[c\n",
        "2:5 invalid TOML: string values must be quoted, expected literal string.\n3:4 invalid TOML: extra `=`, expected nothing.\n3:6 invalid TOML: unexpected key or value, expected newline, `#`.\n4:3 invalid TOML: unclosed table, expected `]`. The file ends here: is it complete?",
    );
    check("[solid.a]\nsphere = { radius = 1 }\n[solid.a]\n", "4:8 invalid TOML: duplicate key.");
    check("[parameters]\nR = 1\nR = 2\n", "4:1 invalid TOML: duplicate key.");
    // a syntax error does not hide problems elsewhere
    let both = listed(&problems("unti = 'mm'\nx = [1\n"));
    assert!(both.starts_with("2:1 unknown key `unti`"), "{both}");
    assert!(both.contains("unclosed array"), "{both}");
    let deep = format!("a = {}", "[".repeat(100_000));
    let said = listed(&problems(&deep));
    assert!(said.contains("max recursion depth"), "{said}");
}

#[test]
fn the_top_level() {
    check("unit = 'mn'", "2:8 unknown unit `mn`: the choices are nm, um, mm, cm, m, km, in, ft.");
    check("unit = 3", "2:8 `unit` is the number 3: it must be a string.");
    check(
        "solis = 3",
        "2:1 unknown key `solis`: outside tables there are only rayweave and unit. Did you mean `solid`?",
    );
    check(
        "[solids.a]\n[optics]\n",
        "2:2 warning: the table `solids` is not used: the tables are parameters, solid, region, medium, camera, light, render, optics, photons, gdml. Did you mean `solid`?",
    );
    check("[optics]\nanything = 1\n", "");
    check("[solid]\nsphere = 3", "3:10 `solid.sphere` is the number 3: it must be a table.");
    check("solid = 3", "2:9 `solid` is the number 3: it must be named tables, such as [solid.name].");
    check("[region]\n", "2:1 `region` is a table: it must be a list of tables, such as [[region]].");
    check(
        "k = 1e999",
        "2:1 unknown key `k`: outside tables there are only rayweave and unit.\n2:5 1e999 is too large: the largest number is about 1.8e308. Did you mean `inf`?",
    );
}

#[test]
fn versions() {
    let message = |text: &str| match parse(text) {
        Ok((_, scene)) => listed(&scene.warnings),
        Err(problems) => listed(&problems),
    };
    assert_eq!(message("rayweave = 2"), "1:12 unknown version 2: this program reads version 1.");
    assert_eq!(message("rayweave = 'x'"), "1:12 `rayweave` is a string: this program reads version 1.");
    assert_eq!(
        message(""),
        "0:0 warning: the format version is missing: future versions may read the file differently. \
         Add `rayweave = 1` as the first line.\n0:0 warning: the model is empty: it has no solid. \
         Define one, such as `[solid.ball]` with `sphere = { radius = 1 }`."
    );
}

#[test]
fn parameters() {
    check(
        "[parameters]\na = 'b + 1'\nb = '2 * c'\nc = 'a'\n[solid.s]\nsphere = { radius = 'a' }",
        "5:6 the parameter `a` depends on itself: a -> b -> c -> a.",
    );
    check(
        "[parameters]\na = 'a'\n[solid.s]\nsphere = { radius = 'a' }",
        "3:6 the parameter `a` depends on itself: a -> a.",
    );
    check(
        "[parameters]\nradius = 1\n[solid.s]\nsphere = { radius = '2 * raduis' }",
        "5:26 unknown parameter `raduis`: it is not defined in [parameters]. Did you mean `radius`?",
    );
    check(
        "[parameters]\nx = 1\n[optics]\n",
        "3:1 warning: the parameter `x` is not used: nothing in the file refers to it.",
    );
    check("[parameters]\nx = 1\n[optics]\ny = 'x'\n", "");
    check(
        "[parameters]\npi = 3\n",
        "3:1 no parameter can be called `pi`: it is a constant of arithmetic expressions.",
    );
    check("[parameters]\nx = nan\n", "3:5 `x` is nan: it must be a number.");
    check("[parameters]\nx = true\n", "3:5 `x` is `true`: it must be a number or an arithmetic expression.");
    check(
        "[parameters]\nx = '1 / (1 - 1)'\ny = 'x + 1'\n[solid.s]\nsphere = { radius = 'y' }\n",
        "3:8 division by zero: the divisor of 1 / 0 is zero.",
    );
    check(
        "[parameters]\nx = '''\n1 +\n 2 2'''\n",
        "5:4 an operator is missing before this: the operators are + - * / ^.",
    );
    // for a string with escapes, the span is the whole string
    check(
        "[parameters]\nx = \"1 \\u002b\"\n",
        "3:5 the expression ends too early: a number or a parameter is missing.",
    );
}

#[test]
fn long_cycles_are_shortened() {
    let chain: String = (0..1000).map(|k| format!("p{k} = 'p{}'\n", (k + 1) % 1000)).collect();
    check(
        &format!("[parameters]\n{chain}"),
        "1002:9 the parameter `p0` depends on itself: \
         p0 -> p1 -> p2 -> p3 -> p4 -> p5 -> p6 -> p7 -> p8 -> .. -> p999 -> p0.",
    );
}

/// Expressions without quotation marks, which are not TOML.
#[test]
fn unquoted_expressions() {
    let hint = |text: &str| listed(&problems(text));
    for (text, written) in [
        ("[solid.s.cylinder]\nradius = 2\nheight = t\n", "height = \"t\""),
        ("[solid.s]\ncylinder = { radius = 2, height = h }", "height = \"h\""),
        ("[solid.s]\ncylinder = { height = 2 * max(h, 3), radius = 2 } # note", "height = \"2 * max(h, 3)\""),
        ("[solid.s]\nbox = { size = [a + 1, 2, 3] }", "\"a + 1\""),
        ("[solid.s]\nbox = { size = [2, b, 3] }", "\"b\""),
        ("[parameters]\nw = 2*3\n", "w = \"2*3\""),
    ] {
        let found = hint(text);
        let expected = format!(" Write an expression as a string: `{written}`.");
        assert!(found.contains("invalid TOML: ") && found.contains(&expected), "{text}\n{found}");
    }
    for text in
        ["[solid.s]\nsphere = { radius = }\n", "[solid.s\n", "unit = 'mm\n", "x = 1 2\n", "a = [1, 2\n"]
    {
        assert!(!hint(text).contains("Write an expression"), "{text}\n{}", hint(text));
    }
    assert!(!hint("[[region]\nsolid = 'a'\n").contains("Write an expression"));
}

/// Files that end early, and a mistake before the end.
#[test]
fn truncated_files() {
    let ball = "[solid.a]\nsphere = { radius = 1 }\n";
    for end in ["[[region]", "[solid.b", "x = { radius = 1", "name = \"abc", "x = [1, 2\n\n"] {
        let found = listed(&problems(&format!("{ball}{end}")));
        assert!(found.ends_with(". The file ends here: is it complete?"), "{end}\n{found}");
    }
    let found = listed(&problems(&format!("[[region]\n{ball}")));
    assert!(!found.contains("The file ends here"), "{found}");
}

#[test]
fn shapes() {
    let shapes: Vec<&str> = rayweave_shape::primitive::MANUALS.iter().map(|manual| manual.name).collect();
    check(
        "[solid.s]\nsphre = { radius = 1 }",
        &format!(
            "3:1 unknown shape `sphre`: the shapes are {}; a solid can also be an `extrude`, `revolve`, `expr` or `place`. Did you mean `sphere`?",
            shapes.join(", ")
        ),
    );
    let unknown = |word: &str, hint: &str| {
        check(
            &format!("[solid.s]\n{word} = {{ radius = 1 }}"),
            &format!(
                "3:1 unknown shape `{word}`: the shapes are {}; a solid can also be an `extrude`, `revolve`, `expr` or `place`. {hint}",
                shapes.join(", ")
            ),
        );
    };
    // words of OpenSCAD and of other programs
    unknown("difference", "Combine named solids with `expr = \"a - b\"`.");
    unknown("union", "Combine named solids with `expr = \"a | b\"`.");
    unknown("intersection", "Combine named solids with `expr = \"a & b\"`.");
    unknown("rotate_extrude", "Did you mean `revolve`?");
    unknown("linear_extrude", "Did you mean `extrude`?");
    check(
        "[solid.s]\ncylinder = { radius = 2, height = 3, center = true }",
        "3:38 cylinder: unknown parameter `center`: the parameters are radius, height. Shapes are centred about the origin of their frame: \
         leave it out, or move the solid with a `transform`.",
    );
    check(
        "[solid.s]\nsphere = { radius = 2, is_round = true }",
        "3:24 sphere: unknown parameter `is_round`: the parameters are radius.",
    );
    check(
        "[solid.s]\n",
        "2:1 the solid has no shape: it needs a shape, `extrude`, `revolve`, `expr` or `place`.",
    );
    check(
        "[solid.s]\nsphere = 5",
        "3:10 `sphere` is the number 5: it must be a table of its parameters, such as { radius = .. }.",
    );
    check(
        "[solid.s]\nsphere = { radius = 1 }\nexpr = 'empty'",
        "3:1 the solid has both `expr` and `sphere`: a solid has one definition; an `expr` combines several solids.",
    );
    check(
        "[solid.s]\nbox = { size = [1, '1 - 1', 3] }",
        "3:20 box: size[1] is 0: size must be finite and greater than 0.",
    );
    check(
        "[solid.s]\nconvex = { planes = [[1, 0, 0, 1], [0, 0, 0, 1]] }",
        "3:36 convex: planes[1] has length zero: a normal must have a direction. Did you mean [0, 0, 1]?",
    );
    check(
        "[solid.s]\nsphere = { radius = true }",
        "3:21 `radius` is `true`: it must be a number or an arithmetic expression.",
    );
    check(
        "[solid.s]\nsphere = { radius = 1 }\ntransfrom = []",
        "4:1 unknown key `transfrom` in `solid.s`: the keys are name, transform, expr, place, extrude, revolve, SHAPES. Did you mean `transform`?"
            .replace("SHAPES", &shapes.join(", "))
            .as_str(),
    );
    check(
        "[solid.empty]\nsphere = { radius = 1 }",
        "2:8 no solid can be called `empty`: the name has a special meaning in expressions.",
    );
}

#[test]
fn expressions() {
    check(
        "[solid.a]\nexpr = 'b | c'\n[solid.b]\nexpr = '~c'\n[solid.c]\nexpr = 'b - a'\n",
        "7:9 the solid `b` is defined in terms of itself: b -> c -> b.\n\
         7:13 the solid `a` is defined in terms of itself: a -> b -> c -> a.",
    );
    check("[solid.a]\nexpr = 'a'\n", "3:9 the solid `a` is defined in terms of itself: a -> a.");
    check("[solid.a]\nexpr = 'x | y & (z'\n", "3:17 unmatched `(`: there is no `)` after it.");
    check(
        "[solid.a]\nexpr = 'x | y'\n",
        "3:9 unknown solid `x`: there is no [solid.x].\n3:13 unknown solid `y`: there is no [solid.y].",
    );
    check("[solid.a]\nexpr = 3\n", "3:8 `expr` is the number 3: it must be a string.");
    check("[solid.a]\nexpr = ''\n", "3:8 the text is empty: the name of a solid is missing.");
}

#[test]
fn transforms() {
    let solid = |transform: &str| format!("[solid.s]\nsphere = {{ radius = 1 }}\ntransform = {transform}");
    check(
        &solid("[{ rotate_x = 90 }, { scale = [1, 0, 1] }]"),
        "4:33 the transform is singular: it has no inverse. Check for a scale factor of 0.",
    );
    check(
        &solid("[{ scale = [1e-8, 1, 1] }, { scale = [1e-8, 1, 1] }]"),
        "4:14 the transform is singular: it has no inverse. Check for a scale factor of 0.",
    );
    check(
        &solid("[{ mirror = [0, 0, 0] }]"),
        "4:26 the normal is the zero vector: it must have a direction.",
    );
    check(
        &solid("[{ rotate = { axis = [0, 0, 1], angle = 90 } }]"),
        "4:25 `rotate` has no `degrees`: it is required.\n4:45 unknown key `angle` in `rotate`: the keys are axis, degrees.",
    );
    check(
        &solid("[{ translate = [1, 2] }, { rotate_x = 1, scale = 2 }]"),
        "4:28 `translate` is a list of 2 values: it must be a list of 3 numbers.\n4:38 the step has 2 maps: a step is one map, because the order of maps matters.",
    );
    check(&solid("[{}]"), "4:14 the step has 0 maps: a step is one map, because the order of maps matters.");
    check(
        &solid("[{ translat = [1, 2, 3] }]"),
        "4:16 unknown key `translat` in `transform`: the keys are translate, rotate_x, rotate_y, rotate_z, rotate, scale, mirror, matrix. Did you mean `translate`?",
    );
    check(
        &solid("[{ matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 2]] }]"),
        "4:14 the matrix is not affine: its last row must be [0, 0, 0, 1].",
    );
    check(&solid("[{ translate = [inf, 0, 0] }]"), "4:29 the number is inf: it must be finite.");
    check(
        &solid("3"),
        "4:13 `transform` is the number 3: it must be a list of steps, such as [{ rotate_x = 90 }].",
    );
}

#[test]
fn placements() {
    let place =
        |layout: &str| format!("[solid.s]\nsphere = {{ radius = 1 }}\n[solid.p]\nplace = {{ {layout} }}");
    check(&place("solid = 'x', at = []"), "5:19 unknown solid `x`: there is no [solid.x].");
    check(
        &place("solid = 's'"),
        "5:9 `place` has no positions: it needs exactly one of grid, ring, at, matrices and file. Write `grid = [3, 2, 1], step = [10, 10, 0]`, for example.",
    );
    check(
        &place("solid = 's', grid = [2, 2.5, 0], step = [1, 1, 1]"),
        "5:35 a number of `grid` is 2.5: it must be a whole number from 1 to 2097152.\n5:40 a number of `grid` is 0: it must be a whole number from 1 to 2097152.",
    );
    check(
        &place("solid = 's', grid = [4000, 4000, 4000], step = [1, 1, 1]"),
        "5:32 the grid has 64000000000 copies: the maximum is 2097152.",
    );
    check(&place("solid = 's', ring = 3"), "5:9 `place` has no `radius`: it is required.");
    check(
        &place("solid = 'p', at = [[0, 0, 0]]"),
        "5:19 the solid `p` is defined in terms of itself: p -> p.",
    );
    check(
        &place("solid = 's', file = 'none.npy'"),
        "5:31 the placements in `none.npy` cannot be used: there is no such file.",
    );
    check(
        &place("solid = 's', at = [1, 2, 3]"),
        "5:29 `at` is one point: it must be a list of points. Write `at = [[x, y, z]]`.",
    );
    check(
        &place("solid = 's', at = [[0, 0, 0]], ring = 3"),
        "5:9 `place` has the positions of ring and at: it needs exactly one of grid, ring, at, matrices and file.",
    );
    check(
        &place("solid = 's', at = [[0, 0]]"),
        "5:30 `at` is a list of 2 values: it must be a list of 3 numbers.",
    );
}

#[test]
fn regions_and_media() {
    let model = |text: &str| format!("[solid.lens]\nsphere = {{ radius = 1 }}\n{text}");
    // a region in the medium of its surroundings has no crossings
    let message = "the region `world` has no medium: a region without `medium` has one of its own name, and `world` is the medium around everything. Rename the solid, or state the `medium` of the region.";
    check("[solid.world]\nsphere = { radius = 1 }\n", &format!("2:8 {message}"));
    check(&model("[[region]]\nsolid = 'lens'\nname = 'world'\n"), &format!("6:8 {message}"));
    parse("rayweave = 1\n[solid.world]\nsphere = { radius = 1 }\n[[region]]\nsolid = 'world'\nmedium = 'world'\n").unwrap();
    check(
        &model("[[region]]\nsolid = 'lnes'\nmedium = 'galss'\ncolour = 'bleu'\n[medium.glass]\nindex = 0\n"),
        "5:9 unknown solid `lnes`: there is no [solid.lnes]. Did you mean `lens`?\n6:10 unknown medium `galss`: there is no [medium.galss]. Did you mean `glass`?\n7:10 `bleu` is not a colour: colours are names such as `red`, or #rgb, #rrggbb or #rrggbbaa in hexadecimal digits. Did you mean `blue`?\n9:9 `index` is 0: it must be finite and greater than 0.",
    );
    check(
        &model("[[region]]\ncolor = '#fff'\n"),
        "4:1 `region` has no `solid`: it is required.\n5:1 unknown key `color` in `region`: the keys are solid, medium, colour, name. Did you mean `colour`?",
    );
    check(
        &model("[medium.glass]\nindx = 1.5\nabbe = 64\n"),
        "5:1 warning: `indx` is not used: additional keys of media are kept only for other programs. Did you mean `index`?",
    );
}

#[test]
fn cameras_lights_and_drawing() {
    check("[camera]\nfov = 30\n", "2:1 `camera` has no `position`: it is required.");
    check(
        "[camera]\nposition = [0, 0, 0]\n",
        "2:1 the camera has no direction of view: its position equals its target.",
    );
    check(
        "[camera]\nposition = [0, 0, 5]\nup = [0, 0, 2]\n",
        "2:1 the direction of view is parallel to `up`: the upward direction of the picture is undefined.",
    );
    check(
        "[camera]\nposition = [0, 0, 5]\nfov = 180\n",
        "4:7 `fov` is 180: it must be an angle in degrees greater than 0 and less than 180.",
    );
    check(
        "[camera]\nposition = [0, 0, 5]\nfov = 30\nprojection = 'orthographic'\n",
        "2:1 `camera` has no `height`: it is required.\n4:1 `fov` has no meaning here: `fov` is for perspective cameras and `height` for orthographic ones.",
    );
    check(
        "[camera]\nposition = [0, 0, 5]\nsize = [0, 1e9]\n",
        "4:9 a side of `size` is 0: it must be a whole number from 1 to 32768.\n4:12 a side of `size` is 1000000000: it must be a whole number from 1 to 32768.",
    );
    check(
        "[[light]]\nintensity = 1\n",
        "2:1 the light has no `direction` and no `position`: it needs one of them.",
    );
    check(
        "[[light]]\ndirection = [0, 0, 0]\n",
        "3:14 the direction is the zero vector: it must have a direction.",
    );
    check(
        "[render]\nshading = 'gouch'\nsamples = 1.5\nedges = 1\n",
        "3:11 unknown shading `gouch`: the choices are gooch, headlight. Did you mean `gooch`?\n4:11 `samples` is 1.5: it must be a whole number from 1 to 16.\n5:9 `edges` is the number 1: it must be true or false.",
    );
}

#[test]
fn overrides() {
    let text = "rayweave = 1\n[parameters]\nradius = 1\n[solid.s]\nsphere = { radius = 'radius' }\n";
    let check = |name: &str, value: &str, expected: &str| {
        let problems = parse_with(text, &[(name.to_owned(), value.to_owned())]).unwrap_err();
        assert_eq!(problems.render(false), expected);
    };
    check(
        "raduis",
        "2",
        "error: unknown parameter `raduis`: the file's parameters are radius. Did you mean `radius`?\n\x20--> <override>:1:1\n  |\n1 | raduis=2\n  | ^^^^^^",
    );
    check(
        "radius",
        "2 +",
        "error: the expression ends too early: a number or a parameter is missing.\n\x20--> <override>:1:11\n  |\n1 | radius=2 +\n  |           ^",
    );
    check(
        "radius",
        "-2",
        "error: sphere: radius is -2: radius must be finite and greater than 0. It is computed with radius = -2.\n\x20--> <text>:5:21\n  |\n5 | sphere = { radius = 'radius' }\n  |                     ^^^^^^^^",
    );
}

#[test]
fn one_problem_neither_hides_nor_causes_others() {
    let text = "unit = 'mn'\n[parameters]\nR = [1]\n\
        [solid.ball]\nsphere = { radius = 'R' }\ntransform = [{ scale = 0 }]\n\
        [solid.cube]\nbox = { size = -1 }\n\
        [solid.both]\nexpr = 'ball & cube & cub'\n\
        [[region]]\nsolid = 'both'\nmedium = 'air'\n";
    check(
        text,
        "2:8 unknown unit `mn`: the choices are nm, um, mm, cm, m, km, in, ft.\n4:5 `R` is a list of 1 value: it must be a number or an arithmetic expression.\n7:14 the transform is singular: it has no inverse. Check for a scale factor of 0.\n9:16 box: size is -1: size must be finite and greater than 0. Did you mean 1?\n11:23 unknown solid `cub`: there is no [solid.cub]. Did you mean `cube`?\n14:10 unknown medium `air`: there is no [medium.air].",
    );
}

fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("rayweave-diagnostics-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn files_that_cannot_be_read() {
    let folder = folder();
    let check = |name: &str, bytes: Option<&[u8]>, expected: &str| {
        let path = folder.join(name);
        if let Some(bytes) = bytes {
            std::fs::write(&path, bytes).unwrap();
        }
        let problems = load(&path, &[]).unwrap_err();
        let expected = expected.replace("FILE", &path.display().to_string());
        let expected = expected.replace("FOLDER", &folder.display().to_string());
        assert_eq!(problems.render(false), expected);
        assert_eq!(problems.iter().next().unwrap().path(), Some(path.as_path()));
    };
    check(
        "none/none.toml",
        None,
        "error: the model file cannot be read: there is no such file. Check the folder `FOLDER/none`: it cannot be read.\n--> FILE",
    );
    check("", None, "error: the model file cannot be read: it is a folder.\n--> FILE");
    check(
        "latin1.toml",
        Some(b"# gr\xf6\xdfe\n"),
        "error: the file is not UTF-8 text: byte 4 is not part of a character. Was it saved in a different encoding?\n --> FILE:1:5\n  |\n1 | # gr\u{fffd}\u{fffd}e\n  |     ^",
    );
    let mut huge = std::fs::File::create(folder.join("huge.toml")).unwrap();
    huge.set_len(300 << 20).unwrap();
    std::io::Write::flush(&mut huge).unwrap();
    check("huge.toml", None, "error: the model file cannot be read: it is larger than 256 MiB.\n--> FILE");
    std::fs::remove_dir_all(&folder).unwrap();
    // a stream without an end
    let endless = rayweave_scene::read_stream(std::io::repeat(b' '));
    assert_eq!(endless.unwrap_err(), "it is larger than 256 MiB");
}

#[test]
fn a_byte_order_mark_and_line_ends_of_windows_are_read() {
    let text = "\u{feff}# Ball.\r\nrayweave = 1\r\n[solid.s]\r\nsphere = { radius = 1 }\r\n";
    let (document, scene) = parse(text).unwrap();
    assert_eq!(document.heading, ["Ball."]);
    assert_eq!(scene.solids.len(), 1);
    let problems = parse(&text.replace("radius = 1", "radius = 0")).unwrap_err();
    assert_eq!(problems.iter().next().unwrap().line_column(), Some((4, 21)));
    // messages show the same lines, also where the place is longer than a line
    for wrong in ["radius = 0", "radius = 1, radius =\n\"\"\"a\nb\"\"\""] {
        let unix = "rayweave = 1\n[solid.s]\nsphere = { radius = 1 }\n".replace("radius = 1", wrong);
        let message = |text: &str| parse(text).unwrap_err().to_string();
        assert_eq!(message(&unix.replace('\n', "\r\n")), message(&unix));
    }
}

#[test]
fn physical_numbers_of_media() {
    let model = |density: &str| {
        format!(
            "rayweave = 1\n[parameters]\nrho = 2\n[solid.a]\nsphere = {{ radius = 'rho' }}\n[medium.a]\ndensity = {density}\n"
        )
    };
    let (_, scene) = parse(&model("7850")).unwrap();
    let warned = scene.warnings.to_string();
    assert!(warned.contains("is 22.6. Did you mean 7.85?"), "{warned}");
    for (density, expected) in [("7.8", 7.8), ("'2 * rho'", 4.0), ("0", 0.0)] {
        let (_, scene) = parse(&model(density)).unwrap();
        assert_eq!(scene.media[1].numbers, [("density".to_owned(), expected)], "{density}");
        assert!(scene.warnings.is_empty(), "{}", scene.warnings);
    }
    for (density, expected) in [
        ("'heavy'", "7:12 unknown parameter `heavy`"),
        ("true", "7:11 `density` is `true`: it must be a number or an arithmetic expression."),
        ("-1", "7:11 `density` is -1: it must be finite and at least 0."),
        ("inf", "7:11 `density` is inf: it must be finite and at least 0."),
    ] {
        let found = listed(&parse(&model(density)).unwrap_err());
        assert!(found.starts_with(expected), "{density}: {found}");
    }
}

#[test]
fn tables_without_a_reader() {
    let found = |table: &str| {
        let text = format!("rayweave = 1\n[solid.a]\nsphere = {{ radius = 1 }}\n[{table}]\nx = 1\n");
        listed(&parse(&text).unwrap().1.warnings)
    };
    assert_eq!(
        found("soild"),
        "4:2 warning: the table `soild` is not used: the tables are parameters, solid, region, medium, camera, light, render, \
         optics, photons, gdml. Did you mean `solid`?"
    );
    assert!(found("lamp").starts_with("4:2 warning: the table `lamp` is not used"));
    assert!(["optics", "photons", "gdml"].iter().all(|table| found(table).is_empty()));
}

/// Thousands of misspelt names among thousands of known ones: only the first get suggestions.
#[test]
fn many_misspelt_names_take_little_time() {
    let count = 3000;
    let solids: String = (0..count)
        .map(|k| format!("[solid.volume_with_long_name_{k}]\nexpr = 'volume_with_lnog_name_{k}'\n"))
        .collect();
    let start = std::time::Instant::now();
    let found = problems(&solids);
    assert!(found.iter().count() >= count);
    let text = found.to_string();
    assert!(text.contains("Did you mean `volume_with_long_name_0`?"), "{}", &text[..500]);
    assert!(text.matches("Did you mean").count() < 100);
    assert!(start.elapsed().as_secs() < 30);
}

#[test]
fn problems_in_a_long_line_do_not_repeat_it() {
    let names: Vec<String> = (0..2000).map(|k| format!("x{k}")).collect();
    let text = format!(
        "solid = {{ {} }}\n",
        names.iter().map(|x| format!("{x} = {{ expr = 'q{x}' }}")).collect::<Vec<_>>().join(", ")
    );
    let found = problems(&text);
    assert!(found.iter().count() >= 2000);
    let rendered = found.to_string();
    assert!(rendered.len() < 400 * 2000, "{}", rendered.len());
    assert!(rendered.contains("--> <text>:2:26"), "{}", &rendered[..300]);
}
