"""Predicts the steps of captures that a library was not fitted to, and measures how far off it is.

    held_out.py BIN_FOLDER CAPTURE... [--parameters step.length,duration] [--steps auto|runs]
                [--mirror] [--folds 5] [--only NAME,...] [--json FILE] [--check]

Every fifth capture is held out (five times, each fold in turn); krok-fit fits the others, krok-synth
makes steps with the parameters of those held out, and the steps are compared. Shares no code with
Krok: reads its files by their specifications and compares joint positions at equal fractions
between keytimes, in the ground frame of the hips (below the hips, facing across the thighs), and in
that of the stance foot. Steps outside the bounds of the fitted captures are not counted.

Prints a row for each way to make weights: planes (an affine fit to all examples), the nearest
example, each kernel that reproduces examples, smoothed ones, the default without refinement and the
default. RMS errors in millimetres over all joints, moments and steps. --check: exit code 1 if the
default is more than 5 % worse than the best of planes, nearest and cubic.
"""

import argparse
import json
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "walk"))
from measure_walk import Motion, read_krok_files, records  # noqa: E402

PARTS = 16         # moments compared between two keytimes
TINY = 1e-5        # spacing that keeps all examples but exact duplicates
SIMPLE = ("planes", "nearest", "cubic")
ALLOWED = 1.05
WAYS = {  # options of krok-fit, and the spacing of the description (None: the default)
    "planes": (("--kernel", "cubic", "--smoothing", "1000000", "--refine", "0"), TINY),
    **{kernel: (("--kernel", kernel, "--smoothing", "0", "--refine", "0"), None)
       for kernel in ("cubic", "linear", "gaussian", "bspline", "wendland")},
    **{f"{kernel} {smoothing}": (("--kernel", kernel, "--smoothing", smoothing, "--refine", "0"), None)
       for kernel in ("cubic", "linear") for smoothing in ("0.01", "0.1", "1", "10")},
    "unrefined": (("--refine", "0"), None),
    "default": ((), None),
}


class Examples:
    """The examples of a .steps file."""

    def __init__(self, path):
        container = read_krok_files.Container(pathlib.Path(path).read_bytes())
        _, joints, keytimes, parameters, examples, _, ground = struct.unpack(
            "<dIIIIIf", container.section("INFO", 32))
        self.ground = ground  # made motions lie this much above those of the file
        self.names = container.texts("EXNAMES", examples)
        self.keytimes = np.array(container.numbers("KEYTIMES", "d", keytimes, examples))
        self.points = np.array(container.numbers("MEASURED", "d", parameters, examples))
        self.feet = [foot[0] for foot in
                     struct.iter_unpack("<iI7d", container.section("FEET", 128))]
        self.skeleton = container.skeleton(joints)
        heads = list(struct.iter_unpack("<dIIII", container.section("EXAMPLES", 24 * examples)))
        ends = np.cumsum([head[1] for head in heads])
        positions, turns = records(container, "FRAMES", joints * int(ends[-1]))
        self.motions = [
            Motion(self.skeleton, head[0],
                   positions[(end - head[1]) * joints:end * joints].reshape(-1, joints, 3),
                   turns[(end - head[1]) * joints:end * joints].reshape(-1, joints, 4))
            for head, end in zip(heads, ends)]


class Frames:
    """Which joints are compared, and where the hips face."""

    def __init__(self, skeleton, feet):
        parents = [joint["parent"] for joint in skeleton]

        def chain(joint):
            path = [joint]
            while parents[path[-1]] >= 0:
                path.append(parents[path[-1]])
            return path[::-1]

        left, right = chain(feet[0]), chain(feet[1])
        shared = sum(1 for a, b in zip(left, right) if a == b)
        self.hips, self.thighs = left[shared - 1], (left[shared], right[shared])
        self.below = [j for j in range(len(parents)) if self.hips in chain(j)]

    def in_hips(self, positions):
        across = positions[:, self.thighs[0]] - positions[:, self.thighs[1]]
        angle = np.arctan2(-across[:, 2], across[:, 0])  # turns `across` to +X about +Y
        apart = positions[:, self.below] - positions[:, self.hips:self.hips + 1] * [1, 0, 1]
        cosine, sine = np.cos(-angle)[:, None], np.sin(-angle)[:, None]
        x, z = apart[..., 0], apart[..., 2]
        return np.stack([cosine * x + sine * z, apart[..., 1], cosine * z - sine * x], -1)

    def of(self, motion, keytimes):
        """Positions at fractions between keytimes: [2 frames][moments, joints, 3]."""
        times = np.concatenate([start + (end - start) * (np.arange(PARTS) + 0.5) / PARTS
                                for start, end in zip(keytimes, keytimes[1:])])
        positions = resampled(motion, times)
        return self.in_hips(positions), positions[:, self.below]


def resampled(motion, times):
    """Positions at any times, by cubics through four frames."""
    values, count = motion.positions, len(motion.positions)
    at = np.clip(times * motion.rate, 0, count - 1)
    first = np.minimum(at.astype(int), max(count - 2, 0))
    t = (at - first)[:, None, None]
    before, here, there, after = (values[np.clip(first + k, 0, count - 1)] for k in (-1, 0, 1, 2))
    return here + 0.5 * t * (there - before + t * (2 * before - 5 * here + 4 * there - after
                                                   + t * (3 * (here - there) + after - before)))


def error_of(made, wanted):
    """RMS distances in the hips' frame and in the stance foot's, in millimetres."""
    return [1e3 * float(np.sqrt(((a - b) ** 2).sum(-1).mean())) for a, b in zip(made, wanted)]


class Tools:
    def __init__(self, bin_folder, options, captures):
        self.bin, self.options, self.captures = bin_folder, options, captures

    def fit(self, folder, kept, spacing, arguments):
        """Path of a library fitted to the captures in `kept`, or None with the tool's message."""
        description = {
            "schema": "krok.library/1", "steps": self.options.steps, "mirror": self.options.mirror,
            "parameters": [{"measures": name} for name in self.options.parameters.split(",")],
            "examples": [{"clip": str(self.captures[i])} for i in kept]}
        if spacing is not None:
            description["spacing"] = spacing
        (folder / "library.json").write_text(json.dumps(description))
        run = subprocess.run([self.bin / "krok-fit", folder / "library.json", "-q", "-j", "2", "-o",
                              folder / "out.steps", "--keep-going", f"--json={folder / 'fit.json'}",
                              *arguments], capture_output=True, text=True)
        if run.returncode in (0, 3):
            report = json.loads((folder / "fit.json").read_text())
            return folder / "out.steps", report.get("result", report)
        return None, run.stderr.strip()

    def synthesise(self, folder, library, names, points, extrapolate):
        """Motions with their keytimes by row of `points`; rows that are refused are absent."""
        rows = list(range(len(points)))
        while rows:
            lines = [",".join(names)] + [",".join(map(repr, map(float, points[r]))) for r in rows]
            (folder / "points.csv").write_text("\n".join(lines) + "\n")
            run = subprocess.run(
                [self.bin / "krok-synth", library, "--points", folder / "points.csv", "-q",
                 "--orientation", "xyzw", "-o", folder / "made.anim",
                 *(["--extrapolate"] if extrapolate else [])], capture_output=True, text=True)
            if run.returncode == 0:
                break
            refused = re.search(r"row (\d+):", run.stderr)
            if not refused and len(rows) > 1:
                raise RuntimeError(run.stderr)
            del rows[int(refused.group(1)) - 1 if refused else 0]
        made = {}
        for number, row in enumerate(rows, 1):
            path = folder / (f"made_{number:0{len(str(len(rows)))}d}.anim")
            if not path.exists():
                path = folder / f"made_{number}.anim"
            sidecar = json.loads(next(folder.glob(path.stem + "*.json")).read_text())
            times = [float(key["time"]) for key in sidecar["keytimes"]]
            made[row] = (Motion.read(path), times)
        for path in folder.glob("made*"):
            path.unlink()
        return made


def clip_of(name):
    return re.sub(r" \d+ (left|right).*$", "", name)


def run_fold(tools, folder, truth, held_out, ways):
    """Errors by way: {step: [hips, stance foot]}; and what the fits reported."""
    frames, steps, parameters = truth
    points = steps.points
    captures = tools.captures
    held_names = {captures[i].name for i in held_out}
    kept = [i for i in range(len(captures)) if i not in held_out]
    asked = [i for i, name in enumerate(steps.names) if clip_of(name) in held_names]
    library, report = tools.fit(folder, kept, TINY, WAYS["planes"][0])
    if library is None:
        raise RuntimeError(report)
    inside = tools.synthesise(folder, library, parameters, points[asked], False)
    asked = [asked[row] for row in sorted(inside)]
    wanted = {i: frames.of(steps.motions[i], steps.keytimes[i]) for i in asked}
    own = Examples(library)
    ranges = np.ptp(own.points, axis=0)
    errors, reports = {}, {}
    for way in ways:
        errors[way] = {}
        if way == "nearest":
            for i in asked:
                near = np.argmin((((own.points - points[i]) / ranges) ** 2).sum(1))
                errors[way][i] = error_of(frames.of(own.motions[near], own.keytimes[near]),
                                          wanted[i])
            continue
        arguments, spacing = WAYS[way]
        library, report = tools.fit(folder, kept, spacing, arguments)
        reports[way] = report
        if library is None:
            continue
        made = tools.synthesise(folder, library, parameters, points[asked], True)
        ground = Examples(library).ground
        for row, (motion, times) in made.items():
            motion.positions[..., 1] -= ground
            errors[way][asked[row]] = error_of(frames.of(motion, times), wanted[asked[row]])
    return errors, reports


def rms(values):
    return float(np.sqrt(np.mean(np.square(values), axis=0))) if len(values) else float("nan")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin_folder", type=pathlib.Path)
    parser.add_argument("captures", type=pathlib.Path, nargs="+")
    parser.add_argument("--parameters", default="step.length,duration")
    parser.add_argument("--steps", default="auto")
    parser.add_argument("--mirror", action="store_true")
    parser.add_argument("--folds", type=int, default=5)
    parser.add_argument("--only", help="ways, instead of all")
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    captures = sorted(path.resolve() for path in options.captures)
    ways = options.only.split(",") if options.only else ["nearest", *WAYS]
    tools = Tools(options.bin_folder.resolve(), options, captures)
    folds = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        library, report = tools.fit(folder, range(len(captures)), TINY, WAYS["planes"][0])
        if library is None:
            print(report, file=sys.stderr)
            return 2
        parameters = [f"{entry['name']} [{entry['unit']}]" for entry in report["parameters"]]
        steps = Examples(library)
        truth = (Frames(steps.skeleton, steps.feet), steps, parameters)
        for first in range(options.folds):
            held_out = set(range(first, len(captures), options.folds))
            folds.append(run_fold(tools, folder, truth, held_out, ways))
    return print_results(options, captures, ways, folds)


def print_results(options, captures, ways, folds):
    steps = sum(len(errors[ways[0]]) for errors, _ in folds)
    print(f"{len(captures)} captures, {steps} steps held out, {options.parameters}"
          f"{', mirrored' if options.mirror else ''}; RMS in mm")
    print(f"{'weights':20} {'hips':>7} {'foot':>7} {'mean':>7}   refused   by fold (hips)")
    table = {}
    for way in ways:
        values = np.array([v for errors, _ in folds for v in errors[way].values()])
        values = values.reshape(-1, 2)
        by_fold = [rms([v[0] for v in errors[way].values()]) for errors, _ in folds]
        table[way] = {"hips": rms(values[:, 0]), "foot": rms(values[:, 1]),
                      "mean": float(values[:, 0].mean()) if len(values) else float("nan"),
                      "refused": steps - len(values), "folds": by_fold}
        print(f"{way:20} {table[way]['hips']:7.1f} {table[way]['foot']:7.1f} "
              f"{table[way]['mean']:7.1f} {table[way]['refused']:9d}   "
              + " ".join(f"{value:6.1f}" for value in by_fold))
    for errors, reports in folds:
        report = reports.get("default") or reports.get("unrefined") or {}
        if isinstance(report, dict):
            print(f"  chosen: {report.get('kernel')}, smoothing {report.get('smoothing')}, "
                  f"{len(report.get('examples', []))} examples, {report.get('inserted')} inserted")
        else:
            print("  default failed: " + report)
    if options.json:
        options.json.write_text(json.dumps({"captures": [path.name for path in captures],
                                            "parameters": options.parameters, "steps": steps,
                                            "ways": table}, indent=1))
    simple = [table[way]["hips"] for way in SIMPLE if way in table and not table[way]["refused"]]
    own = table.get("default", table.get("unrefined"))
    if simple and own:
        ratio = own["hips"] / min(simple)
        print(f"default: {ratio:.3f} of the best simple one")
        if options.check and (ratio > ALLOWED or own["refused"]):
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
