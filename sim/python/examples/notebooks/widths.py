# %% [markdown]
# # Widths against error
#
# How many bits of a mantissa does a scene need? Every design is drawn by the kernel and compared with double precision.

# %%
import matplotlib.pyplot as plt
import splatline

scene = splatline.load("random:3000")
camera = splatline.Camera.framing(scene, size=(192, 192))
reference = splatline.render(scene, camera, engine="float")
bits = range(10, 27, 2)
for width in ("mantissa", "transmittance"):
    designs = [splatline.Design("standard24", **{width: n}) for n in bits]
    errors = [splatline.metrics(splatline.render(scene, camera, design), reference) for design in designs]
    plt.plot(bits, [error["rgb"]["psnr_db"] for error in errors], marker="o", label=width)
plt.xlabel("bits, all other widths as in standard24")
plt.ylabel("PSNR, dB")
plt.legend();
