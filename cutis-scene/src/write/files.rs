//! Files that a saved scene names: by a path below its own folder, on the shelf of assets, or copied beside it.

use super::Destination;
use super::whole::write_whole;
use crate::read::{assets_folder, gltf_neighbours, read_bytes};
use crate::{SceneError, Texels, Texture};
use std::collections::HashMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Most copies of one name: beyond it something else is wrong.
const MAX_NAMES: usize = 10_000;

/// The files of one scene.
pub(super) struct Files<'a> {
    destination: &'a Destination,
    assets: Option<PathBuf>,
    /// Text by which each file is named.
    named: HashMap<PathBuf, String>,
    /// Text by which each image without a file is named, with the end of its name.
    drawn: HashMap<(*const Texture, &'static str), String>,
}

impl<'a> Files<'a> {
    pub(super) fn new(destination: &'a Destination) -> Self {
        let assets = assets_folder(None).ok().and_then(|folder| folder.canonicalize().ok());
        Self { destination, assets, named: HashMap::new(), drawn: HashMap::new() }
    }

    /// The text by which the scene names a file; copies it if it lies elsewhere.
    pub(super) fn name(&mut self, path: &Path) -> Result<String, SceneError> {
        let file = path.canonicalize().map_err(|e| self.fail(path, format!("cannot be found: {e}")))?;
        if let Some(text) = self.named.get(&file) {
            return Ok(text.clone());
        }
        let below = |folder: &Path| file.strip_prefix(folder).ok().and_then(words);
        let text = if let Some(text) = below(&self.destination.folder) {
            // A folder called `assets:` would be read as the shelf; with a dot before it it is not.
            if text.contains(':') { format!("./{text}") } else { text }
        } else if let Some(text) = self.assets.as_deref().and_then(below) {
            format!("assets:{text}")
        } else {
            self.copy(&file)?
        };
        self.named.insert(file, text.clone());
        Ok(text)
    }

    /// Copies a file, and what it needs, into the folder beside the scene.
    fn copy(&self, file: &Path) -> Result<String, SceneError> {
        let name = file.file_name().and_then(|name| name.to_str());
        let Some(name) = name else { return Err(self.fail(file, "its name is no text")) };
        let neighbours = gltf_neighbours(file)?;
        if neighbours.is_empty() {
            return self.put(name, &read_bytes(file, "whole file")?);
        }
        // A glTF file names others by their place; all of them go into one folder of their own.
        let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        for (relative, neighbour) in &neighbours {
            let bytes = read_bytes(neighbour, "whole file")?;
            self.put_exactly(&Path::new(&stem).join(relative), &bytes)?;
        }
        self.put_exactly(&Path::new(&stem).join(name), &read_bytes(file, "whole file")?)
    }

    /// The text by which the scene names an image that has no file.
    pub(super) fn draw(&mut self, texture: &Texture, colour: bool) -> Result<String, SceneError> {
        let (bytes, end) = encoded(texture, colour).map_err(|why| self.fail(&self.destination.scene, why))?;
        let key = (std::ptr::from_ref(texture), end);
        if let Some(text) = self.drawn.get(&key) {
            return Ok(text.clone());
        }
        let text = self.put(&format!("map.{end}"), &bytes)?;
        self.drawn.insert(key, text.clone());
        Ok(text)
    }

    /// Writes bytes beside the scene under a free name; a file that holds them already is taken as it is.
    fn put(&self, name: &str, bytes: &[u8]) -> Result<String, SceneError> {
        let (stem, end) = name.rsplit_once('.').map_or((name, String::new()), |(s, e)| (s, format!(".{e}")));
        for i in 1..MAX_NAMES {
            let name = if i == 1 { name.to_owned() } else { format!("{stem}-{i}{end}") };
            if self.is_free_for(Path::new(&name), bytes) {
                return self.put_exactly(Path::new(&name), bytes);
            }
        }
        Err(self.fail(&self.destination.files, format!("has no free name for `{name}`")))
    }

    fn is_free_for(&self, name: &Path, bytes: &[u8]) -> bool {
        let place = self.destination.files.join(name);
        !place.exists() || holds(&place, bytes)
    }

    /// Writes bytes beside the scene under this name, or says that another file has it.
    fn put_exactly(&self, name: &Path, bytes: &[u8]) -> Result<String, SceneError> {
        let place = self.destination.files.join(name);
        if place.exists() && !holds(&place, bytes) {
            return Err(self.fail(&place, "is there already, and is another file; move it away first"));
        }
        if !place.exists() {
            let folder = place.parent().unwrap_or(&self.destination.files);
            fs::create_dir_all(folder).map_err(|e| self.fail(folder, format!("cannot be made: {e}")))?;
            write_whole(&place, bytes)?;
        }
        let below = place.strip_prefix(&self.destination.folder).ok().and_then(words);
        below.ok_or_else(|| self.fail(&place, "its name is no text"))
    }

    fn fail(&self, path: &Path, reason: impl Into<String>) -> SceneError {
        SceneError::new(path, "saving", reason)
    }
}

fn holds(place: &Path, bytes: &[u8]) -> bool {
    fs::metadata(place).is_ok_and(|m| m.len() == bytes.len() as u64)
        && fs::read(place).is_ok_and(|b| b == bytes)
}

/// A relative path with slashes, if it is text.
fn words(relative: &Path) -> Option<String> {
    let parts = relative.components().map(|part| match part {
        Component::Normal(name) => name.to_str(),
        _ => None,
    });
    parts.collect::<Option<Vec<_>>>().map(|parts| parts.join("/"))
}

/// An image file that is read back as the texels that are there: PNG where they have eight bits of the kind that is read,
/// EXR of 32 bits else.
fn encoded(texture: &Texture, colour: bool) -> Result<(Vec<u8>, &'static str), String> {
    let (width, height) = (texture.width(), texture.height());
    let mut bytes = std::io::Cursor::new(Vec::new());
    let (picture, format, end) = match (texture.texels(), colour) {
        (Texels::Srgb8(texels), true) | (Texels::Linear8(texels), false) => {
            let buffer = image::RgbaImage::from_raw(width, height, texels.as_flattened().to_vec());
            (buffer.map(image::DynamicImage::ImageRgba8), image::ImageFormat::Png, "png")
        }
        _ => {
            let texels = (0..height).flat_map(|y| (0..width).map(move |x| texture.texel(x, y).to_array()));
            let buffer = image::Rgba32FImage::from_raw(width, height, texels.flatten().collect());
            (buffer.map(image::DynamicImage::ImageRgba32F), image::ImageFormat::OpenExr, "exr")
        }
    };
    let picture = picture.ok_or("an image has fewer texels than its size")?;
    picture.write_to(&mut bytes, format).map_err(|e| format!("an image cannot be encoded: {e}"))?;
    Ok((bytes.into_inner(), end))
}
