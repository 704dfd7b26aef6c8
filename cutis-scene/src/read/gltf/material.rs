//! Materials: from metal and roughness to skin.
//!
//! Base colour is the albedo as seen. glTF's roughness squared is the slope width alpha of its GGX lobe; the Beckmann
//! lobe of the same width has m = alpha, so `m = roughness²`. A roughness of 1 without a texture is glTF's default
//! and means that nobody chose it: skin's own value stays. `KHR_materials_specular` scales rho_s,
//! `KHR_materials_ior` gives f0; without it skin's f0 stays. Metalness has no meaning here.

use super::{Document, uri};
use crate::read::image::ColourSpace;
use crate::read::textures::{Origin, Textures};
use crate::{ColourMap, Material, Mesh, NormalMap, NormalSpace, ScalarMap, SceneError, Texels, Texture};
use glam::{Mat2, Vec2, Vec3};
use gltf::json::Index;
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::material::Material as JsonMaterial;
use gltf::json::texture::Info;
use std::sync::Arc;

/// Least Beckmann roughness: a mirror-like lobe falls between the samples of any picture.
const MIN_ROUGHNESS: f32 = 0.05;

/// A material and what it does to the coordinates of the meshes that wear it.
pub(super) struct Read {
    pub(super) material: Material,
    pub(super) uv_transform: UvTransform,
}

/// Which texture coordinates a material uses: those of its base colour, else of its normal map.
pub(super) fn uv_set(document: &Document, index: Option<Index<JsonMaterial>>) -> u32 {
    let material = index.and_then(|index| document.root.materials.get(index.value()));
    let info = material.and_then(leading_texture);
    info.map_or(0, |(set, transform)| transform.and_then(|t| t.tex_coord).unwrap_or(set))
}

/// Texture coordinate set and transform that count for the mesh.
fn leading_texture(material: &JsonMaterial) -> Option<(u32, Option<&TextureTransform>)> {
    let base = material.pbr_metallic_roughness.base_color_texture.as_ref();
    let normal = material.normal_texture.as_ref().map(|normal| (normal.tex_coord, None));
    base.map(|info| (info.tex_coord, transform(info))).or(normal)
}

fn transform(info: &Info) -> Option<&TextureTransform> {
    info.extensions.as_ref()?.texture_transform.as_ref()
}

/// Reads a material with its textures; `index` past the last one stands for none.
pub(super) fn read(
    document: &Document,
    index: usize,
    textures: &mut Textures,
    warnings: &mut Vec<String>,
) -> Result<Read, SceneError> {
    if index == usize::MAX {
        return Ok(Read { material: Material::default(), uv_transform: UvTransform::IDENTITY });
    }
    let place = format!("materials[{index}]");
    let source = document.get(&document.root.materials, Index::new(index as u32), &place)?;
    let mut reader = Reader { document, source, place, textures, warnings };
    let material = reader.material()?;
    let uv_transform = UvTransform::new(leading_texture(source).and_then(|(_, transform)| transform));
    if !uv_transform.is_finite() {
        return document.fail(reader.place, "KHR_texture_transform is not finite");
    }
    Ok(Read { material, uv_transform })
}

struct Reader<'a> {
    document: &'a Document<'a>,
    source: &'a JsonMaterial,
    place: String,
    textures: &'a mut Textures,
    warnings: &'a mut Vec<String>,
}

impl Reader<'_> {
    fn material(&mut self) -> Result<Material, SceneError> {
        let skin = Material::default();
        Ok(Material {
            name: self.source.name.clone().unwrap_or_else(|| self.place.clone()),
            albedo: self.albedo()?,
            normal: self.normal()?,
            roughness: self.roughness(skin.roughness)?,
            rho_s: self.rho_s()?,
            f0: self.f0(skin.f0)?,
            ..skin
        })
    }

    fn albedo(&mut self) -> Result<ColourMap, SceneError> {
        let pbr = &self.source.pbr_metallic_roughness;
        let [r, g, b, _] = pbr.base_color_factor.0;
        let factor = Vec3::new(r, g, b);
        if !factor.is_finite() || factor.min_element() < 0.0 {
            return self
                .document
                .fail(format!("{}.baseColorFactor", self.place), "must be finite, 0 or above");
        }
        Ok(ColourMap { factor, texture: self.texture(pbr.base_color_texture.as_ref(), ColourSpace::Colour)? })
    }

    fn normal(&mut self) -> Result<Option<NormalMap>, SceneError> {
        let Some(normal) = &self.source.normal_texture else { return Ok(None) };
        self.warn_about_other_coordinates(normal.tex_coord, "normal map");
        let texture = self.texture_by_index(normal.index, ColourSpace::Data)?;
        if !normal.scale.is_finite() {
            return self.document.fail(format!("{}.normalTexture.scale", self.place), "is not finite");
        }
        Ok(Some(NormalMap { texture, space: NormalSpace::Tangent, strength: normal.scale }))
    }

    fn roughness(&mut self, of_skin: ScalarMap) -> Result<ScalarMap, SceneError> {
        let pbr = &self.source.pbr_metallic_roughness;
        let factor = pbr.roughness_factor.0;
        if !(0.0..=1.0).contains(&factor) {
            let reason = format!("{factor} is not between 0 and 1");
            return self.document.fail(format!("{}.roughnessFactor", self.place), reason);
        }
        match self.texture(pbr.metallic_roughness_texture.as_ref(), ColourSpace::Data)? {
            Some(texture) => {
                let squared = Arc::new(beckmann_texture(&texture, factor));
                Ok(ScalarMap { offset: 0.0, gain: 1.0, texture: Some((squared, 0)) })
            }
            None if factor == 1.0 => Ok(of_skin),
            None => Ok(ScalarMap::constant((factor * factor).max(MIN_ROUGHNESS))),
        }
    }

    fn rho_s(&mut self) -> Result<ScalarMap, SceneError> {
        let extension = self.source.extensions.as_ref().and_then(|e| e.specular.as_ref());
        let Some(specular) = extension else { return Ok(ScalarMap::constant(1.0)) };
        let factor = specular.specular_factor.0;
        if !(0.0..=1.0).contains(&factor) {
            return self.document.fail(format!("{}.specularFactor", self.place), "is not between 0 and 1");
        }
        let texture = self.texture(specular.specular_texture.as_ref(), ColourSpace::Data)?;
        Ok(match texture {
            // The extension stores it in alpha.
            Some(texture) => ScalarMap { offset: 0.0, gain: factor, texture: Some((texture, 3)) },
            None => ScalarMap::constant(factor),
        })
    }

    fn f0(&self, of_skin: f32) -> Result<f32, SceneError> {
        let Some(ior) = self.source.extensions.as_ref().and_then(|e| e.ior.as_ref()) else {
            return Ok(of_skin);
        };
        let index = ior.ior.0;
        if !(1.0..=4.0).contains(&index) {
            let reason = format!("{index} is not between 1 and 4");
            return self.document.fail(format!("{}.extensions.KHR_materials_ior", self.place), reason);
        }
        let root = (index - 1.0) / (index + 1.0);
        Ok(root * root)
    }

    fn texture(
        &mut self,
        info: Option<&Info>,
        space: ColourSpace,
    ) -> Result<Option<Arc<Texture>>, SceneError> {
        let Some(info) = info else { return Ok(None) };
        let set = transform(info).and_then(|t| t.tex_coord).unwrap_or(info.tex_coord);
        self.warn_about_other_coordinates(set, "texture");
        self.texture_by_index(info.index, space).map(Some)
    }

    fn warn_about_other_coordinates(&mut self, set: u32, what: &str) {
        let leading = leading_texture(self.source);
        let used = leading.map_or(set, |(set, t)| t.and_then(|t| t.tex_coord).unwrap_or(set));
        if set != used {
            self.warnings.push(format!(
                "{}: a {what} wants TEXCOORD_{set}, but one set is used for all: TEXCOORD_{used}",
                self.place
            ));
        }
    }

    fn texture_by_index(
        &mut self,
        index: Index<gltf::json::Texture>,
        space: ColourSpace,
    ) -> Result<Arc<Texture>, SceneError> {
        let document = self.document;
        let texture = document.get(&document.root.textures, index, &self.place)?;
        let place = format!("textures[{}].source", index.value());
        let image = document.get(&document.root.images, texture.source, &place)?;
        let place = format!("images[{}]", texture.source.value());
        let origin = Origin::Embedded(texture.source.value());
        let view_bytes;
        let uri_bytes;
        let bytes: &[u8] = match (image.buffer_view, &image.uri) {
            (Some(view), _) => {
                view_bytes = document.accessors.view(&document.root, view, &place)?;
                view_bytes
            }
            (None, Some(uri)) => match uri::target(uri, &document.folder, document.file, &place)? {
                uri::Target::File(path) => return self.textures.file(&path, space, self.warnings),
                uri::Target::Bytes(bytes) => {
                    uri_bytes = bytes;
                    &uri_bytes
                }
            },
            (None, None) => return document.fail(place, "has neither a uri nor a bufferView"),
        };
        self.textures
            .decode(origin, bytes, space, self.warnings)
            .map_err(|reason| SceneError::new(document.file, place, reason))
    }
}

/// Texture whose red channel is Beckmann's m for a roughness in green. Eight bits: the error of m is at most 0.002.
fn beckmann_texture(texture: &Texture, factor: f32) -> Texture {
    let (width, height) = (texture.width(), texture.height());
    let texel = |i: u32| {
        let roughness = texture.texel(i % width, i / width).y * factor;
        let m = (roughness * roughness).clamp(MIN_ROUGHNESS, 1.0);
        [(m * 255.0).round() as u8, 0, 0, 255]
    };
    Texture::new(width, height, Texels::Linear8((0..width * height).map(texel).collect()))
}

/// `KHR_texture_transform` of the leading texture, applied to the coordinates themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UvTransform {
    linear: Mat2,
    offset: Vec2,
}

impl UvTransform {
    const IDENTITY: Self = Self { linear: Mat2::IDENTITY, offset: Vec2::ZERO };

    fn new(transform: Option<&TextureTransform>) -> Self {
        let Some(t) = transform else { return Self::IDENTITY };
        // The extension turns the coordinates counter-clockwise as one sees them, with v growing downwards.
        let (sin, cos) = t.rotation.0.sin_cos();
        let rotation = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
        let linear = rotation * Mat2::from_diagonal(Vec2::from_array(t.scale.0));
        Self { linear, offset: Vec2::from_array(t.offset.0) }
    }

    fn is_finite(&self) -> bool {
        self.linear.is_finite() && self.offset.is_finite()
    }

    /// Moves the coordinates of a mesh.
    pub(super) fn apply(&self, mesh: &mut Mesh) {
        if *self == Self::IDENTITY {
            return;
        }
        for uv in &mut mesh.uvs {
            *uv = self.linear * *uv + self.offset;
        }
        // They followed the old coordinates.
        mesh.tangents.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roughness_becomes_its_square() {
        let source = Texture::new(1, 1, Texels::Linear8(vec![[0, 128, 0, 255]]));
        let m = beckmann_texture(&source, 1.0).texel(0, 0).x;
        assert!((m - (128.0f32 / 255.0).powi(2)).abs() < 0.002, "{m}");
    }

    #[test]
    fn a_quarter_turn_is_counter_clockwise_on_the_image() {
        // The README of KHR_texture_transform: "rotate the UVs by this many radians counter-clockwise around the
        // origin"; to the right becomes up, which is -v.
        let transform = TextureTransform {
            rotation: gltf::json::extensions::texture::TextureTransformRotation(std::f32::consts::FRAC_PI_2),
            ..TextureTransform::default()
        };
        let uv = UvTransform::new(Some(&transform)).linear * Vec2::X;
        assert!((uv - Vec2::new(0.0, -1.0)).length() < 1e-6, "{uv}");
    }
}
