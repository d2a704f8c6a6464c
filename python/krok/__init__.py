"""Krok's files as numpy arrays, and its tools as functions.

    import krok
    walk = krok.read("walk.anim")
    walk.positions[:, walk.index("LeftFoot"), 1]      # height of the left ankle, metres
    krok.run("plot", "walk.anim", sheet="walk.png")   # a tool's report as a dict

Metres, seconds, radians; right-handed, +Y up, characters face +Z. Positions and orientations are global
(joint to world). Quaternions are x, y, z, w. Arrays of a file are read-only views of its memory map: nothing
is read before it is used. The layouts are those of formats/*/SPEC.md.
"""

from __future__ import annotations

import base64
import difflib
import glob
import json
import mmap
import os
import shutil
import struct
import subprocess
import tempfile
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Iterable, NamedTuple, Union

import numpy as np

__all__ = ["Camera", "Contact", "Error", "FormatError", "Keytime", "Model", "Motion", "Part", "Report", "Skeleton",
           "StepLibrary", "from_positions", "read", "run", "write"]

Path = Union[str, "os.PathLike[str]"]


class FormatError(ValueError):
    """A file that breaks a rule of its SPEC.md; the message begins with its path."""


def _nearest(name: str, names: Iterable[str]) -> str:
    """ "; did you mean 'LeftFoot'?", or nothing where no name is near."""
    by_lower = {one.lower(): one for one in names}
    near = difflib.get_close_matches(name.lower(), by_lower, 1)
    return f"; did you mean '{by_lower[near[0]]}'?" if near else ""


class Error(RuntimeError):
    """A tool that ended with exit code 2 or 3: `exit_code`, its `messages`, and its `report` if it wrote one."""

    def __init__(self, exit_code: int, messages: str, report: Report | None):
        super().__init__(messages.strip() or f"exit code {exit_code}")
        self.exit_code, self.messages, self.report = exit_code, messages, report


class Report(dict):
    """A tool's `--json` report, with its `exit_code` (0, or 1: the answer is no) and what it printed."""

    exit_code: int = 0
    output: str = ""


class Contact(NamedTuple):
    """A joint that stays in place from `start` to `end` (seconds) at `place` (metres)."""
    joint: str
    start: float
    end: float
    place: tuple[float, float, float]


class Keytime(NamedTuple):
    """A named moment, such as `left_strike`, in seconds."""
    name: str
    time: float


class Part(NamedTuple):
    """A run of a model's triangles with one material."""
    name: str
    material: str
    first_triangle: int
    triangle_count: int
    mesh: str = ""  # that it came from


@dataclass
class Skeleton:
    """Joints, parents before children. `parents` is -1 for the root. `positions` (joints, 3) in metres and
    `orientations` (joints, 4) are the reference pose."""
    names: list[str]
    parents: np.ndarray
    end_sites: np.ndarray
    positions: np.ndarray
    orientations: np.ndarray

    def index(self, name: str) -> int:
        """The joint's index; KeyError, with the nearest name, if there is none."""
        try:
            return self.names.index(name)
        except ValueError:
            raise KeyError(name + _nearest(name, self.names)) from None


@dataclass(repr=False)
class Motion:
    """A motion (.anim): frame i is at i / `rate` seconds.

    `positions` (frames, joints, 3) are metres. `raw_orientations` (frames, joints, 3 or 4) are as the file has
    them: with four components (`krok-import --orientation xyzw`) `orientations` is a view, too. Joints
    `stretched` (s,) are not rigid: `stretches` (frames, s, 6) are xx, yy, zz, xy, xz, yz of their symmetric
    matrices U, and the joint maps p to R U p + position.
    """
    skeleton: Skeleton
    rate: float
    positions: np.ndarray
    raw_orientations: np.ndarray
    stretched: np.ndarray | None = None
    stretches: np.ndarray | None = None
    provenance: dict[str, Any] = field(default_factory=dict)
    path: str | None = None

    @property
    def names(self) -> list[str]:
        return self.skeleton.names

    @property
    def parents(self) -> np.ndarray:
        return self.skeleton.parents

    def index(self, name: str) -> int:
        return self.skeleton.index(name)

    @property
    def times(self) -> np.ndarray:
        """(frames,) seconds."""
        return np.arange(len(self.positions)) / self.rate

    @property
    def duration(self) -> float:
        """First frame to last, seconds."""
        return max(len(self.positions) - 1, 0) / self.rate

    @cached_property
    def orientations(self) -> np.ndarray:
        """(frames, joints, 4): x, y, z, w."""
        return _with_w(self.raw_orientations)

    @cached_property
    def _keys(self) -> dict[str, Any]:
        beside = os.path.splitext(self.path)[0] + ".keys.json" if self.path else ""
        if not os.path.exists(beside):
            return {}
        with open(beside, encoding="utf-8") as file:
            return json.load(file)

    @property
    def contacts(self) -> list[Contact]:
        """Contacts of the sidecar that `krok-keys` writes beside the file; empty without one."""
        return [Contact(c["joint"], c["start"], c["end"], tuple(c["place"])) for c in self._keys.get("contacts", [])]

    @property
    def keytimes(self) -> list[Keytime]:
        """Keytimes of the sidecar; empty without one."""
        return [Keytime(k["name"], k["time"]) for k in self._keys.get("keytimes", [])]

    @cached_property
    def roles(self) -> dict[str, Any]:
        """Which joint is what, as `krok-info` finds it: {"hips": "Hips", "spine": ["Spine", "Spine1"], ...}."""
        with tempfile.TemporaryDirectory() as folder:
            pose = os.path.join(folder, "pose.anim")
            first = slice(0, 1)
            write(Motion(self.skeleton, self.rate, self.positions[first], self.orientations[first]), pose)
            return dict(run("info", pose)["result"]["files"][0].get("roles", {}))

    def _summary(self) -> str:
        return f"{len(self.positions)} frames, {len(self.names)} joints, {self.rate:g} fps, {self.duration:.2f} s"

    def __repr__(self) -> str:
        name = f" {os.path.basename(self.path)}" if self.path else ""
        return f"<Motion{name}: {self._summary()}>"

    def to_frame(self) -> Any:
        """A pandas.DataFrame of positions in metres: index `time`, columns (joint, axis). Needs pandas."""
        import pandas
        columns = pandas.MultiIndex.from_product([self.names, list("xyz")], names=["joint", "axis"])
        return pandas.DataFrame(self.positions.reshape(len(self.positions), -1),
                                pandas.Index(self.times, name="time"), columns)

    def _repr_html_(self) -> str:
        """The motion as a strip of images, by `krok-plot`; plain text where that is not installed."""
        text = self._summary()
        with tempfile.TemporaryDirectory() as folder:
            clip, strip = os.path.join(folder, "motion.anim"), os.path.join(folder, "strip.png")
            try:
                write(self, clip)
                run("plot", clip, strip=strip)
            except (Error, OSError, ImportError):
                return f"<p>{text}</p>"
            with open(strip, "rb") as file:
                image = base64.b64encode(file.read()).decode()
        return f'<figure><img alt="" src="data:image/png;base64,{image}"><figcaption>{text}</figcaption></figure>'


@dataclass
class Camera:
    """A camera over time (.cam): `positions` (frames, 3), `orientations` (frames, 4), camera to world; it looks
    along its -Z. `fields_of_view` (frames,) are vertical, radians."""
    rate: float
    positions: np.ndarray
    orientations: np.ndarray
    fields_of_view: np.ndarray
    provenance: dict[str, Any] = field(default_factory=dict)


@dataclass
class Model:
    """A skinned mesh (.model): `positions`, `normals` (vertices, 3), `texture_coordinates` (vertices, 2),
    `tangents` (vertices, 4), `joints` and `weights` (vertices, influences), `triangles` (triangles, 3), `colours`
    (vertices, 4), linear, `more_texture_coordinates` (sets, vertices, 2)."""
    skeleton: Skeleton
    positions: np.ndarray
    normals: np.ndarray | None
    texture_coordinates: np.ndarray | None
    tangents: np.ndarray | None
    joints: np.ndarray
    weights: np.ndarray
    triangles: np.ndarray
    parts: list[Part]
    provenance: dict[str, Any] = field(default_factory=dict)
    colours: np.ndarray | None = None
    more_texture_coordinates: np.ndarray | None = None


@dataclass
class StepLibrary:
    """A step library (.steps): `examples` are motions relative to the stance footprint, `keytimes` (examples,
    keytimes) seconds, `parameters` (examples, parameters) as measured, in metres, radians, seconds."""
    skeleton: Skeleton
    rate: float
    example_names: list[str]
    examples: list[Motion]
    keytime_names: list[str]
    keytimes: np.ndarray
    parameters: np.ndarray
    report: dict[str, Any]
    provenance: dict[str, Any]
    _fit: tuple[int, dict[str, np.ndarray]] | None

    def weights(self, parameters: Any) -> np.ndarray:
        """Blend weights (..., examples) for `parameters` (..., parameters); they sum to 1, some may be negative.
        ValueError if the library is not fitted."""
        if self._fit is None:
            raise ValueError("the library is not fitted: krok-fit fits it")
        kernel, fit = self._fit
        low, high = fit["RANGES"]
        q, centres = ((np.asarray(p, float) - low) / (high - low) for p in (parameters, fit["CENTRES"]))
        t = np.linalg.norm(q[..., None, :] - centres, axis=-1) / fit["RADII"]
        phi = (lambda: t ** 3, lambda: t, lambda: np.exp(-4 * t * t),
               lambda: np.where(t <= 0.5, 1 - 6 * t * t * (1 - t), 2 * np.maximum(0, 1 - t) ** 3),
               lambda: np.maximum(0, 1 - t) ** 4 * (4 * t + 1))[kernel]()
        return fit["AFFINE"][0] + q @ fit["AFFINE"][1:] + phi @ fit["COEFFS"]


def _with_w(raw: np.ndarray) -> np.ndarray:
    """x, y, z, w of stored orientations; three components as float64, with w <= 0."""
    if raw.shape[-1] == 4:
        return raw
    xyz = raw.astype(np.float64)
    w = -np.sqrt(np.maximum(0, 1 - np.einsum("...i,...i->...", xyz, xyz)))
    result = np.concatenate([xyz, w[..., None]], axis=-1)
    return result / np.linalg.norm(result, axis=-1, keepdims=True)


class _Container:
    """Header and section table of a file, formats/container/SPEC.md."""

    def __init__(self, path: Path):
        self.path = os.fspath(path)
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            self.require(size >= 64, f"{size} bytes are no header")
            self.data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self.magic, version, flags, written, _, count = struct.unpack_from("<8sIIQQI", self.data)
        self.require(self.magic in _READERS, "is none of Krok's binary files")
        self.require(version == 1, f"version {version}, expected 1")
        self.require(flags <= (3 if self.magic == b"KROKANIM" else 1), f"unknown flags {flags:#x}")
        self.require(written == size, f"{size} bytes, expected {written}")
        self.require(count <= 64 and 64 + 32 * count <= size, f"impossible number of sections, {count}")
        self.components, self.stretched = 3 + (flags & 1), flags & 2 != 0
        self.sections: dict[str, tuple[int, int]] = {}
        for name, offset, length, _ in struct.iter_unpack("<8sQQQ", self.data[64:64 + 32 * count]):
            self.require(offset % 64 == 0 and offset <= size and length <= size - offset, "a section out of place")
            self.sections[name.rstrip(b"\0").decode("ascii", "replace")] = offset, length

    def require(self, holds: bool, message: str) -> None:
        if not holds:
            raise FormatError(f"{self.path}: error: {message}")

    def bytes(self, name: str) -> bytes:
        self.require(name in self.sections, f"no section {name}")
        offset, length = self.sections[name]
        return self.data[offset:offset + length]

    def array(self, name: str, kind: Any, *shape: int) -> np.ndarray:
        self.require(name in self.sections, f"no section {name}")
        offset, length = self.sections[name]
        count = int(np.prod(shape, dtype=object))
        self.require(length == count * np.dtype(kind).itemsize, f"{name} has {length} bytes")
        return np.frombuffer(self.data, kind, count, offset).reshape(shape)

    def info(self, code: str) -> tuple[Any, ...]:
        content = self.bytes("INFO")
        self.require(len(content) == struct.calcsize(code), f"INFO has {len(content)} bytes")
        return struct.unpack(code, content)

    def rate_and(self, code: str) -> tuple[Any, ...]:
        rate, *rest = self.info("<d" + code)
        self.require(0.001 <= rate <= 100_000, f"impossible rate {rate:g}")
        return rate, *rest

    def texts(self, name: str, count: int) -> list[str]:
        parts = self.bytes(name).split(b"\0")
        self.require(len(parts) == count + 1, f"{name} has {len(parts) - 1} texts, expected {count}")
        try:
            return [part.decode() for part in parts[:-1]]
        except UnicodeDecodeError:
            raise FormatError(f"{self.path}: error: {name} is not UTF-8") from None

    def page(self, name: str) -> dict[str, Any]:
        try:
            return json.loads(self.bytes(name) or b"{}") if name in self.sections else {}
        except (ValueError, RecursionError):
            raise FormatError(f"{self.path}: error: {name} is not JSON") from None

    def skeleton(self, count: int) -> Skeleton:
        joints, pose = self.array("JOINTS", "<i4", count, 2), self.array("REFPOSE", "<f4", count, 3 + self.components)
        parents = joints[:, 0]
        self.require(count > 0 and parents[0] == -1, "joint 0 has a parent")
        self.require(bool(np.all((0 <= parents[1:]) & (parents[1:] < np.arange(1, count)))), "parents out of order")
        return Skeleton(self.texts("NAMES", count), parents, joints[:, 1] & 1 == 1, pose[:, :3], _with_w(pose[:, 3:]))


def _read_motion(file: _Container) -> Motion:
    rate, frames, joints, _ = file.rate_and("QII")
    records = file.array("FRAMES", "<f4", frames, joints, 3 + file.components)
    motion = Motion(file.skeleton(joints), rate, records[..., :3], records[..., 3:], provenance=file.page("META"),
                    path=file.path)
    if file.stretched:
        count = file.sections.get("SJOINTS", (0, 0))[1] // 4
        motion.stretched = file.array("SJOINTS", "<u4", count)
        motion.stretches = file.array("STRETCH", "<f4", frames, count, 6)
        file.require(bool(np.all(motion.stretched < joints)), "a stretched joint out of range")
    return motion


def _read_camera(file: _Container) -> Camera:
    rate, frames = file.rate_and("Q")
    records = file.array("FRAMES", "<f4", frames, 4 + file.components)
    return Camera(rate, records[:, :3], _with_w(records[:, 3:-1]), records[:, -1], file.page("META"))


# Arrays of a model: section, attribute, type and columns (0: influences); those of _OPTIONAL may be absent.
_MESH = (("POSITION", "positions", "<f4", 3), ("NORMAL", "normals", "<f4", 3),
         ("TEXCOORD", "texture_coordinates", "<f4", 2), ("TANGENT", "tangents", "<f4", 4),
         ("COLOUR", "colours", "<f4", 4), ("VJOINTS", "joints", "<u2", 0), ("VWEIGHTS", "weights", "<f4", 0),
         ("TRIANGLE", "triangles", "<u4", 3))
_OPTIONAL = ("NORMAL", "TEXCOORD", "TANGENT", "COLOUR")


def _read_model(file: _Container) -> Model:
    joints, vertices, triangles, parts, influences, _ = file.info("<6I")
    names, runs = file.texts("PARTNAME", 2 * parts), file.array("PARTS", "<u4", parts, 2).tolist()
    meshes = file.texts("MESHNAME", parts) if "MESHNAME" in file.sections else [""] * parts
    arrays = {attribute: None if section in _OPTIONAL and section not in file.sections else
              file.array(section, kind, triangles if section == "TRIANGLE" else vertices, columns or influences)
              for section, attribute, kind, columns in _MESH}
    if "TEXMORE" in file.sections:
        sets = file.sections["TEXMORE"][1] // max(8 * vertices, 1)
        arrays["more_texture_coordinates"] = file.array("TEXMORE", "<f4", sets, vertices, 2)
    model = Model(file.skeleton(joints), **arrays, provenance=file.page("META"),
                  parts=[Part(*names[2 * i:2 * i + 2], *runs[i], meshes[i]) for i in range(parts)])
    file.require(not model.joints.size or int(model.joints.max()) < joints, "a joint out of range")
    file.require(not model.triangles.size or int(model.triangles.max()) < vertices, "a vertex out of range")
    return model


def _read_steps(file: _Container) -> StepLibrary:
    rate, joints, keytimes, parameters, count, _, _ = file.rate_and("6I")
    skeleton, names = file.skeleton(joints), file.texts("EXNAMES", count)
    heads = file.array("EXAMPLES", [("rate", "<f8"), ("frames", "<u4"), ("rest", "<u4", 3)], count)
    ends = np.cumsum(heads["frames"], dtype=np.int64)
    records = file.array("FRAMES", "<f4", int(ends[-1]) if count else 0, joints, 3 + file.components)
    examples = [Motion(skeleton, float(head["rate"]), pose[..., :3], pose[..., 3:])
                for head, pose in zip(heads, np.split(records, ends[:-1]))]
    fit = None
    if "WEIGHTS" in file.sections:
        kernel, _, centres = struct.unpack("<IIQ", file.bytes("WEIGHTS").ljust(16, b"\0")[:16])
        file.require(kernel <= 4, f"unknown kernel {kernel}")
        fit = kernel, {"RANGES": file.array("RANGES", "<f8", 2, parameters),
                       "CENTRES": file.array("CENTRES", "<f8", centres, parameters),
                       "RADII": file.array("RADII", "<f8", centres) if kernel >= 2 else np.ones(centres),
                       "AFFINE": file.array("AFFINE", "<f8", parameters + 1, count),
                       "COEFFS": file.array("COEFFS", "<f8", centres, count)}
    return StepLibrary(skeleton, rate, names, examples, file.texts("KEYNAMES", keytimes),
                       file.array("KEYTIMES", "<f8", count, keytimes), file.array("MEASURED", "<f8", count, parameters),
                       file.page("REPORT"), file.page("META"), fit)


_READERS = {b"KROKANIM": _read_motion, b"KROKMODL": _read_model, b"KROKCAMR": _read_camera, b"KROKSTEP": _read_steps}


def read(path: Path) -> Any:
    """Opens a .anim (Motion), .model (Model), .cam (Camera) or .steps file (StepLibrary), by its content.

    FormatError if it breaks its specification. The checksum is not verified; `krok-info` does.
    """
    file = _Container(path)
    return _READERS[file.magic](file)


def write(data: Motion | Model | Camera, path: Path) -> None:
    """Writes a motion, model or camera; orientations with four components. The file is complete or not there.

    ValueError for values that are not finite or orientations that are no rotations. Needs python3-xxhash.
    """
    import xxhash
    if isinstance(data, Camera):
        info = struct.pack("<dQ", data.rate, len(data.positions))
        frames = np.concatenate([_records(data.positions, data.orientations),
                                 np.asarray(data.fields_of_view, "<f4")[:, None]], axis=-1)
        magic, sections = b"KROKCAMR", [("INFO", info), ("FRAMES", frames.tobytes())]
    else:
        skeleton = data.skeleton
        flags = np.stack([skeleton.parents, skeleton.end_sites], axis=-1).astype("<i4")
        bones = [("JOINTS", flags.tobytes()), ("NAMES", _texts(skeleton.names)),
                 ("REFPOSE", _records(skeleton.positions, skeleton.orientations).tobytes())]
        if isinstance(data, Motion):
            info = struct.pack("<dQII", data.rate, len(data.positions), len(skeleton.names), 0)
            frames = _records(data.positions, data.orientations)
            magic, sections = b"KROKANIM", [("INFO", info), *bones, ("FRAMES", frames.tobytes())]
            if data.stretched is not None:
                sections += [("SJOINTS", np.asarray(data.stretched, "<u4").tobytes()),
                             ("STRETCH", _finite(data.stretches, "<f4").tobytes())]
        else:
            info = struct.pack("<6I", len(skeleton.names), len(data.positions), len(data.triangles), len(data.parts),
                               data.weights.shape[1], 0)
            mesh = [(section, _finite(getattr(data, attribute), kind).tobytes()) for section, attribute, kind, _ in _MESH
                    if getattr(data, attribute) is not None]
            if data.more_texture_coordinates is not None:
                mesh.append(("TEXMORE", _finite(data.more_texture_coordinates, "<f4").tobytes()))
            magic, sections = b"KROKMODL", [("INFO", info), *bones, *mesh,
                                            ("PARTS", np.array([part[2:4] for part in data.parts], "<u4").tobytes()),
                                            ("PARTNAME", _texts(text for part in data.parts for text in part[:2]))]
            if any(part.mesh for part in data.parts):
                sections.append(("MESHNAME", _texts(part.mesh for part in data.parts)))
    if data.provenance:
        # The source stays that of the data; the tool is what wrote the file.
        made = {**data.provenance, "tool": "krok (Python)"}
        sections.append(("META", json.dumps(made, ensure_ascii=False).encode()))
    table, body, end = b"", [], 64 + 32 * len(sections)
    for name, content in sections:
        body += [b"\0" * (-end % 64), content]
        table += struct.pack("<8sQQQ", name.encode(), end + len(body[-2]), len(content), 0)
        end += len(body[-2]) + len(content)
    flags = 3 if isinstance(data, Motion) and data.stretched is not None else 1
    head, rest = struct.pack("<8sIIQ", magic, 1, flags, end), struct.pack("<I28x", len(sections)) + table
    checksum = xxhash.xxh3_64_intdigest(b"".join([*body, head, b"\0" * 8, rest]))
    temporary = f"{os.fspath(path)}.{os.getpid()}.tmp"
    try:
        with open(temporary, "xb") as file:
            file.write(b"".join([head, struct.pack("<Q", checksum), rest, *body]))
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException:
        if os.path.exists(temporary):
            os.unlink(temporary)
        raise


def _finite(values: Any, kind: str) -> np.ndarray:
    array = np.asarray(values, kind)
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        raise ValueError("a value is not finite")
    return array


def _records(positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
    """Transform records, formats/container/SPEC.md."""
    lengths = np.linalg.norm(orientations, axis=-1)
    if not np.allclose(lengths, 1, atol=1e-4):
        raise ValueError("an orientation is no unit quaternion")
    return np.concatenate([_finite(positions, "<f4"), _finite(orientations, "<f4")], axis=-1)


def _texts(texts: Iterable[str]) -> bytes:
    return b"".join(text.encode() + b"\0" for text in texts)


def run(verb: str, *inputs: Path, **options: Any) -> Report:
    """Runs `krok-VERB` (found on PATH) and returns its report.

    `run("edit", "walk.anim", output="cut.anim", from_="1s", loop=True)` is `krok-edit walk.anim --output cut.anim
    --from 1s --loop`: underscores become hyphens, a trailing one is dropped; True is an option without a value,
    False and None leave it out, a list repeats it. Error on exit codes 2 and 3 and for an unknown verb;
    FileNotFoundError without the tools.
    """
    if shutil.which(f"krok-{verb}") is None and shutil.which("krok-import") is not None:
        known = [os.path.basename(path)[5:] for folder in os.get_exec_path()
                 for path in glob.glob(os.path.join(glob.escape(folder), "krok-*"))]
        raise Error(2, f"unknown verb '{verb}'" + _nearest(verb, known), None)
    arguments = [os.fspath(path) for path in inputs]
    for name, value in options.items():
        flag = "--" + name.rstrip("_").replace("_", "-")
        for item in value if isinstance(value, (list, tuple)) else [value]:
            if item is not None and item is not False:
                arguments += [flag] if item is True else [f"{flag}={item}"]
    with tempfile.TemporaryDirectory() as folder:
        page = os.path.join(folder, "report.json")
        done = subprocess.run([f"krok-{verb}", *arguments, f"--json={page}"], capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, errors="replace")
        report = None
        if os.path.exists(page):
            with open(page, encoding="utf-8") as file:
                report = Report(json.load(file))
            report.exit_code, report.output = done.returncode, done.stdout
    if done.returncode not in (0, 1) or report is None:
        raise Error(done.returncode, done.stderr, report)
    return report


def from_positions(positions: Any, skeleton: Path, rate: float, **options: Any) -> Motion:
    """The motion of joint positions, (frames, joints, 3), with rotations found by `krok-import`.

    `skeleton` says what the joints are: "humanml22", "smpl24", "coco17" and so on, or a file as --skeleton takes it;
    `options` are those of `krok-import`, such as unit="mm", up="z". Error if the array is no motion.
    """
    with tempfile.TemporaryDirectory() as folder:
        array, clip = os.path.join(folder, "positions.npy"), os.path.join(folder, "motion.anim")
        np.save(array, np.asarray(positions), allow_pickle=False)
        run("import", array, skeleton=skeleton, fps=rate, output=clip, orientation="xyzw", **options)
        return replace(read(clip), path=None)  # the file is gone, its map stays
