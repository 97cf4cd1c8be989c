"""Light in batches, written to files and read from files; and tables that share memory."""

import signal
import threading
import _thread
import time

import numpy as np
import pytest

import rayweave.optics as ro
from rayweave import RayweaveError

pyarrow = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")


def bench():
    """A lens in front of a screen."""
    lens = ro.lens(60, -60, 5, aperture=20.0, name="lens", material="N-BK7")
    screen = ro.detector(40, name="screen").translate([0, 0, 60])
    return ro.System([lens, screen])


def beams(count=20_000):
    line = ro.beam(8.0, count, wavelength_nm={486.1: 1.0, 656.3: 2.0}).translate([0, 0, -20])
    return [line, ro.lamp(1, 1, 3000, max_degrees=10, wavelength_nm=550.0, seed=5).translate([0, 0, -30])]


SETTINGS = {"branches": "both", "threshold": 1e-7}


def test_batches_equal_the_trace():
    system = bench()
    whole = system.trace(beams(), **SETTINGS)
    stream = system.stream(beams(), rows=50_000, **SETTINGS)
    with pytest.raises(RayweaveError, match="take all batches"):
        stream.balance  # noqa: B018
    parts = list(stream)
    assert len(parts) > 2 and all(part.rows >= 50_000 for part in parts[:-1])
    for name in whole:
        joined = np.concatenate([part[name] for part in parts])
        np.testing.assert_array_equal(joined, whole[name], err_msg=name)
    assert stream.balance == whole.balance
    assert abs(stream.balance.error) < 1e-9 * whole.balance.emitted
    with pytest.raises(RayweaveError, match="a batch has no balance"):
        parts[0].balance  # noqa: B018


@pytest.mark.parametrize("kind", ["parquet", "csv", "npy"])
def test_files_contain_the_trace(tmp_path, kind):
    system = bench()
    whole = system.trace(beams(2000), **SETTINGS)
    reported = []
    path = tmp_path / f"light.{kind}"
    balance = system.trace_to(
        path, beams(2000), rows=5000, progress=lambda done, total: reported.append((done, total)), **SETTINGS
    )
    assert balance == whole.balance
    assert reported[-1] == (5000, 5000) and all(done <= total == 5000 for done, total in reported)
    names = {"element": system.element_names, "surface": system.surface_names}
    if kind == "parquet":
        file = parquet.ParquetFile(path)
        assert file.num_row_groups > 2
        assert file.schema_arrow.metadata[b"unit.x0"] == b"mm"
        table = file.read()
        found = {name: np.array(table[name].to_pylist()) for name in whole}
    elif kind == "csv":
        csv = pytest.importorskip("pyarrow.csv")
        table = csv.read_csv(path)
        found = {name: np.array(table[name].to_pylist()) for name in whole}
    else:
        table = np.load(path)
        found = {name: table[name] for name in whole}
    for name, column in whole.items():
        if name in names and kind != "npy":
            expected = np.array([None if k < 0 else names[name][k] for k in column])
            values = np.array([value or None for value in found[name]])
            np.testing.assert_array_equal(values, expected, err_msg=name)
        elif name == "event" and kind != "npy":
            assert set(found[name]) <= {"split", "absorbed", "escaped", "totally reflected", "transmitted"}
        elif name in names:
            np.testing.assert_array_equal(found[name].astype(np.int32), column, err_msg=name)
        else:
            np.testing.assert_array_equal(found[name].astype(float), column, err_msg=name)
    assert sorted(p.name for p in tmp_path.iterdir() if "names" not in p.name) == [path.name]


def test_an_unfinished_file_does_not_exist(tmp_path):
    def stop(done, total):
        raise ValueError("enough")

    for kind in ("parquet", "csv"):
        with pytest.raises(ValueError, match="enough"):
            bench().trace_to(tmp_path / f"a.{kind}", beams(200_000), rows=1000, progress=stop)
        assert list(tmp_path.iterdir()) == []
    with pytest.raises(RayweaveError, match="table format is unknown"):
        bench().trace_to(tmp_path / "a.txt", beams(10))


def test_an_interrupt_stops_a_stream():
    stream = bench().stream(ro.beam(8.0, 500_000_000).translate([0, 0, -20]), rows=1 << 40)
    # a shell without job control starts background processes with the signal ignored
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        timer = threading.Timer(0.3, _thread.interrupt_main)
        timer.start()
        begin = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            next(iter(stream))
        assert time.monotonic() - begin < 30
        timer.join()
    finally:
        signal.signal(signal.SIGINT, handler)


def test_leaving_early():
    with bench().stream(ro.beam(8.0, 500_000_000).translate([0, 0, -20]), rows=1000) as stream:
        first = next(iter(stream))
    assert first.rows >= 1000
    with pytest.raises(RayweaveError, match="rows is 0"):
        bench().stream(beams(), rows=0)


def address(array):
    return array.__array_interface__["data"][0]


def test_tables_share_memory():
    trace = bench().trace(beams(1000))
    table = trace.to_arrow()
    for name in trace:
        assert table[name].chunk(0).buffers()[1].address == address(trace[name]), name
    batch = trace.to_arrow(names=True)
    assert batch["x1"].chunk(0).buffers()[1].address == address(trace["x1"])
    assert set(batch["element"].to_pylist()) <= {"lens", "screen", None}
    pandas = pytest.importorskip("pandas")
    frame = trace.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and list(frame) == list(trace)
    # a frame can be changed, and has copies
    assert not any(np.shares_memory(frame[name].to_numpy(), trace[name]) for name in trace)
    polars = pytest.importorskip("polars")
    frame = trace.to_polars()
    assert isinstance(frame, polars.DataFrame) and frame.columns == list(trace)
    for name in trace:
        assert address(frame[name].to_numpy(allow_copy=False)) == address(trace[name]), name


def test_a_bar(capsys):
    bench().trace(beams(100), progress=True)
    assert "100 %" in capsys.readouterr().err


MODEL = """
rayweave = 1
unit = "cm"
[parameters]
R = 6
[solid.front]
sphere = { radius = "R" }
transform = [{ translate = [0, 0, "R - 0.25"] }]
[solid.back]
sphere = { radius = "R" }
transform = [{ translate = [0, 0, "0.25 - R"] }]
[solid.lens]
expr = "front & back"
[[region]]
solid = "lens"
medium = "glass"
[medium.glass]
[optics]
branches = "both"
threshold = 1e-6
[optics.medium]
glass = "N-BK7"
[optics.face]
lens = { coated = [[1.38, 0, 99.6]] }
[[optics.sheet]]
name = "screen"
circle = 3
action = "absorb"
transform = [{ translate = [0, 0, 6] }]
[[optics.source]]
beam = { circle = 1, rays = 500 }
wavelength_nm = 550
transform = [{ translate = [0, 0, -2] }]
"""


def test_models_of_files(tmp_path):
    (tmp_path / "lens.toml").write_text(MODEL)
    model = ro.load(tmp_path / "lens.toml")
    assert model.system.element_names == ["lens", "screen"] and model.system.unit == "cm"
    assert model.settings["branches"] == "both" and model.settings["threshold"] == 1e-6
    trace = model.trace()
    # a quarter of a wave of magnesium fluoride: each face reflects ((n - 1.38^2) / (n + 1.38^2))^2
    n = ro.glass("N-BK7").index(550.0)
    r = ((n - 1.38**2) / (n + 1.38**2)) ** 2
    arrived = trace.balance.absorbed["screen"]
    assert arrived == pytest.approx((1 - r) ** 2, rel=1e-3)
    assert trace.spot("screen").rms_radius < 0.1
    np.testing.assert_array_equal(model.trace(threads=1)["x1"], trace["x1"])
    # the same elements keep their coating in a system created in Python
    again = ro.System(model.system.elements, unit="cm").trace(model.sources, **model.settings)
    assert again.balance.absorbed["screen"] == arrived
    moved = ro.System([element.translate([0, 1, 0]) for element in model.system.elements], unit="cm")
    source = model.sources[0].translate([0, 1, 0])
    shifted = moved.trace(source, **model.settings)
    assert shifted.balance.absorbed["screen"] == pytest.approx(arrived, abs=1e-12)
    assert shifted.spot("screen").centroid == pytest.approx([0, 0], abs=1e-4)
    bare = [element.with_finish(ro.polished()) for element in model.system.elements[:1]]
    plain = ro.System([*bare, model.system.elements[1]], unit="cm").trace(model.sources, **model.settings)
    bare_r = ((n - 1) / (n + 1)) ** 2
    assert plain.balance.absorbed["screen"] == pytest.approx((1 - bare_r) ** 2, rel=2e-3)
    balance = model.trace_to(tmp_path / "light.parquet")
    assert balance == trace.balance
    flat = ro.load(tmp_path / "lens.toml", {"R": 60})
    assert flat.trace().spot("screen").rms_radius > 0.2


def test_problems_of_files(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text(MODEL.replace("threshold", "treshold").replace('"N-BK7"', '"N-BK77"'))
    with pytest.raises(RayweaveError) as problem:
        ro.load(path)
    text = str(problem.value)
    assert "bad.toml:20:1" in text and "Did you mean `threshold`?" in text and "N-BK7?" in text
    with pytest.raises(FileNotFoundError, match="none.toml"):
        ro.load(tmp_path / "none.toml")
    with pytest.raises(RayweaveError, match=r"no \[optics\] table"):
        ro.loads("rayweave = 1\n[solid.a]\nsphere = { radius = 1 }\n")
    with pytest.raises(RayweaveError, match="R"):
        ro.loads(MODEL, {"R": "S"})


def test_sources_of_rays_and_files(tmp_path):
    origins = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0]])
    source = ro.source_of_rays(origins, [[0, 0, 2]] * 3, wavelength_nm=[400, 500, 600], power=[1, 2, 3])
    starts, ways, lengths, powers = source.rays()
    np.testing.assert_array_equal(starts, origins)
    np.testing.assert_array_equal(ways, [[0, 0, 1]] * 3)
    assert lengths.tolist() == [400, 500, 600] and powers.tolist() == [1, 2, 3]
    even = ro.source_of_rays(origins, [[0, 0, 1]] * 3, wavelength_nm=550.0, power=("total", 6.0))
    assert even.rays()[2].tolist() == [550] * 3 and even.rays()[3].tolist() == [2] * 3
    rows = np.column_stack([origins, ways, lengths, powers])
    np.save(tmp_path / "light.npy", rows)
    read = ro.source_from_file(tmp_path / "light.npy")
    for found, expected in zip(read.rays(), source.rays(), strict=True):
        np.testing.assert_array_equal(found, expected)
    np.save(tmp_path / "rays.npy", rows[:, :6])
    plain = ro.source_from_file(tmp_path / "rays.npy", wavelength_nm=700.0, power=("total", 3.0))
    assert plain.rays()[2].tolist() == [700] * 3 and plain.rays()[3].tolist() == [1] * 3
    (tmp_path / "bad.csv").write_text("ox,oy,oz,dx,dy,dz,power\n0,0,0,0,0,0,1\n0,0,0,0,0,1,-1\n")
    with pytest.raises(RayweaveError) as problem:
        ro.source_from_file(tmp_path / "bad.csv")
    assert "bad.csv:2: dx, dy and dz are all 0" in str(problem.value) and "power is -1" in str(problem.value)
    with pytest.raises(RayweaveError, match="wavelength_nm"):
        ro.source_of_rays(origins, [[0, 0, 1]] * 3, wavelength_nm=[400, np.nan, 600])


def test_polarised_sources():
    filter_ = ro.polariser(30.0, aperture=20.0, name="filter").translate([0, 0, 5])
    system = ro.System([filter_, ro.detector(20, name="screen").translate([0, 0, 9])])
    light = ro.beam(4.0, 50)
    through = lambda source: system.trace(source, polarised=True).balance.absorbed["screen"]  # noqa: E731
    assert through(light) == pytest.approx(0.5)
    assert through(light.polarised(1, 1, 0, 0)) == pytest.approx(0.75)
    assert through(light.polarised(1, 0, 0, 1)) == pytest.approx(0.5)
    with pytest.raises(RayweaveError, match="stokes"):
        light.polarised(1, 1, 1, 0)


def test_phases_are_columns_on_request(tmp_path):
    # 360 degrees per wavelength of the path, no jumps where light is transmitted
    plate = ro.lens(np.inf, np.inf, 2, aperture=20.0, name="plate", material=1.5)
    system = ro.System([plate, ro.detector(20, name="screen").translate([0, 0, 5])])
    light = ro.beam(4, 3000, wavelength_nm=550).translate([0, 0, -3])
    trace = system.trace(light, phases=True)
    expected = 360 * (trace["path"] * 1e6 / 550 % 1)
    for name in ("phase_s", "phase_p"):
        away = (trace[name] - expected + 180) % 360 - 180
        assert np.abs(away).max() < 1e-5
        with system.stream(light, rows=2000, phases=True) as batches:
            found = np.concatenate([batch[name] for batch in batches])
        np.testing.assert_array_equal(found, trace[name])
        assert name not in system.trace(light)
    system.trace_to(tmp_path / "rays.parquet", light, phases=True)
    table = parquet.read_table(tmp_path / "rays.parquet")
    np.testing.assert_array_equal(table["phase_s"].to_numpy(), trace["phase_s"])
    assert table.schema.metadata[b"unit.phase_s"] == b"deg"
    system.trace_to(tmp_path / "rays.csv", light, phases=True)
    head = (tmp_path / "rays.csv").read_text().splitlines()[0]
    assert head.endswith("event,phase_s,phase_p")


def in_threads(count, work):
    """The results of `work`, executed by several threads at once; an exception in one of them is raised here."""
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(count) as pool:
        return [future.result(timeout=60) for future in [pool.submit(work) for _ in range(count)]]


def test_threads_share_a_stream():
    system = bench()
    whole = system.trace(beams(), **SETTINGS)
    stream = system.stream(beams(), rows=4_000, **SETTINGS)
    parts = [part for some in in_threads(4, lambda: list(stream)) for part in some]
    assert sum(part.rows for part in parts) == whole.rows
    # each batch has consecutive rows
    parts.sort(key=lambda part: part["id"][0])
    np.testing.assert_array_equal(np.concatenate([part["id"] for part in parts]), whole["id"])
    np.testing.assert_array_equal(np.concatenate([part["x1"] for part in parts]), whole["x1"])
    assert stream.balance == whole.balance


def test_a_closed_stream_ends_in_all_threads():
    stream = bench().stream(beams(2_000_000), rows=1_000, **SETTINGS)
    taken = threading.Semaphore(0)

    def work():
        count = 0
        for _ in stream:
            count += 1
            taken.release()
            if count == 3:
                stream.close()
        return count

    counts = in_threads(4, work)
    assert sum(counts) >= 3
    assert list(stream) == []
    with pytest.raises(RayweaveError, match="take all batches before"):
        stream.balance  # noqa: B018


def test_arrays_that_would_not_fit_into_memory_are_refused():
    with pytest.raises(RayweaveError, match="has 1000000000000000 rays: arrays hold at most"):
        ro.beam(1.0, 10**15).rays()
    with pytest.raises(RayweaveError, match="lenslets: at most"):
        ro.lenslet_array(5.0, 1.0, 0.1, 60_000, 60_000)
