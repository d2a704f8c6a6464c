#!/usr/bin/env python3
"""Makes an animated PNG of the cells of a contact sheet, for pages that show images alone.

Usage: animate_sheet.py SHEET.png CELLS FPS OUT.png
The sheet is one row of krok-plot --sheet with that many --moments. Each image stores the rectangle in
which it differs from the one before.
"""
import pathlib
import struct
import sys
import zlib

LEFT, RIGHT = 62, 16  # pixels beside the cells
TOP, BOTTOM = 40, 50  # above them, and for the captions below


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def rows_of(png):
    """(width, rows of RGB bytes) of a PNG with 8 bits per channel that is not interlaced."""
    width, height, depth, colour = struct.unpack(">IIBB", png[16:26])
    assert (depth, colour) == (8, 2), "expected 8-bit RGB"
    data, at = b"", 8
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        if kind == b"IDAT":
            data += png[at + 8:at + 8 + length]
        at += length + 12
    data = zlib.decompress(data)
    rows, above = [], bytearray(3 * width)
    for y in range(height):
        start = y * (3 * width + 1)
        method, row = data[start], bytearray(data[start + 1:start + 1 + 3 * width])
        for i in range(3 * width):
            a = row[i - 3] if i >= 3 else 0
            b = above[i]
            c = above[i - 3] if i >= 3 else 0
            if method == 1:
                row[i] = row[i] + a & 255
            elif method == 2:
                row[i] = row[i] + b & 255
            elif method == 3:
                row[i] = row[i] + (a + b) // 2 & 255
            elif method == 4:
                p = a + b - c
                near = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))
                row[i] = row[i] + near[2] & 255
        rows.append(bytes(row))
        above = row
    return width, rows


def changed(before, image):
    """(left, top, right, bottom) of what differs, in pixels; one pixel if nothing does."""
    at = [y for y, (a, b) in enumerate(zip(before, image)) if a != b]
    if not at:
        return 0, 0, 1, 1
    columns = [i // 3 for y in at for i, (a, b) in enumerate(zip(before[y], image[y])) if a != b]
    return min(columns), at[0], max(columns) + 1, at[-1] + 1


def main():
    sheet, cells, fps, out = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
    width, rows = rows_of(pathlib.Path(sheet).read_bytes())
    rows = rows[TOP:len(rows) - BOTTOM]
    cell = (width - LEFT - RIGHT) // cells
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", cell, len(rows), 8, 2, 0, 0, 0))
    png += chunk(b"acTL", struct.pack(">II", cells, 0))  # plays for ever
    sequence, before = 0, None
    for i in range(cells):
        x = 3 * (LEFT + i * cell)
        image = [row[x:x + 3 * cell] for row in rows]
        left, top, right, bottom = changed(before, image) if before else (0, 0, cell, len(rows))
        before = image
        # Filter 2 stores the difference to the row above.
        data, above = b"", bytes(3 * (right - left))
        for row in image[top:bottom]:
            part = row[3 * left:3 * right]
            data += b"\x02" + bytes(p - q & 255 for p, q in zip(part, above))
            above = part
        data = zlib.compress(data, 9)
        png += chunk(b"fcTL", struct.pack(">IIIIIHHBB", sequence, right - left, bottom - top, left, top, 1, fps, 0, 0))
        sequence += 1
        if i == 0:
            png += chunk(b"IDAT", data)
        else:
            png += chunk(b"fdAT", struct.pack(">I", sequence) + data)
            sequence += 1
    pathlib.Path(out).write_bytes(png + chunk(b"IEND", b""))


if __name__ == "__main__":
    main()
