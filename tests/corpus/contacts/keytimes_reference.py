"""Finds strikes and toe-offs by numpy alone, from BVH files, and holds krok-keys' against them.

    keytimes_reference.py [options] KEYS_FOLDER IN.bvh...
        KEYS_FOLDER has NAME.keys.json for each NAME.bvh, as `krok-keys IN.bvh... --out-dir` writes
        them. Prints how many events are within a frame, the bias, what is lost and what is extra.
    keytimes_reference.py --thin N OUT_FOLDER IN.bvh...
        Writes each file with every Nth frame, so that a detector can be tried at a lower rate
        while the reference sees all frames (--thin N with KEYS_FOLDER does not change it).

Options: --frame SECONDS (default: 1/60), --each (a row per file), --groups (a row per first words
of the names, up to the last digits), --kinds (a row per kind of step, whatever the file is called).

A step is a run if the pelvis is low in the middle of its stance, where a walker's is high (Cavagna,
Heglund and Taylor 1977), and travels at over 1 m/s (for a leg of 0.86 m), else a walk: forward,
backward or sideways by its travel relative to the line through the hips, over 0.3 m/s; below that,
on the spot.

Nothing here is from Krok: another reader of BVH, other points of the foot, another criterion. The
sole is a line from behind the heel over the ball to the tip of the toes, all placed from the frames
in which the foot lies still; a foot is down while the slowest point of that line is slow. The heel
reaches the ground at up to 1 m/s (Winter, "Foot trajectory in human gait", Phys. Ther. 72, 1992),
and a stop seen through a low-pass filter passes half its speed when it happens: a strike is where
the slowest point passes 0.12 of its speed in swing, which is 0.5 m/s at usual speed (for a leg of
0.86 m). Toes leave gradually: the off is half-way from there to where the slowest point accelerates
most. Against the true events of generated walks, slow to fast and turning, both are within 30 ms:
strikes 9 to 29 ms early, offs 8 to 23 ms late.
"""

import argparse
import json
import os
import re
import sys

import numpy as np

RATE = 240.0  # Hz, of all curves
CUTOFF = 12.0  # Hz
SLOW = 0.12  # of the foot's fastest


class Bvh:
    def __init__(self, path):
        text = open(path, encoding="utf-8", errors="replace").read()
        head, motion = text.split("MOTION", 1)
        self.head = head
        self.names, self.parents, self.offsets, self.channels, self.ends = [], [], [], [], {}
        stack, end = [], False
        tokens = iter(head.split())
        for token in tokens:
            if token in ("ROOT", "JOINT"):
                self.names.append(next(tokens))
                self.parents.append(stack[-1] if stack else -1)
                self.channels.append([])
                self.offsets.append([0, 0, 0])
            elif token == "End":
                next(tokens)
                end = True
            elif token == "{":
                stack.append(len(self.names) - 1)
            elif token == "}":
                stack.pop()
                end = False
            elif token == "OFFSET":
                value = [float(next(tokens)) for _ in range(3)]
                if end:
                    self.ends[stack[-1]] = np.array(value)
                else:
                    self.offsets[-1] = value
            elif token == "CHANNELS":
                self.channels[-1] = [next(tokens) for _ in range(int(next(tokens)))]
        lines = motion.strip().splitlines()
        self.time = float(lines[1].split(":")[1])
        self.rows = [line for line in lines[2:] if line.strip()]
        self.values = np.array([[float(v) for v in row.split()] for row in self.rows])

    def world(self):
        """Rotations [frames, joints, 3, 3] and positions [frames, joints, 3]."""
        frames, count = len(self.values), len(self.names)
        turns, places = np.zeros((frames, count, 3, 3)), np.zeros((frames, count, 3))
        column = 0
        for j in range(count):
            turn = np.tile(np.eye(3), (frames, 1, 1))
            place = np.tile(np.array(self.offsets[j], float), (frames, 1))
            moved = False
            for channel in self.channels[j]:
                value = self.values[:, column]
                column += 1
                axis = "XYZ".index(channel[0].upper())
                if channel[1:].lower() == "position":
                    if not moved and len(self.channels[j]) == 6:
                        place, moved = np.zeros((frames, 3)), True
                    place[:, axis] = value
                    continue
                angle = np.radians(value)
                a, b = [(1, 2), (2, 0), (0, 1)][axis]
                one = np.tile(np.eye(3), (frames, 1, 1))
                one[:, a, a] = one[:, b, b] = np.cos(angle)
                one[:, a, b], one[:, b, a] = -np.sin(angle), np.sin(angle)
                turn = turn @ one
            parent = self.parents[j]
            if parent < 0:
                turns[:, j], places[:, j] = turn, place
            else:
                turns[:, j] = turns[:, parent] @ turn
                places[:, j] = places[:, parent] + np.einsum(
                    "fij,fj->fi", turns[:, parent], place)
        return turns, places


def joint(names, words, side):
    """The first joint whose name has one of the words and is of the side."""
    for j, name in enumerate(names):
        plain = name.split(":")[-1]
        first = side[0]
        of_side = (side in plain.lower() or plain.endswith("_" + first.upper())
                   or "_" + first.upper() + "_" in plain or re.match(first + "[A-Z]", plain)
                   or plain.lower() in [first + word for word in words])
        if of_side and any(word in plain.lower() for word in words):
            return j
    return -1


def spline(values, time, at):
    """The natural cubic spline through values, [frames, ...], at times `at`."""
    n = len(values)
    flat = values.reshape(n, -1)
    right = np.zeros_like(flat)
    right[1:-1] = 6 * (flat[2:] - 2 * flat[1:-1] + flat[:-2]) / time**2
    bend, c, d = np.zeros_like(flat), np.zeros(n), np.zeros_like(flat)
    for i in range(1, n - 1):  # tridiagonal, 4 on the diagonal
        pivot = 4 - c[i - 1]
        c[i] = 1 / pivot
        d[i] = (right[i] - d[i - 1]) / pivot
    for i in range(n - 2, 0, -1):
        bend[i] = d[i] - c[i] * bend[i + 1]
    i = np.clip((at / time).astype(int), 0, n - 2)
    t = (at / time - i)[:, None]
    result = (flat[i] * (1 - t) + flat[i + 1] * t
              + time**2 / 6 * (((1 - t)**3 - (1 - t)) * bend[i] + (t**3 - t) * bend[i + 1]))
    return result.reshape((len(at),) + values.shape[1:])


def smooth(values, cutoff=CUTOFF):
    """Gaussian low-pass of [frames, n] at RATE."""
    sigma = RATE / (2 * np.pi * cutoff) * np.sqrt(2 * np.log(2) / 2)
    reach = int(4 * sigma) + 1
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma)**2)
    kernel /= kernel.sum()
    before = 2 * values[0] - values[reach:0:-1]
    after = 2 * values[-1] - values[-2:-reach - 2:-1]
    padded = np.concatenate([before, values, after])
    return np.stack([np.convolve(padded[:, i], kernel, "valid") for i in range(values.shape[1])], 1)


class Body:
    def __init__(self, path):
        bvh = Bvh(path)
        turns, places = bvh.world()
        if len(places) > 2 and np.abs(places[1] - places[0]).max() > 8 * np.abs(
                places[2] - places[1]).max():
            places[0], turns[0] = places[1], turns[1]  # a rest pose
        self.duration = (len(places) - 1) * bvh.time
        at = np.arange(int(self.duration * RATE) + 1) / RATE
        ankles = [joint(bvh.names, ["foot", "ankle"], side) for side in ("left", "right")]
        if min(ankles) < 0:
            raise ValueError("no feet")
        knees = [bvh.parents[a] for a in ankles]
        hips = [bvh.parents[k] for k in knees]
        self.leg = float(np.mean([np.linalg.norm(places[:, k] - places[:, h], axis=1).mean()
                                  + np.linalg.norm(places[:, a] - places[:, k], axis=1).mean()
                                  for h, k, a in zip(hips, knees, ankles)]))
        scale = 0.86 / self.leg
        pelvis = 0.5 * (places[:, hips[0]] + places[:, hips[1]])
        self.pelvis = smooth(spline(pelvis, bvh.time, at) * scale, 6)
        across = spline(places[:, hips[0]] - places[:, hips[1]], bvh.time, at)
        self.facing = smooth(np.stack([-across[:, 2], 0 * across[:, 0], across[:, 0]], 1), 2)
        self.travel = np.gradient(smooth(self.pelvis, 1), axis=0) * RATE * [1, 0, 1]
        self.feet = []
        for side, ankle in zip(("left", "right"), ankles):
            toe = next((j for j, p in enumerate(bvh.parents) if p == ankle), -1)
            ball = places[:, toe] if toe >= 0 else places[:, ankle] + np.einsum(
                "fij,j->fi", turns[:, ankle], bvh.ends[ankle])
            long = np.zeros(3)
            if toe >= 0:
                long = bvh.ends.get(toe, long)
                child = next((j for j, p in enumerate(bvh.parents) if p == toe), -1)
                if child >= 0:
                    long = np.array(bvh.offsets[child])
            # Without an end of the toes: ahead of the ball, with the toe joint.
            along, turn = (long, turns[:, toe]) if np.linalg.norm(long) > 0.02 * self.leg else (
                None, turns[:, toe if toe >= 0 else ankle])
            heel, tip = self.ends(places[:, ankle], ball, turns[:, ankle], turn)
            if along is not None:
                tip = ball + np.einsum("fij,j->fi", turn, along)
            line = [heel + t * (ball - heel) for t in (0, 0.15, 0.3, 0.6, 1)] + [
                ball + t * (tip - ball) for t in (0.5, 1)]
            self.feet.append([smooth(spline(p, bvh.time, at) * scale) for p in line])
        self.at = at

    def ends(self, ankle, ball, ankle_turn, ball_turn):
        """Heel and tip: behind and below the ankle and ahead of the ball, fixed to the foot as it
        lies in its still frames."""
        speed = np.linalg.norm(np.diff(0.5 * (ankle + ball), axis=0), axis=1)
        height = (0.5 * (ankle + ball))[:-1, 1]
        still = np.argsort(speed / (np.median(speed) + 1e-9)
                           + 4 * (height - height.min()) / self.leg)[:max(3, len(speed) // 10)]
        ahead = (ball - ankle)[still]
        ahead[:, 1] = 0

        def fixed(offset, to, turn):
            local = np.einsum("fji,fj->fi", turn[still], offset)
            return to + np.einsum("fij,j->fi", turn, np.median(local, axis=0))

        down = np.zeros_like(ahead)
        down[:, 1] = -0.07 * self.leg
        return (fixed(-0.4 * ahead + down, ankle, ankle_turn),
                fixed(0.5 * ahead + 0.3 * down, ball, ball_turn))

    def events(self):
        found = {}
        for side, points in zip(("left", "right"), self.feet):
            strikes, offs = self.of_foot(points)
            found[side + "_strike"], found[side + "_off"] = strikes, offs
        self.found = found
        return found

    def kind(self, event, time):
        """What kind of step an event of events() belongs to."""
        i = min(int(time * RATE), len(self.at) - 1)
        speed = np.linalg.norm(self.travel[i])
        if speed < 0.3:
            return "on the spot"
        ahead = self.travel[i] @ self.facing[i] / (speed * np.linalg.norm(self.facing[i]) + 1e-9)
        direction = "forward" if ahead > 0.7 else "backward" if ahead < -0.7 else "sideways"
        side, what = event.split("_")
        partners = self.found[side + ("_off" if what == "strike" else "_strike")]
        away = [t - time for t in partners if 0 < (t - time if what == "strike" else time - t) < 1]
        length = min(away, key=abs) if away else 0.4 if what == "strike" else -0.4
        heights = [self.pelvis[min(max(int((time + part * length) * RATE), 0),
                                   len(self.at) - 1), 1] for part in (0, 0.5, 1)]
        sinks = heights[1] < 0.5 * (heights[0] + heights[2])
        return ("run " if sinks and speed > 1 else "walk ") + direction

    def of_foot(self, points):
        speeds = [np.linalg.norm(np.gradient(p, axis=0), axis=1) * RATE for p in points]
        slowest = np.min(speeds, axis=0)
        limit = np.clip(SLOW * np.percentile(slowest, 97), 0.1, 0.8)
        slow = slowest < limit
        low = np.min([p[:, 1] for p in points], axis=0)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], slow.astype(int), [0]])))
        joined = []
        for a, b in zip(edges[::2], edges[1::2] - 1):
            way = np.linalg.norm(points[3][a] - points[3][joined[-1][1]]) if joined else 1
            if joined and (a - joined[-1][1] < 0.05 * RATE or way < 0.03):
                joined[-1][1] = b
            else:
                joined.append([a, b])
        strikes, offs = [], []
        for a, b in joined:
            around = low[max(0, a - int(0.6 * RATE)):b + int(0.6 * RATE)]
            if b - a < 0.06 * RATE or low[a:b + 1].min() - around.min() > 0.25:
                continue
            if a > 0:
                strikes.append(self.crossing(slowest - limit, a - 1, a) / RATE)
            if b < len(slow) - 1:
                off = self.crossing(slowest - limit, b, b + 1)
                if np.argmin([s[b] for s in speeds]) >= 4:  # not backwards, over the heel
                    off = 0.5 * (off + self.steepest(slowest, b))
                offs.append(off / RATE)
        return strikes, offs

    def steepest(self, curve, b):
        """Where the curve rises most, soon after b."""
        rise = np.diff(curve[b - int(0.02 * RATE):b + int(0.1 * RATE)])
        first = int(np.argmax(rise))
        # The first such place: a foot that is off goes on speeding up.
        high = np.flatnonzero((rise[1:-1] >= rise[:-2]) & (rise[1:-1] >= rise[2:])
                              & (rise[1:-1] > 0.6 * rise[first]))
        return b - int(0.02 * RATE) + (high[0] + 1 if len(high) else first) + 0.5

    def crossing(self, curve, a, b):
        return a - curve[a] / (curve[b] - curve[a])


class Tally:
    def __init__(self):
        self.known = self.within = self.extra = 0
        self.errors = []

    def add(self, known, found, frame):
        found = list(found)
        for time in known:
            self.known += 1
            if not found:
                continue
            best = min(found, key=lambda f: abs(f - time))
            if abs(best - time) > 0.2:
                continue
            found.remove(best)
            self.errors.append(best - time)
            self.within += abs(best - time) <= frame + 1e-9
        self.extra += len(found)

    def text(self, frame):
        if not self.known:
            return "none"
        bias = np.median(self.errors) / frame if self.errors else 0
        centred = np.mean(np.abs(np.array(self.errors) - bias * frame) <= frame) if self.errors else 0
        return (f"{self.known:5d} known, {100 * self.within / self.known:5.1f} % within a frame, "
                f"bias {bias:+5.2f} frames ({100 * centred:3.0f} % without it), "
                f"{self.known - len(self.errors):3d} lost, {self.extra:3d} extra")


def thin(path, step, folder):
    bvh = Bvh(path)
    rows = bvh.rows[::step]
    with open(os.path.join(folder, os.path.basename(path)), "w", encoding="utf-8") as out:
        out.write(f"{bvh.head}MOTION\nFrames: {len(rows)}\nFrame Time: {bvh.time * step:.9f}\n")
        out.write("\n".join(rows) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--thin", type=int)
    parser.add_argument("--frame", type=float, default=1 / 60)
    parser.add_argument("--each", action="store_true")
    parser.add_argument("--groups", action="store_true")
    parser.add_argument("--kinds", action="store_true")
    parser.add_argument("folder")
    parser.add_argument("inputs", nargs="+")
    options = parser.parse_args()
    if options.thin:
        os.makedirs(options.folder, exist_ok=True)
        for path in options.inputs:
            thin(path, options.thin, options.folder)
        return
    tallies = {}
    for path in options.inputs:
        name = os.path.basename(path).rsplit(".", 1)[0]
        keys = os.path.join(options.folder, name + ".keys.json")
        if not os.path.exists(keys):
            print(f"{name}: no keys", file=sys.stderr)
            continue
        found = json.load(open(keys, encoding="utf-8")).get("keytimes", [])
        try:
            body = Body(path)
        except (ValueError, IndexError) as error:
            print(f"{name}: {error}", file=sys.stderr)
            continue
        groups = ["all"]
        if options.each:
            groups.append(name)
        if options.groups:
            groups.append(re.sub(r"[_-]?\d+$", "", name))
        for event, times in body.events().items():
            # The first and last frames of a capture show no event in full.
            inside = [t for t in times if 0.08 < t < body.duration - 0.08]
            mine = [k["time"] for k in found if k["name"] == event
                    and 0.08 < k["time"] < body.duration - 0.08]
            kind = event.split("_")[1]
            for group in groups:
                tallies.setdefault((group, kind), Tally()).add(inside, mine, options.frame)
            for time in inside if options.kinds else []:
                near = [t for t in mine if abs(t - time) <= 0.2
                        and all(abs(t - time) <= abs(t - other) for other in inside)]
                tallies.setdefault((body.kind(event, time), kind), Tally()).add(
                    [time], near, options.frame)
    for (group, kind), tally in sorted(tallies.items()):
        print(f"{group:40s} {kind:7s}{tally.text(options.frame)}")


if __name__ == "__main__":
    main()
