#!/usr/bin/env python3
"""Draws a comparison scene with Mitsuba 3: a homogeneous medium behind a dielectric interface, every path traced
(volpathmis). Writes a picture (EXR), one per seed beside it, and a JSON file of mean radiances by region with standard
errors. The same seed gives the same picture."""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from pathlib import Path

import pictures
import regions
import scene_file
from packages import need
from scene_file import Scene

np = need("numpy")

# Roulette starts this deep in absorbing media: 5 to 16 give the least variance for the time on skin1. A medium that
# absorbs nothing never loses weight, so roulette would add noise only. Without an interface volpathmis is off with it: red
# of the furnace falls by 0.7 % at depth 8; with one, depths 8 and 64 agree within 0.1 %.
ROULETTE_DEPTH, ROULETTE_DEPTH_NEVER = 8, 1_000_000


def main() -> int:
    arguments = parse()
    scene = scene_file.read(arguments.scene)
    mi = mitsuba(arguments.variant)
    width, height = arguments.size
    description = describe(mi, scene, arguments, width, height)
    loaded = mi.load_dict(description)
    per_seed = max(1, arguments.samples // arguments.seeds)
    if arguments.warm_up:
        render(mi, loaded, 1, 0)
    started = time.perf_counter()
    seeds = [render(mi, loaded, per_seed, arguments.seed + i) for i in range(arguments.seeds)]
    wall_seconds = time.perf_counter() - started
    picture = np.mean(seeds, axis=0)
    output = arguments.output
    pictures.write(output, picture)
    if arguments.seeds > 1 and not arguments.only_mean:
        for i, seed_picture in enumerate(seeds):
            pictures.write(output.with_suffix(f".seed{arguments.seed + i}{output.suffix}"), seed_picture)
    if arguments.png:
        pictures.write_png(output.with_suffix(".png"), picture, arguments.exposure)
    report = make_report(mi, arguments, scene, seeds, per_seed, wall_seconds)
    output.with_suffix(".json").write_text(json.dumps(report, indent=1) + "\n")
    print(json.dumps(report) if arguments.json else as_text(report))
    return 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", type=Path, help="scene file, such as target/validation/sphere.toml")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        required=True,
        help="picture to write (.exr or .npy); regions go to the same name with .json",
    )
    parser.add_argument("--samples", type=int, default=256, help="samples per pixel, all seeds together [default 256]")
    parser.add_argument(
        "--seeds", type=int, default=4, help="independent renders that the samples are divided among [default 4]"
    )
    parser.add_argument("--seed", type=int, default=1, help="first seed [default 1]")
    parser.add_argument(
        "--size", type=size, default=(128, 128), metavar="WIDTHxHEIGHT", help="pixels [default 128x128]"
    )
    parser.add_argument(
        "--middle-only", action="store_true", help="draw the middle eighth of the picture alone, for its mean"
    )
    parser.add_argument(
        "--interface",
        choices=("rough", "smooth", "matched"),
        default="rough",
        help="rough: Beckmann with the scene's roughness; smooth: polished, lights are then found by chance only; matched: no interface at all [default rough]",
    )
    parser.add_argument("--roughness", type=float, help="Beckmann roughness instead of the scene's [0.01 to 1]")
    parser.add_argument(
        "--mesh", type=Path, help="OBJ in mm instead of the scene's, such as target/validation/sphere_flat.obj"
    )
    parser.add_argument("--no-medium", action="store_true", help="clear inside: tests the interface alone")
    parser.add_argument("--max-depth", type=int, default=-1, help="longest path [default -1: any]")
    parser.add_argument(
        "--roulette-depth",
        type=int,
        help=f"depth at which roulette starts [default {ROULETTE_DEPTH}; {ROULETTE_DEPTH_NEVER} without absorption or interface]",
    )
    parser.add_argument(
        "--scale",
        type=float,
        default=1.0,
        help="Mitsuba units per mm: lengths times this, coefficients divided by it [default 1]",
    )
    parser.add_argument(
        "--offset",
        type=float,
        default=0.0,
        metavar="MM",
        help="move everything along x: far from the origin single precision bites [mm, default 0]",
    )
    parser.add_argument(
        "--variant",
        default="llvm_ad_rgb",
        help="Mitsuba variant; scalar_rgb needs no LLVM library [default llvm_ad_rgb]",
    )
    parser.add_argument(
        "--warm-up", action="store_true", help="render one sample first, so that the time holds no compilation"
    )
    parser.add_argument("--only-mean", action="store_true", help="write no picture per seed")
    parser.add_argument("--png", action="store_true", help="write a PNG for the eye too")
    parser.add_argument("--exposure", type=float, default=1.0, help="factor on the PNG [default 1]")
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object on stdout (wall_seconds: render time alone)"
    )
    arguments = parser.parse_args()
    if min(arguments.samples, arguments.seeds, *arguments.size) < 1:
        parser.error("samples, seeds and size must be 1 or more")
    return arguments


def size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    return int(width), int(height)


def mitsuba(variant: str):
    """The module with its variant set."""
    mi = need("mitsuba")
    try:
        mi.set_variant(variant)
        mi.Float(0.0) + 1.0  # fails here, not in the middle of a render, without the LLVM library
    except (ImportError, RuntimeError) as error:
        raise SystemExit(f"Mitsuba cannot run {variant}: {error}\ntake --variant scalar_rgb") from error
    mi.set_log_level(mi.LogLevel.Error)
    return mi


def describe(mi, scene: Scene, arguments: argparse.Namespace, width: int, height: int) -> dict:
    """The scene as Mitsuba's dictionary."""
    transform = mi.ScalarTransform4f
    scale = arguments.scale

    def placed(point_mm: scene_file.Triple) -> list[float]:
        return [(point_mm[0] + arguments.offset) * scale, point_mm[1] * scale, point_mm[2] * scale]

    never = max(scene.sigma_a_per_mm) == 0.0 or arguments.interface == "matched"
    depth = arguments.roulette_depth or (ROULETTE_DEPTH_NEVER if never else ROULETTE_DEPTH)
    mesh = arguments.mesh or scene.mesh
    if not mesh.is_file():
        raise SystemExit(f"{mesh} is not there")
    units = scale * (1.0 if arguments.mesh else scene.millimetres_per_unit)
    body = {
        "type": "obj",
        "filename": str(mesh),
        "to_world": transform().translate([arguments.offset * scale, 0, 0]).scale(units),
        # The file's own normals: smooth or flat, as cutis reads them.
        "face_normals": False,
        "bsdf": interface(scene, arguments),
    }
    if not arguments.no_medium:
        body["interior"] = medium(scene, scale)
    description = {
        "type": "scene",
        "integrator": {
            "type": "volpathmis",
            "max_depth": arguments.max_depth,
            "rr_depth": depth,
            "hide_emitters": True,
        },
        "sensor": {
            "type": "perspective",
            "fov": scene.vertical_fov_degrees,
            "fov_axis": "y",
            "near_clip": 1.0 * scale,
            "far_clip": 1e5 * scale,
            "to_world": transform().look_at(
                origin=placed(scene.camera_position_mm),
                target=placed(scene.camera_look_at_mm),
                up=[0, 1, 0],
            ),
            "film": {
                "type": "hdrfilm",
                "width": width,
                "height": height,
                "pixel_format": "rgba",
                "component_format": "float32",
                "rfilter": {"type": "box"},
                **(middle(width, height) if arguments.middle_only else {}),
            },
            "sampler": {"type": "independent"},
        },
        "body": body,
    }
    for number, light in enumerate(scene.lights):
        description[f"light_{number}"] = {
            "type": "sphere",
            "center": placed(light.position_mm),
            "radius": light.radius_mm * scale,
            # Lengths are scaled, radiance is not.
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": list(light.radiance())}},
        }
    if scene.environment:
        description["environment"] = environment(mi, scene)
    return description


def middle(width: int, height: int) -> dict:
    """Mitsuba's words for the part of the picture that `summaries` calls the centre."""
    if min(width, height) < 16:
        raise SystemExit("--middle-only needs a picture of 16 x 16 at least")
    x, y = (n // 2 - n // 16 for n in (width, height))
    return {"crop_offset_x": x, "crop_offset_y": y, "crop_width": 2 * (width // 16), "crop_height": 2 * (height // 16)}


def interface(scene: Scene, arguments: argparse.Namespace) -> dict:
    if arguments.interface == "matched":
        return {"type": "null"}
    indices = {"int_ior": scene.refractive_index, "ext_ior": 1.0}
    if arguments.interface == "smooth":
        return {"type": "dielectric", **indices}
    return {
        "type": "roughdielectric",
        "distribution": "beckmann",
        "alpha": arguments.roughness or scene.roughness,
        **indices,
    }


def medium(scene: Scene, scale: float) -> dict:
    """Extinction is written as a colour up to 1 times a factor: Mitsuba refuses colours above 1."""
    largest = max(scene.sigma_t_per_mm)
    return {
        "type": "homogeneous",
        "albedo": {"type": "rgb", "value": list(scene.single_scattering_albedo)},
        "sigma_t": {"type": "rgb", "value": [t / largest for t in scene.sigma_t_per_mm]},
        "scale": largest / scale,
        "phase": {"type": "isotropic"},
    }


def environment(mi, scene: Scene) -> dict:
    """In Mitsuba the middle of the map lies towards +Z; half a turn puts it towards -Z, where cutis has it."""
    picture = pictures.read(scene.environment.path)[..., :3] * np.array(
        scene.environment.radiance_scale, dtype=np.float32
    )
    if np.ptp(picture.reshape(-1, 3), axis=0).max() == 0.0:
        return {"type": "constant", "radiance": {"type": "rgb", "value": [float(x) for x in picture[0, 0]]}}
    return {
        "type": "envmap",
        "bitmap": mi.Bitmap(np.ascontiguousarray(picture)),
        "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 180),
    }


def render(mi, loaded, samples: int, seed: int) -> np.ndarray:
    return np.array(mi.render(loaded, spp=samples, seed=seed), dtype=np.float32)


def make_report(
    mi, arguments: argparse.Namespace, scene: Scene, seeds: list[np.ndarray], per_seed: int, wall_seconds: float
) -> dict:
    """Everything that says how the picture was made, and its means."""
    mask = regions.common_mask(seeds)
    kept = regions.tiles_with_enough(mask)
    tiles = regions.of_pictures(seeds, mask, kept)
    return {
        "program": f"Mitsuba {mi.__version__} {arguments.variant} volpathmis",
        "scene": scene.path.name,
        "interface": arguments.interface,
        "roughness": arguments.roughness or scene.roughness,
        "medium": not arguments.no_medium,
        "mesh": (arguments.mesh or scene.mesh).name,
        "scale": arguments.scale,
        "offset_mm": arguments.offset,
        "width": arguments.size[0],
        "height": arguments.size[1],
        "samples_per_pixel": per_seed * arguments.seeds,
        "seeds": arguments.seeds,
        "first_seed": arguments.seed,
        "wall_seconds": wall_seconds,
        "output": str(arguments.output),
        **summaries(seeds, mask),
        "tiles": [
            {
                "row": int(t // regions.GRID),
                "column": int(t % regions.GRID),
                "mean": tiles.means[i].tolist(),
                "standard_error": regions.number_or_null(tiles.standard_errors[i]),
            }
            for i, t in enumerate(kept)
        ],
    }


def summaries(seeds: list[np.ndarray], mask: np.ndarray) -> dict:
    """Mean radiance of all that is covered, outlines included, and of the middle eighth of the picture."""
    height, width = mask.shape
    # A picture of less than 16 pixels is itself the middle of a larger one.
    rows, columns = (slice(n // 2 - n // 16, n // 2 + n // 16) if n >= 16 else slice(None) for n in (height, width))
    whole = np.array(
        [s[..., :3].sum(axis=(0, 1), dtype=np.float64) / max(s[..., 3].sum(dtype=np.float64), 1e-12) for s in seeds]
    )
    centre = np.array([s[rows, columns, :3].mean(axis=(0, 1), dtype=np.float64) for s in seeds])
    result = {}
    for name, values in (("whole", whole), ("centre", centre)):
        result[name] = values.mean(axis=0).tolist()
        result[f"{name}_standard_error"] = (
            (values.std(axis=0, ddof=1) / math.sqrt(len(seeds))).tolist() if len(seeds) > 1 else None
        )
    return result


def as_text(report: dict) -> str:
    lines = [
        f"{report['program']}: {report['scene']}, {report['interface']} interface, {report['samples_per_pixel']} samples, {report['wall_seconds']:.1f} s"
    ]
    for name in ("whole", "centre"):
        errors = report[f"{name}_standard_error"] or [math.nan] * 3
        lines.append(f"{name}: " + "  ".join(f"{m:.5f} ± {e:.5f}" for m, e in zip(report[name], errors)))
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
