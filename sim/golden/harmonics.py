"""Formulas 9.1 to 9.4 of docs/specification.md: view-dependent colour."""

from functools import cache
from math import isqrt

from arithmetic import *
from surface import times

ONE = 1 << 30


def inverse_tangent(n):
    """(9.3) arctan(1/n), 100 fraction bits."""
    power, total, k = (1 << 100) // n, 0, 0
    while power:
        total += (-power if k % 2 else power) // (2 * k + 1)
        power, k = power // n**2, k + 1
    return total


PI = 16 * inverse_tangent(5) - 4 * inverse_tangent(239)


@cache
def constant(n, d):
    """(9.3) sqrt(n/(d pi)), Q2.29 to nearest."""
    return (isqrt((n << 160) // (d * PI)) + 1) >> 1


def towards(widths, view, centre, camera_point):
    """(9.1) The unit vector from the eye to a centre, in the scene's axes."""
    if not view.perspective:
        return list(view.rotation[2])
    point, exponent = camera_point(widths, view, centre)
    unit = unit_vector([normalised(value, exponent, widths.mantissa) for value in point], widths.mantissa)
    turned = [sum(row[axis] * part for row, part in zip(view.rotation, unit)) for axis in range(3)]
    return [max(-ONE, min(ONE, nearest(total, 30))) for total in turned]


def unit_vector(vector, bits):
    """(9.1) A vector over its length, Q1.30; 0 of 0."""
    square = windowed([times(part, part) for part in vector], bits)
    inverse = reciprocal(square_root(square, bits), bits)
    if inverse is None:
        return [0, 0, 0]
    return [max(-ONE, min(ONE, fixed(product(part, inverse), 30))) for part in vector]


def q(a, b):
    """(9.2) A product in Q.30."""
    return nearest(a * b, 30)


def polynomials(direction):
    """(9.2) The polynomials of degree 1 to 4 in the trainers' order, Q3.30, each with the n and d of its constant and its sign."""
    x, y, z = direction
    xx, yy, zz, xy, yz, xz = q(x, x), q(y, y), q(z, z), q(x, y), q(y, z), q(x, z)
    rr = xx + yy + zz
    c, s, d = xx - 3 * yy, 3 * xx - yy, xx - yy
    five, seven, odd = 5 * zz - rr, 7 * zz - rr, 7 * zz - 3 * rr
    middle = nearest(q(35 * zz - 30 * rr, zz) + q(3 * rr, rr), 1)
    return [
        (-1, 3, 4, y),
        (1, 3, 4, z),
        (-1, 3, 4, x),
        (1, 15, 4, xy),
        (-1, 15, 4, yz),
        (1, 5, 16, 3 * zz - rr),
        (-1, 15, 4, xz),
        (1, 15, 16, d),
        (-1, 35, 32, q(y, s)),
        (1, 105, 4, q(xy, z)),
        (-1, 21, 32, q(y, five)),
        (1, 7, 16, q(z, 5 * zz - 3 * rr)),
        (-1, 21, 32, q(x, five)),
        (1, 105, 16, q(z, d)),
        (-1, 35, 32, q(x, c)),
        (1, 315, 16, q(xy, d)),
        (-1, 315, 32, q(yz, s)),
        (1, 45, 16, q(xy, seven)),
        (-1, 45, 32, q(yz, odd)),
        (1, 9, 64, middle),
        (-1, 45, 32, q(xz, odd)),
        (1, 45, 64, q(d, seven)),
        (-1, 315, 32, q(xz, c)),
        (1, 315, 256, q(xx, c) - q(yy, s)),
    ]


def harmonics(direction):
    """(9.3) The harmonics, Q2.28."""
    return [nearest(sign * constant(n, d) * value, 31) for sign, n, d, value in polynomials(direction)]


def lit(base, coefficients, values):
    """(9.4) A channel's colour, UQ4.28."""
    total = (base << 12) + sum(nearest(value * coefficient, 16) for value, coefficient in zip(values, coefficients))
    lost = bool(total % 4096)
    return max(0, min((1 << 32) - 1, (total >> 12) | lost))
