#!/usr/bin/env python3
"""Reads .anim, .model, .cam and .steps files by the letter of the SPEC.md pages under formats/, with nothing
but Python's standard library, and prints each as a line of JSON. It shares no code with Krok, so the
tests hold the two against each other. The checksum is not verified, as the pages allow.

    read_krok_files.py FILE...
"""

import json
import math
import struct
import sys


class Invalid(Exception):
    """The file breaks a rule of the specification."""


def require(holds, message):
    if not holds:
        raise Invalid(message)


class Container:
    """Header and section table, formats/container/SPEC.md."""

    def __init__(self, data):
        self.data = data
        require(len(data) >= 64, "shorter than a header")
        (self.magic, self.version, self.flags, size, self.checksum, count) = struct.unpack_from(
            "<8sIIQQI", data, 0)
        require(self.version == 1, "version is not 1")
        require(size == len(data), "size differs from the header's")
        known = 3 if self.magic == b"KROKANIM" else 1
        require(self.flags & ~known == 0, "unknown flags")
        require(count <= 64 and 64 + 32 * count <= len(data), "too many sections")
        self.four_components = self.flags & 1 != 0
        self.record_size = 28 if self.four_components else 24
        self.sections = {}
        free = 64 + 32 * count
        for i in range(count):
            name, offset, length, _ = struct.unpack_from("<8sQQQ", data, 64 + 32 * i)
            name = name.rstrip(b"\0").decode("ascii")
            require(name not in self.sections, "a section twice")
            require(offset % 64 == 0, "a section is not aligned")
            require(offset >= free and offset + length <= len(data), "a section out of place")
            require(not any(data[free:offset]), "filling is not zero")
            free = offset + length
            self.sections[name] = data[offset:offset + length]

    def section(self, name, size=None):
        require(name in self.sections, "no section " + name)
        require(size is None or len(self.sections[name]) == size, "wrong size of " + name)
        return self.sections[name]

    def numbers(self, name, code, width, count):
        """A section of `count` tuples of `width` numbers of one type."""
        size = struct.calcsize("<" + code) * width * count
        values = struct.unpack("<%d%s" % (width * count, code), self.section(name, size))
        return [list(values[i * width:(i + 1) * width]) for i in range(count)]

    def optional_numbers(self, name, code, width, count):
        return self.numbers(name, code, width, count) if name in self.sections else None

    def texts(self, name, count):
        parts = self.section(name).split(b"\0")
        require(len(parts) == count + 1 and parts[-1] == b"", "wrong number of texts in " + name)
        return [part.decode("utf-8") for part in parts[:-1]]

    def record(self, data, offset):
        """A transform record: position, and orientation as x, y, z, w."""
        values = struct.unpack_from("<%df" % (self.record_size // 4), data, offset)
        require(all(math.isfinite(value) for value in values), "a value is not finite")
        position, orientation = values[:3], values[3:]
        if not self.four_components:
            x, y, z = orientation
            w = 1 - x * x - y * y - z * z
            w = 0.0 if w < 0 else -math.sqrt(w)
            orientation = (x, y, z, w)
        length = math.sqrt(sum(value * value for value in orientation))
        require(abs(length - 1) <= 1e-3, "an orientation is no rotation")
        return {"position": list(position), "orientation": list(orientation)}

    def records(self, name, count):
        data = self.section(name, count * self.record_size)
        return [self.record(data, i * self.record_size) for i in range(count)]

    def skeleton(self, count):
        require(1 <= count <= 65535, "impossible number of joints")
        joints = self.section("JOINTS", 8 * count)
        names = self.texts("NAMES", count)
        require(all(names) and len(set(names)) == count, "names empty or not unique")
        skeleton = []
        for i, reference in enumerate(self.records("REFPOSE", count)):
            parent, flags = struct.unpack_from("<iI", joints, 8 * i)
            require(parent == -1 if i == 0 else 0 <= parent < i, "parent out of order")
            require(flags & ~1 == 0, "unknown flags of a joint")
            skeleton.append({"name": names[i], "parent": parent, "end_site": flags & 1 == 1,
                             "reference": reference})
        return skeleton

    def provenance(self):
        text = self.sections.get("META", b"")
        return json.loads(text.decode("utf-8")) if text else None


def read_anim(container):
    rate, frames, joints, _ = struct.unpack("<dQII", container.section("INFO", 24))
    require(math.isfinite(rate) and rate > 0, "impossible rate")
    skeleton = container.skeleton(joints)
    records = container.records("FRAMES", frames * joints)
    stretched = stretches = None
    if container.flags & 2:
        count = len(container.section("SJOINTS")) // 4
        stretched = [row[0] for row in container.numbers("SJOINTS", "I", 1, count)]
        require(all(a < b for a, b in zip(stretched, stretched[1:] + [joints])), "SJOINTS")
        rows = container.numbers("STRETCH", "f", 6, frames * count)
        require(all(math.isfinite(value) for row in rows for value in row), "a stretch")
        stretches = [rows[i * count:(i + 1) * count] for i in range(frames)]
    return {"kind": "anim", "rate": rate, "skeleton": skeleton,
            "frames": [records[i * joints:(i + 1) * joints] for i in range(frames)],
            "stretched_joints": stretched, "stretches": stretches}


def read_model(container):
    joints, vertices, triangles, parts, influences, _ = struct.unpack(
        "<6I", container.section("INFO", 24))
    require(1 <= influences <= 8, "impossible number of influences")
    skeleton = container.skeleton(joints)
    names = container.texts("PARTNAME", 2 * parts)
    meshes = (container.texts("MESHNAME", parts) if "MESHNAME" in container.sections
              else [""] * parts)
    ranges = container.numbers("PARTS", "I", 2, parts)
    next_triangle = 0
    for first, count in ranges:
        require(first == next_triangle, "a gap between parts")
        next_triangle += count
    require(next_triangle == triangles, "parts do not cover the triangles")
    bound = container.numbers("VJOINTS", "H", influences, vertices)
    weights = container.numbers("VWEIGHTS", "f", influences, vertices)
    require(all(joint < joints for row in bound for joint in row), "a joint out of range")
    require(all(abs(sum(row) - 1) <= 1e-4 and min(row) >= 0 for row in weights), "weights")
    corners = container.numbers("TRIANGLE", "I", 3, triangles)
    require(all(vertex < vertices for row in corners for vertex in row), "a vertex out of range")
    further = []
    if "TEXMORE" in container.sections:
        size = len(container.sections["TEXMORE"])
        require(size % (8 * vertices) == 0 and 1 <= size // (8 * vertices) <= 7, "TEXMORE")
        further = container.numbers("TEXMORE", "f", 2, size // 8)
    return {"kind": "model", "skeleton": skeleton,
            "positions": container.numbers("POSITION", "f", 3, vertices),
            "normals": container.optional_numbers("NORMAL", "f", 3, vertices),
            "texture_coordinates": container.optional_numbers("TEXCOORD", "f", 2, vertices),
            "more_texture_coordinates": [
                further[i * vertices:(i + 1) * vertices] for i in range(len(further) // vertices)],
            "tangents": container.optional_numbers("TANGENT", "f", 4, vertices),
            "colours": container.optional_numbers("COLOUR", "f", 4, vertices),
            "joints": bound, "weights": weights, "triangles": corners,
            "parts": [{"name": names[2 * i], "material": names[2 * i + 1],
                       "first_triangle": ranges[i][0], "triangle_count": ranges[i][1],
                       "mesh": meshes[i]}
                      for i in range(parts)]}


def read_cam(container):
    rate, frames = struct.unpack("<dQ", container.section("INFO", 16))
    require(math.isfinite(rate) and rate > 0, "impossible rate")
    size = container.record_size + 4
    data = container.section("FRAMES", frames * size)
    result = []
    for i in range(frames):
        frame = container.record(data, i * size)
        (frame["field_of_view"],) = struct.unpack_from("<f", data, (i + 1) * size - 4)
        require(0 < frame["field_of_view"] < math.pi, "impossible field of view")
        result.append(frame)
    return {"kind": "cam", "rate": rate, "frames": result}


def kernel(number, t):
    """The radial functions of formats/steps/SPEC.md."""
    if number == 0:
        return t ** 3
    if number == 1:
        return t
    if number == 2:
        return math.exp(-4 * t * t)
    if number == 3:
        return 1 - 6 * t * t * (1 - t) if t <= 0.5 else 2 * max(0, 1 - t) ** 3
    return max(0, 1 - t) ** 4 * (4 * t + 1)


def read_weights(container, dimensions, examples):
    if "WEIGHTS" not in container.sections:
        return None
    number, _, centres = struct.unpack("<IIQ", container.section("WEIGHTS", 16))
    require(number <= 4 and centres >= examples, "impossible weights")
    lower, upper = container.numbers("RANGES", "d", dimensions, 2)
    points = container.numbers("CENTRES", "d", dimensions, centres)
    radii = [1.0] * centres
    if number >= 2:
        radii = [row[0] for row in container.numbers("RADII", "d", 1, centres)]
    if "SMOOTH" in container.sections:
        ((smoothing,),) = container.numbers("SMOOTH", "d", 1, 1)
        require(smoothing >= 0, "impossible smoothing")
    container.numbers("INSERTED", "d", examples, centres - examples)
    affine = container.numbers("AFFINE", "d", examples, dimensions + 1)
    coefficients = container.numbers("COEFFS", "d", examples, centres)

    def scaled(point):
        return [(p - low) / (high - low) for p, low, high in zip(point, lower, upper)]

    def weights_at(point):
        q = scaled(point)
        values = [kernel(number, math.dist(q, scaled(c)) / r) for c, r in zip(points, radii)]
        return [sum(a[i] * f for a, f in zip(affine, [1.0] + q)) +
                sum(c[i] * v for c, v in zip(coefficients, values)) for i in range(examples)]

    return {"kernel": number, "coefficients": [c for row in coefficients for c in row],
            "at_centres": [weights_at(point) for point in points]}


def read_steps(container):
    rate, joints, keytimes, parameters, examples, swing, _ = struct.unpack(
        "<dIIIIII", container.section("INFO", 32))
    require(keytimes >= 2 and parameters >= 1 and examples >= 1 and swing <= 1, "impossible counts")
    feet = [{"joint": foot[0], "heel": list(foot[2:5]), "forward": list(foot[5:8]),
             "length": foot[8]}
            for foot in struct.iter_unpack("<iI7d", container.section("FEET", 128))]
    measured = [dict(zip(("quantity", "keytime", "joint", "direction", "tolerance"), record))
                for record in struct.iter_unpack("<IiiId", container.section("PARAMS",
                                                                             24 * parameters))]
    names = container.texts("EXNAMES", examples)
    times = container.numbers("KEYTIMES", "d", keytimes, examples)
    values = container.numbers("MEASURED", "d", parameters, examples)
    heads = list(struct.iter_unpack("<dIIII", container.section("EXAMPLES", 24 * examples)))
    frames = container.records("FRAMES", joints * sum(head[1] for head in heads))
    contacts = list(struct.iter_unpack(
        "<iI5d", container.section("CONTACTS", 48 * sum(head[2] for head in heads))))
    result = []
    for i, (own_rate, frame_count, contact_count, flags, _) in enumerate(heads):
        require(flags & ~1 == 0, "unknown flags of an example")
        own, frames = frames[:frame_count * joints], frames[frame_count * joints:]
        stays, contacts = contacts[:contact_count], contacts[contact_count:]
        result.append({
            "name": names[i], "rate": own_rate, "mirrored": flags & 1 == 1, "keytimes": times[i],
            "parameters": values[i],
            "frames": [own[f * joints:(f + 1) * joints] for f in range(frame_count)],
            "contacts": [{"joint": stay[0], "start": stay[2], "end": stay[3],
                          "place": list(stay[4:])} for stay in stays]})
    report = container.sections.get("REPORT", b"")
    return {"kind": "steps", "rate": rate, "swing": "right" if swing else "left",
            "skeleton": container.skeleton(joints), "feet": feet,
            "keytimes": container.texts("KEYNAMES", keytimes), "parameters": measured,
            "examples": result, "weights": read_weights(container, parameters, examples),
            "report": json.loads(report.decode("utf-8")) if report else None}


READERS = {b"KROKANIM": read_anim, b"KROKMODL": read_model, b"KROKCAMR": read_cam,
           b"KROKSTEP": read_steps}


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    require(data[:8] in READERS, "not one of Krok's files")
    container = Container(data)
    result = READERS[container.magic](container)
    result["provenance"] = container.provenance()
    return result


def main():
    if len(sys.argv) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    for path in sys.argv[1:]:
        try:
            print(json.dumps(read(path)))
        except (Invalid, OSError, UnicodeDecodeError, struct.error, ValueError) as error:
            print("%s: error: %s" % (path, error), file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
