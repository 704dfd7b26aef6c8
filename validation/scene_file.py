"""The part of cutis' scene files that the comparisons use, read into plain values: one mesh, one homogeneous medium per
channel, a constant roughness, point lights and an environment, a camera that says where it stands. Anything else is an
error, so that no program silently leaves out what another one draws.

Units are cutis': mm, 1/mm, W/sr, W/(m² sr), degrees.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

Triple = tuple[float, float, float]

KNOWN = {
    "": {"mesh", "material", "light", "camera"},
    "mesh": {"path", "millimetres_per_unit"},
    "material": {"albedo", "roughness", "f0", "medium"},
    "material.medium": {"sigma_a_per_mm", "sigma_s_reduced_per_mm", "refractive_index"},
    "light.point": {"kind", "position_mm", "colour", "intensity", "radius_mm"},
    "light.environment": {"kind", "path", "colour", "intensity"},
    "camera": {"position_mm", "look_at_mm", "vertical_fov_degrees", "background"},
}


@dataclass(frozen=True)
class PointLight:
    """A sphere that shines equally in all directions."""

    position_mm: Triple
    intensity_w_per_sr: Triple
    radius_mm: float

    def radiance(self) -> Triple:
        """Radiance of its surface, W/(m² sr). Seen from far, a sphere of radiance L and radius r is a disc of area
        pi r²: I = L pi r². The irradiance at a distance d of its centre, facing it, is then I / d² exactly, however
        near, as long as all of the sphere is above the horizon."""
        area_m2 = 3.141592653589793 * (self.radius_mm * 1e-3) ** 2
        return tuple(i / area_m2 for i in self.intensity_w_per_sr)


@dataclass(frozen=True)
class Environment:
    """A latitude-longitude map in cutis' layout and the factor on its radiance."""

    path: Path
    radiance_scale: Triple


@dataclass(frozen=True)
class Scene:
    """What the comparisons draw."""

    path: Path
    mesh: Path
    millimetres_per_unit: float
    sigma_a_per_mm: Triple
    sigma_s_per_mm: Triple
    refractive_index: float
    roughness: float
    lights: list[PointLight]
    environment: Environment | None
    camera_position_mm: Triple
    camera_look_at_mm: Triple
    vertical_fov_degrees: float

    @property
    def sigma_t_per_mm(self) -> Triple:
        return tuple(a + s for a, s in zip(self.sigma_a_per_mm, self.sigma_s_per_mm))

    @property
    def single_scattering_albedo(self) -> Triple:
        return tuple(s / t for s, t in zip(self.sigma_s_per_mm, self.sigma_t_per_mm))


def read(path: Path | str) -> Scene:
    """Reads a scene file; ends the program with a sentence if it holds more than the comparisons know."""
    path = Path(path)
    if not path.is_file():
        raise SystemExit(f"{path} is not there; `python validation/prepare.py` makes the scenes in target/validation")
    with path.open("rb") as file:
        root = tomllib.load(file)
    _only(path, "", root)
    mesh, material, camera = (_table(path, root, name) for name in ("mesh", "material", "camera"))
    medium = _table(path, material, "medium", "material.medium")
    if material.get("albedo", [1, 1, 1]) != [1, 1, 1]:
        raise SystemExit(f"{path}: albedo must be [1, 1, 1]: other programs have no absorbing film")
    lights, environment = _lights(path, root.get("light", []))
    return Scene(
        path=path,
        mesh=_file(path, mesh["path"]),
        millimetres_per_unit=float(mesh["millimetres_per_unit"]),
        sigma_a_per_mm=_triple(medium["sigma_a_per_mm"]),
        # Scattering is isotropic here (g = 0), so that reduced and plain coefficients are the same.
        sigma_s_per_mm=_triple(medium["sigma_s_reduced_per_mm"]),
        refractive_index=float(medium.get("refractive_index", 1.4)),
        roughness=float(material.get("roughness", 0.3)),
        lights=lights,
        environment=environment,
        camera_position_mm=_triple(camera["position_mm"]),
        camera_look_at_mm=_triple(camera["look_at_mm"]),
        vertical_fov_degrees=float(camera.get("vertical_fov_degrees", 25.0)),
    )


def _lights(path: Path, tables: list[dict]) -> tuple[list[PointLight], Environment | None]:
    points, environment = [], None
    for table in tables:
        kind = table.get("kind")
        if f"light.{kind}" not in KNOWN:
            raise SystemExit(f"{path}: a light of kind {kind!r} has no twin here; point and environment have")
        _only(path, f"light.{kind}", table)
        strength = tuple(c * float(table.get("intensity", 1.0)) for c in _triple(table.get("colour", [1, 1, 1])))
        if kind == "environment":
            environment = Environment(_file(path, table["path"]), strength)
        elif not table.get("radius_mm"):
            raise SystemExit(f"{path}: a point light without radius_mm cannot be found by a path through a surface")
        else:
            points.append(PointLight(_triple(table["position_mm"]), strength, float(table["radius_mm"])))
    return points, environment


def _table(path: Path, parent: dict, key: str, name: str | None = None) -> dict:
    if key not in parent:
        raise SystemExit(f"{path}: [{name or key}] is missing")
    _only(path, name or key, parent[key])
    return parent[key]


def _only(path: Path, name: str, table: dict) -> None:
    strangers = sorted(set(table) - KNOWN[name])
    if strangers:
        raise SystemExit(f"{path}: [{name}] has {', '.join(strangers)}, which the comparisons do not know")


def _file(path: Path, text: str) -> Path:
    found = path.parent / text
    if not found.is_file():
        raise SystemExit(
            f"{path} names {text}, which is not beside it; run `python validation/prepare.py` (the head needs CUTIS_ASSETS)"
        )
    return found


def _triple(values: list) -> Triple:
    first, second, third = (float(x) for x in values)
    return first, second, third
