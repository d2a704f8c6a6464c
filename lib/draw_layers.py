#!/usr/bin/env python3
"""Draws lib/layers.svg: the libraries and which uses which, from the graph that CMake writes.

Usage: lib/draw_layers.py BUILD_FOLDER [--check]
--check: write nothing, exit 1 if lib/layers.svg is out of date.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

BOX_WIDTH, BOX_HEIGHT, GAP_X, GAP_Y, MARGIN = 120, 34, 24, 36, 12


def dependencies(build):
    """{library: set of libraries it links}, without the prefix krok_."""
    with tempfile.TemporaryDirectory() as folder:
        dot = pathlib.Path(folder) / "graph.dot"
        subprocess.run(["cmake", f"--graphviz={dot}", build], check=True, capture_output=True)
        text = dot.read_text()
    names = dict(re.findall(r'"(node\d+)" \[ label = "krok_(\w+)', text))
    with_alias = {node: name for node, name in names.items()
                  if re.search(rf'"{node}" \[ label = "krok_\w+\\n\(krok::', text)}
    edges = {name: set() for name in with_alias.values()}
    for a, b in re.findall(r'"(node\d+)" -> "(node\d+)"', text):
        if a in with_alias and b in with_alias:
            edges[with_alias[a]].add(with_alias[b])
    return edges


def reachable(edges, start):
    seen, todo = set(), list(edges[start])
    while todo:
        name = todo.pop()
        if name not in seen:
            seen.add(name)
            todo += edges[name]
    return seen


def reduced(edges):
    """Without the edges that follow from others."""
    return {a: {b for b in bs if not any(b in reachable(edges, other) for other in bs - {b})}
            for a, bs in edges.items()}


def draw(edges):
    depth = {}

    def depth_of(name):
        if name not in depth:
            depth[name] = 1 + max((depth_of(other) for other in edges[name]), default=-1)
        return depth[name]

    rows = {}
    for name in sorted(edges):
        rows.setdefault(depth_of(name), []).append(name)
    columns = max(map(len, rows.values()))
    width = 2 * MARGIN + columns * BOX_WIDTH + (columns - 1) * GAP_X
    height = 2 * MARGIN + len(rows) * BOX_HEIGHT + (len(rows) - 1) * GAP_Y
    at = {}
    for row, names in rows.items():
        left = (width - len(names) * BOX_WIDTH - (len(names) - 1) * GAP_X) / 2
        for column, name in enumerate(names):
            at[name] = (left + column * (BOX_WIDTH + GAP_X),
                        height - MARGIN - BOX_HEIGHT - row * (BOX_HEIGHT + GAP_Y))
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
             f'width="{width}" height="{height}" font-family="sans-serif" font-size="14">',
             '<defs><marker id="arrow" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" '
             'markerHeight="7" orient="auto"><path d="M0 0L8 4L0 8z" fill="#555"/></marker></defs>',
             f'<rect width="{width}" height="{height}" fill="#fff"/>']
    for name in sorted(edges):
        for other in sorted(edges[name]):
            x0, y0 = at[name][0] + BOX_WIDTH / 2, at[name][1] + BOX_HEIGHT
            x1, y1 = at[other][0] + BOX_WIDTH / 2, at[other][1]
            lines.append(f'<path d="M{x0:g} {y0:g}C{x0:g} {y0 + GAP_Y:g} {x1:g} {y1 - GAP_Y:g} '
                         f'{x1:g} {y1:g}" fill="none" stroke="#555" marker-end="url(#arrow)"/>')
    for name, (x, y) in sorted(at.items()):
        lines.append(f'<rect x="{x:g}" y="{y:g}" width="{BOX_WIDTH}" height="{BOX_HEIGHT}" rx="5" '
                     f'fill="#e8eef6" stroke="#456"/><text x="{x + BOX_WIDTH / 2:g}" '
                     f'y="{y + BOX_HEIGHT / 2 + 5:g}" text-anchor="middle">{name}</text>')
    return "\n".join(lines + ["</svg>", ""])


def main():
    check = "--check" in sys.argv
    (build,) = (a for a in sys.argv[1:] if a != "--check")
    target = pathlib.Path(__file__).parent / "layers.svg"
    image = draw(reduced(dependencies(build)))
    if not check:
        target.write_text(image)
    elif not target.exists() or target.read_text() != image:
        sys.exit(f"{target} is out of date; run lib/draw_layers.py {build}")


if __name__ == "__main__":
    main()
