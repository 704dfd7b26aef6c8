#!/usr/bin/env python3
"""Draws a comparison scene with Blender (the bpy package): Cycles by its random walk, Cycles by the medium itself behind
rough glass, or EEVEE. Writes a linear EXR. The same seed gives the same picture.

--model walk: Principled BSDF, subsurface 1, method RANDOM_WALK. What its sockets are set to, from the kernel sources that
bpy 5.0.1 brings along (bssrdf.h, subsurface_random_walk.h):
  radius       4 pi / sigma_t, because Cycles divides by 4 pi before it takes it for the mean free path;
  base colour  the colour that its albedo inversion (a fit after Chiang et al. 2016) turns into the medium's own
               single-scattering albedo, found by bisection;
  scale 1, anisotropy 0, IOR that of the medium, roughness the square root of the Beckmann roughness.
The walk then happens in the same medium. What stays different, by design of Cycles: light enters by a GGX refraction
whose losses are left out, leaves without an interface (no total reflection back inside), diffuse at the exit; the surface
layer above takes what its reflection takes; shine is GGX, not Beckmann; a walk ends after 256 steps.
--model skin: the same with RANDOM_WALK_SKIN, whose radius Cycles rescales by a dipole; the socket is set to undo that.
--model volume: Glass BSDF (Beckmann) with the medium as a homogeneous volume: the same physics as volpathmis, by another
program, single scattering at the microfacets likewise.
--engine eevee: the walk's material in EEVEE (a screen-space profile); needs a display, such as that of xvfb-run."""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import sys
import tempfile
import time
from pathlib import Path

import pictures
import regions
import scene_file
from packages import need
from scene_file import Scene, Triple

np = need("numpy")

# Blender's unit is one millimetre here: an intensity in W/sr that shines at metres is 1e6 as much at millimetres.
MM2_PER_M2 = 1e6


def main() -> int:
    arguments = parse()
    scene = scene_file.read(arguments.scene)
    bpy = blender()
    build(bpy, scene, arguments)
    configure(bpy, scene, arguments)
    seeds, wall_seconds = [], 0.0
    for i in range(arguments.seeds):
        picture, seconds = render(bpy, arguments, arguments.seed + i)
        seeds.append(picture)
        wall_seconds += seconds
    output = arguments.output
    mean = np.mean(seeds, axis=0)
    pictures.write(output, mean)
    if arguments.seeds > 1:
        for i, picture in enumerate(seeds):
            pictures.write(output.with_suffix(f".seed{arguments.seed + i}{output.suffix}"), picture)
    if arguments.png:
        pictures.write_png(output.with_suffix(".png"), mean, arguments.exposure)
    report = make_report(bpy, scene, arguments, seeds, wall_seconds)
    output.with_suffix(".json").write_text(json.dumps(report, indent=1) + "\n")
    print(json.dumps(report) if arguments.json else as_text(report))
    return 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path, help="scene file, such as target/validation/head.toml")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        required=True,
        help="picture to write (.exr or .npy); facts go to the same name with .json",
    )
    parser.add_argument("--engine", choices=("cycles", "eevee"), default="cycles", help="[default cycles]")
    parser.add_argument("--model", choices=("walk", "skin", "volume"), default="walk", help="see above [default walk]")
    parser.add_argument("--samples", type=int, default=64, help="samples per pixel, all seeds together [default 64]")
    parser.add_argument(
        "--seeds", type=int, default=1, help="independent renders that the samples are divided among [default 1]"
    )
    parser.add_argument("--seed", type=int, default=1, help="first seed [default 1]")
    parser.add_argument(
        "--size", type=size, default=(512, 512), metavar="WIDTHxHEIGHT", help="pixels [default 512x512]"
    )
    parser.add_argument(
        "--bounces", type=int, help="longest path outside the walk [default 64; volume 1024, the most Cycles has]"
    )
    parser.add_argument("--threads", type=int, default=0, help="threads [default 0: one per processor]")
    parser.add_argument("--png", action="store_true", help="write a PNG for the eye too")
    parser.add_argument("--exposure", type=float, default=1.0, help="factor on the PNG [default 1]")
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object on stdout (wall_seconds: render call alone)"
    )
    arguments = parser.parse_args()
    if min(arguments.samples, arguments.seeds, *arguments.size) < 1:
        parser.error("samples, seeds and size must be 1 or more")
    if arguments.engine == "eevee" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        parser.error("EEVEE needs a display; run this under xvfb-run -a")
    return arguments


def size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    return int(width), int(height)


def blender():
    return need("bpy")


def z_up(v: Triple) -> Triple:
    """From y up to Blender's z up."""
    return v[0], -v[2], v[1]


def cycles_single_scattering_albedo(colour: float) -> float:
    """What Cycles 5.0 makes of a colour at g = 0: its fit with the constants of that case."""
    blend = colour**0.25
    low = 1.8260523782 * math.atan(5.1124679033 * colour) ** 1.09686102424
    high = 0.496310210422 * math.atan(4.2350090365 * colour) ** 2.40602999408
    return (1.0 - blend) * low + blend * high


def cycles_colour(albedo: float) -> float:
    """The inverse, by bisection: the fit grows with colour."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if cycles_single_scattering_albedo(middle) < albedo else (low, middle)
    return 0.5 * (low + high)


def skin_radius_factor(colour: float, index: float) -> float:
    """By what RANDOM_WALK_SKIN multiplies the radius: sqrt(3 (1 - alpha')), alpha' from colour by the classical dipole
    (Jensen et al. 2001), as in bssrdf_setup_radius."""
    f_dr = -1.440 / index**2 + 0.710 / index + 0.668 + 0.0636 * index
    four_thirds_a = 4.0 / 3.0 * (1.0 + f_dr) / (1.0 - f_dr)
    low, high = 0.0, 1.0
    for _ in range(60):
        alpha = 0.5 * (low + high)
        s = math.sqrt(3.0 * (1.0 - alpha))
        total = 0.5 * alpha * (1.0 + math.exp(-four_thirds_a * s)) * math.exp(-s)
        low, high = (alpha, high) if total < colour else (low, alpha)
    return math.sqrt(3.0 * (1.0 - low))


def walk_sockets(scene: Scene, model: str) -> dict:
    """Base colour and radius of the Principled BSDF."""
    colour = [cycles_colour(a) for a in scene.single_scattering_albedo]
    if model == "skin":
        radius = [
            1.0 / (t * skin_radius_factor(c, scene.refractive_index)) for t, c in zip(scene.sigma_t_per_mm, colour)
        ]
    else:
        radius = [4.0 * math.pi / t for t in scene.sigma_t_per_mm]
    return {"base_colour": colour, "radius_mm": radius}


def build(bpy, scene: Scene, arguments: argparse.Namespace) -> None:
    """Mesh, material, lights, camera in an empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.world = bpy.data.worlds.new("world")
    with quiet():
        bpy.ops.wm.obj_import(filepath=str(scene.mesh), global_scale=scene.millimetres_per_unit)
    material = make_material(bpy, scene, arguments.model)
    for body in [o for o in bpy.context.scene.objects if o.type == "MESH"]:
        body.data.materials.clear()
        body.data.materials.append(material)
    for light in scene.lights:
        add_light(bpy, light)
    set_world(bpy, scene)
    add_camera(bpy, scene)


def make_material(bpy, scene: Scene, model: str):
    material = bpy.data.materials.new("skin")
    if material.node_tree is None:
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    roughness = math.sqrt(scene.roughness)
    if model == "volume":
        glass = nodes.new("ShaderNodeBsdfGlass")
        glass.distribution = "BECKMANN"
        glass.inputs["Color"].default_value = (1, 1, 1, 1)
        glass.inputs["Roughness"].default_value = roughness
        glass.inputs["IOR"].default_value = scene.refractive_index
        inside = nodes.new("ShaderNodeVolumeCoefficients")
        inside.inputs["Scatter Coefficients"].default_value = scene.sigma_s_per_mm
        inside.inputs["Absorption Coefficients"].default_value = scene.sigma_a_per_mm
        inside.inputs["Anisotropy"].default_value = 0.0
        links.new(glass.outputs["BSDF"], output.inputs["Surface"])
        links.new(inside.outputs["Volume"], output.inputs["Volume"])
        return material
    sockets = walk_sockets(scene, model)
    skin = nodes.new("ShaderNodeBsdfPrincipled")
    skin.subsurface_method = "RANDOM_WALK_SKIN" if model == "skin" else "RANDOM_WALK"
    skin.distribution = "MULTI_GGX"
    values = {
        "Base Color": (*sockets["base_colour"], 1.0),
        "Subsurface Weight": 1.0,
        "Subsurface Radius": sockets["radius_mm"],
        "Subsurface Scale": 1.0,
        "Subsurface Anisotropy": 0.0,
        "Roughness": roughness,
        "IOR": scene.refractive_index,
    }
    if model == "skin":
        values["Subsurface IOR"] = scene.refractive_index
    for name, value in values.items():
        skin.inputs[name].default_value = value
    links.new(skin.outputs["BSDF"], output.inputs["Surface"])
    return material


def add_light(bpy, light: scene_file.PointLight) -> None:
    data = bpy.data.lights.new("light", "POINT")
    strongest = max(light.intensity_w_per_sr)
    data.color = [i / strongest for i in light.intensity_w_per_sr]
    # A sphere light of power P has an intensity of P / 4 pi in every direction.
    data.energy = 4.0 * math.pi * strongest * MM2_PER_M2
    data.shadow_soft_size = light.radius_mm
    data.use_soft_falloff = False
    thing = bpy.data.objects.new("light", data)
    thing.location = z_up(light.position_mm)
    thing.visible_camera = False
    bpy.context.scene.collection.objects.link(thing)


def set_world(bpy, scene: Scene) -> None:
    world = bpy.context.scene.world
    if world.node_tree is None:
        world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = next((n for n in nodes if n.type == "BACKGROUND"), None)
    if background is None:
        nodes.clear()
        background = nodes.new("ShaderNodeBackground")
        links.new(background.outputs["Background"], nodes.new("ShaderNodeOutputWorld").inputs["Surface"])
    background.inputs["Color"].default_value = (0, 0, 0, 1)
    if scene.environment is None:
        return
    image = bpy.data.images.load(str(scene.environment.path.resolve()))
    image.colorspace_settings.name = "Non-Color"  # linear as it is
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    # The middle of the map lies towards +X in Blender, towards -Z (Blender's +Y) in cutis: a quarter turn.
    mapping, coordinate = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, -0.5 * math.pi)
    links.new(coordinate.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    scaled = nodes.new("ShaderNodeVectorMath")
    scaled.operation = "MULTIPLY"
    scaled.inputs[1].default_value = scene.environment.radiance_scale
    links.new(texture.outputs["Color"], scaled.inputs[0])
    links.new(scaled.outputs["Vector"], background.inputs["Color"])


def add_camera(bpy, scene: Scene) -> None:
    from mathutils import Vector

    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(scene.vertical_fov_degrees)
    data.clip_start, data.clip_end = 1.0, 1e5
    camera = bpy.data.objects.new("camera", data)
    camera.location = z_up(scene.camera_position_mm)
    forward = Vector(z_up(scene.camera_look_at_mm)) - camera.location
    camera.rotation_euler = forward.to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def configure(bpy, scene: Scene, arguments: argparse.Namespace) -> None:
    """Unbiased settings: nothing clamped, blurred, denoised or stopped early."""
    target = bpy.context.scene
    settings = target.render
    settings.resolution_x, settings.resolution_y = arguments.size
    settings.resolution_percentage = 100
    settings.film_transparent = True
    settings.image_settings.file_format = "OPEN_EXR"
    settings.image_settings.color_mode = "RGBA"
    settings.image_settings.color_depth = "32"
    if arguments.threads:
        settings.threads_mode, settings.threads = "FIXED", arguments.threads
    per_seed = max(1, arguments.samples // arguments.seeds)
    if arguments.engine == "eevee":
        settings.engine = "BLENDER_EEVEE"
        target.eevee.taa_render_samples = per_seed
        settings.filter_size = 0.0
        return
    settings.engine = "CYCLES"
    cycles = target.cycles
    cycles.device = "CPU"
    cycles.samples = per_seed
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.light_sampling_threshold = 0.0
    bounces = arguments.bounces or (1024 if arguments.model == "volume" else 64)
    for name in ("max", "diffuse", "glossy", "transmission", "volume", "transparent_max"):
        setattr(cycles, f"{name}_bounces", bounces)


def render(bpy, arguments: argparse.Namespace, seed: int) -> tuple[np.ndarray, float]:
    """The picture and the time of the render call: scene transfer, trees and sampling, no file."""
    target = bpy.context.scene
    if arguments.engine == "cycles":
        target.cycles.seed = seed
    with quiet():
        started = time.perf_counter()
        bpy.ops.render.render()
        seconds = time.perf_counter() - started
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "render.exr"
            bpy.data.images["Render Result"].save_render(str(path))
            if not path.is_file():
                raise SystemExit(
                    "Blender wrote no picture; EEVEE needs OpenGL or Vulkan, such as Mesa's under xvfb-run"
                )
            return pictures.read(path), seconds


@contextlib.contextmanager
def quiet():
    """Blender talks on stdout, where only the result belongs."""
    sys.stdout.flush()
    kept = os.dup(1)
    os.dup2(2, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def make_report(bpy, scene: Scene, arguments: argparse.Namespace, seeds: list[np.ndarray], wall_seconds: float) -> dict:
    from mitsuba_scene import summaries

    return {
        "program": f"Blender {bpy.app.version_string} {arguments.engine} {arguments.model}",
        "scene": scene.path.name,
        "sockets": None if arguments.model == "volume" else walk_sockets(scene, arguments.model),
        "width": arguments.size[0],
        "height": arguments.size[1],
        "samples_per_pixel": max(1, arguments.samples // arguments.seeds) * arguments.seeds,
        "seeds": arguments.seeds,
        "first_seed": arguments.seed,
        "wall_seconds": wall_seconds,
        "output": str(arguments.output),
        **summaries(seeds, regions.common_mask(seeds)),
    }


def as_text(report: dict) -> str:
    lines = [
        f"{report['program']}: {report['scene']}, {report['samples_per_pixel']} samples, {report['wall_seconds']:.1f} s"
    ]
    for name in ("whole", "centre"):
        errors = report[f"{name}_standard_error"] or [math.nan] * 3
        lines.append(f"{name}: " + "  ".join(f"{m:.5f} ± {e:.5f}" for m, e in zip(report[name], errors)))
    if report["sockets"]:
        lines.append(f"sockets: {report['sockets']}")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
