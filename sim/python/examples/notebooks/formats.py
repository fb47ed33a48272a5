# %% [markdown]
# # 16-bit float or 14-bit fixed: which is cheaper?
#
# The arithmetic of one lane, from the radial index to the blended pixel, in transistors of its products and sums as Yosys synthesises each
# alone (`synth; abc -g cmos`; no registers, no timing): an estimate that ranks formats, not a layout. Float units round to nearest and flush
# what is below their normal numbers (`lane_units.sv`). Both find the radial index from its neighbour's or its row's terms, floats by two
# products and three sums, which is less than they are drawn with. The fixed lane pays for its table's interpolation. Neither the table's
# memory nor the floats' exponential is counted, nor setup.

# %%
import subprocess
from functools import cache

import matplotlib.pyplot as plt
import splatline


@cache
def transistors(unit, **parameters):
    """Of a unit alone."""
    settings = " ".join(f"-set {name} {value}" for name, value in parameters.items())
    script = f"read_verilog -sv lane_units.sv; chparam {settings} {unit}; synth -flatten -top {unit}; abc -g cmos; stat -tech cmos"
    text = subprocess.run(["yosys", "-p", script], capture_output=True, text=True, check=True).stdout
    return int(text.rsplit("Estimated number of transistors:", 1)[1].split()[0])


def fixed_lane(w):
    """Radial index by two differences; interpolation, opacity, share; colours and their sums, what is left of the light."""
    products = [(w["weight"] - 2, w["interpolation"]), (w["peak"] + 4, w["weight"]), (w["transmittance"] + 1, w["alpha"])]
    products += 3 * [(w["transmittance"] + 1, w["colour"] + 4)]
    sums = 2 * [32] + [w["weight"] + 1, w["transmittance"] + 1] + 3 * [w["accumulator"] + 4]
    return sum(transistors("fixed_multiply", A=a, B=b) for a, b in products if b > 0) + sum(transistors("fixed_add", A=a) for a in sums)


FORMATS = {"fp32": (8, 23), "fp16": (5, 10), "bfloat16": (8, 7), "e4m3": (4, 3), "e5m2": (5, 2)}


def float_lane(raster, kernel, blend):
    total = 0
    for form, products, sums in ((raster, 2, 3), (kernel, 1, 0), (blend, 5, 4)):
        E, F = FORMATS[form]
        total += products * transistors("float_multiply", E=E, F=F) + sums * transistors("float_add", E=E, F=F)
    return total


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
