"""Sections 7 and 8 of docs/specification.md: lanes, opacity, blending."""

from arithmetic import even, nearest, wrapped

GUARD = 7
WORD = (1 << 32) - 1


def rounded(widths, value, drop):
    """(8.1) A product of the pixel path, not negative, by the design's rounding."""
    if drop <= 0:
        return value << -drop
    if widths.rounding == "truncate":
        return value >> drop
    if widths.rounding == "nearest-even":
        return even(value, drop)
    return (value + (1 << (drop - 1))) >> drop


def added(widths, total, product, drop):
    """(8.1) A sum and a product of the pixel path, rounded once as a whole."""
    if drop <= 0:
        return total + rounded(widths, product, drop)
    return rounded(widths, (total << drop) + product, drop)


def lane_words(run, bits):
    """(7.1) The words of a run's lane, pixel by pixel."""
    _, _, count, radial, first, second = run
    for _ in range(count):
        yield radial
        radial, first = wrapped(radial + first, bits), wrapped(first + second, bits)


def lane_end(widths, cutoff):
    """(7.2) The cut-off in UQ4.radial."""
    return nearest(cutoff, 28 - widths.radial)


def radial_index(widths, word, fraction):
    """(7.3) A lane's word as UQ4.radial."""
    return max(nearest(word, fraction - widths.radial), 0)


def largest_alpha(widths, rules):
    """(8.2) The largest opacity of a splat at a pixel, UQ1.alpha."""
    return min(nearest(rules.alpha_max, 31 - widths.alpha), 1 << widths.alpha)


def smallest_opacity(widths, rules):
    """(8.3) The smallest product of peak and kernel that is drawn, UQ4.(peak + weight)."""
    decided = rules.cutoff is None and rules.kernel == "gaussian"
    threshold = 0 if decided else rules.alpha_min
    fraction = widths.peak + widths.weight
    dropped = fraction - widths.alpha
    blind = max(dropped - GUARD, 0)
    least = nearest(threshold, 60 - (fraction - blind)) << blind
    if dropped <= 0:
        return max(least, 1)
    half = 1 << (dropped - 1)
    return max(least, {"nearest": half, "nearest-even": half + 1, "truncate": 2 * half}[widths.rounding])


def last_transmittance(widths, rules):
    """(8.4) The largest transmittance at which a pixel is finished, UQ1.transmittance."""
    drop = 60 - widths.transmittance
    return max(((rules.minimum_transmittance + (1 << drop) - 1) >> drop) - 1, 0)


class Blend:
    """The constants of (8.2) to (8.4)."""

    def __init__(self, widths, rules):
        self.alpha_max = largest_alpha(widths, rules)
        self.opacity_min = smallest_opacity(widths, rules)
        self.minimum = last_transmittance(widths, rules)
        self.omit_finishing = rules.omit_finishing


def opacity(widths, blend, peak, kernel):
    """(8.5) The opacity of a splat at a pixel, UQ1.alpha; 0 is not drawn."""
    product = peak * kernel
    if product < blend.opacity_min:
        return 0
    return min(rounded(widths, product, widths.peak + widths.weight - widths.alpha), blend.alpha_max)


def clear(widths):
    """(8.6) A pixel before its first splat: red, green, blue, transmittance, finished."""
    return [0, 0, 0, 1 << widths.transmittance, 0]


def front_to_back(widths, blend, pixel, alpha, colour):
    """(8.7) "Over", nearest splat first."""
    transmittance = pixel[3]
    share = rounded(widths, transmittance * alpha, widths.alpha)
    rest = transmittance - share
    stop = rest <= blend.minimum
    if stop and blend.omit_finishing:
        pixel[4] = 1
        return
    drop = widths.transmittance + widths.colour - widths.accumulator
    for channel in range(3):
        pixel[channel] = min(added(widths, pixel[channel], share * colour[channel], drop), WORD)
    pixel[3], pixel[4] = rest, int(stop)


def back_to_front(widths, blend, pixel, alpha, colour):
    """(8.8) "Over", farthest splat first."""
    drop = widths.alpha + widths.colour - widths.accumulator
    for channel in range(3):
        hidden = rounded(widths, pixel[channel] * alpha, widths.alpha)
        layer = rounded(widths, alpha * colour[channel], drop)
        pixel[channel] = min(pixel[channel] - hidden + layer, WORD)
    pixel[3] -= rounded(widths, pixel[3] * alpha, widths.alpha)


def x_ray(widths, blend, pixel, alpha, colour):
    """(8.9) Plain summation."""
    drop = widths.alpha + widths.colour - widths.accumulator
    for channel in range(3):
        layer = rounded(widths, alpha * colour[channel], drop)
        pixel[channel] = min(pixel[channel] + layer, WORD)
    pixel[3] = max(pixel[3] - rounded(widths, alpha, widths.alpha - widths.transmittance), 0)
