//! Every struct that Rust and WGSL share lies the same in both: names, offsets, sizes.

use cutis_gpu::passes::depth_map::Grown;
use cutis_gpu::passes::diffusion::{Along, Halved, Widening};
use cutis_gpu::passes::downsample::Pixels;
use cutis_gpu::passes::gather::{Gaussian, Gaussians};
use cutis_gpu::passes::heat_flow::{Link, Stage};
use cutis_gpu::passes::inside::depth_absorption::DepthAbsorption;
use cutis_gpu::passes::inside::wrap::Wrap;
use cutis_gpu::passes::levels::{LevelSize, MAX_GAUSSIANS, MAX_SIZES};
use cutis_gpu::passes::openness;
use cutis_gpu::passes::resolve::{LayerKind, Wanted};
use cutis_gpu::passes::sample_profile::{Gathering, PlaceToLook, Radial};
use cutis_gpu::passes::seven_taps::SevenTaps;
use cutis_gpu::passes::shadow::Drawn;
use cutis_gpu::passes::shares::ShareGroup;
use cutis_gpu::passes::thin_parts::Body;
use cutis_gpu::passes::tone_map::{self, GpuFilm};
use cutis_gpu::passes::transmission::{Slab, Slabs, Smoothing, TEXELS_OF_MARK};
use cutis_gpu::passes::visibility::Group;
use cutis_gpu::scene::camera::GpuCamera;
use cutis_gpu::scene::deformable::{Deformation, GpuInfluence, JointPair, Offset};
use cutis_gpu::scene::environment::GpuEnvironment;
use cutis_gpu::scene::geometry::Vertex;
use cutis_gpu::scene::lights::{GpuLight, NO_MAP};
use cutis_gpu::scene::material::GpuMaterial;
use cutis_gpu::scene::slides::EXPONENT;
use cutis_gpu::{passes, shaders};
use cutis_optics::sample::INTERLEAVED_PIXELS;
use cutis_render::film::{self, ToneMapper, dither};
use cutis_render::passes::irradiance_image;
use cutis_render::passes::tap::NARROW_TEXEL2;
use cutis_render::passes::transmission::{FADE_DEVIATIONS, VISIBLE};
use cutis_render::passes::visibility::THINNEST_MM;
use cutis_render::prepare::radial;
use cutis_render::prepare::rho_dt::{COSINES, ROUGHNESSES};
use cutis_render::specular_brdf::MIN_ROUGHNESS;
use cutis_render::technique::depth_absorption;
use cutis_render::technique::image_space;
use std::mem::{offset_of, size_of};

fn module(source: &str) -> naga::Module {
    naga::front::wgsl::parse_str(source).expect("WGSL parses")
}

/// Name and offset of every member of a WGSL struct, and its size.
fn wgsl_layout(source: &str, name: &str) -> (Vec<(String, usize)>, usize) {
    let module = module(source);
    let (_, ty) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).expect("is declared");
    let naga::TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is not a struct") };
    let named = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize));
    (named.collect(), *span as usize)
}

/// Compares a Rust struct with the WGSL struct of a name in a shader.
macro_rules! same_layout {
    ($rust:ty, $shader:expr, $name:literal, [$($field:ident),+ $(,)?]) => {{
        let (wgsl, size) = wgsl_layout($shader, $name);
        let rust = [$((stringify!($field).to_owned(), offset_of!($rust, $field))),+];
        assert_eq!(wgsl, rust, "{}", $name);
        assert_eq!(size, size_of::<$rust>(), "{}", $name);
    }};
}

#[test]
fn structs_of_poses_match_wgsl() {
    same_layout!(
        Deformation,
        shaders::DEFORM,
        "Deformation",
        [
            wave_direction,
            wave_amplitude_mm,
            wave_travel,
            wavelength_mm,
            wave_phase_rad,
            turned,
            morphed,
            pad0
        ]
    );
    same_layout!(Offset, shaders::DEFORM, "Offset", [position_mm, morph_target, normal, pad0, tangent, pad1]);
    same_layout!(GpuInfluence, shaders::DEFORM, "Influence", [joints, weights]);
    same_layout!(JointPair, shaders::DEFORM, "JointPair", [rest, posed]);
}

#[test]
fn structs_of_the_scene_match_wgsl() {
    same_layout!(
        Vertex,
        shaders::STRETCH,
        "Vertex",
        [position_mm, map_u, normal, map_v, tangent, atlas_uv, pad0, pad1]
    );
    same_layout!(
        GpuLight,
        shaders::SHADOW,
        "Light",
        [
            position_mm,
            kind,
            dir,
            extent,
            strength,
            cos_inner,
            map_right,
            cos_outer,
            map_up,
            map_half_width,
            map_forward,
            map_near_mm,
            map_origin_mm,
            map_far_mm,
            map_layer,
            slide_first,
            slide_width,
            slide_height,
            slide_right,
            tan_half_height,
            slide_shift,
            pad0,
            pad1
        ]
    );
    same_layout!(
        GpuMaterial,
        shaders::ATLAS,
        "Material",
        [albedo_factor, albedo_mix, rho_s, f0, roughness, relief_strength, share, relief_space]
    );
    same_layout!(
        GpuEnvironment,
        shaders::SKY,
        "Environment",
        [radiance_scale, rotation_rad, roughnesses, last_roughness, pad0, pad1, pad2]
    );
    same_layout!(
        GpuCamera,
        shaders::SKY,
        "Camera",
        [position_mm, near_mm, forward, far_mm, right, pad0, up, pad1]
    );
}

#[test]
fn structs_of_the_passes_match_wgsl() {
    same_layout!(Drawn, shaders::SHADOW, "Drawn", [light, object, smooth_plane, pad0]);
    same_layout!(Grown, shaders::DEPTH_MAP, "Grown", [light, growth_mm, pad0, pad1]);
    same_layout!(
        DepthAbsorption,
        shaders::RESOLVE_DEPTH_ABSORPTION,
        "DepthAbsorption",
        [sigma_t_per_mm, thickness_scale, colour, filter_radius_mm, samples, layers, by_surface, stops]
    );
    same_layout!(
        Group,
        shaders::VISIBILITY,
        "Group",
        [first_light, light_count, object, samples, opaque_mm, thickness_scale, pad0, pad1]
    );
    same_layout!(SevenTaps, shaders::SEVEN_TAPS, "SevenTaps", [all, step_texels, axis, factor]);
    same_layout!(
        Body,
        shaders::THIN_PARTS,
        "Body",
        [deviation_mm, thickness_scale, object, many_lights, pad0, pad1]
    );
    same_layout!(ShareGroup, shaders::SHARES, "Group", [first_light, pad0, pad1, pad2]);
    same_layout!(
        Widening,
        shaders::TAPS,
        "Widening",
        [from_mm2, to_mm2, saved_texel2, unit_variance, weights, axis, pad0, pad1, pad2]
    );
    same_layout!(Along, shaders::BLUR, "Along", [step_texels, axis, pad0]);
    same_layout!(Halved, shaders::HALVE, "Halved", [layer, factor, pad0, pad1]);
    for shader in [shaders::GATHER, shaders::TRANSMISSION] {
        same_layout!(LevelSize, shader, "LevelSize", [halvings, end, finer_halvings, finer_layer]);
    }
    same_layout!(Gaussian, shaders::GATHER, "Gaussian", [weight, layer]);
    same_layout!(Gaussians, shaders::GATHER, "Gaussians", [all, sizes, size_count, pad0, pad1, pad2]);
    same_layout!(
        Slab,
        shaders::TRANSMISSION,
        "Slab",
        [weight, variance_mm2, layer, before_layer, before_halvings, pad0]
    );
    same_layout!(Slabs, shaders::TRANSMISSION, "Slabs", [all, sizes, count, size_count, object, many_lights]);
    same_layout!(Smoothing, shaders::SMOOTH, "Smoothing", [step, reach, pad0, pad1]);
    same_layout!(Wanted, shaders::RESOLVE, "Wanted", [layer, samples, pad0, pad1]);
    same_layout!(
        Wrap,
        shaders::RESOLVE_WRAP,
        "Wrap",
        [
            wraps,
            scatter_width,
            scatter_colour,
            shininess,
            specular_colour,
            shadow_offset_mm,
            colour,
            by_table,
            energy_conserving,
            by_power,
            pad0,
            pad1
        ]
    );
    same_layout!(Pixels, shaders::DOWNSAMPLE, "Pixels", [grid, pad0, pad1, pad2]);
    same_layout!(
        GpuFilm,
        shaders::TONE_MAP,
        "Film",
        [gain, behind, strength, tone_mapper, cell, reach, pad0, pad1, weights]
    );
}

/// A constant of a shader.
fn constant(source: &str, name: &str) -> f64 {
    let module = module(source);
    let (_, found) =
        module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name)).expect("is declared");
    match module.global_expressions[found.init] {
        naga::Expression::Literal(naga::Literal::F32(value)) => f64::from(value),
        naga::Expression::Literal(naga::Literal::U32(value)) => f64::from(value),
        naga::Expression::Literal(naga::Literal::I32(value)) => f64::from(value),
        ref other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn constants_match_wgsl() {
    let expected = [
        (shaders::BLUR, "TILE_TEXELS", passes::TILE_TEXELS as f64),
        (shaders::GATHER, "MAX_GAUSSIANS", MAX_GAUSSIANS as f64),
        (shaders::GATHER, "MAX_SIZES", MAX_SIZES as f64),
        (shaders::SMOOTH, "TEXELS_OF_MARK", f64::from(TEXELS_OF_MARK)),
        (shaders::OPENNESS, "HALVINGS", openness::HALVINGS as f64),
        (shaders::GATHER, "NO_CHART", f64::from(u16::MAX)),
        (shaders::SHADOW, "NO_MAP", f64::from(NO_MAP)),
        (shaders::SHADOW, "SLIDE_EXPONENT", f64::from(EXPONENT)),
        (shaders::IRRADIANCE, "COSINES", COSINES as f64),
        (shaders::IRRADIANCE, "ROUGHNESSES", ROUGHNESSES as f64),
        (shaders::IRRADIANCE, "MIN_ROUGHNESS", f64::from(MIN_ROUGHNESS)),
        (shaders::TAPS, "NARROW_TEXEL2", NARROW_TEXEL2),
        (shaders::TRANSMISSION, "FADE_DEVIATIONS", f64::from(FADE_DEVIATIONS)),
        (shaders::TRANSMISSION, "VISIBLE", f64::from(VISIBLE)),
        (shaders::VISIBILITY, "THINNEST_MM", f64::from(THINNEST_MM)),
        (shaders::RESOLVE, "LEVEL", f64::from(LayerKind::Level as u32)),
        (shaders::RESOLVE, "DISTANCES", f64::from(LayerKind::Distances as u32)),
        (shaders::RESOLVE, "DISTANCE_OF_ONE", f64::from(LayerKind::DistanceOfOne as u32)),
        (shaders::RESOLVE, "NORMAL", f64::from(LayerKind::Normal as u32)),
        (shaders::RESOLVE, "ALBEDO", f64::from(LayerKind::Albedo as u32)),
        (shaders::RESOLVE, "SPECULAR", f64::from(LayerKind::Specular as u32)),
        (shaders::RESOLVE, "TRANSMISSION", f64::from(LayerKind::Transmission as u32)),
        (shaders::RESOLVE, "DIFFUSE", f64::from(LayerKind::Diffuse as u32)),
        (shaders::RESOLVE, "EXITANCE", f64::from(LayerKind::Exitance as u32)),
        (shaders::RESOLVE, "CHARTS", f64::from(LayerKind::Charts as u32)),
        (shaders::RESOLVE, "TEXEL", f64::from(LayerKind::Texel as u32)),
        (shaders::RESOLVE, "SAMPLES", f64::from(LayerKind::Samples as u32)),
        (shaders::RESOLVE, "WAYS", f64::from(LayerKind::Ways as u32)),
        (shaders::RESOLVE_DEPTH_ABSORPTION, "STREAM", f64::from(depth_absorption::STREAM)),
        (shaders::RESOLVE_DEPTH_ABSORPTION, "FADE_COS", f64::from(depth_absorption::FADE_COS)),
        (shaders::RESOLVE_DEPTH_ABSORPTION, "NO_WAY_MM", f64::from(depth_absorption::NO_WAY_MM)),
    ];
    for (source, name, value) in expected {
        assert_eq!(constant(source, name), value, "{name}");
    }
}

#[test]
fn images_of_projectors_are_bound_where_the_shaders_look_for_them() {
    for source in [shaders::IRRADIANCE, shaders::SHARES, shaders::RESOLVE] {
        let module = module(source);
        let (_, slides) = module
            .global_variables
            .iter()
            .find(|(_, v)| v.name.as_deref() == Some("slides"))
            .expect("is there");
        let binding = slides.binding.expect("is bound");
        assert_eq!([binding.group, binding.binding], [0, passes::SLIDES]);
        let others = module.global_variables.iter().filter(|(_, v)| v.binding == Some(binding));
        assert_eq!(others.count(), 1, "nothing else is bound there");
    }
}

#[test]
fn constants_of_the_film_match_wgsl() {
    let mapper = |tone_mapper| f64::from(tone_map::number(tone_mapper));
    let expected = [
        ("MAX_RADIANCE", f64::from(film::MAX_RADIANCE)),
        ("TURN_OF_COLUMN", f64::from(dither::TURN_OF_COLUMN)),
        ("TURN_OF_ROW", f64::from(dither::TURN_OF_ROW)),
        ("TURN_OF_CHANNEL", f64::from(dither::TURN_OF_CHANNEL)),
        ("STEEPNESS", f64::from(dither::STEEPNESS)),
        ("NONE", mapper(ToneMapper::None)),
        ("REINHARD", mapper(ToneMapper::Reinhard)),
        ("ACES", mapper(ToneMapper::Aces)),
        ("AGX", mapper(ToneMapper::AgX)),
        ("NEUTRAL", mapper(ToneMapper::Neutral)),
    ];
    for (name, value) in expected {
        assert_eq!(constant(shaders::TONE_MAP, name), value, "{name}");
    }
    assert_eq!(constant(shaders::TONE_MAP, "WIDTH") as f32, dither::WIDTH);
}

#[test]
fn the_table_of_taps_is_as_long_as_the_shader_takes_it_to_be() {
    let entries = constant(shaders::TAPS, "VARIANCES");
    assert_eq!(entries, cutis_render::passes::tap::TAPS.narrow.len() as f64);
}

#[test]
fn image_space_matches_wgsl() {
    same_layout!(
        Gathering,
        shaders::SAMPLE_PROFILE,
        "Gathering",
        [lights, light_count, place_count, jacobian, count_valid, mixtures, round, pad0, pad1]
    );
    same_layout!(Radial, shaders::SAMPLE_PROFILE, "Radial", [fine_mm, entries_per_e, pad0, pad1]);
    same_layout!(PlaceToLook, shaders::SAMPLE_PROFILE, "PlaceToLook", [offset_mm, density_per_mm2, pad0]);
    same_layout!(Drawn, shaders::IRRADIANCE_IMAGE, "Drawn", [light, object, smooth_plane, pad0]);
    let expected = [
        ("ENTRIES", radial::ENTRIES as f64),
        ("INTERLEAVED_PIXELS", f64::from(INTERLEAVED_PIXELS)),
        ("GRAZING", f64::from(irradiance_image::GRAZING)),
        ("ROUNDING", f64::from(irradiance_image::ROUNDING)),
        ("MAX_GAIN", f64::from(image_space::MAX_GAIN)),
        ("MAX_JACOBIAN", f64::from(irradiance_image::MAX_JACOBIAN)),
        ("SAME_SURFACE_TEXELS", f64::from(irradiance_image::SAME_SURFACE_TEXELS)),
        ("SAME_SIDE", f64::from(irradiance_image::SAME_SIDE)),
        ("MIN_SLANT", f64::from(irradiance_image::MIN_SLANT)),
    ];
    for (name, value) in expected {
        assert_eq!(constant(shaders::SAMPLE_PROFILE, name), value, "{name}");
    }
}

#[test]
fn heat_flow_matches_wgsl() {
    for source in [shaders::HEAT_FLOW, shaders::HEAT_ROWS] {
        same_layout!(Stage, source, "Stage", [parts, factor, kept, size, seed]);
    }
    same_layout!(Link, shaders::HEAT_ROWS, "Link", [texel, strength]);
}
