"""Optical surfaces of Rayweave and of Geant4: the same GDML files, photons and tables.

    pip install geant4-pybind numpy
    echo n | python geant4_surfaces.py --rayweave path/to/rayweave [--photons 20000] [--case coated]

Each case is a surface between two half spaces; unpolarised photons of 3 eV arrive at an angle. The script compares the
numbers of reflected, transmitted and absorbed photons (z, in standard deviations), and the distributions of the outgoing
directions (chi squared over bins of the direction's y and z) and of the times (z of the mean). Behind dichroic and coated
surfaces Geant4 11.4.1 keeps the velocity of the material in front, so that the times of transmitted photons differ there.

Needs geant4-pybind (Geant4 11.4.1), which asks on standard input about data sets; none are needed. The tables of the LUT,
DAVIS and dichroic cases are made here: smooth functions, not measured data.
"""

import argparse
import csv
import math
import os
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

import numpy as np

ENERGY_EV = 3.0
WAVELENGTH_NM = 1239.841984332 / ENERGY_EV


def surface(model, finish, kind, value, **properties):
    inner = "".join(f'<property name="{name}" ref="P_{name}"/>' for name in properties)
    text = f'<opticalsurface name="S" model="{model}" finish="{finish}" type="{kind}" value="{value}">{inner}</opticalsurface>'
    constants = ("SURFACEROUGHNESS", "COATEDTHICKNESS", "COATEDFRUSTRATEDTRANSMISSION")
    one = '<matrix name="P_{}" coldim="1" values="{}"/>'
    two = '<matrix name="P_{}" coldim="2" values="1*eV {} 10*eV {}"/>'
    matrices = [
        one.format(name, value) if name in constants else two.format(name, value, value)
        for name, value in properties.items()
    ]
    return text, "".join(matrices)


LOBES = {"SPECULARLOBECONSTANT": 0.5, "SPECULARSPIKECONSTANT": 0.2, "BACKSCATTERCONSTANT": 0.1}
LOBE = {"SPECULARLOBECONSTANT": 1}
COAT = {"COATEDRINDEX": 1.38, "COATEDTHICKNESS": "100*nm"}
GAP = {"COATEDRINDEX": 1.0, "COATEDTHICKNESS": "60*nm"}
BARE, METAL = "dielectric_dielectric", "dielectric_metal"

# name: angle of incidence in degrees, the two indices, the surface
CASES = {
    "polished": (50, 1.0, 1.5, surface("glisur", "polished", BARE, 1, REFLECTIVITY=0.9, TRANSMITTANCE=0.04)),
    "unified": (45, 1.0, 1.5, surface("unified", "ground", BARE, 0.15, **LOBES)),
    "unified_inner": (35, 1.5, 1.0, surface("unified", "ground", BARE, 0.15, **LOBES)),
    "glisur": (30, 1.5, 1.0, surface("glisur", "ground", BARE, 0.5)),
    "roughness": (60, 1.5, 1.0, surface("glisur", "polished", BARE, 1, SURFACEROUGHNESS="20*nm")),
    "polished_front": (40, 1.3, 1.5, surface("unified", "polishedfrontpainted", BARE, 0, REFLECTIVITY=0.7, TRANSMITTANCE=0.2)),
    "ground_front": (40, 1.3, 1.5, surface("unified", "groundfrontpainted", BARE, 0, REFLECTIVITY=0.7)),
    "polished_back": (40, 1.3, 1.5, surface("unified", "polishedbackpainted", BARE, 0.1, REFLECTIVITY=0.8, RINDEX=1.7, **LOBE)),
    "ground_back": (40, 1.3, 1.5, surface("unified", "groundbackpainted", BARE, 0.1, REFLECTIVITY=0.8, RINDEX=1.7, **LOBE)),
    "metal": (60, 1.2, 1.5, surface("unified", "ground", METAL, 0.1, REALRINDEX=1.5, IMAGINARYRINDEX=1.2, **LOBE)),
    "metal_lobes": (30, 1.2, 1.5, surface("unified", "ground", METAL, 0.2, REFLECTIVITY=0.9, **LOBES)),
    "metal_glisur": (30, 1.2, 1.5, surface("glisur", "ground", METAL, 0.6, REFLECTIVITY=0.8, TRANSMITTANCE=0.1)),
    "coated": (50, 1.0, 1.52, surface("glisur", "polished", "coated", 1, **COAT)),
    "coated_ground": (50, 1.0, 1.52, surface("unified", "ground", "coated", 0.1, **COAT)),
    "coated_gap": (55, 1.5, 1.5, surface("glisur", "polished", "coated", 1, **GAP)),
    "coated_closed": (55, 1.5, 1.5, surface("glisur", "polished", "coated", 1, COATEDFRUSTRATEDTRANSMISSION=0, **GAP)),
    "dichroic": (37, 1.0, 1.5, surface("glisur", "polished", "dielectric_dichroic", 1)),
    "dichroic_ground": (37, 1.0, 1.5, surface("unified", "ground", "dielectric_dichroic", 0.15, **LOBES)),
    "lut": (33, 1.5, 1.0, surface("LUT", "polishedtyvekair", "dielectric_LUT", 0, REFLECTIVITY=0.9, TRANSMITTANCE=0.05)),
    "lut_normal": (0, 1.5, 1.0, surface("LUT", "polishedtyvekair", "dielectric_LUT", 0, REFLECTIVITY=0.9)),
    "davis": (33.4, 1.5, 1.0, surface("DAVIS", "Rough_LUT", "dielectric_LUTDAVIS", 0)),
    "davis_sensor": (33.4, 1.5, 1.0, surface("DAVIS", "Rough_LUT", "dielectric_LUTDAVIS", 0, EFFICIENCY=0.4)),
}


def gdml(case):
    _, above, below, (text, matrices) = CASES[case]
    index = '<matrix name="{}" coldim="2" values="1*eV {} 10*eV {}"/>'
    return f"""<?xml version="1.0"?><gdml><define>{index.format("ABOVE", above, above)}{index.format("BELOW", below, below)}
{index.format("ZERO", 0, 0)}{index.format("ONE", 1, 1)}{matrices}</define><materials>
<material name="Above" Z="1"><D value="1"/><atom value="1"/><property name="RINDEX" ref="ABOVE"/></material>
<material name="Below" Z="1"><D value="1"/><atom value="1"/><property name="RINDEX" ref="BELOW"/></material>
<material name="Dark" Z="1"><D value="1"/><atom value="1"/></material></materials><solids>
<box name="WorldBox" x="3000" y="3000" z="3000" lunit="mm"/><box name="Half" x="2000" y="2000" z="1000" lunit="mm"/>{text}
<opticalsurface name="D" model="glisur" finish="polished" type="{METAL}" value="1"><property name="REFLECTIVITY" ref="ZERO"/>
<property name="EFFICIENCY" ref="ONE"/></opticalsurface></solids><structure>
<volume name="Upper"><materialref ref="Above"/><solidref ref="Half"/></volume>
<volume name="Lower"><materialref ref="Below"/><solidref ref="Half"/></volume>
<volume name="World"><materialref ref="Dark"/><solidref ref="WorldBox"/>
<physvol name="upper"><volumeref ref="Upper"/><position name="a" z="500" unit="mm"/></physvol>
<physvol name="lower"><volumeref ref="Lower"/><position name="b" z="-500" unit="mm"/></physvol></volume>
<bordersurface name="border" surfaceproperty="S"><physvolref ref="upper"/><physvolref ref="lower"/></bordersurface>
<skinsurface name="skin1" surfaceproperty="D"><volumeref ref="Upper"/></skinsurface>
<skinsurface name="skin2" surfaceproperty="D"><volumeref ref="Lower"/></skinsurface>
</structure><setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"""


def tables(folder):
    """The synthetic tables, as text for Rayweave and compressed for Geant4."""
    incidence, theta, phi = np.meshgrid(np.arange(91), np.arange(45), np.arange(37), indexing="ij")
    mirror = -90 + 4 * theta + incidence
    lut = 0.02 + 0.9 * np.exp(-((mirror / 20.0) ** 2) - ((-90 + 5 * phi) / 30.0) ** 2)
    # directions in the surface itself: their volume is a matter of rounding
    lut[(theta == 0) | (phi == 0)] = 0
    lut = lut.transpose(2, 1, 0).ravel()
    rng = np.random.default_rng(3)
    azimuth = rng.normal(0, 0.7, 7_280_001 // 2)
    elevation = np.arccos(np.sqrt(rng.uniform(size=azimuth.size)))
    elevation[91 * 20_000 :] = math.pi - elevation[91 * 20_000 :]
    davis = np.zeros(7_280_001)
    davis[0:-1:2], davis[1::2] = azimuth, elevation
    reflectance = 0.6 + 0.3 * np.arange(90) / 90
    for name, values, digits in (("PolishedTyvek", lut, 6), ("Rough_LUT", davis, 5), ("Rough_LUTR", reflectance, 6)):
        text = " ".join(np.char.mod(f"%.{digits}g", values)).encode()
        (folder / f"{name}.dat").write_bytes(text)
        (folder / f"{name}.z").write_bytes(zlib.compress(text, 1))
    (folder / "dichroic.txt").write_text("4 3 3\n300 400 500\n0 40 90\n20 50 70\n40 60 30\n90 10 5\n")


def start(case):
    angle = math.radians(CASES[case][0])
    direction = (math.sin(angle), 0.0, -math.cos(angle))
    return tuple(-200 * d for d in direction), direction


def rayweave(case, folder, binary, photons):
    """Rows of (z, direction, time) of the photons at the walls, and the number of the others."""
    path = folder / f"{case}.gdml"
    path.write_text(gdml(case))
    at, towards = start(case)
    command = [binary, "photons", str(path), "--at", ",".join(map(repr, at)), "--towards", ",".join(map(repr, towards))]
    command += ["--wavelength", repr(WAVELENGTH_NM), "-n", str(photons), "--detect", "efficiency", "-o", str(folder / "hits.csv")]
    if case.startswith(("lut", "davis")):
        command += ["--surface-tables", str(folder)]
    if case.startswith("dichroic"):
        command += ["--dichroic", str(folder / "dichroic.txt")]
    subprocess.run(command, check=True, capture_output=True)
    with open(folder / "hits.csv") as file:
        rows = [[float(row[k]) for k in ("z", "dx", "dy", "dz", "time")] for row in csv.DictReader(file)]
    return np.array(rows).reshape(-1, 5)


def geant4(case, folder, photons):
    """The same from Geant4, in this process."""
    for name in ("LE", "LEVELGAMMA", "PARTICLEXS", "SAIDXS", "NEUTRONHP", "RADIOACTIVE", "PII", "ABLA", "INCL", "CHANNELING", "ENSDFSTATE", "REALSURFACE"):
        os.environ[f"G4{name}DATA"] = str(folder)
    os.environ["G4DICHROICDATA"] = str(folder / "dichroic.txt")
    (folder / "ENSDFSTATE.dat").touch()
    import geant4_pybind as g4

    path = folder / f"{case}.gdml"
    path.write_text(gdml(case))
    at, towards = start(case)
    rows = []

    class Detector(g4.G4VUserDetectorConstruction):
        def Construct(self):
            self.parser = g4.G4GDMLParser()
            self.parser.Read(str(path), False)
            for one in g4.G4SurfaceProperty.GetSurfacePropertyTable():
                if one.GetName() != "S":
                    continue
                if case.startswith("coated"):
                    # the GDML reader of Geant4 does not know the type, nor do the bindings its name
                    one.SetType(g4.G4SurfaceType(7))
                elif case.startswith("dichroic"):
                    # with other models than dichroic Geant4 reads the table only here
                    one.SetType(one.GetType())
            return self.parser.GetWorldVolume()

    class Particles(g4.G4VPhysicsConstructor):
        def __init__(self):
            super().__init__("particles")

        def ConstructParticle(self):
            for particle in (g4.G4Gamma, g4.G4Electron, g4.G4Positron, g4.G4Proton, g4.G4OpticalPhoton, g4.G4Geantino, g4.G4ChargedGeantino):
                particle.Definition()

        def ConstructProcess(self):
            pass

    class Physics(g4.G4VModularPhysicsList):
        def __init__(self):
            super().__init__()
            self.parts = [Particles(), g4.G4OpticalPhysics()]
            for part in self.parts:
                self.RegisterPhysics(part)

    class Gun(g4.G4VUserPrimaryGeneratorAction):
        def __init__(self):
            super().__init__()
            self.gun = g4.G4ParticleGun(1)
            self.is_ready = False
            self.random = np.random.default_rng(11)

        def GeneratePrimaries(self, event):
            if not self.is_ready:
                self.gun.SetParticleDefinition(g4.G4ParticleTable.GetParticleTable().FindParticle("opticalphoton"))
                self.gun.SetParticleEnergy(ENERGY_EV * g4.eV)
                self.gun.SetParticlePosition(g4.G4ThreeVector(*at))
                self.gun.SetParticleMomentumDirection(g4.G4ThreeVector(*towards))
                self.is_ready = True
            for turn in self.random.uniform(0, 2 * math.pi, 1000):
                s, c = math.sin(turn), math.cos(turn)
                self.gun.SetParticlePolarization(g4.G4ThreeVector(-towards[2] * c, s, towards[0] * c))
                self.gun.GeneratePrimaryVertex(event)

    class Tracking(g4.G4UserTrackingAction):
        def PostUserTrackingAction(self, track):
            before = track.GetStep().GetPreStepPoint().GetMomentumDirection()
            rows.append([track.GetPosition().z, before.x, before.y, before.z, track.GetGlobalTime()])

    class Actions(g4.G4VUserActionInitialization):
        def Build(self):
            self.SetUserAction(Gun())
            self.SetUserAction(Tracking())

    manager = g4.G4RunManagerFactory.CreateRunManager(g4.G4RunManagerType.Serial)
    manager.SetUserInitialization(Detector())
    manager.SetUserInitialization(Physics())
    manager.SetUserInitialization(Actions())
    manager.Initialize()
    g4.G4UImanager.GetUIpointer().ApplyCommand("/process/inactivate Scintillation opticalphoton")
    manager.BeamOn(photons // 1000)
    found = np.array(rows)
    return found[np.abs(found[:, 0]) > 1e-6]


def z_of(a, b, total):
    """Difference of two counts of equal totals in standard deviations."""
    mean = (a + b) / (2 * total)
    return 0.0 if mean in (0, 1) else (a - b) / math.sqrt(2 * total * mean * (1 - mean))


def chi2(a, b):
    """Chi squared and degrees of freedom of two histograms of directions over y and z."""
    edges = [np.linspace(-1.0001, 1.0001, 9), np.linspace(-1.0001, 1.0001, 41)]
    ha, hb = (np.histogram2d(x[:, 2], x[:, 3], bins=edges)[0].ravel() for x in (a, b))
    used = ha + hb >= 20
    if len(a) == 0 or len(b) == 0 or used.sum() < 2:
        return 0.0, 0
    ratio = math.sqrt(len(b) / len(a))
    terms = (ha * ratio - hb / ratio) ** 2 / (ha + hb + 1e-300)
    return float(terms[used].sum()), int(used.sum()) - 1


def compare(case, folder, binary, photons):
    with tempfile.TemporaryDirectory() as own:
        own = Path(own)
        code = [sys.executable, __file__, "--worker", case, str(own / "rows.npy"), "--photons", str(photons), "--folder", str(folder)]
        done = subprocess.run(code, input="n\n", text=True, capture_output=True)
        if not (own / "rows.npy").exists():
            return f"{case}: Geant4 failed: {done.stdout[-300:]} {done.stderr[-300:]}"
        theirs = np.load(own / "rows.npy")
    ours = rayweave(case, folder, binary, photons)
    line = f"{case:16}"
    for name, sign in (("reflected", 1), ("transmitted", -1)):
        a, b = (x[x[:, 0] * sign > 1e-6] for x in (ours, theirs))
        value, freedom = chi2(a, b)
        sigma = math.sqrt((a[:, 4].var() / len(a) + b[:, 4].var() / len(b))) if len(a) > 1 and len(b) > 1 else 0.0
        shift = a[:, 4].mean() - b[:, 4].mean() if len(a) and len(b) else 0.0
        time = shift / sigma if sigma > 1e-7 else (0.0 if abs(shift) < 1e-6 else math.inf)
        line += f" {name} {len(a):6} {len(b):6} z {z_of(len(a), len(b), photons):5.1f}"
        line += f" chi2 {value:6.1f}/{freedom:<3} time z {time:5.1f} |"
    return line


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--rayweave", default="rayweave")
    parser.add_argument("--photons", type=int, default=20_000)
    parser.add_argument("--case", action="append", choices=CASES)
    parser.add_argument("--worker", nargs=2)
    parser.add_argument("--folder")
    options = parser.parse_args()
    if options.worker:
        case, path = options.worker
        np.save(path, geant4(case, Path(options.folder), options.photons))
        return
    with tempfile.TemporaryDirectory() as folder:
        tables(Path(folder))
        print(f"{options.photons} photons each: counts of Rayweave and Geant4", flush=True)
        for case in options.case or CASES:
            print(compare(case, Path(folder), options.rayweave, options.photons), flush=True)


if __name__ == "__main__":
    main()
