"""GDML detectors for benchmarks of optical photons."""

from pathlib import Path

#: Energies in eV between which all properties are given.
RANGE = (1.2, 11.0)

#: The volumes whose surface detects photons.
SENSORS = ("Shell", "Sensor", "Cathode")


class Writer:
    """Collects the sections of a GDML file."""

    def __init__(self):
        self.define, self.materials, self.solids, self.structure = [], [], [], []
        self.opaque = self.material("Opaque", {})

    def matrix(self, name, values):
        """A table of values by energy in eV; a single value holds at all energies."""
        pairs = [(energy, values) for energy in RANGE] if isinstance(values, (int, float)) else values
        text = " ".join(f"{energy}*eV {value}" for energy, value in pairs)
        self.define.append(f'<matrix name="{name}" coldim="2" values="{text}"/>')
        return name

    def properties(self, owner, values):
        lines = []
        for key, value in values.items():
            if isinstance(value, str):
                name = f"{owner}_{key}"
                self.define.append(f'<matrix name="{name}" coldim="1" values="{value}"/>')
            else:
                name = self.matrix(f"{owner}_{key}", value)
            lines.append(f'<property name="{key}" ref="{name}"/>')
        return "".join(lines)

    def material(self, name, values):
        inner = self.properties(name, values)
        self.materials.append(f'<material name="{name}" Z="7">{inner}<D value="1"/><atom value="14"/></material>')
        return name

    def box(self, name, x, y, z):
        self.solids.append(f'<box name="{name}" x="{x}" y="{y}" z="{z}" lunit="mm"/>')
        return name

    def orb(self, name, radius):
        self.solids.append(f'<orb name="{name}" r="{radius}" lunit="mm"/>')
        return name

    def surface(self, name, kind, finish, values, model="unified", value=0):
        inner = self.properties(name, values)
        self.solids.append(
            f'<opticalsurface name="{name}" model="{model}" finish="{finish}" type="{kind}" value="{value}">{inner}</opticalsurface>'
        )
        return name

    def volume(self, name, material, solid, daughters=()):
        """A volume with daughters (name, volume, position)."""
        placed = "".join(
            f'<physvol name="{own}"><volumeref ref="{volume}"/>'
            f'<position name="{own}_at" x="{x}" y="{y}" z="{z}" unit="mm"/></physvol>'
            for own, volume, (x, y, z) in daughters
        )
        self.structure.append(
            f'<volume name="{name}"><materialref ref="{material}"/><solidref ref="{solid}"/>{placed}</volume>'
        )
        return name

    def skin(self, name, surface, volume):
        self.structure.append(f'<skinsurface name="{name}" surfaceproperty="{surface}"><volumeref ref="{volume}"/></skinsurface>')

    def text(self, world):
        sections = {"define": self.define, "materials": self.materials, "solids": self.solids, "structure": self.structure}
        lines = ['<?xml version="1.0"?>', "<gdml>"]
        for name, content in sections.items():
            lines += [f"<{name}>", *content, f"</{name}>"]
        lines += [f'<setup name="Default" version="1.0"><world ref="{world}"/></setup>', "</gdml>", ""]
        return "\n".join(lines)


def sensor(out, efficiency):
    """The surface of a sensor that detects a part of the photons and absorbs the others."""
    return out.surface("Cathode", "dielectric_metal", "polished", {"REFLECTIVITY": 0.0, "EFFICIENCY": efficiency})


def water_box():
    """A box of water in air."""
    out = Writer()
    air = out.material("Air", {"RINDEX": 1.0})
    water = out.material("Liquid", {"RINDEX": 1.33, "ABSLENGTH": 1000.0})
    out.volume("Tank", water, out.box("TankBox", 2000, 2000, 2000))
    out.volume("World", air, out.box("WorldBox", 4000, 4000, 4000), [("tank", "Tank", (0, 0, 0))])
    return out.text("World"), 413.3


def argon():
    """Liquid argon behind a wavelength shifter, a light guide and a shell: five nested boxes."""
    out = Writer()
    argon = out.material("Argon", {"RINDEX": [(1.2, 1.23), (7.0, 1.26), (9.7, 1.36), (11.0, 1.45)], "ABSLENGTH": 20000.0,
                                   "RAYLEIGH": [(1.2, 1e6), (6.0, 5e4), (9.0, 1000.0), (11.0, 900.0)]})
    shifter = out.material("Terphenyl", {"RINDEX": 1.65, "ABSLENGTH": [(1.2, 1e5), (4.5, 1e5), (11.0, 1e5)],
                                         "WLSABSLENGTH": [(1.2, 1e6), (4.5, 1e6), (6.0, 0.002), (11.0, 0.002)],
                                         "WLSCOMPONENT": [(3.2, 0.1), (3.5, 1.0), (3.9, 0.1)], "WLSTIMECONSTANT": "1*ns"})
    guide = out.material("Guide", {"RINDEX": 1.58, "ABSLENGTH": 3000.0,
                                   "WLSABSLENGTH": [(1.2, 1e6), (2.9, 1e6), (3.2, 2.0), (11.0, 2.0)],
                                   "WLSCOMPONENT": [(2.5, 0.1), (2.8, 1.0), (3.0, 0.1)], "WLSTIMECONSTANT": "2*ns"})
    paint = out.surface("Paint", "dielectric_metal", "polished", {"REFLECTIVITY": 0.9, "EFFICIENCY": 0.3})
    size = [60000.0, 13500.0, 13000.0]
    layers = [("Liquid", argon, 0.0), ("Film", shifter, 0.2), ("Plate", guide, 6.0), ("Shell", out.opaque, 1.0), ("World", out.opaque, 10.0)]
    inner = []
    for name, material, thickness in layers:
        size = [length + 2 * thickness for length in size]
        out.volume(name, material, out.box(name + "Box", *size), inner)
        inner = [(name.lower(), name, (0, 0, 0))]
    out.skin("paint", paint, "Shell")
    return out.text("World"), 128.0


def crystals(count=10):
    """An array of wrapped crystals, each with a sensor at its end."""
    out = Writer()
    air = out.material("Air", {"RINDEX": 1.0})
    crystal = out.material("Crystal", {"RINDEX": 1.79, "ABSLENGTH": 400.0})
    paper = out.surface("Paper", "dielectric_dielectric", "groundfrontpainted", {"REFLECTIVITY": 0.95})
    out.volume("Bar", crystal, out.box("BarBox", 20, 20, 100))
    out.volume("Sensor", out.opaque, out.box("SensorBox", 18, 18, 1))
    out.volume("Gap", air, out.box("GapBox", 20.2, 20.2, 101.2), [("bar", "Bar", (0, 0, -0.5)), ("sensor", "Sensor", (0, 0, 50))])
    out.volume("Wrap", out.opaque, out.box("WrapBox", 20.6, 20.6, 101.6), [("gap", "Gap", (0, 0, 0))])
    places = [(21.0 * (i - (count - 1) / 2), 21.0 * (j - (count - 1) / 2), 0) for i in range(count) for j in range(count)]
    side = 21.0 * count + 20
    out.volume("World", air, out.box("WorldBox", side, side, 200), [(f"wrap{k}", "Wrap", place) for k, place in enumerate(places)])
    out.skin("sensors", sensor(out, 0.3), "Sensor")
    out.skin("paper", paper, "Wrap")
    return out.text("World"), 550.0, places[len(places) // 2 + count // 2]


def phototubes(count):
    """A tank of water with spherical phototubes on a grid on its six walls: at least `count`."""
    out = Writer()
    water = out.material("Liquid", {"RINDEX": 1.33, "ABSLENGTH": 50000.0, "RAYLEIGH": 80000.0})
    glass = out.material("Glass", {"RINDEX": 1.5, "ABSLENGTH": 500.0})
    side = 1
    while 6 * side * side < count:
        side += 1
    size = 20000.0
    pitch = size / side
    radius = 0.3 * pitch
    out.volume("Cathode", out.opaque, out.orb("CathodeOrb", round(0.95 * radius, 6)))
    out.volume("Tube", glass, out.orb("TubeOrb", round(radius, 6)), [("cathode", "Cathode", (0, 0, 0))])
    daughters = []
    for axis in range(3):
        for sign in (-1, 1):
            for i in range(side):
                for j in range(side):
                    place = [round(pitch * (i + 0.5) - size / 2, 6), round(pitch * (j + 0.5) - size / 2, 6)]
                    place.insert(axis, sign * (size / 2 + 1.2 * radius))
                    daughters.append((f"tube{len(daughters)}", "Tube", place))
    edge = size + 6 * radius
    out.volume("Tank", water, out.box("TankBox", edge, edge, edge), daughters)
    steel = out.volume("World", out.opaque, out.box("WorldBox", edge + 100, edge + 100, edge + 100), [("tank", "Tank", (0, 0, 0))])
    out.skin("liner", out.surface("Liner", "dielectric_metal", "ground", {"REFLECTIVITY": 0.5}), steel)
    out.skin("cathodes", sensor(out, 0.25), "Cathode")
    return out.text("World"), 420.0


def detectors():
    """The detectors: name, GDML text, wavelength in nm, position in mm."""
    made = [("water_box", water_box()), ("argon", argon()), ("crystals", crystals())]
    made += [(f"phototubes_{count}", phototubes(count)) for count in (100, 5000, 10000)]
    return [(name, text, wavelength, at[0] if at else (0.0, 0.0, 0.0)) for name, (text, wavelength, *at) in made]


def write(folder):
    """Writes all detectors to a folder. Returns (name, path, wavelength in nm, position in mm) for each."""
    rows = []
    for name, text, wavelength, at in detectors():
        path = Path(folder) / f"{name}.gdml"
        path.write_text(text)
        rows.append((name, path, wavelength, at))
    return rows
