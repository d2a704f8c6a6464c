"""Thirty scripts that a person can walk, and thirty that none can, made by hand.

    judged_scripts.py BIN_FOLDER LIBRARY.steps

Prints which of the first are refused and which of the second are walked without a word; exit code 1 if
there are any.
"""

import math
import pathlib
import subprocess
import sys
import tempfile

from random_scripts import csv_of


def way(steps, width=0.12, out=0.0, begin=(0.0, 0.0), heading=0.0, first=1):
    """Prints along a way from (length, turn in degrees) of each step; both feet stand at the end."""
    x, z = begin
    prints, side = [], first

    def put(side):
        turn = math.radians(heading)
        prints.append({"side": "left" if side > 0 else "right",
                       "x": x + side * 0.5 * width * math.cos(turn),
                       "z": z - side * 0.5 * width * math.sin(turn), "heading": heading + side * out})

    put(side)
    put(-side)
    for length, turn in steps:
        heading += turn
        x += length * math.sin(math.radians(heading))
        z += length * math.cos(math.radians(heading))
        put(side)
        side = -side
    put(side)
    return prints


def straight(count, length, **more):
    return way([(length, 0)] * count, **more)


def at(*places):
    """Prints from (side, x, z[, heading])."""
    return [{"side": {"l": "left", "r": "right"}[p[0]], "x": p[1], "z": p[2],
             "heading": p[3] if len(p) > 3 else 0.0} for p in places]


def treads(count, rise, run, every=1):
    """Stairs, and prints on each (every second) tread with the heel 1 cm from the edge."""
    places, side = [0.0, 0.0, 0.36, 0.69], 1
    places += [1.01 + k * run for k in range(every - 1, count, every)]
    places += [places[-1] + 0.4] * 2
    prints = []
    for place in places:
        prints += at(("l" if side > 0 else "r", side * 0.06, place))
        side = -side
    return prints, f"stairs:rise={rise}m,run={run}m,count={count}"


def boxes(*parts):
    """An OBJ of boxes from (x0, x1, z0, z1, top), tops and four sides."""
    lines, n = [], 0
    for x0, x1, z0, z1, top in parts:
        for x, z in ((x0, z0), (x0, z1), (x1, z1), (x1, z0)):
            lines += [f"v {x} {top} {z}", f"v {x} -1 {z}"]
        lines.append(f"f {n + 1} {n + 3} {n + 5} {n + 7}")
        for k in range(4):
            a, b = n + 1 + 2 * k, n + 1 + 2 * ((k + 1) % 4)
            lines.append(f"f {a} {a + 1} {b + 1} {b}")
        n += 8
    return "\n".join(lines) + "\n"


FLOOR = (-9, 9, -9, 20, 0)
GOOD = at(("l", 0.06, 0), ("r", -0.06, 0), ("l", 0.06, 0.6))

POSSIBLE = {
    "straight": (straight(6, 0.65), "level"),
    "short steps": (straight(6, 0.35), "level"),
    "long steps": (straight(6, 0.8), "level"),
    "narrow": (straight(6, 0.6, width=0.05), "level"),
    "wide": (straight(6, 0.6, width=0.3), "level"),
    "left turn": (way([(0.45, 25)] * 5), "level"),
    "right turn": (way([(0.45, -25)] * 5), "level"),
    "slalom": (way([(0.5, 20), (0.5, 20), (0.5, -20), (0.5, -20), (0.5, -20), (0.5, 20)]), "level"),
    "turn on the spot": (way([(0.0, 30)] * 4, width=0.2), "level"),
    "side steps": (at(("l", 0.1, 0), ("r", -0.1, 0), ("l", 0.35, 0), ("r", 0.15, 0), ("l", 0.6, 0),
                      ("r", 0.4, 0)), "level"),
    "a step back": (at(("l", 0.06, 0), ("r", -0.06, 0), ("l", 0.06, -0.3), ("r", -0.06, -0.3)),
                    "level"),
    "one step": (straight(1, 0.5), "level"),
    "uneven steps": (way([(0.4, 0), (0.7, 0), (0.45, 0), (0.75, 0), (0.4, 0)]), "level"),
    "toes out": (straight(5, 0.6, out=25), "level"),
    "toes in": (straight(5, 0.6, out=-8, width=0.16), "level"),
    "right foot first": (straight(5, 0.6, first=-1), "level"),
    "stairs up": treads(6, 0.17, 0.29),
    "stairs down": treads(6, -0.17, 0.29),
    "steep stairs up": treads(6, 0.2, 0.29),
    "steep stairs down": treads(6, -0.2, 0.29),
    "two treads at a time": treads(6, 0.12, 0.29, every=2),
    "up a slope": (straight(6, 0.6, begin=(0, 3)), "slope:15deg,begin=-9"),
    "down a slope": (straight(6, 0.6, begin=(0, 3)), "slope:-15deg,begin=-9"),
    "across a slope": (straight(6, 0.6, begin=(0, 3), heading=90), "slope:20deg,begin=-9"),
    "up a steep slope": (straight(6, 0.35, begin=(0, 3)), "slope:30deg,begin=-9"),
    "down a steep slope": (straight(6, 0.35, begin=(0, 3)), "slope:-30deg,begin=-9"),
    "onto a slope": (straight(6, 0.6), "slope:20deg"),
    "rough ground": (straight(8, 0.55), "rough:seed=3,height=0.1m"),
    "over a threshold": (straight(4, 0.7), boxes(FLOOR, (-2, 2, 1.08, 1.13, 0.1))),
    "up and down a kerb": (straight(6, 0.6), boxes(FLOOR, (-2, 2, 1.0, 2.9, 0.15))),
}

IMPOSSIBLE = {
    "two metres": (GOOD + at(("r", -0.06, 2.6), ("l", 0.06, 2.6)), "level"),
    "a metre and a half": (GOOD + at(("r", -0.06, 2.1), ("l", 0.06, 2.1)), "level"),
    "back two metres": (GOOD + at(("r", -0.06, -1.4), ("l", 0.06, -1.4)), "level"),
    "aside": (GOOD + at(("r", -1.6, 0.6), ("l", -1.4, 0.6)), "level"),
    "up 80 cm": treads(3, 0.8, 0.35),
    "up a metre": treads(3, 1.0, 0.35),
    "down a metre": treads(3, -1.0, 0.35),
    "onto a table": (straight(3, 0.6), boxes(FLOOR, (-2, 2, 1.0, 9, 0.9))),
    "off a wall": (straight(3, 0.6), boxes((-2, 2, -2, 1.0, 1.2), (-9, 9, 1.0, 9, 0))),
    "legs cross": (GOOD + at(("r", 0.6, 0.9), ("l", 0.7, 1.2)), "level"),
    "legs cross behind": (at(("l", 0.06, 0), ("r", -0.06, 0), ("l", -0.5, 0.1), ("r", -0.5, 0.5)),
                          "level"),
    "on the other foot": (at(("l", 0.06, 0), ("r", -0.06, 0), ("l", -0.06, 0), ("r", -0.06, 0.5)),
                          "level"),
    "face about": (GOOD + at(("r", -0.06, 0.9, 180), ("l", 0.06, 0.9, 180)), "level"),
    "face away": (GOOD + at(("r", -0.06, 1.0, 140), ("l", 0.06, 1.3, 140)), "level"),
    "toes inwards": (GOOD + at(("r", -0.1, 1.0, 110), ("l", 0.06, 1.3)), "level"),
    "across an edge": (at(("l", 0.06, 0), ("r", -0.06, 0), ("l", 0.06, 0.5), ("r", -0.06, 0.9),
                          ("l", 0.06, 0.9)), "stairs:rise=0.2m,run=0.5m"),
    "across a drop": (at(("l", 0.06, 0), ("r", -0.06, 0), ("l", 0.06, 0.5), ("r", -0.06, 0.9),
                         ("l", 0.06, 0.9)), "stairs:rise=-0.2m,run=0.5m"),
    "over a hole": (straight(4, 0.6), boxes((-2, 2, -2, 1.0, 0), (-2, 2, 2.2, 9, 0))),
    "beyond the edge": (straight(6, 0.6), boxes((-2, 2, -2, 2.0, 0))),
    "nothing at all": (straight(4, 0.6, begin=(50, 50)), boxes(FLOOR)),
    "through a wall": (straight(4, 0.6), boxes(FLOOR, (-2, 2, 1.02, 1.1, 2.0))),
    "over a fence": (straight(4, 0.6), boxes(FLOOR, (-2, 2, 1.02, 1.1, 1.0))),
    "a cliff to stand on": (straight(4, 0.3, begin=(0, 3)), "slope:50deg,begin=-9"),
    "a cliff across": (straight(4, 0.3, begin=(0, 3), heading=90), "slope:55deg,begin=-9"),
    "down a cliff": (straight(4, 0.3, begin=(0, 3)), "slope:-55deg,begin=-9"),
    "twice the same foot": (GOOD + at(("l", 0.06, 1.2), ("r", -0.06, 1.2)), "level"),
    "one print": (at(("l", 0.06, 0)), "level"),
    "no number": (GOOD + at(("r", math.nan, 1.2), ("l", 0.06, 1.2)), "level"),
    "at the end of the world": (GOOD + at(("r", -0.06, 1e9), ("l", 0.06, 1e9)), "level"),
    "forty steps a second": ([dict(p, time=0.025 * k) for k, p in
                              enumerate(straight(6, 0.65))], "level"),
}


def text_of(prints):
    if "time" not in prints[0]:
        return csv_of(prints)
    lines = csv_of(prints).splitlines()
    lines[0] += ",time [s]"
    return "\n".join([lines[0]] + [f"{line},{p['time'] or ''}" for line, p in
                                   zip(lines[1:], prints)]) + "\n"


def run(tool, library, prints, ground, folder):
    (folder / "prints.csv").write_text(text_of(prints))
    if "\n" in ground:
        (folder / "ground.obj").write_text(ground)
        ground = str(folder / "ground.obj")
    return subprocess.run([tool, library, "--prints", folder / "prints.csv", "--ground", ground,
                           "-q", "-o", folder / "walk.anim"], capture_output=True, text=True)


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    tool, library = pathlib.Path(sys.argv[1]) / "krok-walk", sys.argv[2]
    refused = accepted = 0
    with tempfile.TemporaryDirectory() as name:
        for title, (prints, ground) in POSSIBLE.items():
            done = run(tool, library, prints, ground, pathlib.Path(name))
            if done.returncode != 0:
                refused += 1
                print(f"refused although a person can: {title}: {done.stderr.strip().splitlines()[0]}")
        for title, (prints, ground) in IMPOSSIBLE.items():
            done = run(tool, library, prints, ground, pathlib.Path(name))
            if done.returncode == 0:
                accepted += 1
                print(f"walked although nobody can: {title}")
            elif done.returncode != 2 or "error:" not in done.stderr:
                accepted += 1
                print(f"ended wrongly: {title}: {done.returncode} {done.stderr}")
    print(f"{len(POSSIBLE)} possible, {refused} refused; {len(IMPOSSIBLE)} impossible, {accepted} "
          "walked")
    return 1 if refused or accepted or len(POSSIBLE) != 30 or len(IMPOSSIBLE) != 30 else 0


if __name__ == "__main__":
    sys.exit(main())
