//! Every shader parses, and asks for nothing that a WebGPU device with default features lacks.

use cutis_gpu::{cost, shaders};
use naga::valid::{Capabilities, ValidationFlags, Validator};

#[test]
fn every_shader_is_valid_on_a_default_device() {
    for (name, source) in shaders::ALL {
        let module = naga::front::wgsl::parse_str(source)
            .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)));
        let validated = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
        if let Err(error) = validated {
            panic!("{name}: {}", error.emit_to_string(source));
        }
    }
}

#[test]
fn reads_of_textures_are_counted_for_every_entry_point() {
    let module = |source| naga::front::wgsl::parse_str(source).expect("WGSL parses");
    let entries = shaders::ALL.iter().flat_map(|(_, source)| module(source).entry_points);
    let shading: Vec<_> =
        entries.filter(|e| e.stage != naga::ShaderStage::Vertex).map(|entry| entry.name).collect();
    for entry in &shading {
        assert!(cost::TAPS.iter().any(|(name, _)| name == entry), "{entry} is not in the table");
    }
    for (name, _) in cost::TAPS {
        assert!(shading.iter().any(|entry| entry == name), "{name} is in no shader");
    }
}
