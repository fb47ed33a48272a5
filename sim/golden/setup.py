"""Section 2 of docs/specification.md: from a splat to its footprint."""

from arithmetic import *

ONE = (1 << 30, -30)
NEAR, FAR, RANGE, DEGENERATE, TRANSPARENT, OUTSIDE = range(1, 7)


class Cull(Exception):
    """A splat without a footprint; its argument is the reason, 1 to 6."""


def entry(w, bits):
    """(2.2) An entry of W, Q1.30, rounded to so many fraction bits."""
    drop = 30 - min(bits, 30)
    return nearest(w, drop) << drop


def difference(view, centre, position):
    """(2.1) u - e, its largest coordinate of `position` bits, and the exponent of the three."""
    eye, exponent = view.eye
    tops = [saturated(leading(number) + 1, 32) for number in centre if number[0]]
    if any(eye):
        tops.append(saturated(exponent + max(abs(e).bit_length() for e in eye), 32))
    unit = saturated(max(tops, default=0) - 60, 32)
    down, down_eye = [saturated(unit - u[1], 32) for u in centre], saturated(unit - exponent, 32)
    exact = [nearest(u[0], s) - nearest(e, down_eye) for u, e, s in zip(centre, eye, down)]
    size = max(abs(d).bit_length() for d in exact)
    if size == 0:
        return [0, 0, 0], 0
    drop = size - position
    return [nearest(d, drop) for d in exact], saturated(unit + drop, 32)


def camera_point(widths, view, centre):
    """(2.2) t = W (u - e): three words and their exponent."""
    d, exponent = difference(view, centre, widths.position)
    low = max(widths.position - 30, 0)
    point = []
    for row, rests in zip(view.rotation, view.rotation_rest):
        if low == 0:
            point.append(sum(entry(w, widths.position) * part for w, part in zip(row, d)))
            continue
        high = [nearest(part, low) for part in d]
        tail = [part - (h << low) for part, h in zip(d, high)]
        cross = sum(w * t + nearest(rest, 30 - low) * h for w, rest, h, t in zip(row, rests, high, tail))
        point.append(sum(w * h for w, h in zip(row, high)) + nearest(cross, low))
    return point, saturated(exponent + low - 30, 32)


def place(number):
    """(2.3) What orders numbers by their values: sign, leading bit, mantissa."""
    sign = (number[0] > 0) - (number[0] < 0)
    return sign, sign * leading(number), number[0] << (64 - length(number))


def cull_by_depth(view, z):
    """(2.3) Near and far."""
    if place(z) <= place(view.near) or (view.perspective and z[0] <= 0):
        raise Cull(NEAR)
    if place(view.far) <= place(z):
        raise Cull(FAR)


def sort_key(z):
    """(2.4) The depth as a key of 48 bits."""
    positive = 1 << 47
    if z[0] == 0:
        return positive
    magnitude = abs(z[0])
    top = leading(z)
    below = ((magnitude << 38) >> (magnitude.bit_length() - 1)) & ((1 << 38) - 1)
    key = max(0, min(positive - 1, (top + 256) << 38 | below))
    return positive | key if z[0] > 0 else positive - 1 - key


def inverse_depth(widths, view, z):
    """(2.5) 1/z, or 1 for an orthographic view."""
    if not view.perspective:
        return ONE
    return reciprocal(normalised(z[0], z[1], widths.view), widths.view)


def on_plane(widths, coordinate, inverse):
    """(2.6) x/z or y/z."""
    return multiplied(normalised(coordinate[0], coordinate[1], widths.view), inverse, widths.view)


def on_screen(widths, view, axis, plane):
    """(2.7) fx x/z + cx in Q27.subpixel."""
    focal = view.focal[axis]
    offset = fixed(product(focal, plane), 32)
    position = saturated(view.principal[axis] + offset, 64)
    if abs(position) >> 58:
        raise Cull(RANGE)
    return nearest(position, 32 - widths.subpixel)


def gain(widths, view, axis, inverse):
    """(2.8) Pixels per scene unit."""
    return multiplied(view.focal[axis], inverse, widths.mantissa)


def ratio(widths, view, rules, axis, plane):
    """(2.9) x/z as the Jacobian takes it."""
    if not view.perspective:
        return ZERO
    word = fixed(plane, 32)
    low, high = view.ratio_low[axis], view.ratio_high[axis]
    if rules.clamp_jacobian and not low <= word <= high:
        return normalised(max(min(word, high), low), -32, widths.mantissa)
    return normalised(plane[0], plane[1], widths.mantissa)


def project(widths, view, rules, point, exponent):
    """(2.3) to (2.9) in their order: depth, centre, ratio, gain."""
    x, y, z = [(value, exponent) for value in point]
    cull_by_depth(view, z)
    inverse = inverse_depth(widths, view, z)
    plane = [on_plane(widths, coordinate, inverse) for coordinate in (x, y)]
    place = [on_screen(widths, view, axis, plane[axis]) for axis in range(2)]
    gains = [gain(widths, view, axis, inverse) for axis in range(2)]
    ratios = [ratio(widths, view, rules, axis, plane[axis]) for axis in range(2)]
    return z, place, ratios, gains


def axis_bits(widths):
    """(2.10) Bits of an axis and of the rotation that turns it."""
    return min(widths.mantissa + 6, 31)


def turned(widths, view, axis):
    """(2.10) W a, three numbers."""
    mantissa, exponent = axis
    bits, kept = widths.mantissa, axis_bits(widths)
    window = bits + GUARD
    parts = [floored(max(m, -(2**31 - 1)), 31 - kept) << (31 - kept) for m in mantissa]
    exponent = max(-512, min(511, exponent)) + 31 - window
    result = []
    for row in view.rotation:
        cuts = [floored(entry(w, kept) * part, 61 - window) for w, part in zip(row, parts)]
        result.append(normalised(sum(cuts), exponent, bits))
    return result


def sheared(across, along, ratio, gain, bits):
    """(2.11) One component of a column of M: (across - ratio along) gain."""
    slope = negated(product(ratio, along))
    return multiplied(windowed([term(across, bits), term(slope, 2 * bits)], bits), gain, bits)


def columns(widths, view, ratios, gains, axes):
    """(2.11) M = J W A, a column for each axis."""
    result = []
    for axis in axes:
        x, y, z = turned(widths, view, axis)
        result.append(
            [sheared(side, z, r, g, widths.mantissa) for side, r, g in zip((x, y), ratios, gains)]
        )
    return result


def enlargement(widths, rules, gains):
    """(2.12) d/k beyond the distance k, otherwise None."""
    across, down = gains
    smaller = across if (leading(across), across[0]) < (leading(down), down[0]) else down
    distance = multiplied(rules.spacing, smaller, widths.mantissa)
    return None if leading(distance) >= 0 else reciprocal(distance, widths.mantissa)


def dimmed(widths, rules, weight, factor):
    """(2.12) The weight of a splat that was enlarged."""
    if rules.normalised:
        return weight
    inverse = reciprocal(factor, widths.mantissa)
    once = multiplied(weight, inverse, widths.mantissa)
    return multiplied(once, inverse, widths.mantissa)


def minor(j, k, bits):
    """(2.14) m_j x m_k."""
    crossed = negated(product(j[1], k[0]))
    return windowed([term(product(j[0], k[1]), 2 * bits), term(crossed, 2 * bits)], bits)


def covariance(widths, rules, m):
    """(2.13), (2.14) V' + V^h and its determinant."""
    bits, h = widths.mantissa, rules.low_pass
    low_pass = term(h, length(h))

    def summed(i, j, *more):
        return windowed([term(product(c[i], c[j]), 2 * bits) for c in m] + list(more), bits)

    xx, xy, sharp = summed(0, 0, low_pass), summed(0, 1), summed(1, 1)
    yy = windowed([term(sharp, bits), low_pass], bits)
    trace = windowed([term(xx, bits), term(sharp, bits)], bits)
    minors = [minor(m[j], m[k], bits) for j, k in ((0, 1), (0, 2), (1, 2))]
    squares = [term(product(n, n), 2 * bits) for n in minors]
    determinant = windowed(squares + [term(product(h, trace), length(h) + bits)], bits)
    return xx, xy, yy, determinant


def ldl(widths, variance):
    """(2.15) A, 1/A, S and C of r = A (x - xc)^2 + C dy^2."""
    xx, xy, yy, determinant = variance
    bits = widths.mantissa
    vertical, inverse = reciprocal(yy, bits), reciprocal(determinant, bits)
    if vertical is None or inverse is None:
        raise Cull(DEGENERATE)
    horizontal = multiplied(yy, inverse, bits)
    squared_width = multiplied(determinant, vertical, bits)
    shear = multiplied(xy, vertical, bits)
    if shear[1] < -512:
        shear = (0, 0)
    if any(not -512 <= number[1] < 512 for number in (horizontal, squared_width, vertical)):
        raise Cull(DEGENERATE)
    return horizontal, squared_width, shear, vertical


def conic(widths, variance, horizontal):
    """(2.16) a, b, c of r = a dx^2 + 2 b dx dy + c dy^2 and their exponent."""
    xx, xy, yy, determinant = variance
    bits = widths.mantissa
    inverse = reciprocal(determinant, bits)
    cross = multiplied(xy, inverse, bits)
    terms = [horizontal, negated(cross), multiplied(xx, inverse, bits)]
    exponent = max(leading(term) for term in terms if term[0]) - (bits - 1)
    if exponent > 511:
        raise Cull(DEGENERATE)
    return [fixed(scaled(term, -exponent), 0) for term in terms], exponent


def compensated(widths, weight, m, determinant):
    """(2.17) The weight without what the low-pass filter adds."""
    bits = widths.mantissa
    minors = [minor(m[j], m[k], bits) for j, k in ((0, 1), (0, 2), (1, 2))]
    sharp = windowed([term(product(n, n), 2 * bits) for n in minors], bits)
    kept = multiplied(sharp, reciprocal(determinant, bits) or ZERO, bits)
    return multiplied(weight, square_root(kept, bits), bits)


def peak_opacity(widths, rules, weight, ratios, gains, determinant):
    """(2.17) The opacity at the centre."""
    if weight[0] <= 0:
        return ZERO
    if not rules.normalised:
        return weight
    bits = widths.mantissa
    slant = windowed([(1, 0, 1)] + [term(product(r, r), 2 * bits) for r in ratios], bits)
    density = square_root(multiplied(slant, reciprocal(determinant, bits) or ZERO, bits), bits)
    area = multiplied(gains[0], gains[1], bits)
    result = multiplied(weight, area, bits)
    result = multiplied(result, density, bits)
    return multiplied(result, rules.inverse_integral, bits)


def cut_off(rules, peak):
    """(2.18) The radial index at which the footprint ends, UQ4.28."""
    if rules.cutoff is not None:
        return min(rules.cutoff, rules.kernel_end)
    if rules.kernel != "gaussian":
        return rules.kernel_end
    least = normalised(rules.alpha_min >> 1, -59, 31)
    log = logarithm(peak)
    if log is None:
        raise Cull(TRANSPARENT)
    result = nearest(log - logarithm(least), 3)
    if result <= 0:
        raise Cull(TRANSPARENT)
    return min(result, 15 << 28)


def bounds(widths, limit, centre, spread, cutoff):
    """(2.19) Columns (or rows) of the bounding box, clipped to the viewport."""
    squared = multiplied(normalised(cutoff, -28, 16), spread, 16)
    extent = fixed(square_root(squared, 16), 32)
    extent = saturated(extent + (extent >> 10), 64)
    if extent >> 60:
        raise Cull(RANGE)
    sample = (centre << (32 - widths.subpixel)) - (1 << 31)
    low = -((extent - sample) >> 32)
    high = ((sample + extent) >> 32) + 1
    low, high = max(0, min(limit, low)), max(0, min(limit, high))
    if low >= high:
        raise Cull(OUTSIDE)
    return low, high


def colour_range(widths):
    """(2.20) Integer bits of colours and their sums."""
    return min(4, 23 - widths.accumulator) if widths.rounding == "nearest-even" else 4


def colour(widths, channels):
    """(2.20) A splat's colour in UQ4.colour."""
    drop, most = 28 - widths.colour, (1 << (widths.colour + colour_range(widths))) - 1
    return [min(c >> drop if widths.rounding == "truncate" else even(2 * c, drop + 1), most) for c in channels]


def peak_word(widths, peak):
    """(2.21) The peak in UQ4.peak, halves to even, saturated."""
    drop = saturated(saturated(-peak[1], 32) - widths.peak, 32)
    word = fixed(peak, widths.peak)
    if 1 <= drop <= 31:
        word = even(peak[0], drop)
    word = min((16 << widths.peak) - 1, word)
    if word == 0:
        raise Cull(TRANSPARENT)
    return word


def footprint(widths, view, rules, splat):
    """(2.22) All of setup; the first reason that applies culls."""
    projected = project(widths, view, rules, *camera_point(widths, view, splat.centre))
    _, _, ratios, gains = projected
    m = columns(widths, view, ratios, gains, splat.axes)
    return shaped(widths, view, rules, splat, projected, m, covariance(widths, rules, m))


def shaped(widths, view, rules, splat, projected, m, variance):
    """(2.12) to (2.21) in their order."""
    (z, centre, ratios, gains), weight = projected, splat.weight
    factor = enlargement(widths, rules, gains)
    if factor is not None:
        m = [[multiplied(c, factor, widths.mantissa) for c in column] for column in m]
        variance, weight = covariance(widths, rules, m), dimmed(widths, rules, weight, factor)
    if rules.compensated:
        weight = compensated(widths, weight, m, variance[3])
    form = ldl(widths, variance)
    coefficients = conic(widths, variance, form[0])
    peak = peak_opacity(widths, rules, weight, ratios, gains, variance[3])
    cutoff = cut_off(rules, peak)
    box = [
        bounds(widths, view.viewport[axis], centre[axis], variance[2 * axis], cutoff) for axis in range(2)
    ]
    channels = colour(widths, splat.colour)
    word = peak_word(widths, peak)
    return sort_key(z), centre, box, form, coefficients, cutoff, word, channels
