"""Formulas 9.15 to 9.18 of docs/specification.md: a deep channel, and colour of the same depth.

A channel is what it holds, how it rounds and its bits; a pixel is a list of red, green, blue and the channel's word.
"""

from math import isqrt

from arithmetic import exact_logarithm, nearest

ONE = 1 << 31
OPACITY, TRANSMITTANCE, OPTICAL_DEPTH = range(3)
NEAREST, DOWN, DITHERED = range(3)
LN_2 = exact_logarithm(2, 1)


def reciprocals():
    """(9.17) 128/i, UQ2.30, for i = 64 to 128."""
    return [((128 << 30) + i // 2) // i for i in range(64, 129)]


RECIPROCALS = reciprocals()


def logarithms():
    """(9.17) log2 of the reciprocals, UQ1.44."""
    return [((exact_logarithm(r, 1 << 30) << 45) // LN_2 + 1) >> 1 for r in RECIPROCALS]


LOGARITHMS = logarithms()


def series(e):
    """(9.17) log2(1 + e), Q0.44, of e in Q0.38."""
    short = nearest(e, 10)
    inner = (1 << 28) // 3 - (short >> 2)
    inner = (1 << 27) - nearest(short * inner, 28)
    inner = (1 << 30) - nearest(e * inner, 36)
    value = nearest(e * inner, 26)
    return (value << 2) + nearest(value * 59417523, 25)


def octaves(alpha):
    """(9.17) -log2(1 - alpha), UQ5.44."""
    if alpha == ONE:
        return 20 << 44
    rest = ONE - alpha
    k = 31 - (rest - 1).bit_length()
    m = rest << k
    i = nearest(m, 24) - 64
    return (k << 44) + LOGARITHMS[i] - series(nearest(m * RECIPROCALS[i] - (1 << 61), 23))


def powers():
    """(9.16) 2^-(i/128), UQ1.32, for i = 0 to 127."""
    entries = []
    for i in range(128):
        root = 1 << (33 * 128 - i)
        for _ in range(7):
            root = isqrt(root)
        entries.append((root + 1) >> 1)
    return entries


POWERS = powers()


def through(channel, word):
    """(9.16) What still shines through, UQ1.31."""
    what, _, bits = channel
    if what == OPACITY:
        return ONE - (word << (32 - bits))
    if what == TRANSMITTANCE:
        return word << (32 - bits)
    if word == (1 << bits) - 1:
        return 0
    depth = word << (32 - bits)
    x = (depth & 0x1FFFFF) * 2977044472 >> 22
    square = x * x >> 38
    cube = square * x >> 38
    power = ((1 << 38) - x + square // 2 - cube // 6 + 64) >> 7
    return nearest(POWERS[depth >> 21 & 127] * power, 32 + (depth >> 28))


def cut(channel, value, drop, noise):
    """(9.15) value / 2^drop by the channel's rounding."""
    rounding = channel[1]
    if rounding == NEAREST:
        return nearest(value, drop)
    if rounding == DITHERED:
        value += (noise << 32) >> (64 - drop)
    return value >> drop


def over(channel, word, alpha, noise):
    """(9.15) to (9.17) The word after one more layer."""
    what, _, bits = channel
    if what == OPACITY:
        return word + cut(channel, ((1 << (bits - 1)) - word) * alpha, 31, noise)
    if what == TRANSMITTANCE:
        return cut(channel, word * (ONE - alpha), 31, noise)
    return min(word + cut(channel, octaves(alpha), 48 - bits, noise), (1 << bits) - 1)


def mixed(word):
    """(9.18) Every bit depends on every other."""
    word ^= word >> 16
    word = word * 0x21F0AAAD & 0xFFFFFFFF
    word ^= word >> 15
    word = word * 0xD35A2D97 & 0xFFFFFFFF
    return word ^ (word >> 15)


def noise(place, layer):
    """(9.18) 32 bits of a pixel and a layer."""
    x, y = place
    at = (x * 0x9E3779B1 ^ y * 0x85EBCA77) & 0xFFFFFFFF
    return mixed(mixed(at ^ 0x5BD1E995) ^ (layer * 0xC2B2AE3D & 0xFFFFFFFF))


def turned(word, by):
    """(9.18) A word of 32 bits, rotated to the left."""
    return (word << by | word >> (32 - by)) % (1 << 32)


def light(channel, share, colour, noise):
    """(9.18) A share of a colour below 2, in the channel's bits."""
    return cut(channel, share * min(colour, (2 << 28) - 1), 60 - channel[2], noise)


def front_to_back(channel, pixel, alpha, colour, noise):
    """(9.18) The pixel with a layer behind it."""
    word, most = over(channel, pixel[3], alpha, noise), (1 << channel[2]) - 1
    share = through(channel, pixel[3]) - through(channel, word)
    parts = [light(channel, share, c, turned(noise, 8 * n)) for n, c in enumerate(colour, 1)]
    return [*(min(total + part, most) for total, part in zip(pixel, parts)), word]


def back_to_front(channel, pixel, alpha, colour, noise):
    """(9.18) The pixel with a layer before it."""
    word, most, sums = over(channel, pixel[3], alpha, noise), (1 << channel[2]) - 1, []
    for n, (total, c) in enumerate(zip(pixel, colour), 1):
        own = turned(noise, 8 * n)
        kept = cut(channel, total * (ONE - alpha), 31, own)
        sums.append(min(kept + light(channel, alpha, c, turned(own, 4)), most))
    return [*sums, word]
