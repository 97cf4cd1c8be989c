"""Directions in which light of several wavelengths leaves an equilateral prism of N-BK7 in Raysect: one row per ray.

    DIR/py/bin/python crates/bench/peers/prism_raysect.py

The apex angle is 60 degrees and the edges are along z. Rays arrive in the plane z = 0 at
the middle of a face. Each row lists wavelength in nm, angle of incidence in degrees, and x and y of the exit direction.
`crates/optics/tests/component/spectrum.rs` contains the output.
"""

from math import cos, radians, sin

from raysect.core import Point3D, Vector3D, rotate_z, translate
from raysect.optical import ConstantSF, Ray, World
from raysect.optical.material import Dielectric, Material, Sellmeier
from raysect.primitive import Box, Intersect, Sphere

WAVELENGTHS_NM = [404.6561, 435.8343, 486.1327, 546.0740, 587.5618, 656.2725, 706.5188]
INCIDENCES = [45.0, 50.0, 60.0]
SIDE = 30.0


class Witness(Material):
    """Records the direction of the incoming ray."""

    def evaluate_surface(self, world, ray, *rest):
        self.direction = ray.direction
        return ray.new_spectrum()

    def evaluate_volume(self, spectrum, *rest):
        return spectrum


def prism(world):
    # three large boxes whose faces are the sides; the first face has its normal along +x, at the inradius
    inner = SIDE / (2 * 3**0.5)
    faces = [
        Box(Point3D(-200, -200, -20), Point3D(inner, 200, 20), transform=rotate_z(turn)) for turn in (0, 120, 240)
    ]
    glass = Sellmeier(1.03961212, 0.231792344, 1.01046945, 0.00600069867, 0.0200179144, 103.560653)
    material = Dielectric(index=glass, transmission=ConstantSF(1.0), transmission_only=True)
    return Intersect(Intersect(faces[0], faces[1]), faces[2], world, material=material), inner


def main():
    world = World()
    _, inner = prism(world)
    witness = Witness()
    # light starts inside the ball and ends on it
    Sphere(150, world, material=witness, transform=translate(0, 0, 0))
    for incidence in INCIDENCES:
        # enters through the face towards +x, inclined away from the exit face, whose normal is at 120 degrees
        direction = Vector3D(-cos(radians(incidence)), sin(radians(incidence)), 0)
        origin = Point3D(inner, 0, 0) - direction * 40
        for wavelength in WAVELENGTHS_NM:
            ray = Ray(
                origin, direction, min_wavelength=wavelength - 1e-6, max_wavelength=wavelength + 1e-6, bins=1
            )
            ray.trace(world)
            x, y = witness.direction.x, witness.direction.y
            print(f"({wavelength!r}, {incidence!r}, {x!r}, {y!r}),")


if __name__ == "__main__":
    main()
