"""Section 4 of docs/specification.md: the footprint table."""

from arithmetic import nearest

ONE = 1 << 60


def exponential(x):
    """(4.1) exp(-x) for x of [0, 4], UQ4.60."""
    small, term, total, n = x >> 4, ONE, 0, 0
    while term:
        total += -term if n & 1 else term
        n += 1
        term = term * small // n // ONE
    for _ in range(4):
        total = total * total >> 60
    return total


def rest_bits(widths, table_range):
    """(4.3) Bits of a radial index below the table's index."""
    return widths.radial + table_range - widths.table


def gaussian_table(widths, table_range):
    """(4.2) exp(-r/2) on 0 to 2^range in 2^table intervals, UQ1.weight."""
    step = (1 << (60 + table_range)) >> widths.table
    factor = exponential(step // 2)
    if widths.interpolation == 0:
        value = exponential(step // 2 // 2)
    else:
        chord = (step * step >> 60) // 48
        cut = step >> (widths.interpolation + 2)
        if widths.interpolation >= rest_bits(widths, table_range):
            cut = 0
        value = ONE - chord - cut
    entries = []
    for _ in range((1 << widths.table) + 1):
        entries.append(nearest(value, 60 - widths.weight))
        value = (value * factor + (ONE >> 1)) >> 60
    return entries


class Table:
    """A table with the two counts of bits by which it is read."""

    def __init__(self, widths, table_range):
        self.entries = gaussian_table(widths, table_range)
        self.rest = rest_bits(widths, table_range)
        self.kept = min(widths.interpolation, self.rest)


def kernel_value(table, radial):
    """(4.3) The kernel at a radial index of UQ4.radial, UQ1.weight."""
    index, kept = radial >> table.rest, table.kept
    low = table.entries[index]
    if not kept:
        return low
    position = (radial >> (table.rest - kept)) & ((1 << kept) - 1)
    return low + nearest((table.entries[index + 1] - low) * position, kept)
