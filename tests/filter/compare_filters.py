"""krok-edit --filter auto against the filters of scipy at their best settings.

    compare_filters.py BIN_FOLDER CORPUS_FOLDER [--set report|tuning] [--kinds noise spikes both clean]
                       [--seed N] [--frames N] [--options "..."]

Captures (the first --frames of each but for frame 0, which is a T-pose in some, scaled to a body of 1.7 m) get
    noise    1 degree about each axis of every joint in every frame, 3 mm in each axis of the root
    spikes   1 % of the frames of each joint turned by 10 to 60 degrees, of the root moved by 5 to 30 cm
    both     both
and are filtered. Error: mean distance of all joints (no end sites) from the capture, mm. scipy filters quaternions
(in one hemisphere, normalised after) and the root's position: butterworth (orders 1 to 3, forward
and backward, 17 cutoffs), savgol (15 windows, degrees 1 to 5) and median (8 windows), each at the
setting of least error for this capture, which only who has the clean capture can choose.
`clean` is the capture as it is: the error is what the filter changes.
Exit code 1 if the mean ratio of a kind is over 0.8. Not run by ctest (minutes). Shares no code with Krok.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy import ndimage, signal
from scipy.spatial.transform import Rotation

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "lint"), str(HERE.parent / "walk")]
from bvh import Bvh, exp_so3  # noqa: E402
from measure_walk import Motion  # noqa: E402

SETS = {
    "report": ("20tab_bvh-python/test_mocapbank", "animated_drawings/fair1_dab", "animated_drawings/fair1_zombie",
               "animated_drawings/rokoko_jesse_dance", "assimp_testmodels/01_03",
               "deep-motion-editing/xia_test_old_13_000", "iclone_cmu/005_01", "optitrack_arena_bvh-matlab/louise",
               "pymo/AV_8Walk_Meredith_HVHA_Rep1", "pybvh/cmu_12_01_walk"),
    "tuning": ("animated_drawings/cmu1_jumping_jacks", "assimp_testmodels/01_01",
               "deep-motion-editing/xia_test_neutral_01_000", "iclone_cmu/002_01", "iclone_cmu/006_01",
               "walkset_cmu07/007_04", "makehuman/02_02", "ipi_smartbody/Right", "pybvh/bvh_test3",
               "makehuman/12_03"),
}
KINDS = ("noise", "spikes", "both")
TARGET = 0.8


class Take:
    def __init__(self, path, frames):
        self.bvh = Bvh(path)
        kept = slice(1, frames + 1)
        self.bvh.rotations, self.bvh.places = self.bvh.rotations[kept].copy(), self.bvh.places[kept].copy()
        self.rate = 1 / self.bvh.frame_time
        self.root = self.bvh.carrier()
        scale = 1.7 / np.percentile(np.ptp(self.bvh.world()[..., 1], axis=1), 90)
        self.bvh.places *= scale
        for joint in self.bvh.joints:
            joint[2] = joint[2] * scale
        self.rotations, self.places = self.bvh.rotations, self.bvh.places
        self.truth = self.bvh.world()

    def world(self, rotations, places):
        self.bvh.rotations, self.bvh.places = rotations, places
        return self.bvh.world()

    def error(self, world):
        """Of the joints; end sites are left out."""
        joints = self.bvh.moving
        return 1000 * np.linalg.norm(world[:, joints] - self.truth[:, joints], axis=-1).mean()

    def disturbed(self, kind, seed):
        random = np.random.default_rng(seed)
        rotations, places, frames = self.rotations.copy(), self.places.copy(), len(self.places)
        moving = self.bvh.moving

        def directions(count):
            vectors = random.standard_normal((count, 3))
            return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)

        if kind in ("noise", "both"):
            turns = np.radians(1) * random.standard_normal((frames, len(moving), 3))
            rotations[:, moving] = rotations[:, moving] @ exp_so3(turns)
            places[:, self.root] += 0.003 * random.standard_normal((frames, 3))
        if kind in ("spikes", "both"):
            for j in moving:
                hit = np.flatnonzero(random.random(frames) < 0.01)
                angles = np.radians(random.uniform(10, 60, len(hit)))
                rotations[hit, j] = rotations[hit, j] @ exp_so3(directions(len(hit)) * angles[:, None])
            hit = np.flatnonzero(random.random(frames) < 0.01)
            places[hit, self.root] += directions(len(hit)) * random.uniform(0.05, 0.3, len(hit))[:, None]
        return rotations, places


def best_of_scipy(take, rotations, places):
    frames, joints = rotations.shape[:2]
    quats = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_quat().reshape(frames, joints, 4).copy()
    for f in range(1, frames):
        quats[f] *= np.where((quats[f] * quats[f - 1]).sum(-1, keepdims=True) < 0, -1, 1)

    def error(smooth):
        smoothed = smooth(quats)
        turns = Rotation.from_quat(smoothed.reshape(-1, 4)).as_matrix().reshape(rotations.shape)
        moved = places.copy()
        moved[:, take.root] = smooth(places[:, take.root])
        return take.error(take.world(turns, moved))

    best = {}

    def attempt(name, setting, smooth):
        best[name] = min(best.get(name, (np.inf, None)), (error(smooth), setting))

    for cutoff in (1.5, 2, 2.5, 3, 3.5, 4, 5, 6, 7, 8, 10, 12, 15, 20, 25, 30, 40):
        for order in (1, 2, 3) if cutoff < 0.475 * take.rate else ():
            sections = signal.butter(order, cutoff, fs=take.rate, output="sos")
            attempt("butterworth", (cutoff, order), lambda x: signal.sosfiltfilt(sections, x, axis=0))
    for window in (5, 7, 9, 11, 13, 15, 17, 21, 25, 31, 37, 45, 55, 65, 81):
        for degree in range(1, 6) if window < frames else ():
            if degree < window:
                attempt("savgol", (window, degree), lambda x: signal.savgol_filter(x, window, degree, axis=0))
    for window in (3, 5, 7, 9, 11, 15, 19, 25):
        attempt("median", window,
                lambda x: ndimage.median_filter(x, size=(window,) + (1,) * (x.ndim - 1), mode="nearest"))
    return best


def by_krok(take, rotations, places, bins, options):
    take.bvh.rotations, take.bvh.places = rotations, places
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        take.bvh.write(folder / "in.bvh")
        axes = ["--unit", "m", "--up", "y", "--forward", "z", "--positions", "absolute", "-q"]
        subprocess.run([bins / "krok-import", folder / "in.bvh", *axes, "-o", folder / "in.anim"], check=True)
        subprocess.run([bins / "krok-edit", folder / "in.anim", *options, "-q", "-o", folder / "out.anim"], check=True)
        motion = Motion.read(folder / "out.anim")
    world = np.zeros_like(take.truth)
    for j in take.bvh.moving:
        world[:, j] = motion.positions[:, motion.names.index(take.bvh.joints[j][0])]
    return take.error(world)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bins", type=pathlib.Path)
    parser.add_argument("corpus", type=pathlib.Path)
    parser.add_argument("--set", choices=SETS, default="report")
    parser.add_argument("--kinds", nargs="+", choices=(*KINDS, "clean"), default=KINDS)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--frames", type=int, default=1500)
    parser.add_argument("--options", default="--filter auto")
    parser.add_argument("--without-scipy", action="store_true", help="Krok's errors alone")
    arguments = parser.parse_args()
    ratios = {}
    for name in SETS[arguments.set]:
        take = Take(arguments.corpus / "bvh" / f"{name}.bvh", arguments.frames)
        for kind in arguments.kinds:
            disturbed = take.disturbed(kind, arguments.seed)
            raw = take.error(take.world(*disturbed))
            ours = by_krok(take, *disturbed, arguments.bins, arguments.options.split())
            line = f"{name:45} {take.rate:4.0f} fps {len(take.truth):5} {kind:6} as it is {raw:6.2f}  krok {ours:6.2f}"
            if kind != "clean" and not arguments.without_scipy:
                best = best_of_scipy(take, *disturbed)
                least = min(error for error, _ in best.values())
                ratios.setdefault(kind, []).append(ours / least)
                line += f"  ratio {ours / least:.2f}  " + "  ".join(
                    f"{key} {error:.2f} {setting}" for key, (error, setting) in best.items())
            print(line, flush=True)
    for kind, values in ratios.items():
        print(f"{kind:6} ratio: mean {np.mean(values):.3f}, largest {max(values):.2f}")
    return int(any(np.mean(values) > TARGET for values in ratios.values()))


if __name__ == "__main__":
    sys.exit(main())
