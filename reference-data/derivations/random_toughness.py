"""Mean of a random critical energy release rate along a line, over its mean everywhere: what a crack on the line costs where
the length of correlation is many times l0. The sample is the one that a scene with this seed has.

```text
r = [-ln(1 - Phi(g))]^(1/m)/Gamma(1 + 1/m),   g = sum_k w_k xi_k/sqrt(sum_k w_k^2),   w_k = exp(-2 |x - x_k|^2/l^2)
```

The x_k are the corners of a lattice of spacing l/2 about the origin; xi_k, by Box and Muller, from two numbers of SplitMix64
(Steele, Lea, Flood 2014). Standard library only.
"""

from math import cos, erfc, exp, gamma, log, pi, sqrt

MASK = (1 << 64) - 1


def scrambled(bits):
    z = (bits + 0x9E3779B97F4A7C15) & MASK
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
    return z ^ (z >> 31)


def corner(seed, column, row):
    bits = scrambled(scrambled(seed ^ scrambled(column & MASK)) ^ scrambled(~row & MASK))
    first, second = (((b >> 11) + 0.5) / 2**53 for b in (bits, scrambled(bits)))
    return sqrt(-2 * log(first)) * cos(2 * pi * second)


def toughness(x, y, modulus, correlation, seed, reach=8):
    """Here the sum reaches further than in the solver: weights below exp(-32)."""
    u, v = 2 * x / correlation, 2 * y / correlation
    total = squares = 0.0
    for j in range(round(v) - reach, round(v) + reach + 1):
        for i in range(round(u) - reach, round(u) + reach + 1):
            weight = exp(-0.5 * ((u - i) ** 2 + (v - j) ** 2))
            total += weight * corner(seed, i, j)
            squares += weight * weight
    return (-log(0.5 * erfc(total / sqrt(2 * squares)))) ** (1 / modulus) / gamma(1 + 1 / modulus)


if __name__ == "__main__":
    for seed in (1, 2, 3):
        places = [(n + 0.5) / 400 * 10e-3 for n in range(400)]
        values = [toughness(x, 0.0, 2.0, 5e-3, seed) for x in places]
        print(f"modulus 2, correlation 5 mm, seed {seed}: mean {sum(values)/400:.7f}, from {min(values):.4f} to {max(values):.4f} on 10 mm")
