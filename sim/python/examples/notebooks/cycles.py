# %% [markdown]
# # Cycles of a machine
#
# The cycle model says what every unit did with its time: it worked, it waited, and for what.

# %%
import matplotlib.pyplot as plt
import splatline

scene = splatline.load("random:20000")
camera = splatline.Camera.framing(scene, size=(320, 240))
for lanes in (1, 2, 4, 8, 16):
    record = splatline.simulate(scene, camera, machine=splatline.Machine("machine-1", lanes=lanes))
    pace = record["pace"]
    print(f"{lanes:2} lanes: {record['cycles']['total']:9,} cycles, {pace['frames_per_s']:6.1f} frames a second, {record['area']['luts_in_all']:,.0f} LUT")

# %%
units = splatline.simulate(scene, camera, machine=splatline.Machine("machine-4")).units
left = 0
for account in [name for name in units.dtype.names if name != "name" and units[name].any()]:
    plt.barh(units["name"], units[account], left=left, label=account)
    left = left + units[account]
plt.xlabel("cycles of a picture, over all instances of a unit")
plt.legend(fontsize="small");
