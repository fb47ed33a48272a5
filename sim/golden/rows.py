"""Sections 5 and 6 of docs/specification.md: rows and their runs, by spans and by boxes."""

from arithmetic import *

BLOCK = 32
BALANCE = 8
SLACK = 1 << 42
BOX = 36
BOX_LANE = 64


class Constants:
    """What a footprint's rows are computed from."""


def first_distance(widths, print, axis):
    """(5.1), (6.1) From the centre to the first row's (column's) sample point, pixels."""
    sample = (2 * print.first[axis] + 1) << (widths.subpixel - 1)
    return normalised(sample - print.centre[axis], -widths.subpixel, widths.mantissa)


def first_centre(widths, print, dy):
    """(5.2) xc - 1/2 in the first row, Q31.32, and its step."""
    _, _, shear, _ = print.ldl
    moved = fixed(product(shear, dy), 32)
    start = (print.centre[0] << (32 - widths.subpixel)) - (1 << 31) + moved
    return start, fixed(shear, 32)


def first_vertical(widths, print, dy):
    """(5.3) C dy^2 in the first row, its difference and its second difference, Q11.52."""
    vertical = print.ldl[3]
    along = multiplied(vertical, dy, widths.mantissa)
    unit = fixed(vertical, 52)
    value = fixed(product(along, dy), 52)
    first = fixed(scaled(along, 1), 52) + unit
    return value, first, 2 * unit


def seed_shifts(widths, print):
    """(5.6) Right shifts of dx, of r and of its difference."""
    horizontal, squared_width, _, _ = print.ldl
    bits = widths.mantissa
    half = (leading(squared_width) + 6) >> 1
    drop = max(0, min(63, half + 32 - bits))
    power = horizontal[1] + drop - 32
    return drop, -(power + drop - 32 + bits + widths.radial), -(power + 1 + widths.radial)


def balance(widths, print):
    """(5.7) 2 A in the lanes' unit, and what seeds add for its rounding."""
    fine = fixed(print.ldl[0], widths.radial + BALANCE)
    second = nearest(fine, BALANCE - 1)
    rounded = second << (BALANCE - 1)
    excess = rounded - fine
    unit = nearest(rounded - excess * BLOCK, BALANCE)
    return second, unit, nearest(excess * BLOCK * BLOCK // 8, BALANCE)


def half_width(print, rest):
    """(5.4) sqrt(rest / A) in Q31.32 for rest in UQ4.52, not 0."""
    mantissa, exponent = print.ldl[1]
    odd = exponent & 1
    squared = mantissa * (rest >> 24)
    root, shift = root_seed(squared << odd)
    return fixed((root, shift + (exponent - odd) // 2 + 18), 0)


def span(print, centre, rest):
    """(5.5) First column and one past the last, within the box."""
    left, right = print.first[0], print.end[0]
    if rest <= 0:
        return left, left
    half = half_width(print, rest)
    low = -((half - centre) >> 32)
    high = ((centre + half) >> 32) + 1
    return max(min(low, right), left), max(min(high, right), left)


def seed(widths, print, constants, x, centre, vertical):
    """(5.8) r, its difference and its second difference at column x."""
    bits, lane = widths.mantissa, widths.lane
    drop, drop_radial, drop_first = constants.shifts
    second, unit, start = constants.balance
    dx = nearest((x << 32) - centre, drop)
    along = print.ldl[0][0] * dx
    across = nearest(along, bits) * dx
    radial = nearest(across, drop_radial) + nearest(vertical, 52 - widths.radial) + start
    first = nearest(along, drop_first) + unit
    return wrapped(radial, lane), wrapped(first, lane), wrapped(second, lane)


def span_rows(widths, print):
    """(5.9) The rows of a footprint: row, xc - 1/2, C dy^2, first column, one past the last."""
    dy = first_distance(widths, print, 1)
    centre, shear = first_centre(widths, print, dy)
    value, first, second = first_vertical(widths, print, dy)
    reach = (print.cutoff << 24) + SLACK
    for y in range(print.first[1], print.end[1]):
        yield (y, centre, value, *span(print, centre, reach - value))
        centre, value, first = centre + shear, value + first, first + second


def span_runs(widths, print):
    """(5.10) The runs of a footprint: row, column, length and three lane words."""
    constants = Constants()
    constants.shifts, constants.balance = seed_shifts(widths, print), balance(widths, print)
    for y, centre, vertical, x, end in span_rows(widths, print):
        while x < end:
            stop = min(x - x % BLOCK + BLOCK, end)
            yield (y, x, stop - x, *seed(widths, print, constants, x, centre, vertical))
            x = stop


def box_runs(widths, print):
    """(6.2) One run a row over the whole bounding box, Q27.36."""
    bits = widths.mantissa
    dx, dy = [first_distance(widths, print, axis) for axis in range(2)]
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
