"""
A detector in GDML
==================

A GDML file of Geant4 becomes a model with a region for each volume. The file here has a calorimeter of ten copies of a
layer of lead and scintillator.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

LAYERS = "".join(
    f'<physvol name="layer{k}" copynumber="{k}"><volumeref ref="Layer"/>'
    f'<position name="p{k}" unit="mm" z="{15 * k - 67.5}"/></physvol>'
    for k in range(10)
)
GDML = f"""
<gdml>
  <materials>
    <material name="Air" Z="7"><D value="0.00129"/><atom value="14"/></material>
    <material name="Lead" Z="82"><D value="11.35"/><atom value="207.2"/></material>
    <material name="Plastic" Z="6"><D value="1.03"/><atom value="12"/></material>
  </materials>
  <solids>
    <box name="HallBox" x="400" y="400" z="400" lunit="mm"/>
    <box name="LayerBox" x="100" y="100" z="15" lunit="mm"/>
    <box name="LeadBox" x="100" y="100" z="5" lunit="mm"/>
    <box name="TileBox" x="100" y="100" z="8" lunit="mm"/>
  </solids>
  <structure>
    <volume name="Absorber"><materialref ref="Lead"/><solidref ref="LeadBox"/></volume>
    <volume name="Tile"><materialref ref="Plastic"/><solidref ref="TileBox"/></volume>
    <volume name="Layer"><materialref ref="Air"/><solidref ref="LayerBox"/>
      <physvol name="a"><volumeref ref="Absorber"/><position name="pa" unit="mm" z="-5"/></physvol>
      <physvol name="t"><volumeref ref="Tile"/><position name="pt" unit="mm" z="2"/></physvol>
    </volume>
    <volume name="Hall"><materialref ref="Air"/><solidref ref="HallBox"/>{LAYERS}</volume>
  </structure>
  <setup name="Default" version="1.0"><world ref="Hall"/></setup>
</gdml>
"""

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "calorimeter.gdml"
    path.write_text(GDML, encoding="utf-8")
    model = rw.load(path)
print(model)

figure, axis = plt.subplots(figsize=(6, 4), layout="constrained")
parts = {name: solid for name, solid in model.solids.items() if name in ("Absorber", "Tile")}
axis.imshow(rw.render(parts, size=(600, 400), cut="x>50%"))
axis.axis("off")

# %%
# The amount of lead along a ray:
pieces = model.partition([0, 0, -100], [0, 0, 1], t_min=0, t_max=200).to_pandas()
lead = (pieces["t_end"] - pieces["t_start"])[pieces["medium"] == "Lead"].sum()
print(f"{lead} mm of lead")
assert np.isclose(lead, 50)
