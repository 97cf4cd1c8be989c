//! Maps and histograms of hits.

use rayweave_draw::detector::{Histogram, HitPositions, MapPlane, MapScale, histograms_svg, hit_maps_svg};
use rayweave_math::{Bounds, Vec3};
use std::sync::Arc;

/// The heights of the bars of a drawing, in pixels.
fn bars(drawing: &str) -> Vec<f64> {
    let rows = drawing.lines().filter(|line| line.contains("class=\"bar\""));
    let height = |line: &str| line.split("height=\"").nth(1)?.split('"').next()?.parse().ok();
    rows.map(|line| height(line).unwrap()).collect()
}

fn histogram<'a>(name: &'a str, values: &'a [f64]) -> Histogram<'a> {
    Histogram::new(name, "ns", values)
}

const NONE: HitPositions<'_> = HitPositions {
    names: &[],
    sensors: &[],
    positions: [&[]; 3],
    extents: &[],
    cells: None,
    plane: None,
    scale: MapScale::Linear,
    chosen: None,
};

/// Four tiles of 6 mm by 6 mm with 400, 100, 25 hits and one hit.
#[test]
fn a_sensor_with_few_hits_does_not_set_the_scale() {
    let centres = [[-30.0, -30.0], [30.0, -30.0], [-30.0, 30.0], [30.0, 30.0]];
    let (mut positions, mut sensors) = ([vec![], vec![], vec![]], Vec::new());
    for (sensor, (side, [x, y])) in (0u32..).zip([20, 10, 5, 1].into_iter().zip(centres)) {
        for k in 0..side * side {
            let at = |k: i32| 6.0 * (f64::from(k) + 0.5) / f64::from(side) - 3.0;
            positions[0].push(x + at(k % side));
            positions[1].push(y + at(k / side));
            positions[2].push(5.0);
            sensors.push(sensor);
        }
    }
    let names = ["a", "b", "c", "d"].map(Arc::from);
    let half = Vec3::new(3.0, 3.0, 0.5);
    let extents = centres.map(|[x, y]| Some(Bounds::centred(Vec3::new(x, y, 5.5), half)));
    let [x, y, z] = &positions;
    let hits = HitPositions { names: &names, sensors: &sensors, positions: [x, y, z], ..NONE };
    let known = HitPositions { extents: &extents, ..hits };
    // 400 hits on 36 mm2; a map of the single hit alone once had a million million per mm2
    for drawing in [hit_maps_svg(hits, "a", "mm"), hit_maps_svg(known, "a", "mm")] {
        assert!(!drawing.contains("10^") && drawing.contains(">hits / mm\u{b2}<"), "{drawing}");
    }
    // the tile, from 27 to 33
    let drawing = hit_maps_svg(known, "a", "mm");
    let single = &drawing[drawing.find(">d<").unwrap()..];
    assert!([">28<", ">30<", ">32<"].iter().all(|tick| single.matches(tick).count() == 2), "{single}");
    assert!(drawing.contains("class=\"outline\""));
    // sensors of equal size have equal cells: 6 by 6 of a tile, for some 10 of its 400 hits in each, and 1 by 1 if there is only one hit; they come before the title
    assert_eq!(cells(&drawing[drawing.find(">c<").unwrap()..drawing.find(">d<").unwrap()]), 36);
    let alone = HitPositions { sensors: &[3], positions: [&x[525..], &y[525..], &z[525..]], ..known };
    assert_eq!(cells(&hit_maps_svg(alone, "a", "mm")), 1);
    // about 10 hits in a cell
    let many: Vec<f64> = (0..4_000).map(|k| 6.0 * (f64::from(k % 80) + 0.5) / 80.0).collect();
    let rows: Vec<f64> = (0..4_000).map(|k| 6.0 * (f64::from(k / 80) + 0.5) / 50.0).collect();
    let extents = [Some(Bounds::new(Vec3::ZERO, Vec3::new(6.0, 6.0, 1.0)))];
    let many = HitPositions {
        sensors: &[0; 4_000],
        positions: [&many, &rows, &[0.0; 4_000]],
        extents: &extents,
        ..hits
    };
    assert_eq!(cells(&hit_maps_svg(many, "a", "mm")), 400);
    assert_eq!(cells(&hit_maps_svg(HitPositions { cells: Some(3), ..many }, "a", "mm")), 9);
}

/// The number of cells of the first map in a part of a drawing: the closed squares of its paths.
fn cells(drawing: &str) -> usize {
    let paths = drawing.lines().filter(|line| line.contains("class=\"cell\"") && line.contains("<path"));
    paths.map(|line| line.matches('Z').count()).sum()
}

/// A square of hits in the plane x = 5, and two hits on a different sensor.
#[test]
fn maps_are_drawn_in_the_plane_of_the_hits() {
    let y: Vec<f64> = (0..100).map(|k| f64::from(k % 10)).chain([40.0, 40.5]).collect();
    let z: Vec<f64> = (0..100).map(|k| f64::from(k / 10)).chain([7.0, 7.5]).collect();
    let x = vec![5.0; 102];
    let sensors: Vec<u32> = (0..102).map(|k| u32::from(k >= 100)).collect();
    let names = ["wide", "small", "dark"].map(Arc::from);
    let hits = HitPositions { names: &names, sensors: &sensors, positions: [&x, &y, &z], ..NONE };
    let drawing = hit_maps_svg(hits, "a", "mm");
    assert!(drawing.contains("102 hits of 2 of 3 sensors") && !drawing.contains(">dark<"), "{drawing}");
    for (panel, part) in [
        ("all sensors", "102 hits, 100.0 %, projected along x"),
        ("wide", "100 hits, 98.0 %"),
        ("small", "2 hits, 2.0 %"),
    ] {
        let at = drawing.find(&format!(">{panel}<")).unwrap();
        assert!(drawing[at..].contains(part), "{panel}");
    }
    assert_eq!(drawing.matches(">y / mm<").count(), 3);
    assert_eq!(drawing.matches(">z / mm<").count(), 3);
    assert_eq!(drawing.matches(">hits / mm\u{b2}<").count(), 3);
}

/// Square lattices of hits on the six faces of a cube, each in its own plane; with a plane, all maps are in that one.
#[test]
fn each_sensor_has_its_own_plane() {
    let mut positions = [vec![], vec![], vec![]];
    let mut sensors = Vec::new();
    for face in 0..6u32 {
        let (axis, side) = (face as usize / 2, if face % 2 == 0 { -50.0 } else { 50.0 });
        for k in 0..100 {
            let own = [side, f64::from(k % 10), f64::from(k / 10)];
            (0..3).for_each(|j| positions[(axis + j) % 3].push(own[j]));
            sensors.push(face);
        }
    }
    let names: Vec<Arc<str>> = (0..6).map(|face| format!("face {face}").into()).collect();
    let [x, y, z] = &positions;
    let hits = HitPositions { names: &names, sensors: &sensors, positions: [x, y, z], ..NONE };
    let drawing = hit_maps_svg(hits, "a", "mm");
    let labels = |drawing: &str, face: u32| {
        let at = drawing.find(&format!(">face {face}<")).unwrap();
        let label = |name: &str| drawing[at..].find(&format!(">{name} / mm<")).unwrap_or(usize::MAX);
        let mut names = ["x", "y", "z"];
        // the two labels that follow first are those of the map
        names.sort_by_key(|name| label(name));
        let mut own = [names[0], names[1]];
        own.sort_unstable();
        own
    };
    for face in 0..6 {
        assert_eq!(labels(&drawing, face), [["y", "z"], ["x", "z"], ["x", "y"]][face as usize / 2], "{face}");
    }
    // every face is seen from the front: 4 by 4 cells of equal area, 600 hits on 6 squares of 9 mm
    assert!(drawing.contains("600 hits, 100.0 %, projected along"), "{drawing}");
    let side = hit_maps_svg(HitPositions { plane: Some(MapPlane::Xz), ..hits }, "a", "mm");
    for face in 0..6 {
        assert_eq!(labels(&side, face), ["x", "z"], "{face}");
    }
    let sphere = hit_maps_svg(HitPositions { plane: Some("sphere".parse().unwrap()), ..hits }, "a", "mm");
    assert!(sphere.contains(">cos theta<") && sphere.contains(">hits / sr<") && !sphere.contains(">face 0<"));
    assert!(sphere.contains("600 hits, 100.0 %, seen from the origin"), "{sphere}");
    let error = "zz".parse::<MapPlane>().unwrap_err();
    assert_eq!(error.to_string(), "`zz` is not a plane of hit maps: it must be yz, xz, xy or sphere.");
}

/// Three by three tiles of 3 mm at distances of 5 mm, with 400 hits on each but the last one, which has one hit, and none on the middle one.
fn tiles(depth: f64) -> ([Vec<f64>; 3], Vec<u32>, Vec<Option<Bounds>>) {
    let (mut positions, mut sensors, mut extents) = ([vec![], vec![], vec![]], Vec::new(), Vec::new());
    for sensor in 0..9u32 {
        let (x, y) = (5.0 * f64::from(sensor % 3), 5.0 * f64::from(sensor / 3));
        let centre = Vec3::new(x, y, 0.1 + depth);
        extents.push(Some(Bounds::centred(centre, Vec3::new(1.5, 1.5, 0.1))));
        let side = [20, 0, 1][usize::from(sensor == 4) + 2 * usize::from(sensor == 8)];
        for k in 0..side * side {
            let at = |k: i32| 3.0 * (f64::from(k) + 0.5) / f64::from(side) - 1.5;
            positions[0].push(x + at(k % side));
            positions[1].push(y + at(k / side));
            positions[2].push(depth);
            sensors.push(sensor);
        }
    }
    (positions, sensors, extents)
}

/// The cells of the map of all sensors are those of the single maps, so that no colour lies between sensors; the single maps lie as the
/// sensors do.
#[test]
fn cells_fit_the_sensors() {
    let (positions, sensors, extents) = tiles(0.0);
    let names: Vec<Arc<str>> = (0..9).map(|k| format!("tile {k}").into()).collect();
    let [x, y, z] = &positions;
    let hits =
        HitPositions { names: &names, sensors: &sensors, positions: [x, y, z], extents: &extents, ..NONE };
    let drawing = hit_maps_svg(hits, "a", "mm");
    assert!(drawing.contains("2801 hits of 8 of 9 sensors"), "{drawing}");
    let end = drawing.find(">all sensors<").unwrap();
    // 6 by 6 cells of each tile, also of the one without hits
    assert_eq!(cells(&drawing[..end]), 9 * 36);
    let coordinates = |name: &str| {
        let line = drawing.lines().find(|line| line.contains(&format!(">{name}<"))).unwrap();
        let number = |key: &str| line.split(key).nth(1).unwrap().split('"').next().unwrap().parse::<f64>();
        [number(" x=\"").unwrap(), number(" y=\"").unwrap()]
    };
    let place = |k: u32| coordinates(&format!("tile {k}"));
    let [origin, right, above] = [place(0), place(1), place(3)];
    assert!(right[0] > origin[0] && right[1] == origin[1], "{origin:?} {right:?}");
    assert!(above[0] == origin[0] && above[1] < origin[1], "{origin:?} {above:?}");
    assert_eq!(place(8), [place(2)[0], place(6)[1]]);
    // on a logarithmic scale, the single hit has the darkest colour, and cells without hits are grey
    let log = HitPositions { scale: MapScale::Logarithmic, cells: Some(4), ..hits };
    let log = hit_maps_svg(log, "a", "mm");
    let of = |fill: &str| -> usize {
        let paths = log[..log.find(">all sensors<").unwrap()].lines().filter(|line| line.contains(fill));
        paths.map(|line| line.matches('Z').count()).sum()
    };
    assert_eq!((of("#b4b4b4"), of("#440154"), of("#fde725")), (16 + 15, 1, 7 * 16));
}

/// Seen from a distance, each sensor has a marker, also one without hits; with a number of cells, or from nearby, there are cells.
#[test]
fn small_sensors_have_markers_on_the_sphere() {
    let names: Vec<Arc<str>> = (0..9).map(|k| format!("tile {k}").into()).collect();
    for (depth, cells, markers) in [(100.0, None, 9), (100.0, Some(8), 0), (0.0, None, 0)] {
        let (positions, sensors, extents) = tiles(depth);
        let [x, y, z] = &positions;
        let (plane, positions) = (Some(MapPlane::Sphere), [&x[..], y, z]);
        let hits = HitPositions {
            names: &names,
            sensors: &sensors,
            positions,
            extents: &extents,
            plane,
            cells,
            ..NONE
        };
        let drawing = hit_maps_svg(hits, "a", "mm");
        assert_eq!(drawing.matches("class=\"marker\"").count(), markers, "{depth}");
        assert_eq!(drawing.contains(">hits of a sensor<"), markers > 0);
        assert_eq!(drawing.contains(">hits / sr<"), markers == 0);
    }
}

/// Tiles on both sides of a detector: the cells of the map of all sensors are those of a footprint, with the hits of both.
#[test]
fn cells_fit_footprints_of_several_sensors() {
    let (mut positions, mut sensors, mut extents) = tiles(0.0);
    let (far, more, their_extents) = tiles(300.0);
    positions.iter_mut().zip(far).for_each(|(own, far)| own.extend(far));
    sensors.extend(more.iter().map(|sensor| sensor + 9));
    extents.extend(their_extents);
    let names: Vec<Arc<str>> = (0..18).map(|k| format!("tile {k}").into()).collect();
    let [x, y, z] = &positions;
    let hits =
        HitPositions { names: &names, sensors: &sensors, positions: [x, y, z], extents: &extents, ..NONE };
    let hits = HitPositions { cells: Some(3), ..hits };
    let drawing = hit_maps_svg(hits, "a", "mm");
    let all = |drawing: &str| cells(&drawing[..drawing.find(">all sensors<").unwrap()]);
    assert_eq!(all(&drawing), 9 * 9);
    assert!(drawing.contains("5602 hits of 16 of 18 sensors"), "{drawing}");
    // two tiles of one footprint, and each of them
    let two = hit_maps_svg(HitPositions { chosen: Some(&[3, 12]), ..hits }, "a", "mm");
    assert_eq!((all(&two), cells(&two)), (9, 27));
    assert!(two.contains(">tile 3<") && two.contains(">tile 12<") && !two.contains(">tile 0<"), "{two}");
    assert!(two.contains("800 hits of 2 of 18 sensors"), "{two}");
}

#[test]
fn of_many_sensors_those_with_the_most_hits_have_maps() {
    // sensor k has k + 1 hits
    let sensors: Vec<u32> = (0..20).flat_map(|k| std::iter::repeat_n(k, k as usize + 1)).collect();
    let x: Vec<f64> = (0..sensors.len()).map(|k| k as f64).collect();
    let y: Vec<f64> = x.iter().map(|x| 7.0 * x % 13.0).collect();
    let z = vec![0.0; x.len()];
    let names: Vec<Arc<str>> = (0..20).map(|k| format!("sensor {k}").into()).collect();
    let hits = HitPositions { names: &names, sensors: &sensors, positions: [&x, &y, &z], ..NONE };
    let drawing = hit_maps_svg(hits, "a", "mm");
    assert!(drawing.contains("210 hits of 20 sensors; the 16 sensors with the most hits"), "{drawing}");
    for k in 0..20 {
        assert_eq!(drawing.contains(&format!(">sensor {k}<")), k >= 4, "{k}");
    }
    let chosen: Vec<u32> = (0..20).collect();
    let all = hit_maps_svg(HitPositions { chosen: Some(&chosen), ..hits }, "a", "mm");
    assert!((0..20).all(|k| all.contains(&format!(">sensor {k}<"))), "{all}");
    // in the order of their numbers
    let places: Vec<usize> = (4..20).filter_map(|k| drawing.find(&format!(">sensor {k}<"))).collect();
    assert!(places.is_sorted(), "{places:?}");
    let coarse = hit_maps_svg(HitPositions { cells: Some(1), ..hits }, "a", "mm");
    assert!(coarse.matches("class=\"cell\"").count() < drawing.matches("class=\"cell\"").count());
}

#[test]
fn no_hits() {
    assert!(hit_maps_svg(NONE, "a", "mm").contains("no hits"));
    let empty = histograms_svg(&[histogram("time", &[])], "hits");
    assert!(empty.contains("no hits") && !empty.contains("class=\"axis\""), "{empty}");
}

/// 420 nm as wavelengths of photons: from nm to MeV and back. The bar begins at 420 and has a width of 0.5 nm.
#[test]
fn wavelengths_that_rounding_keeps_below_an_edge() {
    const HC: f64 = 1.239_841_984_332_002_6e-3;
    let values = [HC / (HC / 420.0); 100];
    assert!(values[0] < 420.0);
    // the drawings of equal numbers have equal bars, axes and ticks
    let drawing = |values: &[f64]| histograms_svg(&[Histogram::new("wavelength", "nm", values)], "hits");
    assert_eq!(drawing(&values), drawing(&[420.0; 100]));
    // at the lower end of a given range, and at an edge within it
    for range in [[420.0, 480.0], [400.0, 460.0]] {
        let drawing = |values: &[f64]| {
            let own =
                Histogram { range: Some(range), bins: Some(6), ..Histogram::new("wavelength", "nm", values) };
            histograms_svg(&[own], "hits")
        };
        assert_eq!(drawing(&values), drawing(&[420.0; 100]), "{range:?}");
    }
}

/// Bins of a width of 0.2 with 20 values each, up to 10; one value is beyond the axis.
#[test]
fn late_values_do_not_hide_the_others() {
    let values: Vec<f64> = (0..1000).map(|k| (f64::from(k) + 0.5) * 0.01).chain([500.0]).collect();
    let drawing = histograms_svg(&[histogram("time", &values)], "hits");
    assert!(drawing.contains("1001 hits") && drawing.contains("1 beyond the axis"), "{drawing}");
    assert!(drawing.contains("hits per 0.2 ns") && drawing.contains("time / ns"), "{drawing}");
    let bars = bars(&drawing);
    // the axis ends with the bin of the value below which 99.5 % lie
    assert_eq!(bars.len(), 50);
    assert!(bars.iter().all(|height| (height - bars[0]).abs() < 1.0), "{bars:?}");
}

#[test]
fn means_and_single_values() {
    let drawing = histograms_svg(&[histogram("time", &[1.0, 3.0]), histogram("other", &[550.0; 9])], "hits");
    assert!(drawing.contains("2 hits, mean 2 ns, standard deviation 1 ns"), "{drawing}");
    // one bar among empty bins
    assert!(drawing.contains("9 hits, mean 550 ns, standard deviation 0 ns"), "{drawing}");
    assert_eq!(bars(&drawing).len(), 3);
    for values in [&[0.0][..], &[-3.0, 4.0, 1e9], &[f64::NAN, 1.0], &[5e-324, 1e300]] {
        let drawing = histograms_svg(&[histogram("time", values)], "hits");
        assert!(!bars(&drawing).is_empty() && !drawing.contains("NaN"), "{values:?}: {drawing}");
    }
}

/// Bins and range as requested: 5 values in 2 bins of [0, 4], one beyond.
#[test]
fn bins_and_range_can_be_chosen() {
    let values = [0.0, 1.0, 2.5, 4.0, 9.0];
    let chosen = Histogram { bins: Some(2), range: Some([0.0, 4.0]), ..histogram("time", &values) };
    let svg = histograms_svg(&[chosen], "hits");
    assert!(svg.matches("class=\"bar\"").count() == 2 && svg.contains("1 beyond the axis"), "{svg}");
    assert!(svg.contains("hits per 2 ns"), "{svg}");
}
