"""Polygon meshes: OBJ in and out, and whether they are closed.

A mesh is a list of positions and a list of faces; a face is a list of corners (position, uv or None). All indices count
from 0. Positions are welded: two corners at one place share one position, whatever their texture coordinates.
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

from packages import need

np = need("numpy")


Corner = tuple[int, "int | None"]


@dataclass
class Mesh:
    """Positions (n, 3), texture coordinates (m, 2), faces of corners."""

    positions: np.ndarray
    uvs: np.ndarray
    faces: list[list[Corner]]

    def triangles(self) -> np.ndarray:
        """Positions of the corners of every face cut into a fan, (t, 3)."""
        fans = [(f[0][0], f[i][0], f[i + 1][0]) for f in self.faces for i in range(1, len(f) - 1)]
        return np.array(fans, dtype=np.int64)


def read_obj(path: Path) -> Mesh:
    """Reads `v`, `vt` and `f`; everything else is passed over."""
    positions, uvs, faces = [], [], []
    for line in path.read_text(errors="replace").splitlines():
        word, _, rest = line.partition(" ")
        if word == "v":
            positions.append([float(x) for x in rest.split()[:3]])
        elif word == "vt":
            uvs.append([float(x) for x in rest.split()[:2]])
        elif word == "f":
            faces.append([_corner(text, len(positions), len(uvs)) for text in rest.split()])
    return Mesh(np.array(positions), np.array(uvs).reshape(-1, 2), faces)


def _corner(text: str, positions: int, uvs: int) -> Corner:
    parts = text.split("/")

    def index(i: int, count: int) -> int | None:
        if len(parts) <= i or not parts[i]:
            return None
        number = int(parts[i])
        return number - 1 if number > 0 else count + number

    return index(0, positions), index(1, uvs)


def weld(mesh: Mesh, decimals: int = 7) -> tuple[Mesh, int]:
    """Merges positions that are equal to so many decimals, drops corners and faces that collapse and positions that no
    face uses; also how many positions went."""
    rounded = np.round(mesh.positions, decimals) + 0.0  # turns -0 into 0
    _, first, inverse = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    inverse = inverse.reshape(-1)
    faces = []
    for face in mesh.faces:
        corners = [(int(first[inverse[p]]), uv) for p, uv in face]
        kept = [c for i, c in enumerate(corners) if c[0] != corners[i - 1][0]]
        if len(kept) >= 3:
            faces.append(kept)
    used = sorted({p for face in faces for p, _ in face})
    place = {old: new for new, old in enumerate(used)}
    faces = [[(place[p], uv) for p, uv in face] for face in faces]
    return Mesh(mesh.positions[used], mesh.uvs, faces), len(mesh.positions) - len(used)


@dataclass
class Topology:
    """What a mesh is like; see `describe`."""

    positions: int
    faces: int
    edges: int
    boundary_loops: list[list[int]] = field(default_factory=list)
    boundary_edges: int = 0
    edges_of_three_faces: int = 0
    edges_with_two_faces_of_one_direction: int = 0
    vertices_with_two_fans: int = 0
    components: int = 0
    euler_characteristic: int = 0
    signed_volume: float = 0.0

    @property
    def closed_manifold(self) -> bool:
        """Every edge has two faces that agree about the outside, every vertex one fan."""
        return not (
            self.boundary_edges
            or self.edges_of_three_faces
            or self.edges_with_two_faces_of_one_direction
            or self.vertices_with_two_fans
        )

    @property
    def genus(self) -> float:
        """Handles, all components together; meaningful for a closed manifold."""
        return self.components - self.euler_characteristic / 2


def topology(mesh: Mesh) -> Topology:
    """Counts edges by their faces, follows boundaries and measures the enclosed volume (positive: faces turn
    anticlockwise seen from outside)."""
    half_edges: dict[tuple[int, int], list[int]] = defaultdict(list)
    for number, face in enumerate(mesh.faces):
        for i, (p, _) in enumerate(face):
            half_edges[p, face[(i + 1) % len(face)][0]].append(number)
    edges = {(min(a, b), max(a, b)) for a, b in half_edges}
    count = {(a, b): (len(half_edges.get((a, b), ())), len(half_edges.get((b, a), ()))) for a, b in edges}
    boundary = [(a, b) if n else (b, a) for (a, b), (n, m) in count.items() if n + m == 1]
    used = {p for face in mesh.faces for p, _ in face}
    components = _components(mesh, edges)
    return Topology(
        positions=len(used),
        faces=len(mesh.faces),
        edges=len(edges),
        boundary_loops=_loops(boundary),
        boundary_edges=len(boundary),
        edges_of_three_faces=sum(n + m > 2 for n, m in count.values()),
        edges_with_two_faces_of_one_direction=sum((n, m) in ((2, 0), (0, 2)) for n, m in count.values()),
        vertices_with_two_fans=_vertices_with_two_fans(mesh),
        components=components,
        euler_characteristic=len(used) - len(edges) + len(mesh.faces),
        signed_volume=signed_volume(mesh),
    )


def signed_volume(mesh: Mesh) -> float:
    """Volume that the faces enclose, unit³; of an open mesh, with cones to its centre over the holes."""
    a, b, c = (mesh.positions[mesh.triangles()[:, i]] - mesh.positions.mean(axis=0) for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def _loops(boundary: list[tuple[int, int]]) -> list[list[int]]:
    """Closed walks along boundary half-edges, longest first."""
    after: dict[int, list[int]] = defaultdict(list)
    for a, b in sorted(boundary):
        after[a].append(b)
    loops = []
    while any(after.values()):
        start = min(a for a, targets in after.items() if targets)
        loop, at = [], start
        while after[at]:
            loop.append(at)
            at = after[at].pop()
        loops.append(loop)
    return sorted(loops, key=lambda loop: (-len(loop), loop))


def _components(mesh: Mesh, edges: set[tuple[int, int]]) -> int:
    parent = list(range(len(mesh.positions)))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for a, b in edges:
        parent[root(a)] = root(b)
    return len({root(p) for face in mesh.faces for p, _ in face})


def _vertices_with_two_fans(mesh: Mesh) -> int:
    """Vertices whose faces do not form one fan around them."""
    links: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for face in mesh.faces:
        for i, (p, _) in enumerate(face):
            links[p].append((face[i - 1][0], face[(i + 1) % len(face)][0]))
    return sum(_pieces(link) > 1 for link in links.values())


def _pieces(link: list[tuple[int, int]]) -> int:
    pieces: list[set[int]] = []
    for pair in link:
        touching = [piece for piece in pieces if piece & set(pair)]
        pieces = [piece for piece in pieces if piece not in touching] + [set(pair).union(*touching)]
    return len(pieces)


def corner_normals(mesh: Mesh, smooth: bool, flat_from: int | None = None) -> tuple[np.ndarray, list[list[int]]]:
    """Unit normals and, for every face, the normal of each corner. Smooth ones are averages of the faces around a
    position, weighted by the angle of each face there; faces from number `flat_from` on have their own."""
    face_normals = np.array([_face_normal(mesh, face) for face in mesh.faces])
    flat_from = len(mesh.faces) if flat_from is None else flat_from
    if not smooth:
        return face_normals, [[n] * len(face) for n, face in enumerate(mesh.faces)]
    sums = np.zeros_like(mesh.positions)
    for number, face in enumerate(mesh.faces[:flat_from]):
        for i, (p, _) in enumerate(face):
            sums[p] += _angle(mesh, face, i) * face_normals[number]
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    smooth_normals = np.divide(sums, lengths, out=np.zeros_like(sums), where=lengths > 0)
    normals = np.concatenate([smooth_normals, face_normals[flat_from:]])
    flat = range(len(sums), len(normals))
    of_face = [[p for p, _ in face] for face in mesh.faces[:flat_from]]
    return normals, of_face + [[n] * len(face) for n, face in zip(flat, mesh.faces[flat_from:])]


def _face_normal(mesh: Mesh, face: list[Corner]) -> np.ndarray:
    p = mesh.positions[[c[0] for c in face]]
    normal = np.cross(p[1:-1] - p[0], p[2:] - p[0]).sum(axis=0)
    length = np.linalg.norm(normal)
    return normal / length if length > 0 else np.array([0.0, 0.0, 1.0])


def _angle(mesh: Mesh, face: list[Corner], i: int) -> float:
    here = mesh.positions[face[i][0]]
    a = mesh.positions[face[i - 1][0]] - here
    b = mesh.positions[face[(i + 1) % len(face)][0]] - here
    cosine = np.dot(a, b) / max(np.linalg.norm(a) * np.linalg.norm(b), 1e-30)
    return math.acos(min(1.0, max(-1.0, cosine)))


def write_obj(path: Path, mesh: Mesh, normals: np.ndarray, normal_of_corner: list[list[int]], comment: str) -> None:
    """Writes positions, uvs, normals and faces; corners without a uv get (0, 0)."""
    path.parent.mkdir(parents=True, exist_ok=True)
    uvs = mesh.uvs if len(mesh.uvs) else np.zeros((1, 2))
    lines = [f"# {line}" for line in comment.splitlines()]
    lines += ["v %.7f %.7f %.7f" % tuple(p) for p in mesh.positions]
    lines += ["vt %.7f %.7f" % tuple(uv) for uv in uvs]
    lines += ["vn %.7f %.7f %.7f" % tuple(n) for n in normals]
    for face, of_corner in zip(mesh.faces, normal_of_corner):
        lines.append("f " + " ".join(f"{p + 1}/{(uv or 0) + 1}/{n + 1}" for (p, uv), n in zip(face, of_corner)))
    path.write_text("\n".join(lines) + "\n")
