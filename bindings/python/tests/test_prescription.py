"""Prescriptions, their first-order data and their images, compared with published data, a peer, and closed forms."""

import csv
import inspect
import math
import pickle
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from rayweave import RayweaveError, optics
from rayweave.optics import Prescription, Surface

ROOT = Path(__file__).resolve().parents[3]
D_NM = 587.5618


def design(name: str) -> Prescription:
    return Prescription.read_zmx(ROOT / f"models/optics/{name}.zmx")


def paraboloid(f: float = 100.0, *, aperture: float = 20.0, shift: float = 0.0) -> Prescription:
    """A mirror with a perfect focus on the axis, and the image shifted from it."""
    mirror = Surface(-2 * f, -f + shift, "mirror", conic=-1)
    return Prescription([mirror], entrance_pupil_diameter=aperture, wavelengths_nm=[550.0])


def test_published_first_order_data() -> None:
    # the sources are in the notes of the files
    assert design("cooke-triplet").first_order().focal_length == pytest.approx(50.0, abs=1e-3)
    assert design("tessar").first_order().focal_length == pytest.approx(4.0, abs=5e-3)  # inches
    assert design("achromat").first_order().back_focal_distance == pytest.approx(97.1, abs=0.15)
    hubble = design("hubble").first_order()
    assert hubble.focal_length == pytest.approx(57_600, abs=1)
    assert hubble.f_number == pytest.approx(24.0, abs=1e-3)
    # the entrance pupil of Hubble is its primary mirror
    assert hubble.entrance_pupil.position == 0.0
    assert hubble.entrance_pupil.diameter == pytest.approx(2400.0)


def test_cardinal_points_of_a_thick_lens() -> None:
    r1, r2, t, n = 50.0, -70.0, 12.0, 1.6
    lens = Prescription([Surface(r1, t, n), Surface(r2, 60.0)], entrance_pupil_diameter=5)
    found = lens.first_order()
    f = optics.lensmaker(r1, r2, n, t)
    assert found.focal_length == pytest.approx(f, rel=1e-13)
    # E. Hecht, Optics, section 6.1: h1 = -f (n - 1) t / (r2 n), h2 = -f (n - 1) t / (r1 n)
    assert found.front_principal_plane == pytest.approx(-f * (n - 1) * t / (r2 * n), rel=1e-12)
    assert found.back_principal_plane == pytest.approx(-f * (n - 1) * t / (r1 * n), rel=1e-12)
    assert np.linalg.det(found.matrix) == pytest.approx(1.0, abs=1e-14)
    # Petzval's sum, the power of each surface over its indices
    assert found.petzval_sum == pytest.approx((1 / n - 1) / r1 + (1 - 1 / n) / r2, rel=1e-12)


def test_spots_and_wavefronts_of_a_peer() -> None:
    with (ROOT / "crates/lens/tests/design/reference/peers.csv").open() as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    compared = 0
    for name in ("cooke-triplet", "double-gauss"):
        lens = design(name)
        grid = optics.pupil_grid("hexapolar", 6)
        # glass absorbs light, but the peer counts rays
        images = lens.spots(wavelength_nm=lens.primary_nm).images
        rms = [math.hypot(image["x"].std(), image["y"].std()) for image in images]
        for row in rows:
            if row["design"] != name or not row["peer"].startswith("Optiland") or not row["field"]:
                continue
            field, value = int(row["field"]), float(row["value"])
            if row["quantity"] == "rms spot":
                assert rms[field] == pytest.approx(value, rel=1e-10)
            else:
                # the peer does not remove tilt
                assert lens.wavefront(field, pupil=grid).rms_about_chief_ray == pytest.approx(value, abs=2e-9)
            compared += 1
    assert compared == 12


def test_seidel_sums_of_a_peer() -> None:
    # Optiland 0.6.3, aberrations.seidels(), which has the opposite sign
    total = design("cooke-triplet").seidel().sum
    expected = [-0.00696004149135, 0.00123488647048, 0.00890673846436, -0.0257157169117, 0.00185858910192]
    np.testing.assert_allclose([-total[name] for name in list(total)[:5]], expected, rtol=1e-10)


def test_a_paraboloid_out_of_focus() -> None:
    f, aperture, shift = 100.0, 20.0, 0.5
    spots = paraboloid(f).spots()
    assert spots["rms"][0] < 1e-12 and spots["rays"][0] == 96 and spots.images[0].rows == 127
    # a cone about the focus: the ray at the height h hits the plane at h s / (f - h^2 / 4 f)
    image = paraboloid(f, shift=shift).arrivals(rings=8)
    h = 0.5 * aperture * np.arange(9) / 8
    reach = h * shift / (f - h**2 / (4 * f))
    # the mean of reach^2 over the disk, with u = h^2 / 4 f: the integral of u / (f - u)^2 by partial fractions
    u = h[-1] ** 2 / (4 * f)
    square = 4 * f * shift**2 / u * (u / (f - u) + math.log1p(-u / f))
    centroid = image.spot().centroid
    assert isinstance(centroid, tuple) and centroid == pytest.approx((0, 0), abs=1e-9)
    assert image.spot().rms == pytest.approx(math.sqrt(square), rel=1e-9)
    assert image.spot().geometric == pytest.approx(reach[-1], rel=1e-9)
    # light travels back: the image moves along the axis of the world
    assert image.best_focus() == pytest.approx(-shift, rel=1e-9)
    assert image.moved(-shift).spot().rms < 1e-12
    # a fraction of the power is one of the area: hexapolar points that count equally would give 61 / 217 within the fourth ring
    np.testing.assert_allclose(image.encircled_energy([reach[4], reach[8]]), [1 / 4, 1], atol=1e-3)
    assert image.radius_of_energy(1 / 4) == pytest.approx(reach[4], rel=2e-3)
    given = paraboloid(f, shift=shift).arrivals(pupil=optics.pupil_grid("hexapolar", 8))
    np.testing.assert_allclose(given.encircled_energy([reach[4] + 1e-9, reach[8] + 1e-9]), [61 / 217, 1])
    assert given.radius_of_energy(61 / 217) == pytest.approx(reach[4], rel=1e-9)


def test_through_focus_is_a_hyperbola_about_the_best_focus() -> None:
    lens = paraboloid(100.0, aperture=4.0)
    found = lens.through_focus([-0.2, -0.1, 0.0, 0.1])
    # the RMS radius of a uniform disk
    cone = 0.02 * math.sqrt(0.5)
    np.testing.assert_allclose(found["rms"], [0.2 * cone, 0.1 * cone, 0, 0.1 * cone], rtol=2e-4, atol=1e-12)
    assert found.units["shift"] == "mm"


def cooke_triplet() -> Prescription:
    """The triplet of the tutorial at three other lines."""
    rows = [(22.01359, 3.25896, "N-SK16"), (-435.76044, 6.00755, "air"), (-22.21328, 0.99997, "F2")]
    rows += [(20.29192, 4.75041, "air"), (79.6836, 2.95208, "N-SK16"), (-18.39533, 42.20778, "air")]
    surfaces = [Surface(radius, thickness, behind) for radius, thickness, behind in rows]
    lines = {"wavelengths_nm": [480, 550, 650], "primary": 1}
    return Prescription(surfaces, stop=4, entrance_pupil_diameter=10, fields=[0, 14, 20], **lines)  # type: ignore[arg-type]


def dense_square_radii(lens: Prescription, across: int) -> NDArray[np.float64]:
    """The mean square radii of the spots over cells of a square grid, without any rule of quadrature."""
    at = (np.arange(across) + 0.5) / across * 2 - 1
    grid = np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 2)
    grid = grid[np.hypot(*grid.T) < 1]
    found = []
    for field in range(len(lens.fields)):
        rays = lens.arrivals(field, pupil=grid)
        x, y = (rays[name] - np.average(rays[name], weights=rays["power"]) for name in "xy")
        found.append(np.average(x**2 + y**2, weights=rays["power"]))
    return np.array(found)


def test_rms_radii_converge_with_few_rings() -> None:
    lens = cooke_triplet()
    # a grid of cells has an error of about 1 / across^1.5 (the circle problem): 3e-4 for 200
    dense = np.sqrt(dense_square_radii(lens, 200))
    for rings in (3, 4, 6, 12):
        np.testing.assert_allclose(lens.spots(rings=rings)["rms"], dense, rtol=1e-3)
    spots = lens.spots()
    np.testing.assert_allclose(lens.spots(rings=4)["rms"], lens.spots(rings=16)["rms"], rtol=2e-6)
    np.testing.assert_allclose(spots["rms"], lens.spots(rings=16)["rms"], rtol=1e-9)
    assert [image.spot().rms for image in spots.images] == spots["rms"].tolist()
    assert spots["rays"].tolist() == [288] * 3 and [image.rows for image in spots.images] == [381] * 3


def polar_means(rings: int, arms: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and weights of a disk by NumPy's Gaussian quadrature of the square of the radius."""
    nodes, weights = np.polynomial.legendre.leggauss(rings)
    radius, angle = np.meshgrid(np.sqrt((1 + nodes) / 2), (np.arange(arms) + 0.5) * 2 * np.pi / arms, indexing="ij")
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1).reshape(-1, 2)
    return points, np.repeat(weights / (2 * arms), arms)


def test_the_rms_of_a_wavefront_is_a_mean_over_the_pupil() -> None:
    lens = cooke_triplet()
    points, weights = polar_means(30, 71)
    for field in range(3):
        waves = lens.wavefront(field, pupil=points)["waves"]
        about_chief = math.sqrt(weights @ (waves - weights @ waves) ** 2)
        # x and y have the mean square 1/4 over the disk and no mean
        tilts = [4.0 * (weights @ (waves * points[:, k])) for k in range(2)]
        flat = waves - points @ tilts
        rms = math.sqrt(weights @ (flat - weights @ flat) ** 2)
        for across in (9, 33):
            front = lens.wavefront(field, across=across)
            assert front.rms == pytest.approx(rms, rel=1e-8)
            assert front.rms_about_chief_ray == pytest.approx(about_chief, rel=1e-8)
            assert front.strehl == pytest.approx(math.exp(-((2 * math.pi * rms) ** 2)), rel=1e-6)
        kept = pickle.loads(pickle.dumps(front))
        assert (kept.rms, kept.rms_about_chief_ray) == (front.rms, front.rms_about_chief_ray)
        for name, value in (("wavefront", rms), ("wavefront about chief ray", about_chief)):
            aim = optics.goal(name, field=field, wavelength_nm=550)
            assert optics.optimise(lens, ["thickness 6"], [aim]).before == pytest.approx(value, rel=1e-8)
            one = lens.replace(fields=[lens.fields[field]])
            assert optics.tolerance(one, {"thickness 6": 0.0}, name, trials=1).nominal == pytest.approx(value, rel=1e-8)
    # the points of a grid, and given points, count equally
    grid = optics.pupil_grid("square", 33)
    given = lens.wavefront(1, pupil=grid)
    assert given.rms_about_chief_ray == pytest.approx(given["waves"].std(), rel=1e-14)
    assert given.rms == pytest.approx(math.hypot(*given.zernike(15)["coefficient"][3:], given.zernike(15).residual_rms), rel=0.05)
    assert given.rms_about_chief_ray != pytest.approx(lens.wavefront(1).rms_about_chief_ray, rel=1e-2)
    # a vignetted field: over the part of the pupil that transmits
    narrow = lens.with_surface(1, semi_diameter=4.5).with_surface(2, semi_diameter=4.5)
    at = narrow.wavefront(2, across=301)
    assert narrow.wavefront(2).rms_about_chief_ray == pytest.approx(at["waves"].std(), rel=0.01)
    columns = np.stack([np.ones(at.rows), at["pupil_x"], at["pupil_y"]], axis=1)
    left = np.linalg.lstsq(columns, at["waves"])[1][0]
    assert narrow.wavefront(2).rms == pytest.approx(math.sqrt(left / at.rows), rel=0.01)
    assert narrow.wavefront(2).rms != pytest.approx(lens.wavefront(2).rms, rel=0.02)


def test_the_strehl_ratio_is_that_of_the_peak_of_the_image() -> None:
    # off the axis, a paraboloid has coma: the peak is not where the chief ray is
    mirror = optics.Prescription(
        [optics.Surface(-400, -200, "mirror", conic=-1)], entrance_pupil_diameter=40, fields=[0.5], wavelengths_nm=[587.6]
    )
    rays = mirror.arrivals(0, pupil=optics.pupil_grid("square", 41))
    steps = np.linspace(-0.008, 0.008, 81)
    peak = 0.0
    for x in rays["x"].mean() + steps:
        places = np.stack([np.full(81, x), rays["y"].mean() + steps], axis=1)
        off = places[:, None, :] - np.stack([rays["x"], rays["y"]], axis=1)
        path = rays["path"] + off[:, :, 0] * rays["x_tilt"] + off[:, :, 1] * rays["y_tilt"]
        peak = max(peak, float((np.abs(np.exp(2j * np.pi * path / 587.6e-6).mean(axis=1)) ** 2).max()))
    front = mirror.wavefront(0)
    assert peak == pytest.approx(0.72, abs=0.02)
    assert front.strehl == pytest.approx(peak, abs=0.02)
    assert front.rms_about_chief_ray > 2.5 * front.rms


def test_the_means_of_a_pupil_are_exact_for_polynomials() -> None:
    points, weights = optics.pupil_quadrature(4)
    x, y = points.T
    # means over the unit disk in polar coordinates
    for values, mean in [(x**2, 1 / 4), (x**2 * y**2, 1 / 24), (x**10, 21 / 512), ((x**2 + y**2) ** 7, 1 / 8), (x**5 * y, 0)]:
        assert weights @ values == pytest.approx(mean, rel=1e-12, abs=1e-15)
    assert optics.pupil_quadrature(0)[0].tolist() == [[0, 0]]
    with pytest.raises(RayweaveError, match="rings is 1025: it must be at most 1024"):
        optics.pupil_quadrature(1025)


def test_the_best_focus_of_a_spherical_mirror() -> None:
    # a rho^3 + b rho has the smallest RMS at b = - 2 a / 3, two thirds of the way to the marginal focus, where its RMS is
    # a / 6; higher orders are smaller by the square of the sine s of the incidence
    radius, height = 200.0, 10.0
    s = height / radius
    mirror = Prescription([Surface(-radius, -radius / 2, "mirror")], entrance_pupil_diameter=2 * height)
    marginal = 0.5 * radius * (1 / math.sqrt(1 - s * s) - 1)
    for rings in (2, 4, 6):
        assert mirror.arrivals(rings=rings).best_focus() == pytest.approx(2 / 3 * marginal, rel=2 * s * s)
        found = mirror.through_focus([2 / 3 * marginal], rings=rings)["rms"][0]
        assert found == pytest.approx(marginal * 2 * s / 6, rel=4 * s * s)


def test_refocused_lenses_have_the_best_focus_of_all_fields() -> None:
    lens = cooke_triplet()
    found = lens.refocused()
    # the parabola through the dense mean squares at three places of the image
    planes = [float(np.mean(dense_square_radii(lens.with_surface(6, thickness=42.20778 + shift), 60))) for shift in (-0.1, 0, 0.1)]
    a, b, _ = np.polyfit([-0.1, 0, 0.1], planes, 2)
    # both have the error of the grid, relative to the half width of about 0.1 where the radius doubles
    assert found.surfaces[-1].thickness - 42.20778 == pytest.approx(-b / (2 * a), abs=1e-3)
    assert np.mean(found.spots()["rms"] ** 2) < np.mean(lens.spots()["rms"] ** 2)
    moved = [np.mean(found.spots(shift=shift)["rms"] ** 2) for shift in (-1e-3, 0, 1e-3)]
    assert moved[1] < min(moved[0], moved[2])
    # light that travels back, one field with the same answer as its best focus, a curved image
    mirror = paraboloid(shift=0.5)
    assert mirror.refocused().surfaces[0].thickness == pytest.approx(-100.0, rel=1e-12)
    curved = lens.replace(image_radius=-80.0).refocused()
    assert abs(curved.refocused().surfaces[-1].thickness - curved.surfaces[-1].thickness) < 1e-6
    tilted = mirror.replace(breaks=[optics.CoordinateBreak(2, tilt_degrees=(5, 0, 0))])
    with pytest.raises(RayweaveError, match="the image is tilted by a coordinate break"):
        tilted.refocused()
    afocal = Prescription([Surface(np.inf, 5.0, 1.5), Surface(np.inf, 50.0)], entrance_pupil_diameter=4)
    with pytest.raises(RayweaveError, match="parallel: it has no best focus"):
        afocal.refocused()


def test_refocused_lenses_are_those_that_the_optimiser_finds() -> None:
    lens = cooke_triplet()
    goals = [optics.goal("spot", field=k, wavelength_nm=550) for k in range(len(lens.fields))]
    found = optics.optimise(lens, ["thickness 6"], goals).lens.surfaces[5].thickness
    # a least-squares search ends where its function is flat to about the square root of the rounding unit
    assert lens.refocused(wavelength_nm=550).surfaces[5].thickness == pytest.approx(found, abs=1e-5)


def test_unknown_attributes_have_suggestions() -> None:
    lens = paraboloid()
    for thing, name, meant in [
        (lens, "refocus", r"refocused\(\)"),
        (lens, "quick_focus", r"refocused\(\)"),
        (lens, "efl", r"first_order\(\).focal_length"),
        (lens, "psf", r"diffraction_mtf\(\)"),
        (lens, "wavefrnt", "wavefront"),
        (lens.first_order(), "efl", "focal_length"),
        (lens.first_order(), "refocus", r"refocused\(\)"),
        (lens.first_order(), "focal_lenght", "focal_length"),
    ]:
        with pytest.raises(AttributeError, match=f"has no attribute '{name}'. Did you mean {meant}"):
            getattr(thing, name)
    for name in ("mtf", "geometric_mtf", "diffraction_mtf"):
        with pytest.raises(TypeError, match=rf"Prescription.{name}\(\) got an .*'max_frequency'.*Did you mean frequencies"):
            getattr(lens, name)(max_frequency=100)


def test_first_order_data_as_a_list() -> None:
    first = cooke_triplet().first_order()
    lines = str(first).splitlines()
    assert lines[0] == "First-order data, lengths in mm" and len(lines) > 12
    assert re.search(r"^focal length +50$", str(first), re.M) and re.search(r"^entrance pupil +at 11.5122 from", str(first), re.M)
    assert first.total_track == pytest.approx(3.25896 + 6.00755 + 0.99997 + 4.75041 + 2.95208 + 42.20778)
    assert first.working_f_number == pytest.approx(5.0, rel=1e-5)
    assert first.image_height == pytest.approx(50 * math.tan(math.radians(20)), rel=1e-5)
    # a thin lens at the magnification -1: twice the F-number, and an image as high as the object
    thin = Prescription(
        [Surface(100.0, 1e-9, 1.5), Surface(-100.0, 200.0)],
        entrance_pupil_diameter=10,
        object_distance=200,
        fields=[0, 7],
        field_kind="object height",
    ).first_order()
    assert thin.working_f_number == pytest.approx(20.0, rel=1e-6) and thin.image_height == pytest.approx(7.0, rel=1e-6)


def test_diffraction_of_a_perfect_lens() -> None:
    lens = paraboloid(aperture=10.0)
    cutoff = 1 / (550e-6 * 10)
    frequencies = np.linspace(0, 1.1 * cutoff, 23)
    # the closed form of a circular aperture: Goodman, section 6.4
    s = np.minimum(frequencies / cutoff, 1)
    expected = 2 / np.pi * (np.arccos(s) - s * np.sqrt(1 - s**2))
    for across in (32, 96):
        found = lens.diffraction_mtf(frequencies, across=across)
        for name in ("tangential", "sagittal"):
            np.testing.assert_allclose(found[name], expected, atol=across**-1.5)
    np.testing.assert_allclose(found["limit"], expected, atol=1e-9)
    # 0.5 mm of defocus: W rho^2, and the integral along the frequency over the lens of two disks (Goodman, section
    # 6.4.3), here by the midpoint rule over a fine grid
    out = paraboloid(aperture=10.0, shift=0.5)
    at = (np.arange(1000) + 0.5) / 500 - 1
    x, y = np.meshgrid(at, at)
    for frequency in (20.0, 60.0):
        shift = 2 * frequency / cutoff
        both = (np.hypot(x - shift / 2, y) < 1) & (np.hypot(x + shift / 2, y) < 1)
        front = out.wavefront(pupil=[[1.0, 0.0]])["waves"][0]
        waves = front * ((x + shift / 2) ** 2 + y**2 - (x - shift / 2) ** 2 - y**2)
        value = abs(np.sum(np.exp(2j * np.pi * waves[both]))) / np.sum(np.hypot(x, y) < 1)
        assert out.diffraction_mtf([frequency])["tangential"][0] == pytest.approx(value, abs=2e-3)


def test_the_limit_of_diffraction_is_that_of_the_light() -> None:
    # a perfect mirror, which has no colour: its transfer function is the limit, the weighted mean over the wavelengths
    lines = {"wavelengths_nm": [450.0, 650.0], "weights": [3.0, 1.0], "primary": 1}
    lens = paraboloid(aperture=10.0).replace(**lines)
    frequencies = np.linspace(0, 220, 12)

    def at(nm: float) -> NDArray[np.float64]:
        s = np.minimum(frequencies * nm * 1e-6 * 10, 1)
        return np.asarray(2 / np.pi * (np.arccos(s) - s * np.sqrt(1 - s**2)))

    mean = (3 * at(450.0) + at(650.0)) / 4
    assert mean[-1] > 0.0 and at(650.0)[-1] == 0.0
    for found in (lens.diffraction_mtf(frequencies), lens.geometric_mtf(frequencies)):
        np.testing.assert_allclose(found["limit"], mean, atol=1e-12)
    np.testing.assert_allclose(lens.diffraction_mtf(frequencies)["tangential"], mean, atol=96**-1.5)
    np.testing.assert_allclose(lens.diffraction_mtf(frequencies, wavelength_nm=450)["limit"], at(450.0), atol=1e-12)
    assert lens.spots(wavelength_nm=450)._airy == pytest.approx(1.21967 * 450e-6 * 10, rel=1e-5)


def test_diffraction_far_from_its_limit_is_geometric() -> None:
    # five waves and more: at low frequencies the transform of the spot, colour included
    surfaces = [Surface(50.0, 5.0, "N-BK7"), Surface(-50.0, 46.0)]
    lens = Prescription(surfaces, entrance_pupil_diameter=5, fields=[0, 4], wavelengths_nm=[480, 550, 650], primary=1, stop=2)
    frequencies = np.array([0.0, 2.0, 4.0, 6.0])
    waves, rays = lens.diffraction_mtf(frequencies), lens.geometric_mtf(frequencies, across=97)
    # diffraction changes the modulation by about the frequency over its limit, 6 / 180
    for name in ("tangential", "sagittal"):
        np.testing.assert_allclose(waves[name], rays[name], atol=0.04)
    assert rays["tangential"].min() < 0.6
    with pytest.raises(RayweaveError, match=r"across is 8: the wavefront changes by .* waves between two points"):
        lens.diffraction_mtf([1.0], across=8)
    with pytest.raises(RayweaveError, match="across is 5000: it must be at most 2048"):
        lens.diffraction_mtf([1.0], across=5000)


def bessel_1(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """By its integral; the midpoint rule is exact to rounding for whole periods."""
    t = (np.arange(64) + 0.5) * np.pi / 64
    return np.asarray(np.cos(t - np.outer(x, np.sin(t))).mean(axis=1))


@pytest.mark.parametrize(("across", "error"), [(None, 2e-4), (201, 2e-3)])
def test_modulation_of_a_disk_of_light(across: int | None, error: float) -> None:
    f, aperture, shift = 100.0, 2.0, 2.0
    found = paraboloid(f, aperture=aperture, shift=shift).mtf(np.linspace(1, 40, 14), across=across)
    radius = shift * aperture / (2 * f)
    # the transform of a uniform disk, 2 J1(x) / x with x = 2 pi v radius
    x = 2 * np.pi * found["frequency"] * radius
    np.testing.assert_allclose(found["tangential"], np.abs(2 * bessel_1(x) / x), atol=error)
    np.testing.assert_allclose(found["sagittal"], found["tangential"], atol=1e-9)
    # the cutoff of a circular pupil is 1 / (wavelength F-number); at half of it the modulation is 0.391
    cutoff = 1 / (550e-6 * f / aperture)
    limit = paraboloid(f, aperture=aperture).mtf([0.0, cutoff / 2, cutoff, 2 * cutoff], across=3)["limit"]
    np.testing.assert_allclose(limit, [1, 0.39100, 0, 0], atol=1e-5)


def test_a_spherical_mirror_with_the_stop_at_its_centre() -> None:
    # every field has its own axis: no astigmatism, and the image lies on a sphere of half the radius about the centre
    surfaces = [Surface(thickness=200.0), Surface(-200.0, -100.0, "mirror")]
    mirror = Prescription(surfaces, entrance_pupil_diameter=2, fields=[0, 8])
    curved = mirror.field_curvature(count=5)
    expected = 100 * (np.cos(np.radians(curved["field_y"])) - 1)
    np.testing.assert_allclose(curved["tangential"], expected, atol=1e-6)
    np.testing.assert_allclose(curved["sagittal"], expected, atol=1e-6)
    assert curved.units["field_y"] == "degrees"
    distorted = mirror.distortion(count=5)
    np.testing.assert_allclose(distorted["real"], 100 * np.tan(np.radians(distorted["field_y"])), atol=1e-11)
    np.testing.assert_allclose(distorted["relative"][1:], 0, atol=1e-12)


def test_colour_of_a_singlet_follows_its_paraxial_focus() -> None:
    lines = [486.1327, D_NM, 656.2725]
    surfaces = [Surface(60.0, 4.0, "N-SF11"), Surface(-90.0, 45.0)]
    singlet = Prescription(
        surfaces, entrance_pupil_diameter=4, wavelengths_nm=lines, primary=1, fields=[0, 5]
    )
    found = singlet.focal_shift(lines)
    expected = [singlet.first_order(line).back_focal_distance - 45 for line in lines]
    np.testing.assert_allclose(found["focus"], expected, atol=1e-6)
    # the stop is in the lens: chief rays of all colours leave it at almost the same height, and lateral colour is
    # that of the lens as a prism
    lateral = singlet.lateral_colour(count=3)
    at_primary = lateral["wavelength_nm"] == D_NM
    np.testing.assert_allclose(lateral["shift"][at_primary], 0, atol=1e-15)
    blue, red = (lateral["shift"][lateral["wavelength_nm"] == line][-1] for line in (lines[0], lines[2]))
    real = [singlet.arrivals(1, wavelength_nm=line, pupil=[[0, 0]])["y"][0] for line in lines]
    assert (blue, red) == pytest.approx((real[0] - real[1], real[2] - real[1]), abs=1e-13)


def test_zernike_polynomials_are_found_again() -> None:
    grid = optics.pupil_grid("square", 15)
    r2 = (grid**2).sum(axis=1)
    # Noll 4 and 11: sqrt(3) (2 r^2 - 1) and sqrt(5) (6 r^4 - 6 r^2 + 1)
    waves = 0.3 * math.sqrt(3) * (2 * r2 - 1) - 0.1 * math.sqrt(5) * (6 * r2**2 - 6 * r2 + 1)
    fit = optics.Wavefront.of(grid, waves).zernike(15)
    expected = np.where(fit["index"] == 4, 0.3, np.where(fit["index"] == 11, -0.1, 0.0))
    np.testing.assert_allclose(fit["coefficient"], expected, atol=1e-13)
    np.testing.assert_allclose(fit.at(grid), waves, atol=1e-13)
    assert fit.residual_rms < 1e-13
    # OSA/ANSI number 12 is spherical aberration
    osa = optics.Wavefront.of(grid, waves).zernike(15, scheme="osa")
    assert osa["coefficient"][12] == pytest.approx(-0.1, abs=1e-13)


def test_fans_of_a_symmetric_lens() -> None:
    lens = design("cooke-triplet")
    fans = lens.fans(count=11)
    assert fans.rows == 3 * 3 * 2 * 11
    pupil, error = fans.fan(0, 550.0, "y")
    np.testing.assert_allclose(error, -error[::-1], atol=1e-12)
    # the marginal ray, traced through the solids alone
    rim = lens.arrivals(0, wavelength_nm=550.0, pupil=[[0, 1]])
    assert error[-1] == pytest.approx(rim["y"][0], abs=1e-12) and pupil[-1] == 1.0


def test_fans_show_lateral_colour() -> None:
    lens = cooke_triplet()
    fans, same = lens.fans(count=3, aimed=True), lens.fans(count=3, aimed=True, reference="same")
    # at the centre of the stop, the fans are the chief rays
    lateral = lens.lateral_colour(count=2)
    for line in lens.wavelengths_nm:
        pupil, error = fans.fan(2, line, "y")
        at_edge = (lateral["wavelength_nm"] == line) & (lateral["share"] == 1.0)
        assert pupil[1] == 0.0 and error[1] == pytest.approx(lateral["shift"][at_edge][0], abs=1e-12)
        assert same.fan(2, line, "y")[1][1] == 0.0
        np.testing.assert_allclose(np.diff(same.fan(2, line, "y")[1]), np.diff(error), atol=1e-14)
    assert abs(fans.fan(2, 480.0, "y")[1][1]) > 1e-4
    with pytest.raises(RayweaveError, match="there is no reference of ray fans 'chief': there are primary, same"):
        lens.fans(reference="chief")  # type: ignore[arg-type]


def test_zemax_files_and_rows() -> None:
    path = ROOT / "models/optics/cooke-triplet.zmx"
    lens = Prescription.read_zmx(path)
    assert lens.to_zmx() == path.read_text() and lens.passed_over == ()
    assert "GCAT SCHOTT" in lens.to_zmx()
    again = lens.replace(name="again")
    assert again.surfaces == lens.surfaces and again.fields == lens.fields and again.name == "again"
    assert lens.replace(f_number=4).first_order().f_number == pytest.approx(4)
    assert lens.replace(wavelengths_nm=[500, 600]).wavelengths_nm == (500, 600)
    glass = lens.with_surface(1, behind=optics.glass("N-BK7"))
    assert glass.first_order().focal_length == lens.with_surface(1, behind="N-BK7").first_order().focal_length


def test_replaced_glasses_are_warnings(tmp_path: Path) -> None:
    text = (ROOT / "models/optics/cooke-triplet.zmx").read_text().replace("GLAS N-SK16 0 0 1.620410 60.3236", "GLAS SK16 0 0 1.5 40")
    path = tmp_path / "old.zmx"
    path.write_text(text)
    for read, start in [(lambda: Prescription.read_zmx(path), f"{path}: "), (lambda: Prescription.from_zmx(text), "")]:
        with pytest.warns(UserWarning) as caught:
            lens = read()
        said = [str(warning.message) for warning in caught]
        assert said == [start + note for note in lens.passed_over] and len(said) == 2
        assert all(warning.filename == __file__ for warning in caught)
        assert 'no glass is named "SK16"' in said[0] and said[0].endswith("its successor N-SK16 is used")
    # Hikari's F2 has another dispersion than Schott's
    hikari = re.sub("GLAS F2 .*", "GLAS F2", text.replace("GLAS SK16 0 0 1.5 40", "GLAS N-SK16 0 0 1.620410 60.3236")).replace("GCAT SCHOTT", "GCAT HIKARI SCHOTT")
    with pytest.warns(UserWarning, match="F2 of Schott is used: HIKARI is not among the built-in catalogues"):
        Prescription.from_zmx(hikari)


def test_prescriptions_and_results_are_equal_by_value() -> None:
    path = ROOT / "models/optics/cooke-triplet.zmx"
    lens, other = Prescription.read_zmx(path), Prescription.read_zmx(path)
    tilt = optics.CoordinateBreak(7, tilt_degrees=(1, 2, 3))
    fine = lens.replace(
        [*lens.surfaces[:5], Surface(-18.0, 42.0, optics.Glass("N-BK7"), figure=optics.Biconic(-20.0))], breaks=[tilt], image_semi_diameter=30
    )
    for one in (lens, fine):
        assert one == one.replace() == pickle.loads(pickle.dumps(lens if one is lens else one.replace()))
        assert hash(one) == hash(one.replace()) and len({one, one.replace()}) == 1
        changes: list[dict[str, Any]] = [{"name": "x"}, {"fields": [0, 1]}, {"wavelengths_nm": [480, 550, 640]}, {"stop": 3}, {"f_number": 4.9}]
        assert all(one.replace(**change) != one for change in changes)
    assert lens == other and lens != fine and lens != "lens" and lens.with_surface(2, thickness=6) != lens
    first = lens.first_order()
    assert first == other.first_order() and hash(first) == hash(other.first_order())
    assert first != lens.first_order(500) and first != lens.replace(unit="cm").first_order()
    assert lens.spots() == other.spots() and lens.spots() != lens.spots(rings=3) and lens.spots() != lens.fans()
    assert lens.distortion() == other.distortion()  # NaN on the axis
    assert lens.distortion() != lens.replace(unit="cm").distortion()


def test_the_solids_form_an_ordinary_system() -> None:
    lens = design("cooke-triplet")
    system = lens.system()
    assert system.element_names == ["lens 1-2", "lens 3-4", "lens 5-6", "stop", "mount", "image"]
    trace = system.trace_rays(*lens.rays(2), lens.primary_nm)
    arrived = trace.spot("image")
    image = lens.arrivals(2, wavelength_nm=lens.primary_nm, pupil=optics.pupil_grid("hexapolar", 6))
    assert arrived.rms_radius == pytest.approx(image.spot().rms, rel=1e-9)
    mirror = design("cassegrain").system()
    assert {"mirror 1", "mirror 2"} <= set(mirror.element_names)


def test_refusals() -> None:
    surface = Surface(50.0, 4.0, "N-BK7")
    with pytest.raises(RayweaveError, match="the aperture is missing: pass one of entrance_pupil_diameter, f_number"):
        Prescription([surface])
    with pytest.raises(RayweaveError, match=r"surface 1: .*Did you mean"):
        Prescription([Surface(50.0, 4.0, "N-BK8")], entrance_pupil_diameter=1)
    with pytest.raises(RayweaveError, match="no surface"):
        Prescription([], entrance_pupil_diameter=1)
    with pytest.raises(RayweaveError, match="the field is 3: it must be from 0 to"):
        paraboloid().arrivals(3)
    with pytest.raises(RayweaveError, match='field_kind is "sine"'):
        Prescription([surface], entrance_pupil_diameter=1, field_kind="sine")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"surfaces\[0\] is of the type float"):
        Prescription([5.0], entrance_pupil_diameter=1)  # type: ignore[list-item]
    with pytest.raises(TypeError, match="a thickness is 'thin'"):
        Prescription([Surface(50.0, "thin")], entrance_pupil_diameter=1)  # type: ignore[arg-type]
    with pytest.raises(RayweaveError, match=r"wavelengths_nm has shape \(\)"):
        Prescription([surface], entrance_pupil_diameter=1, wavelengths_nm=500)  # type: ignore[arg-type]
    with pytest.raises(RayweaveError, match="count is 0"):
        paraboloid().wavefront().zernike(0)
    with pytest.raises(RayweaveError, match="there is no surface 2"):
        paraboloid().with_surface(2, radius=1.0)
    with pytest.raises(RayweaveError, match="surfaces 1 and 2 cross"):
        Prescription(
            [Surface(20, 1, 1.5), Surface(-20, 19)], entrance_pupil_diameter=15
        ).spots()


def test_columns_go_into_tables() -> None:
    spots = design("cooke-triplet").spots()
    pandas, arrow = pytest.importorskip("pandas"), pytest.importorskip("pyarrow")
    frame = spots.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and frame.attrs["units"]["rms"] == "mm"
    table = spots.to_arrow()
    assert isinstance(table, arrow.Table) and table.schema.field("rms").metadata == {b"unit": b"mm"}
    np.testing.assert_array_equal(table["rms"].to_numpy(), spots["rms"])


def test_the_principal_ray_goes_through_the_centre_of_the_stop() -> None:
    # behind a plane plate a ray has its original direction, so that a stop there has no distortion at any angle
    plate = Prescription([Surface(np.inf, 10.0, 1.5), Surface(np.inf, 50.0)], entrance_pupil_diameter=1, fields=[0, 50], stop=2)
    np.testing.assert_allclose(plate.distortion(count=3)["relative"][1:], 0, atol=1e-10)
    angle = math.radians(50)
    inside = math.asin(math.sin(angle) / 1.5)
    expected = 10.0 * (math.tan(angle) / 1.5 - math.tan(inside)) / 0.5
    np.testing.assert_allclose(plate.chief_ray_pupil_point(1), (0, expected), atol=1e-8)
    with pytest.raises(RayweaveError, match="Aim the rays at the stop"):
        plate.spots()
    assert plate.spots(aimed=True)["rays"].min() > 80


def test_pictures() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    plt = pytest.importorskip("matplotlib.pyplot")
    lens = design("cooke-triplet")
    layout = lens.show(rays=3)
    assert layout.get_xlabel() == "z, mm" and layout.get_title() == lens.name
    legend = layout.get_legend()
    assert legend is not None and [text.get_text() for text in legend.get_texts()] == ["0 deg", "14 deg", "20 deg"]
    # closed outlines of three lenses, the image, and two sides of the stop
    paths: list[Any] = [np.asarray(line.get_xydata()) for line in layout.lines]
    closed = [path for path in paths if len(path) > 3 and np.array_equal(path[0], path[-1])]
    assert len(closed) == 3
    assert [text.get_text() for text in layout.texts] == ["stop"]
    stop = [path for path in paths if len(path) == 2]
    assert sorted(abs(ends[0][1]) for ends in stop) == pytest.approx([lens.first_order().stop_semi_diameter] * 2)
    # the outline of the first lens: its vertices on the axis, and the sags of its spheres at any height
    front, back = lens.surfaces[:2]
    z, y = closed[0].T
    at = y[np.abs(y) < 8]
    sags = [surface.radius - math.copysign(1, surface.radius) * np.sqrt(surface.radius**2 - at**2) for surface in (front, back)]
    far = np.abs(z[np.abs(y) < 8] - [sags[0], sags[1] + front.thickness]).min(axis=0)
    # half a row of the picture, 1 / 800 of its height
    assert far.max() < 1e-9
    spots = lens.spots()
    diagrams: list[Any] = list(spots.show())
    assert [axis.get_title() for axis in diagrams] == [
        f"{angle} deg, RMS {1e3 * rms:#.3g} um" for angle, rms in zip((0, 14, 20), spots["rms"], strict=True)
    ]
    names = [text.get_text() for text in diagrams[-1].get_legend().get_texts()]
    assert names == ["480 nm", "550 nm", "650 nm", "RMS radius", "Airy disk"]
    # the first zero of J1 over pi, times wavelength and F-number
    assert diagrams[0].patches[0].get_radius() == pytest.approx(3.8317059702 / np.pi * 0.55 * 5.0, rel=1e-5)
    assert diagrams[0].get_xlabel() == "x, um"
    assert [np.shape(axis.collections[0].get_offsets())[0] for axis in diagrams] == [381, 381, 381]
    fans = lens.fans(count=5).show()
    assert fans.shape == (3, 2) and len(fans[0][0].lines) == 4
    plt.close("all")
    # fields times curves, and the other lines
    curves = [
        (lens.mtf([0, 10], across=5).show(), 7),
        (lens.through_focus([0, 1], rings=3).show(), 3),
        (lens.encircled_energy([0, 1], across=5).show(), 3),
        (lens.distortion(count=3).show(), 2),
        (lens.field_curvature(count=3).show(), 3),
        (lens.focal_shift([500, 600]).show(), 1),
        (lens.lateral_colour(count=3).show(), 3),
    ]
    assert [len(axis.lines) for axis, _ in curves] == [count for _, count in curves]
    assert curves[0][0].get_ylabel() == "geometric MTF (without diffraction)"
    assert curves[0][0].get_xlabel() == "frequency, cycles/mm"
    assert lens.diffraction_mtf([0, 10], wavelength_nm=550, across=64).show().get_ylabel() == "diffraction MTF"
    assert curves[3][0].lines[0].get_xydata()[0].tolist() == [0, 0]
    assert curves[6][0].get_xlabel() == "lateral colour, um"
    assert lens.mtf()["frequency"].max() in (50, 60) and lens.diffraction_mtf(wavelength_nm=550, across=64)["frequency"].max() == 400
    # cells of a grid; given points are drawn as they are
    cells = lens.wavefront(across=5).show().collections[0].get_array()
    assert np.shape(cells) == (5, 5) and np.ma.count(cells) == 13
    given = lens.wavefront(pupil=optics.pupil_grid("hexapolar", 2)).show()
    assert np.shape(given.collections[0].get_offsets()) == (19, 2)
    assert len(lens.wavefront(across=9).zernike(11).show().patches) == 8
    assert len(lens.seidel().show().patches) == 7 * 7
    trials = optics.tolerance(lens, {"radius 1": 0.05, "tilt x 3-4": 0.02}, trials=30, rings=2)
    assert len(trials.show(bins=5).patches) == 5
    assert len(trials.sensitivities.show().patches) == 4
    plt.close("all")
    assert len(trials.sensitivities.show(most=1).patches) == 2
    plt.close("all")


def test_tolerances_of_the_focal_length() -> None:
    r1, r2, t, n = 60.0, -90.0, 5.0, 1.6
    lens = Prescription([Surface(r1, t, n), Surface(r2, 58.0)], entrance_pupil_diameter=5)
    found = optics.tolerance(
        lens, {"radius 1": 0.02, "radius 2": ("normal", 0.01)}, "focal length", trials=500, seed=3
    )
    f = optics.lensmaker(r1, r2, n, t)
    assert found.nominal == pytest.approx(f, rel=1e-13)
    # 1 / f = (n - 1) (c1 - c2 + (n - 1) t c1 c2 / n), differentiated
    m = (n - 1) / n * t
    slopes = f * f * (n - 1) * np.array([(1 + m / r2) / r1**2, -(1 - m / r1) / r2**2])
    np.testing.assert_allclose(found.sensitivities["slope"], slopes, rtol=1e-5)
    linear = f + slopes[0] * found["radius 1"] + slopes[1] * found["radius 2"]
    np.testing.assert_allclose(found["merit"], linear, atol=1e-4)
    sigma = math.hypot(slopes[0] * 0.02 / math.sqrt(3), slopes[1] * 0.01)
    assert found["merit"].std() == pytest.approx(sigma, rel=4 / math.sqrt(1000))
    assert found.quantile(0.5) == pytest.approx(f, abs=5 * sigma / math.sqrt(500))
    assert found.units == {"radius 1": "mm", "radius 2": "mm", "merit": "mm", "shift": "mm", "lost": ""}
    assert found.failures == 0


def test_the_change_of_the_merit_finds_the_worst_tolerance() -> None:
    # to either side a mirrored tilt has the same effect: its slope is 0, although it is the worst of these errors
    errors: dict[str, optics.Spread] = {"radius 1": 0.001, "tilt x 3-4": 0.1, "index 3": 1e-6}
    alone = optics.tolerance(cooke_triplet(), errors, trials=1, rings=3).sensitivities
    changes = [np.abs(alone[end] - alone["nominal"]) for end in ("minus", "plus")]
    np.testing.assert_array_equal(alone["change"], np.maximum(*changes))
    assert alone["parameter"][alone["change"].argmax()] == "tilt x 3-4"
    assert abs(alone["slope"][1]) < 1e-3 * np.abs(alone["slope"]).max()
    assert alone.units["change"] == alone.units["nominal"] == "mm"


def test_a_prescription_has_the_arguments_of_its_constructor() -> None:
    surfaces = [Surface(50, 5, (1.5, 60.0), conic=-1, semi_diameter=8), Surface(-50, 46, even=(0, 1e-5)), Surface(30, 4, "mirror")]
    given = {
        "name": "one",
        "notes": ("a note",),
        "unit": "cm",
        "f_number": 5.0,
        "fields": ((0.0, 1.0), (2.0, 3.0)),
        "field_kind": "object height",
        "wavelengths_nm": (486.0, 587.0, 656.0),
        "weights": (1.0, 2.0, 3.0),
        "primary": 1,
        "object_distance": 100.0,
        "stop": 2,
        "image_radius": 70.0,
        "image_conic": -1.0,
        "image_semi_diameter": 9.0,
    }
    lens = Prescription(surfaces, **given)
    assert {name: getattr(lens, name) for name in given} == given
    assert (lens.entrance_pupil_diameter, lens.object_numerical_aperture, lens.stop_semi_diameter) == (None, None, None)
    # the attributes are arguments of the constructor
    names = [name for name in inspect.signature(Prescription.__init__).parameters if name != "self"]
    assert set(given) < set(names)
    assert Prescription(**{name: getattr(lens, name) for name in names}) == lens
    with pytest.raises(AttributeError, match="Did you mean entrance_pupil_diameter"):
        _ = lens.epd  # type: ignore[attr-defined]


def test_the_text_of_a_prescription_is_its_table() -> None:
    surfaces = [Surface(50, 5, (1.5, 60.0), conic=-1, semi_diameter=8), Surface(-50, 46, even=(0, 1e-5))]
    lens = Prescription(surfaces, f_number=8, stop=2, wavelengths_nm=[486, 587], weights=[1, 2], primary=1, name="one")
    lines = str(lens).splitlines()
    assert lines[0] == "one: 2 surfaces, F-number 8"
    assert lines[2] == "wavelengths in nm: 486, 587 (primary, weight 2)"
    assert lines[3].split() == ["surface", *"radius / mm thickness / mm behind semi-diameter / mm conic remarks".split()]
    assert lines[4].split() == ["1", "50", "5", "1.5", "60", "8", "-1"]
    assert lines[5].split()[:3] == ["2", "-50", "46"]
    assert lines[5].endswith("stop, aspheric terms")
    assert lines[6].split() == ["image", "inf"]
    # surfaces that cross have no solids
    crossing = Prescription([Surface(20, 1, "N-BK7", semi_diameter=15), Surface(-20, 46, semi_diameter=15)], entrance_pupil_diameter=5)
    assert "15" in str(crossing)


def test_tolerances_with_tilts_and_refocusing() -> None:
    # a tilted mirror deflects the light by twice its angle
    turned = optics.tolerance(paraboloid(), {"tilt x 1": 0.1}, "image shift", trials=20, rings=0)
    expected = 100 * np.tan(np.radians(2 * np.abs(turned["tilt x 1"])))
    np.testing.assert_allclose(turned["merit"], expected, rtol=1e-9)
    # refocusing removes a shift of the image completely
    back = optics.tolerance(paraboloid(), {"thickness 1": 0.1}, trials=10, refocus=True)
    assert back["merit"].max() < 1e-12
    np.testing.assert_allclose(back["shift"], -back["thickness 1"], atol=1e-9)
    with pytest.raises(RayweaveError, match="`girth 1` is not a parameter"):
        optics.tolerance(paraboloid(), {"girth 1": 0.1})
    with pytest.raises(RayweaveError, match='the spread is "triangle"'):
        optics.tolerance(paraboloid(), {"radius 1": ("triangle", 0.1)})  # type: ignore[dict-item]


def test_tolerances_are_those_of_both_sides_of_the_field() -> None:
    lens = cooke_triplet()
    errors: dict[str, optics.Spread] = {"tilt x 3-4": 0.05, "decentre y 5-6": 0.02}
    options = {"trials": 40, "rings": 3}
    found = optics.tolerance(lens, errors, **options)
    one_sided = optics.tolerance(lens, errors, mirror_fields=False, **options)
    both = optics.tolerance(lens.replace(fields=[0, 0, 14, 20, -14, -20]), errors, **options)
    assert (found.mirrored, one_sided.mirrored, both.mirrored) == (True, False, False)
    np.testing.assert_allclose(found["merit"], both["merit"], rtol=1e-12)
    rms = lens.spots(rings=3)["rms"]
    assert found.nominal == pytest.approx(one_sided.nominal, rel=1e-12)
    assert found.nominal == pytest.approx(math.sqrt(np.mean(rms**2)), rel=1e-4)
    # an error to either side has the same effect
    alone = found.sensitivities
    np.testing.assert_allclose(alone["minus"], alone["plus"], rtol=1e-9)
    assert np.all(alone["plus"] > found.nominal)
    assert (one_sided["merit"] < one_sided.nominal).sum() > 5 * (found["merit"] < found.nominal).sum()
    assert not optics.tolerance(lens, {"radius 1": 0.1}, trials=1).mirrored


def test_a_spot_goal_is_the_polychromatic_spot() -> None:
    lens = cooke_triplet()
    spots = lens.spots()["rms"]
    for field in range(3):
        found = optics.optimise(lens, ["thickness 6"], [optics.goal("spot", field=field)], patience=1)
        # spots() includes the transmittance of the glasses
        assert found.before == pytest.approx(spots[field], rel=1e-3)
    names = [f"curvature {k}" for k in range(1, 7)]
    goals = [optics.goal("focal length", 50, weight=10), *(optics.goal("spot", field=k) for k in range(3))]
    best = optics.optimise(lens, names, goals)
    after = best.lens.spots()["rms"]
    assert np.sum(after**2) < np.sum(spots**2)
    table = best.goals
    assert table["goal"].tolist() == ["focal length", "spot, field 0", "spot, field 1", "spot, field 2"]
    np.testing.assert_allclose(table["value_after"][1:], after, rtol=1e-3)
    np.testing.assert_allclose(table["contribution_after"][1:], table["value_after"][1:] ** 2, rtol=1e-12)
    assert table["contribution_before"].sum() == pytest.approx(best.before**2, rel=1e-12)
    assert table["contribution_after"].sum() == pytest.approx(best.after**2, rel=1e-12)
    assert table["wanted"][0] == 50 and table["value_after"][0] == best.lens.first_order().focal_length


def test_radii_of_an_optimised_lens_come_back_from_a_file() -> None:
    names = [f"curvature {k}" for k in (1, 2, 6)]
    best = optics.optimise(cooke_triplet(), names, [optics.goal("spot", field=1)], rings=3)
    assert Prescription.from_zmx(best.lens.to_zmx()) == best.lens


def test_a_lens_whose_surfaces_cross_is_a_warning() -> None:
    start = Prescription([Surface(60.0, 6.0, 1.5), Surface(-60.0, 58.0)], entrance_pupil_diameter=20)
    with pytest.warns(UserWarning, match=r"the optimised lens cannot be built: surfaces 1 and 2 cross .* Add bounds"):
        optics.optimise(start, ["thickness 1"], [optics.goal("thickness 1", 0.5)])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        optics.optimise(start, ["thickness 1"], [optics.goal("thickness 1", 5.0)])


def test_the_optimiser_finds_the_lens_of_best_form() -> None:
    n, line = 1.5, D_NM
    start = Prescription([Surface(110.0, 0.01, n), Surface(-110.0, 100.0)], entrance_pupil_diameter=10)
    goals = [
        optics.goal("focal length", 100.0, weight=100),
        optics.goal("wavefront", field=0, wavelength_nm=line),
    ]
    found = optics.optimise(start, ["curvature 1", "curvature 2", "thickness 2"], goals)
    r1, r2 = (surface.radius for surface in found.lens.surfaces)
    # E. Hecht, Optics, section 6.3.1: q = 2 (n^2 - 1) / (n + 2)
    assert (r2 + r1) / (r2 - r1) == pytest.approx(2 * (n * n - 1) / (n + 2), abs=5e-3)
    assert found.lens.first_order().focal_length == pytest.approx(100.0, abs=1e-4)
    assert found.values["thickness 2"] == found.lens.surfaces[1].thickness
    assert found.after < found.before and found.has_converged


def test_an_optimised_index_stays_in_the_lens() -> None:
    lens = Prescription([Surface(50, 5, "N-BK7"), Surface(-50, 46)], entrance_pupil_diameter=10)
    best = optics.optimise(lens, ["index 1"], [optics.goal("focal length", 60)]).lens
    # the lensmaker's equation of a thick lens: 1/f = (n - 1) (1/R1 - 1/R2 + (n - 1) d / (n R1 R2))
    n = best.surfaces[0].behind.index(D_NM)
    assert 1 / ((n - 1) * (2 / 50 - (n - 1) * 5 / (n * 2500))) == pytest.approx(60, rel=1e-9)
    assert best != lens and "N-BK7 -0.09" in str(best)
    for changed in (best.replace(fields=[0, 5]), best.with_surface(2, thickness=50)):
        assert changed.first_order().focal_length == pytest.approx(60, rel=1e-9)
    assert best.system().elements
    # a file has a model glass with the same index and Abbe number at the d line
    assert Prescription.from_zmx(best.to_zmx()).first_order().focal_length == pytest.approx(60, rel=1e-5)


def test_violated_bounds_are_a_warning() -> None:
    lens = Prescription([Surface(50, 5, "N-BK7"), Surface(-50, 46)], entrance_pupil_diameter=10)
    goals = [optics.goal("focal length", 60), optics.goal("curvature 2", at_least=-0.01)]
    with pytest.warns(UserWarning, match=r"violates bounds: curvature 2 is -0.01\d+ \(at least -0.01, weight 1\)\. .*increase its weight"):
        optics.optimise(lens, ["curvature 2"], goals)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        optics.optimise(lens, ["curvature 2"], [optics.goal("focal length", 60), optics.goal("curvature 2", at_least=-0.02)])
    far = optics.goal("edge", at_least=1, surface=1, height=60)
    with pytest.raises(RayweaveError, match="goal 2 of 2 has no value, because .* a surface ends before its height"):
        optics.optimise(lens, ["curvature 2"], [optics.goal("total track", 50), far])


def test_refusals_of_goals() -> None:
    lens = paraboloid()
    with pytest.raises(RayweaveError, match="the goal 'spot' lacks field: it takes field."):
        optics.goal("spot")
    with pytest.raises(RayweaveError, match="the goal 'wavefront' lacks wavelength_nm:"):
        optics.goal("wavefront", field=0)
    with pytest.raises(RayweaveError, match="the goal 'edge' has field: it takes surface and height"):
        optics.goal("edge", surface=1, height=2.0, field=0)
    for wrong, meant in [("efl", "focal length"), ("thicknes 6", "thickness"), ("spots", "spot"), ("thickness", "thickness")]:
        with pytest.raises(RayweaveError, match=f"no operand '{wrong}': .*Did you mean '{meant}'"):
            optics.goal(wrong)
    for name in ("radius 2", "r^16 1", "r^4 2", "conic 1", "index 1", "curvature 12"):
        assert optics.goal(name).operand == name
    with pytest.raises(RayweaveError, match="2 values"):
        optics.goal("focal length", 3.0, at_most=4.0)
    with pytest.raises(RayweaveError, match="there is no operand 'sharpness'"):
        optics.goal("sharpness")
    with pytest.raises(RayweaveError, match="no parameter to vary"):
        optics.optimise(lens, [], [optics.goal("focal length", 1.0)])


def test_figures_are_kept_and_written() -> None:
    figures = [
        None,
        optics.Biconic(30.0, -0.5),
        optics.Toroidal(80.0),
        optics.XYPolynomial(4.0, (0.0, 0.1, 0.2)),
        optics.ZernikePolynomials(5.0, (0.0, 0.0, 0.0, 0.01)),
        optics.ZernikePolynomials(5.0, (0.0, 0.0, 0.0, 0.01), "fringe"),
    ]
    for figure in figures:
        front = Surface(50.0, 4.0, 1.5, figure=figure)
        lens = Prescription([front, Surface(thickness=90.0)], entrance_pupil_diameter=4.0)
        assert lens.surfaces[0] == front
        assert Prescription.from_zmx(lens.to_zmx()).surfaces[0].figure == figure
        assert lens.with_surface(2, thickness=80.0).surfaces[0] == front
        assert lens.spots()["rms"][0] > 0
    with pytest.raises(RayweaveError, match="figure is 3"):
        Prescription([Surface(50.0, 4.0, 1.5, figure=3)], entrance_pupil_diameter=4.0)  # type: ignore[arg-type]
    with pytest.raises(RayweaveError, match="radius_x"):
        Prescription([Surface(50.0, 4.0, 1.5, figure=optics.Biconic(0.0))], entrance_pupil_diameter=4.0)
    with pytest.raises(RayweaveError, match="along is"):
        paraboloid().first_order(along="z")  # type: ignore[arg-type]


def test_a_cylinder_has_power_along_one_axis() -> None:
    # f = R / (n - 1)
    front = Surface(50.0, 4.0, 1.5, figure=optics.Toroidal(math.inf))
    lens = Prescription([front, Surface(thickness=90.0)], entrance_pupil_diameter=4.0)
    assert lens.first_order(along="y").focal_length == pytest.approx(100.0, abs=1e-12)
    assert math.isinf(lens.first_order(along="x").focal_length)


def test_vignetted_fields_use_points_that_are_even_in_area() -> None:
    surfaces = [
        Surface(21.25, 2.0, (1.62041, 60.33), semi_diameter=6.5),
        Surface(-158.65, 6.0, semi_diameter=6.5),
        Surface(-20.25, 1.0, (1.61659, 36.63), semi_diameter=5.0),
        Surface(19.3, 6.0, semi_diameter=5.0),
        Surface(141.25, 2.0, (1.62041, 60.33), semi_diameter=6.5),
        Surface(-17.285, 42.95, semi_diameter=6.5),
    ]
    lens = Prescription(surfaces, entrance_pupil_diameter=12.5, fields=[0, 14, 20], stop=3)
    spots = lens.spots()
    dense = optics.pupil_grid("square", 301)
    for field in range(3):
        reference = lens.arrivals(field, pupil=dense).spot()
        # on the axis the square grid itself has an error of a few parts in a thousand at the rim
        assert spots["rms"][field] == pytest.approx(reference.rms, rel=0.01)
        assert spots["transmitted"][field] == pytest.approx(reference.transmitted, abs=2e-3)
        assert reference.launched == len(dense)
    assert spots["launched"].tolist() == [96, 4096, 4096]
    assert (spots["rays"] == spots["transmitted"] * spots["launched"]).all()
    # the quadrature of a clear pupil is off by more
    points, weights = optics.pupil_quadrature()
    found = lens.arrivals(1, pupil=points)
    shares = weights[found["id"]] / weights[found["id"]].sum()
    middle = shares @ found["x"], shares @ found["y"]
    rms = math.sqrt(shares @ ((found["x"] - middle[0]) ** 2 + (found["y"] - middle[1]) ** 2))
    assert abs(rms / spots["rms"][1] - 1.0) > 0.05


def test_vignetting_of_an_aperture_in_front_of_the_stop() -> None:
    # two circles of radius 1, shifted by d = 10 tan(5 degrees): Euclidean geometry gives their common area
    plate = [Surface(thickness=10, semi_diameter=1.0), Surface(thickness=1), Surface(100, 2, 1.5), Surface(-100, 97)]
    mask = [Surface(thickness=1, behind=1.0001, semi_diameter=1.0), Surface(thickness=9, semi_diameter=1.0), *plate[1:]]
    lens = Prescription(mask, entrance_pupil_diameter=2, fields=[5], stop=3)
    found = lens.vignetting(count=2)
    d = 10 * math.tan(math.radians(5))
    lens_area = (2 * math.acos(d / 2) - d / 2 * math.sqrt(4 - d**2)) / math.pi
    # a plate of index 1.0001 shifts rays by 1e-5, and its other face, 1 nearer to the stop, cuts less
    assert found["transmitted"].tolist() == pytest.approx([1.0, lens_area], abs=2e-3)
    assert found.show().get_xlabel() == "field, degrees"


def test_layouts_show_rays_that_pass_the_surfaces_in_order() -> None:
    pytest.importorskip("matplotlib").use("Agg")
    surfaces = [Surface(50, 3, 1.5, semi_diameter=3.2), Surface(-50, 48, semi_diameter=3.2)]
    lens = Prescription(surfaces, entrance_pupil_diameter=8, fields=[0])
    ax = lens.show(rays=13)
    rays = max(ax.collections, key=lambda drawn: drawn.get_zorder())
    ends = np.array([path.vertices[-1] for path in rays.get_paths()])
    # heights of -12/3, -10/3, ..., 12/3: the outer two miss the lens on both sides and end at its front vertex
    beside = ends[np.abs(ends[:, 1]) > 3.25]
    assert len(beside) == 4 and np.abs(beside[:, 0]).max() < 0.1
    assert np.count_nonzero(ends[:, 0] > 50.9) == 9
    semi_diameter = float(lens.semi_diameters()[-1])
    assert semi_diameter == pytest.approx(1.02 * np.abs(ends[ends[:, 0] > 50.9][:, 1]).max(), rel=1e-9)


def test_prescriptions_are_pickled() -> None:
    for lens in (design("cooke-triplet"), Prescription([Surface(50, 5, optics.Glass("N-BK7")), Surface(-50, 46)], f_number=5, weights=[2.0])):
        again = pickle.loads(pickle.dumps(lens))
        assert again.fields == lens.fields and again.name == lens.name
        assert again.to_zmx() == lens.to_zmx()
        assert (again.spots()["rms"] == lens.spots()["rms"]).all()


def test_diffraction_takes_as_many_cells_as_the_wavefront_needs() -> None:
    # three waves and more of spherical aberration: 24 cells are too few
    lens = Prescription([Surface(50, 5, "N-BK7"), Surface(-50, 46)], entrance_pupil_diameter=10)
    with pytest.raises(RayweaveError, match="Pass across=") as refused:
        lens.diffraction_mtf([20.0], across=24)
    needed = re.search(r"across=(\d+)", str(refused.value))
    assert needed is not None
    enough = lens.diffraction_mtf([20.0], across=int(needed[1]))["tangential"]
    assert lens.diffraction_mtf([20.0])["tangential"] == pytest.approx(enough, abs=0.01)


def test_drawings_name_fields_by_their_place() -> None:
    pytest.importorskip("matplotlib").use("Agg")
    lens = design("cooke-triplet")
    _, labels = lens.geometric_mtf([0.0, 10.0]).show().get_legend_handles_labels()
    assert labels[:2] == ["0 deg, tangential", "0 deg, sagittal"]
    assert lens.fans(count=5).show()[1][0].get_title() == "14 deg, along y"
    with pytest.raises(AttributeError, match="write_zmx"):
        lens.save  # noqa: B018


def test_plots_and_tables(tmp_path: Any) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    plt = pytest.importorskip("matplotlib.pyplot")
    lens = design("cooke-triplet")
    spots, seidel = lens.spots(), lens.seidel()
    plots = [lens.show(), spots.show(), lens.fans(count=5).show(), seidel.show(), lens.distortion(count=3).show()]
    for number, plot in enumerate(plots):
        plot.save(tmp_path / f"{number}.png")
        assert (tmp_path / f"{number}.png").stat().st_size > 0 and plot.figure is plot.axes.flat[0].figure
    assert [len(plot) for plot in plots] == [1, 3, 3, 1, 1]
    with pytest.raises(AttributeError, match=r"select one of them, as in plot\[0\].get_title"):
        plots[1].get_title()
    # a plot takes another one as its axes
    assert seidel.show(ax=plots[3])[0] is plots[3][0]
    plt.close("all")
    rows = [line.split() for line in str(seidel).splitlines()]
    assert [row[0] for row in rows] == ["surface", "1", "2", "3", "4", "5", "6", "sum"]
    assert float(rows[-1][1]) == pytest.approx(seidel.sum["spherical"], rel=1e-5)
    assert "rms [mm]" in str(spots) and len(str(spots).splitlines()) == 4


def test_a_missing_lens_file_is_reported_with_its_neighbours(tmp_path):
    (tmp_path / "lens.zmx").write_text("")
    with pytest.raises(FileNotFoundError, match=r"did you mean `.*lens\.zmx`\?"):
        Prescription.read_zmx(tmp_path / "lense.zmx")
