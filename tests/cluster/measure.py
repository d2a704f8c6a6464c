#!/usr/bin/env python3
"""Times samples/cluster on a collection like the large public ones: captures of 875 frames and 77 joints.

  measure.py TOOLS MAKE_WALK SOURCE FOLDER [--captures N] [--cores N]

Writes the captures and the results below FOLDER (1.6 MB and 2.8 MB a capture; captures that are there
are used again) and prints seconds, CPU seconds and the largest process of a first run, of one after
that, and of one with a changed capture. 10,000 captures take 44 GB; fewer can be scaled.
"""

import argparse
import math
import os
import random
import resource
import subprocess
import sys
import time

JOINTS, FRAMES, RATE = 77, 875, 120
BASES = 24
HEADER = "\tCHANNELS 3 Zrotation Xrotation Yrotation\n"


def with_fingers(text, counts):
    """The capture with chains of joints for its hands' ends: as many joints, and small turns for them."""
    head, motion = text.split("MOTION\n")
    for side, count in counts.items():
        at = head.index(f"{side}HandMiddle1")
        end = head.index("End Site", at)
        fingers = ""
        for finger in range(count):
            fingers += (f"JOINT {side}Finger{finger}\n{{\n\tOFFSET {'-' if side == 'Right' else ''}2.0 0.0 "
                        f"{finger % 5 - 2}.0\n{HEADER}\tEnd Site\n\t{{\n\t\tOFFSET 1 0 0\n\t}}\n}}\n")
        head = head[:end] + fingers + head[end + head[end:].index("}") + 1:]
    return head, motion


def bases(make_walk, folder):
    """Captures of twice the length, each a head and its lines; the fingers' channels follow their hand's."""
    for number in range(BASES):
        path = f"{folder}/base.bvh"
        subprocess.run([make_walk, "-q", "--steps", "32", "--rate", str(RATE), "--step-length",
                        f"{45 + number * 2}cm", "--noise-angle", "0.2deg", "--seed", str(number), "--contacts",
                        "/dev/null", "-o", path], check=True)
        with open(path) as file:
            text = file.read()
        own = text.count("JOINT") + 1
        left = (JOINTS - own) // 2
        head, motion = with_fingers(text, {"Left": left, "Right": JOINTS - own - left})
        order = [line.split()[1] for line in head.splitlines() if line.split()[:1] in (["ROOT"], ["JOINT"])]
        after = {side: 3 + 3 * (order.index(f"{side}HandMiddle1") + 1) for side in ("Left", "Right")}
        lines = []
        for frame, line in enumerate(motion.splitlines()[2:2 + 2 * FRAMES]):
            values = line.split()
            for side, count in (("Right", JOINTS - own - left), ("Left", left)):  # from the end
                place = after[side] - (3 * left if side == "Right" else 0)
                turns = [f"{8 * math.sin(frame / 40 + channel):.4f}" for channel in range(3 * count)]
                values[place:place] = turns
            lines.append(" ".join(values) + "\n")
        os.remove(path)
        yield head, lines


def make_collection(make_walk, folder, count):
    os.makedirs(folder, exist_ok=True)
    wanted = [f"{folder}/{number % 100:02d}/take_{number}.bvh" for number in range(count)]
    if all(map(os.path.exists, wanted)):
        return
    made = list(bases(make_walk, folder))
    for number, path in enumerate(wanted):
        head, lines = made[number % BASES]
        first = number // BASES % (len(lines) - FRAMES)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w") as file:
            file.write(f"{head}MOTION\nFrames: {FRAMES}\nFrame Time: {1 / RATE:.8f}\n")
            file.writelines(lines[first:first + FRAMES])


def timed(what, command):
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    wall, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(done.stdout[-3000:])
    jobs = sum(line.startswith(("rule ", "localrule ")) for line in done.stdout.splitlines())
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"{what}: {wall:.1f} s, {cpu:.1f} s of CPU, {jobs} jobs, largest process "
          f"{after.ru_maxrss / 1024:.0f} MiB", flush=True)


def size_of(folder):
    return sum(os.path.getsize(os.path.join(path, name)) for path, _, names in os.walk(folder) for name in names)


def main():
    options = argparse.ArgumentParser()
    for name in ("tools", "make_walk", "source", "folder"):
        options.add_argument(name, type=os.path.abspath)
    options.add_argument("--captures", type=int, default=1000)
    options.add_argument("--cores", type=int, default=os.cpu_count())
    given = options.parse_args()
    captures = f"{given.folder}/captures_{given.captures}"
    out = f"{given.folder}/out_{time.time_ns()}"
    make_collection(given.make_walk, captures, given.captures)
    print(f"{given.captures} captures, {size_of(captures) / 1e6:.0f} MB", flush=True)
    workflow = ["snakemake", "-s", f"{given.source}/samples/cluster/Snakefile", "--cores", str(given.cores),
                "--config", f"collection={captures}", f"out={out}", f"bin={given.tools}"]
    os.chdir(given.folder)
    timed("plan alone", workflow + ["--dry-run", "--quiet"])
    timed("import, keys, sheets, index", workflow + ["library=no"])
    timed("step library", workflow)
    print(f"results: {size_of(out) / 1e6:.0f} MB", flush=True)
    timed("nothing to do", workflow)
    changed = f"{captures}/{random.randrange(min(100, given.captures)):02d}"
    changed = os.path.join(changed, sorted(os.listdir(changed))[0])
    os.utime(changed)
    timed("one capture changed", workflow)


if __name__ == "__main__":
    main()
