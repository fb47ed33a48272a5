"""Reads a folder of vectors: manifest.json and one file per stage, a record a line."""

import json
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace as Values


class Folder:
    """The manifest's constants by name, and the stages' records."""

    def __init__(self, path):
        self.path = Path(path)
        self.manifest = json.loads((self.path / "manifest.json").read_text())
        self.stages = {stage["name"]: stage for stage in self.manifest["stages"]}
        self.constants = {c["name"]: c["value"] for c in self.manifest["constants"]}
        self.kept = {}

    def names(self, stage):
        """The names of a stage's fields."""
        return [field["name"] for field in self.stages[stage]["fields"]]

    def records(self, stage):
        """The records of a stage, each a list of values in the order of its fields."""
        if stage in self.kept:
            yield from self.kept[stage]
            return
        fields = self.stages[stage]["fields"]
        places = [(f["offset"], (1 << f["bits"]) - 1, f["signed"] << (f["bits"] - 1)) for f in fields]
        with open(self.path / self.stages[stage]["file"]) as lines:
            for line in lines:
                if not line.startswith("//"):
                    word = int(line, 16)
                    yield [((word >> at & mask) ^ sign) - sign for at, mask, sign in places]

    def keep(self):
        """Holds all records in memory, for many checks of one folder."""
        self.kept = {stage: list(self.records(stage)) for stage in self.stages}
        _ = self.splats, self.prints
        return self

    def widths(self):
        """The design's widths."""
        design = self.manifest["design"]
        lane = self.constants["lane_bits"]
        return Values(**design["widths"], rounding=design["rounding"], lane=lane)

    def traversal(self):
        """`spans` or `box`."""
        return self.manifest["design"]["traversal"]

    def rules(self):
        """The rules' constants."""
        c = self.constants
        return Values(
            normalised=c["normalised"],
            compensated=c["compensated"],
            low_pass=(c["low_pass_mantissa"], c["low_pass_exponent"]),
            spacing=(c["spacing_mantissa"], c["spacing_exponent"]),
            inverse_integral=(c["inverse_integral_mantissa"], c["inverse_integral_exponent"]),
            cutoff=None if c["cutoff_by_opacity"] else c["cutoff"],
            kernel="gaussian",
            kernel_end=c["kernel_end"],
            alpha_max=c["alpha_max"],
            alpha_min=c["alpha_min"],
            minimum_transmittance=c["minimum_transmittance"],
            omit_finishing=c["omit_finishing"],
            clamp_jacobian=c["clamp_jacobian"],
            table_range=c["table_range"],
        )

    def view(self):
        """The camera."""
        v = self.manifest["view"]
        return Values(
            rotation=v["rotation_q1_30"],
            rotation_rest=v["rotation_rest_2_60"],
            eye=(v["eye_mantissas"], v["eye_exponent"]),
            focal=v["focal_mantissa_exponent"],
            principal=v["principal_q31_32"],
            near=tuple(v["near_mantissa_exponent"]),
            far=tuple(v["far_mantissa_exponent"]),
            viewport=v["viewport"],
            perspective=not v["orthographic"],
            ratio_low=v["ratio_low_q31_32"],
            ratio_high=v["ratio_high_q31_32"],
        )

    @cached_property
    def splats(self):
        """The inputs."""
        return [splat(record) for record in self.records("splats")]

    @cached_property
    def prints(self):
        """The footprints of packets, which vectors of systems do not have."""
        if "packets" not in self.stages:
            return []
        names = self.names("packets")
        return [print_of(names, record) for record in self.records("packets")]


def splat(record):
    """A splat from its record."""
    axes = [(record[at : at + 3], record[at + 3]) for at in (6, 10, 14)]
    centre = [tuple(record[at : at + 2]) for at in (0, 2, 4)]
    return Values(centre=centre, axes=axes, weight=tuple(record[18:20]), colour=record[20:23])


def print_of(names, record):
    """A packet's record as a footprint, by the fields of (3.1)."""
    f = dict(zip(names, record))

    def number(name):
        return f.get(f"{name}_mantissa"), f.get(f"{name}_exponent")

    return Values(
        centre=[f["centre_u"], f["centre_v"]],
        first=[f["first_column"], f["first_row"]],
        end=[f["end_column"], f["end_row"]],
        ldl=[number(name) for name in ("horizontal", "squared_width", "shear", "vertical")],
        conic=([f.get("conic_a"), f.get("conic_b"), f.get("conic_c")], f.get("conic_exponent")),
        cutoff=f["cutoff"],
        peak=f["peak"],
        colour=[f["red"], f["green"], f["blue"]],
        splat=f["splat"],
    )
