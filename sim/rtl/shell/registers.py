"""Writes what drivers need of the register maps: for `registers.json` `splat_axi.svd` (CMSIS-SVD, for debuggers and
svd2rust) and `splat_axi.h` (C), and for `machine.json` `machine_axi.svd` and `machine_axi.h`.

    python3 sim/rtl/shell/registers.py            writes them beside itself
    python3 sim/rtl/shell/registers.py --check    fails if one is not what it would write, or if a shell decodes another
                                                  address
"""

import json
import re
import sys
from pathlib import Path
from xml.sax.saxutils import escape

HERE = Path(__file__).resolve().parent
MAPS = {"splat_axi": "registers.json", "machine_axi": "machine.json"}

# What drivers do with several registers: a comment, a function, its arguments, and the register and word of each write.
TABLE = ("Writes an entry of the footprint table.", "table", "index low step", (
    ("TABLE_INDEX", "index"), ("TABLE_LOW", "low"), ("TABLE_STEP", "step")))
FUNCTIONS = {
    "splat_axi": (
        ("Begins the tile of columns first .. last and rows top .. end (each one past the last); "
         "its packets follow on the stream.",
         "begin", "first top last end", (
             ("FIRST", "top << 16 | first"), ("LAST", "end << 16 | last"), ("CONTROL", "SPLAT_AXI_CONTROL_BEGIN"))),
        TABLE),
    "machine_axi": (
        ("Writes a constant of camera and rules.", "constant", "index low high exponent", (
            ("CONSTANT_INDEX", "index"), ("CONSTANT_LOW", "low"), ("CONSTANT_HIGH", "high"),
            ("CONSTANT_EXPONENT", "exponent"))),
        TABLE,
        ("Begins a frame of this size; where everything lies has been written.", "begin", "columns rows", (
            ("SIZE", "rows << 16 | columns"), ("CONTROL", "MACHINE_AXI_CONTROL_BEGIN")))),
}


def function(shell, comment, name, arguments, writes):
    """A C function that writes registers."""
    listed = ", ".join(f"uint32_t {argument}" for argument in arguments.split())
    lines = [f"/* {comment} */", f"static inline void {shell}_{name}(uintptr_t base, {listed}) {{"]
    lines += [f"  {shell}_write(base, {shell.upper()}_{register}, {word});" for register, word in writes]
    return lines + ["}", ""]


def header(shell, source):
    """The C header of a shell, from its map."""
    name = source["name"]
    guard = f"{name}_H"
    lines = ["/* " + source["description"], f"   Written by registers.py from {MAPS[shell]}. */"]
    lines += [f"#ifndef {guard}", f"#define {guard}", "", "#include <stdint.h>", ""]
    for register in source["registers"]:
        prefix = f"{name}_{register['name'].upper()}"
        lines += [f"/* {register['description']} ({register['access']}) */", f"#define {prefix} {register['offset']}u"]
        for field in register.get("fields", []):
            high, low = field["bits"]
            mask = ((1 << (high - low + 1)) - 1) << low
            lines += [f"/* {field['description']} */", f"#define {prefix}_{field['name'].upper()} 0x{mask:x}u"]
    lines += [
        "",
        f"static inline uint32_t {shell}_read(uintptr_t base, uint32_t offset) "
        "{ return *(volatile const uint32_t *)(base + offset); }",
        f"static inline void {shell}_write(uintptr_t base, uint32_t offset, uint32_t value) "
        "{ *(volatile uint32_t *)(base + offset) = value; }",
        "",
    ]
    for described in FUNCTIONS[shell]:
        lines += function(shell, *described)
    return "\n".join(lines + ["#endif", ""])


def svd(source):
    """The CMSIS-SVD description of a map."""

    def element(name, text):
        return f"<{name}>{escape(str(text))}</{name}>"

    registers = ""
    for register in source["registers"]:
        fields = ""
        for field in register.get("fields", []):
            high, low = field["bits"]
            fields += "<field>" + element("name", field["name"]) + element("description", field["description"])
            fields += element("bitRange", f"[{high}:{low}]")
            fields += "".join(element(key, field[key]) for key in ("access", "modifiedWriteValues") if key in field) + "</field>\n"
        registers += "<register>" + element("name", register["name"]) + element("description", register["description"])
        registers += element("addressOffset", register["offset"]) + element("access", register["access"])
        registers += element("resetValue", register["reset"]) if "reset" in register else ""
        registers += (f"\n<fields>\n{fields}</fields>" if fields else "") + "</register>\n"
    return f"""<?xml version="1.0" encoding="utf-8"?>
<device schemaVersion="1.3" xmlns:xs="http://www.w3.org/2001/XMLSchema-instance">
{element("vendor", "splatline")}{element("name", source["name"])}{element("version", "1.0")}{element("description", source["description"])}
{element("addressUnitBits", 8)}{element("width", 32)}{element("size", 32)}{element("resetValue", 0)}
<peripherals><peripheral>
{element("name", source["name"])}{element("version", "1.0")}{element("description", source["description"])}{element("baseAddress", "0x0")}
<addressBlock>{element("offset", "0x0")}{element("size", "0x80")}{element("usage", "registers")}</addressBlock>
<registers>
{registers}</registers>
</peripheral></peripherals>
</device>
"""


def check_circuit(shell, source):
    """Addresses that the circuit decodes for writing and reading are those of the map that may be written or read."""
    text = (HERE / f"{shell}.sv").read_text()
    reads = {4 * int(word) for word in re.findall(r"5'd(\d+): s_axil_rdata", text)}
    writes = {4 * int(word) for word in re.findall(r"5'd(\d+): \w+(?:\[[\d:]+\])? <= s_axil_wdata", text)} | {0}
    for access, found in (("read", reads), ("write", writes)):
        mapped = {int(register["offset"], 16) for register in source["registers"] if access in register["access"]}
        if mapped != found:
            sys.exit(f"{MAPS[shell]} and {shell}.sv differ in what they {access}: {sorted(mapped ^ found)}")


def main():
    for shell, name in MAPS.items():
        source = json.loads((HERE / name).read_text())
        check_circuit(shell, source)
        for path, text in ((HERE / f"{shell}.svd", svd(source)), (HERE / f"{shell}.h", header(shell, source))):
            if sys.argv[1:] != ["--check"]:
                path.write_text(text)
            elif not path.exists() or path.read_text() != text:
                sys.exit(f"{path.name} is not what registers.py writes")


if __name__ == "__main__":
    main()
