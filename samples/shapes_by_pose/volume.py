#!/usr/bin/env python3
"""Volume of the part of a mesh around a joint, in litres, in each of several shapes.

Usage: volume.py X Y Z RADIUS REST.obj SHAPE.obj...

The part is the triangles whose middle in REST is within RADIUS of the point (metres), closed by a fan
from the middle of each boundary. Prints a line for each shape: its name, the volume, and the percentage
of the volume in REST that is missing.
"""
import sys


def read(path):
    vertices, triangles = [], []
    for line in open(path, encoding="utf-8"):
        words = line.split()
        if words and words[0] == "v":
            vertices.append(tuple(map(float, words[1:4])))
        elif words and words[0] == "f":
            triangles.append(tuple(int(word.split("/")[0]) - 1 for word in words[1:4]))
    return vertices, triangles


def loops_of(triangles):
    """The boundaries, each a list of vertices, such that fans over them close the surface."""
    edges = {(t[i], t[(i + 1) % 3]) for t in triangles for i in range(3)}
    after = {b: a for a, b in edges if (b, a) not in edges}
    loops = []
    while after:
        loop = [next(iter(after))]
        while loop[-1] in after:
            loop.append(after.pop(loop[-1]))
        loops.append(loop[:-1])
    return loops


def volume(vertices, triangles, loops):
    base = vertices[triangles[0][0]]
    total = 0

    def add(a, b, c):
        a, b, c = ([p - q for p, q in zip(x, base)] for x in (a, b, c))
        return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6

    for a, b, c in triangles:
        total += add(vertices[a], vertices[b], vertices[c])
    for loop in loops:
        middle = [sum(vertices[v][i] for v in loop) / len(loop) for i in range(3)]
        for a, b in zip(loop, loop[1:] + loop[:1]):
            total += add(vertices[a], vertices[b], middle)
    return 1000 * total


def main():
    place, radius = list(map(float, sys.argv[1:4])), float(sys.argv[4])
    rest, triangles = read(sys.argv[5])

    def near(triangle):
        return sum((sum(rest[v][i] for v in triangle) / 3 - place[i]) ** 2
                   for i in range(3)) < radius ** 2

    part = [t for t in triangles if near(t)]
    loops = loops_of(part)
    before = volume(rest, part, loops)
    for path in sys.argv[5:]:
        now = volume(read(path)[0], part, loops)
        print(f"{path} {now:.4f} {100 * (before - now) / before:.1f}")


if __name__ == "__main__":
    main()
