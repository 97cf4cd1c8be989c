"""
Properties and probable mistakes
================================

The optical properties of a material by wavelength, and what `check` says about a file with mistakes.
"""

import rayweave.photons as photons

TANK = """
<gdml>
  <define>
    <matrix name="INDEX" coldim="2" values="1.8*eV 1.330 2.5*eV 1.337 3.2*eV 1.344 4*eV 1.355"/>
    <matrix name="LENGTH" coldim="2" values="1.8*eV 2000 2.5*eV 20000 3.2*eV 15000 4*eV 5000"/>
    <matrix name="WRONG" coldim="2" values="1.8 0.9 4 0.9"/>
  </define>
  <materials>
    <material name="Sea" Z="8"><D value="1"/><atom value="16"/>
      <property name="RINDEX" ref="INDEX"/><property name="ABSLENGTH" ref="LENGTH"/></material>
  </materials>
  <solids>
    <box name="Room" x="1000" y="1000" z="1000" lunit="mm"/>
    <opticalsurface name="Wall" model="unified" finish="polished" type="dielectric_metal" value="0">
      <property name="REFLECTIVITY" ref="WRONG"/></opticalsurface>
  </solids>
  <structure>
    <volume name="World"><materialref ref="Sea"/><solidref ref="Room"/></volume>
    <skinsurface name="wall" surfaceproperty="Wall"><volumeref ref="World"/></skinsurface>
  </structure>
  <setup name="Default" version="1.0"><world ref="World"/></setup>
</gdml>
"""
detector = photons.loads(TANK)
print(detector.check())
sea = detector.material("Sea")
assert abs(sea.absorption_length.at(1239.84198 / 2.5) - 20000) < 1

drawing = sea.plot()
