# %% [markdown]
# # A study on Slurm
#
# Any executor will do: here submitit, which makes the points one array of jobs. Without Slurm the same array runs as processes of this machine.

# %%
import logging
import shutil
import tempfile

import splatline
import submitit
from splatline.study import Study

space = """
[design]
base = ["lean18", "standard24"]
mantissa = [14, 16, 18]
[machine]
lanes = [1, 2, 4, 8]
"""
scene = splatline.load("random:2000")
plan = splatline.plan(scene, splatline.Camera.framing(scene, size=(128, 128)))
folder = tempfile.mkdtemp()
# A Slurm without accounting answers no sacct, which submitit says at every look.
logging.getLogger("submitit").setLevel(logging.ERROR)
executor = submitit.AutoExecutor(f"{folder}/logs", cluster="slurm" if shutil.which("sbatch") else "local")
executor.update_parameters(timeout_min=10, cpus_per_task=1)
study = Study(f"{folder}/study.sqlite", plan, space)
print(study.run(executor, workers=2), "points")

# %%
rows = study.frame()
rows[["base", "mantissa", "lanes", "psnr_db", "cycles", "area"]].sort_values("area").head(8)

# %% [markdown]
# Every point is in one SQLite file; who runs the study again runs what is missing. Optuna searches the same space and the same file.

# %%
found = study.search({"area": "minimize", "cycles": "minimize"}, limits={"psnr_db": (50, None)}, trials=16, executor=executor)
[(trial.values, trial.params) for trial in found.best_trials][:4]
