//! Each pass on both backends, from the same input.

mod common;

use common::tolerances;
use common::{difference, head_in_the_studio, patch, patch_under_a_spot, read, renderer};
use cutis_gpu::{GpuRenderer, GpuScene};
use cutis_render::lit_scene::LitScene;
use cutis_render::passes::atlas::NO_CHART;
use cutis_render::passes::object_maps::ObjectMaps;
use cutis_render::{Aov, AovSpace, CpuRenderer, Renderer, Settings, Silent};
use cutis_scene::{Light, Material, Mesh, Object, Scene};
use glam::{Vec2, Vec3, Vec4};

fn settings() -> Settings {
    Settings { width: 32, height: 32, irradiance_size: 512, samples_per_pixel: 1, ..Settings::default() }
}

/// The head under its two lights without extent: every ray is all or nothing.
fn head_under_sharp_lights() -> Scene {
    let mut scene = head_in_the_studio();
    for light in &mut scene.lights {
        match light {
            Light::Point { radius_mm, .. } | Light::Spot { radius_mm, .. } => *radius_mm = 0.0,
            Light::Projector(projector) => projector.radius_mm = 0.0,
            Light::Directional { angular_radius_rad, .. } => *angular_radius_rad = 0.0,
        }
    }
    scene
}

/// A scene on both.
struct Both<'a> {
    renderer: &'a GpuRenderer,
    gpu: GpuScene,
    cpu: LitScene<&'a Scene>,
    scene: &'a Scene,
}

impl<'a> Both<'a> {
    fn new(renderer: &'a GpuRenderer, scene: &'a Scene, settings: &Settings) -> Self {
        let gpu = renderer.scene(scene, settings, &Silent).expect("is uploaded");
        gpu.draw(&renderer.gpu).expect("is drawn");
        let cpu = LitScene::new(scene, settings, &Silent).expect("draws");
        Self { renderer, gpu, cpu, scene }
    }

    fn maps(&self) -> &ObjectMaps {
        &self.cpu.maps()[0]
    }

    /// Whether a chart covers a texel.
    fn inside(&self, texel: usize) -> bool {
        self.maps().atlas.charts.chart[texel] != NO_CHART
    }

    /// The processor's value for every texel, from its surface point.
    fn at_points(&self, value: impl Fn(&cutis_scene::SurfacePoint) -> Vec3) -> Vec<Vec4> {
        let atlas = &self.maps().atlas;
        let point = |t: usize| atlas.surface_point(&self.scene.objects[0], t);
        (0..atlas.size * atlas.size).map(|t| point(t).map_or(Vec4::ZERO, |p| value(&p).extend(0.0))).collect()
    }

    fn texture(&self, aov: Aov) -> Vec<Vec4> {
        let GpuRenderer { gpu, passes, .. } = self.renderer;
        let mut layers = self.gpu.layers(gpu, passes, &[aov], AovSpace::Texture).expect("is read");
        layers.remove(0).pixels
    }
}

#[test]
fn stretch_is_that_of_the_processor() {
    let Some(renderer) = renderer("stretch_is_that_of_the_processor") else { return };
    let scene = head_under_sharp_lights();
    let both = Both::new(renderer, &scene, &settings());
    let wanted: Vec<_> = both.maps().stretch_mm.iter().map(|s| s.extend(0.0).extend(0.0)).collect();
    difference(&both.texture(Aov::Stretch), &wanted, |t| both.inside(t))
        .check("stretch", tolerances::STRETCH);
}

#[test]
fn the_atlas_is_that_of_the_processor() {
    let Some(renderer) = renderer("the_atlas_is_that_of_the_processor") else { return };
    let scene = head_under_sharp_lights();
    let both = Both::new(renderer, &scene, &settings());
    let [places, normals] = both.gpu.objects[0].atlas.unpacked(&renderer.gpu).expect("is read");
    let wanted = both.at_points(|p| p.position_mm);
    difference(&places, &wanted, |t| both.inside(t)).check("places", tolerances::PLACES);
    let wanted = both.at_points(|p| p.normal);
    difference(&normals, &wanted, |t| both.inside(t)).check("normals", tolerances::NORMALS);
}

#[test]
fn lights_see_what_rays_see() {
    let Some(renderer) = renderer("lights_see_what_rays_see") else { return };
    let scene = head_under_sharp_lights();
    let both = Both::new(renderer, &scene, &settings());
    let got = read(&renderer.gpu, &both.gpu.objects[0].visibility, 0);
    for l in 0..2 {
        let got: Vec<_> = got.iter().map(|v| Vec4::splat(v[l])).collect();
        let wanted: Vec<_> = both.maps().visibility[l].iter().map(|&v| Vec4::splat(v)).collect();
        difference(&got, &wanted, |t| both.inside(t)).check(&format!("light {l}"), tolerances::VISIBILITY);
    }
}

/// A ball that light comes through; of what is convex, rays and maps know the same surface.
fn ball() -> Object {
    let (rings, radius_mm) = (48, 5.0);
    let mut mesh = Mesh::default();
    for i in 0..=rings {
        for j in 0..=2 * rings {
            let uv = Vec2::new(j as f32 / (2 * rings) as f32, i as f32 / rings as f32);
            let (polar, azimuth) = (uv.y * std::f32::consts::PI, uv.x * std::f32::consts::TAU);
            let normal = Vec3::new(polar.sin() * azimuth.cos(), polar.cos(), -polar.sin() * azimuth.sin());
            mesh.positions_mm.push(normal * radius_mm);
            mesh.normals.push(normal);
            mesh.uvs.push(uv * 0.96 + 0.02);
        }
    }
    let row = 2 * rings + 1;
    for a in (0..rings).flat_map(|i| (0..2 * rings).map(move |j| i * row + j)) {
        mesh.triangles.extend([[a, a + row, a + 1], [a + 1, a + row, a + row + 1]]);
    }
    Object::new("ball", mesh, Material::default())
}

#[test]
fn distances_through_a_ball_are_those_of_rays() {
    let Some(renderer) = renderer("distances_through_a_ball_are_those_of_rays") else { return };
    let mut scene = patch_under_a_spot(ball());
    scene.lights = vec![Light::Directional {
        dir_to_light: Vec3::new(0.3, 0.4, -0.8).normalize(),
        irradiance_w_per_m2: Vec3::ONE,
        angular_radius_rad: 0.0,
    }];
    for thickness_scale in [1.0, 0.4, 1.4] {
        scene.objects[0].material.thickness_scale = thickness_scale;
        let both = Both::new(renderer, &scene, &settings());
        let levels = &both.maps().diffused.levels;
        let wanted: Vec<_> = levels[0].layers[0].iter().map(|d| Vec4::splat(d.w)).collect();
        let got: Vec<_> = both.texture(Aov::Thickness).iter().map(|d| Vec4::splat(d.x)).collect();
        let thin = |t: usize| both.inside(t) && wanted[t].x > 0.0;
        assert!((0..got.len()).filter(|&t| thin(t)).count() > 10_000, "half of the ball is in the dark");
        let what = format!("distance, scaled by {thickness_scale}");
        difference(&got, &wanted, thin).check(&what, tolerances::DISTANCE);
    }
}

#[test]
fn irradiance_is_that_of_the_processor_where_nothing_hides() {
    let Some(renderer) = renderer("irradiance_is_that_of_the_processor_where_nothing_hides") else { return };
    let mut scene = patch_under_a_spot(patch(|u| 40.0 * u, |v| 40.0 * v));
    scene.environment = Some(cutis_scene::studio::studio_environment());
    let both = Both::new(renderer, &scene, &settings());
    let wanted = &both.maps().diffused.levels[0].layers[0];
    difference(&both.texture(Aov::Irradiance), wanted, |t| both.inside(t))
        .check("patch", tolerances::IRRADIANCE);
}

#[test]
fn the_sum_of_gaussians_is_that_of_the_processor() {
    let Some(renderer) = renderer("the_sum_of_gaussians_is_that_of_the_processor") else { return };
    let scene = patch_under_a_spot(patch(|u| 60.0 * u, |v| 30.0 * v));
    let both = Both::new(renderer, &scene, &settings());
    let maps = both.maps();
    let size = maps.atlas.size;
    let wanted: Vec<_> = (0..size * size)
        .map(|t| {
            let uv = (glam::Vec2::new((t % size) as f32, (t / size) as f32) + 0.5) / size as f32;
            maps.diffused.weighted_sum(&maps.kernel.weights, uv, maps.atlas.charts.chart[t]).extend(0.0)
        })
        .collect();
    let got = read(&renderer.gpu, &both.gpu.objects[0].local, 0);
    difference(&got, &wanted, |t| both.inside(t)).check("patch", tolerances::LOCAL);
}

#[test]
fn light_that_comes_through_is_that_of_rays() {
    let Some(renderer) = renderer("light_that_comes_through_is_that_of_rays") else { return };
    let mut scene = head_under_sharp_lights();
    // From the side of an ear that the light behind shines through.
    scene.camera.position_mm = Vec3::new(400.0, 0.0, 500.0);
    let wanted = Settings { width: 128, height: 128, aovs: vec![Aov::Transmission], ..settings() };
    let gpu = renderer.render(&scene, &wanted, &Silent).expect("draws");
    let cpu = CpuRenderer.render(&scene, &wanted, &Silent).expect("draws");
    let covered = |i: usize| cpu.pixels[i].w > 0.99 && gpu.pixels[i].w > 0.99;
    let (got, wanted) = (&gpu.layers[0].pixels, &cpu.layers[0].pixels);
    difference(got, wanted, covered).check("transmission", tolerances::TRANSMISSION);
}
