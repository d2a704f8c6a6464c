"""Arrays in and out, by numpy alone: python3 arrays_test.py BIN_FOLDER SOURCE_FOLDER

Would fail if numpy.load could not read what krok-export writes, joints or rotations came back elsewhere, poses of
SMPL were put together in another way than by rotation vectors down the tree, noise were kept or bones stretched,
or a hostile file did anything but end with exit code 2 and the reason.
"""

import os
import pathlib
import pickle
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

BIN, SOURCE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
os.environ["PATH"] = f"{BIN}{os.pathsep}{os.environ['PATH']}"
sys.path[:0] = [str(SOURCE / "python"), str(SOURCE / "tests" / "lint")]
import krok  # noqa: E402
from bvh import Bvh  # noqa: E402

CAPTURE = SOURCE / "samples" / "captures" / "walk.bvh"
SMPL = [-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19]


def matrices(quaternions):
    x, y, z, w = np.moveaxis(np.asarray(quaternions, float), -1, 0)
    rows = [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
            2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
            2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]
    return np.stack(rows, -1).reshape(x.shape + (3, 3))


def degrees(a, b):
    return np.degrees(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=(-1, -2)) / np.sqrt(8), 0, 1)))


def without_offset(found, truth):
    """`found` times the constant rotation that brings it nearest to `truth`: which way a rig's rest pose twists a bone
    does not show in positions."""
    u, _, v = np.linalg.svd(np.einsum("tji,tjk->ik", found, truth))
    return found @ (u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v)


def rodrigues(vectors):
    angle = np.linalg.norm(vectors, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(vectors / np.maximum(angle[..., 0], 1e-12), -1, 0)
    zero = np.zeros_like(x)
    k = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], -1).reshape(x.shape + (3, 3))
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


class Arrays(unittest.TestCase):
    def setUp(self):
        kept = tempfile.TemporaryDirectory()
        self.addCleanup(kept.cleanup)
        self.folder = pathlib.Path(kept.name)

    def walk(self):
        krok.run("export", CAPTURE, output=self.folder / "walk.npz")
        return dict(np.load(self.folder / "walk.npz"))

    def imported(self, name, array, **options):
        path = self.folder / name
        np.savez(path, **array) if isinstance(array, dict) else np.save(path, array)
        krok.run("import", path, output=self.folder / "in.anim", **options)
        krok.run("export", self.folder / "in.anim", output=self.folder / "in.npz")
        return np.load(self.folder / "in.npz")

    def test_what_is_exported_comes_back(self):
        walk = self.walk()
        again = self.imported("again.npz", walk)
        self.assertLess(np.abs(again["positions"] - walk["positions"]).max(), 1e-6)
        self.assertLess(degrees(matrices(again["quaternions"]), matrices(walk["quaternions"])).max(), 0.2)
        for name in ("names", "parents", "rate", "end_sites", "contacts", "contact_joints"):
            np.testing.assert_array_equal(again[name], walk[name])

    def test_rotations_come_back_from_positions(self):
        walk = self.walk()
        found = self.imported("p.npy", walk["positions"], skeleton=CAPTURE, fps=walk["rate"])
        self.assertLess(np.linalg.norm(found["positions"] - walk["positions"], axis=-1).max(), 1e-4)
        off = degrees(matrices(found["quaternions"]), matrices(walk["quaternions"]))
        self.assertLess(np.median(off[:, walk["end_sites"] == 0]), 1)

    def test_noise_is_smoothed_and_bones_are_rigid(self):
        walk = self.walk()
        place = walk["positions"].astype(float)
        noisy = place + np.random.default_rng(1).normal(0, 0.005, place.shape)
        found = self.imported("n.npy", noisy, skeleton=CAPTURE, fps=walk["rate"])["positions"].astype(float)
        bones = np.linalg.norm(found[:, 1:] - found[:, walk["parents"][1:]], axis=-1)
        self.assertLess(np.abs(bones - bones.mean(0)).max(), 1e-6)
        self.assertLess(np.sqrt(((found - place) ** 2).sum(-1).mean()), 0.005)
        jitter = [np.square(np.diff(x, 3, axis=0)).mean() for x in (found, noisy)]
        self.assertLess(jitter[0], 0.2 * jitter[1])

    def test_poses_of_smpl(self):
        random = np.random.default_rng(2)
        body = random.normal(0, 0.2, (22, 3))
        poses, trans = random.normal(0, 0.6, (30, 22, 3)), random.normal(0, 1, (30, 3))
        turns, places = rodrigues(poses), np.zeros((30, 22, 3))
        places[:, 0] = trans + body[0]
        for joint, parent in enumerate(SMPL[1:], 1):
            places[:, joint] = places[:, parent] + turns[:, parent] @ (body[joint] - body[parent])
            turns[:, joint] = turns[:, parent] @ turns[:, joint]
        np.savez(self.folder / "body.npz", v_template=body, J_regressor=np.eye(22))
        for layout in ({"poses": poses.reshape(30, 66)},
                       {"root_orient": poses[:, 0], "pose_body": poses[:, 1:].reshape(30, 63)}):
            found = self.imported("smpl.npz", {**layout, "trans": trans, "mocap_framerate": 60.0},
                                  skeleton=self.folder / "body.npz", up="y", forward="z", unit="m")
            self.assertLess(np.abs(found["positions"] - places).max(), 1e-6)
            self.assertLess(degrees(matrices(found["quaternions"]), turns).max(), 0.1)
            self.assertEqual(found["rate"], 60)

    def test_a_body_in_a_world_with_z_up(self):
        walk = self.walk()
        order = ["Hips", "LeftUpLeg", "RightUpLeg", "Spine", "LeftLeg", "RightLeg", "Spine1", "LeftFoot", "RightFoot",
                 "Spine2", "LeftToeBase", "RightToeBase", "Neck", "LeftShoulder", "RightShoulder", "Head", "LeftArm",
                 "RightArm", "LeftForeArm", "RightForeArm", "LeftHand", "RightHand"]
        places = walk["positions"][:, [list(walk["names"]).index(name) for name in order]]
        upright = self.imported("y.npy", places, skeleton="humanml22", fps=60)
        self.assertLess(np.abs(upright["positions"] - places).max(), 1e-4)
        krok.run("export", self.folder / "in.anim", output=self.folder / "in.bvh", unit="m")
        bvh = Bvh(self.folder / "in.bvh")  # kinematics that share no code with Krok
        joints = [list(upright["names"]).index(joint[0]) if joint[0] else -1 for joint in bvh.joints]
        self.assertEqual(sorted(joints)[-22:], list(range(22)))
        self.assertLess(np.abs(bvh.world() - places[:, joints])[:, np.array(joints) >= 0].max(), 1e-4)
        lying = self.imported("z.npy", 1000 * places @ [[1, 0, 0], [0, 0, 1], [0, -1, 0]], skeleton="humanml22",
                              fps=60)
        self.assertLess(np.abs(lying["positions"] - places).max(), 1e-4)
        self.assertLess(degrees(matrices(lying["quaternions"]), matrices(upright["quaternions"])).max(), 0.1)
        feet = [lying["names"].tolist().index(name) for name in ("left_foot", "left_ankle")]
        toes, ankle = lying["reference_positions"][feet]
        self.assertGreater((toes - ankle)[2], 0.05)  # the reference pose faces +Z

    def test_captures_come_back_from_their_positions(self):
        corpus = SOURCE.parent / "shared" / "corpus" / "bvh"
        off = {"arm": [], "leg": [], "hand": []}
        for folder in sorted(corpus.glob("*"))[::3]:
            for capture in [path for path in sorted(folder.glob("*.bvh")) if path.stat().st_size < 400_000][:1]:
                try:
                    krok.run("import", capture, output=self.folder / "c.anim")
                    krok.run("export", self.folder / "c.anim", output=self.folder / "c.npz")
                    roles = krok.read(self.folder / "c.anim").roles
                except krok.Error:
                    continue  # not a person, or damaged
                truth = np.load(self.folder / "c.npz")
                if len(truth["positions"]) < 20:
                    continue
                found = self.imported("p.npy", truth["positions"], skeleton=self.folder / "c.npz", fps=truth["rate"],
                                      up="y", forward="z", unit="m")
                bones = np.linalg.norm(np.diff(found["positions"][:, [0, 1]], axis=1), axis=-1)
                self.assertLess(np.ptp(bones), 1e-5, capture)
                turns = [matrices(motion["quaternions"]) for motion in (found, truth)]
                for role, kind in (("left_lower_arm", "arm"), ("right_lower_arm", "arm"), ("left_lower_leg", "leg"),
                                   ("right_lower_leg", "leg"), ("left_hand", "hand"), ("right_hand", "hand")):
                    joint = list(truth["names"]).index(roles[role]) if role in roles else -1
                    if joint >= 0 and (kind != "hand" or (truth["parents"] == joint).sum() > 2):
                        own = without_offset(turns[0][:, joint], turns[1][:, joint])
                        off[kind].append(np.median(degrees(own, turns[1][:, joint])))
        for kind, angles in off.items():
            if len(angles) > 3:
                self.assertLess(np.median(angles), 3, kind)

    def test_rotations_with_positions(self):
        walk = self.walk()
        turns = matrices(walk["quaternions"])
        turns = turns @ np.swapaxes(matrices(walk["reference_quaternions"]), -1, -2)
        found = self.imported("k.npz", {"posed_joints": walk["positions"], "global_rot_mats": turns}, skeleton=CAPTURE,
                              fps=walk["rate"], up="y", forward="z", unit="m")
        self.assertLess(np.abs(found["positions"] - walk["positions"]).max(), 1e-6)
        self.assertLess(degrees(matrices(found["quaternions"]), turns).max(), 0.1)

    def test_several_motions_and_a_gap(self):
        place = self.walk()["positions"][:40]
        several = np.stack([place, place + [1, 0, 0]])
        np.save(self.folder / "two.npy", several)
        krok.run("import", self.folder / "two.npy", skeleton=CAPTURE, fps=30, clip="all",
                 output=self.folder / "two_{clip}.anim")
        apart = [krok.read(self.folder / f"two_{i}.anim").positions for i in (0, 1)]
        self.assertLess(np.abs(apart[1] - apart[0] - [1, 0, 0]).max(), 1e-5)
        place[7, 3] = np.nan
        np.save(self.folder / "gap.npy", place)
        with self.assertRaisesRegex(krok.Error, "npy-value"):
            krok.run("import", self.folder / "gap.npy", skeleton=CAPTURE, output=self.folder / "gap.anim")
        krok.run("import", self.folder / "gap.npy", skeleton=CAPTURE, repair=True, output=self.folder / "gap.anim")

    def test_from_positions(self):
        random = np.random.default_rng(3)
        tree = krok.from_positions(np.cumsum(random.normal(0, 0.01, (20, 22, 3)), 0) + random.normal(0, 1, (22, 3)),
                                   "humanml22", 20, up="y", forward="z", unit="m")
        self.assertEqual((tree.positions.shape, tree.rate, tree.names[0]), ((20, 22, 3), 20, "pelvis"))

    def test_hostile_files(self):
        class Run:
            def __reduce__(self):
                return os.system, (f"touch {self_folder}/ran",)
        self_folder, good = self.folder, np.ones((4, 22, 3), np.float32)
        np.save(self.folder / "object.npy", np.array([Run()], dtype=object), allow_pickle=True)
        np.savez(self.folder / "object.npz", positions=np.array([Run()], dtype=object))
        (self.folder / "pickle.npy").write_bytes(pickle.dumps(good))
        np.savez_compressed(self.folder / "bomb.npz", positions=np.zeros((100_000, 22, 3)))
        np.save(self.folder / "nan.npy", np.where(np.arange(3) == 1, np.nan, good))
        np.save(self.folder / "axes.npy", np.ones((3, 22, 40)))
        np.save(self.folder / "complex.npy", good.astype(complex))
        np.save(self.folder / "fields.npy", np.ones(4, [("x", "f4")]))
        np.save(self.folder / "cut.npy", good)
        (self.folder / "cut.npy").write_bytes((self.folder / "cut.npy").read_bytes()[:-1])
        huge = (self.folder / "axes.npy").read_bytes().replace(b"(3, 22, 40)", b"(9999999999999, 22, 3)")
        (self.folder / "huge.npy").write_bytes(huge)
        for path, code in (("object.npy", "npy-objects"), ("object.npz", "npy-objects"), ("pickle.npy", ""),
                           ("bomb.npz", "file-too-large"), ("nan.npy", "npy-value"), ("axes.npy", "npy-shape"),
                           ("complex.npy", "npy-type"), ("fields.npy", "npy-type"), ("cut.npy", "npy-damaged"),
                           ("huge.npy", "npy-damaged")):
            done = subprocess.run(["krok-import", self.folder / path, "-o", self.folder / "x.anim"],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, path)
            self.assertIn(f"[{code}" if code else "error", done.stderr, path)
            self.assertFalse((self.folder / "x.anim").exists())
        self.assertFalse((self.folder / "ran").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
