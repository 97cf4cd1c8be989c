//! Histories: steps, sequences and counts of recorded runs.

use crate::{CLEAR, SlabDetector, beam, count, detector, run, settings};
use rayweave_math::Vec3;
use rayweave_photon::{
    Detector, End, Histories, HistoryOptions, PhotonError, PhotonRun, Process, RunSettings, Source, Torch,
    sequence_text, simulate_parts,
};
use rayweave_trace::Packets;
use std::num::NonZeroUsize;

const ALL: HistoryOptions = HistoryOptions { steps: true, sequences: true };

pub(crate) fn record(detector: &Detector, source: &Source, settings: &RunSettings) -> (PhotonRun, Histories) {
    let evaluator = Packets::new(detector.program().clone());
    let (mut total, mut histories) = (PhotonRun::default(), Histories::default());
    simulate_parts(detector, &evaluator, source, settings, Some(ALL), |part| {
        total.append(part.run);
        histories.append(part.histories.unwrap());
        Ok::<(), PhotonError>(())
    })
    .unwrap();
    (total, histories)
}

/// A glass slab with absorption, scattering, a wavelength shifter and a rough, lossy skin that detects.
fn busy() -> SlabDetector<'static> {
    SlabDetector {
        matrices: r#"<matrix name="LENGTH" coldim="2" values="1*eV 60 10*eV 60"/>
<matrix name="SHORT" coldim="2" values="1*eV 1e12 2.9*eV 1e12 2.95*eV 50 10*eV 50"/>
<matrix name="BAND" coldim="2" values="2.0*eV 1 2.5*eV 1"/><matrix name="MEAN" coldim="1" values="2"/>"#,
        inner: r#"<property name="RINDEX" ref="GLASS"/><property name="RAYLEIGH" ref="LENGTH"/>
<property name="ABSLENGTH" ref="LENGTH"/><property name="WLSABSLENGTH" ref="SHORT"/>
<property name="WLSCOMPONENT" ref="BAND"/><property name="WLSMEANNUMBERPHOTONS" ref="MEAN"/>"#,
        surfaces: r#"<opticalsurface name="S" model="unified" finish="ground" type="dielectric_dielectric" value="0.2">
<property name="REFLECTIVITY" ref="HALF"/><property name="EFFICIENCY" ref="HALF"/></opticalsurface>"#,
        links: r#"<skinsurface name="skin" surfaceproperty="S"><volumeref ref="Slab"/></skinsurface>"#,
        ..CLEAR
    }
}

fn inside() -> Source {
    Source::Torch(Torch::point(Vec3::new(1.0, 2.0, 30.0), 400.0).unwrap())
}

/// A photon through a clear slab: every step in closed form, with two steps in vacuum and one in glass.
#[test]
fn steps_of_a_straight_photon() {
    let detector = CLEAR.build();
    // Fresnel's reflectance of 4 % at each face: the photons that are never reflected
    let (run, histories) = record(&detector, &beam(100, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &settings(100));
    let through: Vec<_> = histories
        .sequences
        .iter()
        .filter(|sequence| sequence_text(sequence.words) == "TO BT BT MI")
        .map(|sequence| sequence.photon)
        .collect();
    assert!(through.len() > 80, "{}", through.len());
    assert_eq!(count(&run, End::Escaped), 100);
    let c = 299.792_458;
    let expected = [
        (Process::Emission, -10.0, 0.0, "World"),
        (Process::FresnelRefraction, 0.0, 10.0 / c, "World"),
        (Process::FresnelRefraction, 100.0, (10.0 + 150.0) / c, "Slab"),
        (Process::End(End::Escaped), 1000.0, (10.0 + 150.0 + 900.0) / c, "World"),
    ];
    for photon in through {
        let rows: Vec<_> = histories.steps.iter().filter(|row| row.photon == photon).collect();
        assert_eq!(rows.len(), expected.len());
        for ((row, (process, z, time, volume)), step) in rows.iter().zip(expected).zip(0..) {
            assert_eq!((row.process, row.step, row.track, row.surface), (process, step, photon, None));
            assert!((row.position.z - z).abs() < 1e-9 && (row.time - time).abs() < 1e-12, "{row:?}");
            assert_eq!(&*histories.volumes()[row.volume as usize], volume);
            assert_eq!(row.direction, Vec3::Z);
        }
    }
}

/// The photons of a recorded run are those of a run without histories, and every count agrees with the rows.
#[test]
fn recording_changes_nothing_and_counts_agree() {
    let detector = busy().build();
    let settings = RunSettings { seed: 3, threads: NonZeroUsize::new(2), ..RunSettings::new(0..6000) };
    let plain = run(&detector, &inside(), &settings);
    let (recorded, histories) = record(&detector, &inside(), &settings);
    assert_eq!(recorded, plain);
    assert!(plain.photons > 6000 && plain.hits.len() > 100, "{} {}", plain.photons, plain.hits.len());
    for process in Process::ALL {
        let rows = histories.steps.iter().filter(|row| row.process == process).count() as u64;
        assert_eq!(histories.processes.get(&process).copied().unwrap_or(0), rows, "{process:?}");
        if let Process::End(end) = process {
            assert_eq!(rows, count(&plain, end), "{end:?}");
        }
    }
    // each surface event is a boundary event of the run
    let at_surfaces: u64 = histories.surfaces.values().sum();
    assert_eq!(at_surfaces, plain.boundary_events.values().sum::<u64>());
    for (surface, process) in histories.surfaces.keys() {
        let rows = histories.steps.iter().filter(|row| row.process == *process && row.surface == *surface);
        if surface.is_some() {
            assert_eq!(rows.count() as u64, histories.surfaces[&(*surface, *process)]);
        }
    }
    // a track begins with its emission and ends once, with steps in order and light going forward in time
    for track in histories.steps.chunk_by(|a, b| a.track == b.track) {
        let [first, .., last] = track else { panic!("a track of one row: {track:?}") };
        let begins = if first.track == first.photon { Process::Emission } else { Process::Reemission };
        assert_eq!(first.process, begins);
        assert!(matches!(last.process, Process::End(_)), "{last:?}");
        let ends = track.iter().filter(|row| matches!(row.process, Process::End(_))).count();
        assert_eq!(ends, 1);
        assert!(track.windows(2).all(|pair| pair[0].step <= pair[1].step && pair[0].time <= pair[1].time));
    }
    let tracks = histories.steps.chunk_by(|a, b| a.track == b.track).count() as u64;
    // those of absorbed photons whose shifter emitted others in addition
    assert_eq!(tracks, recorded.photons);
    // sequences are the nibbles of the first 32 rows
    assert_eq!(histories.sequences.len() as u64, tracks);
    for (sequence, rows) in
        histories.sequences.iter().zip(histories.steps.chunk_by(|a, b| a.track == b.track))
    {
        assert_eq!((sequence.photon, sequence.track), (rows[0].photon, rows[0].track));
        for (slot, row) in rows.iter().take(32).enumerate() {
            assert_eq!(sequence.words[slot / 16] >> (4 * (slot % 16)) & 15, row.process.nibble());
        }
    }
}

/// The histories of consecutive ranges make up those of the whole run, with any number of threads.
#[test]
fn histories_of_ranges_are_parts_of_the_run() {
    let detector = busy().build();
    let settings =
        |range, threads| RunSettings { threads: NonZeroUsize::new(threads), ..RunSettings::new(range) };
    let (_, whole) = record(&detector, &inside(), &settings(0..5000, 1));
    let (_, threaded) = record(&detector, &inside(), &settings(0..5000, 3));
    assert_eq!(threaded, whole);
    let mut parts = Histories::default();
    for range in [0..17, 17..18, 18..5000] {
        parts.append(record(&detector, &inside(), &settings(range, 2)).1);
    }
    assert_eq!(parts, whole);
}

/// Two copies of a box with a sensitive core: the paths name the copies of mothers and daughters.
#[test]
fn volumes_have_paths_with_copy_numbers() {
    let text = CLEAR
        .text()
        .replace(
            r#"<box name="SlabBox""#,
            r#"<box name="CoreBox" x="100" y="100" z="20" lunit="mm"/><box name="SlabBox""#,
        )
        .replace(
            r#"<volume name="Slab"><materialref ref="Inner"/><solidref ref="SlabBox"/></volume>"#,
            r#"<volume name="Core"><materialref ref="Outer"/><solidref ref="CoreBox"/><auxiliary auxtype="SensDet" auxvalue="tracker"/></volume>
<volume name="Slab"><materialref ref="Inner"/><solidref ref="SlabBox"/>
<physvol name="core" copynumber="7"><volumeref ref="Core"/></physvol></volume>"#,
        )
        .replace(
            r#"<physvol name="slab">"#,
            r#"<physvol name="other" copynumber="3"><volumeref ref="Slab"/><position name="q" z="300" unit="mm"/></physvol>
<physvol name="slab" copynumber="2">"#,
        );
    let detector = detector(&text).unwrap();
    assert_eq!(detector.sensors().collect::<Vec<_>>(), [("Core", "tracker")]);
    let (run, histories) = record(&detector, &beam(200, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &settings(200));
    let volumes = |text: &str| {
        let mut sequences = histories.sequences.iter();
        let found = sequences.find(|sequence| sequence_text(sequence.words) == text).unwrap();
        let rows = histories.steps.iter().filter(|row| row.photon == found.photon);
        rows.map(|row| &*histories.volumes()[row.volume as usize]).collect::<Vec<_>>()
    };
    assert_eq!(volumes("TO BT BT SD"), ["World", "World", "Slab[2]", "Slab[2]/Core[7]"]);
    assert!(run.hits.len() > 150);
    assert_eq!((run.hits.paths(), run.hits.copies()), (&["Slab[2]/Core[7]".into()][..], &[7][..]));
}

#[test]
fn processes_have_distinct_names_and_numbers() {
    for (number, process) in Process::ALL.into_iter().enumerate() {
        assert_eq!(process.number(), number);
        let same = Process::ALL.iter().filter(|other| other.name() == process.name());
        assert_eq!(same.count(), 1, "{process:?}");
    }
    for end in End::ALL {
        assert!(Process::ALL.contains(&Process::End(end)));
    }
}

/// TO SC BT BR AB: nibbles 13, 6, 12, 11, 4 from the lowest bits up (OpticksPhoton.h).
#[test]
fn sequences_have_the_flags_of_opticks() {
    let processes = [
        Process::Emission,
        Process::Rayleigh,
        Process::FresnelRefraction,
        Process::TotalInternalReflection,
        Process::End(End::Absorbed),
    ];
    let nibbles = processes.map(Process::nibble);
    assert_eq!(nibbles, [0xd, 0x6, 0xc, 0xb, 0x4]);
    assert_eq!(sequence_text([0x4bc6d, 0]), "TO SC BT BR AB");
    assert_eq!(sequence_text([0; 2]), "");
    // 32 flags, the last of which ends the photon or not
    let full = |last: u64| {
        [u64::from_str_radix("cccccccccccccccd", 16).unwrap(), last << 60 | 0x0ccc_cccc_cccc_cccc]
    };
    assert!(sequence_text(full(0xc)).ends_with("BT BT ..."));
    assert!(sequence_text(full(7)).ends_with("BT SD"));
    let long = [u64::MAX / 15 * 12, 0x7];
    assert!(sequence_text(long).ends_with("BT BT SD") && sequence_text(long).split(' ').count() == 17);
}
