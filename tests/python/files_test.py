"""The Python package against the tools: python3 files_test.py BIN_FOLDER SOURCE_FOLDER

Would fail if the package read other positions than krok-export writes, other weights than the specification
gives, wrote files that the tools refuse or find different, let a damaged file through as anything but a
FormatError, or read a file's content before it is used. Captures of ../shared/corpus where that is at hand.
"""

import csv
import dataclasses
import os
import pathlib
import random
import sys
import tempfile
import unittest

try:
    import numpy as np
    import xxhash  # noqa: F401, which krok.write needs
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

BIN, SOURCE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
os.environ["PATH"] = f"{BIN}{os.pathsep}{os.environ['PATH']}"
sys.path[:0] = [str(SOURCE / "python"), str(SOURCE / "tests" / "golden")]
import krok  # noqa: E402
import read_krok_files  # noqa: E402  (another reader by the same pages, without numpy)

FROZEN = [path for path in sorted((SOURCE / "tests" / "golden" / "v1").glob("*.*"))
          if path.suffix in (".anim", ".model", ".cam", ".steps")]


def captures():
    """Captures of this project, and of the corpus: one of each folder, up to 1.5 MB."""
    yield from sorted((SOURCE / "samples" / "captures").glob("*.bvh"))
    for folder in sorted((SOURCE.parent / "shared" / "corpus" / "bvh").glob("*")):
        yield from [path for path in sorted(folder.glob("*.bvh")) if path.stat().st_size < 1_500_000][:1]


class Files(unittest.TestCase):
    def setUp(self):
        kept = tempfile.TemporaryDirectory()
        self.addCleanup(kept.cleanup)
        self.folder = pathlib.Path(kept.name)

    def walk(self, **options):
        path = self.folder / "walk.anim"
        krok.run("import", SOURCE / "samples" / "captures" / "walk.bvh", output=path, **options)
        return path

    def test_positions_are_those_that_krok_export_writes(self):
        read = 0
        for capture in captures():
            clip, table = self.folder / f"{read}.anim", self.folder / f"{read}.csv"
            try:
                krok.run("import", capture, output=clip)
            except krok.Error:
                continue  # what no one can read is of other tests
            krok.run("export", clip, output=table)
            motion = krok.read(clip)
            with open(table, newline="", encoding="utf-8") as file:
                rows = list(csv.reader(file))[1:]
            written = np.array([row[3:6] for row in rows], float).reshape(motion.positions.shape)
            np.testing.assert_allclose(motion.positions, written, rtol=1e-6, atol=1e-7, err_msg=str(capture))
            if len(written):
                self.assertEqual([row[2] for row in rows[:len(motion.names)]], motion.names)
                self.assertAlmostEqual(float(rows[-1][1]), motion.times[-1], places=5)
            read += 1
        self.assertGreaterEqual(read, 3)  # those of this project; the corpus need not be there

    def test_orientations_are_the_same_in_both_layouts(self):
        three, four = (krok.read(self.walk(orientation=layout)).orientations for layout in ("xyz", "xyzw"))
        dots = np.abs(np.einsum("fji,fji->fj", three, four))
        self.assertLess(2 * np.arccos(np.minimum(dots, 1)).max(), 1e-3)
        self.assertEqual(four.dtype, np.float32)
        self.assertFalse(four.flags.owndata or four.flags.writeable)

    def test_frozen_files_read_as_by_the_pages(self):
        kinds = set()
        for path in FROZEN:
            truth = read_krok_files.read(path)
            mine = krok.read(path)
            kinds.add(truth["kind"])
            self.assertEqual(mine.provenance, truth["provenance"] or {})
            if truth["kind"] != "cam":
                self.assertEqual(mine.skeleton.names, [joint["name"] for joint in truth["skeleton"]])
            if truth["kind"] in ("anim", "cam"):
                places = [[r["position"] for r in (row if isinstance(row, list) else [row])] for row in truth["frames"]]
                np.testing.assert_array_equal(mine.positions.reshape(-1), np.float32(places).reshape(-1))
            elif truth["kind"] == "model":
                for name in ("positions", "normals", "texture_coordinates", "tangents", "joints", "weights"):
                    np.testing.assert_array_equal(getattr(mine, name), truth[name], name)
                self.assertEqual([part._asdict() for part in mine.parts], truth["parts"])
            elif truth["weights"]:
                centres = mine._fit[1]["CENTRES"]
                np.testing.assert_allclose(mine.weights(centres), truth["weights"]["at_centres"], atol=1e-12)
                np.testing.assert_allclose(mine.weights(centres).sum(-1), 1, atol=1e-12)
        self.assertEqual(kinds, {"anim", "model", "cam", "steps"})

    def test_what_is_written_is_the_same_to_krok_diff(self):
        for path in [self.walk(), *FROZEN]:
            data = krok.read(path)
            if isinstance(data, krok.StepLibrary):
                continue
            copy = self.folder / ("copy" + path.suffix)
            krok.write(data, copy)
            report = krok.run("diff", path, copy)
            self.assertEqual(report.exit_code, 0, report.output)
        self.assertEqual([name for name in os.listdir(self.folder) if "tmp" in name], [])

    def test_nothing_half_written_and_nothing_wrong(self):
        motion = krok.read(self.walk())
        broken = krok.Motion(motion.skeleton, 60, np.full((1, len(motion.names), 3), np.nan), motion.orientations[:1])
        target = self.folder / "kept.anim"
        target.write_bytes(b"old")
        with self.assertRaises(ValueError):
            krok.write(broken, target)
        self.assertEqual(target.read_bytes(), b"old")

    def test_damaged_files_are_format_errors(self):
        chance = random.Random(1)
        for path in FROZEN:
            content = path.read_bytes()
            for _ in range(40):
                damaged = bytearray(content[:chance.randrange(len(content))] if chance.random() < 0.5 else content)
                for _ in range(chance.randrange(4)):
                    if damaged:
                        damaged[chance.randrange(min(len(damaged), 600))] = chance.randrange(256)
                target = self.folder / "damaged"
                target.write_bytes(damaged)
                try:
                    krok.read(target)
                except krok.FormatError as error:
                    self.assertTrue(str(error).startswith(f"{target}: error: "), str(error))

    def test_contacts_and_keytimes_of_the_sidecar(self):
        path = self.walk()
        self.assertEqual(krok.read(path).contacts, [])
        krok.run("keys", path, output=self.folder / "walk.keys.json")
        motion = krok.read(path)
        self.assertIn("left_strike", {key.name for key in motion.keytimes})
        contact = next(c for c in motion.contacts if c.end - c.start > 0.3)
        joint = motion.positions[:, motion.index(contact.joint)]
        stay = joint[round(contact.start * motion.rate):round(contact.end * motion.rate)]
        self.assertLess(np.abs(np.median(stay, axis=0) - contact.place).max(), 0.03)

    def test_errors_of_tools_are_exceptions(self):
        with self.assertRaises(krok.Error) as caught:
            krok.run("export", self.folder / "none.anim", output=self.folder / "x.csv")
        self.assertEqual(caught.exception.exit_code, 2)
        self.assertEqual(caught.exception.report["issues"][0]["code"], "file-missing")

    def test_wrong_names_get_the_nearest(self):
        with self.assertRaisesRegex(krok.Error, "unknown verb 'exprot'; did you mean 'export'"):
            krok.run("exprot", self.walk())
        with self.assertRaisesRegex(KeyError, "leftfoot; did you mean 'LeftFoot'"):
            krok.read(self.walk()).index("leftfoot")

    def test_a_large_file_is_mapped_not_read(self):
        motion = krok.read(self.walk())
        large = self.folder / "large.anim"
        times = 1500
        krok.write(krok.Motion(motion.skeleton, motion.rate, np.tile(motion.positions[:40], (times, 1, 1)),
                               np.tile(motion.orientations[:40], (times, 1, 1))), large)

        def memory(kind):  # MiB: of its own (RssAnon), or mapped from files (RssFile)
            with open("/proc/self/status", encoding="ascii") as file:
                return next(int(line.split()[1]) / 1024 for line in file if line.startswith(kind))
        own, of_files = memory("RssAnon"), memory("RssFile")
        mapped = krok.read(large)
        self.assertLess(memory("RssFile") - of_files, 8)
        column = mapped.positions[::1000, 0, 1].copy()
        self.assertLess(memory("RssAnon") - own, 4)
        self.assertGreater(large.stat().st_size, 40 << 20)
        np.testing.assert_array_equal(column, np.tile(motion.positions[:40], (times, 1, 1))[::1000, 0, 1])

    def test_a_motion_in_one_line_its_roles_and_who_made_a_changed_one(self):
        motion = krok.read(self.walk())
        self.assertEqual(repr(motion), "<Motion walk.anim: 264 frames, 29 joints, 60 fps, 4.38 s>")
        self.assertEqual(motion.roles["hips"], "Hips")
        self.assertEqual(motion.roles["chest"], "Spine2")
        lifted = dataclasses.replace(motion, positions=motion.positions + [0, 0.1, 0], path=None)
        self.assertEqual(repr(lifted), "<Motion: 264 frames, 29 joints, 60 fps, 4.38 s>")
        krok.write(lifted, self.folder / "lifted.anim")
        again = krok.read(self.folder / "lifted.anim")
        self.assertEqual(again.provenance["tool"], "krok (Python)")
        np.testing.assert_allclose(again.positions, motion.positions + [0, 0.1, 0], atol=1e-6)

    def test_pandas_and_notebooks(self):
        motion = krok.read(self.walk())
        self.assertIn("data:image/png;base64,", motion._repr_html_())
        try:
            frame = motion.to_frame()
        except ImportError:
            self.skipTest("without pandas")
        np.testing.assert_array_equal(frame["Hips"]["y"], motion.positions[:, motion.index("Hips"), 1])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
