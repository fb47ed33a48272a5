"""Formulas 9.19 to 9.23 of docs/specification.md: points, their gathering, and sheets."""

import setup
from arithmetic import *
from pixels import WORD, rounded


def minified(widths, view, rules, splat):
    """(9.19) Is the splat a point?"""
    try:
        projected = setup.project(widths, view, rules, *setup.camera_point(widths, view, splat.centre))
    except setup.Cull:
        return False
    return setup.enlargement(widths, rules, projected[3]) is not None


def point_filter(widths, rules, deviation):
    """(9.19) Covariance and LDL of all points; None without an area."""
    bits, inverse = widths.mantissa, reciprocal(rules.spacing, widths.mantissa)
    if inverse is None:
        return None
    side = multiplied(deviation, inverse, bits)
    area = multiplied(side, side, bits)
    variance = area, ZERO, area, multiplied(area, area, bits)
    try:
        form = setup.ldl(widths, variance)
        setup.conic(widths, variance, form[0])
    except setup.Cull:
        return None
    return variance, form


def point(widths, view, rules, splat, filter):
    """(9.19) A point's footprint."""
    variance, form = filter
    bits = widths.mantissa
    z, centre, _, gains = setup.project(widths, view, rules, *setup.camera_point(widths, view, splat.centre))
    if splat.weight[0] <= 0:
        raise setup.Cull(setup.TRANSPARENT)
    if rules.normalised:
        share = multiplied(form[0], rules.inverse_integral, bits)
    else:
        share = multiplied(rules.spacing, rules.spacing, bits)
    peak = multiplied(multiplied(splat.weight, multiplied(*gains, bits), bits), share, bits)
    cutoff = setup.cut_off(rules, None)
    box = [setup.bounds(widths, view.viewport[a], centre[a], variance[0], cutoff) for a in range(2)]
    return setup.sort_key(z), centre, box, form, cutoff, setup.peak_word(widths, peak)


def gather(widths, blend, pixel, slab, opacity, colour, depth, thickness):
    """(9.20) Adds a point to a slab: red, green, blue, opacity, first depth."""
    if slab[3] and depth - slab[4] > thickness:
        close(widths, blend, pixel, slab)
        if pixel[4]:
            return
    if not slab[3]:
        slab[4] = depth
    slab[3] = min(slab[3] + opacity, WORD)
    for c in range(3):
        part = rounded(widths, opacity * colour[c], widths.alpha + widths.colour - widths.accumulator)
        slab[c] = min(slab[c] + part, WORD)


def close(widths, blend, pixel, slab):
    """(9.21) Composites a slab and empties it."""
    *colour, opacity, _ = slab
    slab[:] = [0] * 5
    if not opacity:
        return
    one = 1 << widths.alpha
    if opacity > one:
        factor = fixed(reciprocal(normalised(opacity, -widths.alpha, 31), 31), 31)
        colour, opacity = [nearest(c * factor, 31) for c in colour], one
    rest = pixel[3] - rounded(widths, pixel[3] * opacity, widths.alpha)
    layer(widths, blend, pixel, colour, rest)


def layer(widths, blend, pixel, colour, rest):
    """(9.21), (9.22) C' = C + T c unless 8.7 leaves the layer out, and T'."""
    stop = rest <= blend.minimum
    if stop and blend.omit_finishing:
        pixel[4] = 1
        return
    for c in range(3):
        pixel[c] = min(pixel[c] + rounded(widths, pixel[3] * colour[c], widths.transmittance), WORD)
    pixel[3:] = [rest, int(stop)]


def hidden(widths, value, sheet):
    """(9.22), (9.23) A value's share behind a sheet's opacity."""
    opacity = (1 << widths.transmittance) - sheet[3]
    return rounded(widths, value * opacity, widths.transmittance)


def sheet_behind(widths, blend, pixel, sheet):
    """(9.22) The sheet behind the pixel."""
    layer(widths, blend, pixel, sheet, pixel[3] - hidden(widths, pixel[3], sheet))


def sheet_over(widths, pixel, sheet):
    """(9.23) The sheet before the pixel."""
    for c in range(3):
        pixel[c] = min(pixel[c] - hidden(widths, pixel[c], sheet) + sheet[c], WORD)
    pixel[3] -= hidden(widths, pixel[3], sheet)
