"""Formulas 9.5 to 9.14 of docs/specification.md: surface splats and their weighted sums.

A fragment is a list: weight sum, sums of red, green, blue and opacity, three of the normal, least and greatest depth, material.
"""

import setup
from arithmetic import *
from pixels import clear, rounded

WEIGHT, NEAR, FAR, MATERIAL = 0, 8, 9, 10
COLOUR, NORMAL = slice(1, 5), slice(5, 8)
EMPTY = [0] * 11
WORD = (1 << 32) - 1
FULL = 1 << 31


def times(a, b):
    """(9.5) An exact product as a term of its operands' lengths."""
    return term(product(a, b), length(a) + length(b))


def fraction(widths):
    """(9.5) Fraction bits f of attributes."""
    return min(widths.colour + 4, 28)


def peak(widths, weight, area, determinant):
    """(9.5) The peak."""
    inverse = reciprocal(square_root(determinant, widths.mantissa), widths.mantissa)
    if weight[0] <= 0 or inverse is None:
        return ZERO
    height = multiplied(weight, (abs(area[0]), area[1]), widths.mantissa)
    return multiplied(height, inverse, widths.mantissa)


def slope(widths, rules, m, z, area, determinant):
    """(9.6) The filtered plane's depth a pixel along the row and down the column."""
    bits, inverse = widths.mantissa, reciprocal(determinant, widths.mantissa)
    (m1x, m1y), (m2x, m2y) = m[:2]
    z1, z2 = z

    def component(sharp, filtered):
        both = [times(area, windowed(sharp, bits)), times(rules.low_pass, windowed(filtered, bits))]
        return multiplied(windowed(both, bits), inverse, bits)

    across = component([times(m2y, z1), times(negated(m1y), z2)], [times(m1x, z1), times(m2x, z2)])
    down = component([times(m1x, z2), times(negated(m2x), z1)], [times(m1y, z1), times(m2y, z2)])
    return across, down


def plane(widths, z, centre, first, slopes):
    """(9.7) Depth at the box's corner and its two steps, Q31.32."""
    origin = fixed(z, 32)
    for axis in range(2):
        sample = (2 * first[axis] + 1) << (widths.subpixel - 1)
        distance = normalised(sample - centre[axis], -widths.subpixel, widths.mantissa)
        origin = saturated(origin + fixed(product(slopes[axis], distance), 32), 64)
    return origin, *[fixed(g, 32) for g in slopes]


def depth_at(plane, across, down):
    """(9.7) The lane's word so many columns and rows from the corner."""
    origin, right, below = plane
    return wrapped(origin + right * across + below * down, 64)


def pixel_depth(lane):
    """(9.7) A lane's depth as pixels keep it, UQ9.23."""
    return max(0, min(WORD, nearest(lane, 9)))


def attributes(widths, colour, opacity):
    """(9.8) Red, green, blue and opacity, at most 1."""
    f = fraction(widths)
    one = 1 << f
    share = min(rounded(widths, opacity, 28 - f), one)
    return [rounded(widths, min(rounded(widths, c, 28 - f), one) * share, f) for c in colour] + [share]


def facing(widths, view, ratios, normal):
    """(9.8) The normal towards the eye, and whether it was turned."""
    x, y, z = setup.turned(widths, view, normal)
    f = fraction(widths)
    along = [times(x, ratios[0]), times(y, ratios[1]), term(z, widths.mantissa)]
    back = windowed(along, widths.mantissa)[0] > 0
    parts = [max(-(1 << f), min(1 << f, fixed(n, f))) for n in (x, y, z)]
    return [-n if back else n for n in parts], back


def surface(widths, view, rules, splat, normal):
    """(9.5) to (9.7) in their order: footprint and plane, and what attributes take of setup."""
    point = setup.project(widths, view, rules, *setup.camera_point(widths, view, splat.centre))
    z, centre, ratios, gains = point
    axes = [*splat.axes[:2], ([0, 0, 0], 0)]
    m = setup.columns(widths, view, ratios, gains, axes)
    variance = setup.covariance(widths, rules, m)
    form = setup.ldl(widths, variance)
    setup.conic(widths, variance, form[0])
    area = setup.minor(m[0], m[1], widths.mantissa)
    height = peak(widths, splat.weight, area, variance[3])
    cutoff = setup.cut_off(rules, height)
    word = setup.peak_word(widths, height)
    box = [setup.bounds(widths, view.viewport[a], centre[a], variance[2 * a], cutoff) for a in range(2)]
    along = [setup.turned(widths, view, axis)[2] for axis in axes[:2]]
    slopes = slope(widths, rules, m, along, area, variance[3])
    first = [low for low, _ in box]
    print = setup.sort_key(z), centre, box, form, cutoff, word
    return print, plane(widths, z, centre, first, slopes), facing(widths, view, ratios, normal)


def halves_up(widths, value, drop):
    """(9.9) By the design's rounding, with halves to even as halves up."""
    return (floored if widths.rounding == "truncate" else nearest)(value, drop)


def sum_fraction(widths):
    """(9.9) Fraction bits s of sums."""
    return min(widths.accumulator, 24)


def weight(widths, alpha):
    """(9.9) A sample's weight, UQ1.s."""
    return halves_up(widths, alpha, widths.alpha - sum_fraction(widths))


def accumulate(widths, fragment, sample):
    """(9.9) Adds a sample: weight, depth, four attributes, normal, material."""
    w, depth, shares, normal, material = sample
    if fragment[WEIGHT] + w >= FULL:
        return
    if not fragment[WEIGHT] or (depth, material) < (fragment[NEAR], fragment[MATERIAL]):
        fragment[NEAR], fragment[MATERIAL] = depth, material
    fragment[WEIGHT] += w
    fragment[FAR] = max(fragment[FAR], depth)
    f = fraction(widths)
    parts = [halves_up(widths, w * share, f) for share in shares]
    parts += [halves_up(widths, w * n, f) if n >= 0 else -halves_up(widths, w * -n, f) for n in normal]
    for place, part in enumerate(parts, COLOUR.start):
        fragment[place] += part


def single(widths, threshold, fragment, sample):
    """(9.10) A pixel of one fragment: accumulates, replaces or discards."""
    depth = sample[1]
    if fragment[WEIGHT]:
        if depth > fragment[NEAR] + threshold:
            return
        if depth + threshold < fragment[NEAR]:
            fragment[:] = EMPTY
    accumulate(widths, fragment, sample)


def divided(widths, fragment):
    """(9.11) Colour, opacity and normal over the weight sum."""
    inverse = reciprocal((fragment[WEIGHT], 0), widths.mantissa)

    def divide(value, bits):
        return max(-(1 << bits), min(1 << bits, fixed(product((value, 0), inverse), bits)))

    colours = [divide(value, widths.accumulator) for value in fragment[COLOUR]]
    return colours + [divide(value, 30) for value in fragment[NORMAL]]


def coverage(widths, fragment, tau):
    """(9.12) How much of the pixel a fragment covers, UQ1.30; all of it without tau."""
    inverse = reciprocal(normalised(tau, -30, 31), 31)
    if inverse is None:
        return 1 << 30
    return min(1 << 30, fixed(product((fragment[WEIGHT], -sum_fraction(widths)), inverse), 30))


def resolved(widths, fragments, tau):
    """(9.13) The pixel of fragments, nearest first."""
    pixel = clear(widths)
    for fragment in fragments:
        *colour, opacity = divided(widths, fragment)[:4]
        seen = rounded(widths, pixel[3] * coverage(widths, fragment, tau), 30)
        for channel in range(3):
            pixel[channel] += rounded(widths, seen * colour[channel], widths.transmittance)
        pixel[3] -= rounded(widths, seen * opacity, widths.accumulator)
    return pixel


def layered(widths, threshold, layers, most, sample):
    """(9.14) A pixel of so many layers: 1 if two had to be merged."""
    depth = sample[1]
    for place, fragment in enumerate(layers):
        if fragment[NEAR] - threshold <= depth <= fragment[FAR] + threshold:
            accumulate(widths, fragment, sample)
            join(threshold, layers, place)
            return 0
    fragment = list(EMPTY)
    accumulate(widths, fragment, sample)
    layers.append(fragment)
    layers.sort(key=lambda layer: layer[NEAR])
    if len(layers) <= most:
        return 0
    gaps = [back[NEAR] - front[FAR] for front, back in zip(layers, layers[1:])]
    place = gaps.index(min(gaps))
    layers[place : place + 2] = [merged(widths, *layers[place : place + 2])]
    return 1


def join(threshold, layers, place):
    """(9.14) Adds the next layer if the gap is closed; halves both where the weight sum would be full."""
    if place + 1 == len(layers) or layers[place + 1][NEAR] - layers[place][FAR] > threshold:
        return
    front, back = layers[place], layers.pop(place + 1)
    half = front[WEIGHT] + back[WEIGHT] >= FULL
    sums = [(a >> half) + (b >> half) for a, b in zip(front[:NEAR], back)]
    layers[place] = [*sums, front[NEAR], back[FAR], front[MATERIAL]]


def merged(widths, front, back):
    """(9.14) The front over the back, weighed again."""
    a, most = widths.accumulator, max(front[WEIGHT], back[WEIGHT])
    fore, behind = divided(widths, front), divided(widths, back)
    opacity, rest = fore[3], (1 << a) - fore[3]
    colours = [min(c + nearest(rest * b, a), 1 << a) for c, b in zip(fore[:4], behind)]
    normals = [
        nearest(n * opacity, a) + nearest(nearest(b * rest, a) * behind[3], a)
        for n, b in zip(fore[4:], behind[4:])
    ]
    sums = [nearest(c * most, a) for c in colours] + [nearest(n * most, 30) for n in normals]
    return [most, *sums, front[NEAR], back[FAR], front[MATERIAL]]
