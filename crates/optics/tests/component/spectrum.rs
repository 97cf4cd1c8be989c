//! The spectrum of a prism, compared with Raysect and with Snell's law.

use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_optics::component::{Aperture, light_pipe};
use rayweave_optics::glass::{Dispersion, Glass};
use rayweave_optics::{Assembly, Beam, Element, Event, Light, Medium, TraceSettings, Tracer};
use rayweave_shape::primitive::{Primitive, Prism};
use rayweave_trace::Packets;

/// Output of `crates/bench/peers/prism_raysect.py` with Raysect 0.9.1 on 2026-11-22: wavelength in
/// nm, incidence in degrees, and x and y of the direction in which light leaves.
const RAYSECT: [(f64, f64, f64, f64); 21] = [
    (404.6561, 45.0, -0.996_573_533_427_485_7, 0.082_711_501_448_445_86),
    (435.8343, 45.0, -0.996_053_340_381_249_7, 0.088_756_651_104_887_84),
    (486.1327, 45.0, -0.995_380_035_736_251_7, 0.096_013_459_773_608_53),
    (546.074, 45.0, -0.994_772_955_743_322_5, 0.102_111_539_610_827_97),
    (587.5618, 45.0, -0.994_440_694_576_574, 0.105_298_171_731_805_45),
    (656.2725, 45.0, -0.993_999_377_345_115_9, 0.109_385_729_588_104_89),
    (706.5188, 45.0, -0.993_738_128_606_597_8, 0.111_734_201_359_552_92),
    (404.6561, 50.0, -0.984_304_966_435_005_4, 0.176_475_871_017_493_74),
    (435.8343, 50.0, -0.983_319_673_673_242_2, 0.181_885_731_620_566_1),
    (486.1327, 50.0, -0.982_093_688_366_497_7, 0.188_393_172_038_395_67),
    (546.074, 50.0, -0.981_026_745_854_561, 0.193_872_442_389_347_53),
    (587.5618, 50.0, -0.980_455_779_619_105_5, 0.196_739_584_759_888_18),
    (656.2725, 50.0, -0.979_709_834_562_341_4, 0.200_421_156_722_114_02),
    (706.5188, 50.0, -0.979_274_342_912_130_9, 0.202_538_295_919_597_16),
    (404.6561, 60.0, -0.947_023_767_233_523_3, 0.321_163_485_307_445),
    (435.8343, 60.0, -0.945_418_941_671_326_5, 0.325_857_368_689_230_3),
    (486.1327, 60.0, -0.943_450_126_810_621_7, 0.331_514_491_720_984_8),
    (546.074, 60.0, -0.941_759_595_065_531_5, 0.336_286_879_170_161_87),
    (587.5618, 60.0, -0.940_862_957_044_612_8, 0.338_787_390_646_799_75),
    (656.2725, 60.0, -0.939_699_430_659_751_3, 0.342_001_432_771_472_1),
    (706.5188, 60.0, -0.939_024_093_885_048_4, 0.343_851_350_300_334_87),
];

/// The radius of the circle in a triangle of side 30.
const INNER: f64 = 8.660_254_037_844_387;

fn bk7() -> Glass {
    // Schott's coefficients, as in the script
    let terms = [(1.03961212, 0.00600069867), (0.231792344, 0.0200179144), (1.01046945, 103.560653)];
    Glass::new("N-BK7", Dispersion::sellmeier(&terms))
}

#[test]
fn prism_dispersion_agrees_with_raysect_and_snell() {
    let prism = Solid::from(Primitive::from(Prism::new(3, 2.0 * INNER, 40.0).unwrap())).rotate_z(60.0);
    let element = Element::transparent("prism", prism, &Medium::from(bk7()));
    let system = Assembly::new().add(element).compile().unwrap();
    let tracer = Tracer::new(&system, Packets::new);
    for (wavelength_nm, incidence, x, y) in RAYSECT {
        let (s, c) = incidence.to_radians().sin_cos();
        let direction = Vec3::new(-c, s, 0.0);
        let light = Light::new(INNER * Vec3::X - 40.0 * direction, direction, wavelength_nm);
        let found = tracer.trace(&Beam::from_iter([light]), &TraceSettings::default()).unwrap();
        let last = found.segments.get(2).direction;
        assert!((last - Vec3::new(x, y, 0.0)).length() < 1e-9, "{wavelength_nm} {incidence}: {last}");
        // the deviation is i + e - A, with sin e = n sin(A - r) and sin i = n sin r
        let n = bk7().index(wavelength_nm).unwrap();
        let apex = 60.0_f64.to_radians();
        let leaving = (n * (apex - (s / n).asin()).sin()).asin();
        let turned = (180.0 - incidence).to_radians() + incidence.to_radians() + leaving - apex;
        assert!((last - Vec3::new(turned.cos(), turned.sin(), 0.0)).length() < 1e-14);
    }
}

/// A square pipe of glass preserves the angles to its walls, and so transmits all incident light:
/// conservation of etendue in the flux.
#[test]
fn light_pipes_keep_etendue() {
    let pipe = light_pipe(30.0, Aperture::rectangle(2.0, 3.0)).unwrap();
    let glass = Medium::constant("glass", 1.5, 0.0).unwrap();
    let system = Assembly::new().add(Element::transparent("pipe", pipe, &glass)).compile().unwrap();
    let tracer = Tracer::new(&system, Packets::new);
    // over the face and the whole half space; an index above sqrt 2 guides all of it
    let light = |k: usize| {
        let part = |step: f64| (0.5 + step * k as f64).fract();
        let (s, c) = (std::f64::consts::TAU * part(0.819_172_513_396_164_4)).sin_cos();
        let radius = 0.999 * part(0.671_043_606_703_789_2).sqrt();
        let direction = Vec3::new(radius * c, radius * s, (1.0 - radius * radius).sqrt());
        let (x, y) = (part(0.549_700_477_901_970_2) - 0.5, part(0.450_299_522_098_029_8) - 0.5);
        Light::new(Vec3::new(1.98 * x, 2.98 * y, -15.0) - 1e-3 * direction, direction, 550.0)
    };
    let beam: Beam = (0..2000).map(light).collect();
    let found = tracer.trace(&beam, &TraceSettings::default()).unwrap();
    let out: Vec<_> = found.segments.iter().filter(|row| row.event == Event::Escaped).collect();
    assert_eq!(out.len(), 2000);
    for row in out {
        let came = beam.get(row.id as usize).ray.direction.abs();
        assert!(row.direction.z > 0.0 && (row.direction.abs() - came).length() < 1e-13);
    }
}
