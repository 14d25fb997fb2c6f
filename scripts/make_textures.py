#!/usr/bin/env python3
"""Writes the small images, the water and the smoke of the demo scenes to scenes/textures and scenes/geometry."""
import math
import pathlib
import struct
import zlib

SCENES = pathlib.Path(__file__).resolve().parent.parent / "scenes"

# Letters that show mirroring and turning at once.
LETTERS = {
    "F": ("#####", "#....", "#....", "####.", "#....", "#....", "#...."),
    "R": ("####.", "#...#", "#...#", "####.", "#.#..", "#..#.", "#...#"),
    "4": ("...#.", "..##.", ".#.#.", "#..#.", "#####", "...#.", "...#."),
    "7": ("#####", "....#", "...#.", "..#..", "..#..", "..#..", "..#.."),
}


def write_png(name, width, height, pixel):
    """pixel(x, y) -> (r, g, b) in 0..255, y from the top."""
    rows = b"".join(b"\0" + bytes(v for x in range(width) for v in pixel(x, y)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    (SCENES / "textures").mkdir(parents=True, exist_ok=True)
    (SCENES / "textures" / name).write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
        chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def letters(x, y):
    """Four quarters, each with its letter: F top left on red, R top right on green, 4 and 7 below on blue and yellow."""
    letter = ("FR", "47")[y // 64][x // 64]
    ground = {"F": (190, 60, 50), "R": (60, 150, 70), "4": (60, 90, 180), "7": (210, 170, 50)}[letter]
    u, v = (x % 64 - 12) // 8, (y % 64 - 4) // 8
    inside = 0 <= u < 5 and 0 <= v < 7 and LETTERS[letter][v][u] == "#"
    return (245, 240, 230) if inside else ground


def bumps(x, y):
    """Height of round studs, 8 by 8."""
    dx, dy = (x % 16 - 7.5) / 7.5, (y % 16 - 7.5) / 7.5
    height = max(0.0, 1.0 - dx * dx - dy * dy)
    return (int(255 * math.sqrt(height)),) * 3


def normals(x, y):
    """The same studs as normals; red points to +u, green to +v (up)."""
    dx, dy = (x % 16 - 7.5) / 7.5, -(y % 16 - 7.5) / 7.5
    if dx * dx + dy * dy > 0.9:
        return (128, 128, 255)
    n = (0.8 * dx, 0.8 * dy, 1.0)
    length = math.sqrt(sum(v * v for v in n))
    return tuple(int(127.5 + 127.5 * v / length) for v in n)


def slit(x, _):
    return (255, 255, 255) if x == 32 else (0, 0, 0)


def lamp(x, y):
    """An equal-area map, its pole in the middle: a bright cap and a ring round it."""
    u, v = (x + 0.5) / 32 - 1, (y + 0.5) / 32 - 1
    r = 1 - abs(1 - (abs(u) + abs(v)))
    cosine = (1 - r * r) * (1 if abs(u) + abs(v) <= 1 else -1)
    if cosine > 0.96 or abs(cosine - 0.84) < 0.03:
        return (255, 255, 255)
    return (25, 25, 25)


def water(n=112, size=20.0):
    """A square of water about the origin, as a grid with normals."""
    waves = [(0.055, 1.7, 0.3, 0.0), (0.045, 2.1, 1.9, 1.3), (0.035, 2.9, -0.8, 2.9), (0.022, 4.1, 2.6, 0.7), (0.014, 6.2, -2.2, 4.1)]

    def at(x, y):
        z = dx = dy = 0.0
        for amplitude, k, angle, phase in waves:
            kx, ky = k * math.cos(angle), k * math.sin(angle)
            z += amplitude * math.sin(kx * x + ky * y + phase)
            slope = amplitude * math.cos(kx * x + ky * y + phase)
            dx, dy = dx + kx * slope, dy + ky * slope
        length = math.sqrt(dx * dx + dy * dy + 1)
        return x, y, z, -dx / length, -dy / length, 1 / length

    (SCENES / "geometry").mkdir(parents=True, exist_ok=True)
    with open(SCENES / "geometry" / "water.ply", "wb") as file:
        file.write(("ply\nformat binary_little_endian 1.0\ncomment made by scripts/make_textures.py\n"
                    f"element vertex {n * n}\n" + "".join(f"property float {p}\n" for p in ("x", "y", "z", "nx", "ny", "nz")) +
                    f"element face {(n - 1) ** 2}\nproperty list uchar ushort vertex_indices\nend_header\n").encode())
        for j in range(n):
            for i in range(n):
                file.write(struct.pack("<6f", *at(size * (i / (n - 1) - 0.5), size * (j / (n - 1) - 0.5))))
        for j in range(n - 1):
            for i in range(n - 1):
                a = j * n + i
                file.write(struct.pack("<B4H", 4, a, a + 1, a + n + 1, a + n))


def smoke(n=20):
    """A rising plume, thinner and wider with height, in whorls."""
    def density(x, y, z):
        bend_x, bend_y = 0.12 * math.sin(6 * z), 0.10 * math.cos(5 * z + 1)
        width = 0.06 + 0.17 * z
        d2 = ((x - bend_x) ** 2 + (y - bend_y) ** 2) / width ** 2
        whorls = 0.6 + 0.4 * math.sin(17 * x + 9 * z) * math.sin(15 * y - 11 * z) * math.sin(13 * z + 3)
        value = math.exp(-d2) * (1.1 - z) * whorls * min(1.0, 12 * (1 - z))
        return value if value > 0.02 else 0.0

    values = [density((i + 0.5) / n - 0.5, (j + 0.5) / n - 0.5, (k + 0.5) / n) for k in range(n) for j in range(n) for i in range(n)]
    lines = [" ".join(f"{v:.2g}" for v in values[i:i + n]) for i in range(0, len(values), n)]
    (SCENES / "geometry" / "smoke.pbrt").write_text(
        "# Made by scripts/make_textures.py.\n"
        f"MakeNamedMedium \"smoke\" \"string type\" \"uniformgrid\" \"integer nx\" {n} \"integer ny\" {n} \"integer nz\" {n}\n"
        "    \"point3 p0\" [ -1 -1 0 ] \"point3 p1\" [ 1 1 3 ] \"rgb sigma_a\" [ 0.6 0.7 0.8 ] \"rgb sigma_s\" [ 9 9 9 ]\n"
        "    \"float g\" 0.3 \"float density\" [\n" + "\n".join(lines) + "\n]\n")


def main():
    write_png("letters.png", 128, 128, letters)
    write_png("bumps.png", 128, 128, bumps)
    write_png("normals.png", 128, 128, normals)
    write_png("slit.png", 64, 64, slit)
    write_png("lamp.png", 64, 64, lamp)
    water()
    smoke()


if __name__ == "__main__":
    main()
