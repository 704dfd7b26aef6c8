"""Draws the images that the projectors of these scenes throw, and the marble slab: python3 slides.py, beside the scenes.

Nothing but the standard library, no chance: the same bytes every time.
"""

import math
import struct
import zlib


def write_png(name, size, colour):
    """A square image of 8 bits; `colour` takes the middle of a pixel, from -1 to 1, x to the right and y upwards."""
    middle = lambda i: (2 * i + 1) / size - 1
    rows = (b"\0" + bytes(c for x in range(size) for c in colour(middle(x), -middle(y))) for y in range(size))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    with open(name, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header))
        file.write(chunk(b"IDAT", zlib.compress(b"".join(rows), 9)) + chunk(b"IEND", b""))


GLASS = [(222, 38, 30), (28, 62, 190), (244, 178, 24), (20, 138, 70), (120, 34, 150), (236, 104, 20), (40, 150, 214)]
LEAD = (6, 6, 8)


def pane(x, y):
    """A rose window: rings of panes, each ring turned against the one inside it, lead between them."""
    r, turn = math.hypot(x, y), math.atan2(y, x) / math.tau
    rings = [(0.16, 1), (0.36, 6), (0.62, 12), (0.9, 18)]
    inner = 0.0
    for number, (outer, panes) in enumerate(rings):
        if r < outer:
            place = (turn + 0.5 * (number % 2) / panes) * panes % panes
            aside = abs(place - round(place)) / panes * math.tau * r if panes > 1 else 1.0
            lead = min(outer - r, aside, r - inner if number else 1.0)
            return LEAD if lead < 0.012 else GLASS[(int(place) * 3 + number * 2) % len(GLASS)]
        inner = outer
    corner = max(abs(x), abs(y)) < 0.97 and r > 0.93
    return GLASS[1] if corner else LEAD


def square(x, y):
    """Eight squares by eight."""
    return (255, 255, 255) if (math.floor(4 * x) + math.floor(4 * y)) % 2 else (0, 0, 0)


def corner(x, y):
    """A number from 0 to 1 for each corner of a lattice that repeats every 64: two rounds of an integer hash."""
    h = (x % 64 * 374761393 + y % 64 * 668265263) & 0xFFFFFFFF
    for _ in range(2):
        h = ((h ^ (h >> 13)) * 1274126177) & 0xFFFFFFFF
    return (h ^ (h >> 16)) / 0xFFFFFFFF


def cloud(x, y):
    """Numbers of a lattice, blended."""
    i, j = math.floor(x), math.floor(y)
    u, v = (t * t * (3 - 2 * t) for t in (x - i, y - j))
    row = lambda j: corner(i, j) * (1 - u) + corner(i + 1, j) * u
    return row(j) * (1 - v) + row(j + 1) * v


def vein(x, y):
    """Share of the dark mineral: thin veins across, bent by clouds, and a haze of it around them."""
    bent = sum(cloud(2 ** k * 1.5 * (x + 1), 2 ** k * 1.5 * (y + 1)) / 2 ** k for k in range(5))
    line = abs(math.sin(math.pi * (1.3 * x + 0.8 * y + 1.1 * bent)))
    strength = cloud(2 * x + 20, 2 * y + 30)
    haze = 0.35 * max(0.0, cloud(4 * x + 40, 4 * y + 50) - 0.3)
    return (round(255 * min(1.0, strength * math.exp(-line * 6) + haze * (1 - line))),) * 3


def slab(name, half_mm, thickness_mm, bevel_mm):
    """A square slab that faces +z, its upper edges bevelled; every face has a chart and a normal of its own."""
    lines = ["# A slab of marble, %g mm square and %g mm thick, made by slides.py." % (2 * half_mm, thickness_mm)]
    h, d, t, low = half_mm, half_mm - bevel_mm, thickness_mm, thickness_mm - bevel_mm

    def face(corners, normal, place, size):
        first = lines.count("") * 4 + 1
        for (x, y, z), (u, v) in zip(corners, [(0, 0), (1, 0), (1, 1), (0, 1)]):
            lines.append("v %g %g %g" % (x, y, z))
            lines.append("vt %g %g" % (place[0] + u * size[0], place[1] + v * size[1]))
            lines.append("vn %g %g %g" % normal)
        lines.extend(["f " + " ".join("%d/%d/%d" % (n, n, n) for n in range(first, first + 4)), ""])

    face([(-d, -d, t), (d, -d, t), (d, d, t), (-d, d, t)], (0, 0, 1), (0.02, 0.02), (0.7, 0.7))
    face([(-h, h, 0), (h, h, 0), (h, -h, 0), (-h, -h, 0)], (0, 0, -1), (0.75, 0.02), (0.23, 0.23))
    for n, (c, s) in enumerate([(1, 0), (0, 1), (-1, 0), (0, -1)]):
        turned = lambda x, y, z: (c * x - s * y, s * x + c * y, z)
        side = [turned(h, -h, 0), turned(h, h, 0), turned(h, h, low), turned(h, -h, low)]
        face(side, turned(1, 0, 0), (0.02, 0.74 + 0.06 * n), (0.7, 0.02))
        bevel = [turned(h, -h, low), turned(h, h, low), turned(d, d, t), turned(d, -d, t)]
        face(bevel, turned(0.7071068, 0, 0.7071068), (0.02, 0.77 + 0.06 * n), (0.7, 0.02))
    with open(name, "w") as file:
        file.write("\n".join(lines))


if __name__ == "__main__":
    write_png("stained_glass.png", 512, pane)
    write_png("checkerboard.png", 128, square)
    write_png("veins.png", 512, vein)
    slab("marble_slab.obj", 40, 12, 1.5)
