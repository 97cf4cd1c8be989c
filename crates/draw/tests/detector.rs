//! Maps and histograms of hits.

use rayweave_draw::detector::{Histogram, HitPositions, histograms_svg, hit_maps_svg};

/// The heights of the bars of a drawing, in pixels.
fn bars(drawing: &str) -> Vec<f64> {
    let rows = drawing.lines().filter(|line| line.contains("class=\"bar\""));
    let height = |line: &str| line.split("height=\"").nth(1)?.split('"').next()?.parse().ok();
    rows.map(|line| height(line).unwrap()).collect()
}

fn histogram<'a>(name: &'a str, values: &'a [f64]) -> Histogram<'a> {
    Histogram::new(name, "ns", values)
}

/// A square of hits in the plane x = 5, and two hits on a different sensor.
#[test]
fn maps_are_drawn_in_the_plane_of_the_hits() {
    let y: Vec<f64> = (0..100).map(|k| f64::from(k % 10)).chain([40.0, 40.5]).collect();
    let z: Vec<f64> = (0..100).map(|k| f64::from(k / 10)).chain([7.0, 7.5]).collect();
    let x = vec![5.0; 102];
    let sensors: Vec<u32> = (0..102).map(|k| u32::from(k >= 100)).collect();
    let names = ["wide".to_owned(), "small".to_owned(), "dark".to_owned()];
    let hits = HitPositions { names: &names, sensors: &sensors, positions: [&x, &y, &z], cells: None };
    let drawing = hit_maps_svg(hits, "a", "mm");
    assert!(drawing.contains("102 hits of 2 sensors") && !drawing.contains(">dark<"), "{drawing}");
    for (panel, part) in
        [("all sensors", "102 hits, 100.0 %"), ("wide", "100 hits, 98.0 %"), ("small", "2 hits, 2.0 %")]
    {
        let at = drawing.find(&format!(">{panel}<")).unwrap();
        assert!(drawing[at..].contains(part), "{panel}");
    }
    assert_eq!(drawing.matches(">y / mm<").count(), 3);
    assert_eq!(drawing.matches(">z / mm<").count(), 3);
    assert_eq!(drawing.matches(">hits / mm\u{b2}<").count(), 3);
}

#[test]
fn of_many_sensors_those_with_the_most_hits_have_maps() {
    // sensor k has k + 1 hits
    let sensors: Vec<u32> = (0..20).flat_map(|k| std::iter::repeat_n(k, k as usize + 1)).collect();
    let x: Vec<f64> = (0..sensors.len()).map(|k| k as f64).collect();
    let y: Vec<f64> = x.iter().map(|x| 7.0 * x % 13.0).collect();
    let z = vec![0.0; x.len()];
    let names: Vec<String> = (0..20).map(|k| format!("sensor {k}")).collect();
    let hits = HitPositions { names: &names, sensors: &sensors, positions: [&x, &y, &z], cells: None };
    let drawing = hit_maps_svg(hits, "a", "mm");
    assert!(drawing.contains("210 hits of 20 sensors; the 16 sensors with the most hits"), "{drawing}");
    for k in 0..20 {
        assert_eq!(drawing.contains(&format!(">sensor {k}<")), k >= 4, "{k}");
    }
    // in the order of their numbers
    let places: Vec<usize> = (4..20).filter_map(|k| drawing.find(&format!(">sensor {k}<"))).collect();
    assert!(places.is_sorted(), "{places:?}");
    let coarse = hit_maps_svg(HitPositions { cells: Some(1), ..hits }, "a", "mm");
    assert!(coarse.matches("class=\"cell\"").count() < drawing.matches("class=\"cell\"").count());
}

#[test]
fn no_hits() {
    let hits = HitPositions { names: &[], sensors: &[], positions: [&[]; 3], cells: None };
    assert!(hit_maps_svg(hits, "a", "mm").contains("no hits"));
    let empty = histograms_svg(&[histogram("time", &[])], "hits");
    assert!(empty.contains("no hits") && !empty.contains("class=\"axis\""), "{empty}");
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
