r"""
Figure 3: geometry, mesh and materials
======================================

**The paper:** (a) global geometry, (b) mesh of a period and (c) dimensions and materials in a
section of the tyre. Rubber is blue, steel-reinforced rubber magenta, steel red. The exterior
radius is 0.278 m, the interior one 0.168 m; the geometry is that of a 165/65R13.

**Ours** has these radii, the materials of the paper's table 1 and its number of nodes, read as
those of a section: 173. All other sizes are ours, as is which material is where.
"""

from pathlib import Path
from tempfile import mkdtemp

from measures import case_of

import tyrefrf
from tyrefrf.plots import draw_plots
from tyrefrf.study.estimate import estimate

case = case_of(7, frequency={"stop": 100.0, "step": 50.0, "adaptive": False})
results = tyrefrf.run(case, jobs=1)
drawn = {path.stem: path for path in draw_plots(results, mkdtemp())}
shown = [drawn["section"]]

# %%
# What is made of it, and what it weighs:

found = estimate(case, jobs=1)
assert (found.section_nodes, found.n_cells) == (173, 60)  # the paper's
print(f"{found.section_nodes} nodes, {found.section_elements} quadrilaterals in a section")
print(f"{found.n_cells} cells, {found.ring_nodes} nodes, {found.ring_dofs} dofs around the axle")
for material, mass in found.masses.items():
    print(f"{mass:.2f} kg of {material}")

# %%
# The whole tyre, here as a unit force in the middle of the tread bends it at 70 Hz, near its first
# resonance:

(deflection,) = tyrefrf.deflections(case, [70.0])
shown = draw_plots(deflection, Path(mkdtemp()))
