"""Histories of optical photons in Geant4, as a table for `rayweave photons compare`.

    pip install geant4-pybind numpy
    python geant4_histories.py DETECTOR.gdml --at 0,0,0 --wavelength 420 -n 100000 --seed 1 -o geant4.csv

The detector is a GDML file. The table has a row for each track and the columns of `rayweave photons --histories`: photon, track, steps,
history, volume, x, y, z, time, wavelength_nm. `--hits` writes the table of detected photons in addition. Sources: `--at`, with `--towards`
for one direction and else all directions; `--wavelength NM` or `A:B`, unpolarised or `--polarisation`; or `--photons FILE.npy`, an array
(n, 4, 4) in the layout of Opticks.

Scintillation by optical photons (Bugzilla 2750) is switched off. The kind of a boundary event is the status of the boundary process.
The bindings have no access to it, so the script reads it from the memory of the process. In the first event, the process also prints
its status (verbosity 2), which shows where it is; if no place in the memory holds every printed status, the process prints to the end.
Geant4 asks on standard input about data sets; the script answers no. Tested with geant4-pybind 0.1.3 (Geant4 11.4.1).
"""

import argparse
import csv
import ctypes
import math
import os
import re
import sys
import tempfile
import time
import xml.etree.ElementTree
from pathlib import Path

import numpy as np

#: The data sets that Geant4 looks for; optical photons need none of them.
DATA = "ENSDFSTATE LE LEVELGAMMA PARTICLEXS SAIDXS NEUTRONHP RADIOACTIVE PII REALSURFACE ABLA INCL CHANNELING".split()

#: The names of Rayweave of the states of Geant4's boundary process.
BOUNDARY = {
    "Transmission": "transmission",
    "FresnelRefraction": "fresnel_refraction",
    "FresnelReflection": "fresnel_reflection",
    "TotalInternalReflection": "total_internal_reflection",
    "LambertianReflection": "lambertian_reflection",
    "LobeReflection": "lobe_reflection",
    "SpikeReflection": "spike_reflection",
    "BackScattering": "back_scattering",
    "Absorption": "surface_absorbed",
    "Detection": "detected",
    "SameMaterial": "same_material",
    "NoRINDEX": "no_index",
    "Dichroic Transmission": "dichroic_transmission",
    "CoatedDielectricReflection": "coated_reflection",
    "CoatedDielectricRefraction": "coated_refraction",
    "CoatedDielectricFrustratedTransmission": "coated_frustrated_transmission",
}

#: The states of the boundary process as they are printed, in the order of the enumeration G4OpBoundaryProcessStatus.
STATES = (
    "Undefined",
    "Transmission",
    "FresnelRefraction",
    "FresnelReflection",
    "TotalInternalReflection",
    "LambertianReflection",
    "LobeReflection",
    "SpikeReflection",
    "BackScattering",
    "Absorption",
    "Detection",
    "NotAtBoundary",
    "SameMaterial",
    "StepTooSmall",
    "NoRINDEX",
    *["Table"] * 24,
    "Dichroic Transmission",
    "CoatedDielectricReflection",
    "CoatedDielectricRefraction",
    "CoatedDielectricFrustratedTransmission",
)

#: The names of processes in a material.
BULK = {"OpRayleigh": "rayleigh", "OpMieHG": "mie", "OpAbsorption": "absorbed"}

#: Photons per event of Geant4.
PER_EVENT = 1000

#: The length in mm of steps that the boundary process ignores.
TOLERANCE = 1e-9

#: The number of bytes of the boundary process that the search for its status looks at.
PROCESS_SIZE = 1024

#: What the stepping action writes after each step.
MARK = b"@step\n"

COLUMNS = ["photon", "track", "steps", "history", "volume", "x", "y", "z", "time", "wavelength_nm"]
HIT_COLUMNS = ["event", "photon", "x", "y", "z", "time", "dx", "dy", "dz", "px", "py", "pz", "wavelength_nm", "steps", "sensor"]


def vector(text):
    values = [float(value) for value in text.split(",")]
    if len(values) != 3:
        raise argparse.ArgumentTypeError("give three numbers as X,Y,Z")
    return np.array(values)


def interval(text):
    low, _, high = text.partition(":")
    return float(low), float(high or low)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def starts(options):
    """Positions, directions, polarisations, wavelengths and times of the photons."""
    random = np.random.default_rng(options.seed)
    if options.photons is not None:
        rows = np.load(options.photons).astype(float)[: options.n]
        position, moment, direction = rows[:, 0, :3], rows[:, 0, 3], unit(rows[:, 1, :3])
        polarisation, wavelength = rows[:, 2, :3], rows[:, 2, 3]
        count = len(rows)
    else:
        count = options.n or 10_000
        position, moment = np.tile(options.at, (count, 1)), np.zeros(count)
        towards = unit(random.normal(size=(count, 3)))
        direction = towards if options.towards is None else np.tile(unit(options.towards), (count, 1))
        polarisation = np.zeros((count, 3)) if options.polarisation is None else np.tile(options.polarisation, (count, 1))
        wavelength = random.uniform(*options.wavelength, count)
    # unpolarised photons have a random polarisation
    unpolarised = np.linalg.norm(polarisation, axis=1) == 0
    polarisation = np.where(unpolarised[:, None], random.normal(size=(count, 3)), polarisation)
    across = polarisation - (polarisation * direction).sum(axis=1, keepdims=True) * direction
    return position, direction, unit(across), wavelength, moment


def bare(name):
    """A name without the pointer that Geant4 appends."""
    return re.sub(r"0x[0-9a-f]+$", "", name)


def sensitive_volumes(path):
    """The names of the volumes with the auxiliary tag SensDet."""
    volumes = xml.etree.ElementTree.parse(path).iter("volume")
    return {bare(v.get("name")) for v in volumes if any(a.get("auxtype") == "SensDet" for a in v.findall("auxiliary"))}


def explicit_copies(path):
    """The names of the placements that have a copy number in the file."""
    placed = xml.etree.ElementTree.parse(path).iter("physvol")
    return {bare(p.get("name") or "") for p in placed if p.get("copynumber") is not None}


class Capture:
    """The standard output of Geant4, in a file that is emptied after each event."""

    def __init__(self):
        self.file = os.fdopen(os.memfd_create("geant4"), "r+b")
        self.own = os.dup(1)
        # the file is opened for appending, so that it can be emptied
        descriptor = os.open(f"/proc/self/fd/{self.file.fileno()}", os.O_WRONLY | os.O_APPEND)
        sys.stdout.flush()
        os.dup2(descriptor, 1)

    def take(self):
        self.file.seek(0)
        text = self.file.read()
        self.file.truncate(0)
        return text

    def end(self):
        sys.stdout.flush()
        os.dup2(self.own, 1)


STATUS = re.compile(rb"\*\*\* *([A-Za-z ]+?) *\*\*\*")


def states(text):
    """The last state of the boundary process before each mark."""
    found = []
    for part in text.split(MARK)[:-1]:
        match = None
        for match in STATUS.finditer(part):
            pass
        found.append(match.group(1).decode() if match else "")
    return found


class BoundaryStatus:
    """The status of the boundary process, in its memory."""

    def __init__(self, process):
        self.process = process
        # an object of pybind11 is the head of a Python object and a pointer to the object in C++, or to a pointer to it
        pointer = ctypes.c_void_p.from_address(id(process) + object.__basicsize__).value
        self.addresses = [pointer, ctypes.c_void_p.from_address(pointer).value]
        self.copies = []

    def copy(self):
        """Stores the memory after a step."""
        self.copies += [ctypes.string_at(address, PROCESS_SIZE) for address in self.addresses]

    def find(self, printed):
        """Returns the number in the memory that was the printed status after each step; None if there is not exactly one."""
        words = np.frombuffer(b"".join(self.copies), np.int32).reshape(len(printed), 2, -1)
        numbers = np.array([STATES.index(state) if state in STATES else -1 for state in printed])
        # the process is not called after steps that end in the material or outside the world
        is_called = np.array([state != "" for state in printed])
        self.copies = []
        places = np.argwhere((words == numbers[:, None, None])[is_called].all(axis=0))
        if len(places) != 1:
            return None
        pointer, word = places[0].tolist()
        return ctypes.c_int32.from_address(self.addresses[pointer] + 4 * word)


class Track:
    """A track so far."""

    __slots__ = ("photon", "track", "rows", "end")

    def __init__(self, photon, track, rows):
        self.photon, self.track, self.rows, self.end = photon, track, rows, None


def simulate(options, tracks, hits):
    """Runs Geant4 and writes the two tables, event by event. Returns the numbers of tracks and hits and the seconds of the simulation."""
    empty = tempfile.mkdtemp()
    Path(empty, "ENSDFSTATE.dat").touch()
    os.environ.update({f"G4{name}DATA": empty for name in DATA})
    read, write = os.pipe()
    os.write(write, b"n\n" * 8)  # the answer to the question whether to download them
    os.close(write)
    os.dup2(read, 0)
    import geant4_pybind as g4

    path = options.detector
    sensitive = sensitive_volumes(path)
    numbered = explicit_copies(path)
    position, direction, polarisation, wavelength, moment = starts(options)
    energy = g4.h_Planck * g4.c_light / (wavelength * g4.nm)
    count = len(position)

    class World(g4.G4VUserDetectorConstruction):
        def Construct(self):
            self.parser = g4.G4GDMLParser()
            self.parser.SetOverlapCheck(False)
            self.parser.Read(str(path), False)
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
            self.gun, self.next = None, 0

        def GeneratePrimaries(self, event):
            if self.gun is None:
                self.gun = g4.G4ParticleGun(1)
                self.gun.SetParticleDefinition(g4.G4ParticleTable.GetParticleTable().FindParticle("opticalphoton"))
            run.begin(self.next)
            for k in range(self.next, min(self.next + PER_EVENT, count)):
                self.gun.SetParticleEnergy(energy[k])
                self.gun.SetParticlePosition(g4.G4ThreeVector(*position[k]))
                self.gun.SetParticleMomentumDirection(g4.G4ThreeVector(*direction[k]))
                self.gun.SetParticlePolarization(g4.G4ThreeVector(*polarisation[k]))
                self.gun.SetParticleTime(moment[k])
                self.gun.GeneratePrimaryVertex(event)
            self.next += PER_EVENT

    def volume_path(touchable):
        """The path of a volume in the form of Rayweave: names of volumes, with the copy numbers of the file."""
        depth = touchable.GetHistoryDepth()
        if depth == 0:
            return segment(touchable.GetVolume(0), 0)
        return "/".join([segment(touchable.GetVolume(d), touchable.GetReplicaNumber(d)) for d in reversed(range(depth))])

    # The segments of paths by volume and copy number. The bindings return the same objects for as long as these are kept.
    segments = {}

    def segment(volume, copy):
        known = segments.get((volume, copy))
        if known is None:
            known = bare(volume.GetLogicalVolume().GetName())
            known = f"{known}[{copy}]" if copy != 0 or bare(volume.GetName()) in numbered else known
            segments[volume, copy] = known
        return known

    class Run:
        """The tracks of the event."""

        def __init__(self):
            self.further, self.tracks_written, self.hits_written = 0, 0, 0
            # the number in memory, once it is found
            self.status = None
            self.search = BoundaryStatus(g4.G4ProcessTable.GetProcessTable().FindProcess("OpBoundary", "opticalphoton"))

        def begin(self, first):
            self.first, self.tracks, self.steps = first, {}, []

        def name(self, state):
            """The name of a state of the boundary process."""
            name = BOUNDARY.get(state) or f"unknown:{state.replace(' ', '')}"
            return "surface_absorbed" if name == "detected" and options.detect == "volume" else name

        def fill(self, printed):
            """Fills in the printed states."""
            for at, state in zip(self.steps, printed, strict=True):
                track, k = at or (None, 0)
                if track is not None and track.rows[k] == "?":
                    track.rows[k] = self.name(state)

        def finish(self):
            """Writes the tracks of the event."""
            ended = {id(track): track for track in self.tracks.values() if track.end is not None}
            for track in sorted(ended.values(), key=lambda track: (track.photon, track.track)):
                rows = track.rows
                # a wavelength shifter that emitted nothing
                if rows[-1] == "shift":
                    rows[-1] = "shifter_absorbed"
                path, (x, y, z), moment, length, hit = track.end
                steps = len(rows) - 1
                tracks.writerow([track.photon, track.track, steps, " ".join(rows), path, x, y, z, moment, length])
                self.tracks_written += 1
                if rows[-1] == "detected":
                    self.hits_written += 1
                    if hit is not None:
                        vectors, sensor = hit
                        hits.writerow([0, track.photon, x, y, z, moment, *vectors, length, steps, sensor])

    class Steps(g4.G4UserSteppingAction):
        def UserSteppingAction(self, step):
            current = run.current
            rows = current.rows
            if run.status is None:
                os.write(1, MARK)
                run.search.copy()
                self.add(step, current, rows)
            elif step.GetPostStepPoint().GetStepStatus() != g4.fGeomBoundary:
                self.add(step, current, rows)
            else:
                name = names[run.status.value]
                if name is None:
                    # the step after a reflection (StepTooSmall)
                    return
                rows.append(name)
                self.enter(step, current, rows)
            if len(rows) > options.max_steps and step.GetTrack().GetTrackStatus() == g4.fAlive:
                rows.append("step_limit")
                step.GetTrack().SetTrackStatus(g4.fStopAndKill)

        def add(self, step, current, rows):
            """Adds a step that does not end at a boundary, or whose status is not known yet."""
            after = step.GetPostStepPoint()
            process = after.GetProcessDefinedStep().GetProcessName()
            at = (current, len(rows))
            if process in BULK:
                rows.append(BULK[process])
            elif process.startswith("OpWLS"):
                rows.append("shift")
            elif after.GetStepStatus() == g4.fWorldBoundary:
                rows.append("escaped")
            elif step.GetStepLength() <= TOLERANCE:
                # the step after a reflection, back into the volume, in which nothing happens (StepTooSmall)
                at = None
            else:
                rows.append("?")
                self.enter(step, current, rows)
            run.steps.append(at)

        def enter(self, step, current, rows):
            """Detects a photon that moves into a sensor."""
            after = step.GetPostStepPoint()
            if not self.is_sensor(after):
                return
            track = step.GetTrack()
            volumes = after.GetTouchable().GetVolume(), step.GetPreStepPoint().GetTouchable().GetVolume()
            if track.GetTrackStatus() == g4.fAlive and self.goes_on(step, track.GetMomentumDirection()) and volumes[0] != volumes[1]:
                rows.append("detected")
                run.into_sensor = True
                track.SetTrackStatus(g4.fStopAndKill)

        def is_sensor(self, point):
            if options.detect == "efficiency" or not sensitive:
                return False
            touchable = point.GetTouchable()
            volume = touchable.GetVolume()
            return volume is not None and bare(volume.GetLogicalVolume().GetName()) in sensitive

        def goes_on(self, step, direction):
            """Whether a photon at a boundary is transmitted: it leaves on the side of the normal that it came to."""
            after = step.GetPostStepPoint()
            touchable = after.GetTouchable()
            history = touchable.GetHistory().GetTopTransform()
            solid = touchable.GetVolume().GetLogicalVolume().GetSolid()
            local = history.TransformPoint(after.GetPosition())
            normal = solid.SurfaceNormal(local)
            return normal.dot(history.TransformAxis(direction)) < 0

    class Tracking(g4.G4UserTrackingAction):
        def PreUserTrackingAction(self, track):
            number, parent = track.GetTrackID(), track.GetParentID()
            run.into_sensor = False
            if parent == 0:
                photon = run.first + number - 1
                run.current = Track(photon, photon, ["emission"])
            else:
                absorbed = run.tracks[parent]
                if absorbed.end is not None and absorbed.rows[-1] == "shift":
                    # the first photon of a wavelength shifter continues the history
                    absorbed.rows[-1] = "reemission"
                    run.current = Track(absorbed.photon, absorbed.track, absorbed.rows)
                    absorbed.end = None
                else:
                    run.further += 1
                    run.current = Track(absorbed.photon, 2**62 + run.further, ["reemission"])
            run.tracks[number] = run.current

        def PostUserTrackingAction(self, track):
            step = track.GetStep()
            before, after = step.GetPreStepPoint(), step.GetPostStepPoint()
            at = after.GetPosition()
            length = g4.h_Planck * g4.c_light / track.GetVertexKineticEnergy() / g4.nm
            path = volume_path((after if run.into_sensor else before).GetTouchable())
            hit = None
            if options.hits is not None:
                direction, across, inside = before.GetMomentumDirection(), before.GetPolarization(), after.GetTouchable()
                sensor = volume_path(inside) if inside.GetVolume() is not None else ""
                hit = (direction.x, direction.y, direction.z, across.x, across.y, across.z), sensor
            run.current.end = path, (at.x, at.y, at.z), after.GetGlobalTime(), length, hit

    class Actions(g4.G4VUserActionInitialization):
        def Build(self):
            self.parts = [Gun(), Steps(), Tracking()]
            for part in self.parts:
                self.SetUserAction(part)

    capture = Capture()
    manager = g4.G4RunManagerFactory.CreateRunManager(g4.G4RunManagerType.Serial)
    keep = [World(), Physics(), Actions()]
    for part in keep:
        manager.SetUserInitialization(part)
    orders = g4.G4UImanager.GetUIpointer()
    manager.Initialize()
    orders.ApplyCommand("/process/inactivate Scintillation opticalphoton")
    orders.ApplyCommand("/process/optical/boundary/verbose 2")
    orders.ApplyCommand(f"/random/setSeeds {options.seed + 1} {options.seed + 7919}")
    run = Run()
    # the names of the numbers of the status
    names = [None if state == "StepTooSmall" else run.name(state) for state in STATES]
    begin = time.perf_counter()
    for _ in range(math.ceil(count / PER_EVENT)):
        capture.take()
        manager.BeamOn(1)
        text = capture.take()
        if run.status is None:
            printed = states(text)
            run.fill(printed)
            run.status = run.search.find(printed)
            if run.status is not None:
                orders.ApplyCommand("/process/optical/boundary/verbose 0")
        run.finish()
    seconds = time.perf_counter() - begin
    capture.end()
    return run.tracks_written, run.hits_written, seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("detector", type=Path)
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--hits", type=Path)
    parser.add_argument("--at", type=vector, default=vector("0,0,0"))
    parser.add_argument("--towards", type=vector)
    parser.add_argument("--polarisation", type=vector)
    parser.add_argument("--wavelength", type=interval, default=(420.0, 420.0))
    parser.add_argument("--photons", type=Path)
    parser.add_argument("-n", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--detect", choices=("efficiency", "volume", "both"), default="both")
    parser.add_argument("--max-steps", type=int, default=10_000)
    options = parser.parse_args()
    # a fatal exception of Geant4 ends the process: it leaves unfinished files, not tables that look complete
    paths = [path for path in (options.out, options.hits) if path is not None]
    unfinished = [path.with_name(path.name + ".unfinished") for path in paths]
    files = [open(path, "w", newline="") for path in (*unfinished, os.devnull)]
    with files[0] as tracks, files[1] as hits, files[-1]:
        tables = [csv.writer(file, lineterminator="\n") for file in (tracks, hits)]
        for table, columns in zip(tables, (COLUMNS, HIT_COLUMNS)):
            table.writerow(columns)
        written, found, seconds = simulate(options, *tables)
    for own, path in zip(unfinished, paths):
        os.replace(own, path)
    print(f"{written} tracks, {found} hits in {seconds:.1f} s: {written / max(seconds, 1e-9):.0f} tracks/s")
    sys.stdout.flush()
    os._exit(0)  # Geant4 may fail while it takes itself apart


if __name__ == "__main__":
    main()
