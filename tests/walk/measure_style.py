"""How much a walk moves like the real steps that its library was fitted to.

    measure_style.py BIN_FOLDER LIBRARY.steps [--check] [--variation V] [--style NAME] [--distance METRES]
                     [--options "..."]

Walks straight ahead on the level with steps as long as the library's usual ones (or those of the
style), and compares its steps with the examples (of the style) that are as long and as straight, a
row each for the examples, the walk, and the walk of the average (--variation 0):

    arms_cm    range of the hands along the way, from the hips, over a step
    hips_m/s   largest vertical speed of the hips in a step
    jerk       root mean square of the third derivative, over 50 ms, as captures jitter from frame to
               frame; joints relative to the hips, m/s3
    stride_mm  distance between a step and the next one with the same foot, joints relative to the hips
               at the same share of the step, over sqrt(2)
    spread_mm  the same between a step and the mean of all with that foot
    time_%     standard deviation of durations, of the mean

Of examples, neighbours are those cut from one capture. --check: exit code 1 unless arms, hips and
jerk are within 10 % of the examples, and the spread and the stride within 0.5 to 1.2 times theirs.
Shares no code with Krok.
"""

import argparse
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

import numpy as np

from measure_walk import Library, Motion, read_krok_files

PHASES = 32
JERK_OVER = 0.05  # seconds between the places that a third difference is taken of
COLUMNS = ("arms_cm", "hips_m/s", "jerk", "stride_mm", "spread_mm", "time_%", "length_m", "steps")


class Step:
    """Frames [a, b] of a motion, strike to strike; `side` is the foot that stepped, `sequence` the
    capture and the step's number in it."""

    def __init__(self, motion, a, b, side, duration, sequence):
        places = motion.positions[a:b + 1]
        hips = places[:, hips_of(motion)]
        forward = hips[-1] - hips[0]
        self.heading = np.arctan2(forward[0], forward[2])
        c, s = np.cos(-self.heading), np.sin(-self.heading)
        turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        relative = (places - hips[:, None]) @ turn.T
        relative[:, 0] = 0  # a root may be anywhere
        self.side, self.duration, self.sequence = side, duration, sequence
        self.hands = [np.ptp(relative[:, hand, 2]) for hand in hands_of(motion)]
        self.speed = np.abs(np.diff(hips[:, 1])).max() * motion.rate
        moving = relative[:, body_of(motion)]
        far = max(1, int(round(JERK_OVER * motion.rate)))
        third = moving[3 * far:] - 3 * moving[2 * far:-far] + 3 * moving[far:-2 * far] - moving[:-3 * far]
        self.jerk = np.sqrt((third ** 2).sum(2).mean()) * (motion.rate / far) ** 3
        share = np.linspace(0, len(places) - 1, PHASES)
        low = np.minimum(share.astype(int), len(places) - 2)
        part = (share - low)[:, None, None]
        self.cycle = (1 - part) * moving[low] + part * moving[low + 1]


def hips_of(motion):
    return motion.find("hips", "cc_base_hip", "joint_hips", "hip", "pelvis")


def hands_of(motion):
    return [motion.find(f"{side}hand", f"cc_base_{side[0]}_hand", f"hand_{side[0]}", f"{side}wrist")
            for side in ("left", "right")]


def body_of(motion):
    """Joints that carry others, without fingers: at most one below a hand."""
    hands = set(hands_of(motion))
    below = set()
    for i, joint in enumerate(motion.skeleton):
        if joint["parent"] in hands | below:
            below.add(i)
    return [i for i in range(1, len(motion.names)) if i not in below]


def examples_of(library, path):
    container = read_krok_files.Container(pathlib.Path(path).read_bytes())
    rate, joints, keytimes, parameters, examples, swing, _ = struct.unpack(
        "<dIIIIII", container.section("INFO", 32))
    names = container.texts("EXNAMES", examples)
    times = container.numbers("KEYTIMES", "d", keytimes, examples)
    styles = [""] * examples
    if "EXSTYLES" in container.sections:
        styles = container.texts("EXSTYLES", examples)
    steps = []
    for motion, name, time, style in zip(library.examples, names, times, styles):
        a, b = (int(round(t * motion.rate)) for t in (time[0], time[-1]))
        capture, number, side = name.rsplit(" ", 2)
        step = Step(motion, a, min(b, len(motion.positions) - 1), side, time[-1] - time[0],
                    (capture, int(number)))
        foot = library.feet[swing]["joint"]
        ankles = motion.positions[[a, min(b, len(motion.positions) - 1)], foot]
        step.style = style
        step.length = 0.5 * np.hypot(*(ankles[1] - ankles[0])[[0, 2]])
        steps.append(step)
    return steps


def measures(steps):
    arms = 100 * np.mean([s.hands for s in steps])
    speed = np.mean([s.speed for s in steps])
    jerk = np.sqrt(np.mean([s.jerk ** 2 for s in steps]))
    distance = lambda a, b: np.sqrt(((a - b) ** 2).sum(2).mean())
    strides, spreads = [], []
    by = {}
    for s in steps:
        by.setdefault(s.side, []).append(s)
    for own in by.values():
        mean = np.mean([s.cycle for s in own], axis=0)
        spreads += [distance(s.cycle, mean) ** 2 for s in own]
        for s in own:
            capture, number = s.sequence
            follower = next((o for o in own if o.sequence == (capture, number + 2)), None)
            if follower is not None:
                strides.append(distance(s.cycle, follower.cycle) ** 2 / 2)
    durations = np.array([s.duration for s in steps])
    mean_length = np.mean([s.length for s in steps])
    return (arms, speed, jerk, 1000 * np.sqrt(np.mean(strides)) if strides else np.nan,
            1000 * np.sqrt(np.mean(spreads)), 100 * durations.std() / durations.mean(), mean_length,
            len(steps))


def walked(tool, path, length, options, distance):
    with tempfile.TemporaryDirectory() as folder:
        out = f"{folder}/walk.anim"
        subprocess.run([tool, "-q", path, "--goal", f"0,{distance}m", "--step-length", f"{length:.4f}m",
                        "-o", out, *options], check=True)
        motion = Motion.read(out)
        keys = json.loads(pathlib.Path(f"{folder}/walk.keys.json").read_text())
    strikes = sorted((k["time"], k["name"].split("_")[0]) for k in keys["keytimes"]
                     if k["name"].endswith("_strike"))
    steps = []
    for number, ((t0, _), (t1, side)) in enumerate(zip(strikes, strikes[1:])):
        if number < 2 or number > len(strikes) - 4:
            continue
        step = Step(motion, int(round(t0 * motion.rate)), int(round(t1 * motion.rate)), side, t1 - t0,
                    ("walk", number))
        step.length = length
        steps.append(step)
    return steps


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("bin")
    parser.add_argument("library")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--variation", default="0.85")
    parser.add_argument("--style")
    parser.add_argument("--options", default="")
    parser.add_argument("--distance", type=float, default=30)
    arguments = parser.parse_args()
    tool = pathlib.Path(arguments.bin) / "krok-walk"
    library = Library(arguments.library)
    every = examples_of(library, arguments.library)
    options = arguments.options.split()
    if arguments.style:
        wanted = arguments.style.lower()
        every = ([s for s in every if s.style.lower() == wanted]
                 or [s for s in every if wanted in s.sequence[0].lower()])
        options += ["--style", arguments.style]
    usual = np.median([s.length for s in every])
    alike = [s for s in every if abs(s.length - usual) < 0.07 * usual]
    straight = np.median([s.heading for s in alike])
    alike = [s for s in alike if abs(s.heading - straight) < 0.15]
    length = np.mean([s.length for s in alike])
    rows = {"examples": measures(alike)}
    for name, variation in (("walk", arguments.variation), ("average", "0")):
        rows[name] = measures(walked(tool, arguments.library, length,
                                     ["--variation", variation, *options], arguments.distance))
    print(f"{'':10}", *(f"{c:>9}" for c in COLUMNS))
    for name, row in rows.items():
        print(f"{name:10}", *(f"{v:9.3f}" for v in row))
    own, made = rows["examples"], rows["walk"]
    wrong = [c for c, a, b in list(zip(COLUMNS, own, made))[:3] if abs(b / a - 1) > 0.1]
    wrong += [c for c, a, b in list(zip(COLUMNS, own, made))[3:5] if not 0.5 <= b / a <= 1.2]
    print("outside:", *wrong) if wrong else print("within")
    return 1 if wrong and arguments.check else 0


if __name__ == "__main__":
    sys.exit(main())
