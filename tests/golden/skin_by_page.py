#!/usr/bin/env python3
"""Skins a .model by a .anim by the formulas of formats/model/SPEC.md, with nothing but Python's standard
library, and prints as JSON, for each method and frame, the position and normal of each vertex. It shares
no code with Krok, so the tests hold the two against each other. Mirrored joints are not supported.

    skin_by_page.py MODEL ANIM
"""

import json
import math
import sys

import read_krok_files


def product(a, b):
    """Of two matrices, lists of rows."""
    return [[sum(x * y for x, y in zip(row, column)) for column in zip(*b)] for row in a]


def transposed(a):
    return [list(column) for column in zip(*a)]


def times(a, v):
    return [sum(x * y for x, y in zip(row, v)) for row in a]


def plus(a, b, factor=1.0):
    return [x + factor * y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def inverse_transpose(a):
    cofactors = [cross(a[1], a[2]), cross(a[2], a[0]), cross(a[0], a[1])]
    determinant = sum(x * y for x, y in zip(a[0], cofactors[0]))
    return [[x / determinant for x in row] for row in cofactors]


def rotation(q):
    x, y, z, w = unit(q)
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]


def nearest_rotation(a):
    """The rotation of the polar decomposition, by Newton's iteration (Higham 1986)."""
    for _ in range(60):
        a = [[(x + y) / 2 for x, y in zip(*rows)] for rows in zip(a, inverse_transpose(a))]
    return a


def quaternion(r):
    """x, y, z, w of a rotation matrix, from its largest component."""
    trace = r[0][0] + r[1][1] + r[2][2]
    squares = [1 + 2 * r[i][i] - trace for i in range(3)] + [1 + trace]
    k = max(range(4), key=lambda i: squares[i])
    if k == 3:
        q = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1], squares[3]]
    else:
        i, j = (k + 1) % 3, (k + 2) % 3
        q = [0.0, 0.0, 0.0, r[j][i] - r[i][j]]
        q[k], q[i], q[j] = squares[k], r[k][i] + r[i][k], r[k][j] + r[j][k]
    return unit(q)


def multiplied(a, b):
    """Of two quaternions."""
    v = cross(a, b)
    return [a[3] * b[i] + b[3] * a[i] + v[i] for i in range(3)] + \
        [a[3] * b[3] - sum(a[i] * b[i] for i in range(3))]


def conjugate(q):
    return [-q[0], -q[1], -q[2], q[3]]


def skinning_transforms(model, anim, frame):
    """For each joint of the model A, b and its position in the reference pose."""
    places = {joint["name"]: i for i, joint in enumerate(anim["skeleton"])}
    result = []
    for joint in model["skeleton"]:
        index = places[joint["name"]]
        record, reference = anim["frames"][frame][index], joint["reference"]
        u = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        if anim["stretches"] and index in anim["stretched_joints"]:
            xx, yy, zz, xy, xz, yz = anim["stretches"][frame][anim["stretched_joints"].index(index)]
            u = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
        a = product(product(rotation(record["orientation"]), u),
                    transposed(rotation(reference["orientation"])))
        result.append((a, plus(record["position"], times(a, reference["position"]), -1),
                       reference["position"]))
    return result


def turn_of_normals(a, stretched):
    return inverse_transpose(a) if stretched else a


def linear(influences, p, n, stretched):
    a = [[sum(w * m[r][c] for w, (m, _, _) in influences) for c in range(3)] for r in range(3)]
    b = [sum(w * t[i] for w, (_, t, _) in influences) for i in range(3)]
    return plus(times(a, p), b), unit(times(turn_of_normals(a, stretched), n))


def rigid(influences, p, n, stretched):
    a, b, _ = max(influences, key=lambda influence: influence[0])[1]
    return plus(times(a, p), b), unit(times(turn_of_normals(a, stretched), n))


def dual_quaternion(influences, p, n, stretched):
    deformed, q, d = [0.0] * 3, [0.0] * 4, [0.0] * 4
    s_sum = [[0.0] * 3 for _ in range(3)]
    first = None
    for w, (a, b, c) in influences:
        r = nearest_rotation(a)
        s = product(transposed(r), a)
        deformed = plus(deformed, plus(times(s, plus(p, c, -1)), c), w)
        s_sum = [plus(row, one, w) for row, one in zip(s_sum, s)]
        moved = plus(plus(times(a, c), b), times(r, c), -1)
        turn = quaternion(r)
        dual = [x / 2 for x in multiplied(moved + [0.0], turn)]
        first = first or turn
        sign = -1 if sum(x * y for x, y in zip(turn, first)) < 0 else 1
        q, d = plus(q, turn, sign * w), plus(d, dual, sign * w)
    length = math.sqrt(sum(x * x for x in q))
    q, d = [x / length for x in q], [x / length for x in d]

    def turned(v):
        return multiplied(multiplied(q, v + [0.0]), conjugate(q))[:3]

    offset = [2 * x for x in multiplied(d, conjugate(q))[:3]]
    return plus(turned(deformed), offset), unit(turned(times(turn_of_normals(s_sum, stretched), n)))


METHODS = {"linear": linear, "rigid": rigid, "dual-quaternion": dual_quaternion}


def skinned(model, anim, frame, method):
    transforms = skinning_transforms(model, anim, frame)
    stretched = anim["stretches"] is not None and any(
        row != [1, 1, 1, 0, 0, 0] for row in anim["stretches"][frame])
    vertices = []
    for v, p in enumerate(model["positions"]):
        influences = [(w, transforms[j]) for w, j in zip(model["weights"][v], model["joints"][v])
                      if w > 0]
        vertices.append(method(influences, p, model["normals"][v], stretched))
    return vertices


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    model, anim = read_krok_files.read(sys.argv[1]), read_krok_files.read(sys.argv[2])
    print(json.dumps({name: [skinned(model, anim, frame, method)
                             for frame in range(len(anim["frames"]))]
                      for name, method in METHODS.items()}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
