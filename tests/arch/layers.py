"""Checks the dependency rule: which folder may include which, top-level names, public headers, and
that what a source uses of other libraries is included: precompiled headers hide what is forgotten.

Usage: layers.py SOURCE_FOLDER. Prints what is wrong, exit code 1 if anything is.
"""

import functools
import pathlib
import re
import subprocess
import sys

# folder -> folders whose headers it may include, besides its own. Transitive use is spelt out,
# so that this table is the whole truth.
BASE = {"lib/core", "lib/math", "lib/scene"}
ALLOWED = {
    "lib/core": set(),
    "lib/math": {"lib/core"},
    "lib/scene": {"lib/core", "lib/math"},
    "lib/roles": BASE,
    "lib/nodes": BASE,
    "lib/capture": BASE | {"lib/roles"},
    "lib/character": BASE | {"lib/roles", "lib/capture", "lib/nodes", "lib/retarget"},
    "lib/tracks": BASE,
    "lib/plant": BASE | {"lib/contacts", "lib/ik", "lib/motion", "lib/roles"},
    "lib/pose": BASE,
    "lib/motion": BASE | {"lib/roles"},
    "lib/blend": BASE | {"lib/roles", "lib/motion", "lib/pose"},
    "lib/timeline": BASE | {"lib/roles", "lib/motion", "lib/pose", "lib/blend"},
    "lib/filter": BASE | {"lib/motion"},
    "lib/camera": BASE | {"lib/roles", "lib/motion", "lib/filter"},
    "lib/contacts": BASE | {"lib/roles", "lib/motion", "lib/filter"},
    "lib/parametric": BASE | {"lib/roles", "lib/motion", "lib/pose", "lib/contacts", "lib/rbf"},
    "lib/rbf": {"lib/core", "lib/math"},
    "lib/terrain": {"lib/core", "lib/math", "lib/scene"},
    "lib/gait": BASE | {"lib/roles", "lib/contacts", "lib/ik", "lib/motion", "lib/parametric", "lib/pose",
                        "lib/rbf", "lib/terrain"},
    "lib/fit": {"lib/core", "lib/rbf"},
    "lib/ik": BASE | {"lib/roles", "lib/motion", "lib/timeline"},
    "lib/positions": BASE | {"lib/roles", "lib/filter"},
    "lib/ragdoll": BASE | {"lib/roles", "lib/ik", "lib/motion", "lib/timeline"},
    "lib/retarget": BASE | {"lib/roles", "lib/contacts", "lib/ik", "lib/motion"},
    "lib/settle": BASE | {"lib/roles", "lib/motion", "lib/ragdoll", "lib/retarget", "lib/terrain"},
    "lib/skin": BASE,
    "lib/face": BASE | {"lib/motion", "lib/pose", "lib/blend", "lib/timeline", "lib/skin"},
    "lib/body": BASE | {"lib/roles", "lib/retarget"},
    "lib/correctives": BASE | {"lib/rbf", "lib/skin"},
    "lib/compare": BASE,
    "lib/lint": BASE | {"lib/capture", "lib/contacts", "lib/motion", "lib/roles"},
    "lib/draw": BASE | {"lib/roles", "lib/contacts", "lib/motion", "lib/compare", "lib/retarget"},
    "lib/render": BASE,
    "formats/registry": {"lib/core"},
    "formats/io": BASE | {"lib/capture", "lib/character", "lib/roles", "lib/nodes", "lib/skin", "lib/terrain"},
    "formats/json": BASE | {"formats/registry"},
    "formats/chart": {"lib/core", "lib/draw", "formats/csv"},
    "formats/role_map": BASE | {"lib/roles", "formats/json"},
    "formats/timeline": BASE | {"lib/motion", "lib/blend", "lib/timeline", "lib/face", "formats/json"},
    "formats/textgrid": BASE | {"formats/csv"},
    "formats/sequences": {"lib/core", "lib/scene", "formats/json"},
    "formats/library": {"lib/core", "lib/scene", "formats/json"},
    "formats/keys": BASE | {"formats/json"},
    "formats/camera_keys": BASE | {"lib/camera", "formats/json"},
    "formats/alignment": BASE | {"formats/json"},
    "formats/zip": BASE,
    "formats/limits": BASE | {"lib/ik", "formats/json"},
    "formats/ragdoll": BASE | {"lib/ik", "lib/ragdoll", "formats/json"},
    "formats/goals": BASE | {"lib/roles", "lib/motion", "lib/timeline", "lib/ik", "formats/json"},
    "formats/container": BASE | {"formats/registry"},
    "formats/bvh": BASE | {"lib/roles", "lib/capture", "formats/registry"},
    "formats/acclaim": BASE | {"lib/roles", "lib/capture", "formats/registry"},
    "formats/anim": BASE | {"formats/container", "formats/registry"},
    "formats/model": BASE | {"formats/container", "formats/registry"},
    "formats/cam": BASE | {"formats/container", "formats/registry"},
    "formats/steps": BASE | {"lib/contacts", "lib/parametric", "lib/rbf", "formats/container",
                             "formats/registry"},
    "formats/gltf": BASE | {"lib/nodes", "lib/skin", "lib/tracks"},
    "formats/assimp": BASE | {"lib/capture", "lib/character", "lib/nodes", "formats/registry"},
    "formats/npy": BASE | {"lib/capture", "lib/motion", "lib/positions", "lib/roles", "formats/json", "formats/zip"},
    "formats/csv": BASE,
    "formats/film": {"lib/core"},
    "formats/opensim": {"lib/core", "formats/csv"},
    "formats/obj": BASE,
    "formats/pc2": BASE,
    "formats/weights": BASE | {"lib/skin", "formats/csv", "formats/json"},
    "formats/image": BASE,
    "formats/prints": BASE | {"lib/contacts", "lib/gait", "formats/csv", "formats/json"},
    "formats/path": BASE | {"lib/gait", "formats/csv", "formats/json"},
    "formats/height_field": BASE | {"lib/terrain", "formats/image", "formats/json", "formats/morph_exr"},
    "formats/material": BASE | {"formats/json"},
    "formats/character": BASE | {"formats/json"},
    "formats/correctives": BASE | {"lib/correctives", "lib/rbf", "lib/skin", "formats/json"},
    "formats/key_shapes": BASE | {"lib/skin", "formats/json"},
    "formats/morph_exr": BASE | {"formats/container"},
}
# A format that is not above reads into assets; formats/io has the table of formats and opens all.
PLAIN_FORMAT = BASE | {"lib/capture", "lib/roles", "formats/csv", "formats/json", "formats/registry"}
TOP = {
    "CMakeLists.txt", "CMakePresets.json", "Makefile", "README.md", "LICENSE", "CHANGELOG.md", "CONTRIBUTING.md",
    "action.yml", "tools", "lib", "formats", "tests", "samples", "docs", "packaging", "python",
}
# Below tools/: the frame of a command line knows nothing of batches, neither knows what tools share.
SHARED_BY_TOOLS = {"tools/cli", "tools/batch", "tools/shared"}
TOOLS = {"tools/cli": set(), "tools/batch": {"tools/cli"}, "tools/shared": {"tools/cli"}}
# What a header of the library may show its user. Everything else stays in .cpp files.
PUBLIC_THIRD_PARTY = ("Eigen/",)
THIRD_PARTY = re.compile(
    r"^(ceres|bullet|btBullet|tiny_gltf|OpenEXR|Imf|Imath|assimp|hwy|fmt|CLI|nlohmann|fast_float|"
    r"xxhash|embree|png\.h|jpeglib|ft2build)")
# What names a library in a source -> how its headers begin.
USES = {r"\bfmt::": "fmt/", r"\bnlohmann::": "nlohmann/", r"\bEigen::": "Eigen/",
        r"\b(EXPECT|ASSERT)_": ("gtest/", "gmock/")}
NO_CODE = re.compile(r'//.*|"(\\.|[^"\\\n])*"')
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def room_of(include):
    """The folder of an include as the project writes them: "scene/clip.h", "formats/bvh/x.h"."""
    parts = include.split("/")
    if parts[0] in ("formats", "tools", "samples", "tests"):
        return "/".join(parts[:2])
    return "lib/" + parts[0] if len(parts) > 1 else None


@functools.cache
def included(root, name):
    """Headers of other libraries, files of the project."""
    libraries, files = set(), set()
    for kind, include in INCLUDE.findall((root / name).read_text(encoding="utf-8")):
        if kind == "<":
            libraries.add(include)
        else:
            folders = ("", "lib/", "tests/", name.rpartition("/")[0] + "/")
            files |= set([folder + include for folder in folders if (root / (folder + include)).is_file()][:1])
    return libraries, files


def libraries_of(root, name):
    """Headers of other libraries that a source includes, itself or through the project's headers."""
    found, reached, waiting = set(), {name}, [name]
    while waiting:
        libraries, files = included(root, waiting.pop())
        found |= libraries
        waiting += files - reached
        reached |= files
    return found


def main():
    root = pathlib.Path(sys.argv[1])
    tracked = subprocess.run(
        ["git", "-C", str(root), "ls-files", "--cached", "--others", "--exclude-standard"],
        capture_output=True, text=True, check=True).stdout.split("\n")
    tracked = [name for name in tracked if name and (root / name).exists()]
    faults = []

    for name in sorted({name.split("/")[0] for name in tracked}):
        if name not in TOP and not name.startswith("."):
            faults.append(f"{name}: does not belong at the top level")

    checked = 0
    for name in tracked:
        path = root / name
        if path.suffix in (".h", ".cpp"):
            code = NO_CODE.sub("", path.read_text(encoding="utf-8"))
            libraries = libraries_of(root, name)
            faults += [f"{name}: uses {header} and does not include it" for use, header in USES.items()
                       if re.search(use, code) and not any(it.startswith(header) for it in libraries)]
        if path.suffix not in (".h", ".cpp") or not name.startswith(("lib/", "formats/", "tools/")):
            continue
        room = "/".join(name.split("/")[:2])
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".h" and not text.startswith("#pragma once\n"):
            faults.append(f"{name}: does not begin with #pragma once")
        for kind, include in INCLUDE.findall(text):
            checked += 1
            if kind == "<":
                in_library = name.startswith(("lib/", "formats/"))
                if (path.suffix == ".h" and in_library and THIRD_PARTY.match(include)
                        and not include.startswith(PUBLIC_THIRD_PARTY)
                        and not path.stem.endswith("_internal")):
                    faults.append(f"{name}: a public header shows <{include}>")
                continue
            target = room_of(include)
            if target is None or target == room:
                continue
            if name.startswith("tools/"):
                if target.startswith("tools/") and target not in TOOLS.get(room, SHARED_BY_TOOLS):
                    faults.append(f"{name}: includes {include}; tools use {sorted(SHARED_BY_TOOLS)} alone, "
                                  "cli nothing above it")
                continue
            is_format = room.startswith("formats/")
            allowed = ALLOWED.get(room, PLAIN_FORMAT if is_format else None)
            if room == "formats/io" and target.startswith("formats/"):
                continue
            if allowed is None:
                faults.append(f"{name}: folder {room} is not in the table of layers.py")
            elif target not in allowed:
                faults.append(f"{name}: {room} may not include {include}")

    for fault in faults:
        print(fault)
    print(f"{checked} includes checked, {len(faults)} faults")
    return 1 if faults or checked < 100 else 0


if __name__ == "__main__":
    sys.exit(main())
