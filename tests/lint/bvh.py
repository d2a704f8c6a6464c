"""Reads and writes BVH, apart from Krok's own reader: rotations as rotation vectors, forward kinematics."""

import numpy as np


def exp_so3(vectors):
    """Rotation matrices of rotation vectors, [..., 3] -> [..., 3, 3]."""
    angle = np.linalg.norm(vectors, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    skew = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], -1).reshape(*x.shape, 3, 3)
    small = angle < 1e-8
    safe = np.where(small, 1, angle)
    a = np.where(small, 1, np.sin(safe) / safe)
    b = np.where(small, 0.5, (1 - np.cos(safe)) / safe**2)
    return np.eye(3) + a * skew + b * skew @ skew


def log_so3(matrices):
    """Rotation vectors of rotation matrices, by their quaternions."""
    m = matrices
    trace = np.trace(m, axis1=-2, axis2=-1)
    four = np.stack([trace, m[..., 0, 0] * 2 - trace, m[..., 1, 1] * 2 - trace, m[..., 2, 2] * 2 - trace], -1) + 1
    four = np.sqrt(np.maximum(four, 0)) / 2  # |w|, |x|, |y|, |z|
    pairs = {(0, 1): m[..., 2, 1] - m[..., 1, 2], (0, 2): m[..., 0, 2] - m[..., 2, 0],
             (0, 3): m[..., 1, 0] - m[..., 0, 1], (1, 2): m[..., 1, 0] + m[..., 0, 1],
             (1, 3): m[..., 0, 2] + m[..., 2, 0], (2, 3): m[..., 2, 1] + m[..., 1, 2]}
    best = np.argmax(four, -1)
    quaternion = np.empty_like(four)
    for k in range(4):
        signed = np.stack([four[..., i] if i == k else pairs[min(i, k), max(i, k)] / (4 * np.maximum(four[..., k], 1e-12))
                           for i in range(4)], -1)
        quaternion = np.where((best == k)[..., None], signed, quaternion)
    quaternion *= np.where(quaternion[..., :1] < 0, -1, 1)
    size = np.linalg.norm(quaternion[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(size, quaternion[..., :1])
    return quaternion[..., 1:] * np.where(size < 1e-10, 2, angle / np.maximum(size, 1e-10))


def axis_matrix(axis, angles):
    return exp_so3(angles[..., None] * np.eye(3)["XYZ".index(axis)])


def euler_of(matrices, order):
    """Angles (radians) about three different axes whose product, in this order, is the rotation."""
    i, j, k = ("XYZ".index(axis) for axis in order)
    sign = 1 if (j - i) % 3 == 1 else -1
    middle = np.arcsin(np.clip(sign * matrices[..., i, k], -1, 1))
    first = np.arctan2(-sign * matrices[..., j, k], matrices[..., k, k])
    last = np.arctan2(-sign * matrices[..., i, j], matrices[..., i, i])
    return np.stack([first, middle, last], -1)


class Bvh:
    """joints: list of (name, parent, offset, channels or None for an end site); values [frames x channels]."""

    def __init__(self, path):
        words = open(path, encoding="latin-1").read().split()
        self.joints, stack, i = [], [-1], 1
        while words[i].upper() != "MOTION":
            word = words[i].upper()
            if word in ("ROOT", "JOINT"):
                self.joints.append([words[i + 1], stack[-1], None, []])
                i += 2
            elif word == "END":
                self.joints.append([None, stack[-1], None, None])
                i += 2
            elif word == "{":
                stack.append(len(self.joints) - 1)
                i += 1
            elif word == "}":
                stack.pop()
                i += 1
            elif word == "OFFSET":
                self.joints[-1][2] = np.array(words[i + 1:i + 4], float)
                i += 4
            elif word == "CHANNELS":
                count = int(words[i + 1])
                self.joints[-1][3] = [name.lower() for name in words[i + 2:i + 2 + count]]
                i += 2 + count
            else:
                raise ValueError(f"{path}: {words[i]}")
        numbers = " ".join(words[i + 1:]).replace(":", " ").split()
        self.frame_time = float(numbers[4])
        channels = sum(len(joint[3] or ()) for joint in self.joints)
        self.values = np.array(numbers[5:], float).reshape(-1, channels)
        self.moving = [j for j, joint in enumerate(self.joints) if joint[3]]
        self.read_channels()

    def read_channels(self):
        frames = len(self.values)
        self.rotations = np.zeros((frames, len(self.joints), 3, 3)) + np.eye(3)
        self.places = np.zeros((frames, len(self.joints), 3))  # in the parent
        self.orders, at = {}, 0
        for j, (_, _, offset, channels) in enumerate(self.joints):
            self.places[:, j] = offset
            order = ""
            for channel in channels or ():
                column, axis = self.values[:, at], channel[0].upper()
                if channel.endswith("position"):
                    self.places[:, j, "XYZ".index(axis)] = column
                else:
                    self.rotations[:, j] = self.rotations[:, j] @ axis_matrix(axis, np.radians(column))
                    order += axis
                at += 1
            self.orders[j] = order

    def vectors(self):
        return log_so3(self.rotations)

    def carrier(self):
        """The joint whose place moves the body."""
        ranges = np.ptp(self.places, axis=0).sum(-1)
        return int(np.argmax(ranges[:3]))

    def world(self):
        """[frames x joints x 3]"""
        places, turns = np.empty_like(self.places), np.empty_like(self.rotations)
        for j, (_, parent, _, _) in enumerate(self.joints):
            if parent < 0:
                places[:, j], turns[:, j] = self.places[:, j], self.rotations[:, j]
            else:
                places[:, j] = places[:, parent] + np.einsum("fab,fb->fa", turns[:, parent], self.places[:, j])
                turns[:, j] = turns[:, parent] @ self.rotations[:, j]
        return places

    def resample(self, frames):
        """Keeps the motion at these frames, which may lie between two: cubic through the four around it."""
        first = np.floor(frames).astype(int)
        t = (frames - first)[:, None]
        weights = np.concatenate([-t + 2 * t**2 - t**3, 2 - 5 * t**2 + 3 * t**3, t + 4 * t**2 - 3 * t**3, t**3 - t**2], 1) / 2
        around = np.clip(first[:, None] + np.arange(-1, 3), 0, len(self.places) - 1)
        self.places = np.einsum("fk,fkja->fja", weights, self.places[around])
        u, _, v = np.linalg.svd(np.einsum("fk,fkjab->fjab", weights, self.rotations[around]))
        self.rotations = u @ v

    def write(self, path):
        moves = {j for j in self.moving if np.ptp(self.places[:, j], axis=0).max() > 1e-9 or j == self.moving[0]}
        children = {j: [k for k, joint in enumerate(self.joints) if joint[1] == j] for j in range(-1, len(self.joints))}
        lines, columns = ["HIERARCHY"], []

        def put(j, depth):
            name, parent, offset, channels = self.joints[j]
            pad = "\t" * depth
            lines.append(pad + ("End Site" if channels is None else f"{'ROOT' if parent < 0 else 'JOINT'} {name}"))
            lines.append(pad + "{")
            lines.append(pad + "\tOFFSET " + " ".join(f"{v:.6f}" for v in offset))
            if channels is not None:
                order = self.orders[j] or "ZXY"
                named = [f"{axis}position" for axis in "XYZ"] if j in moves else []
                named += [f"{axis}rotation" for axis in order]
                lines.append(f"{pad}\tCHANNELS {len(named)} " + " ".join(named))
                if j in moves:
                    columns.append(self.places[:, j])
                columns.append(np.degrees(euler_of(self.rotations[:, j], order)))
            for child in children[j]:
                put(child, depth + 1)
            lines.append(pad + "}")

        put(0, 0)
        lines += ["MOTION", f"Frames: {len(self.places)}", f"Frame Time: {self.frame_time:.8f}"]
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")
            np.savetxt(file, np.concatenate(columns, 1), fmt="%.6f")
