"""How a walk moves on grounds that are not level: knees, pelvis, feet, trunk and cadence.

    measure_gait.py BIN_FOLDER LIBRARY.steps [--check] [GROUND ...]

Walks 6 m over each ground (default: level, slopes, stairs) and prints a row for each, means over the
steps whose prints all lie on it. --check, for a library of level steps: exit code 1 if knees are
farther than 8 degrees from published changes (Reznick and others, Scientific Data 8, 2021), feet do
not strike with the forefoot on stairs (Riener and others, Gait & Posture 15, 2002), or the trunk
does not lean uphill. Angles are degrees. For each step, from the strike of the stance
foot to that of the swing foot:

    knee.mid   of the stance leg, in the middle of single support
    knee.hit   of the leading leg at the strike, and knee.last of the trailing one
    range_mm   vertical range of the pelvis less the climb from strike to strike; low.at is when it
               is lowest in the step, as a share
    trail      pitch of the trailing foot against its print at the other's strike, toes down
    contact    pitch of the leading foot against its print at the strike, toes up
    lean       of the trunk, forward;  arms_cm: range of the hands along the way, from the hips
    steps/min, step_cm; print_mm, drift_mm, clear_mm: see measure_walk.py

Shares no code with Krok.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from grounds import ground_of
from measure_style import hands_of, hips_of
from measure_walk import Foot, Library, Motion, knee_angles, measure_files, normal_at, read_prints

GROUNDS = ["level"] + [f"slope:{a}deg" for a in (5, 8, 10, 15, -5, -8, -10, -15)] + [
    "stairs:rise=17cm,run=29cm,count=14", "stairs:rise=-17cm,run=29cm,count=14"]
COLUMNS = ("knee.mid", "knee.hit", "knee.last", "range_mm", "low.at", "trail", "contact", "lean",
           "arms_cm", "steps/min", "step_cm")


def pitch(foot, frame, ground, place):
    """Degrees by which the sole is turned toes up against the print at `place`, its heel."""
    way = foot.ball[frame] - foot.heel[frame]
    ahead = np.array([way[0], 0, way[2]]) / np.hypot(way[0], way[2])
    # The print's slope along the foot: over a tread's edge the sole lies on the heel's tread.
    normal = normal_at(ground, place)
    flat = ahead - normal * (normal @ ahead)
    return np.degrees(np.arcsin(way[1] / np.linalg.norm(way)) -
                      np.arcsin(flat[1] / np.linalg.norm(flat)))


def steps_of(motion, keys, prints, ground, library):
    first = getattr(ground, "begin", -np.inf)
    last = first + ground.run * ground.count if hasattr(ground, "run") else np.inf
    feet = [Foot(motion, sole, ground) for sole in library.feet]
    knees = [np.degrees(knee_angles(motion, side)) for side in ("left", "right")]
    hips = motion.positions[:, hips_of(motion)]
    trunk = motion.positions[:, motion.find("neck", "neck1", "cc_base_necktwist01")] - hips
    hands = [motion.positions[:, hand] for hand in hands_of(motion)]
    times = {(k["name"].split("_")[0], k["name"].split("_")[1], i): k["time"]
             for i, k in enumerate(keys["keytimes"])}
    strikes = {side: sorted(t for (s, what, _), t in times.items() if s == side and what == "strike")
               for side in ("left", "right")}
    offs = sorted(t for (_, what, _), t in times.items() if what == "off")
    struck = []  # (time, side, print)
    for side in strikes:
        own = [p for p in prints if p["side"] == side][1:]
        struck += [(t, side, p) for t, p in zip(strikes[side], own)]
    struck.sort(key=lambda s: s[0])
    at = lambda time: min(int(round(time * motion.rate)), len(motion.positions) - 1)
    rows = []
    for (t0, side0, p0), (t1, side1, p1) in zip(struck[1:-2], struck[2:-1]):
        if not all(first <= float(p["z"]) <= last for p in (p0, p1)):
            continue
        stance, swing = (0, 1) if side0 == "left" else (1, 0)
        off = next(t for t in offs if t > t0)
        a, b, middle = at(t0), at(t1), at(0.5 * (off + t1))
        # The last frame before the strike, when the foot is not on its print yet.
        hit = int(np.floor(t1 * motion.rate))
        forward = hips[b] - hips[a]
        forward[1] = 0
        forward /= np.linalg.norm(forward)
        share = np.linspace(0, 1, b - a + 1)
        climb = hips[a:b + 1, 1] - (hips[a, 1] + share * (hips[b, 1] - hips[a, 1]))
        swings = [np.ptp(((hand - hips) @ forward)[a:b + 1]) for hand in hands]
        lean = np.degrees(np.arctan2(trunk[a:b] @ forward, trunk[a:b, 1])).mean()
        place = lambda p: np.array([float(p["x"]), 0, float(p["z"])])
        rows.append([knees[stance][middle], knees[swing][b], knees[stance][b],
                     1000 * np.ptp(climb), share[climb.argmin()],
                     -pitch(feet[stance], b, ground, place(p0)), pitch(feet[swing], hit, ground, place(p1)),
                     lean, 100 * np.mean(swings), 60 / (t1 - t0),
                     100 * np.hypot(float(p1["z"]) - float(p0["z"]), 0)])
    return np.array(rows)


def faults(table):
    """What --check finds wrong."""
    level, found = table["level"], []
    for spec, row in table.items():
        if spec.startswith("slope"):
            grade = float(spec.removeprefix("slope:").removesuffix("deg"))
            # Degrees of the knee in mid-stance per degree of the slope: 18 and 20 at 7.5, level 11.
            published = level["knee.mid"] + (0.95 * grade if grade > 0 else -1.2 * grade)
            if abs(row["knee.mid"] - published) > 8:
                found.append(f"{spec}: knee {row['knee.mid']:.1f} in mid-stance, published {published:.1f}")
            if (row["lean"] - level["lean"]) * grade < 0:
                found.append(f"{spec}: the trunk leans downhill")
        if spec.startswith("stairs") and row["contact"] > 0:
            found.append(f"{spec}: the heel strikes first")
        if row["print_mm"] > 0.1 or row["drift_mm"] > 0.2:
            found.append(f"{spec}: feet are off by {row['print_mm']:.3f} and {row['drift_mm']:.3f} mm")
    return found


def main():
    arguments = [a for a in sys.argv[1:] if a != "--check"]
    if len(arguments) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    walk, path = pathlib.Path(arguments[0]) / "krok-walk", arguments[1]
    library, table = Library(path), {}
    columns = COLUMNS + ("print_mm", "drift_mm", "clear_mm")
    print(f"{'ground':24}", *(f"{c:>9}" for c in columns))
    for spec in arguments[2:] or GROUNDS:
        ground = ground_of(spec)
        with tempfile.TemporaryDirectory() as folder:
            out, prints = f"{folder}/walk.anim", f"{folder}/prints.csv"
            run = subprocess.run([walk, "-q", path, "--goal", "0,6m", "--ground", spec, "-o", out,
                                  "--save-prints", prints], capture_output=True, text=True)
            if run.returncode != 0:
                print(f"{spec[:24]:24} {run.stderr.strip().splitlines()[0]}")
                return 1
            keys = json.loads(pathlib.Path(f"{folder}/walk.keys.json").read_text())
            rows = steps_of(Motion.read(out), keys, read_prints(prints), ground, library)
            m = measure_files(out, prints, ground, library)
        drift = max(m["heel_drift_mm"], m["ball_drift_mm"])
        values = list(rows.mean(axis=0)) + [m["print_mm"], drift, m["clearance_mm"]]
        print(f"{spec[:24]:24}", *(f"{v:9.2f}" for v in values))
        table[spec] = dict(zip(columns, values))
    wrong = faults(table) if "--check" in sys.argv else []
    print(*wrong, sep="\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
