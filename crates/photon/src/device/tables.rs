//! The tables of a detector on a device, and the text of the kernel: see `step.wgsl` and `approximate.wgsl`.

use super::codes::{
    ABSORBS, COMPLEX_METAL, COUNTS, HAS_ROUGHNESS, INTERFACE, IS_ROUGH, IS_UNIFIED, MATERIAL_WORDS, METAL,
    MIE, MIRROR, OTHER_PROCESS, PAINT, PROCESS_BITS, RAYLEIGH, SAME, SENSITIVE, SHIFTS, SURFACE_SHIFT,
    SURFACE_WORDS, UNKNOWN, declarations,
};
use crate::detector::Detector;
use crate::draws::{LEAST_EXPONENTIAL, LN2_HIGH, LN2_LOW, LOG, ROOT, TO_ONE};
use crate::material::{Bulk, MAX_SHIFTERS, OpticalMaterial, ValueTable};
use crate::philox::{COSINE, SINE, UNIT};
use crate::property::{HC_MEV_NM, PropertyTable};
use crate::surface::{OpticalSurface, SurfaceFinish, SurfaceModel, SurfaceType};
use rayweave_gpu::{GpuError, NextTables, Unsupported};

/// The bits of the coefficients of the sine and the cosine in `libm` (FreeBSD, `k_sin.c` and `k_cos.c`).
const SINE_TERMS: [u64; 6] = [
    0xbfc5_5555_5555_5549,
    0x3f81_1111_1110_f8a6,
    0xbf2a_01a0_19c1_61d5,
    0x3ec7_1de3_57b1_fe7d,
    0xbe5a_e5e6_8a2b_9ceb,
    0x3de5_d93a_5acf_d57c,
];
const COSINE_TERMS: [u64; 6] = [
    0x3fa5_5555_5555_554c,
    0xbf56_c16c_16c1_5177,
    0x3efa_01a0_19cb_1590,
    0xbe92_7e4f_809c_52ad,
    0x3e21_ee9e_bdb4_b1c4,
    0xbda8_fae9_be88_38d4,
];

/// The greatest number of regions, with the world: there is a word for each pair of them.
const MOST_REGIONS: usize = 4096;

/// The tables and the kernel of a detector.
#[derive(Debug)]
pub(super) struct Tables {
    pub next: NextTables,
    pub source: String,
}

impl Tables {
    pub fn new(detector: &Detector) -> Result<Tables, GpuError> {
        if detector.material_of.len() > MOST_REGIONS {
            return Err(GpuError::Unsupported(Unsupported::Pairs { limit: MOST_REGIONS - 1 }));
        }
        let mut next = NextTables::new(&detector.program)?;
        let (materials, shifters) = materials(&mut next, &detector.materials);
        let rows: Vec<u32> = detector.surfaces.iter().flat_map(|own| surface(&mut next, own)).collect();
        let surfaces = put(&mut next, &rows);
        let material_of = put(&mut next, &detector.material_of);
        let pairs = pairs(detector);
        let pairs = put(&mut next, &pairs);
        debug_assert!(shifters <= MAX_SHIFTERS);
        let word = |value: u32| format!("{value}u");
        let number = |value: f64| format!("{value:?}");
        let mut replacements = vec![
            ("@MATERIALS@", word(materials)),
            ("@SURFACES@", word(surfaces)),
            ("@MATERIAL_OF@", word(material_of)),
            ("@PAIRS@", word(pairs)),
            ("@REGIONS@", word(detector.material_of.len() as u32)),
            ("@CODES@", declarations()),
            ("@COUNTS@", word(COUNTS as u32)),
            ("@HC@", number(HC_MEV_NM)),
            ("@UNIT@", number(UNIT)),
            ("@LEAST@", number(LEAST_EXPONENTIAL)),
            ("@GRAZING@", number(crate::boundary::GRAZING)),
            ("@OBLIQUE@", number(1.0 - crate::boundary::GRAZING)),
            ("@QUARTER@", number(std::f64::consts::FRAC_PI_2)),
            ("@TO_ONE@", TO_ONE.to_string()),
            ("@ROOT@", ROOT.to_string()),
            ("@LN2_LOW@", number(LN2_LOW)),
            ("@LN2_HIGH@", number(LN2_HIGH)),
            ("@SIN6@", number(SINE[6])),
            ("@COS6@", number(COSINE[6])),
            ("@SERIES@", series()),
        ];
        let names = ["@LOG0@", "@LOG1@", "@LOG2@", "@LOG3@", "@LOG4@", "@LOG5@", "@LOG6@"];
        replacements.extend(names.into_iter().zip(LOG.map(number)));
        let names = ["@S1@", "@S2@", "@S3@", "@S4@", "@S5@", "@S6@"];
        replacements.extend(names.into_iter().zip(SINE_TERMS.map(|bits| number(f64::from_bits(bits)))));
        let names = ["@C1@", "@C2@", "@C3@", "@C4@", "@C5@", "@C6@"];
        replacements.extend(names.into_iter().zip(COSINE_TERMS.map(|bits| number(f64::from_bits(bits)))));
        let own = [include_str!("step.wgsl"), include_str!("approximate.wgsl"), include_str!("main.wgsl")];
        let text = [next.shader(), own.join("\n")].join("\n");
        let source = replacements.iter().fold(text, |text, (name, value)| text.replace(name, value));
        Ok(Tables { next, source })
    }
}

/// The other terms of the Taylor series, from the last but one on.
fn series() -> String {
    let term = |k: usize| {
        format!(
            "    sine = plus(times_(sine, square), {:?}lf);\n    cosine = plus(times_(cosine, square), {:?}lf);\n",
            SINE[k], COSINE[k]
        )
    };
    (0..6).rev().map(term).collect()
}

/// Appends words; returns the place of the first.
fn put(next: &mut NextTables, words: &[u32]) -> u32 {
    let at = next.words.len() as u32;
    next.words.extend(words);
    at
}

/// Appends numbers; returns the place of the first.
fn put_numbers(next: &mut NextTables, numbers: impl IntoIterator<Item = f64>) -> u32 {
    let at = next.exact.len() as u32;
    next.exact.extend(numbers);
    at
}

/// The words of a table of properties: energies, their number, pieces, number of properties.
fn properties(next: &mut NextTables, table: &ValueTable) -> [u32; 4] {
    let (energies, pieces, width) = table.columns();
    let at = put_numbers(next, energies.iter().copied());
    let first = put_numbers(next, pieces.iter().flat_map(|piece| piece.numbers()));
    [at, energies.len() as u32, first, width as u32]
}

/// The row of a surface.
fn surface(next: &mut NextTables, surface: &OpticalSurface) -> [u32; SURFACE_WORDS as usize] {
    let [zero, one] = [0.0, 1.0].map(PropertyTable::constant);
    let is_unified = surface.model == SurfaceModel::Unified;
    let lobe = |table| Option::as_ref(table).filter(|_| is_unified).unwrap_or(&zero);
    let table = ValueTable::of(&[
        surface.reflectivity.as_ref().unwrap_or(&one),
        surface.transmittance.as_ref().unwrap_or(&zero),
        surface.efficiency.as_ref().unwrap_or(&zero),
        lobe(&surface.lobe),
        lobe(&surface.spike),
        lobe(&surface.backscatter),
        surface.metal_index.as_ref().map_or(&zero, |(real, _)| real),
        surface.metal_index.as_ref().map_or(&zero, |(_, imaginary)| imaginary),
    ]);
    let [a, b, c, d] = properties(next, &table);
    let value = put_numbers(next, [surface.value, 4.0 * std::f64::consts::PI * surface.roughness]);
    let flags = [
        (surface.finish == SurfaceFinish::Ground, IS_ROUGH),
        (is_unified, IS_UNIFIED),
        (surface.roughness != 0.0, HAS_ROUGHNESS),
    ];
    [a, b, c, d, value, flags.iter().filter(|(holds, _)| *holds).map(|(_, bit)| bit).sum()]
}

/// The rows of materials; the largest number of shifters of one of them.
fn materials(next: &mut NextTables, materials: &[OpticalMaterial]) -> (u32, usize) {
    let mut rows = Vec::new();
    for material in materials {
        let table = ValueTable::new(material);
        let (processes, has_index) = table.processes();
        let mut row = [0; MATERIAL_WORDS as usize];
        row[..4].copy_from_slice(&properties(next, &table));
        row[4] = u32::from(has_index);
        row[5] = processes.len() as u32;
        for (k, &process) in processes.iter().enumerate() {
            let kind = match process {
                Bulk::Absorption => ABSORBS,
                Bulk::Rayleigh => RAYLEIGH,
                Bulk::Shift(number) if material.shifters[usize::from(number)].mean_photons.is_none() => {
                    SHIFTS + u32::from(number)
                }
                Bulk::Mie => MIE,
                Bulk::Shift(_) => OTHER_PROCESS,
            };
            row[6] |= kind << (PROCESS_BITS * k as u32);
        }
        for (k, shifter) in material.shifters.iter().take(MAX_SHIFTERS).enumerate() {
            let [energies, cumulative] = shifter.spectrum.columns();
            let count = energies.len() as u32;
            let [energies, cumulative] = [energies, cumulative].map(|column| column.to_vec());
            let at = [energies, cumulative].map(|column| put_numbers(next, column));
            let time = put_numbers(next, [shifter.time]);
            row[7 + k] = put(next, &[at[0], at[1], count, time]);
        }
        if let Some(mie) = &material.mie {
            row[9] = put_numbers(next, [mie.forward, mie.backward, mie.forward_ratio]);
        }
        rows.extend(row);
    }
    let most = materials.iter().map(|material| material.shifters.len().min(MAX_SHIFTERS)).max();
    (put(next, &rows), most.unwrap_or(0))
}

/// For each region in front, one word for each region behind: the kind of the boundary, whether the region behind is sensitive, and
/// one more than the number of the surface.
fn pairs(detector: &Detector) -> Vec<u32> {
    let regions = detector.material_of.len() as u32;
    let pair = |before: u32, after: u32| {
        let [own, other] = [before, after].map(|region| detector.material_of[region as usize]);
        let sensitive = if detector.sensors[after as usize].is_some() { SENSITIVE } else { 0 };
        let Some(surface) = detector.boundaries.between([before, after]) else { return UNKNOWN };
        let number = surface.map_or(0, |number| number as u32 + 1);
        kind(surface.map(|number| &detector.surfaces[number]), own == other)
            | sensitive
            | number << SURFACE_SHIFT
    };
    (0..regions).flat_map(|before| (0..regions).map(move |after| pair(before, after))).collect()
}

/// The kind of a boundary, with or without a surface, between two materials.
pub(super) fn kind(surface: Option<&OpticalSurface>, is_same: bool) -> u32 {
    use SurfaceFinish::{Ground, GroundFrontPainted, Polished, PolishedFrontPainted};
    use SurfaceModel::{Glisur, Unified};
    let interface = if is_same { SAME } else { INTERFACE };
    let Some(surface) = surface else { return interface };
    if surface.reflectivity.is_none() && surface.metal_index.is_some() {
        return match (surface.kind, surface.finish, surface.model) {
            (SurfaceType::DielectricMetal, Polished, _) => COMPLEX_METAL,
            (SurfaceType::DielectricMetal, Ground, Unified | Glisur) => COMPLEX_METAL,
            _ => UNKNOWN,
        };
    }
    match (surface.kind, surface.finish, surface.model) {
        (SurfaceType::DielectricDielectric, Polished | Ground, _) if is_same => SAME,
        (SurfaceType::DielectricDielectric, Polished, _) => INTERFACE,
        (SurfaceType::DielectricDielectric, Ground, Unified | Glisur) => INTERFACE,
        (SurfaceType::DielectricDielectric, PolishedFrontPainted, _) => MIRROR,
        (SurfaceType::DielectricDielectric, GroundFrontPainted, _) => PAINT,
        (SurfaceType::DielectricMetal, Polished, _) => MIRROR,
        (SurfaceType::DielectricMetal, Ground, Unified | Glisur) => METAL,
        _ => UNKNOWN,
    }
}
