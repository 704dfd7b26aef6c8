//! Images of one scene: each is decoded once, and all together stay within memory.

use super::file::read_bytes;
use super::image::{ColourSpace, decode};
use crate::error::one_line;
use crate::{SceneError, Texels, Texture, TextureSource};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most memory for all textures of a scene, bytes.
const MAX_BYTES: usize = 6 << 30;

/// Where an image comes from.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum Origin {
    /// A file of its own.
    File(PathBuf),
    /// An image inside another file, by its number.
    Embedded(usize),
}

/// Decoded images by origin and meaning.
#[derive(Default)]
pub(crate) struct Textures {
    decoded: HashMap<(Origin, ColourSpace), Arc<Texture>>,
    bytes: usize,
}

impl Textures {
    /// The image in a file; `path` was resolved before.
    pub(crate) fn file(
        &mut self,
        path: &Path,
        space: ColourSpace,
        warnings: &mut Vec<String>,
    ) -> Result<Arc<Texture>, SceneError> {
        let origin = Origin::File(path.to_owned());
        if let Some(texture) = self.decoded.get(&(origin.clone(), space)) {
            return Ok(texture.clone());
        }
        let bytes = read_bytes(path, "image")?;
        self.decode(origin, &bytes, space, warnings).map_err(|reason| SceneError::new(path, "image", reason))
    }

    /// An image from bytes, decoded unless its origin is known already.
    pub(crate) fn decode(
        &mut self,
        origin: Origin,
        bytes: &[u8],
        space: ColourSpace,
        warnings: &mut Vec<String>,
    ) -> Result<Arc<Texture>, String> {
        let key = (origin, space);
        if let Some(texture) = self.decoded.get(&key) {
            return Ok(texture.clone());
        }
        let mut mended = Vec::new();
        let texture = decode(bytes, space, &mut mended)?;
        let texture = Arc::new(match &key.0 {
            Origin::File(path) => texture.with_source(TextureSource::File(path.clone())),
            Origin::Embedded(_) => texture,
        });
        warnings.extend(mended.into_iter().map(|text| one_line(&format!("{}: {text}", key.0))));
        self.bytes += size_bytes(&texture);
        if self.bytes > MAX_BYTES {
            return Err(format!(
                "with it the textures take {} bytes; at most {MAX_BYTES} are used",
                self.bytes
            ));
        }
        self.decoded.insert(key, texture.clone());
        Ok(texture)
    }
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Embedded(index) => write!(f, "images[{index}]"),
        }
    }
}

fn size_bytes(texture: &Texture) -> usize {
    match texture.texels() {
        Texels::Srgb8(t) | Texels::Linear8(t) => 4 * t.len(),
        Texels::LinearF32(t) => 16 * t.len(),
    }
}
