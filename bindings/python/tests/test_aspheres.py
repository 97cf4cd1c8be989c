"""Aspheres from Python: components, prescriptions, tolerances and optimisation, compared with closed forms."""

import numpy as np
import pytest

import rayweave
from rayweave import optics

N = 1.5


def plano_convex(conic: float = -N * N, diameter: float = 20.0, even: tuple[float, ...] = ()) -> optics.Prescription:
    """Light that leaves glass through a hyperboloid with k = -n^2 is focused to a point (R. Descartes, 1637)."""
    return optics.Prescription(
        [
            optics.Surface(np.inf, 8.0, N),
            optics.Surface(-30.0, 30.0 / (N - 1.0), "air", conic, even=even),
        ],
        entrance_pupil_diameter=diameter,
    )


def test_the_optimiser_finds_the_hyperboloid() -> None:
    goals = [optics.goal("spot", field=0, wavelength_nm=587.5618)]
    found = optics.optimise(plano_convex(0.0), ["conic 2"], goals)
    assert found.has_converged
    assert found.values["conic 2"] == pytest.approx(-N * N, abs=1e-7)
    # if the sphere is fixed, the term in r^4 replaces that of the conic: k c^3 / 8
    small = plano_convex(0.0, 6.0)
    terms = optics.optimise(small, ["r^4 2", "r^6 2", "r^8 2"], goals).values
    assert terms["r^4 2"] == pytest.approx(-N * N * (-1 / 30.0) ** 3 / 8, rel=1e-3)


def test_the_sensitivity_of_a_term_is_its_derivative() -> None:
    trials = optics.tolerance(plano_convex(), {"r^2 2": 1e-9, "conic 2": 1e-3}, "focal length", trials=5)
    slope, by_conic = trials.sensitivities["slope"]
    assert slope == pytest.approx(2 * (30.0 / (N - 1)) ** 2 * (N - 1), rel=1e-5)
    assert by_conic == 0.0
    assert trials.units["r^2 2"] == "1/mm"
    assert trials["lost"].tolist() == [0] * 5


def test_rays_that_a_rim_blocks_are_counted() -> None:
    lens = plano_convex().with_surface(1, semi_diameter=8.0)
    # 20 rings at the nodes of a Gaussian quadrature in r^2, each of 44 rays
    count, squares = 20 * 44, (np.polynomial.legendre.leggauss(20)[0] + 1) / 2
    for vignette, share in ((False, 0.0), (True, np.mean(squares > 0.8**2))):
        trials = optics.tolerance(lens, {"r^4 2": 1e-12}, trials=2, rings=20, vignette=vignette)
        assert trials["lost"] / count == pytest.approx([share] * 2, abs=0.03)


def test_terms_survive_files_and_changes() -> None:
    lens = plano_convex(even=(0.0, 1e-7, -2e-10))
    assert lens.surfaces[1].even == (0.0, 1e-7, -2e-10)
    assert lens.surfaces[0].even == () == lens.surfaces[1].odd
    again = optics.Prescription.from_zmx(lens.to_zmx())
    assert again.surfaces[1].even == lens.surfaces[1].even
    odd = lens.with_surface(2, odd=(1e-3, 2e-5))
    assert optics.Prescription.from_zmx(odd.to_zmx()).surfaces[1].odd == (1e-3, 2e-5)
    assert odd.with_surface(1, thickness=9.0).surfaces[1].odd == (1e-3, 2e-5)
    with pytest.raises(rayweave.RayweaveError, match="even has 9 coefficients"):
        plano_convex(even=(0.0,) * 9)


def test_a_lens_of_terms_focuses_as_the_conic_does() -> None:
    """The series of the hyperboloid to r^16: the same lens up to the first omitted term."""
    c, k = -1 / 30.0, -N * N
    terms, coefficient = [], 0.5 * c
    for m in range(1, 9):
        terms.append(coefficient)
        coefficient *= (1 + k) * c * c * (2 * m - 1) / (2 * m + 2)
    back = optics.Asphere(even=tuple(terms))
    lens = optics.aspheric_lens(np.inf, back, 8.0, aperture=22.0, material=N)
    screen = optics.detector(1.0, name="focus").translate([0, 0, 4.0 + 30.0 / (N - 1)])
    heights = np.linspace(-9, 9, 7)
    origins = np.stack([heights, 0 * heights, np.full(7, -20.0)], axis=1)
    hits = optics.System([lens, screen]).trace_rays(origins, [0, 0, 1]).at("focus")
    assert hits.rows >= 7
    # the first omitted term, at the rim: 2e-7 of the sag, times a lever of 60
    assert np.abs(hits.points()[:7, :2]).max() < 1e-4


def test_an_aspheric_mirror_is_a_paraboloid_by_its_first_term() -> None:
    face = optics.Asphere(even=(-1 / 400.0,))
    mirror = optics.aspheric_mirror(face, 10.0, aperture=80.0)
    assert mirror.material == "absorber"
    screen = optics.detector(1.0, name="focus").translate([0, 0, -100])
    origins = np.array([[x, y, -50.0] for x in (-30, 3, 20) for y in (-10, 0, 15)], float)
    hits = optics.System([mirror, screen]).trace_rays(origins, [0, 0, 1]).at("focus")
    assert hits.rows == 9
    assert np.abs(hits.points() - [0, 0, -100]).max() < 1e-11

def test_rays_in_a_gradient_are_drawn_as_curves() -> None:
    """In a rod of graded glass rays are sines (Born & Wolf, 7th edition, section 3.2.1), and so are the drawn
    points."""
    from rayweave.optics._drawing import _lines

    g, n = 0.3, 1.6
    rod = optics.element(rayweave.cylinder(2.0, 18.0), optics.graded(n, "selfoc", g), name="rod")
    trace = optics.System([rod]).trace_rays([[1.0, 0.0, -10.0]], [0, 0, 1])
    starts, ends, tilts = (np.stack([trace[f"{k}{kind}"] for k in "xyz"], axis=1) for kind in ("0", "1", "_tilt"))
    ends = np.where(np.isnan(ends), starts + tilts, ends)
    chosen = np.ones(trace.rows, bool)
    lines = [line for line in _lines(trace, starts, ends, tilts, chosen) if len(line) > 2]
    points = np.concatenate(lines)
    # x'' = -g^2 x / (1 - g^2): the axial component of the direction is constant
    rate = g / np.sqrt(1 - g * g)
    sine = np.cos(rate * (points[:, 2] + 9.0))
    chords = np.concatenate([line[[0, -1]].mean(axis=0, keepdims=True) for line in lines])
    worst = np.abs(chords[:, 0] - np.cos(rate * (chords[:, 2] + 9.0))).max()
    assert len(points) > 2 * len(lines) and np.abs(points[:, 0] - sine).max() < 0.2 * worst


def test_the_beams_of_an_etalon_add_up_to_airys_formula() -> None:
    """Born & Wolf, Principles of Optics, 7th edition, section 7.6.1."""
    n, thickness = 1.8, 0.5
    plate = optics.lens(np.inf, np.inf, thickness, aperture=10.0, material=n)
    reflectance = ((n - 1) / (n + 1)) ** 2
    for nm in (500.0, 500.03, 500.08):
        trace = optics.System([plate]).trace_rays([0.1, 0, -5], [0, 0, 1], nm, branches="both", threshold=1e-20)
        s, p = trace.phases()
        through = (trace["event"] == 0) & (trace["z_tilt"] > 0)
        half = 2 * np.pi * n * thickness * 1e6 / nm
        expected = 1 / (1 + 4 * reflectance / (1 - reflectance) ** 2 * np.sin(half) ** 2)
        for phase in (s, p):
            amplitude = (np.sqrt(trace["intensity"]) * np.exp(1j * np.radians(phase)))[through].sum()
            assert abs(amplitude) ** 2 == pytest.approx(expected, abs=1e-7)
    with pytest.raises(rayweave.RayweaveError, match="whole trace"):
        trace.at("lens").phases()
