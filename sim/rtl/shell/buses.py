"""What the benches of both shells share: registers by AXI4-Lite, a reset that leaves them as their map says, and pauses of a bus."""

import json
import logging
import random
from pathlib import Path

from cocotb.triggers import ClockCycles
from cocotbext.axi import AxiLiteBus, AxiLiteMaster


def offsets(name):
    """Offsets of a map's registers by their names, in their order."""
    registers = json.loads(Path(__file__).with_name(name).read_text())["registers"]
    return {register["name"]: int(register["offset"], 16) for register in registers}


def reset_values(name, but):
    """What registers hold after a reset, by their offsets, all but one that depends on something else."""
    registers = json.loads(Path(__file__).with_name(name).read_text())["registers"]
    return {int(register["offset"], 16): int(register.get("reset", "0"), 16) for register in registers if register["name"] != but}


def pauses(seed, share):
    """True in `share` of 100 cycles: the bus waits."""
    numbers = random.Random(seed)
    while True:
        yield numbers.randrange(100) < share


class RegisterBoard:
    """The bus of the registers around a circuit."""

    def __init__(self, dut, values, buses):
        """`values` are those after a reset; of `buses`, tens of thousands of lines would be no log."""
        for bus in ("s_axil", *buses):
            logging.getLogger(f"cocotb.{dut._name}.{bus}").setLevel(logging.ERROR)
        self.dut = dut
        self.values = values
        self.reset_port = {"reset": dut.aresetn, "reset_active_level": False}
        self.registers = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.aclk, **self.reset_port)

    async def reset(self):
        self.dut.aresetn.value = 0
        await ClockCycles(self.dut.aclk, 8)
        self.dut.aresetn.value = 1
        await ClockCycles(self.dut.aclk, 4)
        for address, value in self.values.items():
            found = await self.read(address)
            assert found == value, f"the register at {address:#x} is {found:#x} after a reset"

    async def write(self, address, value):
        await self.registers.write_dword(address, value)

    async def read(self, address):
        return await self.registers.read_dword(address)
