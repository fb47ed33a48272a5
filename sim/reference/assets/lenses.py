"""Writes lenses.tsv: pixels of rays by COLMAP's own lenses. pip install pycolmap numpy; python lenses.py > lenses.tsv"""

import numpy as np
import pycolmap

MODELS = {
    "SIMPLE_RADIAL": [900, 640, 360, -0.12],
    "RADIAL": [900, 640, 360, -0.12, 0.03],
    "OPENCV": [900, 910, 640, 360, -0.2, 0.05, 0.001, -0.002],
    "OPENCV_FISHEYE": [600, 610, 640, 360, 0.05, -0.01, 0.003, -0.0005],
    "FULL_OPENCV": [900, 910, 640, 360, -0.2, 0.05, 0.001, -0.002, 0.01, 0.02, -0.01, 0.004],
    "FOV": [600, 610, 640, 360, 0.9],
    "SIMPLE_RADIAL_FISHEYE": [600, 640, 360, 0.05],
    "RADIAL_FISHEYE": [600, 640, 360, 0.05, -0.01],
    "THIN_PRISM_FISHEYE": [600, 610, 640, 360, 0.05, -0.01, 0.001, -0.002, 0.003, -0.0005, 0.0007, -0.0003],
}
RAYS = [(0.0, 0.0), (0.3, -0.2), (-0.7, 0.35), (0.05, 0.4), (0.66, 0.39)]

print("# pycolmap", pycolmap.__version__)
for model, parameters in MODELS.items():
    camera = pycolmap.Camera(model=model, width=1280, height=720, params=parameters)
    for x, y in RAYS:
        u, v = np.ravel(camera.img_from_cam(np.array([x, y, 1.0])))
        words = [model, " ".join(map(str, parameters)), repr(x), repr(y), repr(float(u)), repr(float(v))]
        print("\t".join(words))
