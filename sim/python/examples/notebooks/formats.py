# %% [markdown]
# # 16-bit float or 14-bit fixed: which is cheaper?
#
# The arithmetic of one lane, from the radial index to the blended pixel, in transistors of its products and sums as Yosys synthesises each
# alone (`synth; abc -g cmos`; no registers, no timing): an estimate that ranks formats, not a layout. Float units round to nearest and flush
# what is below their normal numbers (`lane_units.sv`, `lane_units.py`). Both find the radial index from its neighbour's or its row's terms, floats by two
# products and three sums, which is less than they are drawn with. The fixed lane pays for its table's interpolation. Neither the table's
# memory nor the floats' exponential is counted, nor setup.

# %%
import matplotlib.pyplot as plt
import splatline
from lane_units import fixed_lane, float_lane

# %% [markdown]
# Fixed designs are fitted to a PSNR against double precision by `fit`; what floats reach is drawn with every operation rounded.

# %%
scene = splatline.load("random:2000")
camera = splatline.Camera.framing(scene, size=(128, 128))
reference = splatline.render(scene, camera, engine="float")
fixed = {}
for decibels in (25, 30, 35, 40, 45, 50, 60, 70, 80):
    found = splatline.fit(scene, {"psnr_db": decibels}, camera)
    widths = found["widths"]
    picture = splatline.render(scene, camera, splatline.Design("standard24", **widths))
    fixed[decibels] = (splatline.metrics(picture, reference)["rgb"]["psnr_db"], fixed_lane(widths), widths)
floats = {}
for engine, stages in {
    "fp32": ("fp32", "fp32", "fp32"),
    "fp16": ("fp16", "fp16", "fp16"),
    "bfloat16": ("bfloat16", "bfloat16", "bfloat16"),
    "fp8-fp16": ("fp16", "e4m3", "fp16"),
    "e5m2-fp16": ("fp16", "e5m2", "fp16"),
    "fp8": ("e4m3", "e4m3", "e4m3"),
}.items():
    picture = splatline.render(scene, camera, engine=engine)
    floats[engine] = (splatline.metrics(picture, reference)["rgb"]["psnr_db"], float_lane(*stages))
for decibels, (reached, cost, widths) in fixed.items():
    print(f"fixed for {decibels} dB  {reached:6.2f} dB  {cost:6} transistors a lane; transmittance {widths['transmittance']}, weight {widths['weight']} bits")
for engine, (reached, cost) in floats.items():
    print(f"{engine:15}  {reached:6.2f} dB  {cost:6} transistors a lane")

# %%
reached, cost, widths = fixed[40]
enough = {engine: price for engine, (decibels, price) in floats.items() if decibels >= 40}
cheapest = min(enough, key=enough.get)
print(f"at 40 dB: fixed {cost}, {cheapest} {enough[cheapest]} transistors a lane: {enough[cheapest] / cost:.1f} times as much")
print("widths of the fixed lane:", " ".join(f"{name} {bits}" for name, bits in widths.items()))

# %%
figure, axes = plt.subplots(figsize=(6, 4))
axes.plot([point[0] for point in fixed.values()], [point[1] for point in fixed.values()], "o-", label="fixed, fitted")
for engine, (decibels, price) in floats.items():
    axes.plot(decibels, price, "s", label=engine)
axes.axvline(40, color="grey", linewidth=0.5)
axes.set_yscale("log")
axes.set_xlabel("PSNR against double precision, dB")
axes.set_ylabel("transistors of a lane's arithmetic")
axes.legend()
figure.tight_layout()
