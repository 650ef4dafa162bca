"""Can a surface mesh be a cell? The faults that `create_cells` refuses, all and not only the first,
and what makes a mesh bad though it is sound.

The faults and their bounds are those of src/DCM/law/mesh.h and self_crossing.h.
"""
import numpy as np

from .triangles import tetrahedron_volumes, triangle_quality, triangle_vectors

SAME_PLACE = 1e-9    # of the size of the mesh
SMALL_AREA = 1e-6    # of the mean area of a face
FLAT_FACE = 1e-4     # height of a face over its longest side
# [ours] a step is limited by the smallest triangles, and a node of few or many edges is stiff
POOR_QUALITY, FEW_EDGES, MANY_EDGES = 0.2, 4, 9
PAIRS_AT_ONCE = 2_000_000


def half_edges(faces):
    """Sides of all faces: (3 m, 2) nodes in the sense of the face, and (3 m,) the face."""
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    return sides, np.repeat(np.arange(len(faces)), 3)


def edge_groups(faces):
    """(edges (e, 2), lower node first; number of faces (e,); edge (3 m,) of each half-edge)."""
    sides, _ = half_edges(faces)
    edges, at, count = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True,
                                 return_counts=True)
    return edges, count, at.ravel()


def components(pairs, n):
    """Component (n,) of each of n things that `pairs` (k, 2) join."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    graph = coo_matrix((np.ones(len(pairs)), np.asarray(pairs).reshape(-1, 2).T), shape=(n, n))
    return connected_components(graph, directed=False)[1]


def doubled_nodes(nodes, distance):
    """Pairs (k, 2) of nodes within `distance` of each other."""
    from scipy.spatial import cKDTree

    return cKDTree(nodes).query_pairs(distance, output_type="ndarray").reshape(-1, 2)


def size_of(nodes):
    """Longest side of the box around a mesh."""
    return float(np.ptp(nodes, axis=0).max())


def enclosed_volume(nodes, faces):
    """Volume inside a closed mesh, negative if it is inside out."""
    return float(tetrahedron_volumes((nodes - nodes.mean(axis=0))[faces]).sum())


def find_faults(nodes, faces):
    """Sentences, one per sort of fault, each with the number of places, the first of them, counted
    from 1 as LAMMPS does, and the remedy; none if the mesh can be the surface of a cell."""
    if not np.isfinite(nodes).all():
        bad = np.flatnonzero(~np.isfinite(nodes).all(axis=1))
        return [f"{len(bad)} nodes have a coordinate that is not finite, the first is node "
                f"{bad[0] + 1}: export the mesh again"]
    if len(faces) and not (0 <= faces.min() and faces.max() < len(nodes)):
        return [f"faces name nodes that do not exist: the mesh has nodes 1 to {len(nodes)}"]
    found = []
    twice = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    if twice.any():
        found.append(f"{twice.sum()} faces name a node twice, the first is face "
                     f"{np.flatnonzero(twice)[0] + 1}: remove them")
    unused = np.setdiff1d(np.arange(len(nodes)), faces)
    if len(unused):
        found.append(f"{len(unused)} nodes are in no face, the first is node {unused[0] + 1}: "
                     "remove them")
    pairs = doubled_nodes(nodes, SAME_PLACE * size_of(nodes))
    if len(pairs):
        found.append(f"{len(pairs)} pairs of nodes lie in the same place, the first are nodes "
                     f"{pairs[0][0] + 1} and {pairs[0][1] + 1}: merge them, `mesh convert`")
    if twice.any() or len(pairs):    # what else is wrong follows from that
        return found
    found += _edge_faults(nodes, faces)
    found += _flat_faults(nodes, faces)
    found += _whole_faults(nodes, faces, sound=not found)
    crossings = self_crossings(nodes, faces)
    if len(crossings):
        a, b = crossings[0] + 1
        found.append(f"the surface runs through itself at {len(crossings)} pairs of faces, the "
                     f"first are faces {a} and {b}: repair it, or reconstruct the surface")
    return found


def _edge_faults(nodes, faces):
    found = []
    edges, count, at = edge_groups(faces)
    sides, face = half_edges(faces)

    def where(edge):
        a, b = edges[edge]
        x, y, z = nodes[[a, b]].mean(axis=0)
        return f"between nodes {a + 1} and {b + 1} (face {face[at == edge][0] + 1}, at {x:.4g} " \
               f"{y:.4g} {z:.4g})"

    border = np.flatnonzero(count == 1)
    if len(border):
        holes = len(np.unique(components(edges[border], len(nodes))[edges[border]]))
        found.append(f"the surface is open: {len(border)} edges belong to one face only, in "
                     f"{holes} hole{'s' if holes > 1 else ''}, the first {where(border[0])}: close "
                     "the holes")
    many = np.flatnonzero(count > 2)
    if len(many):
        found.append(f"the surface is not a manifold: {len(many)} edges are shared by more than "
                     f"two faces, the first {where(many[0])}: remove faces inside the surface")
    forward = np.bincount(at, sides[:, 0] < sides[:, 1], minlength=len(edges))
    turned = np.flatnonzero((count == 2) & (forward != 1))
    if len(turned):
        found.append(f"the faces are not oriented alike: the two of {len(turned)} edges run along "
                     f"them in the same direction, the first {where(turned[0])}: flip some of them")
    return found


def _flat_faults(nodes, faces):
    corners = nodes[faces]
    twice_area = 2.0 * np.linalg.norm(triangle_vectors(corners), axis=1)
    longest = ((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=2).max(axis=1)
    flat = (twice_area <= SMALL_AREA * twice_area.mean()) | (twice_area <= FLAT_FACE * longest)
    if not flat.any():
        return []
    return [f"{flat.sum()} faces are degenerate, their nodes lie on a line or nearly so, the first "
            f"is face {np.flatnonzero(flat)[0] + 1}: remesh, `mesh convert --nodes N`"]


def _whole_faults(nodes, faces, sound):
    """Faults of the surface as a whole; those of shape make sense if it is closed only."""
    edges = edge_groups(faces)[0]
    part = components(edges, len(nodes))[faces[:, 0]]
    parts = len(np.unique(part))
    found = []
    if parts > 1:
        largest = np.bincount(part).max()
        found.append(f"the mesh has {parts} components, the largest with {largest} of {len(faces)} "
                     "faces: one cell is one surface; `mesh convert --largest` keeps the largest")
    if not sound:
        return found
    pinched = pinched_nodes(faces)
    if len(pinched):
        found.append(f"the surface touches itself at {len(pinched)} nodes, the first is node "
                     f"{pinched[0] + 1}: separate its parts")
    euler = len(np.unique(faces)) - len(edges) + len(faces)
    if parts == 1 and euler != 2 and not len(pinched):
        found.append(f"the surface is not a sphere: its Euler characteristic (nodes - edges + "
                     f"faces) is {euler}, not 2, it has {(2 - euler) // 2} handle"
                     f"{'s' if euler < 0 else ''}: close them")
    if not enclosed_volume(nodes, faces) > 0.0:
        found.append("the mesh is inside out (negative volume): flip all faces")
    return found


def pinched_nodes(faces):
    """Nodes (k,) of a closed manifold at which faces touch that share no edge there."""
    sides, face = half_edges(faces)
    edges, _, at = edge_groups(faces)
    order = np.argsort(at, kind="stable")
    first, second = order[::2], order[1::2]    # the two half-edges of each edge
    # half-edge number 3 f + k begins at corner k and ends at corner k + 1 of face f
    begin = np.arange(len(sides))
    end = 3 * face + (begin - 3 * face + 1) % 3
    same = sides[first, 0] == sides[second, 0]
    other_begin = np.where(same, begin[second], end[second])
    other_end = np.where(same, end[second], begin[second])
    pairs = np.concatenate([np.stack([begin[first], other_begin], axis=1),
                            np.stack([end[first], other_end], axis=1)])
    fan = components(pairs, len(sides))
    node_fans = np.unique(np.stack([faces.ravel(), fan], axis=1), axis=0)[:, 0]
    nodes, count = np.unique(node_fans, return_counts=True)
    return nodes[count > 1]


def self_crossings(nodes, faces):
    """Pairs (k, 2) of faces, sorted, that run through each other; those that only touch do not.
    Faces that share a node are compared by the sides that do not end at it."""
    corners = nodes[faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    axis = int(np.ptp(nodes, axis=0).argmax())
    order = np.argsort(low[:, axis], kind="stable")
    low, high = low[order], high[order]
    end = np.searchsorted(low[:, axis], high[:, axis], side="right")
    count = np.maximum(end - np.arange(len(order)) - 1, 0)
    found, begin = [np.zeros((0, 2), dtype=int)], 0
    while begin < len(order):
        total = np.cumsum(count[begin:])
        stop = begin + max(1, int(np.searchsorted(total, PAIRS_AT_ONCE, side="right")))
        here = count[begin:stop]
        i = np.repeat(np.arange(begin, stop), here)
        j = i + 1 + np.arange(len(i)) - np.repeat(np.cumsum(here) - here, here)
        near = ((low[j] <= high[i]) & (low[i] <= high[j])).all(axis=1)
        pairs = np.stack([order[i[near]], order[j[near]]], axis=1)
        through = _run_through(nodes, faces, pairs) | _run_through(nodes, faces, pairs[:, ::-1])
        found.append(np.sort(pairs[through], axis=1))
        begin = stop
    return np.unique(np.concatenate(found), axis=0)


def _run_through(nodes, faces, pairs):
    """Whether a side of the first face of each pair runs through the inside of the second."""
    hit = np.zeros(len(pairs), dtype=bool)
    s, t = faces[pairs[:, 0]], faces[pairs[:, 1]]
    a, b, c = (nodes[t[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    for k in range(3):
        p, q = s[:, k], s[:, (k + 1) % 3]
        apart = ~((t == p[:, None]) | (t == q[:, None])).any(axis=1)
        x, y = nodes[p], nodes[q]
        above = np.einsum("ij,ij->i", normal, x - a) * np.einsum("ij,ij->i", normal, y - a) < 0.0
        sides = [np.einsum("ij,ij->i", y - x, np.cross(u - x, v - x))
                 for u, v in ((a, b), (b, c), (c, a))]
        inside = np.all([w > 0.0 for w in sides], axis=0) | np.all([w < 0.0 for w in sides], axis=0)
        hit |= apart & above & inside
    return hit


def measure_surface(nodes, faces):
    """Measures of a mesh, a dict: nodes, faces; volume, area; mean_edge; size (3,), of its box;
    middle (3,), the mean node; radius, of the sphere of the same volume; reach, of the farthest
    node from the mean node; worst, median: quality of faces; valence: (fewest, most) edges of a
    node."""
    edges = edge_groups(faces)[0]
    quality = triangle_quality(nodes[faces])
    valence = np.bincount(edges.ravel(), minlength=len(nodes))
    volume, middle = enclosed_volume(nodes, faces), nodes.mean(axis=0)
    return dict(
        nodes=len(nodes), faces=len(faces), volume=volume, middle=middle,
        area=float(np.linalg.norm(triangle_vectors(nodes[faces]), axis=1).sum()),
        mean_edge=float(np.linalg.norm(nodes[edges[:, 0]] - nodes[edges[:, 1]], axis=1).mean()),
        size=np.ptp(nodes, axis=0), radius=float(np.cbrt(0.75 * abs(volume) / np.pi)),
        reach=float(np.linalg.norm(nodes - middle, axis=1).max()),
        worst=float(quality.min()), median=float(np.median(quality)),
        valence=(int(valence.min()), int(valence.max())))


def find_doubts(measures):
    """Sentences on what makes a sound mesh a bad one; measures: of measure_surface."""
    found = []
    if measures["worst"] < POOR_QUALITY:
        found.append(f"slivers: the worst face has quality {measures['worst']:.2g} (1: "
                     "equilateral), which takes short steps: remesh, `mesh convert --nodes N`")
    few, many = measures["valence"]
    if few < FEW_EDGES or many > MANY_EDGES:
        found.append(f"nodes have {few} to {many} edges, 5 to 7 in a good mesh: remesh, `mesh "
                     "convert --nodes N`")
    return found
