"""Tests of the comparison scripts' own mathematics: `python -m unittest discover -s validation`. They need numpy, OpenEXR
and matplotlib, no renderer and no asset."""

from __future__ import annotations

import math
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import close_head
import cycles_scene
import error_over_time
import heat_flow_curve
import mesh_file
import pictures
import prepare
import regions
import scene_file
import sphere_walk
from packages import need

np = need("numpy")


class Meshes(unittest.TestCase):
    def test_the_sphere_is_closed_and_nearly_as_large_as_a_sphere(self):
        mesh = prepare.sphere(32, 16)
        facts = mesh_file.topology(mesh)
        self.assertTrue(facts.closed_manifold)
        self.assertEqual((facts.components, facts.euler_characteristic, facts.genus), (1, 2, 0))
        # An inscribed polyhedron is smaller, here by less than 2 %.
        whole = 4.0 / 3.0 * math.pi * prepare.SPHERE_RADIUS_MM**3
        self.assertTrue(0.98 * whole < facts.signed_volume < whole, facts.signed_volume)

    def test_holes_are_found_and_closed(self):
        mesh = prepare.sphere(32, 16)
        # The faces around the north pole, and one quad on the equator.
        mesh.faces = [face for i, face in enumerate(mesh.faces) if i >= 32 and i != 32 * 8 + 5]
        before = mesh_file.topology(mesh)
        self.assertEqual([len(loop) for loop in before.boundary_loops], [32, 4])
        self.assertFalse(before.closed_manifold)
        facts = [close_head.cap(mesh, loop) for loop in before.boundary_loops]
        after = mesh_file.topology(mesh)
        self.assertTrue(after.closed_manifold)
        self.assertGreater(after.signed_volume, 0.0)
        self.assertEqual([f["folded_triangles"] for f in facts], [0, 0])
        # The cap over the pole looks up.
        self.assertGreater(facts[0]["normal"][1], 0.999)

    def test_what_is_not_a_manifold_is_said(self):
        mesh = prepare.sphere(8, 4)
        mesh.faces[10] = mesh.faces[10][::-1]
        self.assertEqual(mesh_file.topology(mesh).edges_with_two_faces_of_one_direction, 4)
        mesh = prepare.sphere(8, 4)
        mesh.faces.append(mesh.faces[10])
        self.assertEqual(mesh_file.topology(mesh).edges_of_three_faces, 4)

    def test_welding_joins_and_drops(self):
        positions = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1e-9, 0, 0], [1, 0, 0], [5, 5, 5]], dtype=float)
        faces = [[(0, None), (1, None), (2, None)], [(3, None), (0, None), (4, None)]]
        welded, gone = mesh_file.weld(mesh_file.Mesh(positions, np.zeros((0, 2)), faces))
        self.assertEqual((len(welded.positions), gone, len(welded.faces)), (3, 3, 1))

    def test_an_obj_comes_back_as_it_went(self):
        mesh = prepare.sphere(8, 4)
        normals, of_corner = mesh_file.corner_normals(mesh, smooth=True)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "mesh.obj"
            mesh_file.write_obj(path, mesh, normals, of_corner, "test")
            back = mesh_file.read_obj(path)
        self.assertEqual(back.faces, mesh.faces)
        self.assertLess(np.abs(back.positions - mesh.positions).max(), 1e-6)


class Pictures(unittest.TestCase):
    def test_exr_comes_back_as_it_went(self):
        picture = np.random.default_rng(1).random((6, 9, 4), dtype=np.float32)
        with tempfile.TemporaryDirectory() as folder:
            pictures.write(Path(folder) / "picture.exr", picture)
            np.testing.assert_array_equal(pictures.read(Path(folder) / "picture.exr"), picture)

    def test_the_lobe_is_where_the_formula_says(self):
        picture = prepare.lobe_environment()
        row, column = np.unravel_index(picture[..., 0].argmax(), picture.shape[:2])
        height, width = picture.shape[:2]
        azimuth, polar = ((column + 0.5) / width - 0.5) * 2 * math.pi, (row + 0.5) / height * math.pi
        brightest = np.array(
            [math.sin(polar) * math.sin(azimuth), math.cos(polar), -math.sin(polar) * math.cos(azimuth)]
        )
        wanted = np.array(prepare.LOBE_DIRECTION) / np.linalg.norm(prepare.LOBE_DIRECTION)
        # Half a texel's diagonal, rad.
        self.assertLess(math.acos(brightest @ wanted), 0.5 * math.hypot(math.pi / height, 2 * math.pi / width))


class Regions(unittest.TestCase):
    def test_noise_alone_stays_within_its_errors(self):
        random = np.random.default_rng(2)
        first, second = ([noisy(random) for _ in range(16)] for _ in range(2))
        report = compare(first, second)
        # 192 means with 30 degrees of freedom: variance of t² about 2.5, so 1.08 ± 0.11; 5 of these.
        self.assertTrue(0.5 < report["mean_square_in_standard_errors"] < 1.65, report["mean_square_in_standard_errors"])

    def test_a_difference_in_one_tile_is_found_there(self):
        first, second = np.ones((64, 64, 4), dtype=np.float32), np.ones((64, 64, 4), dtype=np.float32)
        first[16:24, 40:48, 1] = 1.5
        report = compare([first], [second])
        self.assertEqual(report["largest_is_in"], {"row": 2, "column": 5, "channel": "G"})
        self.assertAlmostEqual(report["largest_relative_difference"], 0.5, places=6)

    def test_only_what_both_cover_counts(self):
        first, second = np.ones((64, 64, 4), dtype=np.float32), np.ones((64, 64, 4), dtype=np.float32)
        first[:32, :, 3] = 0.5
        first[:32, :, :3] = 9.0
        report = compare([first], [second])
        self.assertEqual((len(report["tiles"]), report["largest_relative_difference"]), (32, 0.0))


class Errors(unittest.TestCase):
    def test_relative_rmse_is_that_of_a_known_error_without_fireflies(self):
        reference = np.ones((100, 100, 4), dtype=np.float32)
        picture = reference.copy()
        picture[..., :3] += 0.1
        picture[0, 0, :3] = 1e6
        # (1.1 - 1) / (1 + 0.01); the firefly is among the left out.
        self.assertAlmostEqual(error_over_time.relative_rmse(picture, reference), 0.1 / 1.01, places=6)


class Media(unittest.TestCase):
    def test_the_colour_for_cycles_gives_the_albedo_back(self):
        for albedo in (0.3, 0.678, 0.9585, 0.995):
            colour = cycles_scene.cycles_colour(albedo)
            self.assertAlmostEqual(cycles_scene.cycles_single_scattering_albedo(colour), albedo, places=9)

    def test_a_lamp_has_the_irradiance_of_its_intensity(self):
        light = scene_file.PointLight((0, 0, 0), (2.0, 1.0, 0.5), 40.0)
        # From far the sphere is a disc of solid angle pi r² / d²; here at 2 m.
        irradiance = light.radiance()[0] * math.pi * 0.04**2 / 2.0**2
        self.assertAlmostEqual(irradiance, 2.0 / 2.0**2, places=12)

    def test_fresnel_meets_normal_incidence_brewster_and_total_reflection(self):
        self.assertAlmostEqual(float(sphere_walk.fresnel(np.array([1.0]), 1.3)[0]), (0.3 / 2.3) ** 2, places=12)
        brewster = math.cos(math.atan(1.3))
        s = ((brewster - 1.3 * math.sin(math.atan(1.3))) / (brewster + 1.3 * math.sin(math.atan(1.3)))) ** 2
        self.assertAlmostEqual(float(sphere_walk.fresnel(np.array([brewster]), 1.3)[0]), 0.5 * s, places=12)
        self.assertEqual(float(sphere_walk.fresnel(np.array([0.3]), 1 / 1.3)[0]), 1.0)

    def test_a_white_sphere_loses_nothing(self):
        escaped = sphere_walk.walk(2.0, 1.0, 1.3, 5.0, 400, np.random.default_rng(3))
        # Roulette keeps the mean, not each weight: below 1e-3 of each of 400 weights, ten times over.
        self.assertLess(abs(escaped.mean() - 1.0), 1e-3)

    def test_a_large_matched_sphere_is_chandrasekhars_half_space(self):
        escaped = sphere_walk.walk(1.0, 0.8, 1.0, 2000.0, 20_000, np.random.default_rng(4))
        # Diffuse albedo of the half-space at albedo 0.8, from Chandrasekhar's H function; four standard errors.
        self.assertLess(abs(escaped.mean() - 0.34186685), 4 * escaped.std() / math.sqrt(len(escaped)))


class SceneFiles(unittest.TestCase):
    def test_what_the_comparisons_do_not_know_is_refused(self):
        text = (prepare.HERE / "scenes" / "sphere.toml").read_text()
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "sphere.obj").write_text("")
            path = Path(folder) / "scene.toml"
            path.write_text(text)
            self.assertEqual(scene_file.read(path).sigma_t_per_mm[0], 0.032 + 0.74)
            path.write_text(text.replace("roughness = 0.3", "roughness = 0.3\nspecular = 0.5"))
            with self.assertRaises(SystemExit):
                scene_file.read(path)


class Curves(unittest.TestCase):
    def test_rows_of_the_bench_are_read_and_all_else_is_left_out(self):
        lines = ["cpu: 2 threads", "| operator | texels | polynomials | links, s | in a pose, s | light, s | adapter, s | error, % | near seams, % |",
                 "|---|---|---|---|---|---|---|---|---|", "| heat-flow | 512² | 12 | 0.1 | 0.05 | 0.02 | 0.3 | 2.9 | 5.9 |"]
        rows = heat_flow_curve.rows_of(lines)
        self.assertEqual([(row["operator"], row["texels"], row["near_seams_percent"]) for row in rows], [("heat-flow", 512, 5.9)])


def noisy(random: np.random.Generator) -> np.ndarray:
    picture = np.ones((64, 64, 4), dtype=np.float32)
    picture[..., :3] += 0.3 * random.standard_normal((64, 64, 3))
    return picture


def compare(first: list[np.ndarray], second: list[np.ndarray]) -> dict:
    mask = regions.common_mask(first + second)
    kept = regions.tiles_with_enough(mask)
    return regions.compare(regions.of_pictures(first, mask, kept), regions.of_pictures(second, mask, kept), mask, kept)


if __name__ == "__main__":
    unittest.main()
