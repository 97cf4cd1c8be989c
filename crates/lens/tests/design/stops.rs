//! Stops on the faces of lenses: the solids and a sequential trace vignette the same rays.

use crate::lenses::{D_NM, at_image, cassegrain, disk, doublet, index, trace, triplet};
use rayweave_lens::prescription::{
    Behind, MOUNT, Prescription, PrescriptionLayout, STOP, Surface, SystemAperture,
};
use rayweave_optics::Event;
use rayweave_optics::component::Figure;

fn names(layout: &PrescriptionLayout) -> Vec<String> {
    layout.assembly.compile().unwrap().element_names().to_vec()
}

/// The triplet without its dummy surface, with the stop at one of its six surfaces.
fn stopped_at(stop: usize) -> Prescription {
    let mut lens = triplet();
    lens.surfaces.remove(4);
    lens.surfaces[3].thickness += 4.2;
    lens.stop_at(stop)
}

/// Traces a beam of several times the diameter of the entrance pupil through the solids; exactly the rays within the
/// semi-diameter at the stop and within all lenses arrive at the image, in any order of elements.
fn same_rays_pass(lens: &Prescription) {
    let layout = lens.assembly().unwrap();
    let (clear, stop) = (&layout.semi_diameters, lens.stop - 1);
    let SystemAperture::EntrancePupilDiameter(diameter) = lens.aperture else { panic!("no pupil") };
    let wide =
        Prescription { aperture: SystemAperture::EntrancePupilDiameter(2.0 * diameter), ..lens.clone() };
    for field in 0..lens.fields.len() {
        let beam = wide.beam(field, D_NM, &disk(3000, 1.0)).unwrap();
        let rows = at_image(&layout, &beam);
        let passes = |k: &usize| {
            let Ok(points) = lens.follow(&beam.get(*k).ray, D_NM) else { return false };
            let heights: Vec<f64> = points.iter().map(|pass| pass.point.x.hypot(pass.point.y)).collect();
            let reach = |j: usize| clear[j - j % 2].max(clear[j - j % 2 + 1]);
            let is_inside = (0..lens.surfaces.len()).all(|j| heights[j] < reach(j));
            is_inside && heights[stop] < clear[stop] && heights[lens.surfaces.len()] < *clear.last().unwrap()
        };
        let expected: Vec<i64> = (0..beam.len()).filter(passes).map(|k| k as i64).collect();
        assert!(expected.len() > 500 && expected.len() < 2500, "{} rays pass", expected.len());
        let found: Vec<i64> = rows.iter().map(|row| row.id).collect();
        assert_eq!(found, expected, "stop {}, field {field}, {:?}", lens.stop, names(&layout));
    }
}

#[test]
fn stops_on_faces_block_light() {
    for stop in 3..=4 {
        let lens = stopped_at(stop);
        same_rays_pass(&lens);
        // a stated semi-diameter of the stop counts, although the other face of the lens is wider
        let mut narrow = lens.clone();
        narrow.surfaces[stop - 1].semi_diameter = Some(2.6);
        same_rays_pass(&narrow);
    }
}

#[test]
fn stops_on_other_forms_block_light() {
    let mut conic = stopped_at(4);
    conic.surfaces[3].conic = -0.8;
    same_rays_pass(&conic);
    let mut asphere = stopped_at(3);
    asphere.surfaces[2].even[1] = 1e-5;
    same_rays_pass(&asphere);
    let mut freeform = stopped_at(4);
    let coefficients = vec![0.0, 0.0, 0.01, 0.002, -0.01];
    freeform.surfaces[3].figure = Figure::Polynomial { norm_radius: 4.0, coefficients };
    same_rays_pass(&freeform);
    let mut plane = stopped_at(3);
    plane.surfaces[2].radius = f64::INFINITY;
    plane.surfaces[3].radius = 12.0;
    same_rays_pass(&plane);
}

/// The ring lies on the shared face of two cemented lenses, where there is no gap.
#[test]
fn stops_on_cemented_faces_block_light() {
    let mut lens = doublet().stop_at(2);
    lens.surfaces[1].semi_diameter = Some(8.0);
    let layout = lens.assembly().unwrap();
    assert_eq!(names(&layout), ["lens 1-2", "lens 2-3", STOP, "image"]);
    let beam = lens.beam(0, D_NM, &disk(4000, 1.0)).unwrap();
    let height = |k: usize| {
        let point = lens.follow(&beam.get(k).ray, D_NM).unwrap()[1].point;
        point.x.hypot(point.y)
    };
    let expected: Vec<i64> = (0..beam.len()).filter(|&k| height(k) < 8.0).map(|k| k as i64).collect();
    assert!(expected.len() > 1000 && expected.len() < 3000);
    assert_eq!(at_image(&layout, &beam).iter().map(|row| row.id).collect::<Vec<_>>(), expected);
    // the light ends at the stop, after the first face only
    let found = trace(&layout, &beam);
    let stopped: Vec<_> = found.segments.iter().filter(|row| row.event == Event::Absorbed).collect();
    assert!(stopped.iter().all(|row| row.element == 2 && row.generation == 1));
    assert_eq!(stopped.len(), beam.len() - expected.len());
}

#[test]
fn a_mount_is_left_out_where_it_is_not_needed() {
    // the rim of the only lens is the stop
    assert_eq!(names(&doublet().assembly().unwrap()), ["lens 1-2", "lens 2-3", "image"]);
    assert_eq!(names(&cassegrain().assembly().unwrap()), ["mirror 1", "mirror 2", "image"]);
    let layout = stopped_at(4).assembly().unwrap();
    assert_eq!(names(&layout), ["lens 1-2", "lens 3-4", "lens 5-6", STOP, MOUNT, "image"]);
    assert_eq!(layout.stop.iter().map(|sheet| sheet.name).collect::<Vec<_>>(), [STOP, MOUNT]);
    assert_eq!(layout.stop[0].opening, layout.semi_diameters[3]);
    assert_eq!(layout.stop[0].outline, layout.stop[1].opening);
    // a front lens around the plane of the mount: light passes that plane on its way
    let nested = Prescription::new(vec![
        Surface::new(40.0, 2.0, index(1.6)).semi_diameter(14.0),
        Surface::new(15.0, 8.0, Behind::Air).semi_diameter(14.0),
        Surface::new(-40.0, 2.0, index(1.6)).semi_diameter(4.0),
        Surface::new(-20.0, 40.0, Behind::Air).semi_diameter(4.5),
    ])
    .entrance_pupil_diameter(5.0)
    .stop_at(3);
    assert_eq!(names(&nested.assembly().unwrap()), ["lens 1-2", "lens 3-4", STOP, "image"]);
}
