"""Crossings of aspheres, compared with an independent root finder: eigenvalues of companion matrices (LAPACK)."""

import os

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import NDArray

import rayweave

#: 50 makes it a million rays.
EFFORT = int(os.environ.get("RAYWEAVE_EFFORT", "1"))

#: Curvature, conic constant and coefficients of r^2, r^4, r^6 in an aperture of radius 1.
ASPHERES = [
    (0.6, -0.5, (0.0, 0.4, -0.3)),
    (0.9, 0.0, (0.3, -1.2, 0.9)),
    (-0.7, 0.5, (-0.5, 2.0, -1.4)),
    (0.8, -3.0, (0.0, -2.0, 2.2)),
    (0.3, 4.0, (1.5, -6.0, 5.0)),
]


def products(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """The products of polynomials, row by row."""
    product = np.zeros((len(a), a.shape[1] + b.shape[1] - 1))
    for k in range(a.shape[1]):
        product[:, k : k + b.shape[1]] += a[:, k : k + 1] * b
    return product


def added(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    both = np.zeros((len(a), max(a.shape[1], b.shape[1])))
    both[:, : a.shape[1]] += a
    both[:, : b.shape[1]] += b
    return both


def rays(count: int, rng: np.random.Generator) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Through the aperture, with t = 0 nearest to the axis and 1 unit of t across it."""
    angle, side = rng.uniform(0, 2 * np.pi, count), rng.uniform(-0.95, 0.95, count)
    across = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    origins = np.stack([-side * across[:, 1], side * across[:, 0], rng.uniform(-0.7, 0.9, count)], axis=1)
    slope = rng.choice([0.02, 0.3, 2.0], count) * rng.standard_normal(count)
    return origins, np.column_stack([across, slope])


def test_as_many_crossings_as_eigenvalues() -> None:
    rng = np.random.default_rng(20)
    decided = set_aside = crossings = 0
    for c, k, even in ASPHERES:
        for _ in range(EFFORT):
            origins, directions = rays(4000, rng)
            solid = rayweave.asphere(aperture=1.0, curvature=c, conic=k, even=list(even), height=50.0)
            found = solid.crossings(origins, directions)
            names = np.array(found.surface_names)[found.surface]
            on = np.char.endswith(names.astype(str), "surface")
            # (c - g L)^2 = c^2 (1 - g v) with L = z less the terms, v = r^2 and g = (1 + k) c^2
            v = np.column_stack([(origins[:, :2] ** 2).sum(1), np.zeros(4000), np.ones(4000)])
            height, power = np.column_stack([origins[:, 2], directions[:, 2]]), v
            for coefficient in even:
                height = added(height, -coefficient * power)
                power = products(power, v)
            g = (1 + k) * c * c
            m = added(np.full((4000, 1), c), -g * height)
            whole = added(products(m, m), added(np.full((4000, 1), -c * c), c * c * g * v))
            companion = np.zeros((4000, whole.shape[1] - 1, whole.shape[1] - 1))
            companion[:, 1:, :-1] = np.eye(whole.shape[1] - 2)
            companion[:, :, -1] = -whole[:, :-1] / whole[:, -1:]
            roots = np.linalg.eigvals(companion)
            for ray in range(4000):
                real = roots[ray][np.abs(roots[ray].imag) < 1e-4]
                half = np.sqrt(1 - v[ray, 0])
                inside = real[np.abs(real.real) < half + 1e-4]
                times = np.sort(inside.real)
                sheet = polynomial.polyval(times, m[ray]) / c
                # exclude roots that nearly coincide, at the rim, or where the conic turns back: neither method is
                # reliable there
                unclear = (np.abs(inside.imag) > 1e-12).any() or (np.diff(times) < 1e-4).any()
                unclear |= bool((np.abs(np.abs(times) - half) < 1e-4).any() or (np.abs(sheet) < 1e-6).any())
                if unclear:
                    set_aside += 1
                    continue
                mine = found.t[found.offsets[ray] : found.offsets[ray + 1]]
                mine = mine[on[found.offsets[ray] : found.offsets[ray + 1]]]
                expected = times[(sheet > 0) & (np.abs(times) < half)]
                assert len(mine) == len(expected), (c, k, even, origins[ray], directions[ray], mine, expected)
                assert np.abs(mine - expected).max(initial=0.0) < 1e-7
                decided, crossings = decided + 1, crossings + len(mine)
    print(f"{decided} rays decided with {crossings} crossings, {set_aside} set aside")
    assert decided > 50 * set_aside and 2 * crossings > decided
