"""The ground of a walk, by the letter of lib/terrain's headers, sharing no code with Krok."""

import re

import numpy as np

MASK = (1 << 64) - 1
UNITS = {"": 1.0, "m": 1.0, "cm": 0.01, "mm": 0.001}


def metres(text):
    number, unit = re.fullmatch(r"([-+0-9.e]+)([a-z]*)", text).groups()
    return float(number) * UNITS[unit]


class Level:
    def __init__(self, height=0.0):
        self.level = height

    def height(self, x, z):
        return np.full(np.shape(x), self.level)


class Stairs:
    def __init__(self, rise=0.17, run=0.29, count=20, begin=1.0):
        self.rise, self.run, self.count, self.begin = rise, run, count, begin

    def height(self, x, z):
        runs = (np.asarray(z) - self.begin) / self.run
        passed = np.floor(runs) + 1 if self.rise > 0 else np.ceil(runs)
        return self.rise * np.clip(passed, 0, self.count)


class Slope:
    def __init__(self, angle, begin=1.0):
        self.tangent, self.begin = np.tan(angle), begin

    def height(self, x, z):
        return self.tangent * np.maximum(0, np.asarray(z) - self.begin)


def mixed(bits):
    bits = (bits + 0x9E3779B97F4A7C15) & MASK
    bits = ((bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    bits = ((bits ^ (bits >> 27)) * 0x94D049BB133111EB) & MASK
    return bits ^ (bits >> 31)


class Rough:
    LATTICES = ((0.6, 0.75), (0.2, 0.25))

    def __init__(self, seed=1, height=0.08):
        self.seed, self.range, self.corners = seed, height, {}

    def corner(self, lattice, column, row):
        key = (lattice, column, row)
        if key not in self.corners:
            bits = mixed(mixed(mixed(self.seed + lattice) ^ (column & MASK)) ^ (row & MASK))
            self.corners[key] = (bits >> 11) * 2.0 ** -53 - 0.5
        return self.corners[key]

    def one(self, x, z):
        total = 0.0
        for lattice, (spacing, share) in enumerate(self.LATTICES):
            u, v = x / spacing, z / spacing
            column, row = int(np.floor(u)), int(np.floor(v))
            right, down = eased(u - column), eased(v - row)
            a, b = (self.corner(lattice, column + i, row) for i in (0, 1))
            c, d = (self.corner(lattice, column + i, row + 1) for i in (0, 1))
            upper, lower = a + (b - a) * right, c + (d - c) * right
            total += share * (upper + (lower - upper) * down)
        grown = eased(min(1.0, max(0.0, (np.hypot(x, z) - 0.3) / 0.7)))
        return self.range * grown * total

    def height(self, x, z):
        x, z = np.broadcast_arrays(x, z)
        return np.array([self.one(a, b) for a, b in zip(x.ravel(), z.ravel())]).reshape(x.shape)


def eased(t):
    return t * t * t * (t * (6 * t - 15) + 10)


class Stones:
    """Level quadrilaterals, each four corners (x, z) and a height; NaN beside them."""

    def __init__(self, stones):
        self.stones = stones

    def height(self, x, z):
        x, z = np.broadcast_arrays(np.asarray(x, float), np.asarray(z, float))
        best = np.full(x.shape, np.nan)
        for corners, height in self.stones:
            inside = np.ones(x.shape, bool)
            for (ax, az), (bx, bz) in zip(corners, corners[1:] + corners[:1]):
                inside &= (bx - ax) * (z - az) - (bz - az) * (x - ax) >= -1e-9
            best = np.where(inside & ~(best > height), height, best)
        return best

    def obj(self):
        lines = []
        for corners, height in self.stones:
            lines += [f"v {x:.6f} {height:.6f} {z:.6f}" for x, z in corners]
            n = len(lines) - len(lines) // 5
            lines.append(f"f {n} {n - 1} {n - 2} {n - 3}")
        return "\n".join(lines) + "\n"


def ground_of(spec):
    kind, _, rest = spec.partition(":")
    values = dict(part.split("=") if "=" in part else ("angle", part)
                  for part in rest.split(",") if part)
    if kind == "level":
        return Level(metres(values.get("height", "0")))
    if kind == "slope":
        return Slope(np.radians(float(values["angle"].removesuffix("deg"))),
                     metres(values.get("begin", "1")))
    if kind == "stairs":
        given = {k: int(v) if k == "count" else metres(v) for k, v in values.items()}
        return Stairs(**given)
    if kind == "rough":
        return Rough(int(values.get("seed", "1")), metres(values.get("height", "0.08")))
    raise ValueError("no such ground: " + spec)
