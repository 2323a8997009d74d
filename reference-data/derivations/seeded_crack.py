"""Surface energy of a crack that is seeded by a history field, in one dimension, for spans of no length.

```text
[1 + B max(1 − d/w, 0)] c − 4 l0² c'' = 1,      γ = ∫ [(1 − c)²/(4 l0) + l0 c'²] dx
```

with c the phase field (1 where intact), d the distance from the crack, B = 1000 and w the half width of the
seed. Linear elements with exact integrals, 2, 4 and 8 thousand within the seed, and the solution beyond it in
closed form: c = 1 − A exp(−(d − w)/(2 l0)). Extrapolated with the order 2 of the elements.
"""

B = 1000.0


def energy(width, elements):
    """Surface energy over Gc for l0 = 1."""
    h = width / elements
    n = elements + 1
    lower, diagonal, right = [0.0] * n, [0.0] * n, [0.0] * n
    for e in range(elements):
        # The factor is linear in the element: its products with two linear functions, integrated exactly.
        a, b = (1 + B * (1 - x * h / width) for x in (e, e + 1))
        diagonal[e] += h * (3 * a + b) / 12 + 4 / h
        diagonal[e + 1] += h * (a + 3 * b) / 12 + 4 / h
        lower[e + 1] += h * (a + b) / 12 - 4 / h
        right[e] += h / 2
        right[e + 1] += h / 2
    # Beyond: 4 c'(w) = 2 (1 − c(w)).
    diagonal[-1] += 2.0
    right[-1] += 2.0
    for i in range(1, n):
        factor = lower[i] / diagonal[i - 1]
        diagonal[i] -= factor * lower[i]
        right[i] -= factor * right[i - 1]
    c = [0.0] * n
    c[-1] = right[-1] / diagonal[-1]
    for i in reversed(range(n - 1)):
        c[i] = (right[i] - lower[i + 1] * c[i + 1]) / diagonal[i]
    gamma = 0.0
    for p, q in zip(c, c[1:]):
        gamma += h * ((1 - p) ** 2 + (1 - p) * (1 - q) + (1 - q) ** 2) / 12 + (q - p) ** 2 / h
    beyond = (1 - c[-1]) ** 2 * (1 / 4 + 1 / 4)  # ∫ A² exp(−x) (1/4 + 1/4)
    return 2 * (gamma + beyond)


if __name__ == "__main__":
    for width in (0.5, 1.0):
        values = [energy(width, n) for n in (2000, 4000, 8000)]
        limit = values[2] + (values[2] - values[1]) / 3
        print(f"w = {width} l0:", *(f"{v:.7f}" for v in values), f"limit {limit:.6f}")
