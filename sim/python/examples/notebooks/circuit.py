# %% [markdown]
# # A circuit checked by cocotb
#
# The kernel's stages are functions here, in its own integers. First a splat by hand, from its packet to its pixels.

# %%
import subprocess
import sys

import splatline

scene = splatline.load("random:120")
stages = splatline.Stages(scene, splatline.Camera.framing(scene, size=(64, 32)))
packets = stages.setup().sorted()
packets["centre_u"][:4]

# %%
inside = stages.radial(packets.words[0])
weight = stages.weight(inside["radial"])
opacity = stages.opacity(packets["peak"].raw[0], weight)
inside["radial"][:4], weight[:4], opacity[:4]

# %% [markdown]
# A bench holds `splat_primitive` in Icarus Verilog against the same stages: every packet, span and pixel in the cycle in which it is handed over.

# %%
bench = subprocess.run([sys.executable, "../primitive/run.py"], capture_output=True, text=True)
print(next(line.split("  ")[-1].strip() for line in (bench.stdout + bench.stderr).splitlines() if "differences" in line))
