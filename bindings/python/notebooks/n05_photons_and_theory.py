"""
Photons and theory
==================

Four closed forms of optics, each beside a simulation: absorption, refraction at a boundary, light that is trapped in a plate,
and the Cerenkov angle.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rayweave.photons as photons


def load(text: str) -> photons.Detector:
    """The detector of a model file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.toml"
        path.write_text(text, encoding="utf-8")
        return photons.load(path)


def ends(steps: photons.Histories, name: str) -> np.ndarray:
    """True in the rows of a process."""
    return np.array(steps.process_names)[steps["process"]] == name


TANK = """
rayweave = 1
unit = "mm"
[solid.tank]
box = { size = [400, 400, 400] }
[solid.block]
box = { size = [100, 100, <d>] }
[[region]]
solid = "tank"
medium = "outer"
[[region]]
solid = "block"
medium = "inner"
[medium.outer]
[medium.inner]
[photons.medium.outer]
RINDEX = { eV = [1.5, 4], value = [<outer>, <outer>] }
[photons.medium.inner]
RINDEX = <inner>
ABSLENGTH = <length>
"""


def tank(outer: float, inner: float, length: float, thick: float) -> photons.Detector:
    """A block in a medium."""
    text = TANK.replace("<outer>", str(outer)).replace("<inner>", str(inner))
    return load(text.replace("<length>", str(length)).replace("<d>", str(thick)))


# %%
# Absorption
# ----------
# A beam crosses a block of thickness d of the same index: ``exp(-d / length)`` of it remains.

beam = photons.point([0, 0, -150], 450, towards=[0, 0, 1])
thicknesses = np.array([10, 30, 60, 100, 150])
remaining = []
for d in thicknesses:
    run = tank(1.33, 1.33, 50, d).simulate(beam, n=5_000, seed=1)
    remaining.append(run.ends["escaped"] / 5_000)
exact = np.exp(-thicknesses / 50)
sigma = np.sqrt(exact * (1 - exact) / 5_000)
for d, found, expected, error in zip(thicknesses, remaining, exact, sigma, strict=True):
    print(f"{d:4} mm: {found:.4f}, exp(-d / 50) = {expected:.4f} +- {error:.4f}")
assert np.all(np.abs(remaining - exact) < 4 * sigma)

# %%
# Refraction
# ----------
# Unpolarised light meets a block at an angle. The fraction that is reflected at the front is that of Fresnel's equations.

angles = np.arange(0, 86, 17)
reflected = []
glass = tank(1.0, 1.5, 1e6, 100)
for angle in np.radians(angles):
    direction = np.array([np.sin(angle), 0, np.cos(angle)])
    source = photons.point(np.array([0, 0, -50]) - 20 * direction, 450, towards=direction)
    steps = glass.simulate(source, n=5_000, seed=2, record="steps", max_steps=1).histories
    reflected.append((ends(steps, "fresnel_reflection") & (steps["step"] == 1)).sum() / 5_000)

incidence = np.radians(angles)
cos_i, cos_t = np.cos(incidence), np.sqrt(1 - (np.sin(incidence) / 1.5) ** 2)
across, along = ((cos_i - 1.5 * cos_t) / (cos_i + 1.5 * cos_t)) ** 2, ((cos_t - 1.5 * cos_i) / (cos_t + 1.5 * cos_i)) ** 2
exact = (across + along) / 2
figure, axis = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
axis.errorbar(angles, reflected, np.sqrt(exact * (1 - exact) / 5_000), fmt="o", label="simulated")
axis.plot(angles, exact, label="Fresnel")
axis.set(xlabel="angle of incidence in degrees", ylabel="reflected fraction")
axis.legend()
assert np.all(np.abs(reflected - exact) < 4 * np.sqrt(exact * (1 - exact) / 5_000) + 1e-9)

# %%
# Trapped light
# -------------
# Light from a point in a wide plate leaves through a face if its angle is below the critical one. The rest,
# ``sqrt(1 - 1 / n**2)`` of it, is reflected totally at the first face.

plate = tank(1.0, 1.58, 1e6, 0.5)
steps = plate.simulate(photons.point([0, 0, 0], 450), n=10_000, seed=3, record="steps", max_steps=1).histories
trapped = (ends(steps, "total_internal_reflection") & (steps["step"] == 1)).sum() / 10_000
exact = np.sqrt(1 - 1 / 1.58**2)
print(f"trapped {trapped:.4f}, exactly {exact:.4f} +- {np.sqrt(exact * (1 - exact) / 10_000):.4f}")
assert abs(trapped - exact) < 4 * np.sqrt(exact * (1 - exact) / 10_000)

# %%
# Cerenkov light
# --------------
# The directions of the photons of a genstep make an angle with the track whose cosine is ``1 / (beta n)``.

water = tank(1.33, 1.33, 1e6, 10)
cosines = []
betas = np.array([0.8, 0.9, 0.99])
for beta in betas:
    speed = beta * 299.792458
    step = [15, 0, 0, 0, 0, 0, 2_000, 1, 20, speed, 0, 0, 0, 20, 100, 100]
    source = photons.gensteps(water, np.array([step]), materials={0: "outer"})
    steps = water.simulate(source, seed=1, record="steps", max_steps=1).histories
    cosines.append(steps["dz"][ends(steps, "cerenkov")])
figure, axis = plt.subplots(figsize=(5.5, 3), layout="constrained")
for beta, values in zip(betas, cosines, strict=True):
    axis.hist(np.degrees(np.arccos(values)), bins=np.linspace(0, 50, 101), label=f"beta = {beta}")
    assert np.allclose(values, 1 / (beta * 1.33), atol=1e-9)
axis.set(xlabel="angle from the track in degrees", ylabel="photons")
axis.legend()
