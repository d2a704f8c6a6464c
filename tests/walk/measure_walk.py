"""Measures a walk from its result alone: the motion, its sidecar, the footprints and the ground.

    measure_walk.py WALK.anim PRINTS.csv GROUND LIBRARY.steps

GROUND is a text such as slope:12deg. Shares no code with Krok and knows nothing of how the walk was
made: the soles are those that the library's file says, the bones those of the motion's own skeleton.
Prints one line a measure.
"""

import csv
import json
import pathlib
import struct
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "golden"))
import read_krok_files  # noqa: E402

from grounds import ground_of  # noqa: E402

SIDES = ("left", "right")
SOLE_WIDTH = 0.08  # metres
AWAY = 0.1         # metres from both prints: where clearance is measured


def records(container, name, count):
    """Positions and orientations (x, y, z, w) of `count` transforms."""
    width = container.record_size // 4
    values = np.frombuffer(container.section(name, count * container.record_size), "<f4")
    values = values.reshape(count, width).astype(float)
    turns = values[:, 3:]
    if width == 6:
        w = -np.sqrt(np.maximum(0, 1 - (turns ** 2).sum(1)))
        turns = np.column_stack([turns, w])
    return values[:, :3], turns / np.linalg.norm(turns, axis=1, keepdims=True)


class Motion:
    def __init__(self, skeleton, rate, positions, turns):
        self.skeleton, self.rate = skeleton, rate
        self.positions, self.turns = positions, turns  # [frames, joints, 3 and 4]
        self.names = [joint["name"] for joint in skeleton]

    @classmethod
    def read(cls, path):
        container = read_krok_files.Container(pathlib.Path(path).read_bytes())
        rate, frames, joints, _ = struct.unpack("<dQII", container.section("INFO", 24))
        positions, turns = records(container, "FRAMES", frames * joints)
        return cls(container.skeleton(joints), rate, positions.reshape(frames, joints, 3),
                   turns.reshape(frames, joints, 4))

    def times(self):
        return np.arange(len(self.positions)) / self.rate

    def find(self, *words):
        for i, name in enumerate(self.names):
            if name.lower() in words:
                return i
        raise KeyError(words)


class Library:
    """A .steps file: the soles of its feet, and its examples as motions."""

    def __init__(self, path):
        data = pathlib.Path(path).read_bytes()
        container = read_krok_files.Container(data)
        rate, joints, keytimes, parameters, examples, swing, _ = struct.unpack(
            "<dIIIIII", container.section("INFO", 32))
        self.rate = rate
        feet = [np.array(foot[2:9]) for foot in
                struct.iter_unpack("<iI7d", container.section("FEET", 128))]
        joints_of_feet = [foot[0] for foot in
                          struct.iter_unpack("<iI7d", container.section("FEET", 128))]
        self.feet = [{"joint": joint, "heel": foot[:3], "forward": foot[3:6], "length": foot[6]}
                     for joint, foot in zip(joints_of_feet, feet)]
        heads = list(struct.iter_unpack("<dIIII", container.section("EXAMPLES", 24 * examples)))
        count = sum(head[1] for head in heads)
        positions, turns = records(container, "FRAMES", joints * count)
        skeleton = container.skeleton(joints)
        self.examples, first = [], 0
        for own_rate, frames, _, _, _ in heads:
            part = slice(first * joints, (first + frames) * joints)
            self.examples.append(Motion(skeleton, own_rate,
                                        positions[part].reshape(frames, joints, 3),
                                        turns[part].reshape(frames, joints, 4)))
            first += frames
        self.baseline = Baseline(self.examples)


def rotated(turns, vector):
    """`vector` turned by each quaternion."""
    axis, w = turns[..., :3], turns[..., 3:]
    cross = np.cross(axis, vector) + w * vector
    return vector + 2 * np.cross(axis, cross)


def unrotated(turn, vector):
    return rotated(turn * np.array([-1, -1, -1, 1]), vector)


def knee_angles(motion, side):
    """Radians between thigh and shank."""
    thigh = motion.find(f"{side}upleg", f"{side}upperleg", f"{side}thigh", f"{side}_upper_leg",
                        f"cc_base_{side[0]}_thigh", f"upperleg_{side[0]}")
    foot = motion.find(f"{side}foot", f"{side}ankle", f"{side}_foot", f"cc_base_{side[0]}_foot",
                       f"foot_{side[0]}")
    shank = motion.skeleton[foot]["parent"]
    a = motion.positions[:, shank] - motion.positions[:, thigh]
    b = motion.positions[:, foot] - motion.positions[:, shank]
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(1))


def second_difference(values, rate):
    return np.diff(values, 2, axis=0) * rate * rate


def jumps(values, rate):
    """How much velocity and acceleration differ before and after each frame, from four frames on
    either side: exact for cubics, so that only what is not smooth remains."""
    n = len(values)
    if n < 9:
        return np.zeros((1, values.shape[1])), np.zeros((1, values.shape[1]))
    at = np.arange(3, n - 3)
    first = np.array([-11, 18, -9, 2]) / 6 * rate
    second = np.array([2, -5, 4, -1]) * rate * rate
    after = [values[at + k] for k in range(4)]
    before = [values[at - k] for k in range(4)]
    speed = sum(f * a for f, a in zip(first, after)) + sum(f * b for f, b in zip(first, before))
    force = sum(s * a for s, a in zip(second, after)) - sum(s * b for s, b in zip(second, before))
    return np.linalg.norm(speed, axis=-1), np.linalg.norm(force, axis=-1)


class Baseline:
    """What the examples themselves do, against which a walk is held."""

    def __init__(self, examples):
        self.knee, lifts = 0.0, []
        self.jump_speed = self.jump_force = 0.0
        for motion in examples:
            for side in SIDES:
                bend = second_difference(knee_angles(motion, side), motion.rate)
                self.knee = max(self.knee, np.abs(bend).max())
            lifts.append(second_difference(motion.positions[:, 0, 1], motion.rate))
            speed, force = jumps(motion.positions, motion.rate)
            self.jump_speed = max(self.jump_speed, speed.max())
            self.jump_force = max(self.jump_force, force.max())
        lifts = np.concatenate(lifts)
        self.lift = (lifts.min(), lifts.max())


def read_prints(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    names = [name.split(" ")[0] for name in rows[0]]
    return [dict(zip(names, row)) for row in rows[1:]]


def stances(keys, motion, feet):
    """For each foot its stances in order: when the heel rests, and when the ball does."""
    result = []
    for side, foot in zip(SIDES, feet):
        heel_joint = motion.names[foot["joint"]]
        toes = [i for i, joint in enumerate(motion.skeleton) if joint["parent"] == foot["joint"]]
        toe_names = {motion.names[i] for i in toes}
        heels = sorted((c["start"], c["end"]) for c in keys["contacts"] if c["joint"] == heel_joint)
        balls = sorted((c["start"], c["end"]) for c in keys["contacts"] if c["joint"] in toe_names)
        pairs = []
        for start, end in heels:
            rest = [b for b in balls if b[0] < end and b[1] > start]
            pairs.append(((start, end), rest[0] if rest else (start, end)))
        result.append(pairs)
    return result


def between(times, start, end):
    return (times >= start - 1e-6) & (times <= end + 1e-6)


class Foot:
    """Heel and ball in all frames, and where the sole's sides are."""

    def __init__(self, motion, sole, ground):
        joint = sole["joint"]
        at, turns = motion.positions[:, joint], motion.turns[:, joint]
        self.heel = at + rotated(turns, sole["heel"])
        ball = sole["heel"] + sole["length"] * sole["forward"]
        self.ball = at + rotated(turns, ball)
        # The walker begins with flat feet, which tells which way the sole faces.
        forward = self.ball[0] - self.heel[0]
        normal = normal_at(ground, self.heel[0])
        # With the heel up, the part of the sole at the ball belongs to the toes.
        parents = [one["parent"] for one in motion.skeleton]
        toes = [i for i, parent in enumerate(parents) if parent == joint]
        self.rest = self.ball
        if toes:
            # Helper bones have no children, or fewer.
            joint = max(toes, key=parents.count)
            toes_at, toes_turns = motion.positions[:, joint], motion.turns[:, joint]
            own_ball = unrotated(toes_turns[0], self.ball[0] - toes_at[0])
            self.rest = toes_at + rotated(toes_turns, own_ball)
        left = np.cross(normal, forward)
        own_left = unrotated(turns[0], left / np.linalg.norm(left))
        self.left = rotated(turns, own_left)

    def corners(self):
        return [point + sign * 0.5 * SOLE_WIDTH * self.left
                for point in (self.heel, self.ball) for sign in (-1, 1)]


def normal_at(ground, place, step=1e-4):
    x, _, z = place
    along_x = (ground.height(x + step, z) - ground.height(x - step, z)) / (2 * step)
    along_z = (ground.height(x, z + step) - ground.height(x, z - step)) / (2 * step)
    if not np.isfinite(along_x + along_z):
        return np.array([0.0, 1.0, 0.0])
    normal = np.array([-float(along_x), 1.0, -float(along_z)])
    return normal / np.linalg.norm(normal)


def over_ground(points, ground):
    return points[:, 1] - ground.height(points[:, 0], points[:, 2])


def half_steps(values):
    """Half the distance to the next float: the most by which a coordinate is rounded."""
    return 0.5 * np.spacing(np.abs(values).astype(np.float32)).astype(float)


def bone_error(motion):
    """Largest change of a bone's length, as a share of it, beyond what the file's floats allow: each
    coordinate of both its ends is rounded to the nearest, and so is the reference pose. And the
    change with that rounding."""
    worst = rounded = 0.0
    for i, joint in enumerate(motion.skeleton):
        if joint["parent"] < 0:
            continue
        ends = motion.positions[:, i], motion.positions[:, joint["parent"]]
        lengths = np.linalg.norm(ends[0] - ends[1], axis=1)
        reference = (np.array(joint["reference"]["position"]),
                     np.array(motion.skeleton[joint["parent"]]["reference"]["position"]))
        own = np.linalg.norm(reference[0] - reference[1])
        if own <= 1e-3:
            continue
        floats = np.linalg.norm(half_steps(ends[0]) + half_steps(ends[1]), axis=1)
        floats += np.linalg.norm(half_steps(reference[0]) + half_steps(reference[1]))
        off = np.abs(lengths - own)
        worst = max(worst, (np.maximum(0, off - floats) / own).max())
        rounded = max(rounded, (off / own).max())
    return worst, rounded


def measure(motion, keys, prints, ground, library):
    times = motion.times()
    feet = [Foot(motion, sole, ground) for sole in library.feet]
    m = {"print_mm": 0.0, "print_deg": 0.0, "heel_drift_mm": 0.0, "ball_drift_mm": 0.0,
         "corner_mm": 0.0, "warp_mm": 0.0, "sink_mm": 0.0, "clearance_mm": np.inf,
         "never_flat": 0, "stances_missing": 0}
    all_stances = stances(keys, motion, library.feet)
    for side, foot, pairs in zip(SIDES, feet, all_stances):
        own = [p for p in prints if p["side"] == side]
        if len(pairs) != len(own):
            m["stances_missing"] += abs(len(own) - len(pairs))
        for k, ((heel_on, ball_on), asked) in enumerate(zip(pairs, own)):
            measure_stance(m, times, foot, heel_on, ball_on, asked, ground)
            if k + 1 < len(pairs):
                measure_swing(m, times, foot, ball_on[1], pairs[k + 1][0][0], ground)
    m["bones"], m["bones_rounded"] = bone_error(motion)
    base = library.baseline
    bends = [np.abs(second_difference(knee_angles(motion, side), motion.rate)).max()
             for side in SIDES]
    m["knee_ratio"] = max(bends) / base.knee
    speed, force = jumps(motion.positions, motion.rate)
    m["speed_jump_ratio"] = speed.max() / base.jump_speed
    m["force_jump_ratio"] = force.max() / base.jump_force
    lift = second_difference(motion.positions[:, 0, 1], motion.rate)
    span = base.lift[1] - base.lift[0]
    m["pelvis_over"] = max(0.0, lift.max() - base.lift[1], base.lift[0] - lift.min()) / span
    return m


def measure_stance(m, times, foot, heel_on, ball_on, asked, ground):
    flat = between(times, max(heel_on[0], ball_on[0]), min(heel_on[1], ball_on[1]))
    if not flat.any():
        m["never_flat"] += 1
    else:
        off = foot.heel[flat][:, (0, 2)] - (float(asked["x"]), float(asked["z"]))
        m["print_mm"] = max(m["print_mm"], 1000 * np.linalg.norm(off, axis=1).max())
        way = foot.ball[flat] - foot.heel[flat]
        heading = np.degrees(np.arctan2(way[:, 0], way[:, 2])) - float(asked["heading"])
        wrapped = (heading + 180) % 360 - 180
        m["print_deg"] = max(m["print_deg"], np.abs(wrapped).max())
        heights = np.array([over_ground(corner[flat], ground) for corner in foot.corners()])
        heights = heights[:, np.isfinite(heights).all(axis=0)]
        if heights.size:
            # No plane is nearer to four corners than a quarter of their warp.
            warp = np.abs(heights[0] - heights[1] - heights[2] + heights[3]) / 4
            m["warp_mm"] = max(m["warp_mm"], 1000 * warp.max())
            m["corner_mm"] = max(m["corner_mm"], 1000 * (np.abs(heights) - warp).max())
    for name, points, on in (("heel", foot.heel, heel_on), ("ball", foot.rest, ball_on)):
        rests = points[between(times, *on)]
        if len(rests):
            drift = np.linalg.norm(rests - rests[len(rests) // 2], axis=1).max()
            m[name + "_drift_mm"] = max(m[name + "_drift_mm"], 1000 * drift)


def measure_swing(m, times, foot, off, on, ground):
    swing = between(times, off, on)
    if not swing.any():
        return
    low = np.full(int(swing.sum()), np.inf)
    for points in (foot.heel[swing], foot.ball[swing]):
        heights = over_ground(points, ground)
        heights = np.where(np.isfinite(heights), heights, np.inf)
        m["sink_mm"] = max(m["sink_mm"], -1000 * heights.min())
        moved = np.minimum(np.linalg.norm(points[:, (0, 2)] - points[0, (0, 2)], axis=1),
                           np.linalg.norm(points[:, (0, 2)] - points[-1, (0, 2)], axis=1))
        low = np.minimum(low, np.where(moved > AWAY, heights, np.inf))
    m["clearance_mm"] = min(m["clearance_mm"], 1000 * low.min())


def measure_files(walk, prints, ground, library):
    keys = json.loads(pathlib.Path(walk).with_suffix("").with_suffix(".keys.json").read_text())
    return measure(Motion.read(walk), keys, read_prints(prints), ground, library)


def main():
    if len(sys.argv) != 5:
        print(__doc__, file=sys.stderr)
        return 2
    library = Library(sys.argv[4])
    for name, value in measure_files(sys.argv[1], sys.argv[2], ground_of(sys.argv[3]),
                                     library).items():
        print(f"{name:16} {value:.6g}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
