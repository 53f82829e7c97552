//! Accessors: numbers in buffers, strided, sparse, normalised, with every range checked.

use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::validation::Checked;

use super::document::{Document, absent, named, range};
use crate::Result;

/// How the elements of an accessor lie.
#[derive(Clone, Copy)]
struct Format {
    component: ComponentType,
    /// Numbers an element.
    width: usize,
    normalised: bool,
}

impl Format {
    fn size(self) -> usize {
        self.component_size() * self.width
    }

    fn component_size(self) -> usize {
        match self.component {
            ComponentType::I8 | ComponentType::U8 => 1,
            ComponentType::I16 | ComponentType::U16 => 2,
            ComponentType::U32 | ComponentType::F32 => 4,
        }
    }

    /// Numbers of an element as they mean it.
    fn float(self, bytes: &[u8]) -> f32 {
        let scaled = |value: f32, largest: f32| if self.normalised { (value / largest).max(-1.0) } else { value };
        match (self.component, bytes) {
            (ComponentType::I8, &[a]) => scaled(f32::from(a as i8), 127.0),
            (ComponentType::U8, &[a]) => scaled(f32::from(a), 255.0),
            (ComponentType::I16, &[a, b]) => scaled(f32::from(i16::from_le_bytes([a, b])), 32_767.0),
            (ComponentType::U16, &[a, b]) => scaled(f32::from(u16::from_le_bytes([a, b])), 65_535.0),
            (ComponentType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
            _ => self.integer(bytes) as f32,
        }
    }

    fn integer(self, bytes: &[u8]) -> u32 {
        bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
    }
}

impl Document {
    /// Elements of `N` numbers; integers are brought to 0..1 or -1..1 where the accessor says so.
    pub(super) fn floats<const N: usize>(&self, at: usize) -> Result<Vec<[f32; N]>> {
        self.elements(at, [0.0; N], |format, bytes, element| {
            for (value, bytes) in element.iter_mut().zip(bytes.chunks_exact(format.component_size())) {
                *value = format.float(bytes);
            }
        })
    }

    /// Elements of `N` unsigned integers.
    pub(super) fn integers<const N: usize>(&self, at: usize) -> Result<Vec<[u32; N]>> {
        if let Some(accessor) = self.root.accessors.get(at)
            && !matches!(
                accessor.component_type,
                Checked::Valid(GenericComponentType(ComponentType::U8 | ComponentType::U16 | ComponentType::U32))
            )
        {
            return Err(self.error(format!("{} must hold unsigned integers", named("accessor", at, accessor.name.as_deref()))));
        }
        self.elements(at, [0; N], |format, bytes, element| {
            for (value, bytes) in element.iter_mut().zip(bytes.chunks_exact(format.component_size())) {
                *value = format.integer(bytes);
            }
        })
    }

    /// Numbers an element of an accessor, for attributes that come in several widths.
    pub(super) fn width(&self, at: usize) -> Option<usize> {
        match self.root.accessors.get(at)?.type_ {
            Checked::Valid(kind) => Some(width_of(kind)),
            Checked::Invalid => None,
        }
    }

    fn elements<const N: usize, T: Copy>(&self, at: usize, zero: [T; N], read: impl Fn(Format, &[u8], &mut [T; N])) -> Result<Vec<[T; N]>> {
        let accessor = self.root.accessors.get(at).ok_or_else(|| self.error(absent("accessor", at, self.root.accessors.len())))?;
        let place = named("accessor", at, accessor.name.as_deref());
        let fail = |message: String| self.error(format!("{place}: {message}"));
        let (Checked::Valid(GenericComponentType(component)), Checked::Valid(kind)) = (accessor.component_type, accessor.type_) else {
            return Err(fail("the type is none of glTF".to_owned()));
        };
        let format = Format { component, width: width_of(kind), normalised: accessor.normalized };
        if format.width != N {
            return Err(fail(format!("has {} numbers an element where {N} are needed", format.width)));
        }
        let count = usize::try_from(accessor.count.0).map_err(|_| fail("the count is too large".to_owned()))?;

        let mut elements = Vec::new();
        if let Some(view) = accessor.buffer_view {
            let (bytes, stride) = self.view(view.value()).map_err(fail)?;
            let stride = stride.unwrap_or(format.size());
            if stride < format.size() {
                return Err(fail(format!("the stride of {stride} bytes is less than an element's {}", format.size())));
            }
            let needed = (count as u64).saturating_sub(1).saturating_mul(stride as u64).saturating_add(format.size() as u64);
            let offset = accessor.byte_offset.unwrap_or_default().0;
            let bytes = if count == 0 {
                &[]
            } else {
                range(bytes, offset, needed).ok_or_else(|| {
                    fail(format!(
                        "{count} elements end {} bytes behind the start of bufferView {}, which has {}",
                        offset.saturating_add(needed),
                        view.value(),
                        bytes.len()
                    ))
                })?
            };
            self.charge(count, size_of::<[T; N]>())?;
            elements.reserve_exact(count);
            for element in bytes.chunks(stride) {
                let mut values = zero;
                read(format, element.get(..format.size()).unwrap_or_default(), &mut values);
                elements.push(values);
            }
        } else {
            // Nothing in the file bounds the count of zeros.
            self.charge(count, size_of::<[T; N]>())?;
            elements.resize(count, zero);
        }

        if let Some(sparse) = &accessor.sparse {
            let Checked::Valid(index_type) = sparse.indices.component_type else {
                return Err(fail("the type of the sparse indices is none of glTF".to_owned()));
            };
            let index_format = Format { component: index_type.0, width: 1, normalised: false };
            let part = |view: usize, offset: u64, format: Format, what: &str| {
                let (bytes, _) = self.view(view).map_err(fail)?;
                let needed = sparse.count.0.saturating_mul(format.size() as u64);
                range(bytes, offset, needed).ok_or_else(|| fail(format!("the sparse {what} end behind bufferView {view}")))
            };
            let indices = part(sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0, index_format, "indices")?;
            let values = part(sparse.values.buffer_view.value(), sparse.values.byte_offset.0, format, "values")?;
            for (index, value) in indices.chunks_exact(index_format.size()).zip(values.chunks_exact(format.size())) {
                let index = index_format.integer(index);
                let element = elements
                    .get_mut(index as usize)
                    .ok_or_else(|| fail(format!("the sparse index {index} is not below the count of {count}")))?;
                read(format, value, element);
            }
        }
        Ok(elements)
    }
}

fn width_of(kind: Type) -> usize {
    match kind {
        Type::Scalar => 1,
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        Type::Vec4 | Type::Mat2 => 4,
        Type::Mat3 => 9,
        Type::Mat4 => 16,
    }
}
