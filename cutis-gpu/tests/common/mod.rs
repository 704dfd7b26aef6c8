//! An adapter to test on, scenes to draw, and how far two maps are apart.

#![allow(dead_code, reason = "every test binary uses its own part")]

pub mod tolerances;

use cutis_gpu::map::Map;
use cutis_gpu::passes::Passes;
use cutis_gpu::readback::read_layer;
use cutis_gpu::{Adapters, Gpu, GpuError, GpuRenderer};
use cutis_render::Settings;
use cutis_scene::head::HeadDetail;
use cutis_scene::validation::shapes;
use cutis_scene::{Camera, Light, Material, Object, ReadOptions, Scene, read_scene, studio};
use glam::{Vec3, Vec4};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A renderer on whatever adapter there is, or `None` with a line on stderr; `CUTIS_REQUIRE_GPU=1` forbids that.
/// An adapter that refuses to compile the passes fails the test.
pub fn renderer(test: &str) -> Option<&'static GpuRenderer> {
    static RENDERER: OnceLock<Result<GpuRenderer, GpuError>> = OnceLock::new();
    match RENDERER.get_or_init(|| GpuRenderer::new(Adapters::Any)) {
        Ok(renderer) => Some(renderer),
        Err(why) => {
            let is_absent = matches!(why, GpuError::NoAdapter { .. } | GpuError::NoDevice { .. });
            assert!(is_absent, "{test}: {why}");
            let required = std::env::var_os("CUTIS_REQUIRE_GPU").is_some_and(|v| v == "1");
            assert!(!required, "{test}: {why}");
            eprintln!("SKIPPED: {test}: {why}");
            None
        }
    }
}

/// The folder of shared assets, or `None` with a line on stderr; `CUTIS_REQUIRE_ASSETS=1` forbids that.
pub fn assets(test: &str) -> Option<PathBuf> {
    let given = std::env::var_os("CUTIS_ASSETS").map(PathBuf::from);
    let usual = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/assets");
    let folder = given.unwrap_or_else(usual);
    if folder.is_dir() {
        return Some(folder);
    }
    let why = format!("the assets folder {} does not exist; set CUTIS_ASSETS", folder.display());
    assert!(std::env::var_os("CUTIS_REQUIRE_ASSETS").is_none_or(|v| v != "1"), "{test}: {why}");
    eprintln!("SKIPPED: {test}: {why}");
    None
}

/// The scanned head by the project's own scene file, where the assets are.
pub fn scanned_head(test: &str) -> Option<Scene> {
    let folder = assets(test)?;
    let options = ReadOptions { assets_folder: Some(folder), ..ReadOptions::default() };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/lee_perry_smith.toml");
    Some(read_scene(&file, &options).expect("the scene of the scan is valid"))
}

/// How frames are drawn that both backends draw.
pub fn small_frame() -> Settings {
    Settings {
        width: 160,
        height: 160,
        irradiance_size: 512,
        samples_per_pixel: 9,
        shadow_samples: 16,
        ..Settings::default()
    }
}

/// A small built-in head in the studio, before a dark grey.
pub fn head_in_the_studio() -> Scene {
    let detail = HeadDetail { triangles: 10_000, map_size: 128 };
    Scene { background: Some(Vec3::splat(0.02)), ..studio::head_in_the_studio(detail) }
}

/// How an axis of a texture lies on the plane: share of the texture to millimetres, growing.
pub type AxisMap = fn(f64) -> f64;

/// A flat patch over nearly the whole texture.
pub fn patch(along_u: AxisMap, along_v: AxisMap) -> Object {
    Object::new("patch", shapes::patch(64, 1.0 / 128.0, along_u, along_v), Material::default())
}

/// A patch under a spot whose edge lies across it: no shadow, but light that has somewhere to spread.
pub fn patch_under_a_spot(object: Object) -> Scene {
    let [lo, hi] = object.mesh.bounds_mm().expect("has points");
    let middle = 0.5 * (lo + hi);
    let spot = Light::Spot {
        position_mm: middle + Vec3::new(30.0, 20.0, 150.0),
        dir_travel: Vec3::new(-30.0, -20.0, -150.0).normalize(),
        intensity_w_per_sr: Vec3::new(0.05, 0.045, 0.04),
        inner_cone_rad: 0.05,
        outer_cone_rad: 0.12,
        radius_mm: 0.0,
    };
    Scene {
        camera: Camera::framing([lo, hi], Vec3::new(0.3, 0.2, 1.0), 0.4),
        objects: vec![object],
        lights: vec![spot],
        environment: None,
        background: None,
        warnings: Vec::new(),
    }
}

/// Mean absolute difference of what two maps hold, relative to the mean of the second, and the share of texels that differ
/// by more than a tenth of that mean. Only texels that `counts` are looked at.
pub fn difference(got: &[Vec4], expected: &[Vec4], counts: impl Fn(usize) -> bool) -> Difference {
    assert_eq!(got.len(), expected.len());
    let texels: Vec<_> = (0..got.len()).filter(|&i| counts(i)).collect();
    let mean =
        texels.iter().map(|&i| rgb(expected[i]).abs().element_sum() / 3.0).sum::<f32>() / texels.len() as f32;
    let off = |i: usize| (rgb(got[i]) - rgb(expected[i])).abs().element_sum() / 3.0;
    let far = texels.iter().filter(|&&i| off(i) > 0.1 * mean || off(i).is_nan()).count();
    let sum = texels.iter().map(|&i| off(i)).sum::<f32>();
    Difference { mean: sum / texels.len() as f32 / mean, far: far as f32 / texels.len() as f32 }
}

/// How far two maps are apart.
#[derive(Debug, Clone, Copy)]
pub struct Difference {
    /// Mean absolute difference, relative to the mean.
    pub mean: f32,
    /// Share of texels that differ by more than a tenth of the mean.
    pub far: f32,
}

impl Difference {
    /// Fails if it is more than is allowed.
    pub fn check(self, what: &str, allowed: tolerances::Tolerance) {
        eprintln!("{what}: mean difference {:.5}, far off {:.5}", self.mean, self.far);
        assert!(
            self.mean <= allowed.mean && self.far <= allowed.far,
            "{what}: {self:?}, allowed {allowed:?}"
        );
    }
}

fn rgb(v: Vec4) -> Vec3 {
    v.truncate()
}

/// A layer of a map.
pub fn read(gpu: &Gpu, map: &Map, layer: u32) -> Vec<Vec4> {
    read_layer(gpu, map, layer).expect("the device is there")
}

/// The renderer's device and passes.
pub fn parts(renderer: &GpuRenderer) -> (&Gpu, &Passes) {
    (&renderer.gpu, &renderer.passes)
}
