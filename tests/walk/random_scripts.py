"""Random scripts: footprints that a person can walk, each with its ground.

A script is (prints, ground): prints as dicts of side, x, z, heading (degrees), ground as a text for
--ground or as Stones. The same for the same kind and number on every machine.
"""

import math
import random

from grounds import Stones

KINDS = ("level", "slope", "stairs up", "stairs down", "rough", "stones")
FOOT = 0.27       # metres from heel to toes
HALF_FOOT = 0.05  # metres across


def prints_along(chance, steps, length, width, turn, begin=(0.0, 0.0), heading=0.0):
    """Prints left and right of a way that bends: length and width (metres) and turn (degrees) are
    ranges that each step draws from; the last two side by side."""
    x, z = begin
    side = chance.choice((1, -1))
    out = chance.uniform(0, 8)
    wide = chance.uniform(*width)
    prints = []

    def put(side, wide):
        prints.append({"side": "left" if side > 0 else "right",
                       "x": x + side * 0.5 * wide * math.cos(math.radians(heading)),
                       "z": z - side * 0.5 * wide * math.sin(math.radians(heading)),
                       "heading": heading + side * out})

    put(side, wide)
    put(-side, wide)
    for _ in range(steps):
        heading += chance.uniform(*turn)
        step = chance.uniform(*length)
        x += step * math.sin(math.radians(heading))
        z += step * math.cos(math.radians(heading))
        put(side, chance.uniform(*width))
        side = -side
    prints.append(dict(prints[-1]))
    wide = chance.uniform(*width)
    prints[-2:] = []
    put(-side, wide)
    put(side, wide)
    return prints


def level(chance):
    return prints_along(chance, chance.randint(3, 14), (0.4, 0.8), (0.08, 0.2), (-18, 18)), "level"


def slope(chance):
    angle = chance.uniform(-30, 30)
    # The steeper, the shorter the steps: up and down by at most 26 cm a step.
    longest = min(0.75, 0.26 / max(1e-3, math.tan(math.radians(abs(angle)))))
    prints = prints_along(chance, chance.randint(3, 12), (0.6 * longest, longest), (0.1, 0.2),
                          (-10, 10), (0.0, 4.0), chance.uniform(-180, 180))
    return prints, f"slope:{angle:.3f}deg,begin=-100m"


def stairs(chance, sign):
    rise = sign * chance.uniform(0.1, 0.2)
    run = chance.uniform(0.29, 0.36)
    count = chance.randint(3, 10)
    side = chance.choice((1, -1))
    wide = chance.uniform(0.1, 0.2)
    places = [0.0, 0.0, chance.uniform(0.3, 0.4)]
    places.append(1.0 - FOOT - chance.uniform(0.02, 0.06))
    for k in range(count):
        places.append(1.0 + k * run + chance.uniform(0.008, run - FOOT - 0.002))
    landing = 1.0 + (count - 1) * run
    places += [max(places[-1] + 0.35, landing + 0.1)] * 2
    prints = []
    for place in places:
        prints.append({"side": "left" if side > 0 else "right", "x": side * 0.5 * wide, "z": place,
                       "heading": 0.0})
        side = -side
    return prints, f"stairs:rise={rise:.4f}m,run={run:.4f}m,count={count}"


def rough(chance):
    prints = prints_along(chance, chance.randint(3, 12), (0.4, 0.7), (0.1, 0.2), (-15, 15))
    return prints, f"rough:seed={chance.randint(0, 10 ** 6)},height=0.1m"


def stone_at(print_, height, chance):
    turn = math.radians(print_["heading"] + chance.uniform(-20, 20))
    half_width, behind, ahead = HALF_FOOT + 0.05, -0.08, FOOT + 0.06
    return ([(print_["x"] + a * math.cos(turn) + b * math.sin(turn),
              print_["z"] - a * math.sin(turn) + b * math.cos(turn))
             for a, b in ((-half_width, behind), (half_width, behind), (half_width, ahead),
                          (-half_width, ahead))], height)


def stones(chance):
    prints = prints_along(chance, chance.randint(3, 10), (0.5, 0.7), (0.16, 0.24), (-8, 8))
    heights = [0.0, 0.0]
    while len(heights) < len(prints) - 1:
        heights.append(heights[-1] + chance.uniform(-0.08, 0.08))
    heights.append(heights[-1])
    # Stones of neighbouring feet may overlap: the higher one would be stood on by both.
    found = [stone_at(p, round(h, 4), chance) for p, h in zip(prints, heights)]
    return prints, Stones([(corners[::-1] if is_clockwise(corners) else corners, height)
                           for corners, height in found])


def is_clockwise(corners):
    area = sum(ax * bz - bx * az
               for (ax, az), (bx, bz) in zip(corners, corners[1:] + corners[:1]))
    return area < 0


MAKERS = {"level": level, "slope": slope, "rough": rough, "stones": stones,
          "stairs up": lambda chance: stairs(chance, 1),
          "stairs down": lambda chance: stairs(chance, -1)}


def script(kind, number):
    return MAKERS[kind](random.Random(f"{kind} {number}"))


def csv_of(prints):
    lines = ["side,x [m],z [m],heading [deg]"]
    lines += [f"{p['side']},{p['x']:.6f},{p['z']:.6f},{p['heading']:.6f}" for p in prints]
    return "\n".join(lines) + "\n"
