"""Draws a scene in three designs and says how far each is from double precision: `python three_designs.py guitar.ply`."""

import sys

import splatline

scene = splatline.load(sys.argv[1])
camera = splatline.Camera.look_at(eye=(5.5, -2.1, 0.2), target=(0.1, -2.1, 0.1), up=(0, -1, 0), size=(512, 512))
reference = splatline.render(scene, camera, engine="float")
for design in ("lean18", "standard24", "deep32"):
    picture = splatline.render(scene, camera, design)
    colour = splatline.metrics(picture, reference)["rgb"]
    print(f"{design}: {colour['psnr_db']:.3f} dB, largest error {colour['max_abs']:.2e}")
    picture.save(f"{design}.png")
