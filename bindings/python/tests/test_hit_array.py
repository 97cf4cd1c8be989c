"""array_csg and count_array, compared with the original NumPy code and with their rules."""

import pickle
import threading

import numpy as np
import pytest

import rayweave
from rayweave import Operation, RayweaveError, array_csg, count_array

INF = np.inf
A = (1, 4, 5, 10)
B = (0, 2, 3, 5, 6, 7, 8, 9, 11, 12)


def merged(array1, array2, operation):
    """Entries in stable order and the count after each, as R. Frazier's "Efficient CSG" defines them."""
    both = np.concatenate((array1, array2))
    order = np.argsort(both, axis=0, kind="stable")
    leaves = (order & 1).astype(bool)
    if operation is Operation.DIFFERENCE:
        leaves ^= order >= len(array1)
    first = 1 if operation is Operation.DIFFERENCE else 0
    return np.take_along_axis(both, order, 0), first + np.cumsum(np.where(leaves, -1, 1), axis=0)


def oracle(array1, array2, operation, sort_output=True):
    """An independent array_csg: an entry is kept where the boolean function of the count changes."""
    times, count = merged(array1, array2, operation)
    inside = count >= (1 if operation is Operation.UNION else 2)
    if operation is Operation.UNION:
        kept = inside != np.concatenate((np.zeros_like(inside[:1]), inside[:-1]))
    else:
        kept = inside | np.roll(inside, 1, axis=0)
    hits = np.where(kept, times, np.asarray(INF, times.dtype))
    return np.sort(hits, axis=0) if sort_output else hits


def random_hits(rng, rows, columns, dtype=np.float64):
    """Columns with many ties, padding, and some entries of -inf."""
    hits = rng.integers(0, 12, (rows, columns)).astype(dtype)
    hits[rng.random((rows, columns)) < 0.2] = INF
    hits[rng.random((rows, columns)) < 0.05] = -INF
    return np.sort(hits, axis=0)


@pytest.mark.parametrize(
    ("operation", "expected"),
    [
        (Operation.UNION, (0, 10, 11, 12)),
        (Operation.INTERSECT, (1, 2, 3, 4, 5, 5, 6, 7, 8, 9)),
        (Operation.DIFFERENCE, (2, 3, 5, 6, 7, 8, 9, 10)),
    ],
)
def test_vectors_of_the_seed(operation, expected):
    padded = list(expected) + [INF] * (14 - len(expected))
    assert array_csg(A, B, operation).tolist() == padded
    one_column = array_csg(np.reshape(A, (-1, 1)), np.reshape(B, (-1, 1)), operation)
    assert one_column.shape == (14, 1)
    assert one_column[:, 0].tolist() == padded


def test_regularize_removes_the_double_five():
    expected = [1, 2, 3, 4, 6, 7, 8, 9] + [INF] * 6
    assert array_csg(A, B, Operation.INTERSECT, regularize=True).tolist() == expected
    assert array_csg(B, A, Operation.INTERSECT, regularize=True).tolist() == expected
    assert array_csg(A, B, Operation.INTERSECT, regularize=np.True_).tolist() == expected


def test_regularize_by_a_length_drops_short_pieces():
    hits = [0, 5, 5.5, 9, 20, 20.25]
    assert array_csg(hits, [], Operation.UNION, regularize=1).tolist() == [0, 9] + [INF] * 4
    assert array_csg(hits, [], Operation.UNION, regularize=0.3).tolist() == [0, 5, 5.5, 9, INF, INF]


@pytest.mark.parametrize("operation", Operation)
@pytest.mark.parametrize("sort_output", [True, False])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_agrees_with_numpy(rng, operation, sort_output, dtype):
    for rows1, rows2, columns in [(2, 2, 300), (4, 10, 50), (0, 6, 7), (6, 0, 7), (0, 0, 3), (4, 2, 0)]:
        a, b = random_hits(rng, rows1, columns, dtype), random_hits(rng, rows2, columns, dtype)
        hits = array_csg(a, b, operation, sort_output)
        assert hits.dtype == dtype
        np.testing.assert_array_equal(hits, oracle(a, b, operation, sort_output))


@pytest.mark.parametrize("operation", Operation)
def test_counts_agree_with_numpy(rng, operation):
    a, b = random_hits(rng, 4, 40), random_hits(rng, 6, 40)
    times, counts = count_array(a, b, operation)
    expected_times, expected_counts = merged(a, b, operation)
    np.testing.assert_array_equal(times, expected_times)
    np.testing.assert_array_equal(counts, expected_counts)
    assert counts.dtype == np.int64


@pytest.mark.parametrize(
    "layout",
    [
        np.asfortranarray,
        lambda x: np.flip(np.flip(x, 0).copy(), 0),
        lambda x: np.repeat(x, 2, axis=1)[:, ::2],
        lambda x: x.T.copy().T,
        lambda x: x[:, ::-1].copy()[:, ::-1],
        lambda x: x.astype(">f8"),
        lambda x: x.astype(np.longdouble),
        lambda x: x.tolist(),
    ],
)
def test_any_layout(rng, layout):
    a, b = random_hits(rng, 4, 30), random_hits(rng, 6, 30)
    expected = array_csg(a, b, Operation.DIFFERENCE)
    np.testing.assert_array_equal(array_csg(layout(a), layout(b), Operation.DIFFERENCE), expected)
    out = np.empty((10, 30))
    np.testing.assert_array_equal(array_csg(layout(a), b, Operation.DIFFERENCE, out=out), expected)


def test_fields_of_packed_records():
    record = np.zeros(4, dtype=[("flag", "i1"), ("t", "f8")])
    record["t"] = A
    assert array_csg(record["t"], B, Operation.UNION)[:4].tolist() == [0, 10, 11, 12]


def test_dtypes():
    single, double = np.float32([1, 2]), np.float64([1, 2])
    assert array_csg(single, single, Operation.UNION).dtype == np.float32
    for other in [double, [1, 2], np.array([1, 2]), np.array([1, 2], np.uint8), np.float16([1, 2])]:
        assert array_csg(single, other, Operation.UNION).dtype == np.float64
        assert array_csg(other, single, Operation.UNION).dtype == np.float64
    assert array_csg(np.float32([0.1, 3]), [0.2, 3], Operation.UNION)[0] == np.float64(np.float32(0.1))


@pytest.mark.parametrize(
    "bad",
    [[True, False], [1j, 2j], ["a", "b"], [None, 1], np.array([1, 2], object), "text", None, {1, 2}, 10**400],
)
def test_wrong_dtypes_are_type_errors(bad):
    with pytest.raises(TypeError, match="array2 (has dtype|is None)"):
        array_csg(A, bad, Operation.UNION)
    with pytest.raises(TypeError, match="array1 (has dtype|is None)"):
        array_csg(bad, A, Operation.UNION)


@pytest.mark.parametrize(
    ("a", "b", "message"),
    [
        ([1, 2, 3], A, "array1 has 3 rows"),
        (A, [1, np.nan], "array2 row 1, column 0 is NaN"),
        (A, [2, 1], "array2 row 1, column 0 is 1, less than 2"),
        ([[1, 1, 5], [2, 2, 4]], np.zeros((2, 3)), "array1 row 1, column 2 is 4, less than 5"),
        (np.zeros((2, 3)), np.zeros((2, 4)), "array1 has 3 columns and array2 has 4"),
        (np.zeros((2, 3)), A, r"array1 has shape \(2, 3\) and array2 has shape \(4,\)"),
        (np.zeros((2, 3, 1)), np.zeros((2, 3, 1)), r"array1 has shape \(2, 3, 1\)"),
        (3.0, A, r"array1 has shape \(\)"),
        ([[1], [2, 3]], A, "array1 is not an array of numbers"),
    ],
)
def test_bad_values_are_named(a, b, message):
    with pytest.raises(RayweaveError, match=message):
        array_csg(a, b, Operation.UNION)
    with pytest.raises(ValueError, match=message):
        count_array(a, b, Operation.UNION)


def test_bad_options():
    with pytest.raises(TypeError, match="operation is 1: "):
        array_csg(A, B, 1)
    with pytest.raises(RayweaveError, match="regularize needs sort_output"):
        array_csg(A, B, Operation.UNION, False, regularize=True)
    for length in [-1.0, INF, np.nan]:
        with pytest.raises(RayweaveError, match="min_sep"):
            array_csg(A, B, Operation.UNION, regularize=length)
    with pytest.raises(TypeError, match="regularize is"):
        array_csg(A, B, Operation.UNION, regularize="yes")
    with pytest.raises(TypeError):
        array_csg(A, B, Operation.UNION, True, True)


def test_out_is_written_in_place(rng):
    a, b = random_hits(rng, 4, 20), random_hits(rng, 2, 20)
    expected = array_csg(a, b, Operation.UNION)
    out = np.zeros((6, 20))
    assert array_csg(a, b, Operation.UNION, out=out) is out
    np.testing.assert_array_equal(out, expected)
    # every layout of out, and one that shares memory with an operand
    wide = np.zeros((12, 40), order="F")
    view = wide[::2, ::-2]
    assert array_csg(a, b, Operation.UNION, out=view) is view
    np.testing.assert_array_equal(view, expected)
    shared = np.zeros((6, 20))
    shared[:4] = a
    array_csg(shared[:4], b, Operation.UNION, out=shared)
    np.testing.assert_array_equal(shared, expected)


def test_out_must_fit():
    with pytest.raises(RayweaveError, match=r"out has shape \(13,\): the result has shape \(14,\)\."):
        array_csg(A, B, Operation.UNION, out=np.empty(13))
    with pytest.raises(TypeError, match="out is an array of dtype float32"):
        array_csg(A, B, Operation.UNION, out=np.empty(14, np.float32))
    with pytest.raises(TypeError, match="out is "):
        array_csg(A, B, Operation.UNION, out=[0.0] * 14)
    frozen = np.zeros(14)
    frozen.flags.writeable = False
    with pytest.raises(RayweaveError, match="read-only"):
        array_csg(A, B, Operation.UNION, out=frozen)
    with pytest.raises(RayweaveError, match="read-only"):
        array_csg(np.float32(A), np.float32(B), Operation.UNION, out=np.broadcast_to(np.float32(0), 14))
    # nothing is written after an error
    out = np.full(14, 7.0)
    with pytest.raises(RayweaveError):
        array_csg(A, B[::-1], Operation.UNION, out=out)
    assert (out == 7).all()


def test_operations_keep_the_seeds_numbers():
    assert [(op.name, op.value) for op in Operation] == [("UNION", 1), ("INTERSECT", 2), ("DIFFERENCE", 3)]
    assert pickle.loads(pickle.dumps(Operation.UNION)) is Operation.UNION
    error = pickle.loads(pickle.dumps(RayweaveError("text")))
    assert isinstance(error, rayweave.RayweaveError) and str(error) == "text"


def test_other_threads_run_meanwhile(rng):
    """The interpreter is not blocked while arrays are combined."""
    a = np.sort(rng.random((40, 20_000)), axis=0)
    turns, done = 0, threading.Event()

    def work():
        for _ in range(3):
            array_csg(a, a, Operation.UNION)
        done.set()

    worker = threading.Thread(target=work)
    worker.start()
    while not done.is_set():
        turns += 1
    worker.join()
    assert turns > 100


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_threads_give_the_same_bits(rng, dtype, monkeypatch):
    a, b = random_hits(rng, 4, 70_001, dtype), random_hits(rng, 4, 70_001, dtype)
    alone = array_csg(a, b, Operation.UNION, threads=1)
    np.testing.assert_array_equal(alone, oracle(a, b, Operation.UNION))
    for threads in [2, 3, np.int64(5), None]:
        assert array_csg(a, b, Operation.UNION, threads=threads).tobytes() == alone.tobytes()
    monkeypatch.setenv("RAYWEAVE_THREADS", "3")
    assert array_csg(a, b, Operation.UNION).tobytes() == alone.tobytes()
    # every seventh ray, so that rays are not contiguous in memory
    assert array_csg(a[:, ::7], b[:, ::7], Operation.UNION).tobytes() == alone[:, ::7].tobytes()


def test_bad_threads():
    with pytest.raises(RayweaveError, match="threads is 0"):
        array_csg(A, B, Operation.UNION, threads=0)
    with pytest.raises(TypeError, match="threads is"):
        array_csg(A, B, Operation.UNION, threads="two")


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_the_first_bad_ray_of_many_is_named(rng, dtype):
    a = random_hits(rng, 4, 70_001, dtype)
    bad = a.copy()
    bad[2, [60_000, 69_990]] = np.nan
    for threads in [1, 4]:
        with pytest.raises(RayweaveError, match="array2 row 2, column 60000 is NaN"):
            array_csg(a, bad, Operation.UNION, threads=threads)
