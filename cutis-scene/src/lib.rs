//! What is lit: meshes with their UV charts, textures, lights, camera, and the readers that bring them in.
//!
//! A [`Scene`] is complete and believed: every reader checks what it reads, converts lengths to millimetres and
//! colours to linear Rec. 709, and ends in a [`SceneError`] that names file, place and reason where it cannot.
//! Nothing here draws; `cutis-render` does.

pub mod bvh;
pub mod camera;
pub mod charts;
pub mod closing;
pub mod deform;
pub mod environment;
pub mod error;
pub mod head;
pub mod light;
pub mod material;
pub mod mesh;
pub mod object;
pub mod pose;
pub mod projector;
pub mod read;
pub mod skeleton;
pub mod solids;
pub mod source;
pub mod studio;
pub mod tangents;
pub mod texture;
pub mod tiles;
pub mod topology;
pub mod unwrap;
pub mod validation;

mod scale;
mod scene;
mod write;

pub use bvh::{Bvh, Hit};
pub use camera::{Camera, CameraRays};
pub use charts::Charts;
pub use environment::Environment;
pub use error::SceneError;
pub use light::{Light, LightSample};
pub use material::{ColourMap, Material, NormalMap, NormalSpace, ScalarMap, Scattering, SecondMedium};
pub use mesh::{Mesh, MorphTarget};
pub use object::{Object, SurfacePoint};
pub use pose::{MeshPose, Pose, PoseError, Wave};
pub use projector::Projector;
pub use read::{AtlasChoice, ColourSpace, PictureFile, ReadOptions, read_image, read_picture, read_scene};
pub use scene::Scene;
pub use skeleton::{Influence, Joint, Skeleton};
pub use source::{MeshOrigin, ObjectSource, TextureSource};
pub use texture::{Texels, Texture};
pub use write::write_scene;
