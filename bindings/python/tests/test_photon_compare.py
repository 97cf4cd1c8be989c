"""Comparison of runs of photons: samples, files, arrays of Opticks, and Geant4 where it is installed."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import rayweave.photons as rp
from rayweave import RayweaveError

ROOT = Path(__file__).resolve().parents[3]
GUIDE = (ROOT / "docs/guides/photons.md").read_text(encoding="utf-8")
BAR = re.search(r"^```xml\n(.*?)^```$", GUIDE, re.MULTILINE | re.DOTALL)[1]
SCRIPTS = ROOT / "bindings/python/benchmarks"


@pytest.fixture(scope="module")
def bar():
    return rp.loads(BAR)


def simulate(bar, seed, n=2000):
    return bar.simulate(rp.point([0, 0, 0], 550), n=n, seed=seed, record="steps")


def test_runs_of_one_distribution(bar):
    a, b = simulate(bar, 1), simulate(bar, 2)
    comparison = rp.compare(a.histories, b.histories)
    assert comparison.photons == (2000, 2000) and not comparison.is_same_run and comparison.equality is None
    assert set(comparison.quantities) == {"history", "end", "volume", "time", "wavelength"}
    assert comparison["history"].ndf > 10 and comparison["history"].p > 1e-3
    assert sum(own.counts[0] for own in comparison["history"].bins) == 2000
    assert comparison["wavelength"].ndf == 0 and np.isnan(comparison["wavelength"].chi2_per_ndf)
    assert "history" in str(comparison)


def test_the_same_run(bar, tmp_path):
    a = simulate(bar, 1)
    a.histories.save(tmp_path / "a.csv")
    comparison = rp.compare(a.histories, tmp_path / "a.csv")
    assert comparison.is_same_run and comparison.equal_histories == 2000 and comparison.first_difference is None
    assert comparison.worst_z <= 0 and comparison["history"].chi2 == 0
    assert "are equal: 2000 photons, one by one, in history, end," in comparison.equality
    assert str(comparison).endswith(comparison.equality)
    other = bar.simulate(rp.point([0, 0, 0], 550), n=2000, seed=1, record="steps", max_steps=20)
    first = rp.compare(a.histories, other.histories).first_difference
    # the first photon with more than 20 steps ends at the limit
    steps = np.bincount(a.histories["photon"]) - 1
    assert first.photon == np.flatnonzero(steps > 20)[0] and first.row == 21
    assert first.histories[1].endswith("step_limit")


def test_arrays_of_opticks(bar):
    a, b = simulate(bar, 1), simulate(bar, 3)
    hits = rp.compare(a.hits.to_opticks(), b.hits)
    assert hits.is_hits and hits.photons == (a.hits.rows, b.hits.rows)
    assert hits.hits_z == pytest.approx((a.hits.rows - b.hits.rows) / (a.hits.rows + b.hits.rows) ** 0.5)
    assert hits["time"].p > 1e-3
    words = simulate(bar, 1).histories
    flags = rp.compare(words, b.histories, flags=True)
    assert flags["history"].bins[0].label.startswith("TO ")


def test_recorded_sequences_are_compared(bar):
    def run(seed, record):
        return bar.simulate(rp.point([0, 0, 0], 550), n=2000, seed=seed, record=record).histories

    own, other = run(1, "sequences"), run(2, "sequences")
    for a in (own, own.sequences()):
        found = rp.compare(a, other)
        assert found.photons == (2000, 2000) and found["history"].p > 1e-3
    # sequences of the same photons are those of the steps
    same = rp.compare(own, run(1, "steps"), flags=True)
    assert same["history"].chi2 == 0 and same["history"].ndf > 5
    with pytest.raises(RayweaveError, match='a record of counts has no histories'):
        rp.compare(own, run(2, "counts"))


def test_hits_are_fractions_of_the_photons(bar):
    a, b = (bar.simulate(rp.point([0, 0, 0], 550), n=n, seed=n).hits for n in (2000, 6000))
    z = rp.compare(a, b, photons=(2000, 6000)).hits_z
    pooled = (a.rows + b.rows) / 8000
    expected = (a.rows / 2000 - b.rows / 6000) / (pooled * (1 - pooled) * (1 / 2000 + 1 / 6000)) ** 0.5
    assert z == pytest.approx(expected) and abs(z) < 4 < abs(rp.compare(a, b).hits_z)
    with pytest.raises(RayweaveError, match="5 photons are stated"):
        rp.compare(a, b, photons=(2000, 5))


def test_errors(bar, tmp_path):
    with pytest.raises(FileNotFoundError, match="no such file"):
        rp.compare(tmp_path / "a.csv", tmp_path / "b.csv")
    with pytest.raises(RayweaveError, match="a int cannot be compared"):
        rp.compare(3, tmp_path / "b.csv")
    with pytest.raises(RayweaveError, match="at least 1"):
        rp.compare(simulate(bar, 1, 100).histories, simulate(bar, 2, 100).histories, least=0)
    (tmp_path / "b.csv").write_text("")
    with pytest.raises(RayweaveError, match=r"photons of Opticks have \(n, 4, 4\)"):
        rp.compare(np.zeros((3, 4), np.float32), tmp_path / "b.csv")


@pytest.mark.skipif(importlib.util.find_spec("geant4_pybind") is None, reason="the package geant4-pybind is not installed")
@pytest.mark.parametrize("name", ["absorption", "ground_unified", "wls"])
def test_geant4(name, tmp_path):
    sys.path.insert(0, str(SCRIPTS))
    import history_detectors

    path, wavelength, at = history_detectors.write(tmp_path, name)
    place = ",".join(map(str, at))
    command = [sys.executable, SCRIPTS / "geant4_histories.py", path, f"--at={place}", "--wavelength", str(wavelength)]
    command += ["-n", "2000", "--seed", "5", "--max-steps", "100", "-o", tmp_path / "geant4.csv"]
    subprocess.run(list(map(str, command)), check=True, stdin=subprocess.DEVNULL, capture_output=True)
    run = rp.load(path).simulate(rp.point(at, wavelength), n=2000, seed=3, max_steps=100, record="steps")
    comparison = rp.compare(run.histories, tmp_path / "geant4.csv")
    assert comparison.worst_z < 4, str(comparison)
