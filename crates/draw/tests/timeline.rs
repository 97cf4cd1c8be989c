//! Time lines, read back from the drawing: shapes of waves, texts, and well-formedness.

use rayweave_draw::{Timeline, ray_timeline};
use rayweave_math::Vec3;
use rayweave_rootray::{RootRay, Side};
use rayweave_scene::{Compiled, parse};
use rayweave_shape::Ray;
use rayweave_trace::Weave;

fn ray(start: Side, times: &[f64]) -> RootRay {
    RootRay::from_times(start, times.iter().copied()).unwrap()
}

/// The attribute of every element of a class, in order.
fn attributes<'s>(svg: &'s str, class: &str, attribute: &str) -> Vec<&'s str> {
    let (class, attribute) = (format!("class=\"{class}\""), format!(" {attribute}=\""));
    let elements = svg.lines().filter(|line| line.contains(&class));
    elements.filter_map(|line| line.split_once(&attribute)?.1.split_once('"').map(|parts| parts.0)).collect()
}

/// The texts of a class, in order.
fn texts<'s>(svg: &'s str, class: &str) -> Vec<&'s str> {
    let class = format!("<text class=\"{class}\"");
    let elements = svg.lines().filter(|line| line.starts_with(&class));
    elements.map(|line| line.trim_end_matches("</text>").rsplit_once('>').unwrap().1).collect()
}

/// The numbers that follow a letter of a path.
fn numbers(path: &str, letter: char) -> Vec<f64> {
    let parts = path.split(letter).skip(1);
    let end = |part: &str| part.find(|c: char| c.is_ascii_alphabetic() || c == ' ').unwrap_or(part.len());
    parts.map(|part| part[..end(part)].parse().unwrap()).collect()
}

#[test]
fn the_first_example_of_hit_arrays() {
    let a = ray(Side::Outside, &[1.0, 4.0, 5.0, 10.0]);
    let b = ray(Side::Outside, &[0.0, 2.0, 3.0, 5.0, 6.0, 7.0, 8.0, 9.0, 11.0, 12.0]);
    let mut timeline = Timeline::new();
    timeline.title("two surfaces").operand("A", &a).operand("B", &b);
    let svg = timeline.result("A - B", &(&a - &b)).to_svg();
    assert_eq!(texts(&svg, "title"), ["two surfaces"]);
    assert_eq!(texts(&svg, "name"), ["A", "B", "count"]);
    assert_eq!(texts(&svg, "result"), ["A - B"]);
    let roots = "1 4 5 10 0 2 3 5 6 7 8 9 11 12 2 3 5 6 7 8 9 10";
    assert_eq!(texts(&svg, "number").join(" "), roots);

    // all on the same scale x = x0 + t * unit: every root of every row, of areas and of lines
    let waves = attributes(&svg, "wave", "d");
    assert_eq!(waves.len(), 4);
    let (left, right) = (numbers(waves[1], 'H')[0], numbers(waves[1], 'H')[9]);
    let place = |t: f64| left + t / 12.0 * (right - left);
    let at = |path: &str, times: &[f64]| {
        let found = numbers(path, 'H');
        assert_eq!(found.len(), times.len() + 1);
        found.iter().zip(times).all(|(x, t)| (x - place(*t)).abs() < 0.02)
    };
    assert!(at(waves[0], &[1.0, 4.0, 5.0, 10.0]));
    assert!(at(waves[1], &[0.0, 2.0, 3.0, 5.0, 6.0, 7.0, 8.0, 9.0, 11.0, 12.0]));
    assert!(at(waves[3], &[2.0, 3.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]));
    let starts = attributes(&svg, "solid", "x");
    let starts: Vec<f64> = starts.iter().map(|x| x.parse().unwrap()).collect();
    for (start, t) in starts.iter().zip([2.0, 5.0, 7.0, 9.0]) {
        assert!((start - place(t)).abs() < 0.02, "{start} {t}");
    }

    // the heights show the count 1 2 1 2 1 1(5) 2 1 2 1 0 1 0; all steps are equally high
    let heights = numbers(waves[2], 'V');
    let counts = [1.0, 2.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0, 2.0, 1.0, 0.0, 1.0, 0.0];
    let zero = heights[10];
    let step = zero - heights[0];
    assert!(step > 5.0);
    assert!(heights.iter().zip(counts).all(|(y, n)| (zero - y - n * step).abs() < 0.02));

    // both operands change at 5
    let tied = attributes(&svg, "tied", "d");
    assert_eq!(numbers(tied[0], 'M').len(), 1);
    assert!((numbers(tied[0], 'M')[0] - place(5.0)).abs() < 0.02);
}

#[test]
fn waves_without_ends_have_arrows() {
    let arrows = |ray: &RootRay| {
        let svg = Timeline::new().operand("x", ray).to_svg();
        attributes(&svg, "arrow", "d").len()
    };
    assert_eq!(arrows(&RootRay::empty()), 0);
    assert_eq!(arrows(&RootRay::universe()), 2);
    assert_eq!(arrows(&ray(Side::Inside, &[2.0])), 1);
    assert_eq!(arrows(&ray(Side::Outside, &[2.0])), 1);
    assert_eq!(arrows(&ray(Side::Outside, &[2.0, 3.0])), 0);
    assert_eq!(arrows(&ray(Side::Inside, &[2.0, 3.0])), 2);
}

#[test]
fn names_cannot_break_out() {
    let name = "a\"/><script>&'\u{0}";
    let mut timeline = Timeline::new();
    timeline.title(name).operand(name, &RootRay::<()>::universe());
    let svg = timeline.bands(name, name, [(1.0, name)]).unwrap().to_svg();
    assert!(!svg.contains("<script") && !svg.contains('\u{0}'));
    assert_eq!(texts(&svg, "name"), ["a&quot;/&gt;&lt;script&gt;&amp;&#39;\u{fffd}"]);
    let long = "x".repeat(500);
    let svg = Timeline::new().operand(&long, &RootRay::<()>::universe()).to_svg();
    assert_eq!(texts(&svg, "name")[0].chars().count(), 26);
    assert!(svg.contains(&format!("<title>{long}</title>")));
}

#[test]
fn many_roots_are_thinned() {
    let times: Vec<f64> = (0..5000).map(f64::from).collect();
    let svg = Timeline::new().operand("comb", &ray(Side::Outside, &times)).to_svg();
    let xs = attributes(&svg, "number", "x");
    let xs: Vec<f64> = xs.iter().map(|x| x.parse().unwrap()).collect();
    assert!((20..60).contains(&xs.len()), "{}", xs.len());
    assert!(xs.windows(2).all(|pair| pair[1] - pair[0] > 12.0));
    assert!(attributes(&svg, "guide", "d").is_empty());
    // the wave itself is complete
    assert_eq!(numbers(attributes(&svg, "wave", "d")[0], 'V').len(), 5000);
}

#[test]
fn windows_cut_waves() {
    let a = ray(Side::Outside, &[0.0, 10.0, 20.0, 30.0]);
    let mut timeline = Timeline::new();
    timeline.operand("a", &a);
    let svg = timeline.window(5.0, 25.0).unwrap().to_svg();
    assert_eq!(texts(&svg, "number"), ["10", "20"]);
    let wave = attributes(&svg, "wave", "d")[0];
    let (levels, corner) = (numbers(wave, 'V'), wave.split(['M', 'H']).nth(1).unwrap());
    // the wave begins inside, at the same height as after 20
    let first: f64 = corner.split(' ').nth(1).unwrap().parse().unwrap();
    assert_eq!(first, levels[1]);
    assert!(levels[0] > first);
    for (t_min, t_max) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        let error = Timeline::new().window(t_min, t_max).unwrap_err();
        assert!(error.to_string().contains("is empty"), "{error}");
    }
}

#[test]
fn bands_are_named_and_checked() {
    let mut timeline = Timeline::new();
    let svg = timeline.bands("medium", "", [(0.0, "glass"), (1.0, ""), (2.0, "glass")]);
    let svg = svg.unwrap().to_svg();
    assert_eq!(texts(&svg, "band"), ["glass", "glass"]);
    let fills = attributes(&svg, "solid", "fill");
    assert_eq!(fills.len(), 2);
    assert_eq!(fills[0], fills[1]);
    // the same name has the same colour in all rows, different names have different colours
    let svg = timeline.bands("next", "air", [(0.5, "glass")]).unwrap().to_svg();
    let next = attributes(&svg, "solid", "fill");
    assert_eq!(next[3], fills[0]);
    assert_ne!(next[2], fills[0]);
    for times in [[1.0, 1.0], [1.0, f64::INFINITY], [f64::NAN, 1.0]] {
        let error = Timeline::new().bands("m", "", times.map(|t| (t, "x"))).unwrap_err();
        assert!(error.to_string().contains("`m`"), "{error}");
    }
}

#[test]
fn nothing_overflows() {
    let extremes: [&[f64]; 4] = [&[], &[f64::MIN, f64::MAX], &[5e-324], &[1e8, 1e8 + 1.5e-8]];
    for times in extremes {
        let mut timeline = Timeline::new();
        let svg = timeline.operand("x", &ray(Side::Inside, times)).to_svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
    let empty = Timeline::new().to_svg();
    assert!(empty.starts_with("<svg ") && empty.ends_with("</svg>\n"));
}

#[test]
fn time_lines_show_leaves_once() {
    let (_, scene) = parse(
        "rayweave = 1\n[solid.ball]\nsphere = { radius = 1 }\n[solid.pair]\nexpr = \"ball | ball\"\n\
         [solid.far]\nexpr = \"pair - ~pair\"\ntransform = [{ translate = [3, 0, 0] }]\n[solid.all]\nexpr = \"pair | far\"\n",
    )
    .unwrap();
    let compiled = Compiled::new(&scene).unwrap();
    let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
    let svg = ray_timeline(&scene, None, &compiled, ray, Weave::new).unwrap().to_svg();
    // two waves named `ball`, with numbers where they change
    assert_eq!(svg.matches(">ball<").count(), 2);
    for time in [4, 6, 7, 9] {
        assert!(svg.contains(&format!(">{time}<")), "{time}: {svg}");
    }
    let pair = Compiled::solid(&scene, "pair").unwrap();
    let alone = ray_timeline(&scene, Some("pair"), &pair, ray, Weave::new).unwrap();
    assert_eq!(alone.to_svg().matches(">ball<").count(), 1);
}

#[test]
fn time_lines_of_large_models_show_regions() {
    let mut text = "rayweave = 1\n[solid.ball]\nsphere = { radius = 0.3 }\n".to_owned();
    for k in 0..50 {
        text += &format!("[solid.s{k}]\nexpr = \"ball\"\ntransform = [{{ translate = [{k}, 0, 0] }}]\n");
    }
    let names: Vec<String> = (0..50).map(|k| format!("s{k}")).collect();
    text += &format!("[solid.row]\nexpr = \"{}\"\n", names.join(" | "));
    let (_, scene) = parse(&text).unwrap();
    let compiled = Compiled::new(&scene).unwrap();
    let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
    let svg = ray_timeline(&scene, None, &compiled, ray, Weave::new).unwrap().to_svg();
    assert_eq!(svg.matches(">ball<").count(), 0);
    // as an operand and as the result
    assert!(svg.matches(">row<").count() >= 2, "{svg}");
    // a solid with 2^60 occurrences of one leaf
    let mut text = "rayweave = 1\n[solid.d0]\nsphere = { radius = 1 }\n".to_owned();
    for k in 1..60 {
        text += &format!("[solid.d{k}]\nexpr = \"d{0} | d{0}\"\n", k - 1);
    }
    let (_, scene) = parse(&text).unwrap();
    let compiled = Compiled::new(&scene).unwrap();
    assert!(ray_timeline(&scene, None, &compiled, ray, Weave::new).unwrap().to_svg().contains(">d59<"));
}
