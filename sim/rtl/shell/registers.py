"""Writes what drivers need of `registers.json`: `splat_axi.svd` (CMSIS-SVD, for debuggers and svd2rust) and `splat_axi.h` (C).

    python3 sim/rtl/shell/registers.py            writes both beside itself
    python3 sim/rtl/shell/registers.py --check    fails if one is not what it would write, or if splat_axi.sv decodes another address
"""

import json
import re
import sys
from pathlib import Path
from xml.sax.saxutils import escape

HERE = Path(__file__).resolve().parent
MAP = json.loads((HERE / "registers.json").read_text())
NAME, REGISTERS = MAP["name"], MAP["registers"]


def header():
    guard = f"{NAME}_H"
    lines = ["/* " + MAP["description"], "   Written by registers.py from registers.json. */", f"#ifndef {guard}", f"#define {guard}", "", "#include <stdint.h>", ""]
    for register in REGISTERS:
        prefix = f"{NAME}_{register['name'].upper()}"
        lines += [f"/* {register['description']} ({register['access']}) */", f"#define {prefix} {register['offset']}u"]
        for field in register.get("fields", []):
            high, low = field["bits"]
            mask = ((1 << (high - low + 1)) - 1) << low
            lines += [f"/* {field['description']} */", f"#define {prefix}_{field['name'].upper()} 0x{mask:x}u"]
    lines += [
        "",
        f"static inline uint32_t {NAME.lower()}_read(uintptr_t base, uint32_t offset) {{ return *(volatile const uint32_t *)(base + offset); }}",
        f"static inline void {NAME.lower()}_write(uintptr_t base, uint32_t offset, uint32_t value) {{ *(volatile uint32_t *)(base + offset) = value; }}",
        "",
        "/* Begins the tile of columns first .. last and rows top .. end (each one past the last); its packets follow on the stream. */",
        f"static inline void {NAME.lower()}_begin(uintptr_t base, uint32_t first, uint32_t top, uint32_t last, uint32_t end) {{",
        f"  {NAME.lower()}_write(base, {NAME}_FIRST, top << 16 | first);",
        f"  {NAME.lower()}_write(base, {NAME}_LAST, end << 16 | last);",
        f"  {NAME.lower()}_write(base, {NAME}_CONTROL, {NAME}_CONTROL_BEGIN);",
        "}",
        "",
        "/* Writes an entry of the footprint table. */",
        f"static inline void {NAME.lower()}_table(uintptr_t base, uint32_t index, uint32_t low, uint32_t step) {{",
        f"  {NAME.lower()}_write(base, {NAME}_TABLE_INDEX, index);",
        f"  {NAME.lower()}_write(base, {NAME}_TABLE_LOW, low);",
        f"  {NAME.lower()}_write(base, {NAME}_TABLE_STEP, step);",
        "}",
        "",
        "#endif",
        "",
    ]
    return "\n".join(lines)


def svd():
    def element(name, text):
        return f"<{name}>{escape(str(text))}</{name}>"

    registers = ""
    for register in REGISTERS:
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
{element("vendor", "splatline")}{element("name", NAME)}{element("version", "1.0")}{element("description", MAP["description"])}
{element("addressUnitBits", 8)}{element("width", 32)}{element("size", 32)}{element("resetValue", 0)}
<peripherals><peripheral>
{element("name", NAME)}{element("version", "1.0")}{element("description", MAP["description"])}{element("baseAddress", "0x0")}
<addressBlock>{element("offset", "0x0")}{element("size", "0x80")}{element("usage", "registers")}</addressBlock>
<registers>
{registers}</registers>
</peripheral></peripherals>
</device>
"""


def check_circuit():
    """Addresses that the circuit decodes for writing and reading are those of the map that may be written or read."""
    text = (HERE / "splat_axi.sv").read_text()
    reads = {4 * int(word) for word in re.findall(r"5'd(\d+): s_axil_rdata", text)}
    writes = {4 * int(word) for word in re.findall(r"5'd(\d+): \w+(?:\[[\d:]+\])? <= s_axil_wdata", text)} | {0}
    for access, found in (("read", reads), ("write", writes)):
        told = {int(register["offset"], 16) for register in REGISTERS if access in register["access"]}
        if told != found:
            sys.exit(f"registers.json and splat_axi.sv differ in what they {access}: {sorted(told ^ found)}")


def main():
    check_circuit()
    for name, text in (("splat_axi.svd", svd()), ("splat_axi.h", header())):
        path = HERE / name
        if sys.argv[1:] != ["--check"]:
            path.write_text(text)
        elif not path.exists() or path.read_text() != text:
            sys.exit(f"{name} is not what registers.py writes")


if __name__ == "__main__":
    main()
