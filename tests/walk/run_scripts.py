"""Walks random scripts on every kind of ground and measures the results, see measure_walk.py.

    run_scripts.py BIN_FOLDER LIBRARY.steps [--count N] [--kinds level,slope,...] [--check]

Prints a table: for each measure the largest value and the 99th percentile over N scripts a kind, and
how many were refused, with why. --check: exit code 1 if feet miss their prints, slide, sink or change
length beyond the targets, or more than 2 % of a kind are refused.
"""

import argparse
import collections
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from grounds import Stones, ground_of
from measure_walk import Library, measure_files
from random_scripts import KINDS, csv_of, script

# What --check holds every walk to; corners beyond what the ground's warp leaves to any plane.
TARGETS = {"print_mm": 0.1, "print_deg": 0.05, "heel_drift_mm": 0.2, "ball_drift_mm": 0.2,
           "bones": 1e-6, "corner_mm": 1.0}


def walk(tool, library, prints, ground, folder):
    """The refusal's code and message, or None."""
    (folder / "prints.csv").write_text(csv_of(prints))
    spec = ground
    if isinstance(ground, Stones):
        (folder / "stones.obj").write_text(ground.obj())
        spec = str(folder / "stones.obj")
    run = subprocess.run([tool, library, "--prints", folder / "prints.csv", "--ground", spec, "-q",
                          "--orientation", "xyzw", "-o", folder / "walk.anim"],
                         capture_output=True, text=True)
    if run.returncode == 0:
        return None
    return run.stderr.strip().splitlines()[0] if run.stderr else f"exit code {run.returncode}"


def run_kind(kind, count, tool, library_path, library):
    rows, refused = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for number in range(count):
            prints, ground = script(kind, number)
            refusal = walk(tool, library_path, prints, ground, folder)
            if refusal:
                refused.append((number, refusal))
                continue
            measured_ground = ground if isinstance(ground, Stones) else ground_of(ground)
            row = measure_files(folder / "walk.anim", folder / "prints.csv", measured_ground,
                                library)
            row["script"] = number
            rows.append(row)
    print(f"\n{kind}: {len(rows)} walks, {len(refused)} refused")
    reasons = collections.Counter(text.rsplit("[", 1)[-1].rstrip("]") for _, text in refused)
    for reason, times in reasons.most_common():
        number, text = next(r for r in refused if r[1].rstrip("]").endswith(reason))
        print(f"  {reason}: {times}, such as script {number}: {text}")
    names = [name for name in (rows[0] if rows else {}) if name != "script"]
    for name in names:
        values = np.array([row.get(name, 0.0) for row in rows])
        if name == "clearance_mm":
            values = values[np.isfinite(values)]
            if len(values):
                print(f"  {name:18} least {values.min():11.4g}   1st percentile "
                      f"{np.percentile(values, 1):11.4g}")
            continue
        worst = rows[int(np.argmax(values))]["script"]
        print(f"  {name:18} most  {values.max():11.4g}  99th percentile "
              f"{np.percentile(values, 99):11.4g}  (script {worst})")
    return rows, refused


def faults_of(kind, rows, refused, count):
    for row in rows:
        for name, most in TARGETS.items():
            if row[name] > most:
                yield f"{kind} {row['script']}: {name} is {row[name]:.4g}, at most {most} is allowed"
        for name in ("stances_missing", "never_flat"):
            if row[name]:
                yield f"{kind} {row['script']}: {name} is {row[name]}"
    if len(refused) > 0.02 * count:
        yield f"{kind}: {len(refused)} of {count} scripts were refused"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("bin_folder", type=pathlib.Path)
    parser.add_argument("library")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    library = Library(options.library)
    faults = []
    for kind in options.kinds.split(","):
        rows, refused = run_kind(kind, options.count, options.bin_folder / "krok-walk",
                                 options.library, library)
        faults += faults_of(kind, rows, refused, options.count)
    if options.check:
        for fault in faults:
            print(fault)
    return 1 if options.check and faults else 0


if __name__ == "__main__":
    sys.exit(main())
