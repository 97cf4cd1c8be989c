"""GDML detectors for comparisons of histories with Geant4: each process alone, and all together."""

from pathlib import Path

from photon_detectors import Writer

#: Indices of specular lobe, spike and back scattering; the rest is diffuse.
LOBES = {"SPECULARLOBECONSTANT": 0.5, "SPECULARSPIKECONSTANT": 0.2, "BACKSCATTERCONSTANT": 0.1}

#: The tables of a wavelength shifter.
SHIFTER = {
    "WLSABSLENGTH": [(1.2, 1e6), (2.6, 1e6), (2.8, 100.0), (11.0, 100.0)],
    "WLSCOMPONENT": [(2.0, 0.1), (2.4, 1.0), (2.9, 0.3)],
    "WLSTIMECONSTANT": "2*ns",
}


def block(inner, surface=None, outer=None, size=200):
    """A cube in a world of index 1; `surface` are the arguments of its skin surface."""
    out = Writer()
    around = out.material("Around", {"RINDEX": 1.0} if outer is None else outer)
    material = out.material("Inner", inner)
    out.volume("Block", material, out.box("BlockBox", size, size, size))
    out.volume("World", around, out.box("WorldBox", 4 * size, 4 * size, 4 * size), [("block", "Block", (0, 0, 0))])
    if surface is not None:
        kind, finish, values, model, value = surface
        out.skin("skin", out.surface("Skin", kind, finish, values, model=model, value=value), "Block")
    return out.text("World")


def everything():
    """A crystal with all processes, diffuse walls, a metal mirror, and a sensor at its end."""
    out = Writer()
    air = out.material("Air", {"RINDEX": 1.0, "ABSLENGTH": 5000.0})
    crystal = {"RINDEX": [(1.2, 1.5), (4.0, 1.6)], "ABSLENGTH": 800.0, "RAYLEIGH": 500.0, "MIEHG": 400.0, "MIEHG_FORWARD": "0.8"}
    crystal |= {"MIEHG_BACKWARD": "0.3", "MIEHG_FORWARD_RATIO": "0.7"} | SHIFTER
    crystal = out.material("Crystal", crystal)
    glue = out.material("Glue", {"RINDEX": 1.4, "ABSLENGTH": 300.0})
    ground = out.surface("Ground", "dielectric_dielectric", "ground", {"REFLECTIVITY": 0.97, **LOBES}, value=0.2)
    mirror = out.surface("Mirror", "dielectric_metal", "polished", {"REALRINDEX": 1.2, "IMAGINARYRINDEX": 5.0})
    sensor = out.surface("Cathode", "dielectric_metal", "polished", {"REFLECTIVITY": 0.2, "EFFICIENCY": 0.4})
    out.volume("Bar", crystal, out.box("BarBox", 60, 60, 200))
    out.volume("Glue", glue, out.box("GlueBox", 60, 60, 2))
    out.volume("Sensor", out.opaque, out.box("SensorBox", 60, 60, 2))
    out.volume("Plate", out.opaque, out.box("PlateBox", 100, 100, 2))
    places = [("bar", "Bar", (0, 0, 0)), ("glue", "Glue", (0, 0, 101)), ("sensor", "Sensor", (0, 0, 103)), ("plate", "Plate", (0, 0, -120))]
    out.volume("World", air, out.box("WorldBox", 400, 400, 400), places)
    out.skin("ground", ground, "Bar")
    out.skin("mirror", mirror, "Plate")
    out.skin("cathode", sensor, "Sensor")
    return out.text("World")


BARE, METAL = "dielectric_dielectric", "dielectric_metal"
GLASS = {"RINDEX": 1.5, "ABSLENGTH": 1000.0}

#: name: GDML text, wavelength in nm
DETECTORS = {
    "absorption": (block({"RINDEX": 1.0, "ABSLENGTH": 100.0}), 400),
    "rayleigh": (block({"RINDEX": 1.0, "RAYLEIGH": 60.0}), 400),
    "mie": (block({"RINDEX": 1.0, "MIEHG": 60.0, "MIEHG_FORWARD": "0.8", "MIEHG_BACKWARD": "0.4", "MIEHG_FORWARD_RATIO": "0.7"}), 400),
    "wls": (block({"RINDEX": 1.0, **SHIFTER}), 400),
    "wls_number": (block({"RINDEX": 1.0, **SHIFTER, "WLSMEANNUMBERPHOTONS": "1.5"}), 400),
    "fresnel": (block(GLASS), 400),
    "roughness": (block(GLASS, (BARE, "polished", {"SURFACEROUGHNESS": "20*nm"}, "glisur", 1)), 400),
    "transmittance": (block(GLASS, (BARE, "polished", {"REFLECTIVITY": 0.7, "TRANSMITTANCE": 0.2}, "glisur", 1)), 400),
    "ground_unified": (block(GLASS, (BARE, "ground", LOBES, "unified", 0.2)), 400),
    "ground_glisur": (block(GLASS, (BARE, "ground", {}, "glisur", 0.6)), 400),
    "metal_index": (block(GLASS, (METAL, "polished", {"REALRINDEX": 1.2, "IMAGINARYRINDEX": 4.0}, "glisur", 1)), 400),
    "metal_ground": (block(GLASS, (METAL, "ground", {"REFLECTIVITY": 0.8, **LOBES}, "unified", 0.2)), 400),
    "polished_front": (block(GLASS, (BARE, "polishedfrontpainted", {"REFLECTIVITY": 0.8}, "unified", 0)), 400),
    "ground_front": (block(GLASS, (BARE, "groundfrontpainted", {"REFLECTIVITY": 0.8}, "unified", 0)), 400),
    "polished_back": (block(GLASS, (BARE, "polishedbackpainted", {"REFLECTIVITY": 0.8, "RINDEX": 1.2, **LOBES}, "unified", 0.1)), 400),
    "ground_back": (block(GLASS, (BARE, "groundbackpainted", {"REFLECTIVITY": 0.8, "RINDEX": 1.2, **LOBES}, "unified", 0.1)), 400),
    "efficiency": (block(GLASS, (METAL, "polished", {"REFLECTIVITY": 0.4, "EFFICIENCY": 0.3}, "glisur", 1)), 400),
    "everything": (everything(), 400),
}

#: A point inside the cube that no symmetry favours.
AT = (13.0, -7.0, 21.0)


def write(folder, name):
    """Writes a detector. Returns its path, the wavelength in nm and the position of the source in mm."""
    text, wavelength = DETECTORS[name]
    path = Path(folder) / f"{name}.gdml"
    path.write_text(text)
    return path, wavelength, AT
