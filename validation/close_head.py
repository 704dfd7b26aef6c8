#!/usr/bin/env python3
"""Makes the scanned head a closed solid, as a walk of light inside it needs: welds it, caps every hole with a fan to the
middle of its rim, and says whether the result is closed. Writes an OBJ in millimetres; the scan itself is never stored
here. Scan: «Infinite, 3D Head Scan by Lee Perry-Smith», CC BY 3.0, Infinite-Realities / triplegangers.com."""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path

import mesh_file
from mesh_file import Mesh, Topology
from packages import need

np = need("numpy")

ROOT = Path(__file__).resolve().parent.parent
MILLIMETRES_PER_UNIT = 950.0  # as in scenes/lee_perry_smith.toml
CREDIT = (
    "«Infinite, 3D Head Scan by Lee Perry-Smith», CC BY 3.0, Infinite-Realities / triplegangers.com.\n"
    "Changed: scaled to millimetres, holes closed."
)


def main() -> int:
    arguments = parse()
    source = arguments.input or assets_folder() / "lee_perry_smith" / "LeePerrySmith.obj"
    if not source.is_file():
        print(
            f"close_head: {source} is not there; CUTIS_ASSETS names the folder that holds lee_perry_smith/",
            file=sys.stderr,
        )
        return 2
    facts = close(source, arguments.output, arguments.millimetres_per_unit)
    if arguments.self_intersections:
        facts["self_intersections"] = self_intersections(mesh_file.read_obj(arguments.output))
    print(json.dumps(facts, indent=2) if arguments.json else as_text(facts))
    return 0 if facts["after"]["closed_manifold"] else 1


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--input",
        type=Path,
        help="OBJ to close [default: lee_perry_smith/LeePerrySmith.obj in CUTIS_ASSETS, else ../shared/assets]",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=ROOT / "target/validation/head.obj",
        help="OBJ to write [default: target/validation/head.obj]",
    )
    parser.add_argument(
        "--millimetres-per-unit",
        type=float,
        default=MILLIMETRES_PER_UNIT,
        help="length of the unit of the input [mm, default 950]",
    )
    parser.add_argument(
        "--self-intersections",
        action="store_true",
        help="also count the pairs of triangles that cut each other (needs bpy)",
    )
    parser.add_argument("--json", action="store_true", help="print the facts as one JSON object")
    return parser.parse_args()


def assets_folder() -> Path:
    return Path(os.environ.get("CUTIS_ASSETS") or ROOT.parent / "shared" / "assets")


def close(source: Path, output: Path, millimetres_per_unit: float) -> dict:
    """Reads, welds, caps, writes; the facts of before and after."""
    mesh, welded = mesh_file.weld(mesh_file.read_obj(source))
    mesh.positions = mesh.positions * millimetres_per_unit
    before = mesh_file.topology(mesh)
    faces_before = len(mesh.faces)
    caps = [cap(mesh, loop) for loop in before.boundary_loops]
    after = mesh_file.topology(mesh)
    if after.signed_volume < 0.0:
        mesh.faces = [face[::-1] for face in mesh.faces]
        after = mesh_file.topology(mesh)
    normals, of_corner = mesh_file.corner_normals(mesh, smooth=True, flat_from=faces_before)
    mesh_file.write_obj(output, mesh, normals, of_corner, CREDIT)
    return {
        "output": str(output),
        "positions_welded": welded,
        "turned_inside_out": before.signed_volume < 0.0,
        "bounds_mm": [mesh.positions.min(axis=0).round(2).tolist(), mesh.positions.max(axis=0).round(2).tolist()],
        "before": summary(before),
        "caps": caps,
        "after": summary(after),
    }


def cap(mesh: Mesh, loop: list[int]) -> dict:
    """Closes a hole by triangles between its rim and the middle of its rim. The rim runs along its faces, so the cap's
    edges run against it."""
    rim = mesh.positions[loop]
    centre = rim.mean(axis=0)
    uv_of = {p: uv for face in mesh.faces for p, uv in face if p in set(loop) and uv is not None}
    mesh.positions = np.concatenate([mesh.positions, centre[None]])
    if uv_of:
        mesh.uvs = np.concatenate([mesh.uvs, mesh.uvs[list(uv_of.values())].mean(axis=0)[None]])
    middle = (len(mesh.positions) - 1, len(mesh.uvs) - 1 if uv_of else None)
    following = loop[1:] + loop[:1]
    mesh.faces += [[(b, uv_of.get(b)), (a, uv_of.get(a)), middle] for a, b in zip(loop, following)]
    return cap_facts(rim, centre)


def cap_facts(rim: np.ndarray, centre: np.ndarray) -> dict:
    """Size of a cap, and how many of its triangles turn against the rest: folds, where it may cut itself."""
    crosses = 0.5 * np.cross(np.roll(rim, -1, axis=0) - centre, rim - centre)
    mean = crosses.sum(axis=0)
    mean /= max(np.linalg.norm(mean), 1e-30)
    return {
        "rim_vertices": len(rim),
        "rim_length_mm": round(float(np.linalg.norm(np.roll(rim, -1, axis=0) - rim, axis=1).sum()), 2),
        "area_mm2": round(float(np.linalg.norm(crosses, axis=1).sum()), 2),
        "centre_mm": centre.round(2).tolist(),
        "normal": mean.round(3).tolist(),
        "rim_off_its_plane_mm": round(float(np.abs((rim - centre) @ mean).max()), 2),
        "folded_triangles": int((crosses @ mean < 0.0).sum()),
    }


def self_intersections(mesh: Mesh) -> dict:
    """Pairs of triangles without a common corner that cut each other, and the box around them: there a point can be inside
    twice, and programs that count crossings disagree with those that look at the side that was hit."""
    need("bpy")  # brings mathutils along
    from mathutils.bvhtree import BVHTree

    triangles = mesh.triangles()
    tree = BVHTree.FromPolygons(mesh.positions.tolist(), triangles.tolist(), all_triangles=True)
    corners = [set(t) for t in triangles.tolist()]
    pairs = [(a, b) for a, b in tree.overlap(tree) if a < b and not corners[a] & corners[b]]
    if not pairs:
        return {"pairs": 0}
    touched = mesh.positions[triangles[np.unique(pairs)].ravel()]
    return {
        "pairs": len(pairs),
        "bounds_mm": [touched.min(axis=0).round(1).tolist(), touched.max(axis=0).round(1).tolist()],
    }


def summary(t: Topology) -> dict:
    return {
        "positions": t.positions,
        "faces": t.faces,
        "edges": t.edges,
        "components": t.components,
        "boundary_loops": [len(loop) for loop in t.boundary_loops],
        "edges_of_three_or_more_faces": t.edges_of_three_faces,
        "edges_whose_faces_disagree": t.edges_with_two_faces_of_one_direction,
        "vertices_with_two_fans": t.vertices_with_two_fans,
        "euler_characteristic": t.euler_characteristic,
        "signed_volume_mm3": round(t.signed_volume, 1),
        "closed_manifold": t.closed_manifold,
    }


def as_text(facts: dict) -> str:
    lines = [f"{facts['output']}: {facts['positions_welded']} positions welded, bounds {facts['bounds_mm']} mm"]
    for when in ("before", "after"):
        lines.append(f"{when}: " + ", ".join(f"{key} {value}" for key, value in facts[when].items()))
    lines += ["cap: " + ", ".join(f"{key} {value}" for key, value in cap.items()) for cap in facts["caps"]]
    if "self_intersections" in facts:
        lines.append(
            "self-intersections: " + ", ".join(f"{key} {value}" for key, value in facts["self_intersections"].items())
        )
    lines.append("closed" if facts["after"]["closed_manifold"] else "NOT closed: light would leak")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
