"""Optical photons in detectors: closed forms, arrays, files, histories, errors."""

import json
import math
import pickle
import re
import signal
import subprocess
import threading
import time
import zlib
import _thread
from pathlib import Path

import numpy as np
import pytest

import rayweave as rw
import rayweave.photons as rp
from rayweave import RayweaveError, optics

ROOT = Path(__file__).resolve().parents[3]
GUIDE = (ROOT / "docs/guides/photons.md").read_text(encoding="utf-8")
BAR = re.search(r"^```xml\n(.*?)^```$", GUIDE, re.MULTILINE | re.DOTALL)[1]

#: A world of 2 m filled with a medium of index 1.5 and absorption length 100 mm.
ABSORBER = """<gdml><define>
<matrix name="GLASS" coldim="2" values="1*eV 1.5 10*eV 1.5"/>
<matrix name="LENGTH" coldim="2" values="2*eV 100 4*eV 300"/></define>
<materials><element name="H" Z="1"><atom value="1"/></element>
<material name="Medium"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="GLASS"/>
<property name="ABSLENGTH" ref="LENGTH"/></material></materials>
<solids><box name="WorldBox" x="2000" y="2000" z="2000" lunit="mm"/></solids>
<structure><volume name="World"><materialref ref="Medium"/><solidref ref="WorldBox"/></volume></structure>
<setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"""

C = 299.792458


@pytest.fixture(scope="module")
def bar():
    return rp.loads(BAR)


def from_middle(**more):
    return rp.point([0, 0, 0], 550, **more)


def test_properties_are_arrays(bar):
    crystal = bar.material("Crystal")
    assert crystal.name == "Crystal" and crystal.refractive_index.unit == ""
    np.testing.assert_allclose(crystal.refractive_index.energy_ev, [1.5, 4.0], rtol=1e-15)
    np.testing.assert_array_equal(crystal.refractive_index.values, [1.79, 1.79])
    assert crystal.absorption_length.unit == "mm" and crystal.absorption_length.values[0] == 400.0
    # without dispersion the group velocity is c / n
    np.testing.assert_allclose(crystal.group_velocity.values, C / 1.79, rtol=1e-15)
    assert bar.material("Opaque").refractive_index is None and crystal.rayleigh_length is None
    absorption = rp.loads(ABSORBER).material("Medium").absorption_length
    # linear in the energy, constant beyond the ends: 3 eV is 413.28 nm
    np.testing.assert_allclose(absorption.at([1239.841984332 / 3.0, 2000.0, 10.0]), [200.0, 100.0, 300.0])
    np.testing.assert_allclose(absorption.wavelength_nm, 1239.841984332 / np.array([2.0, 4.0]))
    wrapping, cathode = bar.surface("Wrapping"), bar.surface("Cathode")
    assert (wrapping.model, wrapping.finish, wrapping.type) == ("unified", "groundfrontpainted", "dielectric_dielectric")
    assert (cathode.finish, cathode.type, cathode.value) == ("polished", "dielectric_metal", 0.0)
    assert cathode.efficiency.at(550) == 0.3 and wrapping.efficiency is None
    assert bar.sensors == {}
    assert "3 materials" in repr(bar) or "2 materials" in repr(bar)
    with pytest.raises(RayweaveError, match="Did you mean 'Crystal'"):
        bar.material("Cristal")


def test_absorption_follows_the_exponential_law():
    """3 eV: 200 mm. The mean depth, and the fraction beyond one absorption length, of 40,000 photons."""
    detector = rp.loads(ABSORBER)
    source = rp.point([0, 0, -999], 1239.841984332 / 3.0, towards=[0, 0, 1])
    run = detector.simulate(source, n=40_000, record="steps", seed=4)
    steps = run.histories
    ends = steps["process"] == steps.process_names.index("absorbed")
    depth = steps["z"][ends] + 999
    # behind 1999 mm a photon leaves the world, with the probability exp(-10)
    assert ends.sum() + run.ends["escaped"] == 40_000
    assert abs(depth.mean() - 200.0) < 5 * 200.0 / math.sqrt(40_000)
    beyond = np.count_nonzero(depth > 200.0) + run.ends["escaped"]
    expected, deviation = 40_000 * math.exp(-1), math.sqrt(40_000 * math.exp(-1) * (1 - math.exp(-1)))
    assert abs(beyond - expected) < 5 * deviation
    # n / c times the distance
    np.testing.assert_allclose(steps["time"][ends], depth * 1.5 / C, rtol=1e-12, atol=1e-12)


def test_hits_are_columns(bar):
    run = bar.simulate(from_middle(), n=3000, event=7)
    hits = run.hits
    assert sum(run.ends.values()) == run.photons == 3000 and run.ends["detected"] == hits.rows > 100
    assert hits.position.shape == hits.direction.shape == hits.polarisation.shape == (hits.rows, 3)
    np.testing.assert_allclose(hits.position[:, 2], 50.0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(hits.direction, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose((hits.direction * hits.polarisation).sum(axis=1), 0.0, atol=1e-9)
    assert (hits.time >= 50 * 1.79 / C * (1 - 1e-12)).all()
    assert set(hits["event"]) == {7} and set(hits["weight"]) == {1.0} and set(hits["copy"]) == {-1}
    assert hits.sensor_paths == ["Diode"] and set(hits.named("sensor")) == {"Diode"}
    assert hits.counts() == {"Diode": hits.rows}
    assert "detected" in repr(run) and hits.units["time"] == "ns"
    frame = hits.to_pandas()
    assert list(frame.columns) == list(hits) and set(frame["sensor"]) == {"Diode"}
    assert frame["x"].to_numpy().tolist() == hits["x"].tolist() and frame.attrs["units"]["x"] == "mm"
    table = hits.to_arrow()
    assert table["sensor"].to_pylist() == ["Diode"] * hits.rows
    assert table.schema.field("time").metadata[b"unit"] == b"ns"


def test_no_hits_have_columns_too(bar):
    # no volume of the bar is marked as sensitive
    run = bar.simulate(from_middle(), n=10, record="steps", detect="volume")
    assert run.hits.rows == 0 and run.ends["detected"] == 0
    assert run.hits.position.shape == (0, 3) and run.hits.to_opticks().shape == (0, 4, 4)
    assert run.hits.to_pandas().empty and run.hits.to_arrow().num_rows == 0
    assert "no hits" in run.hits.plot().svg and "no hits" in run.hits.plot_spectra().svg
    assert run.histories.plot().svg.startswith("<svg ")
    assert bar.simulate(from_middle(), n=0).photons == 0


def test_hits_of_files_are_those_of_the_run(bar, tmp_path):
    hits = bar.simulate(from_middle(), n=2000).hits
    for name in ("hits.npy", "hits.csv"):
        hits.save(tmp_path / name)
        read = bar.read_hits(tmp_path / name)
        assert read == hits and read.counts() == hits.counts()
        assert read.plot().svg == hits.plot().svg and read.plot_spectra().svg == hits.plot_spectra().svg
        assert (read.to_opticks() == hits.to_opticks()).all()
    (tmp_path / "other.csv").write_text("photon,x\n1,2\n")
    with pytest.raises(RayweaveError, match="other.csv is not a table of hits: it has no column `event`"):
        bar.read_hits(tmp_path / "other.csv")
    with pytest.raises(RayweaveError, match="pandas.read_parquet"):
        bar.read_hits("hits.parquet")


def test_tracks_of_some_photons(bar):
    run = bar.simulate(from_middle(), n=300, record="steps")
    detected = run.hits.photon
    assert 0 < detected.size < 100
    drawing = run.histories.plot("yz", photons=detected)
    assert drawing.svg.count("<circle") >= detected.size and len(drawing.svg) < len(run.histories.plot("yz").svg)
    one = run.histories.of(detected[0])
    assert one.plot("yz").svg == run.histories.plot("yz", photons=detected[:1]).svg
    # the same as a run of this photon
    number = int(detected[0])
    alone = bar.simulate(from_middle(), n=300, range=(number, number + 1), record="steps")
    assert one.plot("yz").svg == alone.histories.plot("yz").svg
    assert run.histories.plot(photons=[]).svg.startswith("<svg ")
    with pytest.raises(RayweaveError, match="photons has 300: the histories have no such photon"):
        run.histories.plot(photons=[300])
    with pytest.raises(TypeError, match="whole numbers"):
        run.histories.plot(photons=[0.5])


def test_materials_and_surfaces_are_printed(bar):
    text = str(bar.material("Crystal"))
    assert "RINDEX: 1.79, 309.96 to 826.561 nm, 2 points" in text and "ABSLENGTH: 400 mm" in text
    assert str(bar.surface("Cathode")).splitlines()[0] == "Surface Cathode"


def test_sources_that_are_partly_outside_have_notes(bar):
    source = rp.line([0, 0, -49], [0, 0, 60], 550)
    with pytest.warns(UserWarning, match="start"):
        run = bar.simulate(source, n=300)
    assert run.notes[0] == bar.check_source(source)
    assert run.ends["no_index"] > 0
    with pytest.warns(UserWarning, match="start"):
        next(bar.stream(source, n=300))


def test_runs_without_hits_have_notes(bar):
    with pytest.warns(UserWarning, match="no photon is detected"):
        run = bar.simulate(from_middle(), n=200, detect="volume")
    [note] = run.notes
    most = max(run.ends, key=run.ends.get)
    assert f"{run.ends[most]} of 200 end as {most}" in note and "`check()` of the detector reports 1 probable mistake;" in note
    assert bar.simulate(from_middle(), n=200).notes == ()
    # a low limit of steps is a choice, and a world without sensors detects nothing
    assert bar.simulate(from_middle(), n=200, max_steps=1).notes == ()
    assert rp.loads(ABSORBER).simulate(from_middle(), n=200).notes == ()


def test_undefined_references_are_errors(tmp_path):
    text = BAR.replace('<physvolref ref="diode"/>', '<physvolref ref="dioed"/>')
    with pytest.raises(RayweaveError, match="unknown placement `dioed`.*Did you mean `diode`"):
        rp.loads(text)
    with pytest.warns(UserWarning) as caught:
        detector = rp.loads(text, allow_missing=True)
    assert any("unknown placement `dioed`" in str(own.message) for own in caught)
    assert any("`dioed`" in text for text in detector.warnings)
    assert [own for own in detector.check()["text"] if "`dioed`" in own]
    (tmp_path / "bar.gdml").write_text(BAR.replace('surfaceproperty="Cathode"', 'surfaceproperty="Cathod"'))
    with pytest.raises(RayweaveError, match="(?s)unknown optical surface `Cathod`.*bar.gdml:.*allow_missing=True"):
        rp.load(tmp_path / "bar.gdml")
    with pytest.warns(UserWarning) as caught:
        detector = rp.load(tmp_path / "bar.gdml", allow_missing=True)
    assert any("unknown optical surface" in str(own.message) for own in caught)
    rows = [own for own in detector.check()["text"] if "unknown optical surface `Cathod`" in own]
    assert len(rows) == 1
    with pytest.raises(RayweaveError, match="there is no surface 'cathode'.*Did you mean 'Cathode'"):
        rp.loads(BAR).surface("cathode")


def test_definitions_of_gdml_are_parameters(tmp_path):
    text = ABSORBER.replace("</define>", '<constant name="half" value="1000"/></define>').replace('"2000"', '"2*half"')
    (tmp_path / "world.gdml").write_text(text)
    for half in (20, "2*cm", "10+1*cm"):
        detector = rp.load(tmp_path / "world.gdml", parameters={"half": half})
        for own in (detector, pickle.loads(pickle.dumps(detector)), rp.loads(text, parameters={"half": half})):
            assert own.simulate(rp.point([0, 0, 19], 550), n=1).photons == 1
            with pytest.raises(RayweaveError, match="outside the world"):
                own.simulate(rp.point([0, 0, 21], 550), n=1)
    with pytest.raises(RayweaveError, match="unknown parameter `halb`.*Did you mean `half`"):
        rp.loads(text, parameters={"halb": 1})
    model = rw.load(tmp_path / "world.gdml", {"half": 20})
    assert np.array_equal(model.bounds, [[-20] * 3, [20] * 3])


def test_misspelt_spectra_have_a_suggestion(bar):
    with pytest.raises(RayweaveError, match="no spectrum 'scintilation'.*scintillation.*Did you mean 'scintillation'"):
        rp.point([0, 0, 0], ("scintilation", bar.material("Crystal")))


def test_a_path_selects_copies(bar):
    placed = '<physvol name="bar"><volumeref ref="Bar"/>'
    other = f'{placed}<position name="o" x="60" unit="mm"/></physvol>'.replace('"bar"', '"other"')
    assert placed in BAR
    detector = rp.loads(BAR.replace(placed, other + placed))
    for number, centre in ((0, 60), (1, 0)):
        for kind in (rp.volume, rp.surface):
            steps = detector.simulate(kind(detector, f"Bar[{number}]", 550), n=50, record="steps").histories
            x = steps["x"][steps["step"] == 0]
            assert len(x) == 50 and (abs(x - centre) <= 10).all()
    with pytest.raises(ValueError, match=r"no copy of a volume is called `Bar\[2\]`: the names are Bar\[0\], Bar\[1\]\."):
        rp.volume(detector, "Bar[2]", 550)


def test_histories_without_steps_say_so(bar):
    run = bar.simulate(from_middle(), n=100, record="sequences")
    for use in (lambda: run.histories.of(3), lambda: run.histories.plot(), lambda: run.histories.save("steps.csv")):
        with pytest.raises(RayweaveError, match='have no steps: .* Simulate with record="steps"'):
            use()


def test_a_source_without_light_is_an_error(bar):
    for place, reason in (([0, 0, 300], "outside the world"), ([0, 0, 90], "has no RINDEX")):
        with pytest.raises(RayweaveError, match=reason):
            bar.simulate(rp.point(place, 550), n=10)
        with pytest.raises(RayweaveError, match=reason):
            bar.stream(rp.point(place, 550), n=10)


def test_sensors_have_equal_numbers_in_all_runs(tmp_path):
    placed = '<physvol name="diode"><volumeref ref="Diode"/><position name="p" z="50.5" unit="mm"/></physvol>'
    low = '<physvol name="low"><volumeref ref="Diode"/><position name="q" z="-50.5" unit="mm"/></physvol>'
    dark = '<physvol name="dark"><volumeref ref="Diode"/><position name="r" z="80" unit="mm"/></physvol>'
    border = '<bordersurface name="end" surfaceproperty="Cathode"><physvolref ref="bar"/><physvolref ref="diode"/></bordersurface>'
    text = BAR.replace(placed, placed + low + dark).replace(border, border + border.replace('"end"', '"other"').replace('"diode"', '"low"'))
    detector = rp.loads(text)
    paths = ["Diode[0]", "Diode[1]", "Diode[2]"]
    runs = list(detector.stream(from_middle(), n=300, chunk=10, seed=3))
    assert all(run.hits.sensor_paths == paths for run in runs)
    # the first hits are on different sensors
    assert {run.hits["sensor"][0] for run in runs if run.hits.rows} == {0, 1}
    for run in runs:
        # copy 0 is at z = 50
        assert ((run.hits["sensor"] == 0) == (run.hits.position[:, 2] > 0)).all()
    whole = detector.simulate(from_middle(), n=300, seed=3).hits
    assert np.array_equal(whole["sensor"], np.concatenate([run.hits["sensor"] for run in runs]))
    # in files as well, whichever sensor has the first hit
    for number, run in enumerate(runs):
        run.hits.save(tmp_path / f"{number}.npy")
        assert np.array_equal(np.load(tmp_path / f"{number}.npy")["sensor"], run.hits["sensor"])
        assert json.loads((tmp_path / f"{number}.names.json").read_text())["sensor"] == paths
    assert f"{whole.counts()[paths[1]]} hits" in whole.plot_spectra(sensor=1).svg
    assert whole.plot_spectra(sensor="Diode[1]").svg == whole.plot_spectra(sensor=1).svg
    assert f"{whole.rows} hits" in whole.plot_spectra(sensor="Diode").svg
    with pytest.raises(RayweaveError, match="no sensor is called `Diod`"):
        whole.plot_spectra(sensor="Diod")
    # rows of hits are hits
    late = whole[whole["time"] > np.median(whole["time"])]
    assert isinstance(late, rp.Hits) and late.sensor_paths == paths and 0 < late.rows < whole.rows
    assert np.array_equal(late["x"], whole["x"][whole["time"] > np.median(whole["time"])])
    assert f"{late.rows} hits" in late.plot_spectra().svg and f"{late.rows} hits" in late.plot().svg
    assert whole[[]].rows == 0 and whole[:5] == whole[[0, 1, 2, 3, 4]]
    one = whole.plot(sensor="Diode[1]").svg
    assert f"{whole.counts()[paths[1]]} hits of" in one and one == whole.plot(sensor=1).svg
    assert np.array_equal(whole.copy_numbers[:, -1], whole["copy"])
    with pytest.raises(IndexError, match="there are 3 sensors"):
        whole.plot_spectra(sensor=3)
    counts = whole.counts()
    assert list(counts) == paths and counts["Diode[2]"] == 0 and sum(counts.values()) == whole.rows


def test_maps_have_a_number_of_cells(bar):
    hits = bar.simulate(from_middle(), n=2000).hits
    assert hits.plot(bins=1).svg.count("M") < hits.plot(bins=20).svg.count("M")
    # the diode from -10 to 10, also for a few hits, which once had a map of their own extent
    few = bar.simulate(from_middle(), n=30, seed=2).hits
    assert 0 < few.rows < 20
    assert ">\u221210<" in few.plot().svg and ">10<" in few.plot().svg
    with pytest.raises(RayweaveError, match="bins is 0: it must be at least 1"):
        hits.plot(bins=0)


def test_maps_have_a_plane(bar):
    hits = bar.simulate(from_middle(), n=2000).hits
    # the diode lies across z
    assert "x / mm" in hits.plot().svg and "z / mm" not in hits.plot().svg
    assert "z / mm" in hits.plot("yz").svg and "x / mm" not in hits.plot(plane="yz").svg
    assert "cos theta" in hits.plot("sphere").svg
    # cells without hits are grey on a logarithmic scale
    few = bar.simulate(from_middle(), n=30, seed=2).hits
    assert "#b4b4b4" in few.plot(bins=9, scale="log").svg and "#b4b4b4" not in few.plot(bins=9).svg
    with pytest.raises(ValueError, match="`logarithmic` is not a scale of hit maps: it must be linear or log"):
        hits.plot(scale="logarithmic")
    with pytest.raises(ValueError, match="`zx` is not a plane of hit maps: it must be yz, xz, xy or sphere"):
        hits.plot("zx")


def test_whole_floats_and_warnings(bar):
    assert bar.simulate(from_middle(), 1e2).photons == 100
    with pytest.raises(TypeError, match="n is 1.5: it must be a whole number"):
        bar.simulate(from_middle(), 1.5)
    with pytest.warns(UserWarning) as caught:
        detector = rp.loads(BAR.replace("1.5*eV 1.79 4*eV 1.79", "1.5 1.79 4 1.79"))
    assert any("look like eV" in str(own.message) for own in caught)
    assert any("look like eV" in text for text in detector.warnings)
    sensor = '<solidref ref="DiodeBox"/>'
    marked = BAR.replace(sensor, sensor + '<auxiliary auxtype="SensDet" auxvalue="d"/>')
    assert str(rp.loads(marked).check()) == "no findings"


def test_the_layout_of_opticks(bar):
    hits = bar.simulate(from_middle(), n=2000).hits
    photons = hits.to_opticks()
    assert photons.dtype == np.float32 and photons.shape == (hits.rows, 4, 4)
    np.testing.assert_array_equal(photons[:, 0], np.column_stack([hits.position, hits.time]).astype(np.float32))
    np.testing.assert_array_equal(photons[:, 2, 3], hits.wavelength_nm.astype(np.float32))
    flags = photons.view(np.uint32)[:, 3]
    np.testing.assert_array_equal(flags[:, 2], hits["photon"])
    assert set(flags[:, 0]) == {1 << 6} and set(flags[:, 1]) == {1}
    # the index of the instance is an integer
    assert set(photons.view(np.uint32)[:, 1, 3]) == {0}


def test_masks_of_opticks_have_the_flags_of_all_steps(bar):
    bits = {name: bit for bit, name in enumerate("CK SI MI AB RE SC SD SA DR SR BR BT TO".split())}
    run = bar.simulate(from_middle(), n=2000, record="sequences")
    sequences = run.histories.sequences()
    texts = dict(zip(sequences.photon.tolist(), sequences.texts))
    found = run.hits.to_opticks().view(np.uint32)[:, 3, 3].tolist()
    for photon, mask in zip(run.hits["photon"].tolist(), found):
        # longer sequences are cut
        if not texts[photon].endswith("..."):
            assert mask == sum(1 << bits[flag] for flag in set(texts[photon].split())), texts[photon]
    assert len(set(found)) > 1
    # without histories
    assert set(bar.simulate(from_middle(), n=2000).hits.to_opticks().view(np.uint32)[:, 3, 3]) == {1 << bits["SD"]}


def same(a, b):
    return all(np.array_equal(a[name], b[name]) for name in a) and a.sensor_paths == b.sensor_paths


def test_runs_are_reproducible(bar):
    whole = bar.simulate(from_middle(), n=9000, seed=3)
    assert same(bar.simulate(from_middle(), n=9000, seed=3, threads=3, record="steps").hits, whole.hits)
    assert not same(bar.simulate(from_middle(), n=9000, seed=4).hits, whole.hits)
    parts = [bar.simulate(from_middle(), n=9000, seed=3, range=part).hits for part in [(0, 11), range(11, 9000)]]
    chunks = [run.hits for run in bar.stream(from_middle(), n=9000, seed=3, chunk=2500)]
    assert len(chunks) == 4
    for pieces in (parts, chunks):
        for name in whole.hits:
            joined = np.concatenate([piece[name] for piece in pieces])
            np.testing.assert_array_equal(joined, whole.hits[name], err_msg=name)


def test_arrays_are_a_source(bar):
    """Equal photons from arrays and from a point have the same histories, bit for bit."""
    point = bar.simulate(from_middle(towards=[1, 2, 3]), n=3000, seed=8, record="steps")
    given = rp.photons([0, 0, 0], np.tile([1, 2, 3], (3000, 1)), wavelengths_nm=550)
    assert given.count == 3000
    arrays = bar.simulate(given, seed=8, record="steps")
    for name in point.histories:
        np.testing.assert_array_equal(arrays.histories[name], point.histories[name], err_msg=name)
    # with given polarisations, for any seed
    emitted = arrays.histories["process"] == 0
    full = rp.photons(
        [0, 0, 0], [1, 2, 3], wavelengths_nm=550, polarisations=arrays.histories.polarisation[emitted]
    )
    again = bar.simulate(full, seed=8).hits
    np.testing.assert_allclose(again.position, arrays.hits.position, atol=1e-9)
    late = bar.simulate(rp.photons([0, 0, 0], [1, 2, 3], wavelengths_nm=550, times=np.full(3000, 5.0)), seed=8).hits
    np.testing.assert_allclose(late.time, point.hits.time + 5.0, rtol=1e-12)
    chunked = [run.hits for run in bar.stream(given, seed=8, chunk=1000)]
    np.testing.assert_array_equal(np.concatenate([hits["x"] for hits in chunked]), arrays.hits["x"])


def test_histories(bar):
    run = bar.simulate(from_middle(), n=500, record="steps", seed=2)
    steps = run.histories
    names = steps.named("process")
    assert {name: np.count_nonzero(names == name) for name in steps.processes} == steps.processes
    assert steps.processes["emission"] == 500
    assert {end: count for end, count in run.ends.items() if count} == {
        end: steps.processes[end] for end in run.ends if end in steps.processes
    }
    wrapping = steps.surfaces["Wrapping"]
    assert wrapping["lambertian_reflection"] == steps.processes["lambertian_reflection"]
    on_wrapping = steps.named("surface") == "Wrapping"
    assert np.count_nonzero(on_wrapping) == sum(wrapping.values())
    assert set(steps.named("volume")) == {"Bar"}
    # between reflections photons travel straight, at c / n
    for photon in (0, 1, 499):
        track = steps.of(photon)
        points = np.stack([track["x"], track["y"], track["z"]], axis=1)
        lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
        np.testing.assert_allclose(np.diff(track["time"]), lengths * 1.79 / C, rtol=1e-9, atol=1e-12)
        assert track["process"][0] == "emission" and track["process"][-1] in run.ends
    found = steps.sequences()
    assert found.words.shape == (500, 2) and found.words.dtype == np.uint64
    # the nibbles of TO, DR, SD, SA, AB in OpticksPhoton.h
    codes = {"TO": 13, "DR": 9, "SD": 7, "SA": 8, "AB": 4}
    for text, (low, high) in zip(found.texts, found.words.tolist(), strict=True):
        slots = text.removesuffix(" ...").split()
        # a text that is cut has all 32 flags, and the last one does not end the photon
        assert len(slots) <= 32 and text.endswith("...") == (len(slots) == 32 and slots[-1] in ("TO", "DR"))
        expected = sum(codes[slot] << (4 * k) for k, slot in enumerate(slots))
        assert low | high << 64 == expected
    assert sum(found.counts().values()) == 500 and next(iter(found.counts())).startswith("TO")
    only = bar.simulate(from_middle(), n=500, record="sequences", seed=2).histories
    assert only.rows == 0 and only.sequences().texts == found.texts
    counts = bar.simulate(from_middle(), n=500, record="counts", seed=2).histories
    assert counts.processes == steps.processes and counts.surfaces == steps.surfaces and not counts.sequences().texts
    with pytest.raises(RayweaveError, match="no histories are recorded"):
        bar.simulate(from_middle(), n=1).histories  # noqa: B018


def test_drawings(bar, tmp_path):
    run = bar.simulate(from_middle(), n=100, record="steps")
    tracks = run.histories.plot("yz")
    assert "section x = 0" in tracks.svg and f"detected: {run.hits.rows}" in tracks.svg
    # one for each hit, and one in the legend
    assert tracks.svg.count('class="mark"') == run.hits.rows + 1
    assert f"{run.hits.rows} hits of one sensor" in run.hits.plot().svg
    assert "550 nm" in tracks.svg and "time / ns" in run.hits.plot_spectra().svg
    tracks.save(tmp_path / "tracks.svg")
    assert (tmp_path / "tracks.svg").read_text(encoding="utf-8") == tracks._repr_svg_()
    with pytest.raises(RayweaveError, match="`up` is not a plane"):
        run.histories.plot("up")


def command():
    """The command of this checkout, if it is built."""
    built = [ROOT / "target" / kind / "rayweave" for kind in ("debug", "release")]
    found = [path for path in built if path.exists()]
    return max(found, key=lambda path: path.stat().st_mtime) if found else None


@pytest.mark.parametrize("kind", ["csv", "npy"])
def test_files_are_those_of_the_command(bar, tmp_path, kind):
    program = command()
    if program is None:
        pytest.skip("the command is not built")
    (tmp_path / "bar.gdml").write_text(BAR, encoding="utf-8")
    table = ["-o", f"c.{kind}", "--steps", f"s.{kind}"]
    arguments = ["photons", "bar.gdml", "--at", "0,0,0", "--wavelength", "550", "-n", "2000", "--seed", "5"]
    subprocess.run([program, *arguments, *table], cwd=tmp_path, check=True, capture_output=True)
    run = rp.load(tmp_path / "bar.gdml").simulate(from_middle(), n=2000, seed=5, record="steps")
    run.hits.save(tmp_path / f"p.{kind}")
    run.histories.save(tmp_path / f"q.{kind}")
    for own, other in ("pc", "qs"):
        assert (tmp_path / f"{own}.{kind}").read_bytes() == (tmp_path / f"{other}.{kind}").read_bytes()


def test_files_hold_the_hits(bar, tmp_path):
    hits = bar.simulate(from_middle(), n=1000).hits
    hits.save(tmp_path / "hits.npy")
    table = np.load(tmp_path / "hits.npy")
    for name in table.dtype.names:
        np.testing.assert_array_equal(table[name], hits[name], err_msg=name)
    parquet = pytest.importorskip("pyarrow.parquet")
    hits.save(tmp_path / "hits.parquet")
    read = parquet.read_table(tmp_path / "hits.parquet")
    np.testing.assert_array_equal(read["x"].to_numpy(), hits["x"])
    assert set(read["sensor"].to_pylist()) == {"Diode"} and set(read.column_names) == set(hits)
    assert read.schema.metadata[b"unit.time"] == b"ns"
    with pytest.raises(RayweaveError, match="does not exist. Create it first"):
        hits.save(tmp_path / "no/hits.parquet")
    assert [path.name for path in tmp_path.iterdir() if "part" in path.name] == []
    for bad, reason in (("hits.txt", "table format is unknown"), ("no/hits.csv", "no/hits.csv")):
        with pytest.raises(RayweaveError, match=reason):
            hits.save(tmp_path / bad)
    assert not (tmp_path / "hits.txt").exists()


def test_bad_sources_are_explained(bar):
    nan = [[0, 0, 0], [0, float("nan"), 0]]
    up = [0, 0, 1]
    cases = [
        (lambda: rp.point([0, 0, float("nan")], 550), r"position\[2\] is NaN"),
        (lambda: rp.point([0, 0], 550), "position has 2 numbers: it must have 3"),
        (lambda: rp.point([0, 0, 0], 0), "the wavelength is 0 nm: it must be positive"),
        (lambda: rp.point([0, 0, 0], float("inf")), "the wavelength is inf nm"),
        (lambda: rp.point([0, 0, 0], 550, towards=[0, 0, 0]), "it must be finite and not zero"),
        (lambda: rp.photons(nan, up, wavelengths_nm=550), r"positions\[1\] is .*it must be finite"),
        (lambda: rp.photons([0, 0, 0], [up, [0, 0, 0]], wavelengths_nm=550), r"directions\[1\] is"),
        (lambda: rp.photons([0, 0, 0], up, wavelengths_nm=[550, 0]), r"wavelengths_nm\[1\] is 0: it must be positive"),
        (lambda: rp.photons([0, 0, 0], up, wavelengths_nm=550, times=[0, math.inf]), r"times\[1\] is inf"),
        (lambda: rp.photons([0, 0, 0], up, wavelengths_nm=550, polarisations=up), r"polarisations\[0\].*not along"),
        (lambda: rp.photons(np.zeros((3, 3)), np.ones((2, 3)), wavelengths_nm=550), "directions has 2 rows: positions has 3"),
        (lambda: rp.photons(np.zeros((3, 2)), up, wavelengths_nm=550), r"positions has shape \(3, 2\)"),
        (lambda: rp.photons([0, 0, 0], up, wavelengths_nm=np.ones((2, 2))), r"wavelengths_nm has shape \(2, 2\)"),
    ]
    for make, reason in cases:
        with pytest.raises(RayweaveError, match=reason):
            make()
    with pytest.raises(TypeError, match="wavelength_nm is 'blue'"):
        rp.point([0, 0, 0], "blue")
    with pytest.raises(TypeError, match="source is 5"):
        bar.simulate(5, n=1)


def test_bad_settings_are_explained(bar, tmp_path):
    source = from_middle()
    cases = [
        ({}, "n is missing"),
        ({"n": -1}, "n is -1"),
        ({"n": 10, "range": (5, 3)}, r"range is \(5, 3\)"),
        ({"n": 10, "range": (0, 11)}, "the run has the photons 0 to 10"),
        ({"n": 10, "range": range(0, 10, 2)}, "its step must be 1"),
        ({"n": 10, "seed": -1}, "seed is -1"),
        ({"n": 10, "detect": "all"}, "it must be efficiency, volume or both"),
        ({"n": 10, "record": "step"}, "Did you mean 'steps'"),
        ({"n": 10, "max_time": 0}, "the maximum time is 0 ns: it must be positive"),
        ({"n": 10, "max_time": math.nan}, "the maximum time is NaN ns"),
        ({"n": 10, "threads": 0}, "threads is 0"),
    ]
    for arguments, reason in cases:
        with pytest.raises(RayweaveError, match=reason):
            bar.simulate(source, **arguments)
    with pytest.raises(RayweaveError, match="the source has 1 photons"):
        bar.simulate(rp.photons([0, 0, 0], [0, 0, 1], wavelengths_nm=550), n=2)
    with pytest.raises(RayweaveError, match="chunk is 0"):
        bar.stream(source, n=5, chunk=0)
    with pytest.raises(FileNotFoundError, match="missing.gdml"):
        rp.load(tmp_path / "missing.gdml")
    with pytest.raises(RayweaveError, match="property `RINDEX` of material `Crystal` is invalid"):
        rp.loads(BAR.replace("1.5*eV 1.79 4*eV 1.79", "1.5*eV 1.79 4*eV 0"))
    (tmp_path / "plain.toml").write_text("rayweave = 1\n[solid.a]\nsphere = { radius = 1 }\n")
    with pytest.raises(RayweaveError, match=r"it has neither a table \[photons\] nor a table \[gdml\]"):
        rp.load(tmp_path / "plain.toml")


def test_the_text_of_a_native_model_is_a_detector(tmp_path):
    text = "rayweave = 1\n[solid.a]\nsphere = { radius = 1 }\n"
    # it is read as a native model, not as XML
    with pytest.raises(RayweaveError, match=r"it has neither a table \[photons\] nor a table \[gdml\]"):
        rp.loads(text)
    text = """rayweave = 1
unit = "mm"
[solid.ball]
sphere = { radius = 5 }
[[region]]
solid = "ball"
medium = "glass"
[medium.glass]
[photons.medium.glass]
RINDEX = 1.5
"""
    (tmp_path / "ball.toml").write_text(text)
    loaded, read = rp.load(tmp_path / "ball.toml"), rp.loads(text)
    assert loaded.material("glass").refractive_index.at(500) == read.material("glass").refractive_index.at(500) == 1.5


def test_progress(bar):
    reported = []
    bar.simulate(from_middle(), n=9000, progress=lambda done, total: reported.append((done, total)))
    assert reported[-1] == (9000, 9000) and all(0 < done <= total for done, total in reported)
    reported.clear()
    for _ in bar.stream(from_middle(), n=9000, chunk=4000, progress=lambda *done: reported.append(done)):
        pass
    assert {(4000, 9000), (8000, 9000), (9000, 9000)} <= set(reported) and reported == sorted(reported)

    def stop(done, total):
        raise ValueError("enough")

    with pytest.raises(ValueError, match="enough"):
        bar.simulate(from_middle(), n=100, progress=stop)


def test_an_interrupt_stops_a_run(bar):
    # a shell without job control starts background processes with the signal ignored
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        timer = threading.Timer(0.5, _thread.interrupt_main)
        timer.start()
        begin = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            bar.simulate(rp.point([0, 0, 0], 550), n=2**32)
        assert time.monotonic() - begin < 60
        timer.join()
    finally:
        signal.signal(signal.SIGINT, handler)


def test_other_threads_run_meanwhile(bar):
    """A thread counts while photons are simulated: the GIL is released."""
    running, count = threading.Event(), 0
    running.set()

    def counting():
        nonlocal count
        while running.is_set():
            count += 1
            time.sleep(1e-4)

    thread = threading.Thread(target=counting)
    thread.start()
    before = count
    bar.simulate(from_middle(), n=20_000)
    after = count
    running.clear()
    thread.join()
    assert after - before > 5


def emissions(detector, source, n, **more):
    """The first rows of the histories of photons."""
    steps = detector.simulate(source, n=n, record="steps", max_steps=1, **more).histories
    first = np.isin(steps.named("process"), ["emission", "cerenkov", "scintillation"])
    return {name: getattr(steps, name)[first] for name in ("position", "direction", "polarisation", "time", "wavelength_nm")}


def test_torches_have_their_shapes(bar):
    n = 4000
    disc = emissions(bar, rp.disc([1, 2, -20], 5, 550, towards=[0, 0, 2], cone_degrees=30), n)
    radius = np.hypot(disc["position"][:, 0] - 1, disc["position"][:, 1] - 2)
    np.testing.assert_allclose(disc["position"][:, 2], -20, atol=1e-12)
    # the mean radius of a disc is 2/3 of it, with the variance r^2 / 18
    assert radius.max() <= 5 and abs(radius.mean() - 10 / 3) < 5 * 5 / math.sqrt(18 * n)
    cosine = disc["direction"][:, 2]
    lowest = math.cos(math.radians(30))
    assert cosine.min() >= lowest and abs(cosine.mean() - (1 + lowest) / 2) < 5 * (1 - lowest) / math.sqrt(12 * n)
    assert abs(emissions(bar, rp.disc([0, 0, 0], 5, 550, normal=[1, 0, 0]), 100)["position"][:, 0]).max() < 1e-12
    line = emissions(bar, rp.line([0, 0, -40], [0, 0, 40], ("uniform", 500, 600), polarisation=[1, 0, 0]), n)
    assert abs(line["position"][:, 2].mean()) < 5 * 80 / math.sqrt(12 * n) and abs(line["position"][:, :2]).max() == 0
    assert abs(line["wavelength_nm"].mean() - 550) < 5 * 100 / math.sqrt(12 * n)
    # in the plane of the vector and the direction
    across = np.cross(line["direction"], [1, 0, 0])
    np.testing.assert_allclose((across * line["polarisation"]).sum(axis=1), 0, atol=1e-12)
    inside = emissions(bar, rp.volume(bar, "Bar", 550), n)["position"]
    assert (abs(inside) <= [10, 10, 50]).all() and abs(inside[:, 2]).max() > 45
    on_faces = emissions(bar, rp.surface(bar, "Bar", 550), n)["position"]
    depth = np.min([10, 10, 50] - abs(on_faces), axis=1)
    assert (depth > 0).all() and depth.max() < 1.001e-6
    # four faces of 20 x 100 and two of 20 x 20
    ends = np.count_nonzero(50 - abs(on_faces[:, 2]) < 1e-5)
    assert abs(ends - n / 11) < 5 * math.sqrt(n * 10 / 121)


def test_spectra_and_pulses(bar):
    n = 20_000
    table = emissions(bar, rp.point([0, 0, 0], ("table", 400, 0, 500, 2, 600, 0)), n)["wavelength_nm"]
    # a triangle: mean 500, variance 100^2 / 6
    assert abs(table.mean() - 500) < 5 * 100 / math.sqrt(6 * n) and 400 <= table.min() and table.max() <= 600
    hot = emissions(bar, rp.point([0, 0, 0], ("black body", 3000, 400, 700)), n)["wavelength_nm"]
    grid = np.linspace(400, 700, 20_001)
    density = 1 / (grid**4 * np.expm1(1.438776877e7 / (grid * 3000)))
    expected = (grid * density).sum() / density.sum()
    assert abs(hot.mean() - expected) < 5 * hot.std() / math.sqrt(n)
    pulse = rp.point([0, 0, 0], 550, time=(3, 8), time_deviation=1, time_decay=2)
    times = emissions(bar, pulse, n)["time"]
    # means 5.5 + 0 + 2, variances 25 / 12 + 1 + 4
    assert abs(times.mean() - 7.5) < 5 * math.sqrt((25 / 12 + 5) / n)
    assert set(emissions(bar, rp.point([0, 0, 0], 550, time=4.0), 10)["time"]) == {4.0}


#: The bar of the guide with two components of scintillation and a wavelength shifter.
SCINTILLATING = BAR.replace(
    "</define>",
    """<matrix name="GREEN" coldim="2" values="2.1*eV 0 2.3*eV 1 2.5*eV 0"/><matrix name="BLUE" coldim="2" values="3*eV 1 3.2*eV 1"/>
<matrix name="T1" coldim="1" values="40*ns"/><matrix name="T2" coldim="1" values="900*ns"/><matrix name="Y1" coldim="1" values="0.25"/>
<matrix name="Y2" coldim="1" values="0.75"/></define>""",
).replace(
    '<property name="RINDEX" ref="INDEX"/>',
    """<property name="RINDEX" ref="INDEX"/><property name="WLSABSLENGTH" ref="LENGTH"/><property name="WLSCOMPONENT" ref="GREEN"/>
<property name="WLSTIMECONSTANT" ref="T1"/><property name="SCINTILLATIONCOMPONENT1" ref="BLUE"/>
<property name="SCINTILLATIONTIMECONSTANT1" ref="T1"/><property name="SCINTILLATIONYIELD1" ref="Y1"/>
<property name="SCINTILLATIONCOMPONENT2" ref="GREEN"/><property name="SCINTILLATIONTIMECONSTANT2" ref="T2"/>
<property name="SCINTILLATIONYIELD2" ref="Y2"/>""",
    1,
)


def test_scintillation_of_materials():
    detector, n = rp.loads(SCINTILLATING), 20_000
    crystal = detector.material("Crystal")
    assert crystal.properties["WLSCOMPONENT"].energy_ev.tolist() == pytest.approx([2.1, 2.3, 2.5])
    fast, slow = crystal.scintillation
    assert (fast.time_ns, fast.rise_time_ns, fast.share, slow.time_ns, slow.share) == (40, 0, 0.25, 900, 0.75)
    assert fast.spectrum.values.tolist() == [1, 1] and slow.spectrum.values.tolist() == [0, 1, 0]
    source = rp.point([0, 0, 0], ("scintillation", crystal), time=10)
    assert repr(source) == "<Source: point, scintillation of Crystal>"
    found = emissions(detector, source, n)
    blue = found["wavelength_nm"] < 450
    assert abs(np.count_nonzero(blue) - 0.25 * n) < 5 * math.sqrt(n * 0.25 * 0.75)
    for mean, times in ((40, found["time"][blue]), (900, found["time"][~blue])):
        assert abs(times.mean() - 10 - mean) < 5 * mean / math.sqrt(len(times))
    copy = pickle.loads(pickle.dumps(source))
    np.testing.assert_array_equal(emissions(detector, copy, 100)["time"], found["time"][:100])
    with pytest.raises(RayweaveError, match="the material `Opaque` has no scintillation light: it has no SCINTILLATIONCOMPONENT1"):
        rp.point([0, 0, 0], ("scintillation", detector.material("Opaque")))
    with pytest.raises(TypeError, match="scintillation needs a material"):
        rp.point([0, 0, 0], ("scintillation", "Crystal"))


def test_torches_are_those_of_the_command(bar, tmp_path):
    program = command()
    if program is None:
        pytest.skip("the command is not built")
    (tmp_path / "bar.gdml").write_text(BAR, encoding="utf-8")
    detector = rp.load(tmp_path / "bar.gdml")
    light = {"towards": [0, 0, 1], "cone_degrees": 60, "polarisation": [1, 1, 0], "time": (1, 2), "time_decay": 6}
    options = "--towards 0,0,1 --cone 60 --polarisation 1,1,0 --time 1:2 --time-decay 6"
    cases = [
        (rp.disc([0, 0, 0], 4, ("uniform", 500, 600), **light), "--source disc --at 0,0,0 --radius 4 --wavelength 500:600"),
        (rp.line([0, 0, -9], [0, 0, 9], 550, **light), "--source line --at 0,0,-9 --to 0,0,9 --wavelength 550"),
        (rp.volume(detector, "Bar", 550, **light), "--source volume --volume Bar --wavelength 550"),
        (rp.surface(detector, "Bar", ("black body", 4000, 500, 600), **light),
         "--source surface --volume Bar --black-body 4000 --wavelength 500:600"),
    ]
    for source, text in cases:
        arguments = ["photons", "bar.gdml", *text.split(), *options.split(), "-n", "1000", "-o", "c.csv"]
        subprocess.run([program, *arguments], cwd=tmp_path, check=True, capture_output=True)
        detector.simulate(source, n=1000).hits.save(tmp_path / "p.csv")
        assert (tmp_path / "c.csv").read_text() == (tmp_path / "p.csv").read_text(), text
        assert len((tmp_path / "p.csv").read_text().splitlines()) > 20, text
    (tmp_path / "bar.gdml").write_text(SCINTILLATING, encoding="utf-8")
    detector = rp.load(tmp_path / "bar.gdml")
    source = rp.volume(detector, "Bar", ("scintillation", detector.material("Crystal")))
    arguments = ["photons", "bar.gdml", *"--source volume --volume Bar --scintillation Crystal -n 1000 -o c.csv".split()]
    subprocess.run([program, *arguments], cwd=tmp_path, check=True, capture_output=True)
    detector.simulate(source, n=1000).hits.save(tmp_path / "p.csv")
    assert (tmp_path / "c.csv").read_text() == (tmp_path / "p.csv").read_text()


def genstep(kind, photons):
    """A step of 40 mm along z in Opticks' layout."""
    row = np.zeros((1, 6, 4), np.float32)
    row.view(np.uint32)[0, 0] = [kind, 1, 4, photons]
    row[0, 1] = [0, 0, -20, 2]
    row[0, 2] = [0, 0, 40, 40]
    row[0, 3, 1:] = [-1, 1, 290]
    row[0, 4, 0] = 1.03
    row[0, 5] = [0, 1, 1, 290]
    return row


def test_gensteps_are_a_source(bar):
    steps = np.concatenate([genstep(15, 300), genstep(15, 0), genstep(15, 700)])
    source = rp.gensteps(bar, steps, materials={4: "Crystal"})
    assert source.count == 1000 and "gensteps" in repr(source)
    assert source.notes and "Cerenkov photons: its RINDEX predicts" in source.notes[0]
    run = bar.simulate(source, record="steps")
    hits = run.hits
    assert hits.rows > 50
    np.testing.assert_array_equal(hits["genstep"], np.where(hits["photon"] < 300, 0, 2))
    assert "genstep" not in bar.simulate(from_middle(), n=100).hits
    assert run.histories.processes["cerenkov"] == 1000
    assert all(text.startswith("CK") for text in run.histories.sequences().texts)
    first = emissions(bar, source, 1000)
    np.testing.assert_allclose(first["direction"][:, 2], 1.03 / 1.79, atol=1e-6)
    assert (abs(first["position"][:, 2]) <= 20).all() and abs(first["position"][:, :2]).max() == 0
    # the layout of Geant4; 1/beta from the mean velocity
    row = [15, 0, 0, -20, 2, 4, 1000, -1, 40, C / 1.03, 0, 0, 0, 40, 1, 1]
    geant4 = rp.gensteps(bar, np.array([row], float))
    np.testing.assert_allclose(emissions(bar, geant4, 1000)["direction"][:, 2], 1.03 / 1.79, atol=1e-12)


def test_photons_of_other_programs(bar):
    hits = bar.simulate(from_middle(), n=500).hits
    photons = hits.to_opticks()
    # back into the bar: no light starts in the opaque diode
    photons[:, 0, :3] -= 0.1 * photons[:, 1, :3]
    again = rp.from_opticks(photons)
    assert again.count == hits.rows
    first = emissions(bar, again, hits.rows)
    np.testing.assert_allclose(first["wavelength_nm"], 550, rtol=1e-6)
    np.testing.assert_allclose(first["direction"], hits.direction, atol=1e-6)
    lamp = optics.source_of_rays(
        [[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 0, 1]] * 3, wavelength_nm=[500, 500, 600], power=[1.0, 2.0, 2.5]
    )
    source = rp.from_optics(lamp, 900)
    # in proportion to power times wavelength: 1 : 2 : 3
    x = emissions(bar, source, 900)["position"][:, 0]
    assert np.bincount(x.astype(int)).tolist() == [150, 300, 450]
    with pytest.raises(RayweaveError, match="the light is polarised"):
        rp.from_optics(lamp.polarised(1, 1, 0, 0), 10)
    with pytest.raises(TypeError, match=r"it must be a source of rayweave\.optics"):
        rp.from_optics(source, 10)


def test_measured_surfaces_have_tables(tmp_path):
    wrapped = BAR.replace(
        'finish="groundfrontpainted" type="dielectric_dielectric"', 'finish="groundtyvekair" type="dielectric_LUT"'
    )
    with pytest.raises(RayweaveError, match="RealSurface with GroundTyvek.z"):
        rp.loads(wrapped)
    ones = np.ones((37, 45, 91))
    from_array = rp.loads(wrapped, tables=rp.SurfaceTables().lut("groundtyvekair", ones))
    (tmp_path / "GroundTyvek.z").write_bytes(zlib.compress(b"1 " * ones.size))
    from_file = rp.loads(wrapped, tables=rp.SurfaceTables(tmp_path))
    runs = [detector.simulate(from_middle(), n=500, record="counts") for detector in (from_array, from_file)]
    assert runs[0].ends == runs[1].ends and same(runs[0].hits, runs[1].hits)
    assert runs[0].histories.surfaces["Wrapping"]["lut_reflection"] > 500
    dichroic = BAR.replace(
        'model="unified" finish="groundfrontpainted" type="dielectric_dielectric"',
        'model="dichroic" finish="polished" type="dielectric_dichroic"',
    )
    tables = rp.SurfaceTables().dichroic("Wrapping", [400, 700], [0, 90], np.full((2, 2), 25.0))
    counts = rp.loads(dichroic, tables=tables).simulate(from_middle(), n=4000, record="counts", max_steps=1).histories
    through, back = (counts.surfaces["Wrapping"].get(name, 0) for name in ("dichroic_transmission", "spike_reflection"))
    assert abs(through - 0.25 * (through + back)) < 5 * math.sqrt((through + back) * 3 / 16)
    for make, reason in [
        (lambda: rp.SurfaceTables().lut("S", np.ones((3, 3))), r"probabilities has shape \(3, 3\)"),
        (lambda: rp.SurfaceTables().davis("S", np.ones(3), np.ones(8)), "it has 3 reflectances, 90 are needed"),
        (lambda: rp.SurfaceTables().dichroic("S", [1, 2], [0, 1], [[0, 1], [2, 101]]), "the value 3"),
        (lambda: rp.SurfaceTables(dichroic=tmp_path / "none.dat"), "none.dat"),
    ]:
        with pytest.raises(RayweaveError, match=reason):
            make()
    with pytest.raises(TypeError, match="tables is 'folder'"):
        rp.loads(BAR, tables="folder")


def test_findings_are_a_table(bar):
    sensitive = BAR.replace('<solidref ref="DiodeBox"/>', '<solidref ref="DiodeBox"/><auxiliary auxtype="SensDet" auxvalue="D"/>')
    sound = rp.loads(sensitive).check()
    assert sound.rows == 0 and list(sound) == ["kind", "place", "text"], str(sound)
    assert "no volume behind it is a sensor" in str(bar.check())
    found = rp.loads(sensitive.replace("1.5*eV 400 4*eV 400", "1.5*eV 4e-6 4*eV 4e-6")).check()
    assert found.rows == 1 and found["kind"].tolist() == ["optical"]
    assert "`ABSLENGTH` of material `Crystal` are implausible" in found["text"][0] and found["text"][0] in str(found)
    assert re.fullmatch(r"\d+:\d+", found["place"][0])
    assert list(found.to_pandas().columns) == ["kind", "place", "text"]
    lost = bar.check_source(rp.line([0, 0, 0], [0, 0, 90], 550))
    assert "of the first 1000 photons end at once" in lost and bar.check_source(from_middle()) is None
    with pytest.raises(RayweaveError, match="which has no RINDEX"):
        bar.check_source(rp.point([0, 0, 90], 550))


def test_properties_are_drawn(bar):
    absorption = rp.loads(ABSORBER).material("Medium").absorption_length.plot().svg
    assert "ABSLENGTH / mm" in absorption and "wavelength / nm" in absorption
    assert bar.material("Crystal").plot().svg.count('class="curve"') == 3
    assert "EFFICIENCY" in bar.surface("Cathode").plot().svg
    assert bar.material("Opaque").plot().svg.startswith("<svg ")


def test_bad_torches_are_explained(bar):
    other = rp.loads(BAR)
    cases = [
        (lambda: rp.disc([0, 0, 0], 5, 550), "normal is missing"),
        (lambda: rp.disc([0, 0, 0], 0, 550, normal=[0, 0, 1]), "the radius of the source is 0 mm: it must be positive"),
        (lambda: rp.point([0, 0, 0], 550, cone_degrees=5), "cone_degrees is given without towards"),
        (lambda: rp.point([0, 0, 0], 550, towards=[0, 0, 1], cone_degrees=200), "it must be from 0 to 180"),
        (lambda: rp.point([0, 0, 0], 550, time=(2, 1)), "it must not end before it starts"),
        (lambda: rp.point([0, 0, 0], 550, time=(1, 2, 3)), "time has 3 numbers"),
        (lambda: rp.point([0, 0, 0], 550, time_decay=-1), "it must be finite and at least 0"),
        (lambda: rp.point([0, 0, 0], 550, towards=[0, 0, 1], polarisation=[0, 0, 2]), "parallel to the direction"),
        (lambda: rp.point([0, 0, 0], ("uniform", 600, 500)), "both must be positive and finite, and the first one smaller"),
        (lambda: rp.point([0, 0, 0], {500: 1.0}), "photons have no line spectra"),
        (lambda: rp.point([0, 0, 0], ("table", 500, 0, 600, 0)), "the spectrum is invalid"),
        (lambda: rp.volume(bar, "Baar", 550), "Did you mean `Bar`"),
        (lambda: rp.gensteps(bar, np.zeros((1, 6, 4))), "are not float32"),
        (lambda: rp.gensteps(bar, np.zeros((1, 5))), r"gensteps has shape \(1, 5\): it must be \(N, 6, 4\) or \(N, 16\)"),
        (lambda: rp.gensteps(bar, genstep(3, 1)), "genstep 0 is of the kind 3"),
        (lambda: rp.gensteps(bar, genstep(15, 1), materials={4: "Water"}), "no material is called `Water`"),
        (lambda: rp.from_opticks(np.zeros((3, 4))), r"photons has shape \(3, 4\): it must be \(N, 4, 4\)"),
        (lambda: bar.simulate(rp.volume(other, "Bar", 550), n=1), "the source belongs to another detector"),
    ]
    for make, reason in cases:
        with pytest.raises(RayweaveError, match=reason):
            make()
