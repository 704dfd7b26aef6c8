//! Every shader parses, and asks for nothing that a WebGPU device with default features lacks.

use cutis_gpu::shaders;
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
