"""Section 1 of docs/specification.md: numbers, roundings, and the functions that have a table.

A number, or an exact product, is a pair (mantissa, exponent); a term of a sum is a triple (value, exponent, length).
"""

from math import isqrt

GUARD = 8
ZERO = (0, -(1 << 20))


def wrapped(value, bits):
    """(1.1) The low bits of a value, as two's complement."""
    half = 1 << (bits - 1)
    return ((value + half) & ((1 << bits) - 1)) - half


def saturated(value, bits):
    """(1.2) The nearest value of a two's complement format."""
    half = 1 << (bits - 1)
    return max(-half, min(half - 1, value))


def nearest(value, drop):
    """(1.3) value / 2^drop to nearest, halves up; to the left saturated to 64 bits."""
    if drop > 0:
        return (value + (1 << (drop - 1))) >> drop if drop < 64 else 0
    return saturated(value << min(-drop, 64), 64)


def even(value, drop):
    """(1.3) value / 2^drop to nearest, halves to even; drop is at least 1."""
    return (value + (1 << (drop - 1)) - 1 + ((value >> drop) & 1)) >> drop


def floored(value, drop):
    """(1.4) value / 2^drop rounded down, exact to the left."""
    return (value << 64) >> (64 + drop)


def normalised(value, exponent, bits):
    """(1.5) The number nearest to value 2^exponent whose mantissa has exactly so many bits."""
    if not value:
        return ZERO
    drop = value.bit_length() - bits
    mantissa = value << -drop if drop <= 0 else (value + (1 << (drop - 1))) >> drop
    if abs(mantissa) >> bits:
        mantissa >>= 1
        drop += 1
    return mantissa, saturated(exponent + drop, 32)


def length(number):
    """(1.6) Bits of a mantissa's magnitude."""
    return number[0].bit_length()


def leading(number):
    """(1.6) Position of the leading bit."""
    return number[1] + length(number) - 1


def scaled(number, power):
    """(1.6) number 2^power."""
    return number[0], number[1] + power


def product(a, b):
    """(1.7) An exact product."""
    return a[0] * b[0], saturated(a[1] + b[1], 32)


def multiplied(a, b, bits):
    """(1.7) The exact product, rounded once."""
    return normalised(*product(a, b), bits)


def term(number, size):
    """(1.8) A number, or an exact product, as a term of so many bits."""
    return *number, size


def negated(number):
    """(1.7) A number with the other sign."""
    return -number[0], number[1]


def windowed(terms, bits):
    """(1.8) The sum of terms in a window of bits + GUARD bits."""
    window = bits + GUARD
    cuts = [(floored(v, size - window), saturated(e + size, 32)) for v, e, size in terms]
    tops = [top for value, top in cuts if value]
    if not tops:
        return ZERO
    top = max(tops)
    total = sum(floored(value, top - end) for value, end in cuts if value)
    return normalised(total, saturated(top - window, 32), bits)


def fixed(number, fraction):
    """(1.9) Fixed point with so many fraction bits, saturated to 64 bits."""
    return nearest(number[0], saturated(saturated(-number[1], 32) - fraction, 32))


def reciprocal_table():
    """(1.10) 1/(1 + i/256) in UQ1.30."""
    return [((256 << 30) + (256 + i) // 2) // (256 + i) for i in range(257)]


RECIPROCALS = reciprocal_table()


def reciprocal(number, bits):
    """(1.11) 1/number; None of 0."""
    magnitude = abs(number[0])
    if not magnitude:
        return None
    x = magnitude << (32 - magnitude.bit_length())
    index, rest = (x >> 23) & 255, x & 0x7FFFFF
    low, high = RECIPROCALS[index], RECIPROCALS[index + 1]
    seed = low + nearest((high - low) * rest, 23)
    result = seed << 30
    if bits > 16:
        defect = (1 << 61) - x * seed
        result += nearest(seed * nearest(defect, 14), 17)
    if number[0] < 0:
        result = -result
    return normalised(result, -60 - leading(number), bits)


def root_table():
    """(1.12) sqrt(i/256) in UQ0.24 for i = 64 to 256."""
    return [(isqrt(i << 42) + 1) >> 1 for i in range(64, 257)]


ROOTS = root_table()


def root_chord(normal):
    """(1.13) The root, UQ0.24, of a word of UQ0.32 that is at least 1/4."""
    index, rest = (normal >> 24) - 64, (normal >> 8) & 0xFFFF
    low, high = ROOTS[index], ROOTS[index + 1]
    return low + (((high - low) * rest + (1 << 15)) >> 16)


def root_seed(value):
    """(1.14) (root, shift) of an integer of 64 bits: sqrt(value) is about root 2^shift."""
    even = (64 - value.bit_length()) & ~1
    return bool(value) * root_chord((value << even) >> 32), 8 - even // 2


def square_root(number, bits):
    """(1.15) The root of a number; 0 of what is not positive."""
    mantissa, exponent = number
    if mantissa <= 0:
        return ZERO
    odd = exponent & 1
    shifted = mantissa << odd
    even = (32 - shifted.bit_length()) & ~1
    seed = root_chord(shifted << even) << 7, (exponent - odd) // 2 - 8 - even // 2 - 7
    if bits <= 16:
        return normalised(seed[0], seed[1], bits)
    inverse = reciprocal(seed, 31)
    quotient = number[0] * inverse[0], number[1] + inverse[1] - 1
    unit = seed[1] + 31 - (bits + GUARD)
    total = floored(seed[0], unit - (seed[1] - 1)) + floored(quotient[0], unit - quotient[1])
    return normalised(total, unit, bits)


def exact_logarithm(numerator, denominator):
    """ln(numerator/denominator) for a quotient of [1, 2] with 90 fraction bits, by the series of artanh."""
    one = 1 << 90
    z = ((numerator - denominator) << 90) // (numerator + denominator)
    square, power, total, n = z * z // one, z, 0, 1
    while power:
        total += power // n
        power, n = power * square // one, n + 2
    return 2 * total


def logarithm_table():
    """(1.16) For 32 intervals of [1, 2): 1/middle in UQ0.16, and minus its logarithm in UQ0.32."""
    table = []
    for i in range(32):
        middle = 64 + 2 * i + 1
        inverse = ((64 << 16) + middle // 2) // middle
        table.append((inverse, (exact_logarithm(1 << 16, inverse) + (1 << 57)) >> 58))
    return table


LOGARITHMS = logarithm_table()
LN_2 = (exact_logarithm(2, 1) + (1 << 49)) >> 50


def logarithm(number):
    """(1.17) ln(number) in Q31.32; None of what is not positive."""
    mantissa = number[0]
    if mantissa <= 0:
        return None
    x = mantissa << (31 - mantissa.bit_length())
    inverse, offset = LOGARITHMS[(x >> 25) & 31]
    d = nearest(x * inverse - (1 << 46), 10)
    inner = (1 << 30) // 4 - nearest(d * ((1 << 30) // 5), 36)
    inner = (1 << 30) // 3 - nearest(d * inner, 36)
    inner = (1 << 30) // 2 - nearest(d * inner, 36)
    bent = nearest(d * inner, 30)
    below = (d << 4) - nearest(d * bent, 32)
    end = 1 << 20
    total = max(-end, min(end, leading(number))) * LN_2 + (offset << 8) + below
    return nearest(total, 8)
