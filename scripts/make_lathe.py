#!/usr/bin/env python3
"""Turns a profile (r, z) about the z axis into a binary PLY mesh with smooth normals.

    scripts/make_lathe.py            writes the meshes of the demo scenes to scenes/geometry

The wine glass is cut where its wall meets the wine, so that each interface is a mesh of its own: glass to air, glass to
wine, wine to air. No two surfaces lie on each other, which keeps the order of media right without priorities.
"""
import math
import pathlib
import struct

SEGMENTS = 96
STEPS = 5  # mesh rings per pair of profile points


def smooth(points):
    """Catmull-Rom spline through the points; a point given twice makes a corner."""
    out = []
    for i in range(len(points) - 1):
        p1, p2 = points[i], points[i + 1]
        if p1 == p2:
            continue
        p0 = points[i - 1] if i > 0 else p1
        p3 = points[i + 2] if i + 2 < len(points) else p2
        for s in range(STEPS):
            t = s / STEPS
            out.append(tuple(
                0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t + (3 * b - a - 3 * c + d) * t ** 3)
                for a, b, c, d in zip(p0, p1, p2, p3)))
    out.append(points[-1])
    return [(max(r, 0.0), z) for r, z in out]


def profile_normals(points):
    """Normals to the right of the way along the profile: out of a solid whose profile runs upwards on its outside."""
    normals = []
    for i, _ in enumerate(points):
        (r0, z0), (r1, z1) = points[max(i - 1, 0)], points[min(i + 1, len(points) - 1)]
        length = math.hypot(r1 - r0, z1 - z0) or 1.0
        normals.append(((z1 - z0) / length, -(r1 - r0) / length))
    return [(0.0, math.copysign(1.0, nz)) if r < 1e-6 else (nr, nz) for (r, _), (nr, nz) in zip(points, normals)]


def lathe(points):
    """(vertices with normals, triangles); rings on the axis become one vertex."""
    vertices, triangles, previous = [], [], None
    for (r, z), (nr, nz) in zip(points, profile_normals(points)):
        count = 1 if r < 1e-6 else SEGMENTS
        ring = [len(vertices) + k for k in range(count)]
        for k in range(count):
            c, s = math.cos(2 * math.pi * k / SEGMENTS), math.sin(2 * math.pi * k / SEGMENTS)
            vertices.append((r * c, r * s, z, nr * c, nr * s, nz))
        if previous:
            for k in range(SEGMENTS):
                a, b = previous[k % len(previous)], previous[(k + 1) % len(previous)]
                c, d = ring[(k + 1) % len(ring)], ring[k % len(ring)]
                triangles += [t for t in ((a, b, c), (a, c, d)) if len(set(t)) == 3]
        previous = ring
    return vertices, triangles


def write_ply(path, vertices, triangles):
    header = ("ply\nformat binary_little_endian 1.0\ncomment made by scripts/make_lathe.py\n"
              f"element vertex {len(vertices)}\n" + "".join(f"property float {n}\n" for n in ("x", "y", "z", "nx", "ny", "nz")) +
              f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    with open(path, "wb") as file:
        file.write(header.encode())
        for vertex in vertices:
            file.write(struct.pack("<6f", *vertex))
        for triangle in triangles:
            file.write(struct.pack("<B3i", 3, *triangle))


def main():
    folder = pathlib.Path(__file__).resolve().parent.parent / "scenes" / "geometry"
    folder.mkdir(parents=True, exist_ok=True)

    foot = [(0, 0), (3.2, 0), (3.2, 0), (3.35, 0.08), (3.2, 0.2), (1.6, 0.5), (0.65, 1.2), (0.45, 2.5), (0.42, 4.5), (0.55, 6.4)]
    outside = [(1.3, 7.4), (2.8, 8.6), (3.75, 10.6), (3.95, 12.6), (3.7, 15), (3.25, 17.6)]
    rim = [(3.15, 17.7), (3.05, 17.6)]
    inside_above = [(3.5, 15), (3.72, 13)]
    inside_below = [(3.72, 13), (3.72, 12.4), (3.5, 10.75), (2.6, 9.0), (1.2, 8.1), (0, 7.85)]
    inside = smooth(inside_above + inside_below[1:])
    cut = STEPS * (len(inside_above) - 1)
    glass_air = smooth(foot + outside + rim + inside_above[:1])[:-1] + inside[:cut + 1]
    glass_wine = inside[cut:]
    surface = [inside[cut], (2.4, 13), (1.2, 13), (0, 13)]
    write_ply(folder / "wine-glass.ply", *lathe(glass_air))
    write_ply(folder / "wine-glass-inside.ply", *lathe(glass_wine))
    write_ply(folder / "wine-surface.ply", *lathe(surface))


if __name__ == "__main__":
    main()
