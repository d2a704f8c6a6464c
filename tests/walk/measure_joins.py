"""Measures how smoothly the steps of a walk are joined.

    measure_joins.py BIN_FOLDER LIBRARY.steps [PRINTS.csv GROUND]

Walks at 960 frames a second, so that a join can be told from what a motion does from frame to frame:
on both sides of every strike cubics are fitted to the places of each joint relative to the hips, and
of the hips, and their velocities and accelerations at the join compared. The jumps are shares of the
99th percentile of the examples' speeds and accelerations; feet and toes, which strike, are left out.
Without prints: straight steps, then steps of uneven length round bends, on level ground.
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


def places(motion):
    """Of the hips in the world, of all others relative to them: [frames, joints, 3]."""
    relative = motion.positions - motion.positions[:, :1]
    relative[:, 0] = motion.positions[:, 0]
    return relative


def kept(motion):
    return [i for i, name in enumerate(motion.names)
            if not any(word in name.lower() for word in FEET)]


def percentiles(library):
    """99th percentiles of speeds and accelerations of each joint, over all examples; of a joint that
    hardly moves those of the quietest quarter of the joints."""
    speeds, forces = [], []
    for example in library.examples:
        values = places(example)
        speeds.append(np.linalg.norm(np.diff(values, axis=0), axis=2) * example.rate)
        forces.append(np.linalg.norm(np.diff(values, 2, axis=0), axis=2) * example.rate ** 2)
    return (np.percentile(np.concatenate(speeds), 99), np.percentile(np.concatenate(forces), 99))


def derivatives(values, rate):
    """Velocity and acceleration at time 0 of cubics through values[frames, ...] before or after."""
    times = np.arange(len(values)) / rate
    basis = np.stack([times ** k for k in range(5)], axis=1)
    flat = values.reshape(len(values), -1)
    solved = np.linalg.lstsq(basis, flat, rcond=None)[0]
    return (solved[1].reshape(values.shape[1:]), 2 * solved[2].reshape(values.shape[1:]))


def jumps(motion, times):
    """Largest of velocity and acceleration at any of `times`, over the joints."""
    values = places(motion)[:, kept(motion)]
    result = []
    for time in times:
        k = int(round(time * motion.rate))
        if k < WINDOW or k + WINDOW >= len(values):
            continue
        after_v, after_a = derivatives(values[k:k + WINDOW], motion.rate)
        before_v, before_a = derivatives(values[k:k - WINDOW:-1], motion.rate)
        speed = np.linalg.norm(after_v + before_v, axis=1)
        force = np.linalg.norm(after_a - before_a, axis=1)
        result.append((speed.max(), force.max(), int(speed.argmax()), int(force.argmax())))
    return result


def walk(tool, library, prints, ground, folder):
    (folder / "prints.csv").write_text(csv_of(prints) if not isinstance(prints, str) else prints)
    subprocess.run([tool, library, "--prints", folder / "prints.csv", "--ground", ground, "-q",
                    "--rate", str(RATE), "--orientation", "xyzw", "-o", folder / "walk.anim"],
                   check=True)
    keys = json.loads((folder / "walk.keys.json").read_text())
    strikes = [k["time"] for k in keys["keytimes"] if k["name"].endswith("_strike")]
    return Motion.read(folder / "walk.anim"), strikes


def main():
    if len(sys.argv) not in (3, 5):
        print(__doc__, file=sys.stderr)
        return 2
    tool = pathlib.Path(sys.argv[1]) / "krok-walk"
    library = Library(sys.argv[2])
    speed, force = percentiles(library)
    print(f"examples: 99th percentile of speeds {speed:.3g} m/s, of accelerations {force:.3g} m/s2")
    if len(sys.argv) == 5:
        scripts = [(pathlib.Path(sys.argv[3]).read_text(), sys.argv[4])]
    else:
        scripts = [script("level", number) for number in range(12)]
    worst_speed = worst_force = 0.0
    rest_speed, rest_force = [], []
    with tempfile.TemporaryDirectory() as name:
        for prints, ground in scripts:
            motion, strikes = walk(tool, sys.argv[2], prints, ground, pathlib.Path(name))
            names = [motion.names[i] for i in kept(motion)]
            for time, (v, a, j, i) in zip(strikes, jumps(motion, strikes)):
                if v / speed > worst_speed:
                    worst_speed, joint = v / speed, names[j]
                if a / force > worst_force:
                    worst_force, other = a / force, names[i]
            between = [t + d for t in strikes for d in (0.13, 0.29)]
            for v, a, _, _ in jumps(motion, between):
                rest_speed.append(v / speed)
                rest_force.append(a / force)
    print(f"at joins: velocity jumps by {100 * worst_speed:.3g} % ({joint}), "
          f"acceleration by {100 * worst_force:.3g} % ({other})")
    print(f"elsewhere, where nothing is joined: {100 * max(rest_speed):.3g} %, "
          f"{100 * max(rest_force):.3g} %")
    return 0


if __name__ == "__main__":
    sys.exit(main())
