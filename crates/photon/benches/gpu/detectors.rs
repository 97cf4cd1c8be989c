//! The detectors of the benchmark, as GDML.

use std::fmt::Write as _;

/// A detector with a source of photons in it.
pub struct Case {
    pub name: String,
    pub gdml: String,
    /// The place of an isotropic source, in mm.
    pub at: [f64; 3],
    pub wavelength_nm: f64,
    /// The photons of a run are divided by this number: some detectors take many more steps for each.
    pub share: u64,
}

type Entry = (&'static str, fn() -> Result<Case, std::fmt::Error>);

/// All detectors.
pub const DETECTORS: &[Entry] = &[
    ("water", water),
    ("argon", argon),
    ("crystal", || crystals(1)),
    ("crystals", || crystals(2)),
    ("tank", || tank(1)),
    ("crystals 10 x 10", || crystals(10)),
    ("tank of 150", || tank(5)),
    ("tank of 10086", || tank(41)),
];

/// The sections of a GDML file.
#[derive(Default)]
struct Sections {
    define: String,
    materials: String,
    solids: String,
    structure: String,
}

impl Sections {
    /// Properties with one value at all energies.
    fn properties(&mut self, owner: &str, values: &[(&str, f64)]) -> Result<String, std::fmt::Error> {
        let mut text = String::new();
        for (key, value) in values {
            let name = format!("{owner}_{key}");
            writeln!(
                self.define,
                r#"<matrix name="{name}" coldim="2" values="1.2*eV {value} 11*eV {value}"/>"#
            )?;
            write!(text, r#"<property name="{key}" ref="{name}"/>"#)?;
        }
        Ok(text)
    }

    fn material(&mut self, name: &str, values: &[(&str, f64)]) -> std::fmt::Result {
        let inner = self.properties(name, values)?;
        writeln!(
            self.materials,
            r#"<material name="{name}" Z="7">{inner}<D value="1"/><atom value="14"/></material>"#
        )
    }

    fn box_(&mut self, name: &str, [x, y, z]: [f64; 3]) -> std::fmt::Result {
        writeln!(self.solids, r#"<box name="{name}Solid" x="{x}" y="{y}" z="{z}" lunit="mm"/>"#)
    }

    fn orb(&mut self, name: &str, radius: f64) -> std::fmt::Result {
        writeln!(self.solids, r#"<orb name="{name}Solid" r="{radius}" lunit="mm"/>"#)
    }

    fn skin(&mut self, volume: &str, [kind, finish]: [&str; 2], values: &[(&str, f64)]) -> std::fmt::Result {
        let inner = self.properties(&format!("{volume}Skin"), values)?;
        writeln!(
            self.solids,
            r#"<opticalsurface name="{volume}Surface" model="unified" finish="{finish}" type="{kind}" value="0">{inner}</opticalsurface>"#
        )
    }

    /// A volume with others in it: volume and place.
    fn volume(&mut self, name: &str, material: &str, inside: &[(&str, [f64; 3])]) -> std::fmt::Result {
        write!(
            self.structure,
            r#"<volume name="{name}"><materialref ref="{material}"/><solidref ref="{name}Solid"/>"#
        )?;
        for (number, (volume, [x, y, z])) in inside.iter().enumerate() {
            write!(
                self.structure,
                r#"<physvol name="{volume}_{number}"><volumeref ref="{volume}"/><position name="{volume}_at{number}" x="{x}" y="{y}" z="{z}" unit="mm"/></physvol>"#
            )?;
        }
        writeln!(self.structure, "</volume>")
    }

    /// The file, with skin surfaces of some volumes.
    fn finish(self, skins: &[&str]) -> String {
        let skin = |volume: &&str| {
            format!(
                r#"<skinsurface name="{volume}_skin" surfaceproperty="{volume}Surface"><volumeref ref="{volume}"/></skinsurface>"#
            )
        };
        let Sections { define, materials, solids, structure } = self;
        let skins: String = skins.iter().map(skin).collect();
        format!(
            "<gdml><define>{define}</define><materials>{materials}</materials><solids>{solids}</solids>\n\
             <structure>{structure}{skins}</structure>\n\
             <setup name=\"Default\" version=\"1.0\"><world ref=\"World\"/></setup></gdml>\n"
        )
    }
}

/// A box of water in air, of which the lowest part detects.
fn water() -> Result<Case, std::fmt::Error> {
    let mut own = Sections::default();
    own.material("Air", &[("RINDEX", 1.0)])?;
    own.material("Liquid", &[("RINDEX", 1.33), ("ABSLENGTH", 1000.0), ("RAYLEIGH", 5000.0)])?;
    own.material("Opaque", &[])?;
    own.box_("Tank", [2000.0; 3])?;
    own.box_("Floor", [1900.0, 1900.0, 10.0])?;
    own.box_("World", [4000.0; 3])?;
    own.skin("Floor", ["dielectric_metal", "polished"], &[("REFLECTIVITY", 0.0), ("EFFICIENCY", 0.25)])?;
    own.volume("Floor", "Opaque", &[])?;
    own.volume("Tank", "Liquid", &[("Floor", [0.0, 0.0, -990.0])])?;
    own.volume("World", "Air", &[("Tank", [0.0; 3])])?;
    Ok(Case {
        name: "water box".to_owned(),
        gdml: own.finish(&["Floor"]),
        at: [30.0, 20.0, 10.0],
        wavelength_nm: 413.3,
        share: 1,
    })
}

/// Liquid argon in four layers.
fn argon() -> Result<Case, std::fmt::Error> {
    Ok(Case {
        name: "five boxes of liquid argon".to_owned(),
        gdml: include_str!("argon.gdml").to_owned(),
        at: [300.0, 20.0, -10.0],
        wavelength_nm: 128.0,
        share: 8,
    })
}

/// An array of wrapped crystals, each with a sensor at its end.
fn crystals(count: usize) -> Result<Case, std::fmt::Error> {
    let mut own = Sections::default();
    own.material("Air", &[("RINDEX", 1.0)])?;
    own.material("Crystal", &[("RINDEX", 1.79), ("ABSLENGTH", 400.0)])?;
    own.material("Opaque", &[])?;
    let pitch = 21.0;
    let side = pitch * count as f64 + 20.0;
    let boxes = [
        ("Bar", [20.0, 20.0, 100.0]),
        ("Sensor", [18.0, 18.0, 1.0]),
        ("Gap", [20.2, 20.2, 101.2]),
        ("Wrap", [20.6, 20.6, 101.6]),
        ("World", [side, side, 200.0]),
    ];
    boxes.iter().try_for_each(|(name, size)| own.box_(name, *size))?;
    own.skin("Sensor", ["dielectric_metal", "polished"], &[("REFLECTIVITY", 0.0), ("EFFICIENCY", 0.3)])?;
    own.skin("Wrap", ["dielectric_dielectric", "groundfrontpainted"], &[("REFLECTIVITY", 0.95)])?;
    own.volume("Bar", "Crystal", &[])?;
    own.volume("Sensor", "Opaque", &[])?;
    own.volume("Gap", "Air", &[("Bar", [0.0, 0.0, -0.5]), ("Sensor", [0.0, 0.0, 50.0])])?;
    own.volume("Wrap", "Opaque", &[("Gap", [0.0; 3])])?;
    let middle = (count - 1) as f64 / 2.0;
    let place = |k: usize| [k / count, k % count].map(|i| pitch * (i as f64 - middle));
    let places = (0..count * count).map(place).map(|[x, y]| ("Wrap", [x, y, 0.0])).collect::<Vec<_>>();
    own.volume("World", "Air", &places)?;
    let (_, [x, y, _]) = places[places.len() / 2];
    Ok(Case {
        name: format!("{count} x {count} wrapped crystals with sensors"),
        gdml: own.finish(&["Sensor", "Wrap"]),
        at: [x + 3.0, y - 2.0, 1.0],
        wavelength_nm: 550.0,
        share: 2,
    })
}

/// A tank of water, 20 m wide, with spherical phototubes on its six walls, `side` x `side` each.
fn tank(side: usize) -> Result<Case, std::fmt::Error> {
    let mut own = Sections::default();
    own.material("Liquid", &[("RINDEX", 1.33), ("ABSLENGTH", 50_000.0), ("RAYLEIGH", 80_000.0)])?;
    own.material("Glass", &[("RINDEX", 1.5), ("ABSLENGTH", 500.0)])?;
    own.material("Opaque", &[])?;
    let size = 20_000.0;
    let pitch = size / side as f64;
    let radius = 0.3 * pitch;
    let edge = size + 6.0 * radius;
    own.orb("Cathode", 0.95 * radius)?;
    own.orb("Tube", radius)?;
    own.box_("Tank", [edge; 3])?;
    own.box_("World", [edge + 100.0; 3])?;
    own.skin("Cathode", ["dielectric_metal", "polished"], &[("REFLECTIVITY", 0.0), ("EFFICIENCY", 0.25)])?;
    own.skin("World", ["dielectric_metal", "ground"], &[("REFLECTIVITY", 0.5)])?;
    own.volume("Cathode", "Opaque", &[])?;
    own.volume("Tube", "Glass", &[("Cathode", [0.0; 3])])?;
    let mut tubes = Vec::new();
    for wall in 0..6 {
        for k in 0..side * side {
            let mut place = [0.0; 3];
            let across = [(wall / 2 + 1) % 3, (wall / 2 + 2) % 3];
            for (axis, i) in across.into_iter().zip([k / side, k % side]) {
                place[axis] = pitch * (i as f64 + 0.5) - size / 2.0;
            }
            place[wall / 2] = (size / 2.0 + 1.2 * radius) * if wall % 2 == 0 { 1.0 } else { -1.0 };
            tubes.push(("Tube", place));
        }
    }
    own.volume("Tank", "Liquid", &tubes)?;
    own.volume("World", "Opaque", &[("Tank", [0.0; 3])])?;
    Ok(Case {
        name: format!("tank of water, 20 m, with {} phototubes", tubes.len()),
        gdml: own.finish(&["Cathode", "World"]),
        at: [100.0, 200.0, 300.0],
        wavelength_nm: 420.0,
        share: 1,
    })
}
