"""What the package costs beside the command line: `python sim/python/examples/pace.py [PAIRS]`.

A call's overhead is the time of a picture of one pixel. The 2,000 points of a space are run by `splatline sweep` on two threads and as a study on
two workers, in turn, each from nothing and with its start; several pairs, for machines that are not quiet.
"""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import splatline

SPACE = """
[design]
base = ["lean18", "standard24"]
mantissa = [14, 16, 18, 20, 22]
[machine]
tile_width = [8, 16]
lanes = [1, 2, 4, 8]
row_fifo = [2, 4, 8, 16, 32]
packet_fifo = [8, 16, 32, 64, 128]
"""
STUDY = """
import splatline
from splatline.study import Study
if __name__ == "__main__":
    plan = splatline.plan("random:2000", splatline.Camera.load("camera.json"))
    study = Study("study.sqlite", plan, open("space.toml").read())
    study.run(workers=2, progress=False)
    study.write("study")
"""


def seconds(words, folder):
    began = time.perf_counter()
    subprocess.run([sys.executable, *words], cwd=folder, check=True, capture_output=True)
    return time.perf_counter() - began


def overhead():
    scene = splatline.load("random:1")
    plan = splatline.plan(scene, splatline.Camera.framing(scene, size=(1, 1)))
    times = []
    for _ in range(201):
        began = time.perf_counter()
        splatline.render(plan)
        times.append(time.perf_counter() - began)
    return statistics.median(times)


def main():
    print(f"a call: {overhead() * 1e6:.0f} us with a picture of one pixel")
    ratios = []
    for pair in range(int(sys.argv[1]) if len(sys.argv) > 1 else 3):
        with tempfile.TemporaryDirectory() as folder:
            scene = splatline.load("random:2000")
            Path(folder, "camera.json").write_text(splatline.Camera.framing(scene, size=(128, 128)).to_json())
            Path(folder, "space.toml").write_text(SPACE)
            Path(folder, "program.py").write_text(STUDY)
            view = ["random:2000", "--camera", "camera.json", "--space", "space.toml"]
            runs = {"sweep": ["-m", "splatline", "sweep", *view, "--threads", "2", "-o", "sweep"], "study": ["program.py"]}
            order = list(runs) if pair % 2 else list(reversed(runs))
            took = {name: seconds(runs[name], folder) for name in order}
            points = [len(Path(folder, name, "points.csv").read_text().splitlines()) - 1 for name in runs]
        ratios.append(took["sweep"] / took["study"])
        print(f"{points[0]} points by sweep in {took['sweep']:.1f} s, {points[1]} by study in {took['study']:.1f} s: {ratios[-1]:.0%} of its speed")
    print(f"median: {statistics.median(ratios):.0%}")


if __name__ == "__main__":
    main()
