//! The passes of the frame, by the names the papers give them. Each is a plain function from inputs to a map.

pub mod ambient;
pub mod atlas;
pub mod blur;
pub mod diffusion;
pub mod half_size;
pub mod heat_flow;
pub mod irradiance;
pub mod irradiance_image;
pub mod object_maps;
pub mod picture;
pub mod resolve;
pub mod seam_map;
pub mod seams;
pub mod seven_taps;
pub mod smooth;
pub mod specular;
pub mod stretch;
pub mod tap;
pub mod texel_widths;
pub mod thin_parts;
pub mod transmission;
pub mod visibility;
