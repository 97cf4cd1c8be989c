#!/usr/bin/env python3
"""Runs the command on mutated files of every kind that it reads.

`python3 fuzz/mutate.py target/release/rayweave [--seconds S] [--seed N] [--keep FOLDER] [WORD..]` mutates small files that the command
reads without an error, S CPU seconds for each reader, and runs the command on each. It prints each different fault with the input
that shows it, which is kept in FOLDER: a panic, a signal, more than 10 CPU seconds or 2 GB, a failure without a message or
without the name of the file, and NaN in the answer of a command that succeeded. WORDs select readers by parts of their names.
The messages of each reader, with their counts, are written to FOLDER for review. Linux.
"""

import argparse
import io
import json
import os
import random
import re
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import zipfile

CPU_SECONDS, ADDRESS_SPACE = 10, 2_000_000_000

HERE = os.path.dirname(os.path.abspath(__file__))

NUMBERS = ["0", "-0", "1", "-1", "2", "1e-9", "1e-320", "5e-324", "1e6", "1e18", "1e60", "1e155", "1.7976931348623157e308", "1e309", "-1e309",
           "nan", "NaN", "inf", "-inf", "Infinity", "65536", "2147483647", "2147483648", "-2147483648", "4294967295", "4294967296",
           "9007199254740993", "9223372036854775807", "9223372036854775808", "18446744073709551615", "0x10", "1,5", "1e", ".", "-", "+1", "1d3"]

WORDS = ["\0", "\ufeff", "\r", "\r\n", "\t", "\u00e4", "\u202e", "\U0001f600", "\"", "'", "<", ">", "&", "]]>", "<!--", "*/", "\\", "${x}", "../x", "%s", "#",
         "x" * 300, "x" * 70_000, "(", ")", "[", "]", "{", "}", "=", ",", ";", ":"]


def text_mutant(data, other, rng):
    """A mutant of a text: changes of numbers, words, lines, brackets, and of the encoding."""
    text = data.decode("utf-8", "surrogateescape")
    for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
        kind = rng.randrange(13)
        tokens = list(re.finditer(r"[-+]?\d[\d.eE+-]*|\w+", text))
        lines = text.splitlines(keepends=True)
        if kind < 4 and tokens:
            numbers = [token for token in tokens if token[0][-1:].isdigit()] or tokens
            token = rng.choice(numbers if kind < 3 else tokens)
            new = rng.choice(NUMBERS) if kind < 3 else rng.choice(tokens)[0]
            text = text[:token.start()] + new + text[token.end():]
        elif kind == 4 and tokens:
            token = rng.choice(tokens)
            text = text[:token.start()] + rng.choice(("", rng.choice(WORDS), token[0] * 2)) + text[token.end():]
        elif kind == 5 and lines:
            del lines[rng.randrange(len(lines))]
            text = "".join(lines)
        elif kind == 6 and lines:
            at = rng.randrange(len(lines))
            lines[at:at] = [rng.choice(lines)] * rng.choice((1, 1, 2, 50))
            text = "".join(lines)
        elif kind == 7 and len(lines) > 1:
            a, b = rng.randrange(len(lines)), rng.randrange(len(lines))
            lines[a], lines[b] = lines[b], lines[a]
            text = "".join(lines)
        elif kind == 8:
            at = rng.randrange(len(text) + 1)
            text = text[:at] + rng.choice(WORDS) + text[at:]
        elif kind == 9:
            text = text[:rng.randrange(len(text) + 1)]
        elif kind == 10:
            # an element, a table or a bracketed part: deleted, repeated, or put into itself
            parts = list(re.finditer(r"<(\w+)[^<>]*/>|<(\w+)[^<>]*>[^<>]*</\2>|\[[^\[\]]*\]|\{[^{}]*\}|\([^()]*\)", text))
            if parts:
                part = rng.choice(parts)
                whole = part[0]
                new = rng.choice(("", whole * 2, whole[:1] + whole + whole[-1:], whole[:len(whole) // 2] + whole + whole[len(whole) // 2:]))
                text = text[:part.start()] + new + text[part.end():]
        elif kind == 11:
            foreign = other.decode("utf-8", "surrogateescape").splitlines(keepends=True)
            if foreign and lines:
                at = rng.randrange(len(foreign))
                lines[rng.randrange(len(lines))] = "".join(foreign[at:at + rng.choice((1, 3, 10))])
                text = "".join(lines)
        elif rng.random() < 0.2:
            return text.encode(rng.choice(("utf-16", "utf-16-be", "utf-32", "latin-1")), "replace")
    data = text.encode("utf-8", "surrogateescape")
    return binary_mutant(data, other, rng) if rng.random() < 0.1 else data


def binary_mutant(data, other, rng):
    """A mutant of bytes: single bits, integers and floats at aligned places, pieces deleted, repeated, swapped, truncated."""
    data = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 4))):
        at = rng.randrange(len(data) + 1)
        size = rng.choice((1, 2, 4, 8))
        end = min(len(data), at + rng.choice((1, 4, 16, 100)))
        kind = rng.randrange(9)
        if kind == 0 and at < len(data):
            data[at] ^= 1 << rng.randrange(8)
        elif kind in (1, 2):
            at -= at % size
            order = rng.choice(("little", "big"))
            value = rng.choice((0, 1, 2, 127, 128, 255, 256, 65535, 65536, (1 << 8 * size - 1) - 1, 1 << 8 * size - 1, (1 << 8 * size) - 1, len(data)))
            data[at:at + size] = (value % (1 << 8 * size)).to_bytes(size, order)
        elif kind == 3:
            form = rng.choice("fd")
            at -= at % struct.calcsize(form)
            value = rng.choice((float("nan"), float("inf"), float("-inf"), 0.0, -1.0, 1e30, -1e-30, 3.4e38, 1e-45))
            data[at:at + struct.calcsize(form)] = struct.pack("<" + form, value)
        elif kind == 4:
            del data[at:end]
        elif kind == 5:
            data[at:at] = data[at:end]
        elif kind == 6:
            del data[at:]
        elif kind == 7:
            start = rng.randrange(len(other) + 1)
            data[at:end] = other[start:start + end - at]
        else:
            data[at:at] = bytes(rng.randrange(256) for _ in range(rng.choice((1, 8, 64))))
    return bytes(data)


def npy_mutant(data, other, rng):
    """A mutant of an NPY file: of its header as text, or of its numbers."""
    length = int.from_bytes(data[8:10], "little")
    if rng.random() < 0.4:
        header = text_mutant(data[10:10 + length], other[10:10 + length], rng)
        if rng.random() < 0.7:
            return data[:8] + struct.pack("<H", len(header) % 65536) + header + data[10 + length:]
        return data[:10] + header + data[10 + length:]
    if rng.random() < 0.7:
        return data[:10 + length] + binary_mutant(data[10 + length:], other, rng)
    return binary_mutant(data, other, rng)


def zip_mutant(data, other, rng):
    """A mutant of an archive: of a file in it, or of its bytes."""
    if rng.random() < 0.25:
        return binary_mutant(data, other, rng)
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as archive, zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as changed:
        names = archive.namelist()
        chosen = rng.choice(names)
        for name in names:
            content = archive.read(name)
            if name == chosen:
                content = text_mutant(content, archive.read(rng.choice(names)), rng)
                name = rng.choice((name, name, name, name, name + "x", "../" + name))
            changed.writestr(name, content)
    return out.getvalue()


def glb_mutant(data, other, rng):
    """A mutant of a binary glTF: of its JSON, with the lengths adapted, or of its bytes."""
    if rng.random() < 0.3:
        return binary_mutant(data, other, rng)
    length = int.from_bytes(data[12:16], "little")
    text = text_mutant(data[20:20 + length], data[20:20 + length], rng)
    text += b" " * (-len(text) % 4)
    rest = data[20 + length:]
    return data[:8] + struct.pack("<II", 20 + len(text) + len(rest), len(text)) + data[16:20] + text + rest


class Reader:
    """A command with files: `seeds` are sets of files, of which `targets` are mutated."""

    def __init__(self, name, arguments, seeds, targets, mutant=text_mutant):
        self.name, self.arguments, self.seeds, self.targets, self.mutant = name, arguments, seeds, targets, mutant


def files_below(folder, ending, most=60_000):
    folder = os.path.join(HERE, "..", folder)
    paths = sorted(os.path.join(folder, name) for name in os.listdir(folder) if name.endswith(ending))
    contents = [open(path, "rb").read() for path in paths if os.path.isfile(path)]
    return [content for content in contents if len(content) <= most]


def npy(descr, shape, data):
    header = f"{{'descr': {descr!r}, 'fortran_order': False, 'shape': {shape}, }}"
    header += " " * (-(len(header) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + data


BALL = b"rayweave = 1\n[solid.ball]\nsphere = { radius = 2 }\n[[region]]\nsolid = 'ball'\n"

PARTS = b"""rayweave = 1
unit = 'mm'
[parameters]
r = 2
[solid.ball]
sphere = { radius = 'r' }
[solid.block]
box = { size = ['2 * r', 4, 5] }
transform = [{ rotate_x = 30 }, { translate = [1, 0, 0] }]
[solid.plate]
extrude = { outline = [[0, 0], [6, 0], [6, 4], { at = [0, 4], fillet = 1 }], height = 2 }
[solid.ring]
revolve = { outline = [[1, 0], [3, 0], [3, 1], [1, 1]] }
[solid.row]
place = { solid = 'ball', grid = [2, 2, 1], step = [5, 5, 0] }
[solid.part]
expr = 'block - ball | plate & ring'
[[region]]
solid = 'part'
medium = 'steel'
[[region]]
solid = 'row'
[medium.steel]
density = 7.8
"""

BAR = b"""rayweave = 1
[solid.hall]
box = { size = [200, 200, 200] }
[solid.bar]
box = { size = [20, 20, 100] }
[solid.diode]
box = { size = [20, 20, 1] }
transform = [{ translate = [0, 0, 50.5] }]
[[region]]
solid = 'hall'
medium = 'opaque'
[[region]]
solid = 'bar'
medium = 'crystal'
[[region]]
solid = 'diode'
medium = 'opaque'
[medium.opaque]
[medium.crystal]
[photons.medium.crystal]
RINDEX = 1.79
SCINTILLATIONCOMPONENT1 = { eV = [2, 3], value = [1, 1] }
SCINTILLATIONYIELD1 = 1
SCINTILLATIONTIMECONSTANT1 = 5
[photons.sensor]
diode = 'photodiode'
"""


def slab(surface):
    """A slab in vacuum with an optical surface, as GDML."""
    return f"""<?xml version="1.0"?><gdml><define><matrix name="ONE" coldim="2" values="1*eV 1 10*eV 1"/>
<matrix name="GLASS" coldim="2" values="1*eV 1.5 10*eV 1.5"/><matrix name="FILM" coldim="1" values="100*nm"/></define>
<materials><material name="Vacuum" Z="1"><property name="RINDEX" ref="ONE"/><D value="1e-25"/><atom value="1"/></material>
<material name="Glass" Z="6"><property name="RINDEX" ref="GLASS"/><D value="2"/><atom value="12"/></material></materials>
<solids><box name="world" x="200" y="200" z="200"/><box name="plate" x="100" y="100" z="10"/>{surface}</solids>
<structure><volume name="Slab"><materialref ref="Glass"/><solidref ref="plate"/></volume>
<volume name="World"><materialref ref="Vacuum"/><solidref ref="world"/>
<physvol name="slab"><volumeref ref="Slab"/></physvol></volume>
<skinsurface name="skin" surfaceproperty="S"><volumeref ref="Slab"/></skinsurface></structure>
<setup name="s" version="1"><world ref="World"/></setup></gdml>""".encode()


LIGHT = b"""rayweave = 1
[solid.ball]
sphere = { radius = 10 }
[[region]]
solid = 'ball'
[optics]
[optics.medium]
ball = GLASS
[[optics.source]]
beam = { circle = 1, rays = 5 }
transform = [{ translate = [0, 0, -50] }]
"""

YAML = b"""REFERENCES: |
    <a href="https://example.org/">maker</a> (2017)<br>See also
DATA:
  - type: formula 2
    wavelength_range: 0.3 2.5
    coefficients: 0 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653
  - type: tabulated k
    data: |
        0.300 2.8607E-06
        0.310 1.3679E-06
CONDITIONS:
    temperature: 293
PROPERTIES:
    nd: 1.5168
    Vd: 64.17
    density:
      - value: 2510
"""

YAML_TABLE = b"DATA:\n  - type: tabulated nk\n    data: |\n        0.5209 0.62 2.081\n        0.5486 0.43 2.455\n        0.7 0.2 3\n"

MESHED = b"rayweave = 1\n[solid.a]\nbox = { size = 2 }\n[solid.b]\nsphere = { radius = 1.2 }\n[solid.c]\nexpr = 'a - b'\n[[region]]\nsolid = 'c'\n"

DRAWN = b'linear_extrude(height = 3) import(file = "FILE", layer = "", origin = [0, 0], scale = 1, $fn = 8);'


def converted(program, ending, *options):
    """A small solid as a file of another format."""
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "m.toml"), "wb") as out:
            out.write(MESHED)
        subprocess.run([program, "convert", "m.toml", f"o.{ending}", "--tolerance", "0.5", *options], cwd=folder, check=True, capture_output=True)
        return open(os.path.join(folder, f"o.{ending}"), "rb").read()


def parts(program, arguments, ranges, ending, files):
    """The files of parts that the command writes for some ranges."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in files.items():
            with open(os.path.join(folder, name), "wb") as out:
                out.write(content)
        for k, part in enumerate(ranges):
            subprocess.run([program, *arguments, "--range", part, "-o", f"p{k}.{ending}"], cwd=folder, check=True, capture_output=True)
        return {name: open(os.path.join(folder, name), "rb").read() for name in sorted(os.listdir(folder)) if name not in files}


def readers(program):
    corpus = lambda name, ending="": files_below("fuzz/corpus/" + name, ending)
    all = []

    def add(name, arguments, seeds, targets, mutant=text_mutant):
        all.append(Reader(name, arguments, seeds, targets, mutant))

    gdml = files_below("crates/formats/tests/gdml", ".gdml") + [data for data in corpus("gdml") if b"file" not in data]
    add("gdml", ["info", "m.gdml"], [{"m.gdml": data} for data in gdml], ["m.gdml"])
    add("gdml of photons", ["photons", "m.gdml", "--at", "0,0,-50", "--wavelength", "420", "-n", "5"],
        [{"m.gdml": slab('<opticalsurface name="S" model="glisur" finish="polished" type="coated" value="1">'
                         '<property name="COATEDRINDEX" ref="GLASS"/><property name="COATEDTHICKNESS" ref="FILM"/></opticalsurface>')}], ["m.gdml"])
    add("toml", ["info", "m.toml"], [{"m.toml": PARTS}, {"m.toml": BAR}] + [{"m.toml": data} for data in files_below("models", ".toml")], ["m.toml"])
    add("toml volume", ["volume", "m.toml", "--precision", "0.5"], [{"m.toml": PARTS}], ["m.toml"])
    add("toml section", ["section", "m.toml"], [{"m.toml": PARTS}], ["m.toml"])
    add("toml of photons", ["photons", "m.toml", "--at", "0,0,0", "--wavelength", "420", "-n", "5"], [{"m.toml": BAR}], ["m.toml"])
    add("toml of optics", ["optics", "m.toml"], [{"m.toml": data} for data in files_below("models/optics", ".toml")], ["m.toml"])
    add("csg", ["info", "m.csg"], [{"m.csg": data} for data in [converted(program, "csg")] + [data[1:] for data in corpus("openscad") if b"file" not in data]], ["m.csg"])
    toml = LIGHT.replace(b"GLASS", b"{ file = 'm.yml' }")
    add("yaml", ["optics", "m.toml"], [{"m.toml": toml, "m.yml": data} for data in [YAML, YAML_TABLE] * 4 + [data[1:] for data in corpus("glass") if data[0] % 2]], ["m.yml"])
    add("zmx", ["optics", "m.zmx"], [{"m.zmx": data} for data in files_below("models/optics", ".zmx") + corpus("zmx")], ["m.zmx"])
    for ending, mutant in (("3mf", zip_mutant), ("glb", glb_mutant), ("gltf", text_mutant), ("stl", binary_mutant), ("ply", binary_mutant),
                           ("obj", text_mutant), ("off", text_mutant)):
        seeds = [{f"m.{ending}": converted(program, ending)}]
        add(ending, ["info", f"m.{ending}"], seeds, [f"m.{ending}"], mutant)
        if ending in ("stl", "ply"):
            add(ending + " text", ["info", f"m.{ending}"], [{f"m.{ending}": converted(program, ending, "--text")}], [f"m.{ending}"])
    for ending, parity in (("dxf", 0), ("svg", 1)):
        drawings = [data[1:] for data in corpus("drawing") if data[:1] and data[0] % 2 == parity]
        add(ending, ["info", "m.csg"], [{"m.csg": DRAWN.replace(b"FILE", b"m." + ending.encode()), f"m.{ending}": data} for data in drawings], [f"m.{ending}"])
    rays = [[0.1 * k - 1, 0, -5, 0, 0, 1] for k in range(20)]
    table = "ox,oy,oz,dx,dy,dz\n" + "".join(",".join(map(str, ray)) + "\n" for ray in rays)
    array = npy("<f8", (20, 6), b"".join(struct.pack("<6d", *ray) for ray in rays))
    add("rays csv", ["trace", "m.toml", "--rays", "r.csv", "-o", "-"], [{"m.toml": BALL, "r.csv": table.encode()}], ["r.csv"])
    add("rays npy", ["trace", "m.toml", "--rays", "r.npy", "-o", "-"], [{"m.toml": BALL, "r.npy": array}], ["r.npy"], npy_mutant)
    maps = npy("<f8", (2, 3, 4), struct.pack("<24d", *(1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0) * 2))
    moves = npy("<f8", (3, 3), struct.pack("<9d", *(0, 0, 0, 5, 0, 0, 0, 9, 0)))
    placed = BALL.replace(b"[[region]]\nsolid = 'ball'", b"[solid.p]\nplace = { solid = 'ball', file = 'm.npy' }\n[[region]]\nsolid = 'p'")
    add("places npy", ["info", "m.toml"], [{"m.toml": placed, "m.npy": maps}, {"m.toml": placed, "m.npy": moves}], ["m.npy"], npy_mutant)
    step = struct.pack("<4i", 3, 0, 1, 10) + struct.pack("<4f", 0, 0, 0, 0) + struct.pack("<4f", 0, 0, 1, 1) + struct.pack("<4f", 1, 200, 1, 0) * 3
    geant4 = struct.pack("<16d", *(1, 0, 0, 0, 5, 0, 0, 0, 0, 0, 0, 1, 0, 200, 1, 2))
    steps = [npy("<f4", (2, 6, 4), step * 2), npy("<f8", (2, 16), geant4 * 2)]
    add("gensteps npy", ["photons", "m.toml", "--gensteps", "g.npy", "-o", "-"], [{"m.toml": BAR, "g.npy": data} for data in steps], ["g.npy"], npy_mutant)
    photon = struct.pack("<16f", 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 420, 0, 0, 0, 0)
    add("photons npy", ["photons", "m.toml", "--photons", "g.npy", "-o", "-"], [{"m.toml": BAR, "g.npy": npy("<f4", (3, 4, 4), photon * 3)}], ["g.npy"], npy_mutant)
    add("spectrum csv", ["photons", "m.toml", "--at", "0,0,0", "--spectrum", "s.csv", "-n", "5", "-o", "-"],
        [{"m.toml": BAR, "s.csv": b"wavelength_nm,value\n400,0.1\n420,1\n450,0.2\n"}, {"m.toml": BAR, "s.csv": b"400 0.1\n420 1\n450 0.2\n"}], ["s.csv"])
    surface = '<opticalsurface name="S" model="dichroic" finish="polished" type="dielectric_dichroic" value="0"/>'
    add("dichroic", ["photons", "m.gdml", "--at", "0,0,-50", "--towards", "0,0,1", "--wavelength", "420", "-n", "5", "--dichroic", "d.dat"],
        [{"m.gdml": slab(surface), "d.dat": b"4 3 2\n300 500 700\n0 90\n10 20 30\n40 50 60\n"}], ["d.dat"])
    surface = '<opticalsurface name="S" model="LUT" finish="polishedtyvekair" type="dielectric_LUT" value="0"/>'
    add("lut", ["photons", "m.gdml", "--at", "0,0,-50", "--towards", "0,0,1", "--wavelength", "420", "-n", "5", "--surface-tables", "."],
        [{"m.gdml": slab(surface), "PolishedTyvek.dat": b"0.5 0.4\n" * 75_758}], ["PolishedTyvek.dat"], binary_mutant)
    for ending, mutant in (("csv", text_mutant), ("npy", npy_mutant)):
        files = parts(program, ["trace", "m.toml", "--rays", "r.csv"], ["0:7", "7:20"], ending, {"m.toml": BALL, "r.csv": table.encode()})
        add(f"merge {ending}", ["merge", f"p0.{ending}", f"p1.{ending}", "-o", f"all.{ending}"], [files], [f"p0.{ending}"], mutant)
        add(f"merge {ending} description", ["merge", f"p0.{ending}", f"p1.{ending}", "-o", f"all.{ending}"], [files],
            [name for name in files if name.endswith(".json")])
        torch = ["--at", "0,0,0", "--wavelength", "420"]
        hits = parts(program, ["photons", "m.toml", *torch, "-n", "50"], ["0:20", "20:50"], ending, {"m.toml": BAR})
        add(f"compare {ending}", ["photons", "compare", "--hits", f"p0.{ending}", f"p1.{ending}"], [hits], [name for name in hits if "part" not in name], mutant)
        add(f"missing {ending}", ["merge", "--missing", "50", f"p0.{ending}", f"p1.{ending}"], [hits], list(hits))
    files = parts(program, ["check", "m.toml"], ["0:1", "1:2"], "txt", {"m.toml": PARTS})
    add("merge checks", ["merge", "p0.txt", "p1.txt", "-o", "all.txt"], [files], list(files))
    add("searches", ["check", "m.toml", "--searches", "p0.txt"], [{"m.toml": PARTS, **files}], ["p0.txt", "p0.txt.part.json"])
    files = parts(program, ["volume", "m.toml", "--total", "600"], ["0:100", "100:300"], "txt", {"m.toml": PARTS})
    add("merge volumes", ["merge", "p0.txt", "p1.txt", "-o", "all.txt"], [files], list(files))
    return all


def limited():
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS))


def normalised(line, folder):
    line = re.sub(r"`[^`]*`|\"[^\"]*\"|'[^']*'", "`_`", line.replace(folder, ""))
    return re.sub(r"[-+]?\d[\d.,eE+x-]*", "0", line)[:160]


def fault(code, out, err, targets):
    """The fault that the end of a run shows, or None."""
    text = err.decode("utf-8", "replace")
    if "panicked" in text:
        place = re.search(r"panicked at (\S+)", text)
        return f"panic at {place[1] if place else '?'}"
    if code < 0 or code > 100:
        return f"ended by {code}"
    if code and not text.strip():
        return "failure without a message"
    if code and not any(name in text for name in targets) and not any(os.path.splitext(name)[0] in text for name in targets):
        return "failure that does not name the file: " + normalised(text.strip().splitlines()[0], "")
    if code == 0 and re.search(rb"\bNaN\b|\bnan\b", out):
        return "NaN in the answer"
    return None


def run(program, reader, number, seed, keep, found, messages):
    rng = random.Random(f"{seed} {reader.name} {number}")
    files = dict(rng.choice(reader.seeds))
    target = rng.choice(reader.targets)
    other = rng.choice(reader.seeds)[target]
    mutant = text_mutant if target.endswith(".json") else reader.mutant
    if number:
        files[target] = mutant(files[target], other, rng)
    with tempfile.TemporaryDirectory(dir=keep) as folder:
        for name, content in files.items():
            with open(os.path.join(folder, name), "wb") as out:
                out.write(content)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        try:
            done = subprocess.run([program, *reader.arguments], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, preexec_fn=limited, timeout=120)
            code, out, err = done.returncode, done.stdout, done.stderr
        except subprocess.TimeoutExpired:
            code, out, err = -14, b"", b"no end within 120 s"
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        first = next((line for line in err.decode("utf-8", "replace").splitlines() if line.strip()), "")
        key = f"{code} {normalised(first, folder)}"
        messages.setdefault(key, [0, number])[0] += 1
        what = fault(code, out, err, reader.targets) or ("more than 5 CPU seconds" if seconds > 5 else None)
        if number == 0 and code not in (0, 1):
            what = f"the seed fails: {first}"
        if what and what not in found:
            found[what] = number
            place = os.path.join(keep, re.sub(r"\W+", "-", f"{reader.name}-{number}"))
            shutil.copytree(folder, place, dirs_exist_ok=True)
            with open(os.path.join(place, "command.txt"), "w") as out:
                print("rayweave", *reader.arguments, f"\n{what}\n{err.decode('utf-8', 'replace')[:2000]}", file=out)
            print(f"FAULT {reader.name} {number}: {what}: {seconds:.1f} s, {place}", flush=True)
    return seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("words", nargs="*")
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", default=None)
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    keep = os.path.abspath(options.keep) if options.keep else tempfile.mkdtemp(prefix="mutants-")
    os.makedirs(keep, exist_ok=True)
    faults = 0
    for reader in readers(program):
        if options.words and not any(word in reader.name for word in options.words):
            continue
        found, messages, spent, number = {}, {}, 0.0, 0
        while spent < options.seconds:
            spent += run(program, reader, number, options.seed, keep, found, messages)
            number += 1
        faults += len(found)
        read = sum(count for key, (count, _) in messages.items() if key.startswith("0 "))
        print(f"{reader.name}: {number} files, {read} read, {len(messages)} messages, {len(found)} faults", flush=True)
        with open(os.path.join(keep, re.sub(r"\W+", "-", reader.name) + ".messages"), "w") as out:
            for key, (count, number) in sorted(messages.items(), key=lambda item: -item[1][0]):
                print(count, number, key, file=out)
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
