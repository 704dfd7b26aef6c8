#!/usr/bin/env python3
"""Makes what the comparison scenes need: a sphere, two environments, the closed head; and puts the scenes beside them in
target/validation, since a scene file may only name files in its own folder. Everything follows from formulas written
here, except the head, which is skipped with a word where the scan is not at hand."""

from __future__ import annotations

import argparse
import math
import re
import shutil
import sys
from pathlib import Path

import close_head
import mesh_file
import pictures
from mesh_file import Mesh
from packages import need

np = need("numpy")

HERE = Path(__file__).resolve().parent
SPHERE_RADIUS_MM = 10.0
POLISHED_ROUGHNESS = 0.05
ENVIRONMENT_WIDTH, ENVIRONMENT_HEIGHT = 512, 256
# The environment: a dim surrounding and one broad bright lobe from the front, left and above, so wide that programs
# which find it only by chance still converge.
AMBIENT_RADIANCE = 0.15
LOBE_RADIANCE = 2.5
LOBE_SHARPNESS = 4.0
LOBE_DIRECTION = (-0.45, 0.45, 0.77)


def main() -> int:
    arguments = parse()
    output = arguments.output
    output.mkdir(parents=True, exist_ok=True)
    for normals in ("smooth", "flat"):
        write_sphere(output, normals, arguments.longitudes, arguments.latitudes)
    pictures.write(output / "uniform.exr", np.ones((16, 32, 3)))
    pictures.write(output / "lobe.exr", lobe_environment())
    for scene in sorted((HERE / "scenes").glob("*.toml")):
        shutil.copyfile(scene, output / scene.name)
        write_polished(scene, output)
    scan = close_head.assets_folder() / "lee_perry_smith" / "LeePerrySmith.obj"
    if scan.is_file():
        close_head.close(scan, output / "head.obj", close_head.MILLIMETRES_PER_UNIT)
    else:
        print(
            f"SKIPPED: {scan} is not there (CUTIS_ASSETS); the scenes of the head cannot be rendered", file=sys.stderr
        )
    print(f"scenes and their files are in {output}")
    return 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=HERE.parent / "target/validation",
        help="folder to write [default: target/validation]",
    )
    parser.add_argument("--longitudes", type=int, default=128, help="quads around the sphere [default 128]")
    parser.add_argument("--latitudes", type=int, default=64, help="quads from pole to pole [default 64]")
    return parser.parse_args()


def write_polished(scene: Path, output: Path) -> None:
    """The same scene with a nearly smooth surface, where programs without multiple scattering at the microfacets lose
    next to nothing."""
    text = scene.read_text()
    polished = re.sub(r"(?m)^roughness = .*$", f"roughness = {POLISHED_ROUGHNESS}", text)
    assert polished != text, f"{scene} gives no roughness"
    (output / f"{scene.stem}_polished.toml").write_text(polished)


def write_sphere(output: Path, normals: str, longitudes: int, latitudes: int) -> None:
    """A sphere whose corners carry the sphere's normals (smooth) or those of its facets (flat)."""
    mesh = sphere(longitudes, latitudes)
    facts = mesh_file.topology(mesh)
    assert facts.closed_manifold and facts.signed_volume > 0.0, facts
    if normals == "smooth":
        vectors = mesh.positions / np.linalg.norm(mesh.positions, axis=1, keepdims=True)
        of_corner = [[p for p, _ in face] for face in mesh.faces]
    else:
        vectors, of_corner = mesh_file.corner_normals(mesh, smooth=False)
    comment = f"sphere of radius {SPHERE_RADIUS_MM} mm, {longitudes} x {latitudes}, {normals} normals"
    name = "sphere.obj" if normals == "smooth" else "sphere_flat.obj"
    mesh_file.write_obj(output / name, mesh, vectors, of_corner, comment)


def sphere(longitudes: int, latitudes: int) -> Mesh:
    """Longitudes and latitudes, poles on the y axis. Positions at the seam and at the poles are shared; their texture
    coordinates are not."""
    rows = [[(0.0, SPHERE_RADIUS_MM, 0.0)]]
    for row in range(1, latitudes):
        polar = math.pi * row / latitudes
        ring = [2.0 * math.pi * column / longitudes for column in range(longitudes)]
        rows.append(
            [
                tuple(
                    SPHERE_RADIUS_MM * x
                    for x in (math.sin(polar) * math.sin(a), math.cos(polar), math.sin(polar) * math.cos(a))
                )
                for a in ring
            ]
        )
    rows.append([(0.0, -SPHERE_RADIUS_MM, 0.0)])
    start = np.cumsum([0] + [len(row) for row in rows])
    uvs = [
        (column / longitudes, 1.0 - row / latitudes) for row in range(latitudes + 1) for column in range(longitudes + 1)
    ]

    def corner(row: int, column: int) -> tuple[int, int]:
        position = int(start[row]) + (column % longitudes if len(rows[row]) > 1 else 0)
        return position, row * (longitudes + 1) + column

    faces = []
    for row in range(latitudes):
        for column in range(longitudes):
            quad = [corner(row, column), corner(row + 1, column), corner(row + 1, column + 1), corner(row, column + 1)]
            distinct = [c for i, c in enumerate(quad) if c[0] != quad[i - 1][0]]
            faces.append(distinct)
    return Mesh(np.array([p for row in rows for p in row]), np.array(uvs), faces)


def lobe_environment() -> np.ndarray:
    """Radiance `ambient + lobe * exp(sharpness (cos angle - 1))` on a latitude-longitude map in cutis' layout: +Y is up,
    the middle column lies towards -Z, a quarter of the width to the right towards +X."""
    u = (np.arange(ENVIRONMENT_WIDTH) + 0.5) / ENVIRONMENT_WIDTH
    v = (np.arange(ENVIRONMENT_HEIGHT) + 0.5) / ENVIRONMENT_HEIGHT
    azimuth, polar = np.meshgrid((u - 0.5) * 2.0 * math.pi, v * math.pi)
    direction = np.stack([np.sin(polar) * np.sin(azimuth), np.cos(polar), -np.sin(polar) * np.cos(azimuth)], axis=-1)
    cosine = direction @ (np.array(LOBE_DIRECTION) / np.linalg.norm(LOBE_DIRECTION))
    radiance = AMBIENT_RADIANCE + LOBE_RADIANCE * np.exp(LOBE_SHARPNESS * (cosine - 1.0))
    return np.repeat(radiance[..., None], 3, axis=-1).astype(np.float32)


if __name__ == "__main__":
    sys.exit(main())
