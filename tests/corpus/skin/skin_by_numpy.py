"""Skins a glTF rig with numpy alone, in doubles, and holds a skinned mesh against the result.

    skin_by_numpy.py RIG SECONDS METHOD POSE

RIG has a skin and an animation, POSE the mesh that Krok made of it SECONDS after the animation's
first key with METHOD (linear, dual-quaternion, rigid). Prints the largest distance of two vertices
in metres and, where RIG has normals, the largest angle between two normals in degrees.
"""

import base64
import json
import os
import struct
import sys

import numpy as np

TYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Gltf:
    def __init__(self, path):
        data = open(path, "rb").read()
        binary = None
        if data[:4] == b"glTF":
            length = struct.unpack("<I", data[12:16])[0]
            binary = data[20 + length + 8:]
            data = data[20:20 + length]
        self.json = json.loads(data)
        self.buffers = []
        for buffer in self.json["buffers"]:
            uri = buffer.get("uri")
            if uri is None:
                self.buffers.append(binary)
            elif uri.startswith("data:"):
                self.buffers.append(base64.b64decode(uri.split(",", 1)[1]))
            else:
                self.buffers.append(open(os.path.join(os.path.dirname(path), uri), "rb").read())

    def array(self, index):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        width = WIDTHS[accessor["type"]]
        kind = np.dtype(TYPES[accessor["componentType"]])
        stride = view.get("byteStride", kind.itemsize * width)
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        values = np.ndarray((accessor["count"], width), kind, self.buffers[view["buffer"]], start,
                            (stride, kind.itemsize)).copy()
        if accessor.get("normalized"):
            values = values / np.iinfo(kind).max
        return values

    def vertices(self, names):
        mesh = self.json["meshes"][0]
        return [np.concatenate([self.array(p["attributes"][name]) for p in mesh["primitives"]])
                for name in names]


def rotation(q):
    x, y, z, w = q / np.linalg.norm(q)
    axis = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * axis + 2 * axis @ axis


def quaternion(r):
    # The eigenvector of the largest eigenvalue (Bar-Itzhack 2000).
    k = np.array([
        [r[0, 0] - r[1, 1] - r[2, 2], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[2, 1] - r[1, 2]],
        [0, r[1, 1] - r[0, 0] - r[2, 2], r[1, 2] + r[2, 1], r[0, 2] - r[2, 0]],
        [0, 0, r[2, 2] - r[0, 0] - r[1, 1], r[1, 0] - r[0, 1]],
        [0, 0, 0, r[0, 0] + r[1, 1] + r[2, 2]]])
    k = np.triu(k) + np.triu(k, 1).T
    return np.linalg.eigh(k)[1][:, -1]


def product(a, b):
    return np.concatenate([a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3]),
                           [a[3] * b[3] - a[:3] @ b[:3]]])


def sampled(times, values, seconds):
    i = int(np.clip(np.searchsorted(times, seconds, "right") - 1, 0, len(times) - 1))
    if i + 1 == len(times) or seconds <= times[0]:
        return values[i]
    t = (seconds - times[i]) / (times[i + 1] - times[i])
    a, b = values[i], values[i + 1]
    if len(a) == 3:
        return a + t * (b - a)
    b = b if a @ b >= 0 else -b
    angle = np.arccos(min(a @ b, 1.0))
    if angle < 1e-6:
        return a + t * (b - a)
    return (np.sin((1 - t) * angle) * a + np.sin(t * angle) * b) / np.sin(angle)


def palette(gltf, seconds):
    nodes = [dict(node) for node in gltf.json["nodes"]]
    animation = gltf.json["animations"][0]
    for channel in animation["channels"]:
        sampler = animation["samplers"][channel["sampler"]]
        assert sampler.get("interpolation", "LINEAR") == "LINEAR"
        times = gltf.array(sampler["input"])[:, 0].astype(float)
        values = gltf.array(sampler["output"]).astype(float)
        target = channel["target"]
        nodes[target["node"]][target["path"]] = sampled(times, values, seconds)
    world = {}

    def place(index, parent):
        node = nodes[index]
        if "matrix" in node:
            local = np.array(node["matrix"], float).reshape(4, 4).T
        else:
            local = np.eye(4)
            turn = rotation(np.array(node.get("rotation", [0, 0, 0, 1]), float))
            local[:3, :3] = turn * np.array(node.get("scale", [1, 1, 1]), float)
            local[:3, 3] = node.get("translation", [0, 0, 0])
        world[index] = parent @ local
        for child in node.get("children", []):
            place(child, world[index])

    for root in gltf.json["scenes"][gltf.json.get("scene", 0)]["nodes"]:
        place(root, np.eye(4))
    skin = gltf.json["skins"][0]
    inverses = gltf.array(skin["inverseBindMatrices"]).astype(float)
    return [world[j] @ m.reshape(4, 4).T for j, m in zip(skin["joints"], inverses)]


def blended(matrices, weights, method):
    if method == "rigid":
        return matrices[int(np.argmax(weights))]
    if method == "linear":
        return sum(w * m for w, m in zip(weights, matrices))
    first = quaternion(matrices[0][:3, :3])
    real, dual = np.zeros(4), np.zeros(4)
    for w, m in zip(weights, matrices):
        q = quaternion(m[:3, :3])
        q = q if q @ first >= 0 else -q
        real += w * q
        dual += w * 0.5 * product(np.append(m[:3, 3], 0), q)
    length = np.linalg.norm(real)
    real, dual = real / length, dual / length
    result = np.eye(4)
    result[:3, :3] = rotation(real)
    result[:3, 3] = 2 * product(dual, real * [-1, -1, -1, 1])[:3]
    return result


def main(rig_path, seconds, method, pose_path):
    rig = Gltf(rig_path)
    matrices = palette(rig, float(seconds))
    names = rig.json["meshes"][0]["primitives"][0]["attributes"]
    sets = [i for i in range(2) if f"JOINTS_{i}" in names]
    positions, = rig.vertices(["POSITION"])
    joints = np.concatenate(rig.vertices([f"JOINTS_{i}" for i in sets]), axis=1)
    weights = np.concatenate(rig.vertices([f"WEIGHTS_{i}" for i in sets]), axis=1).astype(float)
    attributes = ["POSITION", "NORMAL"] if "NORMAL" in names else ["POSITION"]
    found = [values.astype(float) for values in Gltf(pose_path).vertices(attributes)]
    given = [values.astype(float) for values in rig.vertices(attributes)]
    assert len(found[0]) == len(positions), (len(found[0]), len(positions))
    distance = angle = 0.0
    for v, position in enumerate(given[0]):
        order = [k for k in np.argsort(-weights[v], kind="stable") if weights[v, k] > 0]
        w = weights[v, order] / weights[v, order].sum()
        m = blended([matrices[joints[v, k]] for k in order], w, method)
        moved = m[:3, :3] @ position + m[:3, 3]
        distance = max(distance, float(np.linalg.norm(moved - found[0][v])))
        if len(given) > 1:
            normal = m[:3, :3] @ given[1][v]
            across = np.linalg.norm(np.cross(normal, found[1][v]))
            angle = max(angle, float(np.degrees(np.arctan2(across, normal @ found[1][v]))))
    print(f"{len(positions)} vertices, {sum((weights > 0).sum(axis=1) > 1)} with several joints")
    print(f"{distance:.3e}")
    print(f"{angle:.3e}")


main(*sys.argv[1:])
