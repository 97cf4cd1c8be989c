"""Optical photons per second in Rayweave and in Geant4: the same GDML detectors and sources, one thread each, hits only.

    pip install geant4-pybind
    python geant4_photons.py RAYWEAVE [--repeat 3] [--seconds 5] [--only NAME ...]

RAYWEAVE is the path of the `rayweave` command. Both programs run alternately, each in a process of its own. The time is that for
which a program has the processor during the simulation, without reading the detector: for Rayweave the difference to a run of one
photon. The number of photons is chosen for each program such that a run takes about as long as requested. The median of several runs
counts. The steps and hits of Geant4 come from a separate run, because counting them slows it down. Output: a Markdown table.
"""

import argparse
import datetime
import importlib.util
import json
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import photon_detectors

#: The data sets that Geant4 looks for; optical photons need none of them.
DATA = "ENSDFSTATE LE LEVELGAMMA PARTICLEXS SAIDXS NEUTRONHP RADIOACTIVE PII REALSURFACE ABLA INCL CHANNELING".split()


def geant4(path, wavelength, position, photons, counts):
    """Simulates photons of a point source in this process. Returns the seconds, and the steps and hits if `counts`."""
    empty = tempfile.mkdtemp()
    Path(empty, "ENSDFSTATE.dat").touch()
    os.environ.update({f"G4{name}DATA": empty for name in DATA})
    read, write = os.pipe()
    os.write(write, b"n\n" * 8)  # the answer to the question whether to download them
    os.close(write)
    os.dup2(read, 0)
    import geant4_pybind as g4

    class World(g4.G4VUserDetectorConstruction):
        def Construct(self):
            self.parser = g4.G4GDMLParser()
            self.parser.Read(str(path), False)
            self.sensor = Sensor("sensor")
            volumes = g4.G4LogicalVolumeStore.GetInstance()
            for name in photon_detectors.SENSORS if counts else ():
                volume = volumes.GetVolume(name, False)
                if volume is not None:
                    volume.SetSensitiveDetector(self.sensor)
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
            self.gun, self.count = None, 1000

        def GeneratePrimaries(self, event):
            if self.gun is None:
                self.gun = g4.G4ParticleGun(1)
                self.gun.SetParticleDefinition(g4.G4ParticleTable.GetParticleTable().FindParticle("opticalphoton"))
                self.gun.SetParticleEnergy(1.239841984e-3 / wavelength * g4.MeV)
                self.gun.SetParticlePosition(g4.G4ThreeVector(*position))
            for _ in range(self.count):
                direction = g4.G4RandomDirection()
                self.gun.SetParticleMomentumDirection(direction)
                self.gun.SetParticlePolarization(direction.orthogonal().unit())
                self.gun.GeneratePrimaryVertex(event)

    seen = {"steps": 0, "hits": 0}

    class Steps(g4.G4UserSteppingAction):
        def UserSteppingAction(self, step):
            seen["steps"] += 1

    class Sensor(g4.G4VSensitiveDetector):
        """The boundary process calls it for each detected photon."""

        def ProcessHits(self, step, history):
            # other calls are steps of reflected photons, which begin behind the surface
            seen["hits"] += step.GetTotalEnergyDeposit() > 0
            return True

    class Actions(g4.G4VUserActionInitialization):
        def Build(self):
            self.gun = Gun()
            self.SetUserAction(self.gun)
            if counts:
                self.steps = Steps()
                self.SetUserAction(self.steps)

    manager = g4.G4RunManagerFactory.CreateRunManager(g4.G4RunManagerType.Serial)
    actions = Actions()
    keep = [World(), Physics(), actions]
    for part in keep:
        manager.SetUserInitialization(part)
    orders = g4.G4UImanager.GetUIpointer()
    orders.ApplyCommand("/process/optical/boundary/setInvokeSD true")
    manager.Initialize()
    # Geant4 11.4 lets absorbed optical photons scintillate (Bugzilla 2750)
    orders.ApplyCommand("/process/inactivate Scintillation opticalphoton")
    manager.BeamOn(1)
    seen.update(steps=0, hits=0)
    start = time.process_time()
    manager.BeamOn(max(1, photons // 1000))
    return {"photons": max(1, photons // 1000) * 1000, "seconds": time.process_time() - start, **seen}


def run_geant4(path, wavelength, position, photons, counts=False):
    arguments = [str(path), str(wavelength), *map(str, position), str(photons), str(int(counts))]
    command = [sys.executable, __file__, "--geant4", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if not lines:
        raise RuntimeError(f"Geant4 failed on {path}: {done.stdout[-2000:]}{done.stderr[-2000:]}")
    return json.loads(lines[-1])


def run_rayweave(command, path, wavelength, position, photons):
    at = ",".join(map(str, position))

    def simulate(count):
        arguments = [command, "photons", str(path), "--at", at, "--wavelength", str(wavelength), "-n", str(count)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        with tempfile.TemporaryDirectory() as folder:
            arguments += ["--threads", "1", "--json", "-o", str(Path(folder, "hits.npy"))]
            done = subprocess.run(arguments, capture_output=True, text=True, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return json.loads(done.stdout), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    start = simulate(1)[1]
    run, took = simulate(photons)
    return {**run, "seconds": max(took - start, 1e-3)}


def fitting(run, seconds):
    """The number of photons that a run of so many seconds simulates."""
    photons = 2000
    while True:
        took = run(photons)["seconds"]
        if took > 0.2 * seconds:
            return max(1000, round(photons * seconds / took / 1000) * 1000)
        photons *= 4 if took < 0.05 * seconds else 2


def processor():
    names = [line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    return names[0] if names else platform.processor()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rayweave")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--only", nargs="*")
    options = parser.parse_args()
    if importlib.util.find_spec("geant4_pybind") is None:
        print("skipped: the package geant4-pybind is not installed")
        return
    print(f"{processor()}, {datetime.date.today()}, 1 thread")
    print()
    print("| detector | Rayweave photons/s | steps/s | Geant4 photons/s | steps/s | ratio | steps per photon | hits per photon |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    with tempfile.TemporaryDirectory() as folder:
        for name, path, wavelength, position in photon_detectors.write(folder):
            if options.only and name not in options.only:
                continue
            source = (path, wavelength, position)
            programs = [lambda n: run_rayweave(options.rayweave, *source, n), lambda n: run_geant4(*source, n)]
            counts = [fitting(run, options.seconds) for run in programs]
            times, last = [[], []], [None, None]
            for _ in range(options.repeat):
                for k, (run, count) in enumerate(zip(programs, counts)):
                    last[k] = run(count)
                    times[k].append(last[k]["seconds"])
            rates = [count / statistics.median(taken) for count, taken in zip(counts, times)]
            counted = run_geant4(*source, min(counts[1], 20000), counts=True)
            steps = [last[0]["steps"] / counts[0], counted["steps"] / counted["photons"]]
            hits = [last[0]["hits"] / counts[0], counted["hits"] / counted["photons"]]
            print(
                f"| `{name}` | {rates[0]:,.0f} | {rates[0] * steps[0]:,.0f} | {rates[1]:,.0f} | {rates[1] * steps[1]:,.0f} "
                f"| {rates[0] / rates[1]:.1f} | {steps[0]:.2f}, {steps[1]:.2f} | {hits[0]:.4f}, {hits[1]:.4f} |",
                flush=True,
            )


if __name__ == "__main__":
    if sys.argv[1:2] == ["--geant4"]:
        file, length, x, y, z, number, is_counted = sys.argv[2:]
        print(json.dumps(geant4(file, float(length), [float(v) for v in (x, y, z)], int(number), is_counted == "1")))
    else:
        main()
