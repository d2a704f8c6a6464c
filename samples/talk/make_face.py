"""Makes a face that can speak: face.gltf (neck and head joints, a mesh with shapes of mouth and lids, an
idle motion of 7 s) and eye.gltf (an eyeball that looks along +Z).

Usage: make_face.py [FOLDER]. Needs Python alone. All of it is made of formulas: an ellipsoid with a slit
for the mouth, bumps for nose and lips, and caps of spheres for lids.
"""

import base64
import json
import math
import pathlib
import struct
import sys

CENTRE = (0.0, 1.62, 0.0)
MOUTH, MOUTH_WIDTH = -0.046, 0.026
EYE, EYE_HEIGHT, EYE_RADIUS = 0.031, 0.020, 0.0125
COLOURS = {"Skin": (0.72, 0.45, 0.34), "Lips": (0.55, 0.16, 0.15), "Inside": (0.05, 0.01, 0.01),
           "White": (0.9, 0.9, 0.88), "Iris": (0.08, 0.2, 0.35), "Pupil": (0.01, 0.01, 0.01)}


def bump(x, y, width, height):
    return math.exp(-((x / width) ** 2 + (y / height) ** 2))


def depth(x, y):
    """The front of the face at x, y."""
    inside = 1 - (x / 0.078) ** 2 - (y / 0.118) ** 2
    z = 0.092 * math.sqrt(max(inside, 0.0))
    z += 0.020 * bump(x, y + 0.012, 0.011, 0.020) + 0.008 * bump(x, y - 0.01, 0.006, 0.02)
    z += 0.006 * bump(x, y - MOUTH, 0.028, 0.011) + 0.006 * bump(x, y + 0.088, 0.02, 0.014)
    for side in (-1, 1):
        z -= 0.016 * math.exp(-(math.hypot(x - side * EYE, y - EYE_HEIGHT) / 0.0165) ** 4)
        z += 0.005 * bump(x - side * 0.028, y - 0.042, 0.022, 0.007)
    return z


class Mesh:
    def __init__(self, names):
        self.points, self.names, self.shapes, self.faces = [], names, {n: {} for n in names}, {}

    def add(self, point, **moves):
        self.points.append(point)
        for name, move in moves.items():
            if any(abs(v) > 1e-6 for v in move):
                self.shapes[name][len(self.points) - 1] = move
        return len(self.points) - 1

    def quad(self, material, a, b, c, d):
        faces = self.faces.setdefault(material, [])
        for face in ((a, b, c), (a, c, d)):
            if len(set(face)) == 3:
                faces.append(face)


def mouth_moves(x, y, lip):
    """How a point moves in the shapes of the mouth; lip: +1 upper, -1 lower, of points at the slit."""
    near = bump(x, y - MOUTH, 0.034, 0.020)
    slit = max(0.0, 1 - (x / MOUTH_WIDTH) ** 2)
    upper = lip > 0 or (lip == 0 and y > MOUTH)
    below = 0.0 if upper else bump(x, (y - MOUTH + 0.03) * (y < MOUTH - 0.03), 0.045, 0.05)
    arch = math.sqrt(slit) if abs(y - MOUTH) < 0.03 else math.sqrt(max(0.0, 1 - (x / 0.05) ** 2))
    rest = 0.0012 * slit * (1 if upper else -1)  # the lips are a little apart at rest
    fade = math.exp(-abs(y - MOUTH) / 0.012)
    return {
        "jaw": (0, 0.002 * slit * fade if upper else -0.021 * below * arch, 0 if upper else -0.006 * below),
        "wide": (0.22 * x * near, 0.0, -0.004 * near * abs(x) / 0.03),
        "round": (-0.42 * x * near, (0.004 if upper else -0.005) * slit * near, 0.011 * near),
        "press": (0, -rest * fade, -0.0035 * bump(x, y - MOUTH, 0.03, 0.006)),
        "bite": (0, (0.002 if upper else 0.0025) * slit * fade, 0 if upper else -0.006 * slit * fade),
        "smile": (0.25 * x * near, 0.010 * (abs(x) / 0.03) ** 2 * near, -0.003 * near),
    }, rest * fade


def skin(mesh):
    columns = [0.0715 * math.copysign(abs(i / 26) ** 1.15, i) for i in range(-26, 27)]
    columns = sorted({round(c, 6) for c in columns} | {-MOUTH_WIDTH, MOUTH_WIDTH})
    above = [MOUTH + 0.15 * (i / 30) ** 1.25 for i in range(1, 31)]
    under = [MOUTH - 0.068 * (i / 18) ** 1.3 for i in range(1, 19)]
    grid = {}

    def vertex(x, y, lip):
        scale = math.hypot(x / 0.078, y / 0.118)
        if scale > 0.999:  # the outline, a little behind
            x, y = x / scale * 0.999, y / scale * 0.999
        moves, rest = mouth_moves(x, y, lip)
        z = depth(x, y) - (0.0 if lip == 0 else 0.0015)
        return mesh.add((x, y + rest, z), **moves)

    rows = sorted(above + [MOUTH] + under)
    for r, y in enumerate(rows):
        for c, x in enumerate(columns):
            slit = y == MOUTH and abs(x) < MOUTH_WIDTH - 1e-9
            grid[r, c, 1] = vertex(x, y, 1 if slit else 0)
            grid[r, c, -1] = vertex(x, y, -1) if slit else grid[r, c, 1]
    for r in range(len(rows) - 1):
        for c in range(len(columns) - 1):
            middle = 0.5 * (columns[c] + columns[c + 1])
            height = 0.5 * (rows[r] + rows[r + 1]) - MOUTH
            reach = max(0.0, 1 - (middle / (MOUTH_WIDTH + 0.002)) ** 2)
            lips = abs(height) < (0.006 if height > 0 else 0.0075) * math.sqrt(reach)
            mesh.quad("Lips" if lips else "Skin", grid[r, c, 1], grid[r, c + 1, 1],
                      grid[r + 1, c + 1, -1], grid[r + 1, c, -1])


def inside_of_mouth(mesh):
    corners = []
    for y, width in ((MOUTH + 0.012, 0.045), (MOUTH - 0.030, 0.030)):
        for x in (-width, width):
            corners.append(mesh.add((x, y, 0.05)))
    mesh.quad("Inside", corners[2], corners[3], corners[1], corners[0])


def lids(mesh):
    radius = EYE_RADIUS * 1.1
    for side in (-1, 1):
        centre = (side * EYE, EYE_HEIGHT, depth(side * EYE, EYE_HEIGHT) - 0.001)
        for first, last, shut in ((28, 115, -17), (-28, -115, -13)):
            grid = []
            for i in range(9):
                row = []
                for j in range(17):
                    yaw = math.radians(-100 + 200 * j / 16)

                    def place(angle):
                        pitch = math.radians(angle) * (0.35 + 0.65 * math.cos(yaw / 1.6))
                        return tuple(c + radius * v for c, v in zip(centre, (
                            math.sin(yaw) * math.cos(pitch), math.sin(pitch),
                            math.cos(yaw) * math.cos(pitch))))
                    share = i / 8
                    rest = place(first + (last - first) * share)
                    closed = place(shut + (last - shut) * share)
                    row.append(mesh.add(rest, blink=tuple(b - a for a, b in zip(rest, closed))))
                grid.append(row)
            for i in range(8):
                for j in range(16):
                    quad = (grid[i][j], grid[i][j + 1], grid[i + 1][j + 1], grid[i + 1][j])
                    mesh.quad("Skin", *(quad if first > 0 else quad[::-1]))


class Gltf:
    def __init__(self):
        self.bytes = b""
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "accessors": [],
                     "bufferViews": [], "materials": []}

    def accessor(self, rows, kind, code, bounds=False):
        size = len(rows[0])
        data = struct.pack(f"<{len(rows) * size}{code}", *(v for row in rows for v in row))
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)})
        self.bytes += data + b"\0" * (-len(data) % 4)
        made = {"bufferView": len(self.json["bufferViews"]) - 1, "count": len(rows), "type": kind,
                "componentType": {"f": 5126, "H": 5123, "B": 5121}[code]}
        if bounds:
            single = [struct.unpack("<f", struct.pack("<f", v))[0] for row in rows for v in row]
            made["min"] = [min(single[i::size]) for i in range(size)]
            made["max"] = [max(single[i::size]) for i in range(size)]
        self.json["accessors"].append(made)
        return len(self.json["accessors"]) - 1

    def primitives(self, mesh, attributes, targets):
        made = []
        for name, faces in mesh.faces.items():
            self.json["materials"].append({"name": name, "pbrMetallicRoughness": {
                "baseColorFactor": [*COLOURS[name], 1], "metallicFactor": 0, "roughnessFactor": 0.6}})
            made.append({"attributes": attributes, "material": len(self.json["materials"]) - 1,
                         "indices": self.accessor([(i,) for face in faces for i in face], "SCALAR", "H")})
            if targets:
                made[-1]["targets"] = targets
        return made

    def write(self, path):
        data = base64.b64encode(self.bytes).decode()
        self.json["buffers"] = [{"byteLength": len(self.bytes),
                                 "uri": "data:application/octet-stream;base64," + data}]
        path.write_text(json.dumps(self.json))


def normals_of(mesh):
    sums = [[0.0] * 3 for _ in mesh.points]
    for faces in mesh.faces.values():
        for face in faces:
            a, b, c = (mesh.points[i] for i in face)
            u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
            n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            for i in face:
                sums[i] = [s + m for s, m in zip(sums[i], n)]
    return [tuple(v / (math.hypot(*n) or 1) for v in (n if math.hypot(*n) else (0, 0, 1))) for n in sums]


def quaternion(yaw, pitch, roll):
    """About y, then x, then z, degrees."""
    cy, cp, cr = (math.cos(math.radians(a) / 2) for a in (yaw, pitch, roll))
    sy, sp, sr = (math.sin(math.radians(a) / 2) for a in (yaw, pitch, roll))
    return (cy * sp * cr + sy * cp * sr, sy * cp * cr - cy * sp * sr,
            cy * cp * sr - sy * sp * cr, cy * cp * cr + sy * sp * sr)


def face(path):
    mesh = Mesh(["jaw", "wide", "round", "press", "bite", "smile", "blink"])
    skin(mesh)
    inside_of_mouth(mesh)
    lids(mesh)
    mesh.points = [tuple(c + v for c, v in zip(CENTRE, p)) for p in mesh.points]
    gltf = Gltf()
    joints = [("Hips", 0.95), ("Spine", 0.4), ("Neck", 0.15), ("Head", 0.06)]
    nodes = [{"name": n, "translation": [0, up, 0], "children": [i + 1]} for i, (n, up) in enumerate(joints)]
    nodes[-1]["children"] = []
    nodes.append({"name": "face", "mesh": 0, "skin": 0})
    heights = [sum(up for _, up in joints[:i + 1]) for i in range(4)]
    count = len(mesh.points)
    attributes = {"POSITION": gltf.accessor(mesh.points, "VEC3", "f", True),
                  "NORMAL": gltf.accessor(normals_of(mesh), "VEC3", "f"),
                  "JOINTS_0": gltf.accessor([(3, 0, 0, 0)] * count, "VEC4", "B"),
                  "WEIGHTS_0": gltf.accessor([(1, 0, 0, 0)] * count, "VEC4", "f")}
    targets = [{"POSITION": gltf.accessor([mesh.shapes[n].get(i, (0, 0, 0)) for i in range(count)],
                                          "VEC3", "f", True)} for n in mesh.names]
    binds = [(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -h, 0, 1) for h in heights]
    times = [i / 30 for i in range(211)]
    turns = [quaternion(3 * math.sin(1.3 * t), 2 * math.sin(2.1 * t), 1.5 * math.sin(0.9 * t)) for t in times]
    gltf.json |= {
        "scenes": [{"nodes": [0, 4]}], "nodes": nodes,
        "skins": [{"joints": [0, 1, 2, 3], "inverseBindMatrices": gltf.accessor(binds, "MAT4", "f")}],
        "meshes": [{"primitives": gltf.primitives(mesh, attributes, targets),
                    "extras": {"targetNames": mesh.names}}],
        "animations": [{"name": "idle", "channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}],
                        "samplers": [{"input": gltf.accessor([(t,) for t in times], "SCALAR", "f", True),
                                      "output": gltf.accessor(turns, "VEC4", "f")}]}]}
    gltf.write(path)


def eye(path):
    mesh = Mesh([])
    rings, sectors = 40, 32
    grid = [[mesh.add(tuple(EYE_RADIUS * v for v in (math.sin(a) * math.cos(b), math.sin(a) * math.sin(b),
                                                     math.cos(a))))
             for b in (2 * math.pi * j / sectors for j in range(sectors))]
            for a in (math.pi * i / rings for i in range(rings + 1))]
    for i in range(rings):
        material = "Pupil" if i < 3 else "Iris" if i < 6 else "White"
        for j in range(sectors):
            k = (j + 1) % sectors
            mesh.quad(material, grid[i][j], grid[i + 1][j], grid[i + 1][k], grid[i][k])
    gltf = Gltf()
    normals = [tuple(v / EYE_RADIUS for v in p) for p in mesh.points]
    attributes = {"POSITION": gltf.accessor(mesh.points, "VEC3", "f", True),
                  "NORMAL": gltf.accessor(normals, "VEC3", "f")}
    gltf.json |= {"nodes": [{"name": "eye", "mesh": 0}],
                  "meshes": [{"primitives": gltf.primitives(mesh, attributes, [])}]}
    gltf.write(path)


folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
face(folder / "face.gltf")
eye(folder / "eye.gltf")
