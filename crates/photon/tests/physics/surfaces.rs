//! Surfaces with tables and films, from GDML.

use crate::{CLEAR, SlabDetector, assert_binomial, beam, imported, run, settings};
use rayweave_photon::{
    BoundaryEvent, Detector, DichroicTable, MeasuredTable, PhotonRun, RunSettings, SurfaceTables, property,
};
use std::io::Write;
use std::sync::Arc;

const COUNT: usize = 20_000;

fn skin<'a>(surface: &'a str, matrices: &'a str) -> SlabDetector<'a> {
    SlabDetector {
        matrices,
        surfaces: surface,
        links: r#"<skinsurface name="skin" surfaceproperty="S"><volumeref ref="Slab"/></skinsurface>"#,
        ..CLEAR
    }
}

fn share(run: &PhotonRun, event: BoundaryEvent, probability: f64) {
    let count = run.boundary_events.get(&event).copied().unwrap_or(0);
    assert_binomial(count, COUNT as u64, probability, &format!("{event:?}"));
}

fn first_events(detector: &Detector) -> PhotonRun {
    let settings = RunSettings { max_steps: 1, ..settings(COUNT) };
    run(detector, &beam(COUNT, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &settings)
}

/// A quarter wave of index n between vacuum and glass g reflects ((g - n^2) / (g + n^2))^2.
#[test]
fn a_coated_surface_is_read_from_gdml() {
    let quarter = property::wavelength_nm(3e-6) / 4.0 / 1.38;
    let surface = r#"<opticalsurface name="S" model="glisur" finish="polished" type="coated" value="1">
<property name="COATEDRINDEX" ref="FILM"/><property name="COATEDTHICKNESS" ref="THICK"/></opticalsurface>"#;
    let matrices = format!(
        r#"<matrix name="FILM" coldim="2" values="1*eV 1.38 10*eV 1.38"/><matrix name="THICK" coldim="1" values="{quarter}*nm"/>"#
    );
    let run = first_events(&skin(surface, &matrices).build());
    let expected = ((1.5 - 1.38f64.powi(2)) / (1.5 + 1.38f64.powi(2))).powi(2);
    share(&run, BoundaryEvent::CoatedReflection, expected);
    share(&run, BoundaryEvent::CoatedRefraction, 1.0 - expected);

    let bare = r#"<opticalsurface name="S" model="glisur" finish="polished" type="coated" value="1"/>"#;
    let message = skin(bare, "").try_build().unwrap_err().to_string();
    assert!(
        message.contains("`COATEDRINDEX` of optical surface `S` is invalid: a coated surface needs"),
        "{message}"
    );
}

#[test]
fn a_dichroic_surface_needs_its_table() {
    let surface = r#"<opticalsurface name="S" model="dichroic" finish="polished" type="dielectric_dichroic" value="0"/>"#;
    let message = skin(surface, "").try_build().unwrap_err().to_string();
    assert!(
        message.contains("optical surface `S` has no table: the transmittance of a dichroic filter"),
        "{message}"
    );
    let table = || DichroicTable::new(vec![300.0, 700.0], vec![0.0, 90.0], vec![35.0; 4]).unwrap();
    let (scene, document) = imported(&skin(surface, "").text());
    let own = MeasuredTable::Dichroic(Arc::new(table()));
    for tables in [SurfaceTables::default().dichroic(table()), SurfaceTables::default().with("S", own)] {
        let run = first_events(&Detector::with_tables(&scene, &document, &tables).unwrap());
        share(&run, BoundaryEvent::Dichroic, 0.35);
        share(&run, BoundaryEvent::SpikeReflection, 0.65);
    }
}

/// Measured finishes, by name and by number, with files in the format of Geant4's data set.
#[test]
fn measured_finishes_need_their_files() {
    let folder = std::env::temp_dir().join(format!("rayweave-tables-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let build = |finish: &str, kind: &str, tables: &SurfaceTables| {
        let surface =
            format!(r#"<opticalsurface name="S" model="LUT" finish="{finish}" type="{kind}" value="0"/>"#);
        let (scene, document) = imported(&skin(&surface, "").text());
        Detector::with_tables(&scene, &document, tables).map_err(|error| error.to_string())
    };
    let none = SurfaceTables::default();
    let refused = |finish: &str, kind: &str, tables: &SurfaceTables| build(finish, kind, tables).unwrap_err();
    assert!(refused("11", "2", &none).contains("data set RealSurface with PolishedTyvek.z"));
    assert!(refused("36", "3", &none).contains("PolishedESR_LUT.z"));
    let without = refused("polishedair", "dielectric_LUT", &none);
    assert!(without.contains("Geant4 has none for the finish"), "{without}");
    assert!(refused("polishedtyvekair", "dielectric_metal", &none).contains("has no meaning for its type"));
    let tables = none.folder(&folder);
    let path = folder.join("PolishedTyvek.dat");
    let missing = refused("polishedtyvekair", "dielectric_LUT", &tables);
    assert!(missing.contains("cannot read the table") && missing.contains("PolishedTyvek.dat"), "{missing}");
    std::fs::write(&path, "0.5 0.5 0.5").unwrap();
    let short = refused("polishedtyvekair", "dielectric_LUT", &tables);
    assert!(short.contains("the LUT table has 3 values: 151515 are needed"), "{short}");
    std::fs::write(&path, "0.5 ".repeat(151_515)).unwrap();
    let built = |tables: &SurfaceTables| build("polishedtyvekair", "dielectric_LUT", tables);
    let run = first_events(&built(&tables).unwrap());
    share(&run, BoundaryEvent::LutReflection, 1.0);
    // as Geant4 ships it: compressed by zlib
    std::fs::remove_file(&path).unwrap();
    let compressed = folder.join("PolishedTyvek.z");
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    zlib.write_all("0.5 ".repeat(151_515).as_bytes()).unwrap();
    let bytes = zlib.finish().unwrap();
    std::fs::write(&compressed, &bytes).unwrap();
    assert_eq!(first_events(&built(&tables).unwrap()), run);
    for damaged in [&bytes[..bytes.len() / 2], b"0.5 0.5"] {
        std::fs::write(&compressed, damaged).unwrap();
        let message = built(&tables).unwrap_err();
        assert!(message.contains("cannot read the table") && message.contains("Tyvek.z"), "{message}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Behind an interface and behind a dichroic filter photons travel with the group velocity there: of an index that rises from
/// 1.5 at 2 eV by 0.1 per eV.
#[test]
fn the_time_behind_a_boundary_is_that_of_the_group_velocity() {
    let plate = r#"<physvol name="plate"><volumeref ref="Plate"/><position name="q" z="45" unit="mm"/></physvol></volume>"#;
    let filter =
        r#"<opticalsurface name="S" model="glisur" finish="polished" type="dielectric_dichroic" value="1"/>"#;
    for (surface, links) in [("", ""), (filter, skin("", "").links)] {
        let slab = SlabDetector {
            matrices: r#"<matrix name="RISING" coldim="2" values="2*eV 1.5 3*eV 1.6 4*eV 1.7"/>"#,
            inner: r#"<property name="RINDEX" ref="RISING"/>"#,
            surfaces: surface,
            links,
            ..CLEAR
        };
        let text = slab
            .text()
            .replace(r#"<volume name="Slab">"#, r#"<volume name="Plate"><materialref ref="Inner"/><solidref ref="Thin"/><auxiliary auxtype="SensDet" auxvalue="S"/></volume><volume name="Slab">"#)
            .replace(r#"<solidref ref="SlabBox"/></volume>"#, &format!(r#"<solidref ref="SlabBox"/>{plate}"#))
            .replace("<solids>", r#"<solids><box name="Thin" x="900" y="900" z="10" lunit="mm"/>"#);
        let (scene, document) = imported(&text);
        let clear = DichroicTable::new(vec![300.0, 700.0], vec![0.0, 90.0], vec![100.0; 4]).unwrap();
        let detector =
            Detector::with_tables(&scene, &document, &SurfaceTables::default().dichroic(clear)).unwrap();
        let run = run(&detector, &beam(100, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &settings(100));
        assert!(run.hits.len() > 80, "{}", run.hits.len());
        // Geant4's table of group velocities: at 2 eV, 2.5 eV and 4 eV
        let c = property::LIGHT_SPEED;
        let speed = |n: f64, low: f64, high: f64| c / (n + 0.1 / (high / low).ln());
        let (middle, last) = (speed(1.55, 2.0, 3.0), speed(1.7, 3.0, 4.0));
        let at_3_ev = middle + (last - middle) * (3.0 - 2.5) / (4.0 - 2.5);
        let expected = 10.0 / c + 90.0 / at_3_ev;
        let first = run.hits.time.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((first - expected).abs() < 1e-9, "{first} {expected}");
    }
}
