//! Lights as shaders read them, and how each light's map is laid over the scene.

use bytemuck::{Pod, Zeroable};
use cutis_render::prepare::LightView;
use cutis_scene::{Light, Object, Projector};
use glam::Vec3;

/// In place of a layer: the light has no shadow map.
pub const NO_MAP: u32 = u32::MAX;
/// One light; the twin of `Light` in `lib/lights.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct GpuLight {
    /// Position, mm.
    pub position_mm: [f32; 3],
    /// 0 directional, 1 point, 2 spot, 3 projector.
    pub kind: u32,
    /// Towards the light if it is directional, along its axis if it is a spot or a projector.
    pub dir: [f32; 3],
    /// Radius in mm, or the tangent of the angular radius.
    pub extent: f32,
    /// W/m² if it is directional, else W/sr.
    pub strength: [f32; 3],
    /// Cosine of a spot's inner cone.
    pub cos_inner: f32,
    /// The map's axis to the right.
    pub map_right: [f32; 3],
    /// Cosine of a spot's outer cone.
    pub cos_outer: f32,
    /// The map's axis upwards.
    pub map_up: [f32; 3],
    /// Half the width of the map: in mm, or at distance 1.
    pub map_half_width: f32,
    /// The map's axis away from the light.
    pub map_forward: [f32; 3],
    /// Depth of what is nearest to the light, mm.
    pub map_near_mm: f32,
    /// Where depth begins, mm.
    pub map_origin_mm: [f32; 3],
    /// Depth behind everything, mm.
    pub map_far_mm: f32,
    /// Layer of the maps, or [`NO_MAP`].
    pub map_layer: u32,
    /// Number of the first texel of a projector's image: see [`super::slides`].
    pub slide_first: u32,
    /// Width of that image, texels.
    pub slide_width: u32,
    /// Height of it, texels.
    pub slide_height: u32,
    /// Its axis to the right as it leaves the lens.
    pub slide_right: [f32; 3],
    /// Tangent of half its vertical angle.
    pub tan_half_height: f32,
    /// How far it has moved to the right and up, in parts of its size.
    pub slide_shift: [f32; 2],
    /// Fills up the struct.
    pub pad0: f32,
    /// Fills up the struct.
    pub pad1: f32,
}

impl GpuLight {
    /// In place of a light where there is none.
    pub const DARK: Self = Self {
        position_mm: [0.0; 3],
        kind: 1,
        dir: [0.0, 0.0, 1.0],
        extent: 0.0,
        strength: [0.0; 3],
        cos_inner: 0.0,
        map_right: [0.0; 3],
        cos_outer: 0.0,
        map_up: [0.0; 3],
        map_half_width: 0.0,
        map_forward: [0.0; 3],
        map_near_mm: 0.0,
        map_origin_mm: [0.0; 3],
        map_far_mm: 0.0,
        map_layer: NO_MAP,
        slide_first: 0,
        slide_width: 0,
        slide_height: 0,
        slide_right: [0.0; 3],
        slide_shift: [0.0; 2],
        pad0: 0.0,
        pad1: 0.0,
        tan_half_height: 0.0,
    };

    /// A light over some objects, whose map is layer `layer`, with room for what is grown. The map is left out if the light
    /// stands among them.
    pub fn new(light: &Light, objects: &[Object], growth_mm: f32, layer: Option<u32>) -> Self {
        let positions = objects.iter().flat_map(|object| object.mesh.positions_mm.iter().copied());
        Self::over_points(light, grown(positions, growth_mm), layer)
    }

    /// A light whose map shows some points.
    pub fn over_points(light: &Light, shown: impl Iterator<Item = Vec3> + Clone, layer: Option<u32>) -> Self {
        let mut gpu = without_map(light);
        let Some(layer) = layer else { return gpu };
        let Some(view) = LightView::over_points(light, shown) else { return gpu };
        gpu.map_right = view.right.to_array();
        gpu.map_up = view.up.to_array();
        gpu.map_forward = view.forward.to_array();
        gpu.map_origin_mm = view.origin_mm.to_array();
        gpu.map_half_width = view.half_width;
        gpu.map_near_mm = view.near_mm;
        gpu.map_far_mm = view.far_mm;
        gpu.map_layer = layer;
        gpu
    }
}

/// Corners of boxes around points, which hold what lies so near to them; the points themselves, if that is nothing.
pub(super) fn grown(
    points: impl Iterator<Item = Vec3> + Clone,
    growth_mm: f32,
) -> impl Iterator<Item = Vec3> + Clone {
    let corners = if growth_mm > 0.0 { 8 } else { 1 };
    points.flat_map(move |p| {
        (0..corners).map(move |i| {
            let side = |axis: u32| if i >> axis & 1 == 0 { growth_mm } else { -growth_mm };
            p + Vec3::new(side(0), side(1), side(2))
        })
    })
}

fn without_map(light: &Light) -> GpuLight {
    let mut gpu = GpuLight { map_layer: NO_MAP, ..GpuLight::zeroed() };
    match *light {
        Light::Projector(Projector {
            position_mm,
            axes: [right, _, along],
            tan_half_height,
            ref image,
            intensity_w_per_sr,
            radius_mm,
            shift,
            ..
        }) => {
            gpu.slide_shift = shift.to_array();
            gpu.kind = 3;
            gpu.position_mm = position_mm.to_array();
            gpu.dir = along.to_array();
            gpu.strength = intensity_w_per_sr.to_array();
            gpu.extent = radius_mm;
            gpu.slide_right = right.to_array();
            gpu.tan_half_height = tan_half_height;
            (gpu.slide_width, gpu.slide_height) = (image.width(), image.height());
        }
        Light::Directional { dir_to_light, irradiance_w_per_m2, angular_radius_rad } => {
            gpu.dir = dir_to_light.to_array();
            gpu.strength = irradiance_w_per_m2.to_array();
            gpu.extent = angular_radius_rad.tan();
        }
        Light::Point { position_mm, intensity_w_per_sr, radius_mm } => {
            gpu.kind = 1;
            gpu.position_mm = position_mm.to_array();
            gpu.strength = intensity_w_per_sr.to_array();
            gpu.extent = radius_mm;
        }
        Light::Spot {
            position_mm,
            dir_travel,
            intensity_w_per_sr,
            inner_cone_rad,
            outer_cone_rad,
            radius_mm,
        } => {
            gpu.kind = 2;
            gpu.position_mm = position_mm.to_array();
            gpu.dir = dir_travel.to_array();
            gpu.strength = intensity_w_per_sr.to_array();
            gpu.extent = radius_mm;
            gpu.cos_inner = inner_cone_rad.cos();
            gpu.cos_outer = outer_cone_rad.cos();
        }
    }
    gpu
}
