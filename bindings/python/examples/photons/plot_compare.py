"""
Two runs compared
=================

Are two runs of photons from one distribution? `compare` tests histories, ends, times and wavelengths by chi squared: first two
runs of one detector with different seeds, then with a reflectance that differs by two per cent.
"""

import matplotlib.pyplot as plt

import rayweave.photons as photons

BAR = """
<gdml>
  <define>
    <matrix name="INDEX" coldim="2" values="1.5*eV 1.79 4*eV 1.79"/>
    <matrix name="LENGTH" coldim="2" values="1.5*eV 400 4*eV 400"/>
    <matrix name="WRAP" coldim="2" values="1.5*eV REFLECTANCE 4*eV REFLECTANCE"/>
  </define>
  <materials>
    <material name="Crystal" Z="55"><D value="4.51"/><atom value="133"/>
      <property name="RINDEX" ref="INDEX"/><property name="ABSLENGTH" ref="LENGTH"/></material>
    <material name="Opaque" Z="55"><D value="2"/><atom value="133"/></material>
  </materials>
  <solids>
    <box name="Room" x="200" y="200" z="200" lunit="mm"/>
    <box name="BarBox" x="20" y="20" z="100" lunit="mm"/>
    <opticalsurface name="Wrapping" model="unified" finish="groundfrontpainted" type="dielectric_dielectric" value="0">
      <property name="REFLECTIVITY" ref="WRAP"/></opticalsurface>
  </solids>
  <structure>
    <volume name="Bar"><materialref ref="Crystal"/><solidref ref="BarBox"/></volume>
    <volume name="World"><materialref ref="Opaque"/><solidref ref="Room"/>
      <physvol name="bar"><volumeref ref="Bar"/></physvol></volume>
    <skinsurface name="wrap" surfaceproperty="Wrapping"><volumeref ref="Bar"/></skinsurface>
  </structure>
  <setup name="Default" version="1.0"><world ref="World"/></setup>
</gdml>
"""


def histories(reflectance: float, seed: int) -> photons.Histories:
    """The recorded steps of 10,000 photons."""
    detector = photons.loads(BAR.replace("REFLECTANCE", str(reflectance)))
    return detector.simulate(photons.point([0, 0, 0], 550), n=10_000, seed=seed, record="steps").histories


first = histories(0.95, 1)
figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), sharey=True, layout="constrained")
for axis, other, title in zip(
    axes, (histories(0.95, 2), histories(0.93, 2)), ("another seed", "reflectance 0.93, not 0.95"), strict=True
):
    comparison = photons.compare(first, other)
    names = list(comparison.quantities)
    values = [comparison[name].p for name in names]
    axis.bar(names, [max(p, 1e-20) for p in values])
    axis.axhline(0.01, color="gray", ls=":")
    axis.set(yscale="log", title=title)
    print(title, {name: float(f"{p:.2g}") for name, p in zip(names, values, strict=True)})
axes[0].set_ylabel("probability p")
