"""Formulas 9.24 to 9.26 of docs/specification.md: spheres in perspective."""

import setup
from arithmetic import *
from surface import times

ONE = (1 << 30, -30)
MOST = 15 << 28
LIMIT = 1 << 50
EXACT, APPROXIMATE = range(2)
AFFINE, PERSPECTIVE, BY_RAYS = range(3)


def peak(widths, rules, weight, deviation):
    """(9.24) The opacity in the middle."""
    bits = widths.mantissa
    if weight[0] <= 0:
        return ZERO
    if not rules.normalised:
        return weight
    inverse = reciprocal(multiplied(deviation, deviation, bits), bits) or ZERO
    return multiplied(multiplied(weight, inverse, bits), rules.inverse_integral, bits)


def total(bits, *numbers):
    """(9.24) The sum of numbers; each is a product with 1."""
    return windowed([times(number, ONE) if len(number) == 2 else number for number in numbers], bits)


def cone(widths, view, ratios, gains, deviation, end, ellipse, index):
    """(9.24) 1/g, k/g, cut-off, spread and L; near where the sphere reaches the eye."""
    if not view.perspective:
        return ONE, ONE, end, 0, (0, 0)
    bits = widths.view
    u, v = ratios
    slant = total(bits, ONE, times(u, u), times(v, v))
    angle = multiplied(deviation, multiplied(reciprocal(view.focal[0], bits), gains[0], bits), bits)
    spread = multiplied(angle, angle, bits)
    limit = multiplied(spread, normalised(end, -28, 31), bits)
    rest = total(bits, ONE, negated(limit))
    if rest[0] <= 0:
        raise setup.Cull(setup.NEAR)
    if index == BY_RAYS:
        aside = total(bits, times(u, u), times(v, v))
        return ONE, ONE, covering(bits, end, aside, limit, rest), 0, slant
    inverse_slant = reciprocal(slant, bits)
    shrink, cutoff, word = ONE, end, 0
    if index == PERSPECTIVE:
        shrink = total(bits, ONE, times(negated(limit), inverse_slant))
        wide = multiplied(normalised(end, -28, bits), reciprocal(shrink, bits), bits)
        cutoff = min(MOST, fixed(wide, 28))
        word = min((1 << 32) - 1, fixed(multiplied(spread, inverse_slant, bits), 32))
    if ellipse == APPROXIMATE:
        return ONE, ONE, cutoff, word, (0, 0)
    inverse = reciprocal(rest, bits)
    return inverse, multiplied(shrink, inverse, bits), cutoff, word, (0, 0)


def covering(bits, end, aside, limit, rest):
    """(9.24) The cut-off that covers the whole outline, for indices by rays."""
    slant = total(bits, ONE, aside)
    wide = multiplied(limit, total(bits, slant, negated(limit)), bits)
    far = total(bits, square_root(aside, bits), square_root(wide, bits))
    farthest = multiplied(far, reciprocal(rest, bits), bits)
    squared = total(bits, ONE, times(farthest, farthest))
    cutoff = multiplied(multiplied(normalised(end, -28, bits), squared, bits), reciprocal(slant, bits), bits)
    word = fixed(cutoff, 28)
    return min(MOST, word + (word >> 12))


def covariance(widths, rules, ratios, gains, deviation, inverse, shrink):
    """(9.24) V and its determinant, the low-pass filter added."""
    bits, h = widths.mantissa, rules.low_pass
    u, v = ratios
    across, down = [multiplied(g, deviation, bits) for g in gains]

    def stretch(a, b):
        return times(multiplied(a, b, bits), inverse)

    def along(radius, ratio):
        form = total(bits, ONE, stretch(ratio, ratio))
        return multiplied(multiplied(multiplied(radius, radius, bits), shrink, bits), form, bits)

    area = multiplied(multiplied(across, down, bits), shrink, bits)
    sharp_x, sharp_y = along(across, u), along(down, v)
    xy = multiplied(area, normalised(*stretch(u, v)[:2], bits), bits)
    xx, yy = total(bits, sharp_x, h), total(bits, sharp_y, h)
    form = total(bits, ONE, stretch(u, u), stretch(v, v))
    sharp = times(multiplied(area, area, bits), form)
    return xx, xy, yy, total(bits, sharp, times(h, total(bits, xx, sharp_y)))


def moved(widths, view, ratios, centre, inverse):
    """(9.24) The ellipse's centre."""
    bits = widths.view
    push = total(bits, inverse, negated(ONE))
    shifts = [fixed(product(multiplied(f, r, bits), push), widths.subpixel) for f, r in zip(view.focal, ratios)]
    return [max(-LIMIT, min(LIMIT, c + shift)) for c, shift in zip(centre, shifts)]


def sphere(widths, view, rules, splat, deviation, ellipse, index):
    """(9.24) Footprint, spread, L and corrected end."""
    z, centre, ratios, gains = setup.project(widths, view, rules, *setup.camera_point(widths, view, splat.centre))
    height = peak(widths, rules, splat.weight, deviation)
    end = setup.cut_off(rules, height)
    inverse, shrink, cutoff, spread, slant = cone(widths, view, ratios, gains, deviation, end, ellipse, index)
    variance = covariance(widths, rules, ratios, gains, deviation, inverse, shrink)
    form = setup.ldl(widths, variance)
    setup.conic(widths, variance, form[0])
    centre = moved(widths, view, ratios, centre, inverse)
    box = [setup.bounds(widths, view.viewport[a], centre[a], variance[2 * a], cutoff) for a in range(2)]
    print = setup.sort_key(z), centre, box, form, cutoff, setup.peak_word(widths, height)
    return print, spread, slant, end


def perspective_table():
    """(9.25) r / (1 + r s), UQ4.28: 65 entries over r for each of 33 s."""
    entries = []
    for s in range(33):
        for r in range(65):
            divisor = (1 << 13) + r * s
            entries.append(((r << 37) + divisor // 2) // divisor)
    return entries


TABLE = perspective_table()


def by_spread(widths, radial, spread):
    """(9.25) The corrected index, UQ4.radial."""
    common = nearest(radial, widths.radial - 28)
    if common >> 30 or spread >> 28:
        corrected = evaluated(common, spread)
    else:
        row, column = 65 * (spread >> 23), common >> 24
        below, above = [along(at + column, common & 0xFFFFFF) for at in (row, row + 65)]
        corrected = below + nearest((above - below) * (spread >> 7 & 0xFFFF), 16)
    return nearest(corrected, 28 - widths.radial)


def along(place, rest):
    """(9.25) Between two entries of a row."""
    low, high = TABLE[place : place + 2]
    return low + nearest((high - low) * rest, 24)


def evaluated(common, spread):
    """(9.25) The formula itself, beyond the table."""
    r, s = normalised(common, -28, 31), normalised(spread, -32, 31)
    divisor = (1 << 58) + fixed(product(r, s), 58)
    return fixed(product(r, reciprocal(normalised(divisor, -58, 31), 31)), 28)


def squared(principal, focal, pixel):
    """(9.26) |v|^2 of a pixel's ray, UQ7.28."""
    result = 1 << 28
    for axis in range(2):
        offset = normalised(((2 * pixel[axis] + 1) << 31) - principal[axis], -32, 31)
        slope = fixed(product(offset, reciprocal(focal[axis], 31) or ZERO), 28)
        slope = max(-(7 << 28), min(7 << 28, slope))
        result += nearest(slope * slope, 28)
    return result


def by_ray(squared, radial, slant):
    """(9.26) The corrected index, UQ4.radial, at most 2^62."""
    factor = multiplied(slant, reciprocal(normalised(squared, -28, 31), 31), 31)
    return min(fixed(product(normalised(radial >> 1, 1, 31), factor), 0), 1 << 62)
