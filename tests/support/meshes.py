"""Meshes, made without the package under test."""

import numpy as np


def icosphere(level):
    """Unit icosphere: nodes (n, 3) and triangles (m, 3), counter-clockwise from outside."""
    g = (1 + 5**0.5) / 2
    nodes = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g),
             (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    nodes = [np.array(p) / np.linalg.norm(p) for p in nodes]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
             (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
             (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(level):
        middle, finer = {}, []

        def mid(a, b, middle=middle):
            key = min(a, b), max(a, b)
            if key not in middle:
                p = nodes[a] + nodes[b]
                nodes.append(p / np.linalg.norm(p))
                middle[key] = len(nodes) - 1
            return middle[key]

        for a, b, c in faces:
            ab, bc, ca = mid(a, b), mid(b, c), mid(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return np.array(nodes), np.array(faces)


def off(nodes, faces):
    """Text of an OFF file."""
    lines = ["OFF", f"{len(nodes)} {len(faces)} 0"]
    lines += [" ".join(f"{x:.17g}" for x in node) for node in nodes]
    lines += ["3 " + " ".join(map(str, face)) for face in faces]
    return "\n".join(lines) + "\n"


def cube(n):
    """Cube of half side 1, n x n squares of two triangles on each side."""
    nodes, faces, index = [], [], {}

    def node(point):
        key = tuple(np.round(point, 9))
        if key not in index:
            index[key] = len(nodes)
            nodes.append(point)
        return index[key]

    grid = np.linspace(-1, 1, n + 1)
    for axis in range(3):
        for side in (-1, 1):
            b, c = ((axis + 1) % 3, (axis + 2) % 3)[::side]
            for s, s1 in zip(grid, grid[1:], strict=False):
                for t, t1 in zip(grid, grid[1:], strict=False):
                    corner = []
                    for u, v in ((s, t), (s1, t), (s1, t1), (s, t1)):
                        point = np.zeros(3)
                        point[axis], point[b], point[c] = side, u, v
                        corner.append(node(point))
                    faces += [corner[:3], [corner[0], corner[2], corner[3]]]
    return np.array(nodes), np.array(faces)
