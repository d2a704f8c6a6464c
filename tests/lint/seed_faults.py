#!/usr/bin/env python3
"""Measures krok-lint's precision and recall on faults that are put into captures.

Usage: seed_faults.py KROK_LINT CAPTURE.bvh... [--clips N] [--half tune|report] [--work FOLDER]

Four kinds by the published recipe of StableMotion (Mu et al. 2025, github.com/Murrol/StableMotion,
data_loaders/dataset_utils.py), at 20 fps, in 20 to 40 frames: noise on the joints' rotation vectors of 0.05 to 0.1 rad
(clipped at 0.5), root velocity times 1 to 1.1, drift of the root of up to 25 mm a frame, a Gaussian of 4 frames over all
rotations; each at five sizes. Further kinds are ours. Its detector of slides (both feet faster than 0.1 m/s, ankles
below 0.15 m, toes below 0.1 m) runs beside.

A fault counts as found if a finding of its rules overlaps it and the clean clip has none there. Findings of these
rules elsewhere that the clean clip lacks, too, are wrong; so are all that clean clips have (column `clean`). The
captures' even half tunes thresholds, the odd half reports.
"""

import argparse
import json
import pathlib
import subprocess
import zlib

import numpy as np

from bvh import Bvh, exp_so3

RULES = {"jitter": {"jitter"}, "slide": {"foot-slide", "drift"}, "drift": {"foot-slide", "drift"},
         "smooth": {"over-smooth"}, "spike": {"pop", "flip"}, "step": {"pop", "flip"}, "flip": {"flip"},
         "frozen": {"frozen"}, "bone": {"bone-length"}, "half rate": {"frame-rate"}, "twice rate": {"frame-rate"}}
SIZES = {"jitter": (.25, .5, 1, 2, 4), "slide": (.25, .5, 1, 2, 4), "drift": (.25, .5, 1, 2, 4), "smooth": (.25, .5, 1, 2, 4),
         "spike": (6, 10, 20, 40, 80), "step": (10, 15, 20, 40, 80), "flip": (180,), "frozen": (.2, .3, .5, 1, 2),
         "bone": (3, 5, 10, 20, 40), "half rate": (.5,), "twice rate": (2,)}
RECIPE = ("jitter", "slide", "drift", "smooth")


def metres_of(motion):
    """Metres of the file's unit, for a body of 1.7 m from sole to head."""
    reference = np.zeros((len(motion.joints), 3))
    for j, (_, parent, offset, _) in enumerate(motion.joints):
        reference[j] = offset + (reference[parent] if parent >= 0 else 0)
    return 1.7 / np.ptp(reference[1:], axis=0).max()


def up_of(motion):
    """The vertical axis: along which the head is over the feet, as the mean pose shows."""
    return int(np.argmax(np.abs(np.ptp(motion.world().mean(0)[1:], axis=0))))


def smoothed(vectors, sigma):
    reach = max(1, round(3 * sigma))
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    padded = np.pad(vectors, ((reach, reach), (0, 0), (0, 0)), mode="edge")
    return sum(w * padded[i:i + len(vectors)] for i, w in enumerate(weights / weights.sum()))


def seed(motion, kind, size, random):
    """Puts one fault into a motion; returns its first and last frame, None where it would be no fault."""
    frames, unit = len(motion.places), metres_of(motion)
    carrier, up = motion.carrier(), up_of(motion)
    level = [axis for axis in range(3) if axis != up]
    length = int(random.integers(20, 41))
    first = int(random.integers(2, max(3, frames - length - 2)))
    window = slice(first, first + length)
    joint = int(random.choice([j for j in motion.moving if j > carrier]))
    if kind in ("jitter", "smooth"):
        vectors = motion.vectors()
        changed = vectors.copy()
        if kind == "jitter":
            joints = random.permutation(motion.moving)[:int(random.integers(1, len(motion.moving) + 1))]
            noise = random.normal(size=vectors.shape) * 0.1 * random.uniform(0.5, 1) * size
            changed[window, joints] += np.clip(noise, -0.5, 0.5)[window, joints]
        else:
            if np.abs(np.diff(vectors[window], axis=0)).max() < 0.03:
                return None  # nothing moves that could be smoothed
            changed[window] = smoothed(vectors, 4 * size)[window]
        motion.rotations = exp_so3(changed)
    elif kind == "slide":
        velocity = np.diff(motion.places[:, carrier], axis=0, prepend=motion.places[:1, carrier])
        if np.linalg.norm(velocity[window][:, level], axis=1).sum() * unit < 0.5:
            return None
        factor = np.ones(frames)
        factor[window] += 0.1 * size * random.random(length)
        way = np.cumsum(velocity * factor[:, None], axis=0) + motion.places[0, carrier]
        motion.places[:, carrier, level] = way[:, level]
    elif kind == "drift":
        direction = random.normal(size=(1, 2)) + 0.1 * random.normal(size=(length, 2))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        way = np.cumsum(direction * random.random((length, 1)) * 0.025 * size / unit, axis=0)
        motion.places[first:first + length, carrier, level[0]] += way[:, 0]
        motion.places[first:first + length, carrier, level[1]] += way[:, 1]
        motion.places[first + length:, carrier, level[0]] += way[-1, 0]
        motion.places[first + length:, carrier, level[1]] += way[-1, 1]
    elif kind in ("spike", "step", "flip"):
        axis = random.normal(size=3)
        turn = exp_so3(axis / np.linalg.norm(axis) * np.radians(size))
        end = first + 1 if kind == "spike" else frames
        motion.rotations[first:end, joint] = motion.rotations[first:end, joint] @ turn
        window = slice(first - 1, first + 1)
    elif kind == "frozen":
        length = round(size * 20)
        window = slice(first, min(frames, first + length))
        for values in (motion.rotations, motion.places):
            values[window] = values[first]
    elif kind == "bone":
        joint = next((j for j in random.permutation(motion.moving)
                      if j > carrier + 1 and np.linalg.norm(motion.joints[j][2]) * unit > 0.1), None)
        if joint is None:
            return None
        motion.places[window, joint] *= 1 + size / 100
    elif kind.endswith("rate"):
        motion.frame_time /= size
        window = slice(0, frames)
    return window.start, min(frames, window.stop) - 1


def their_slide(motion):
    """Frames in which the recipe's own detector sees a slide."""
    names = [(name or "").lower() for name, *_ in motion.joints]
    world, unit, up = motion.world() * metres_of(motion), metres_of(motion), up_of(motion)
    height = world[..., up] - world[:, 1:, up].min()
    speed = np.linalg.norm(np.delete(np.diff(world, axis=0), up, axis=2), axis=2) * 20
    sliding = np.ones(len(world) - 1, bool)
    for side in ("left", "right"):
        mine = [(j, n) for j, n in enumerate(names) if n.startswith(side[0]) or n.endswith("_" + side[0])]
        foot = next((j for j, n in mine if "foot" in n), None)
        toes = next((j for j, n in mine if "toe" in n), foot)
        if foot is None:
            return np.zeros(len(world), bool)
        sliding &= (speed[:, foot] > 0.1) & (speed[:, toes] > 0.1) & (height[:-1, foot] < 0.15) & (height[:-1, toes] < 0.1)
    return np.append(sliding, sliding[-1])


def lint(program, folder):
    run = subprocess.run([program, str(folder), "--json", "-q"], capture_output=True, text=True, check=False)
    files = json.loads(run.stdout)["result"]["files"]
    return {pathlib.Path(f["path"]).stem: f.get("faults", []) for f in files}


def frames_of(fault, rate):
    return fault["from"] * rate, fault["to"] * rate


def measure(program, sources, kind, size, work, clean):
    folder = work / f"{kind}_{size}".replace(" ", "_")
    folder.mkdir(parents=True, exist_ok=True)
    where, theirs = {}, [0, 0]
    for i, path in enumerate(sources):
        motion = Bvh(path)
        random = np.random.default_rng(zlib.crc32(f"{path.name} {kind}".encode()))
        place = seed(motion, kind, size, random)
        if place is None:
            continue
        where[path.stem] = place
        motion.write(folder / path.name)
        if kind in ("slide", "drift"):
            seen, before = their_slide(motion), their_slide(Bvh(path))
            inside = slice(place[0], place[1] + 1)
            theirs[0] += bool((seen & ~before)[inside].any())
            theirs[1] += bool(before.any())
    found = lint(program, folder)
    hits, wrong, missed = 0, 0, []
    for name, (first, last) in where.items():
        mine = [f for f in found.get(name, []) if f["rule"] in RULES[kind]]
        before = [f for f in clean.get(name, []) if f["rule"] in RULES[kind]]
        rate = 20 * (size if kind.endswith("rate") else 1)
        hit, other = False, 0
        for fault in mine:
            a, b = frames_of(fault, rate)
            old = any(min(b, d) - max(a, c) >= 0 and f["value"] > 0.67 * fault["value"]
                      for f in before for c, d in [frames_of(f, 20)])
            inside = a <= last + 12 and b >= first - 12
            hit |= inside and not old
            other += not inside and not old
        hits += hit
        wrong += other
        if not hit:
            missed.append(name)
    clean_wrong = sum(any(f["rule"] in RULES[kind] for f in clean[name]) for name in where)
    line = f"{kind:<10} {size:>6} {len(where):>5} {hits / max(1, len(where)):>7.3f} {hits / max(1, hits + wrong):>10.3f} " \
           f"{hits / max(1, hits + wrong + clean_wrong):>10.3f} {clean_wrong:>6}"
    if kind in ("slide", "drift"):
        line += f"   theirs: recall {theirs[0] / max(1, len(where)):.3f}, clean clips flagged {theirs[1]}"
    print(line, flush=True)
    return missed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("captures", nargs="+", type=pathlib.Path)
    parser.add_argument("--clips", type=int, default=100)
    parser.add_argument("--half", choices=["tune", "report"], default="report")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("/tmp/seeded_faults"))
    parser.add_argument("--kinds", default=",".join(SIZES))
    parser.add_argument("--missed", action="store_true", help="name the clips whose fault was not found")
    arguments = parser.parse_args()
    sources = []
    folder = arguments.work / f"clean_{arguments.half}"
    folder.mkdir(parents=True, exist_ok=True)
    for i, path in enumerate(sorted(arguments.captures)):
        if i % 2 != (arguments.half == "report") or len(sources) >= arguments.clips:
            continue
        place = folder / path.name
        if not place.exists():
            motion = Bvh(path)
            stride = 1 / (20 * motion.frame_time)
            motion.resample(np.arange(1, min(len(motion.places) - 1, 400 * stride), stride))  # no rest pose; 20 s at most
            motion.frame_time = 1 / 20
            if len(motion.places) < 60:
                continue
            motion.write(place)
        sources.append(place)
    clean = lint(arguments.program, folder)
    flagged = {}
    for faults in clean.values():
        for rule in {f["rule"] for f in faults}:
            flagged[rule] = flagged.get(rule, 0) + 1
    print(f"{len(sources)} clean clips; with findings: {dict(sorted(flagged.items()))}")
    print(f"{'kind':<10} {'size':>6} {'clips':>5} {'recall':>7} {'precision':>10} {'with clean':>10} {'clean':>6}")
    for kind in arguments.kinds.split(","):
        for size in SIZES[kind]:
            missed = measure(arguments.program, sources, kind, size, arguments.work, clean)
            if arguments.missed:
                print("  missed:", *missed[:8])


if __name__ == "__main__":
    main()
