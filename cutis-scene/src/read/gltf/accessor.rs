//! Numbers out of buffers: every range is checked against the bytes that are there before any is read.

use super::uri;
use crate::SceneError;
use crate::read::checks::MAX_COUNT;
use crate::read::file::Folder;
use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::buffer::View;
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};
use std::borrow::Cow;
use std::path::Path;

/// Most bytes of all buffers together.
const MAX_BUFFER_BYTES: usize = 2 << 30;

/// Which component types a reading accepts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Accept {
    /// 32-bit float alone: positions, directions, matrices.
    Float,
    /// Float or normalised unsigned integers: texture coordinates and weights.
    FloatOrNormalised,
    /// Unsigned integers, as they are: indices and joints.
    Unsigned,
}

/// The buffers of a document.
pub(super) struct Accessors<'a> {
    file: &'a Path,
    buffers: Vec<Cow<'a, [u8]>>,
}

impl<'a> Accessors<'a> {
    /// Brings in all buffers.
    pub(super) fn load(
        root: &Root,
        binary: Option<&'a [u8]>,
        folder: &Folder,
        file: &'a Path,
    ) -> Result<Self, SceneError> {
        let mut buffers = Vec::new();
        let mut total = 0;
        for (i, buffer) in root.buffers.iter().enumerate() {
            let place = format!("buffers[{i}]");
            let bytes = match (&buffer.uri, binary) {
                (Some(uri), _) => Cow::Owned(uri::bytes(uri, folder, file, &format!("{place}.uri"))?),
                (None, Some(binary)) if i == 0 => Cow::Borrowed(binary),
                _ => return Err(SceneError::new(file, place, "has neither a uri nor a binary chunk")),
            };
            if buffer.byte_length.0 > bytes.len() as u64 {
                let reason = format!("claims {} bytes, but {} are there", buffer.byte_length.0, bytes.len());
                return Err(SceneError::new(file, format!("{place}.byteLength"), reason));
            }
            total += bytes.len();
            if total > MAX_BUFFER_BYTES {
                return Err(SceneError::new(file, place, format!("more than {MAX_BUFFER_BYTES} bytes")));
            }
            buffers.push(bytes);
        }
        Ok(Self { file, buffers })
    }

    fn fail<T>(&self, place: &str, reason: String) -> Result<T, SceneError> {
        Err(SceneError::new(self.file, place, reason))
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, root: &Root, index: Index<View>, place: &str) -> Result<&[u8], SceneError> {
        let Some(view) = root.buffer_views.get(index.value()) else {
            let count = root.buffer_views.len();
            return self.fail(place, format!("names bufferViews[{}], but there are {count}", index.value()));
        };
        let place = format!("bufferViews[{}]", index.value());
        let Some(buffer) = self.buffers.get(view.buffer.value()) else {
            return self
                .fail(&place, format!("names buffers[{}], which does not exist", view.buffer.value()));
        };
        let (offset, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let range = usize::try_from(offset).ok().zip(usize::try_from(length).ok());
        match range.and_then(|(o, l)| buffer.get(o..o.checked_add(l)?)) {
            Some(bytes) => Ok(bytes),
            None => {
                let has = buffer.len();
                self.fail(&place, format!("{length} bytes from {offset} lie past the buffer's end at {has}"))
            }
        }
    }

    /// All elements of an accessor, each of `N` components. Integers are exact up to 2^24 and come as they are or,
    /// where `accept` says so, normalised to 0..=1.
    pub(super) fn read<const N: usize>(
        &self,
        root: &Root,
        index: Index<Accessor>,
        accept: Accept,
        place: &str,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        self.elements(root, index, accept, place, |component, bytes| number(component, accept, bytes))
    }

    /// All elements of an accessor of single unsigned integers.
    pub(super) fn read_indices(
        &self,
        root: &Root,
        index: Index<Accessor>,
        place: &str,
    ) -> Result<Vec<u32>, SceneError> {
        let list: Vec<[u32; 1]> = self.elements(root, index, Accept::Unsigned, place, unsigned)?;
        Ok(list.into_iter().map(|[i]| i).collect())
    }

    /// Number of elements an accessor claims, if it exists.
    fn accessor<'r>(
        &self,
        root: &'r Root,
        index: Index<Accessor>,
        place: &str,
    ) -> Result<&'r Accessor, SceneError> {
        let count = root.accessors.len();
        match root.accessors.get(index.value()) {
            Some(accessor) => Ok(accessor),
            None => self.fail(place, format!("names accessors[{}], but there are {count}", index.value())),
        }
    }

    fn elements<const N: usize, T: Copy + Default>(
        &self,
        root: &Root,
        index: Index<Accessor>,
        accept: Accept,
        place: &str,
        decode: impl Fn(ComponentType, &[u8]) -> T,
    ) -> Result<Vec<[T; N]>, SceneError> {
        let accessor = self.accessor(root, index, place)?;
        let place = format!("accessors[{}]", index.value());
        let component = self.check_type::<N>(accessor, accept, &place)?;
        let count = match usize::try_from(accessor.count.0) {
            Ok(count) if 0 < count && count <= 3 * MAX_COUNT => count,
            _ => {
                return self
                    .fail(&place, format!("has {} elements; 1 to {}", accessor.count.0, 3 * MAX_COUNT));
            }
        };
        let element = |bytes: &[u8]| {
            let mut components = bytes.chunks_exact(size(component));
            std::array::from_fn(|_| components.next().map_or(T::default(), |b| decode(component, b)))
        };
        let offset = accessor.byte_offset.unwrap_or_default().0;
        let mut elements = match accessor.buffer_view {
            Some(view) => {
                let stride = root.buffer_views.get(view.value()).and_then(|view| view.byte_stride);
                let bytes = self.view(root, view, &place)?;
                let layout = Layout { offset, stride: stride.map(|s| s.0), size: N * size(component), count };
                self.chunks(bytes, layout, &place)?.map(element).collect()
            }
            None if accessor.sparse.is_some() => vec![[T::default(); N]; count],
            None => return self.fail(&place, "has no bufferView".to_owned()),
        };
        self.replace_sparse(root, accessor, &place, N * size(component), &mut elements, element)?;
        Ok(elements)
    }

    /// The component type, if it and the number of components are what the reading needs.
    fn check_type<const N: usize>(
        &self,
        accessor: &Accessor,
        accept: Accept,
        place: &str,
    ) -> Result<ComponentType, SceneError> {
        let components = match accessor.type_ {
            Checked::Valid(Type::Scalar) => 1,
            Checked::Valid(Type::Vec2) => 2,
            Checked::Valid(Type::Vec3) => 3,
            Checked::Valid(Type::Vec4) => 4,
            Checked::Valid(Type::Mat4) => 16,
            _ => return self.fail(place, "has a type that is not used here".to_owned()),
        };
        if components != N {
            return self.fail(place, format!("has {components} components, {N} are needed"));
        }
        let Checked::Valid(component) = &accessor.component_type else {
            return self.fail(place, "has an unknown componentType".to_owned());
        };
        let fits = match accept {
            Accept::Float => component.0 == ComponentType::F32,
            Accept::FloatOrNormalised => {
                matches!(component.0, ComponentType::F32 | ComponentType::U8 | ComponentType::U16)
            }
            Accept::Unsigned => {
                matches!(component.0, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
            }
        };
        if !fits {
            return self
                .fail(place, format!("componentType {:?} does not fit: {accept:?} is needed", component.0));
        }
        Ok(component.0)
    }

    /// The bytes of each element, if all of them lie inside `bytes`.
    fn chunks<'b>(
        &self,
        bytes: &'b [u8],
        layout: Layout,
        place: &str,
    ) -> Result<impl Iterator<Item = &'b [u8]> + use<'b>, SceneError> {
        let Layout { offset, stride, size, count } = layout;
        let stride = stride.unwrap_or(size);
        if stride < size || stride > 252 {
            return self.fail(place, format!("byteStride {stride} does not fit elements of {size} bytes"));
        }
        let need = (count as u64 - 1) * stride as u64 + size as u64;
        if offset.checked_add(need).is_none_or(|end| end > bytes.len() as u64) {
            let has = bytes.len();
            return self.fail(
                place,
                format!(
                    "{count} elements from byte {offset} lie past the end of their bufferView ({has} bytes)"
                ),
            );
        }
        let bytes = &bytes[offset as usize..];
        Ok((0..count).map(move |i| &bytes[i * stride..i * stride + size]))
    }

    /// Overwrites the elements that a sparse accessor lists.
    fn replace_sparse<E>(
        &self,
        root: &Root,
        accessor: &Accessor,
        place: &str,
        element_size: usize,
        elements: &mut [E],
        decode: impl Fn(&[u8]) -> E,
    ) -> Result<(), SceneError> {
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        let place = format!("{place}.sparse");
        let Checked::Valid(index_type) = &sparse.indices.component_type else {
            return self.fail(&place, "has an unknown componentType".to_owned());
        };
        let count = match usize::try_from(sparse.count.0) {
            Ok(count) if 0 < count && count <= elements.len() => count,
            _ => return self.fail(&place, format!("has {} of {} elements", sparse.count.0, elements.len())),
        };
        let tight = |offset: u64, size: usize| Layout { offset, stride: None, size, count };
        let index_bytes = self.view(root, sparse.indices.buffer_view, &place)?;
        let index_layout = tight(sparse.indices.byte_offset.0, size(index_type.0));
        let value_bytes = self.view(root, sparse.values.buffer_view, &place)?;
        let value_layout = tight(sparse.values.byte_offset.0, element_size);
        let values = self.chunks(value_bytes, value_layout, &place)?;
        for (at, value) in self.chunks(index_bytes, index_layout, &place)?.zip(values) {
            let index = unsigned(index_type.0, at) as usize;
            let has = elements.len();
            match elements.get_mut(index) {
                Some(element) => *element = decode(value),
                None => return self.fail(&place, format!("replaces element {index} of {has}")),
            }
        }
        Ok(())
    }
}

/// Where the elements of an accessor lie in its view.
struct Layout {
    offset: u64,
    stride: Option<usize>,
    size: usize,
    count: usize,
}

/// Bytes of one component.
fn size(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

fn unsigned(component: ComponentType, bytes: &[u8]) -> u32 {
    match (component, bytes) {
        (_, &[a]) => u32::from(a),
        (_, &[a, b]) => u32::from(u16::from_le_bytes([a, b])),
        (_, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]),
        _ => 0,
    }
}

fn number(component: ComponentType, accept: Accept, bytes: &[u8]) -> f32 {
    let integer = unsigned(component, bytes);
    match (component, accept) {
        (ComponentType::F32, _) => f32::from_bits(integer),
        (ComponentType::U8, Accept::FloatOrNormalised) => integer as f32 / 255.0,
        (ComponentType::U16, Accept::FloatOrNormalised) => integer as f32 / 65535.0,
        _ => integer as f32,
    }
}
