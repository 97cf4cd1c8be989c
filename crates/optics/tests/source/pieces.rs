//! Any range of a source, generated alone, equals that range of the whole, bit for bit.

use rayweave_math::{Affine, Vec3};
use rayweave_optics::component::Aperture;
use rayweave_optics::source::*;
use rayweave_optics::{Beam, Emitter};

fn patterns() -> Vec<Pattern> {
    let (disc, plate, count) = (Aperture::circle(3.0), Aperture::rectangle(1.0, 2.0), 100);
    let beam = |aperture, profile, sampling| Pattern::Beam { aperture, profile, sampling };
    let gauss = BeamProfile::Gaussian { radius: 1.0 };
    let list = |v: Vec3| (0..100).map(|k| v + f64::from(k)).collect();
    vec![
        Pattern::Line { length: 1.0, count },
        Pattern::Circle { diameter: 1.0, count },
        Pattern::Cone { half_angle_degrees: 20.0, count },
        Pattern::Wedge { angle_degrees: 20.0, count },
        Pattern::Lamp { width: 1.0, height: 2.0, half_angle_degrees: 80.0, count },
        beam(disc, gauss, Sampling::Random { count }),
        beam(disc, gauss, Sampling::Hexapolar { rings: 6 }),
        beam(plate, BeamProfile::TopHat, Sampling::Grid { columns: 8, rows: 12 }),
        Pattern::Point { half_angle_degrees: 20.0, sampling: Sampling::Fibonacci { count } },
        Pattern::Point { half_angle_degrees: 20.0, sampling: Sampling::Random { count } },
        Pattern::Extended { aperture: disc, emission: Emission::Isotropic, half_angle_degrees: 9.0, count },
        Pattern::Rays(ListedRays::new(list(Vec3::X), list(Vec3::Z), None, None).unwrap()),
    ]
}

fn sources() -> Sources {
    let spectra = [Spectrum::default(), Spectrum::BlackBody { kelvin: 3e3, from_nm: 400.0, to_nm: 900.0 }];
    let place = Affine::rotation(Vec3::new(1.0, 2.0, 3.0), 40.0).then(&Affine::translate(Vec3::ONE));
    let source = |(k, pattern): (usize, Pattern)| {
        let source = Source::new(pattern).unwrap().spectrum(&spectra[k % 2]).unwrap();
        source.seed(11).apply(&place).unwrap()
    };
    Sources::new(patterns().into_iter().enumerate().map(source).collect())
}

#[test]
fn pieces_make_the_whole() {
    let sources = sources();
    let whole = sources.rays(0..sources.count());
    assert_eq!(whole.len() as u64, sources.count());
    for step in [1, 7, 64, 999] {
        let mut pieces = SourceRays::default();
        for first in (0..sources.count()).step_by(step) {
            sources.append(first..first + step as u64, &mut pieces);
        }
        // past the end a range is shorter
        assert_eq!(pieces, whole, "{step}");
    }
    assert!(whole.id.iter().enumerate().all(|(k, &id)| id == k as i64));
    assert_eq!((whole.source[0], whole.source[99], whole.source[100]), (0, 0, 1));
    assert_eq!(*whole.source.last().unwrap(), 11);
}

#[test]
fn a_source_alone_is_the_first_of_a_list() {
    for source in sources().sources() {
        let alone = source.rays(5..40);
        assert_eq!(alone, Sources::new(vec![source.clone()]).rays(5..40));
        assert_eq!(alone, source.rays(5..40));
        assert!(source.rays(200..300).is_empty() && source.rays(40..40).is_empty());
    }
}

#[test]
fn seeds_and_sources_differ() {
    let lamp = Pattern::Lamp { width: 1.0, height: 1.0, half_angle_degrees: 90.0, count: 50 };
    let source = Source::new(lamp).unwrap();
    let origins = |source: &Source| source.rays(0..50).origins[0].clone();
    assert_eq!(origins(&source), origins(&source.clone().seed(0)));
    assert_ne!(origins(&source), origins(&source.clone().seed(1)));
    let two = Sources::new(vec![source.clone(), source]).rays(0..100);
    assert_ne!(two.origins[0][..50], two.origins[0][50..]);
}

/// Light polarised from x towards y stays so in a mirrored source: from the image of x towards that
/// of y.
#[test]
fn mirrored_sources_send_mirrored_light() {
    let line = || Source::new(Pattern::Line { length: 1.0, count: 3 }).unwrap();
    let (half, turn) = (0.5_f64.sqrt(), Affine::rotation(Vec3::new(1.0, 2.0, 3.0), 40.0));
    let maps = [Affine::IDENTITY, turn, Affine::mirror(Vec3::X), Affine::mirror(Vec3::Z).then(&turn)];
    for map in maps.iter().chain([&Affine::scale(-Vec3::ONE)]) {
        let source = line().stokes([1.0, 0.0, 1.0, 0.0]).unwrap().apply(map).unwrap();
        let mut beam = Beam::default();
        source.emit(0..3, &mut beam);
        for k in 0..3 {
            let light = beam.get(k);
            let diagonal = map.vector(Vec3::new(half, half, 0.0));
            let [i, q, ..] = light.stokes.unwrap().rotated_to(diagonal, light.ray.direction).parameters;
            assert!((q / i - 1.0).abs() < 1e-14, "{map:?}: {q} of {i}");
        }
    }
}

#[test]
fn memory_is_kept() {
    let sources = sources();
    let source = &sources.sources()[0];
    let mut rays = source.rays(0..50);
    rays.clear();
    assert!(rays.is_empty() && rays.power.is_empty() && rays.directions[2].is_empty());
    assert!(rays.origins[0].capacity() >= 50);
}

/// A tracer gets the same rays.
#[test]
fn emitters() {
    let sources = sources();
    let (rays, mut beam) = (sources.rays(90..260), Beam::default());
    sources.emit(90..200, &mut beam);
    sources.emit(200..260, &mut beam);
    assert_eq!((Emitter::count(&sources) as u64, beam.len()), (sources.count(), rays.len()));
    for k in 0..rays.len() {
        let light = beam.get(k);
        assert_eq!(light.ray, rays.rays().get(k));
        assert_eq!((light.power, light.wavelength_nm), (rays.power[k], rays.wavelength_nm[k]));
        assert_eq!(light.source as i32, rays.source[k]);
    }
    let (source, mut alone) = (&sources.sources()[4], Beam::default());
    source.emit(10..20, &mut alone);
    assert_eq!(alone.get(3).ray, source.rays(13..14).rays().get(0));
}
