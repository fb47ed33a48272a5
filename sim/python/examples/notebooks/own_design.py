# %% [markdown]
# # A design of one's own against FP16
#
# `fit` looks for the smallest widths within a budget. What it finds is set beside a datapath of IEEE halves.

# %%
import splatline

scene = splatline.load("random:2000")
camera = splatline.Camera.framing(scene, size=(128, 128))
found = splatline.fit(scene, {"rms_error": 5e-4}, camera, "lean18")
mine = splatline.Design("lean18", **found["widths"])
print(f"bits in all: lean18 {sum(splatline.Design('lean18').widths.values())}, mine {sum(mine.widths.values())}; binding: {found['binding']}")
mine

# %%
reference = splatline.render(scene, camera, engine="float")
pictures = {
    "mine": splatline.render(scene, camera, mine),
    "lean18": splatline.render(scene, camera, "lean18"),
    "fp16": splatline.render(scene, camera, engine="fp16"),
    "bfloat16": splatline.render(scene, camera, engine="bfloat16"),
}
for name, picture in pictures.items():
    colour = splatline.metrics(picture, reference)["rgb"]
    print(f"{name:9} {colour['psnr_db']:6.2f} dB   largest {colour['max_abs']:.1e}   bias {colour['bias']:+.1e}")

# %%
pictures["mine"]
