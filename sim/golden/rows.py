"""Sections 5 and 6 of docs/specification.md: rows and their runs, by spans and by boxes."""

from arithmetic import *

BLOCK = 32
BALANCE = 8
SLACK = 10
BOX = 36
BOX_LANE = 64


class Constants:
    """What the rows of a footprint have in common: (5.1) to (5.4)."""

    def __init__(self, widths, print):
        self.half = reach_of_rows(print)
        self.centre_fraction = centre_fraction(widths, print, self.half)
        self.vertical_fraction = vertical_fraction(widths)
        self.columns = balance(print.ldl[0], widths.radial)
        self.rows = balance(print.ldl[3], self.vertical_fraction)
        self.shifts = seed_shifts(widths, print, self.half, self.centre_fraction)


def reach_of_rows(print):
    """(5.1) |dx| < 2^half pixels within a row."""
    return (leading(print.ldl[1]) + 6) >> 1


def centre_fraction(widths, print, half):
    """(5.1) Fraction bits of xc down the rows."""
    wide = half > 13 or leading(print.ldl[2]) > 12
    return widths.subpixel - 2 if wide else widths.subpixel + 8


def vertical_fraction(widths):
    """(5.1) Fraction bits of C dy^2 down the rows."""
    return max(widths.radial, 22) + 4


def balance(coefficient, fraction):
    """(5.2) Twice A (or C) in the unit of its sequence, and what seeds add for its rounding."""
    fine = fixed(coefficient, fraction + BALANCE)
    second = nearest(fine, BALANCE - 1)
    rounded = second << (BALANCE - 1)
    excess = rounded - fine
    unit = nearest(rounded - excess * BLOCK, BALANCE)
    return second, unit, nearest(excess * BLOCK * BLOCK // 8, BALANCE)


def distance(widths, print, axis, first):
    """(5.3), (6.1) From the centre to a row's (column's) sample point, pixels."""
    sample = (2 * first + 1) << (widths.subpixel - 1)
    return normalised(sample - print.centre[axis], -widths.subpixel, widths.mantissa)


def seed_centre(widths, print, constants, dy):
    """(5.4) xc - 1/2 where a block of rows begins, Q.f."""
    start = print.centre[0] - (1 << (widths.subpixel - 1))
    moved = fixed(product(print.ldl[2], dy), constants.centre_fraction)
    return nearest(start, widths.subpixel - constants.centre_fraction) + moved


def seed_vertical(widths, print, constants, dy):
    """(5.5) C dy^2 there and its difference, Q.g."""
    _, unit, start = constants.rows
    along = multiplied(print.ldl[3], dy, widths.mantissa)
    value = fixed(product(along, dy), constants.vertical_fraction)
    return value + start, fixed(scaled(along, 1), constants.vertical_fraction) + unit


def reach(constants, cutoff):
    """(5.6) Cut-off and slack, Q.g."""
    fraction = constants.vertical_fraction
    return nearest(cutoff, 28 - fraction) + (1 << (fraction - SLACK))


def half_width(print, constants, rest):
    """(5.7) sqrt(rest / A) in Q31.32 for rest in UQ.g, not 0."""
    mantissa, exponent = print.ldl[1]
    odd = exponent & 1
    squared = mantissa * (rest >> (constants.vertical_fraction - 24))
    root, shift = root_seed(squared << odd)
    return fixed((root, shift + (exponent - odd) // 2 + 20), 0)


def span(print, constants, centre, rest):
    """(5.8) First column and one past the last, within the box."""
    left, right = print.first[0], print.end[0]
    if rest <= 0:
        return left, left
    half = half_width(print, constants, rest)
    low = -((half - centre) >> 32)
    high = ((centre + half) >> 32) + 1
    return max(min(low, right), left), max(min(high, right), left)


def span_rows(widths, print, constants):
    """(5.9) The rows of a footprint: row, xc - 1/2 (Q.32), C dy^2, first column, one past the last."""
    up = 32 - constants.centre_fraction
    shear = fixed(print.ldl[2], constants.centre_fraction)
    second, end = constants.rows[0], reach(constants, print.cutoff)
    for y in range(print.first[1], print.end[1]):
        if y == print.first[1] or y % BLOCK == 0:
            dy = distance(widths, print, 1, y)
            centre = seed_centre(widths, print, constants, dy)
            value, first = seed_vertical(widths, print, constants, dy)
        yield (y, centre << up, value, *span(print, constants, centre << up, end - value))
        centre, value, first = centre + shear, value + first, first + second


def seed_shifts(widths, print, half, centre_fraction):
    """(5.10) Right shifts of dx, of r and of its difference."""
    bits = widths.mantissa
    drop = max(min(half + 32 - bits, 63), 32 - centre_fraction)
    power = print.ldl[0][1] + drop - 32
    return drop, -(power + drop - 32 + bits + widths.radial), -(power + 1 + widths.radial)


def seed(widths, print, constants, x, centre, vertical):
    """(5.11) r, its difference and its second difference at column x."""
    bits, lane = widths.mantissa, widths.lane
    drop, drop_radial, drop_first = constants.shifts
    second, unit, start = constants.columns
    dx = nearest((x << 32) - centre, drop)
    along = print.ldl[0][0] * dx
    across = nearest(along, bits) * dx
    below = nearest(vertical, constants.vertical_fraction - widths.radial)
    radial = nearest(across, drop_radial) + below + start
    first = nearest(along, drop_first) + unit
    return wrapped(radial, lane), wrapped(first, lane), wrapped(second, lane)


def span_runs(widths, print):
    """(5.12) The runs of a footprint: row, column, length and three lane words."""
    constants = Constants(widths, print)
    for y, centre, vertical, x, end in span_rows(widths, print, constants):
        while x < end:
            stop = min(x - x % BLOCK + BLOCK, end)
            yield (y, x, stop - x, *seed(widths, print, constants, x, centre, vertical))
            x = stop


def box_runs(widths, print):
    """(6.2) One run a row over the whole bounding box, Q27.36."""
    bits = widths.mantissa
    dx, dy = [distance(widths, print, axis, print.first[axis]) for axis in range(2)]
    mantissas, exponent = print.conic
    a, b, c = [(mantissa, exponent) for mantissa in mantissas]
    adx, bdx, bdy, cdy = [multiplied(p, q, bits) for p, q in ((a, dx), (b, dx), (b, dy), (c, dy))]

    def word(number):
        return fixed(number, BOX)

    def squared(p, q):
        return fixed(product(p, q), BOX)

    value = squared(adx, dx) + 2 * squared(bdx, dy) + squared(cdy, dy)
    down = 2 * (word(cdy) + word(bdx)) + word(c)
    across = 2 * (word(adx) + word(bdy)) + word(a)
    width = print.end[0] - print.first[0]
    for y in range(print.first[1], print.end[1]):
        lanes = [wrapped(n, BOX_LANE) for n in (value, across, 2 * word(a))]
        yield (y, print.first[0], width, *lanes)
        value, down, across = value + down, down + 2 * word(c), across + 2 * word(b)
