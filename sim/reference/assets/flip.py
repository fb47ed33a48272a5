"""Writes flip.tsv: FLIP of two pictures by the authors' own package. pip install flip-evaluator; python flip.py > flip.tsv"""

import flip_evaluator
import numpy as np

WIDTH, HEIGHT = 40, 28


def picture(shift):
    """Both pictures from whole numbers, so that the test can make them again."""
    y, x, c = np.mgrid[0:HEIGHT, 0:WIDTH, 0:3]
    smooth = (5 * x + 3 * y * (c + 1)) % 256
    blocks = 90 * ((x // 7 + y // 5 + c) % 2)
    noise = (shift * (37 * x + 101 * y + 53 * c + x * y)) % 41
    return ((smooth // 2 + blocks + noise) / 255).astype(np.float32)


print(f"# flip-evaluator {flip_evaluator.__version__ if hasattr(flip_evaluator, '__version__') else '1.7'}")
reference, test = picture(0), picture(1)
for ppd in (67.0206432765823, 31.5):
    values, mean, _ = flip_evaluator.evaluate(
        reference, test, "LDR", inputsRGB=True, applyMagma=False, computeMeanError=True, parameters={"ppd": ppd}
    )
    print("\t".join([repr(ppd), repr(float(mean))] + [f"{v:.7g}" for v in np.asarray(values).ravel()]))
