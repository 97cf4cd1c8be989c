//! Lenses shared by several tests.

use rayweave_lens::prescription::{Behind, IMAGE, Prescription, PrescriptionLayout, Surface};
use rayweave_optics::{Beam, Event, Segment, Trace, TraceSettings, Tracer};
use rayweave_trace::Packets;

pub const D_NM: f64 = 587.5618;

pub fn near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found} is not {expected}: off by {:e}",
        found - expected
    );
}

pub fn index(n: f64) -> Behind {
    Behind::Index(n)
}

/// A cemented doublet of crown and flint.
pub fn doublet() -> Prescription {
    Prescription::new(vec![
        Surface::new(61.47, 6.0, Behind::Glass("N-BK7".to_owned())),
        Surface::new(-44.64, 2.5, Behind::Glass("N-SF5".to_owned())),
        Surface::new(-129.94, 95.9, Behind::Air),
    ])
    .entrance_pupil_diameter(25.0)
    .field_angles(&[0.0, 1.5])
}

/// A triplet with its stop behind the second lens.
pub fn triplet() -> Prescription {
    Prescription::new(vec![
        Surface::new(22.0, 3.26, index(1.62)),
        Surface::new(-435.8, 6.0, Behind::Air),
        Surface::new(-22.2, 1.0, index(1.6)),
        Surface::new(20.3, 0.5, Behind::Air),
        Surface::dummy(4.2),
        Surface::new(79.7, 2.95, index(1.62)),
        Surface::new(-18.4, 42.0, Behind::Air),
    ])
    .entrance_pupil_diameter(8.0)
    .field_angles(&[0.0, 10.0])
    .stop_at(5)
}

/// A Cassegrain telescope: a paraboloid with a hole, and a hyperboloid that shares its focus.
pub fn cassegrain() -> Prescription {
    // the primary's focus is 300 behind its vertex and the secondary 240 from it: conjugates 60 behind and
    // 300 in front of the secondary
    let (near, far) = (60.0_f64, 300.0_f64);
    let radius = -2.0 * near * far / (far - near);
    let e = (far + near) / (far - near);
    Prescription::new(vec![
        Surface::new(-600.0, -240.0, Behind::Mirror).conic(-1.0).hole(12.0),
        Surface::new(radius, 300.0, Behind::Mirror).conic(-e * e),
    ])
    .entrance_pupil_diameter(100.0)
}

pub fn trace(layout: &PrescriptionLayout, beam: &Beam) -> Trace {
    let system = layout.assembly.compile().unwrap();
    Tracer::new(&system, Packets::new).trace(beam, &TraceSettings::default()).unwrap()
}

/// The last segment of each ray up to the image.
pub fn at_image(layout: &PrescriptionLayout, beam: &Beam) -> Vec<Segment> {
    let system = layout.assembly.compile().unwrap();
    let image = system.element_names().iter().position(|name| name == IMAGE).unwrap() as i32;
    let found = trace(layout, beam);
    let mut rows: Vec<Segment> = vec![];
    for row in found.segments.iter().filter(|row| row.element == image && row.event == Event::Passed) {
        // keep the last one: on the way to a mirror, light may pass through the image
        match rows.iter_mut().find(|other| other.id == row.id) {
            Some(other) => *other = row,
            None => rows.push(row),
        }
    }
    rows.sort_by_key(|row| row.id);
    rows
}

/// Points evenly distributed over the pupil (Vogel's spiral).
pub fn disk(count: usize, radius: f64) -> Vec<[f64; 2]> {
    let point = |k: usize| {
        let (r, angle) =
            (radius * ((k as f64 + 0.5) / count as f64).sqrt(), 2.399_963_229_728_653 * k as f64);
        [r * angle.cos(), r * angle.sin()]
    };
    (0..count).map(point).collect()
}
