#!/usr/bin/env python3
"""Total reflectance of a sphere in uniform light by a random walk written for this alone: an exact sphere, isotropic
scattering, no interface or a polished one, no mesh, no renderer. In a uniform radiance of 1 it equals the mean radiance
of the sphere's picture from far away: what leaves per direction, averaged over the disc, is flux / (pi area)."""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path

import scene_file
from packages import need

np = need("numpy")

ROULETTE_WEIGHT = 1e-3  # below it a walk goes on with a chance of one in ten and ten times the weight
ROULETTE_CHANCE = 0.1


def main() -> int:
    arguments = parse()
    scene = scene_file.read(arguments.scene)
    index = 1.0 if arguments.interface == "matched" else scene.refractive_index
    result = []
    for channel in range(3):
        random = np.random.default_rng([arguments.seed, channel])
        escaped = walk(
            scene.sigma_t_per_mm[channel],
            scene.single_scattering_albedo[channel],
            index,
            arguments.radius_mm,
            arguments.walks,
            random,
        )
        result.append(
            {
                "channel": "RGB"[channel],
                "reflectance": escaped.mean(),
                "standard_error": escaped.std() / math.sqrt(len(escaped)),
            }
        )
    if arguments.json:
        print(json.dumps(result))
    else:
        print("  ".join(f"{r['channel']} {r['reflectance']:.5f} ± {r['standard_error']:.5f}" for r in result))
    return 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", type=Path, help="scene file whose medium is taken")
    parser.add_argument(
        "--interface",
        choices=("smooth", "matched"),
        default="smooth",
        help="smooth: Fresnel with the scene's index; matched: none [default smooth]",
    )
    parser.add_argument("--radius-mm", type=float, default=10.0, help="radius of the sphere [mm, default 10]")
    parser.add_argument("--walks", type=int, default=200_000, help="walks per channel [default 200000]")
    parser.add_argument("--seed", type=int, default=1, help="seed [default 1]")
    parser.add_argument("--json", action="store_true", help="print JSON")
    return parser.parse_args()


def walk(
    sigma_t: float, albedo: float, index: float, radius: float, count: int, random: np.random.Generator
) -> np.ndarray:
    """Weight that leaves again, for each walk that arrives cosine-distributed from outside."""
    escaped = np.zeros(count)
    cos_outside = np.sqrt(1.0 - random.random(count))
    outside_reflects = fresnel(cos_outside, index)
    escaped += outside_reflects
    weight = 1.0 - outside_reflects
    # All enter at +z; the sphere is the same everywhere.
    sin_inside = np.sqrt(1.0 - cos_outside**2) / index
    position = np.zeros((count, 3))
    position[:, 2] = radius
    direction = np.stack([sin_inside, np.zeros(count), -np.sqrt(1.0 - sin_inside**2)], axis=-1)
    alive = np.arange(count)
    while len(alive):
        flight = -np.log(1.0 - random.random(len(alive))) / sigma_t
        to_edge = distance_to_edge(position, direction, radius)
        leaving = flight >= to_edge
        position += direction * np.where(leaving, to_edge, flight)[:, None]
        normal = position[leaving] / np.linalg.norm(position[leaving], axis=1, keepdims=True)
        position[leaving] = normal * radius
        cosine = np.clip(np.einsum("ij,ij->i", direction[leaving], normal), 0.0, 1.0)
        reflects = fresnel(cosine, 1.0 / index)
        escaped[alive[leaving]] += weight[leaving] * (1.0 - reflects)
        weight[leaving] *= reflects
        direction[leaving] -= 2.0 * cosine[:, None] * normal
        inside = ~leaving
        weight[inside] *= albedo
        direction[inside] = isotropic(int(inside.sum()), random)
        faint = weight < ROULETTE_WEIGHT
        survives = random.random(len(weight)) < ROULETTE_CHANCE
        weight[faint] = np.where(survives[faint], weight[faint] / ROULETTE_CHANCE, 0.0)
        keep = weight > 0.0
        position, direction, weight, alive = position[keep], direction[keep], weight[keep], alive[keep]
    return escaped


def distance_to_edge(position: np.ndarray, direction: np.ndarray, radius: float) -> np.ndarray:
    along = np.einsum("ij,ij->i", position, direction)
    off = np.maximum(along**2 + radius**2 - np.einsum("ij,ij->i", position, position), 0.0)
    return np.maximum(np.sqrt(off) - along, 0.0)


def isotropic(count: int, random: np.random.Generator) -> np.ndarray:
    z = 2.0 * random.random(count) - 1.0
    azimuth = 2.0 * math.pi * random.random(count)
    across = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    return np.stack([across * np.cos(azimuth), across * np.sin(azimuth), z], axis=-1)


def fresnel(cos_in: np.ndarray, eta_out_over_in: float) -> np.ndarray:
    """Unpolarised reflectance; `eta_out_over_in` is the index beyond the surface over that before it."""
    sin_out = np.sqrt(np.maximum(1.0 - cos_in**2, 0.0)) / eta_out_over_in
    cos_out = np.sqrt(np.maximum(1.0 - sin_out**2, 0.0))
    # 1e-12 keeps grazing light from dividing zero by zero; its reflectance is 1 all the same at index 1.3.
    s = (cos_in - eta_out_over_in * cos_out) / np.maximum(cos_in + eta_out_over_in * cos_out, 1e-12)
    p = (eta_out_over_in * cos_in - cos_out) / np.maximum(eta_out_over_in * cos_in + cos_out, 1e-12)
    return np.where(sin_out >= 1.0, 1.0 if eta_out_over_in != 1.0 else 0.0, 0.5 * (s * s + p * p))


if __name__ == "__main__":
    sys.exit(main())
