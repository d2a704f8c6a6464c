"""Measures how smoothly the steps of a walk are joined.

    measure_joins.py BIN_FOLDER LIBRARY.steps [PRINTS.csv GROUND] [--check]

Walks at 480 frames a second, so that a join can be told from what a motion does from frame to frame:
on both sides of every strike polynomials are fitted to the places of each joint relative to the hips,
and of the hips, and their velocities and accelerations at the join compared. The jumps are shares of
the 99th percentile of the examples' speeds and accelerations. The library's own examples must have
that many frames a second too: between the frames of others poses are interpolated, which has corners.
Knees are told apart: the foot that strikes at a join moves them, in the examples as well. Without
prints: random scripts on level ground. --check: exit code 1 beyond the targets.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from measure_walk import Library, Motion
from random_scripts import csv_of, script

RATE = 480
WINDOW = 12       # frames fitted on either side: 25 ms
FEET = ("foot", "ankle", "toe", "ball")
TARGETS = (0.01, 0.08)  # of the body, shares; fits to examples alone find up to 0.03 of acceleration


def places(motion):
    """Of the hips in the world, of all others relative to them: [frames, joints, 3]."""
    relative = motion.positions - motion.positions[:, :1]
    relative[:, 0] = motion.positions[:, 0]
    return relative


def of_body(motion):
    feet = {i for i, name in enumerate(motion.names) if any(word in name.lower() for word in FEET)}
    knees = {motion.skeleton[i]["parent"] for i in feet} - feet
    return [i for i in range(len(motion.names)) if i not in feet | knees], sorted(knees)


def percentiles(library):
    """99th percentiles of the speeds and accelerations of all joints, over all examples."""
    speeds, forces = [], []
    for example in library.examples:
        values = places(example)
        speeds.append(np.linalg.norm(np.diff(values, axis=0), axis=2) * example.rate)
        forces.append(np.linalg.norm(np.diff(values, 2, axis=0), axis=2) * example.rate ** 2)
    return np.percentile(np.concatenate(speeds), 99), np.percentile(np.concatenate(forces), 99)


def derivatives(values, rate):
    """Velocity and acceleration at time 0 of quartics through values[frames, ...], before or after."""
    times = np.arange(len(values)) / rate
    basis = np.stack([times ** k for k in range(5)], axis=1)
    flat = values.reshape(len(values), -1)
    solved = np.linalg.lstsq(basis, flat, rcond=None)[0]
    return (solved[1].reshape(values.shape[1:]), 2 * solved[2].reshape(values.shape[1:]))


def jumps(motion, times, joints):
    """Largest of velocity and acceleration at any of `times`, over the joints: shape [2]."""
    values = places(motion)[:, joints]
    worst = np.zeros(2)
    for time in times:
        k = int(round(time * motion.rate))
        if k < WINDOW or k + WINDOW >= len(values):
            continue
        after_v, after_a = derivatives(values[k:k + WINDOW], motion.rate)
        before_v, before_a = derivatives(values[k:k - WINDOW:-1], motion.rate)
        worst = np.maximum(worst, (np.linalg.norm(after_v + before_v, axis=1).max(),
                                   np.linalg.norm(after_a - before_a, axis=1).max()))
    return worst


def walk(tool, library, prints, ground, folder):
    (folder / "prints.csv").write_text(csv_of(prints) if not isinstance(prints, str) else prints)
    subprocess.run([tool, library, "--prints", folder / "prints.csv", "--ground", ground, "-q",
                    "--rate", str(RATE), "--orientation", "xyzw", "-o", folder / "walk.anim"],
                   check=True)
    keys = json.loads((folder / "walk.keys.json").read_text())
    strikes = [k["time"] for k in keys["keytimes"] if k["name"].endswith("_strike")]
    return Motion.read(folder / "walk.anim"), strikes


def main():
    arguments = [one for one in sys.argv[1:] if one != "--check"]
    if len(arguments) not in (2, 4):
        print(__doc__, file=sys.stderr)
        return 2
    tool = pathlib.Path(arguments[0]) / "krok-walk"
    library = Library(arguments[1])
    usual = np.array(percentiles(library))
    print("examples: 99th percentile of speeds {:.3g} m/s, of accelerations {:.3g} m/s2".format(*usual))
    scripts = [script("level", number) for number in range(12)]
    if len(arguments) == 4:
        scripts = [(pathlib.Path(arguments[2]).read_text(), arguments[3])]
    worst = np.zeros((2, 2))
    with tempfile.TemporaryDirectory() as name:
        for prints, ground in scripts:
            motion, strikes = walk(tool, arguments[1], prints, ground, pathlib.Path(name))
            for i, joints in enumerate(of_body(motion)):
                worst[i] = np.maximum(worst[i], jumps(motion, strikes, joints) / usual)
    own = np.zeros((2, 2))
    for example in library.examples:
        for i, joints in enumerate(of_body(example)):
            own[i] = np.maximum(own[i], jumps(example, example.times(), joints) / usual)
    for i, part in enumerate(("body", "knees")):
        print("{}: velocity jumps by {:.3g} %, acceleration by {:.3g} %; anywhere in an example {:.3g} %, "
              "{:.3g} %".format(part, *100 * worst[i], *100 * own[i]))
    return 1 if "--check" in sys.argv and (worst[0] > TARGETS).any() else 0


if __name__ == "__main__":
    sys.exit(main())
