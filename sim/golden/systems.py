"""Recomputes the stages of `vectors export --systems`: section 9 of docs/specification.md.

A record has the operands, then the results; both are compared.
"""

from copy import copy

import deep
import harmonics
import pixels
import points
import setup
import spheres
import surface
from setup import Cull

# What points take of the rules of EWA splatting.
EWA = {
    "low_pass": (1 << 30, -30),
    "inverse_integral": (1367130551, -33),
    "cutoff": 4 << 28,
    "clamp_jacobian": 0,
}


def systems(check, stages):
    """Stages of the other systems."""
    for stage in stages:
        check.compare(stage, STAGES[stage](check, check.folder.records(stage)))


def colours(check, records):
    """(9.1) to (9.4)."""
    for splat, record in zip(check.splats, records):
        view = harmonics.towards(check.widths, check.view, splat.centre, setup.camera_point)
        direction, base, (count, *coefficients) = record[3:6], record[6:9], record[9:82]
        values = harmonics.harmonics(direction)
        colour = [harmonics.lit(base[c], coefficients[c : 3 * count : 3], values) for c in range(3)]
        yield [*view, *direction, *base, count, *coefficients, *colour]


def printed(print):
    """A footprint's words behind the reason 0."""
    key, centre, box, form, cutoff, word = print
    first, end = zip(*box)
    return [0, key, *centre, *first, *end, *(part for number in form for part in number), cutoff, word]


def padded(record, operands):
    """Zeros behind the reason where a splat was culled."""
    return record + [0] * (len(operands) - len(record))


def surfaces(check, records):
    """(9.5) to (9.8)."""
    for splat, record in zip(check.splats, records):
        colour, opacity, normal, splat = record[:3], record[3], (record[6:9], record[9]), copy(splat)
        splat.weight = tuple(record[4:6])
        try:
            print, plane, (normal, back) = surface.surface(check.widths, check.view, check.rules, splat, normal)
        except Cull as cull:
            yield padded([*record[:10], cull.args[0]], record)
            continue
        lane = surface.depth_at(plane, *(end - first - 1 for first, end in print[2]))
        attributes = surface.attributes(check.widths, colour, opacity)
        own = [*plane, *attributes, *normal, back, lane, surface.pixel_depth(lane)]
        yield [*record[:10], *printed(print), *own]


def samples(check, records):
    """(9.9) to (9.14)."""
    widths, at = check.widths, None
    for lane, _, *record in records:
        pixel, threshold, tau, alpha, _, weight, depth, *rest = record[:15]
        if pixel != at:
            at, one, two, merges = pixel, list(surface.EMPTY), [], 0
        sample = weight, depth, rest[:4], rest[4:7], rest[7]
        surface.single(widths, threshold, one, sample)
        merges += surface.layered(widths, threshold, two, 2, sample)
        operands = [lane, surface.pixel_depth(lane), pixel, threshold, tau, alpha, surface.weight(widths, alpha), weight, depth, *rest]
        layers = [*two, surface.EMPTY, surface.EMPTY]
        filtered = [*surface.divided(widths, one), surface.coverage(widths, one, tau)]
        resolved = [surface.resolved(widths, layers, tau) for layers in ([one] if one[0] else [], two)]
        yield [*operands, *one, *layers[0], *layers[1], merges, *filtered, *resolved[0], *resolved[1]]


def octaves(check, records):
    """(9.16), (9.17), as fine as they are."""
    for alpha, _, word, _ in records:
        yield [alpha, deep.octaves(alpha), word, deep.through((deep.OPTICAL_DEPTH, 0, 32), word)]


def channel(check, records):
    """(9.15) to (9.18)."""
    for record in records:
        channel, place, layer, alpha, colour, pixel = record[:3], record[3:5], *record[5:7], record[7:10], record[10:14]
        noise = deep.noise(place, layer)
        layers = [blend(channel, pixel, alpha, colour, noise) for blend in (deep.front_to_back, deep.back_to_front)]
        yield [*record[:14], deep.through(channel, pixel[3]), *layers[0], *layers[1]]


def as_points(check, records):
    """(9.19)."""
    for splat, record in zip(check.splats, records):
        spacing, deviation, weight = [tuple(record[at : at + 2]) for at in (0, 2, 4)]
        normalised, splat = record[6], copy(splat)
        splat.weight = weight
        rules = copy(check.rules)
        vars(rules).update(EWA, spacing=spacing, normalised=normalised)
        filter = points.point_filter(check.widths, rules, deviation)
        found = [*record[:7], points.minified(check.widths, check.view, rules, splat), filter is not None]
        try:
            if filter is None:
                raise Cull(setup.DEGENERATE)
            print = points.point(check.widths, check.view, rules, splat, filter)
        except Cull as cull:
            yield padded([*found, cull.args[0]], record)
            continue
        yield [*found, *printed(print)]


def gathers(check, records):
    """(9.20), (9.21)."""
    widths, blend, at = check.widths, pixels.Blend(check.widths, check.rules), None
    for record in records:
        number, thickness, alpha, *colour, depth = record[:7]
        if number != at:
            at, pixel, slab = number, pixels.clear(widths), [0] * 5
        points.gather(widths, blend, pixel, slab, alpha, colour, depth, thickness)
        closed = list(pixel)
        if not closed[4]:
            points.close(widths, blend, closed, list(slab))
        yield [*record[:7], *pixel, *slab, *closed]


def sheets(check, records):
    """(9.22), (9.23)."""
    widths, blend = check.widths, pixels.Blend(check.widths, check.rules)
    for record in records:
        pixel, sheet = record[:5], record[5:10]
        behind, over = list(pixel), list(pixel)
        points.sheet_behind(widths, blend, behind, sheet)
        points.sheet_over(widths, over, sheet)
        yield [*pixel, *sheet, *behind, *over]


def as_spheres(check, records):
    """(9.24)."""
    for splat, record in zip(check.splats, records):
        deviation, (ellipse, index), splat = tuple(record[:2]), record[4:6], copy(splat)
        splat.weight = tuple(record[2:4])
        try:
            print, spread, slant, end = spheres.sphere(
                check.widths, check.view, check.rules, splat, deviation, ellipse, index
            )
        except Cull as cull:
            yield padded([*record[:6], cull.args[0]], record)
            continue
        yield [*record[:6], *printed(print), spread, *slant, end]


def indices(check, records):
    """(9.25), (9.26)."""
    for record in records:
        (radial, spread, _), pixel, slant = record[:3], record[3:5], tuple(record[11:13])
        focal = [tuple(record[5:7]), tuple(record[7:9])]
        squared = spheres.squared(record[9:11], focal, pixel)
        corrected = spheres.by_spread(check.widths, radial, spread)
        yield [radial, spread, corrected, *record[3:13], squared, spheres.by_ray(squared, radial, slant)]


STAGES = {
    "colours": colours,
    "surfaces": surfaces,
    "samples": samples,
    "octaves": octaves,
    "deep": channel,
    "points": as_points,
    "gathers": gathers,
    "sheets": sheets,
    "spheres": as_spheres,
    "perspective": lambda check, records: ([entry] for entry in spheres.TABLE),
    "indices": indices,
}
