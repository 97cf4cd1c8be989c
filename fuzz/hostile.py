#!/usr/bin/env python3
"""Inputs below 1 MB that cost much more than their size suggests, one set per reader.

`python3 fuzz/hostile.py target/release/rayweave [WORD..]` writes each input into a temporary folder, runs the command on it,
and prints CPU seconds, peak memory, exit code and the first line of the message. It fails if a command takes more than
5 CPU seconds or 1 GB, or ends by a signal. WORDs select inputs by parts of their names. Linux and macOS.
"""

import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib
from base64 import b64encode
from io import BytesIO

SECONDS, MEGABYTES = 5.0, 1000.0

CASES = []


def case(name, arguments, files):
    """A command with the files that it reads; the sizes of all files together stay below 1 MB."""
    CASES.append((name, arguments, files))


def scad(name, text, *options, **files):
    """A dump of OpenSCAD, as solids and as facets."""
    files = {key.replace("__", "."): value for key, value in files.items()}
    case("csg " + name, ["info", "m.csg", *options], {"m.csg": text, **files})
    case("csg facets " + name, ["info", "m.csg", "--facets", *options], {"m.csg": text, **files})


def mesh(name, ending, data):
    case(f"{ending} {name}", ["info", f"m.{ending}"], {f"m.{ending}": data})


def toml(name, text, **files):
    files = {key.replace("__", "."): value for key, value in files.items()}
    case("toml " + name, ["info", "m.toml"], {"m.toml": text, **files})


def repeat(pattern, count):
    return "".join(pattern.replace("%", str(k)) for k in range(count))


def name_of(k):
    """Names that differ in a few letters."""
    return "".join(chr(97 + k // 26**j % 26) for j in range(5)) + "name"


# --- GDML ---

def gdml(define="", materials="", solids="", structure="", entities="", world="w"):
    doctype = f"<!DOCTYPE gdml [{entities}]>" if entities else ""
    return f"""<?xml version="1.0"?>{doctype}
<gdml><define>{define}</define>
<materials><material name="a" Z="1"><D value="1"/><atom value="1"/></material>{materials}</materials>
<solids><box name="b" x="1" y="1" z="1"/><box name="big" x="1000" y="1000" z="1000"/>{solids}</solids>
<structure>{structure}<volume name="w"><materialref ref="a"/><solidref ref="big"/>{PHYSVOL}</volume></structure>
<setup name="s" version="1"><world ref="{world}"/></setup></gdml>"""


PHYSVOL = ""


def gdml_case(name, **parts):
    global PHYSVOL
    PHYSVOL = parts.pop("physvol", "")
    text = gdml(**parts)
    PHYSVOL = ""
    case("gdml " + name, ["info", "m.gdml"], {"m.gdml": text})


def volume(name, solid, inside=""):
    return f'<volume name="{name}"><materialref ref="a"/><solidref ref="{solid}"/>{inside}</volume>'


def physvol(name, at=0):
    return f'<physvol><volumeref ref="{name}"/><position x="{at}" y="0" z="0"/></physvol>'


def gdml_cases():
    gdml_case("entities in entities", entities='<!ENTITY e0 "0123456789">' + "".join(
        f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12)), define='<constant name="c" value="&e11;"/>')
    gdml_case("one entity many times", entities=f'<!ENTITY e "{"1+" * 100_000}1">',
              define="".join(f'<constant name="c{k}" value="&e;"/>' for k in range(20_000)))
    gdml_case("deep elements", define="<loop>" * 100_000)
    gdml_case("deep brackets", define=f'<constant name="c" value="{"(" * 400_000}1{")" * 400_000}"/>')
    gdml_case("deep functions", define=f'<constant name="c" value="{"sin(" * 150_000}1{")" * 150_000}"/>')
    gdml_case("chain of powers", define=f'<constant name="c" value="{"2^" * 400_000}1"/>')
    gdml_case("long sum", define=f'<constant name="c" value="{"1+" * 450_000}1"/>')
    gdml_case("signs", define=f'<constant name="c" value="{"-" * 900_000}1"/>')
    gdml_case("constants of constants", define='<constant name="c0" value="1"/>' + repeat(
        '<constant name="d%" value="c0+c0+c0"/>', 23_000))
    gdml_case("misspelt attributes", solids=repeat('<box name="x%" x="1" y="1" zz="1" lunitt="mm"/>', 15_000))
    gdml_case("misspelt solids", structure="".join(volume(f"v{k}", name_of(k)) for k in range(9_000)),
              solids="".join(f'<box name="{name_of(k + 7)}" x="1" y="1" z="1"/>' for k in range(5_000)))
    gdml_case("misspelt elements", solids="".join(f'<{name_of(k)} name="{k}"/>' for k in range(30_000)))
    gdml_case("misspelt names", define="".join(f'<constant name="{name_of(k)}" value="{name_of(k + 1)}x"/>' for k in range(15_000)))
    gdml_case("long name", define=f'<constant name="c" value="{"n" * 900_000}"/>')
    gdml_case("long attribute", solids=f'<box name="x" {"n" * 900_000}="1"/>')
    gdml_case("many attributes", solids='<box name="x" ' + " ".join(f'a{k}="1"' for k in range(70_000)) + "/>")
    gdml_case("shared solids", solids='<union name="u0"><first ref="b"/><second ref="b"/></union>' + "".join(
        f'<union name="u{k}"><first ref="u{k - 1}"/><second ref="u{k - 1}"/><position x="{k}"/></union>' for k in range(1, 60)),
        structure=volume("v", "u59"), physvol=physvol("v"))
    gdml_case("shared volumes", structure=volume("v0", "b") + "".join(
        volume(f"v{k}", "big", physvol(f"v{k - 1}", k) * 2) for k in range(1, 60)), physvol=physvol("v59"))
    gdml_case("shared volumes, wide", structure=volume("v0", "b") + "".join(
        volume(f"v{k}", "big", physvol(f"v{k - 1}", k) * 100) for k in range(1, 30)), physvol=physvol("v29"))
    gdml_case("long chain of unions", solids='<union name="u0"><first ref="b"/><second ref="b"/></union>' + "".join(
        f'<union name="u{k}"><first ref="u{k - 1}"/><second ref="b"/><position x="{k}"/></union>' for k in range(1, 8_000)),
        structure=volume("v", "u7999"), physvol=physvol("v"))
    gdml_case("chain of differences", solids='<subtraction name="u0"><first ref="b"/><second ref="b"/></subtraction>' + "".join(
        f'<subtraction name="u{k}"><first ref="b"/><second ref="u{k - 1}"/><position x=".{k}"/></subtraction>' for k in range(1, 8_000)),
        structure=volume("v", "u7999"), physvol=physvol("v"))
    gdml_case("loop", define='<variable name="i" value="0"/>',
              structure=volume("v", "b"), physvol='<loop for="i" to="1000000000" step="1">' + physvol("v", "i") + "</loop>")
    gdml_case("loops in loops", define="".join(f'<variable name="i{k}" value="0"/>' for k in range(6)),
              structure=volume("v", "b"), physvol="".join(f'<loop for="i{k}" to="1000" step="1">' for k in range(6))
              + physvol("v", "i0") + "</loop>" * 6)
    gdml_case("loop of steps", define='<variable name="i" value="0"/>' +
              '<loop for="i" to="10000000" step="1"><constant name="c[i]" value="i"/></loop>')
    gdml_case("empty loop", define='<variable name="i" value="0"/>' + '<loop for="i" to="1e15" step="1"></loop>')
    gdml_case("replicas", structure=volume("v", "b") + volume("r", "big", '<replicavol number="2000000000"><volumeref ref="v"/>'
              '<replicate_along_axis><direction x="1"/><width value="0.0001"/><offset value="0"/></replicate_along_axis></replicavol>'),
              physvol=physvol("r"))
    gdml_case("nested replicas", structure=volume("r0", "b") + "".join(volume(f"r{k}", "big",
              f'<replicavol number="500000"><volumeref ref="r{k - 1}"/><replicate_along_axis><direction x="1"/>'
              '<width value="0.0001"/><offset value="0"/></replicate_along_axis></replicavol>') for k in range(1, 30)),
              physvol=physvol("r29"))
    gdml_case("matrix", define='<matrix name="m" coldim="1" values="' + "1 " * 440_000 + '"/>')
    gdml_case("matrix of expressions", define='<matrix name="m" coldim="1" values="' + "1+1+1+1*2 " * 90_000 + '"/>')
    gdml_case("many matrices", define=repeat('<matrix name="m%" coldim="2" values="1 2 3 4 5 6 7 8"/>', 13_000))
    planes = "".join(f'<zplane rmin="0" rmax="{1 + k % 2}" z="{k}"/>' for k in range(20_000))
    gdml_case("polycone", solids=f'<polycone name="p" startphi="0" deltaphi="360" aunit="deg">{planes}</polycone>',
              structure=volume("v", "p"), physvol=physvol("v"))
    gdml_case("polyhedra", solids=f'<polyhedra name="p" startphi="0" deltaphi="360" aunit="deg" numsides="100000">{planes}</polyhedra>',
              structure=volume("v", "p"), physvol=physvol("v"))
    gdml_case("polyhedron of many sides", solids='<polyhedra name="p" startphi="0" deltaphi="360" aunit="deg" numsides="2000000000">'
              '<zplane rmin="0" rmax="1" z="0"/><zplane rmin="0" rmax="1" z="1"/></polyhedra>',
              structure=volume("v", "p"), physvol=physvol("v"))
    corners = "".join(f'<rzpoint r="{1 + (k % 2) * .5}" z="{k}"/>' for k in range(15_000))
    gdml_case("generic polycone", solids='<genericPolycone name="p" startphi="0" deltaphi="360" aunit="deg">' + corners +
              '<rzpoint r="0" z="15000"/><rzpoint r="0" z="-1"/></genericPolycone>', structure=volume("v", "p"), physvol=physvol("v"))
    corners = "".join(f'<twoDimVertex x="{math.cos(k / 1000):.6f}" y="{math.sin(k / 1000):.6f}"/>' for k in range(6_283))
    sections = "".join(f'<section zOrder="{k}" zPosition="{k}" xOffset="{k % 2}" yOffset="0" scalingFactor="1"/>' for k in range(5_000))
    gdml_case("extrusion", solids=f'<xtru name="x">{corners}{sections}</xtru>', structure=volume("v", "x"), physvol=physvol("v"))
    star = "".join(f'<twoDimVertex x="{(1 + k % 2) * math.cos(k / 1500 * math.pi):.6f}" y="{(1 + k % 2) * math.sin(k / 1500 * math.pi):.6f}"/>'
                   for k in range(3_000))
    gdml_case("star", solids=f'<xtru name="x">{star}<section zOrder="0" zPosition="0" xOffset="0" yOffset="0" scalingFactor="1"/>'
              '<section zOrder="1" zPosition="1" xOffset="0" yOffset="0" scalingFactor="1"/></xtru>', structure=volume("v", "x"), physvol=physvol("v"))
    positions = "".join(f'<position name="q{k}" x="{k % 3}" y="{k // 3}" z="{k * k % 7}"/>' for k in range(9))
    facets = '<triangular vertex1="q0" vertex2="q1" vertex3="q3"/>' * 13_000
    gdml_case("coincident facets", define=positions, solids=f'<tessellated name="t">{facets}</tessellated>',
              structure=volume("v", "t"), physvol=physvol("v"))
    gdml_case("many twisted boxes", solids=repeat('<twistedbox name="t%" PhiTwist="1.5" x="1" y="1" z="1"/>', 5_000),
              structure="".join(volume(f"v{k}", f"t{k}") for k in range(3_000)), physvol="".join(physvol(f"v{k}", k) for k in range(3_000)))
    gdml_case("twisted tubes", solids=repeat('<twistedtubs name="t%" twistedangle="3" endinnerrad="1" endouterrad="2" zlen="9" phi="1"/>', 3_000),
              structure="".join(volume(f"v{k}", f"t{k}") for k in range(3_000)), physvol="".join(physvol(f"v{k}", k) for k in range(3_000)))
    gdml_case("many volumes", structure="".join(volume(f"v{k}", "b") for k in range(7_000)),
              physvol="".join(physvol(f"v{k}", k) for k in range(4_000)))
    gdml_case("multiunion", solids='<multiUnion name="m">' + "".join(
        f'<multiUnionNode name="n{k}"><solid ref="b"/><position x="{k % 10}"/></multiUnionNode>' for k in range(10_000)) + "</multiUnion>",
        structure=volume("v", "m"), physvol=physvol("v"))
    gdml_case("deep volumes", structure=volume("v0", "b") + "".join(volume(f"v{k}", "big", physvol(f"v{k - 1}")) for k in range(1, 5_500)),
              physvol=physvol("v5499"))
    gdml_case("isotopes", materials="".join(
        f'<material name="m{k}"><D value="1"/>' + "".join(f'<fraction n=".1" ref="{name_of(j)}"/>' for j in range(10)) + "</material>"
        for k in range(2_000)))
    gdml_case("materials in materials", materials='<material name="m0" Z="1"><D value="1"/><atom value="1"/></material>' + "".join(
        f'<material name="m{k}"><D value="1"/><fraction n=".5" ref="m{k - 1}"/><fraction n=".5" ref="m{k - 1}"/></material>'
        for k in range(1, 6_000)), structure='<volume name="v"><materialref ref="m5999"/><solidref ref="b"/></volume>', physvol=physvol("v"))
    gdml_case("comments", define="<!-- " + "-" * 900_000)
    gdml_case("open tags", define="<a " * 300_000)
    gdml_case("quadratic entities", entities="".join(f'<!ENTITY {name_of(k)} "1">' for k in range(12_000)),
              define="".join(f'<constant name="c{k}" value="&{name_of(k)}x;"/>' for k in range(8_000)))


# --- OpenSCAD ---

def png(width, height, value=0):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = zlib.compress(b"".join(b"\0" + bytes((value * (x + y)) % 251 for x in range(width)) for y in range(min(height, 64)))
                         if height <= 64 else zlib.compressobj().compress(b"") + b"", 9)
    if height > 64:
        pack = zlib.compressobj(9)
        row = b"\0" + bytes((value * x) % 251 for x in range(width))
        rows = b"".join(pack.compress(row) for _ in range(height)) + pack.flush()
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
            + chunk(b"IDAT", rows) + chunk(b"IEND", b""))


def scad_cases():
    scad("deep groups", "group() {" * 60_000 + "cube();" + "}" * 60_000)
    scad("deep unclosed", "difference() {" * 60_000)
    scad("deep lists", "cube(size = " + "[" * 300_000 + "1" + "]" * 300_000 + ");")
    scad("long name", "n" * 900_000 + "();")
    scad("misspelt items", "".join(f"{name_of(k)}(a = 1);" for k in range(50_000)))
    scad("misspelt arguments", "".join(f"cube({name_of(k)} = 1);" for k in range(40_000)))
    scad("long argument", "cube(" + "n" * 900_000 + " = 1);")
    scad("many arguments", "cube(" + ", ".join(f"a{k} = 1" for k in range(80_000)) + ");")
    scad("fine sphere", "sphere(r = 5, $fn = 5000);")
    scad("fine spheres", "sphere(r = 5, $fn = 600);" * 1000)
    scad("sphere of small facets", "sphere(r = 1e6, $fa = 0.01, $fs = 0.01);")
    scad("fine cylinders", "cylinder(r1 = 1, r2 = 2, h = 1, $fn = 100000);" * 2000)
    scad("fine spheres joined", "union() {" + "".join(f"multmatrix([[1,0,0,{k}],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) sphere(r = 5, $fn = 100);"
                                                   for k in range(300)) + "}")
    scad("fine spheres cut", "difference() {" + "".join(f"multmatrix([[1,0,0,{k / 10}],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) sphere(r = 5, $fn = 300);"
                                                     for k in range(50)) + "}")
    scad("spheres", "union() {" + "".join(f"multmatrix([[1,0,0,{k % 97}],[0,1,0,{k % 89}],[0,0,1,{k % 83}],[0,0,0,1]]) sphere(r = 5, $fn = 8);"
                                         for k in range(9_000)) + "}")
    scad("nested offsets", "linear_extrude(height = 1)" + "offset(r = 1, $fn = 100) " * 16 + "square([1, 1]);")
    scad("nested sharp offsets", "linear_extrude(height = 1)" + "offset(delta = -0.001, chamfer = true) " * 2000 + "circle(r = 100, $fn = 200);")
    scad("alternating offsets", "linear_extrude(height = 1)" + "offset(r = 1, $fn = 100) offset(r = -1, $fn = 100) " * 500 + "square([10, 10]);")
    star = "[" + ",".join(f"[{(1 + k % 2) * math.cos(k / 4000 * math.pi):.6f},{(1 + k % 2) * math.sin(k / 4000 * math.pi):.6f}]" for k in range(8_000)) + "]"
    scad("offset of a star", f"linear_extrude(height = 1) offset(r = 0.5, $fn = 100) polygon(points = {star}, paths = undef);")
    scad("hull of fine spheres", "hull() { sphere(r = 5, $fn = 1000); multmatrix([[1,0,0,9],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) sphere(r = 4, $fn = 1000); }")
    scad("hull of spheres", "hull() {" + "".join(f"multmatrix([[1,0,0,{k * k % 97}],[0,1,0,{k % 89}],[0,0,1,{k % 83}],[0,0,0,1]]) sphere(r = {1 + k % 5});"
                                                for k in range(5_000)) + "}")
    scad("hulls in hulls", "hull() { cube(); " * 5_000 + "sphere(r = 2, $fn = 30);" + "}" * 5_000)
    scad("hull of many hulls", ("hull() { sphere(r = 5, $fn = 60); cube(); }") * 15_000)
    scad("hull of circles", "linear_extrude(height = 1) hull() {" + "".join(
        f"multmatrix([[1,0,0,{k * k % 997}],[0,1,0,{k * 7 % 991}],[0,0,1,0],[0,0,0,1]]) circle(r = {1 + k % 50});" for k in range(8_000)) + "}")
    scad("hull of a curve", "hull() { polyhedron(points = [" + ",".join(f"[{k},{k * k},{k ** 3}]" for k in range(15_000)) + "], faces = [[0,1,2]], convexity = 1); }")
    scad("minkowski of spheres", "minkowski() { sphere(r = 5, $fn = 200); sphere(r = 1, $fn = 200); }")
    scad("minkowski of parts", "minkowski() { union() {" + "".join(
        f"multmatrix([[1,0,0,{3 * k}],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) cube();" for k in range(2_000)) + "} sphere(r = 1, $fn = 20); }")
    scad("nested minkowski", "minkowski() { cube(); " * 200 + "sphere(r = 1, $fn = 30);" + "}" * 200)
    scad("minkowski of stars", f"linear_extrude(height = 1) minkowski() {{ polygon(points = {star}, paths = undef); polygon(points = {star}, paths = undef); }}")
    scad("minkowski of balls and parts", "minkowski() { difference() { cube(size = [9, 9, 9]); " + "".join(
        f"multmatrix([[1,0,0,{k % 9}],[0,1,0,{k % 7}],[0,0,1,{k % 5}],[0,0,0,1]]) sphere(r = .1, $fn = 12);" for k in range(300)) + "} sphere(r = 1, $fn = 12); }")
    scad("projection of fine spheres", "linear_extrude(height = 1) projection(cut = true, convexity = 0) union() {" + "".join(
        f"multmatrix([[1,0,0,{k}],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) sphere(r = 5, $fn = 300);" for k in range(300)) + "}")
    scad("shadow of fine spheres", "linear_extrude(height = 1) projection(cut = false, convexity = 0) union() {" + "".join(
        f"multmatrix([[1,0,0,{k}],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) sphere(r = 5, $fn = 200);" for k in range(30)) + "}")
    scad("many projections", "linear_extrude(height = 1) projection(cut = true, convexity = 0) sphere(r = 5, $fn = 100);" * 8_000)
    scad("twisted extrusion", "linear_extrude(height = 9, twist = 36000, slices = 20000, $fn = 1000) circle(r = 1, $fn = 1000);")
    scad("twisted extrusions", "linear_extrude(height = 9, twist = 360, slices = 100, $fn = 100) circle(r = 1, $fn = 100);" * 3_000)
    scad("rotated extrusion", "rotate_extrude(angle = 360, $fn = 10000) multmatrix([[1,0,0,5],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) circle(r = 1, $fn = 10000);")
    scad("rotated star", "rotate_extrude(angle = 360, $fn = 100) multmatrix([[1,0,0,5],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) " + f"polygon(points = {star}, paths = undef);")
    scad("rotated extrusions", "rotate_extrude(angle = 270, $fn = 60) multmatrix([[1,0,0,5],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) circle(r = 1, $fn = 60);" * 4_000)
    scad("polygon that crosses itself", "linear_extrude(height = 1) polygon(points = [" + ",".join(
        f"[{k * 7919 % 10007},{k * 104729 % 10009}]" for k in range(9_000)) + "], paths = undef);")
    scad("spiral", "linear_extrude(height = 1) polygon(points = [" + ",".join(
        f"[{(1 + k) * math.cos(k / 10):.4f},{(1 + k) * math.sin(k / 10):.4f}]" for k in range(20_000)) + "," + ",".join(
        f"[{(.7 + k) * math.cos(k / 10):.4f},{(.7 + k) * math.sin(k / 10):.4f}]" for k in reversed(range(20_000))) + "], paths = undef);")
    scad("nested squares", "linear_extrude(height = 1) polygon(points = [" + ",".join(
        f"[{-k},{-k}],[{k},{-k}],[{k},{k}],[{-k},{k}]" for k in range(1, 8_000)) + "], paths = [" + ",".join(
        f"[{4 * k},{4 * k + 1},{4 * k + 2},{4 * k + 3}]" for k in range(7_999)) + "]);")
    scad("one path many times", "linear_extrude(height = 1) polygon(points = [[0,0],[1,0],[0,1]], paths = [" + ",".join(["[0,1,2]"] * 100_000) + "]);")
    scad("crossing squares", "linear_extrude(height = 1) {" + "".join(
        f"multmatrix([[1,0,0,{k % 97}],[0,1,0,{k % 89}],[0,0,1,0],[0,0,0,1]]) square(size = [50, 50]);" for k in range(9_000)) + "}")
    scad("cut squares", "linear_extrude(height = 1) difference() { square(size = [1000, 1000]);" + "".join(
        f"multmatrix([[1,0,0,{k % 97 * 10}],[0,1,0,{k % 89 * 10}],[0,0,1,0],[0,0,0,1]]) circle(r = 8, $fn = 100);" for k in range(9_000)) + "}")
    scad("coincident faces", "polyhedron(points = [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], faces = [" + ",".join(["[0,1,2],[0,2,1]"] * 50_000) + "], convexity = 1);")
    scad("huge face", "polyhedron(points = [" + ",".join(f"[{k * 7919 % 10007},{k * 104729 % 10009},0]" for k in range(30_000)) +
         "], faces = [[" + ",".join(str(k) for k in range(30_000)) + "]], convexity = 1);")
    scad("one face of one point", "polyhedron(points = [[0,0,0],[1,0,0],[0,1,0]], faces = [[" + ",".join(["0,1,2"] * 150_000) + "]], convexity = 1);")
    scad("resizes", "resize(newsize = [1,2,3], auto = [0,0,0]) " * 15_000 + "sphere(r = 1, $fn = 50);")
    scad("resized parts", "resize(newsize = [1,2,3], auto = [0,0,0]) { cube(); " * 10_000 + "}" * 10_000)
    scad("matrices", "multmatrix([[1,0,0,1],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) " * 15_000 + "sphere(r = 1, $fn = 50);")
    scad("colours", "color([1, 0, 0, 1]) { cube(); " * 20_000 + "}" * 20_000)
    scad("many colours", "".join(f"color([{k % 1000 / 1000},{k % 997 / 997},{k % 991 / 991},1]) cube();" for k in range(12_000)))
    scad("glyphs", 'linear_extrude(height = 1) text(text = "' + "%&@" * 3_300 + '", size = 10, font = "", $fn = 1000);')
    scad("many texts", 'linear_extrude(height = 1) text(text = "%&@8", size = 10, font = "", $fn = 100);' * 8_000)
    scad("texts with fonts", "".join(f'linear_extrude(height = 1) text(text = "8", size = 10, font = "{name_of(k)}");' for k in range(9_000)))
    scad("huge image", 'surface(file = "m.png", center = false, invert = false);', m__png=png(2000, 2000))
    scad("images", 'surface(file = "m.png", center = false, invert = false);' * 10_000, m__png=png(300, 300, 3))
    scad("bomb of an image", 'surface(file = "m.png", center = false, invert = false);', m__png=png(20_000, 20_000))
    scad("heights", 'surface(file = "m.dat", center = false, invert = false);', m__dat="1 2 3 4 5 6 7 8\n" * 50_000)
    scad("ragged heights", 'surface(file = "m.dat", center = false, invert = false);', m__dat="1 " * 100_000 + "\n" + "1\n" * 300_000)
    scad("imports", 'import(file = "m.stl");' * 30_000, m__stl="solid a\n" + cube_facets() + "endsolid")
    scad("unknown fields", "".join(f"sphere(r = 1, $fn = {k % 500 + 3});" for k in range(25_000)))
    scad("intersections", "intersection() { cube(); " * 30_000 + "}" * 30_000)
    scad("alternating operators", "difference() { sphere(r = 2); union() { cube(); " * 10_000 + "}}" * 10_000)
    scad("empty items", "group();" * 110_000)
    scad("disabled items", "*" * 900_000 + "cube();")
    scad("long string", 'text(text = "' + "a" * 900_000 + '");')
    scad("comments", "/*" * 450_000)


def cube_facets():
    """The twelve triangles of a cube, as ASCII STL."""
    points = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    text = ""
    for a, b, c, d in faces:
        for triangle in ((a, b, c), (a, c, d)):
            text += "facet normal 0 0 0\nouter loop\n" + "".join("vertex %d %d %d\n" % points[k] for k in triangle) + "endloop\nendfacet\n"
    return text


# --- drawings ---

def drawing(name, ending, text, options=""):
    file = f"m.{ending}"
    case(f"{ending} {name}", ["info", "m.csg"], {
        "m.csg": f'linear_extrude(height = 1) import(file = "{file}", layer = "", origin = [0, 0], scale = 1, $fn = 100{options});', file: text})


def svg(inside, attributes=""):
    return f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="100mm" height="100mm" viewBox="0 0 100 100"{attributes}>{inside}</svg>'


def drawing_cases():
    drawing("strokes", "svg", svg('<path fill="none" stroke="black" stroke-width="5" d="M0 0' + "".join(
        f" L{k * 37 % 101} {k * 53 % 103}" for k in range(9_000)) + '"/>'))
    drawing("round strokes", "svg", svg('<path fill="none" stroke="black" stroke-width="50" stroke-linejoin="round" stroke-linecap="round" d="' + "".join(
        f"M{k * 37 % 101} {k * 53 % 103}h1" for k in range(20_000)) + '"/>'))
    drawing("crossing path", "svg", svg('<path d="M0 0' + "".join(f" L{k * 37 % 1009 / 10} {k * 53 % 1013 / 10}" for k in range(30_000)) + 'z"/>'))
    drawing("curves", "svg", svg('<path d="M0 0' + "".join(f" C{k % 100} 1e6 -1e6 {k % 99} {k % 98} 3" for k in range(20_000)) + 'z"/>'))
    drawing("far arc", "svg", svg('<path d="M0 0 h20 v20 a5 5 0 0 1 1e60 5 Z"/>'))
    drawing("arc of a huge radius", "svg", svg('<path d="M0 0 h20 v20 a1e60 1e59 0 0 1 5 5 Z"/>'))
    drawing("far arcs", "svg", svg("".join(f'<path d="M{k} 0 h1e15 A5 5 0 0 1 {k} 1 Z"/>' for k in range(12_000))))
    drawing("huge curve", "svg", svg('<path d="M0 0 C 1e12 1e12 -1e12 1e12 1 1z"/>' * 2000))
    drawing("arcs", "svg", svg('<path d="M0 0' + "".join(f" A1e5 1e5 0 1 1 {k % 100} {k % 97}" for k in range(20_000)) + 'z"/>'))
    drawing("circles", "svg", svg("".join(f'<circle cx="{k % 97}" cy="{k % 89}" r="30"/>' for k in range(20_000))))
    drawing("huge circles", "svg", svg('<circle cx="0" cy="0" r="1e9"/>' * 20_000))
    drawing("uses of uses", "svg", svg('<defs><rect id="u0" width="1" height="1"/>' + "".join(
        f'<g id="u{k}"><use xlink:href="#u{k - 1}"/><use xlink:href="#u{k - 1}" x="1"/></g>' for k in range(1, 60)) + '</defs><use xlink:href="#u59"/>'))
    drawing("one use many times", "svg", svg('<defs><path id="p" d="M0 0' + " l1 1 1 -1" * 20_000 + 'z"/></defs>' + '<use xlink:href="#p"/>' * 20_000))
    drawing("use of itself", "svg", svg('<g id="a"><use xlink:href="#a"/><use xlink:href="#a"/></g>' * 5_000))
    drawing("deep groups", "svg", svg("<g>" * 100_000 + "</g>" * 100_000))
    drawing("transforms", "svg", svg('<rect width="1" height="1" transform="' + "rotate(1) " * 80_000 + '"/>'))
    drawing("styles", "svg", svg('<rect width="1" height="1" style="' + "fill:red;" * 90_000 + '"/>'))
    drawing("style sheet", "svg", svg("<style>" + "".join(f".{name_of(k)}{{fill:red}}" for k in range(25_000)) + "</style>" +
                                      "".join(f'<rect class="{name_of(k)}" width="1" height="1"/>' for k in range(5_000))))
    drawing("entities", "svg", '<!DOCTYPE svg [<!ENTITY a "' + "M0 0 " * 50_000 + '">]>' + svg('<path d="&a;"/>' * 20_000))
    drawing("numbers", "svg", svg('<path d="M' + "0" * 900_000 + '"/>'))
    drawing("dashes", "svg", svg('<path fill="none" stroke="black" stroke-dasharray="0.00001" d="M0 0L1e9 1e9"/>'))
    pairs = lambda *all: "".join(f"{code}\n{value}\n" for code, value in all)
    entities = lambda inside: pairs((0, "SECTION"), (2, "ENTITIES")) + inside + pairs((0, "ENDSEC"), (0, "EOF"))
    line = lambda a, b, c, d: pairs((0, "LINE"), (8, 0), (10, a), (20, b), (11, c), (21, d))
    drawing("lines", "dxf", entities("".join(line(k * 37 % 1009, k * 53 % 1013, (k + 1) * 37 % 1009, (k + 1) * 53 % 1013) for k in range(18_000))))
    drawing("coincident lines", "dxf", entities(line(0, 0, 1, 0) * 20_000))
    drawing("open lines", "dxf", entities("".join(line(k, 0, k + .5, 1) for k in range(17_000))))
    drawing("star of lines", "dxf", entities("".join(line(0, 0, math.cos(k), math.sin(k)) for k in range(13_000))))
    block = lambda name, inside: pairs((0, "BLOCK"), (2, name)) + inside + pairs((0, "ENDBLK"))
    insert = lambda name: pairs((0, "INSERT"), (2, name), (10, 1), (20, 1))
    drawing("blocks of blocks", "dxf", pairs((0, "SECTION"), (2, "BLOCKS")) + block("b0", pairs((0, "CIRCLE"), (40, 1))) + "".join(
        block(f"b{k}", insert(f"b{k - 1}") * 10) for k in range(1, 19)) + pairs((0, "ENDSEC")) + entities(insert("b18")))
    drawing("inserts", "dxf", pairs((0, "SECTION"), (2, "BLOCKS")) + block("b0", pairs((0, "CIRCLE"), (10, 0), (20, 0), (40, 1)) * 5_000) +
            pairs((0, "ENDSEC")) + entities(insert("b0") * 15_000))
    drawing("array of inserts", "dxf", pairs((0, "SECTION"), (2, "BLOCKS")) + block("b0", line(0, 0, 1, 1)) + pairs((0, "ENDSEC")) +
            entities(pairs((0, "INSERT"), (2, "b0"), (70, 30000), (71, 30000), (44, 1), (45, 1))))
    drawing("circles", "dxf", entities("".join(pairs((0, "CIRCLE"), (10, k % 97), (20, k % 89), (40, 30)) for k in range(20_000))))
    drawing("spline", "dxf", entities(pairs((0, "SPLINE"), (71, 1000)) + "".join(pairs((40, k)) for k in range(20_000)) + "".join(
        pairs((10, k % 7), (20, k % 11)) for k in range(18_000))))
    drawing("polylines", "dxf", entities((pairs((0, "LWPOLYLINE"), (90, 3), (70, 1)) + "".join(
        pairs((10, k % 7), (20, k % 11), (42, 1)) for k in range(3))) * 7_000))
    drawing("ellipses", "dxf", entities(pairs((0, "ELLIPSE"), (10, 0), (20, 0), (11, 1e6), (21, 0), (40, 1e-6), (41, 0), (42, 6.283)) * 10_000))


# --- meshes ---

def stl(triangles):
    data = bytearray(80) + struct.pack("<I", len(triangles))
    for triangle in triangles:
        data += struct.pack("<12fH", 0, 0, 0, *(x for point in triangle for x in point), 0)
    return bytes(data)


def zipped(files, level=9):
    buffer = BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=level) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return buffer.getvalue()


RELS = ('<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
        '<Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
TYPES = ('<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
         '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
         '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>')


def threemf(model):
    return zipped({"[Content_Types].xml": TYPES, "_rels/.rels": RELS, "3D/3dmodel.model": model})


def model3(objects, items):
    return (f'<?xml version="1.0"?><model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
            f"<resources>{objects}</resources><build>{items}</build></model>")


TETRAHEDRON = ('<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices>'
               '<triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles></mesh>')


def overlapping(count, data):
    """A zip archive whose entries all refer to the same compressed bytes."""
    pack = zlib.compressobj(9, zlib.DEFLATED, -15)
    packed = pack.compress(data) + pack.flush()
    local = struct.pack("<IHHHHHIIIHH", 0x04034B50, 20, 0, 8, 0, 0, zlib.crc32(data), len(packed), len(data), 16, 0)
    body = local + b"3D/3dmodel.model" + packed
    central = b""
    for k in range(count):
        name = (b"3D/3dmodel.model" if k == 0 else b"3D/%06d.model0" % k)[:16].ljust(16, b"0")
        central += struct.pack("<IHHHHHHIIIHHHHHII", 0x02014B50, 20, 20, 0, 8, 0, 0, zlib.crc32(data), len(packed), len(data), len(name),
                               0, 0, 0, 0, 0, 0) + name
    count = min(count, 65_535)
    return body + central + struct.pack("<IHHHHIIH", 0x06054B50, 0, 0, count, count, len(central), len(body), 0)


def mesh_cases():
    one = [((0, 0, 0), (1, 0, 0), (0, 1, 0))]
    mesh("coincident triangles", "stl", stl(one * 19_000))
    mesh("both orientations", "stl", stl((one + [((0, 0, 0), (0, 1, 0), (1, 0, 0))]) * 9_500))
    soup = [tuple((k * a % 1009, k * b % 1013, k * c % 1019) for a, b, c in ((37, 53, 71), (89, 97, 101), (103, 107, 109))) for k in range(19_000)]
    mesh("crossing triangles", "stl", stl(soup))
    mesh("fan", "stl", stl([((0, 0, 0), (math.cos(k), math.sin(k), k % 7), (math.cos(k + 1), math.sin(k + 1), k % 5)) for k in range(19_000)]))
    mesh("edge of many triangles", "stl", stl([((0, 0, 0), (0, 0, 1), (math.cos(k), math.sin(k), 0)) for k in range(19_000)]))
    mesh("coplanar triangles", "stl", stl([((k % 7, k % 5, 0), (k % 3 + 10, k % 11, 0), (k % 13, k % 17 + 5, 0)) for k in range(19_000)]))
    shells = []
    tetra = [((0, 0, 0), (0, 1, 0), (1, 0, 0)), ((0, 0, 0), (1, 0, 0), (0, 0, 1)), ((1, 0, 0), (0, 1, 0), (0, 0, 1)), ((0, 0, 0), (0, 0, 1), (0, 1, 0))]
    for k in range(4_700):
        shells += [tuple(tuple((1 + k) * x - (1 + k) * .2 for x in point) for point in triangle) for triangle in tetra]
    mesh("nested shells", "stl", stl(shells))
    row = []
    for k in range(4_700):
        row += [tuple((point[0] + 2 * k, point[1], point[2]) for point in triangle) for triangle in tetra]
    mesh("shells in a row", "stl", stl(row))
    mesh("ASCII", "stl", "solid a\n" + "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n" * 10_000 + "endsolid")
    mesh("long name", "stl", "solid " + "a" * 900_000 + "\nfacet normal 0 0 1\n")
    mesh("stated count", "stl", bytes(80) + struct.pack("<I", 0xFFFFFFFF) + bytes(50))
    circle = lambda n: "".join(f"v {math.cos(2 * math.pi * k / n):.6f} {math.sin(2 * math.pi * k / n):.6f} 0\n" for k in range(n))
    face = lambda n: "f " + " ".join(str(k + 1) for k in range(n)) + "\n"
    mesh("polygon", "obj", circle(25_000) + face(25_000))
    star = "".join(f"v {(1 + k % 2) * math.cos(2 * math.pi * k / 20_000):.6f} {(1 + k % 2) * math.sin(2 * math.pi * k / 20_000):.6f} 0\n" for k in range(20_000))
    mesh("star", "obj", star + face(20_000))
    comb = "".join(f"v {k} {k % 2 * 1000} 0\nv {k}.5 {(k + 1) % 2} 0\n" for k in range(10_000))
    mesh("comb", "obj", comb + face(20_000))
    mesh("polygon that crosses itself", "obj", "".join(f"v {k * 7919 % 10007} {k * 104729 % 10009} 0\n" for k in range(20_000)) + face(20_000))
    mesh("polygons of one corner", "obj", circle(4) + ("f " + "1 2 3 4 " * 40 + "\n") * 2_500)
    mesh("polygons", "obj", circle(400) + face(400) * 500)
    mesh("polygons twice bent", "obj", "".join(f"v {k} {k * k % 17} {k * k % 13}\n" for k in range(300)) + face(300) * 700)
    mesh("coincident triangles", "obj", circle(3) + "f 1 2 3\n" * 100_000)
    mesh("long line", "obj", "v " + "1" * 900_000 + "\n")
    mesh("negative indices", "obj", circle(4) + "f -1 -2 -3\n" * 80_000)
    mesh("groups", "obj", circle(3) + repeat("g g%\n", 80_000))
    mesh("polygon", "off", "OFF\n20000 1 0\n" + star.replace("v ", "") + "20000 " + " ".join(str(k) for k in range(20_000)) + "\n")
    mesh("stated counts", "off", "OFF\n4000000000 4000000000 0\n")
    mesh("polygon", "ply", "ply\nformat ascii 1.0\nelement vertex 20000\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
         "property list int int vertex_indices\nend_header\n" + star.replace("v ", "") + "20000 " + " ".join(str(k) for k in range(20_000)) + "\n")
    mesh("stated counts", "ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 4000000000\nproperty list int int vertex_indices\nend_header\n")
    mesh("properties", "ply", "ply\nformat ascii 1.0\nelement vertex 1000\n" + repeat("property float p%\n", 40_000) + "end_header\n" + "1 " * 50_000)
    mesh("empty elements", "ply", "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         + repeat("element e% 4000000000\n", 20_000) + "end_header\n")
    mesh("elements of no property", "ply", "ply\nformat ascii 1.0\nelement a 100000000000\nend_header\n")
    mesh("long lists", "ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
         b"element face 100000\nproperty list uint int vertex_indices\nend_header\n" + bytes(12) + b"\xff\xff\xff\xff" * 1000)
    zeros = '<vertex x="0" y="0" z="0"/>' * 3_000_000
    mesh("bomb of vertices", "3mf", threemf(model3(f'<object id="1" type="model"><mesh><vertices>{zeros}</vertices><triangles/></mesh></object>', '<item objectid="1"/>')))
    mesh("bomb of triangles", "3mf", threemf(model3('<object id="1" type="model"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>'
         "</vertices><triangles>" + '<triangle v1="0" v2="1" v3="2"/>' * 2_000_000 + "</triangles></mesh></object>", '<item objectid="1"/>')))
    mesh("small bomb of triangles", "3mf", threemf(model3('<object id="1" type="model"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>'
         "</vertices><triangles>" + '<triangle v1="0" v2="1" v3="2"/>' * 440_000 + "</triangles></mesh></object>", '<item objectid="1"/>')))
    mesh("bomb of an attribute", "3mf", threemf(model3(f'<object id="1" name="{"a" * 900_000_000}"/>', "")))
    mesh("deep elements", "3mf", threemf("<a>" * 10_000_000))
    mesh("components of components", "3mf", threemf(model3(f'<object id="1" type="model">{TETRAHEDRON}</object>' + "".join(
        f'<object id="{k}" type="model"><components><component objectid="{k - 1}"/><component objectid="{k - 1}"/></components></object>' for k in range(2, 60)),
        '<item objectid="59"/>')))
    mesh("wide components", "3mf", threemf(model3(f'<object id="1" type="model">{TETRAHEDRON}</object><object id="2" type="model"><components>' +
         '<component objectid="1"/>' * 400_000 + "</components></object>", '<item objectid="2"/>' * 200_000)))
    mesh("items", "3mf", threemf(model3(f'<object id="1" type="model">{TETRAHEDRON}</object>', '<item objectid="1"/>' * 240_000)))
    mesh("moved items", "3mf", threemf(model3(f'<object id="1" type="model">{TETRAHEDRON}</object>', "".join(
        f'<item objectid="1" transform="1 0 0 0 1 0 0 0 1 {k % 100}.5 {k // 100 % 100}.5 {k // 10000}.5"/>' for k in range(100_000)))))
    mesh("coincident moved items", "3mf", threemf(model3(f'<object id="1" type="model">{TETRAHEDRON}</object>', "".join(
        f'<item objectid="1" transform="1 0 0 0 1 0 0 0 1 {k % 30 / 100} {k // 100 % 30 / 100} 0"/>' for k in range(100_000)))))
    mesh("unknown references", "3mf", threemf(model3("", "".join(f'<item objectid="{k}"/>' for k in range(350_000)))))
    mesh("empty objects", "3mf", threemf(model3("".join(f'<object id="{k}"/>' for k in range(1, 350_000)), '<item objectid="1"/>')))
    mesh("parts", "3mf", zipped({"[Content_Types].xml": TYPES, "_rels/.rels": RELS, "3D/3dmodel.model": model3("", ""),
                                 **{f"3D/p{k}.model": model3(f'<object id="1" type="model">{TETRAHEDRON}</object>', "") for k in range(1_800)}}))
    mesh("overlapping entries", "3mf", overlapping(12_000, model3(f'<object id="1" type="model">{TETRAHEDRON * 1000}</object>', '<item objectid="1"/>').encode()))
    mesh("relationships", "3mf", zipped({"[Content_Types].xml": TYPES, "_rels/.rels": RELS.replace("</Relationships>", "") +
         '<Relationship Target="/3D/3dmodel.model" Id="r" Type="x"/>' * 3_000_000 + "</Relationships>", "3D/3dmodel.model": model3("", "")}))

    def gltf(meshes, nodes, accessors, views, buffers, scene_nodes, **more):
        return json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": scene_nodes}], "nodes": nodes, "meshes": meshes,
                           "accessors": accessors, "bufferViews": views, "buffers": buffers, **more})

    points = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
    faces = struct.pack("<12H", 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2)
    data = b64encode(points + faces).decode()
    buffers = [{"byteLength": 72, "uri": "data:application/octet-stream;base64," + data}]
    views = [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}]
    accessors = [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}, {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]
    tetra_mesh = {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}
    mesh("primitives", "gltf", gltf([{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}] * 15_000}], [{"mesh": 0}], accessors, views, buffers, [0]))
    mesh("nodes", "gltf", gltf([tetra_mesh], [{"mesh": 0}] * 48_000, accessors, views, buffers, list(range(48_000))))
    mesh("one node many times", "gltf", gltf([tetra_mesh], [{"mesh": 0}], accessors, views, buffers, [0] * 250_000))
    mesh("nodes of nodes", "gltf", gltf([tetra_mesh], [{"mesh": 0}] + [{"children": [k, k]} for k in range(59)], accessors, views, buffers, [59]))
    mesh("deep nodes", "gltf", gltf([tetra_mesh], [{"mesh": 0}] + [{"children": [k]} for k in range(40_000)], accessors, views, buffers, [40_000]))
    sparse = {"componentType": 5126, "count": 40_000_000, "type": "VEC3", "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}}
    mesh("sparse accessor", "gltf", gltf([{"primitives": [{"attributes": {"POSITION": 0}}] * 6}], [{"mesh": 0}], [sparse], views, buffers, [0]))
    sparse = {**sparse, "count": 300_000}
    mesh("sparse accessors", "gltf", gltf([{"primitives": [{"attributes": {"POSITION": 0}}] * 6_000}], [{"mesh": 0}], [sparse], views, buffers, [0]))
    mesh("sparse indices", "gltf", gltf([{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}] * 3_000}], [{"mesh": 0}],
         [accessors[0], {"componentType": 5123, "count": 3_000_000, "type": "SCALAR", "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 1}}}],
         views, buffers, [0]))
    mesh("overlapping views", "gltf", gltf([{"primitives": [{"attributes": {"POSITION": 0}}] * 9_000}], [{"mesh": 0}],
         [{"bufferView": 0, "componentType": 5126, "count": 20_000, "type": "VEC3"}], [{"buffer": 0, "byteLength": 240_000}],
         [{"byteLength": 240_000, "uri": "data:application/octet-stream;base64," + b64encode(bytes(240_000)).decode()}], [0]))
    mesh("many buffers", "gltf", gltf([tetra_mesh], [{"mesh": 0}], accessors, views, buffers * 6_000, [0]))
    mesh("large buffers", "gltf", gltf([tetra_mesh], [{"mesh": 0}], accessors, views, buffers + [{"byteLength": 500_000_000}] * 6_000, [0]))
    mesh("deep brackets", "gltf", "[" * 900_000)
    mesh("deep objects", "gltf", '{"a":' * 180_000)
    mesh("matrices", "gltf", gltf([tetra_mesh], [{"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, k, 0, 0, 1]} for k in range(12_000)], accessors, views, buffers, list(range(12_000))))


# --- native models ---

def toml_cases():
    balls = "rayweave = 1\n[solid.s]\nsphere = { radius = 1 }\n"
    toml("shared solids", balls + "".join(
        f'[solid.u{k}]\nexpr = "{"s" if k == 0 else f"u{k - 1}"} | {"s" if k == 0 else f"u{k - 1}"}"\ntransform = [{{ translate = [{k}, 0, 0] }}]\n' for k in range(60)) +
        '[[region]]\nsolid = "u59"\n')
    toml("moved solids", balls + "[solid.u0]\nexpr = 's'\n" + "".join(
        f"[solid.m{k}]\nexpr = 'u{k - 1}'\ntransform = [{{ translate = [{k}, 0, 0] }}]\n[solid.u{k}]\nexpr = 'u{k - 1} | m{k}'\n" for k in range(1, 60)) + "[[region]]\nsolid = 'u59'\n")
    toml("places of places", balls + "".join(
        f'[solid.p{k}]\nplace = {{ solid = "{"s" if k == 0 else f"p{k - 1}"}", grid = [1000, 1000, 1], step = [1, 1, 1] }}\n' for k in range(30)) + '[[region]]\nsolid = "p29"\n')
    toml("many places", balls + "".join(f'[solid.p{k}]\nplace = {{ solid = "s", grid = [2000, 2000, 1], step = [1, 1, 1] }}\n' for k in range(5_000)) + '[[region]]\nsolid = "p1"\n')
    toml("rings", balls + "".join(f'[solid.p{k}]\nplace = {{ solid = "s", ring = 4000000, radius = 1 }}\n[[region]]\nsolid = "p{k}"\n' for k in range(5_000)))
    toml("deep brackets", "a = " + "[" * 900_000)
    toml("deep tables", "a = " + "{a=" * 200_000)
    toml("deep headers", "[" + "a." * 400_000 + "a]")
    toml("headers", "".join(f"[{name_of(k)}]\n" for k in range(70_000)))
    toml("misspelt shapes", "rayweave = 1\n" + "".join(f"[solid.{name_of(k)}]\nspher = {{ radius = 1 }}\n" for k in range(15_000)))
    toml("misspelt solids", "rayweave = 1\n" + "".join(f"[solid.{name_of(k)}]\nexpr = '{name_of(k + 30_000)}'\n" for k in range(20_000)))
    toml("misspelt parameters", "rayweave = 1\n[parameters]\n" + "".join(f"{name_of(k)} = '{name_of(k + 30_000)}'\n" for k in range(25_000)))
    toml("misspelt media", "rayweave = 1\n[solid.s]\nsphere = { radius = 1 }\n" + "".join(f"[[region]]\nsolid = 's'\nmedium = '{name_of(k)}'\n" for k in range(18_000)))
    toml("misspelt keys", "rayweave = 1\n[solid.s]\nsphere = { radius = 1 }\n" + "".join(f"{name_of(k)} = 1\n" for k in range(40_000)))
    toml("misspelt arguments", "rayweave = 1\n[solid.s]\n[solid.s.sphere]\n" + "".join(f"{name_of(k)} = 1\n" for k in range(40_000)))
    toml("long name", "rayweave = 1\n[solid.s]\nexpr = '" + "n" * 900_000 + "'\n")
    toml("long key", "rayweave = 1\n" + "n" * 900_000 + " = 1\n")
    toml("brackets of an expression", balls + "[solid.e]\nexpr = '" + "(" * 400_000 + "s" + ")" * 400_000 + "'\n[[region]]\nsolid = 'e'\n")
    toml("complements", balls + "[solid.e]\nexpr = '" + "~" * 900_000 + "s'\n[[region]]\nsolid = 'e'\n")
    toml("long expression", balls + "[solid.e]\nexpr = '" + "s - s ^ s | s & " * 55_000 + "s'\n[[region]]\nsolid = 'e'\n")
    toml("brackets of arithmetic", "rayweave = 1\n[parameters]\na = '" + "(" * 400_000 + "1" + ")" * 400_000 + "'\n")
    toml("long sum", "rayweave = 1\n[parameters]\na = '" + "1+" * 450_000 + "1'\n")
    toml("chain of parameters", "rayweave = 1\n[parameters]\np0 = 1\n" + "".join(f"p{k} = 'p{k - 1} + p{k - 1}'\n" for k in range(1, 35_000)))
    toml("cycle of parameters", "rayweave = 1\n[parameters]\np0 = 'p34999'\n" + "".join(f"p{k} = 'p{k - 1} + p{k - 1}'\n" for k in range(1, 35_000)))
    toml("cycle of solids", "rayweave = 1\n[solid.u0]\nexpr = 'u19999'\n" + "".join(f"[solid.u{k}]\nexpr = 'u{k - 1}'\n" for k in range(1, 20_000)))
    toml("cycles of solids", "rayweave = 1\n" + "".join(f"[solid.u{k}]\nexpr = 'u0 | u{k // 2} | u{(k * 7919) % 15000} | u{15000 - k}'\n" for k in range(15_001)))
    toml("chain of solids", balls + "[solid.u0]\nexpr = 's'\n" + "".join(f"[solid.u{k}]\nexpr = 'u{k - 1} - s'\n" for k in range(1, 24_000)) + "[[region]]\nsolid = 'u23999'\n")
    toml("alternating chain", balls + "[solid.u0]\nexpr = 's'\n" + "".join(
        f"[solid.b{k}]\nsphere = {{ radius = {1 + k} }}\n[solid.u{k}]\nexpr = 'b{k} - u{k - 1}'\n" for k in range(1, 9_000)) + "[[region]]\nsolid = 'u8999'\n")
    toml("many regions", balls + "[[region]]\nsolid='s'\n" * 40_000)
    toml("many faults", "rayweave = 1\n" + "[solid.s]\nsphere = {}\n" * 35_000)
    toml("faults of syntax", "= \n" * 300_000)
    toml("faults on one line", "= " * 400_000)
    toml("unused parameters", "rayweave = 1\n[parameters]\n" + repeat("p% = 1\n", 70_000))
    toml("convex polyhedron", "rayweave = 1\n[solid.s]\npolyhedron = { planes = [" + ",".join(
        f"[{math.sin(k):.5f}, {math.cos(k):.5f}, {math.sin(k * 1.7):.5f}, 1]" for k in range(20_000)) + "] }\n[[region]]\nsolid = 's'\n")
    toml("prism", "rayweave = 1\n[solid.s]\nprism = { points = [" + ",".join(
        f"[{(1 + k % 2) * math.cos(k / 10_000 * math.pi):.6f}, {(1 + k % 2) * math.sin(k / 10_000 * math.pi):.6f}]" for k in range(20_000)) + "], height = 1 }\n[[region]]\nsolid = 's'\n")
    toml("mesh in the file", "rayweave = 1\n[solid.s]\nmesh = { points = [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], faces = [" + ",".join(["[0,1,2],[0,2,1]"] * 45_000) + "] }\n[[region]]\nsolid = 's'\n")
    toml("asphere", "rayweave = 1\n[solid.s]\nasphere = { radius = 10, conic = 0, coefficients = [" + ",".join(["1e-9"] * 150_000) + "], diameter = 1, thickness = 1 }\n[[region]]\nsolid = 's'\n")
    toml("other tables", "rayweave = 1\n" + "".join(f"[x{k}]\na = 1\n" for k in range(50_000)))
    toml("light sources", balls + "[optics]\n" + "[[optics.source]]\nbeam = { circle = 1, rays = 4000000000 }\n" * 15_000)
    toml("mesh many times", "rayweave = 1\n" + "".join(f"[solid.m{k}]\nmesh = {{ file = 'm.stl' }}\n" for k in range(10_000)), m__stl=stl(soup_cube() * 400))
    header = lambda text: b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text
    npy = lambda descr, shape, data=b"": header((f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}").encode()) + data
    placed = balls + "[solid.p]\nplace = { solid = 's', file = 'm.npy' }\n[[region]]\nsolid = 'p'\n"
    toml("NPY of brackets", placed, m__npy=header(b"{'descr': " + b"[" * 40 + b"]" * 40 + b"}"))
    toml("NPY of many brackets", placed, m__npy=header(b"(" * 60_000))
    toml("NPY of a stated shape", placed, m__npy=npy("'<f8'", (20_000_000, 3)))
    toml("NPY of a huge shape", placed, m__npy=npy("'<f8'", (1 << 60, 3)))
    toml("NPY of nothing", placed, m__npy=npy("'<f8'", (0, 3)))
    toml("NPY many times", balls + "".join(f"[solid.p{k}]\nplace = {{ solid = 's', file = 'm.npy' }}\n" for k in range(6_000)), m__npy=npy("'<f8'", (20_000, 3), bytes(480_000)))
    rays = lambda name, file, data: case("rays " + name, ["trace", "m.toml", "--rays", file, "-o", "hits.csv"], {"m.toml": balls + "[[region]]\nsolid = 's'\n", file: data})
    rays("NPY of brackets", "m.npy", header(b"{'descr': " + b"[" * 40 + b"]" * 40 + b"}"))
    rays("NPY of many brackets", "m.npy", header(b"(" * 60_000))
    rays("NPY of a stated shape", "m.npy", npy("'<f8'", (1 << 50, 6)))
    rays("NPY of long descr", "m.npy", npy("[" + ",".join(f"('{name_of(k)}', '<f8')" for k in range(3_000)) + "]", (1,)))
    rays("CSV of a long line", "m.csv", "ox,oy,oz,dx,dy,dz\n" + "1" * 900_000)
    rays("CSV of many fields", "m.csv", "ox,oy,oz,dx,dy,dz" + ",a" * 400_000 + "\n")
    rays("CSV of misspelt columns", "m.csv", ",".join(name_of(k) for k in range(60)) + "\n")
    rays("CSV of quotes", "m.csv", '"' * 900_000)
    rays("CSV of faults", "m.csv", "ox,oy,oz,dx,dy,dz\n" + "x,x,x,x,x,x\n" * 75_000)


def soup_cube():
    points = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return [tuple(points[k] for k in triangle) for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]


# --- lenses and glasses ---

def zmx(surfaces, head=""):
    return ("MODE SEQ\nUNIT MM X W X CM MR CPMM\nENPD 25\nFTYP 0 0 1 1 0 0 0\nXFLN 0\nYFLN 0\nWAVM 1 0.55 1\nPWAV 1\n" + head + surfaces)


def surface(k, more=""):
    return f"SURF {k}\n  TYPE STANDARD\n  CURV 0.01\n  DISZ 1\n{more}"


def lens_cases():
    lens = lambda name, text, *more: case("zmx " + name, ["optics", "m.zmx", *more], {"m.zmx": text})
    lens("surfaces", zmx("".join(surface(k, "  STOP\n" if k == 1 else "") for k in range(20_000))))
    lens("glasses", zmx("".join(surface(k, f"  GLAS {name_of(k)} 0 0 1.5 60\n") for k in range(11_000))))
    lens("glasses alike", zmx("".join(surface(k, "  GLAS N-BK77 0 0 1.5 60\n") for k in range(11_000))))
    lens("operands", zmx(surface(0), "".join(f"{name_of(k)} 1 2 3\n" for k in range(50_000))))
    lens("parameters", zmx(surface(0) + "SURF 1\n  TYPE EVENASPH\n" + "".join(f"  PARM {k} 1\n" for k in range(60_000))))
    lens("large parameter", zmx("SURF 0\n  TYPE EVENASPH\n  PARM 4000000000 1\n  XDAT 4000000000 1 0 0\n"))
    lens("large surface", zmx("SURF 4000000000\n  TYPE STANDARD\n"))
    lens("Zernike terms", zmx(surface(0) + "".join(f"SURF {k}\n  TYPE SZERNSAG\n  CURV 0.01\n  DISZ 1\n" + "".join(
        f"  XDAT {j} 1e-6 0 0 1 0 0\n" for j in range(1, 240)) for k in range(1, 120)) + surface(120)))
    lens("fields", zmx(surface(0) + surface(1, "  STOP\n") + surface(2), "YFLN " + "1 " * 300_000 + "\n"))
    lens("wavelengths", zmx(surface(0) + surface(1, "  STOP\n") + surface(2), "".join(f"WAVM {k} 0.5 1\n" for k in range(50_000))))
    lens("long line", zmx("SURF " + "1" * 900_000))
    lens("long type", zmx("SURF 0\n  TYPE " + "A" * 900_000))
    lens("empty surfaces", zmx("SURF 1\n" * 140_000))
    light = ("rayweave = 1\n[solid.ball]\nsphere = { radius = 10 }\n[[region]]\nsolid = 'ball'\n[optics]\n[optics.medium]\nball = { file = 'm.yml' }\n"
             "[[optics.source]]\nbeam = { circle = 1, rays = 10 }\ntransform = [{ translate = [0, 0, -50] }]\n")
    glass = lambda name, ending, text: case(f"{ending} {name}", ["optics", "m.toml"], {
        "m.toml": light, f"m.{ending}": text})
    glass("deep lists", "yml", "a: " + "[" * 900_000)
    glass("deep mappings", "yml", "".join(" " * k + "a:\n" for k in range(1_300)))
    glass("flow mappings", "yml", "a: " + "{a: " * 200_000)
    glass("aliases", "yml", "a0: &a0 [1, 1]\n" + "".join(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]\n" for k in range(1, 30)))
    glass("keys", "yml", repeat("k%: 1\n", 80_000))
    glass("same keys", "yml", "k: 1\n" * 180_000)
    glass("data", "yml", "DATA:\n" + "  - type: formula 1\n    wavelength_range: 0.3 2\n    coefficients: 0 1 1\n" * 11_000)
    glass("table", "yml", "DATA:\n  - type: tabulated nk\n    data: |\n" + "".join(f"        {.3 + k * 1e-5:.6f} 1.5 0.001\n" for k in range(30_000)))
    glass("unsorted table", "yml", "DATA:\n  - type: tabulated nk\n    data: |\n" + "".join(f"        {.3 + (k * 7919 % 30_011) * 1e-5:.6f} 1.5 0.001\n" for k in range(30_000)))
    glass("coefficients", "yml", "DATA:\n  - type: formula 4\n    wavelength_range: 0.3 2\n    coefficients: " + "1 " * 400_000 + "\n")
    glass("block text", "yml", "a: |\n" + " \n" * 400_000)
    glass("dashes", "yml", "- " * 400_000)
    glass("quotes", "yml", 'a: "' + "\\" * 900_000)

# --- questions about detailed models ---

def question_cases():
    def outline(kind, points, rest):
        points = ", ".join(f"[{x:.6f}, {y:.6f}]" for x, y in points)
        return f"rayweave = 1\n[solid.s]\n{kind} = {{ outline = [{points}]{rest} }}\n[[region]]\nsolid = 's'\n"

    def ask(name, file, text, commands=("section", "volume", "check", "info", "thickness", "render", "diff")):
        more = {"thickness": ["-o", "t.csv", "--size", "100x100", "--view", "iso"], "render": ["-o", "p.png", "--size", "100x100"], "diff": [file]}
        for command in commands:
            case(f"ask {command} {name}", [command, file, *more.get(command, [])], {file: text})

    random = __import__("random").Random(2)
    angle = lambda k, n: (math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n))
    shapes = {"circle": lambda k: 10, "star": lambda k: 10 + k % 2 * 10, "ragged disc": lambda k: 10 + random.uniform(-0.5, 0.5)}
    for shape, radius in shapes.items():
        for n in (15_000, 30_000):
            points = [(radius(k) * x, radius(k) * y) for k, (x, y) in ((k, angle(k, n)) for k in range(n))]
            ask(f"extruded {shape} of {n} corners", "m.toml", outline("extrude", points, ", height = 1"))
            ask(f"revolved {shape} of {n} corners", "m.toml", outline("revolve", [(x + 30, y) for x, y in points], ""))
    points = [(shapes["star"](k) * x, shapes["star"](k) * y) for k, (x, y) in ((k, angle(k, 10_000)) for k in range(10_000))]
    ask("extruded star of 10000 corners", "m.toml", outline("extrude", points, ", height = 1"), ("section", "volume", "check"))
    ask("revolved star of 10000 corners", "m.toml", outline("revolve", [(x + 30, y) for x, y in points], ""), ("section", "volume", "check"))
    teeth = [(0, -1)] + [(1 + k % 2 * 0.5, k) for k in range(15_000)] + [(0, 15_000)]
    ask("revolved saw of 15000 corners", "m.toml", outline("revolve", teeth, ""))
    place = lambda: f"[{random.uniform(-5, 5):.3f}, {random.uniform(-5, 5):.3f}, {random.uniform(-5, 5):.3f}]"
    for count in (1_000, 5_000):
        balls = "".join(f"[solid.s{k}]\nsphere = {{ radius = {10 + k * 1e-3:.3f} }}\ntransform = [{{ translate = {place()} }}]\n" for k in range(count))
        ask(f"{count} regions over each other", "m.toml", "rayweave = 1\n" + balls + "".join(f"[[region]]\nsolid = 's{k}'\n" for k in range(count)))
        ask(f"union of {count} balls over each other", "m.toml", "rayweave = 1\n" + balls + "[solid.all]\nexpr = '" + " | ".join(f"s{k}" for k in range(count)) + "'\n[[region]]\nsolid = 'all'\n")
    for name, at in (("in ten places", lambda k: (k % 10, 0, 0)), ("apart", lambda k: (2 * (k % 20), 2 * (k // 20 % 20), 2 * (k // 400)))):
        nodes = "".join(f'<multiUnionNode name="n{k}"><solid ref="b"/><position x="{at(k)[0]}" y="{at(k)[1]}" z="{at(k)[2]}"/></multiUnionNode>' for k in range(8_000))
        text = gdml(solids=f'<multiUnion name="m">{nodes}</multiUnion>', structure=volume("v", "m"))
        text = text.replace('<solidref ref="big"/></volume>', '<solidref ref="big"/>' + physvol("v") + "</volume>")
        ask(f"multiUnion of 8000 boxes {name}", "m.gdml", text)


# --- requests of the command ---

def request_cases():
    ball = "rayweave = 1\n[solid.ball]\nsphere = { radius = 1 }\n"
    nest = "".join(f'[solid.s{k}]\nplace = {{ solid = "s{k - 1}", at = [[0, 0, 0], [{k}, 0, 0]] }}\n' for k in range(1, 29))
    nest = "rayweave = 1\n[solid.s0]\nsphere = { radius = 1 }\n" + nest
    for ending in ("stl", "csg", "gdml"):
        case(f"request convert copies of copies to {ending}", ["convert", "m.toml", f"o.{ending}"], {"m.toml": nest})
    near = ball + '[solid.all]\nplace = { solid = "ball", grid = [50, 50, 1], step = [0.001, 0.001, 0] }\n'
    case("request convert coincident copies", ["convert", "m.toml", "o.stl"], {"m.toml": near})
    for total in (2**64 - 1, 10**12):
        case(f"request volume {total} rays", ["volume", "m.toml", "--total", str(total)], {"m.toml": ball})
    for tolerance in ("1e-14", "1e300"):
        case(f"request section within {tolerance}", ["section", "m.toml", "--tolerance", tolerance], {"m.toml": ball})


# Runs a command in a small process of its own and prints how it ended. The peak memory of a child includes that of its parent at the
# start, and this script holds all inputs.
LAUNCHER = """
import os, resource, signal, sys, time
child = os.fork()
if child == 0:
    resource.setrlimit(resource.RLIMIT_CPU, (8, 8))
    os.execv(sys.argv[1], sys.argv[1:])
deadline = time.monotonic() + 120
while True:
    done, status, usage = os.wait4(child, os.WNOHANG)
    if done:
        break
    if time.monotonic() > deadline:
        os.kill(child, signal.SIGKILL)
    time.sleep(0.005)
with open("usage", "w") as out:
    print(os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, usage.ru_maxrss, file=out)
"""


def run(program, arguments, folder):
    """Exit code or signal, CPU seconds, peak memory in MB, and the first line of the messages."""
    with open(os.path.join(folder, "out"), "w") as out, open(os.path.join(folder, "err"), "w") as err:
        launched = [sys.executable, "-S", "-c", LAUNCHER, program, *arguments]
        subprocess.run(launched, cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=err, check=True)
    with open(os.path.join(folder, "usage")) as usage:
        code, seconds, peak = usage.read().split()
    with open(os.path.join(folder, "err"), errors="replace") as err:
        lines = [line.strip() for line in err.read(100_000).splitlines() if "error" in line or "warning" in line]
    errors = [line for line in lines if "error" in line] or lines
    memory = int(peak) / (1e6 if sys.platform == "darwin" else 1e3)
    return int(code), float(seconds), memory, (errors or [""])[0]


def main():
    program, words = os.path.abspath(sys.argv[1]), sys.argv[2:]
    for cases in (gdml_cases, scad_cases, drawing_cases, mesh_cases, toml_cases, lens_cases, question_cases, request_cases):
        cases()
    failed = []
    for name, arguments, files in CASES:
        if words and not all(word in name for word in words):
            continue
        with tempfile.TemporaryDirectory() as folder:
            total = 0
            for file, data in files.items():
                data = data.encode() if isinstance(data, str) else data
                total += len(data)
                with open(os.path.join(folder, file), "wb") as out:
                    out.write(data)
            code, seconds, megabytes, message = run(program, arguments, folder)
        assert total <= 1_000_000, f"{name}: {total} bytes"
        bad = seconds > SECONDS or megabytes > MEGABYTES or code < 0 or code > 100
        print(f"{'BAD ' if bad else '    '}{seconds:6.2f} s {megabytes:6.0f} MB  {code:4}  {total:7} B  {name}: {message[:110]}", flush=True)
        failed += [name] if bad else []
    print(f"{len(failed)} of {len(CASES)} inputs take too much")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
