//! Typed buffers on a device.

use std::marker::PhantomData;

use bytemuck::Pod;

use crate::error::{Error, Result};

use super::device::GpuDevice;

/// Buffer sizes are multiples of this many bytes: some drivers drop the tail of a storage buffer that is not, and a
/// binding of no bytes at all is invalid.
const PADDING: u64 = 16;

/// Bytes a buffer of `len` elements of `size` bytes occupies: at least one and always whole units of 16.
pub fn padded_size(len: usize, size: usize) -> u64 {
    (len as u64 * size as u64).next_multiple_of(PADDING).max(PADDING)
}

/// A storage buffer of `len` elements; the bytes between its end and its padded size are zero.
pub struct GpuBuffer<T> {
    pub(super) raw: wgpu::Buffer,
    len: usize,
    kind: PhantomData<fn(T) -> T>,
}

impl<T> GpuBuffer<T> {
    /// Number of elements.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True without elements.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Bytes on the device, padding included.
    pub fn size(&self) -> u64 {
        self.raw.size()
    }
}

impl GpuDevice {
    /// A buffer of `len` zero elements.
    ///
    /// Fails with a device error when it exceeds what the adapter can bind at once.
    pub fn allocate<T: Pod>(&self, label: &'static str, len: usize) -> Result<GpuBuffer<T>> {
        let size = padded_size(len, size_of::<T>());
        let limit = self.limits.max_storage_buffer_binding_size.min(self.limits.max_buffer_size);
        if size > limit {
            let what = format!("{label} needs {size} bytes at once, {} binds {limit}", self.info().name);
            return Err(Error::device(what).remedy("run with --device cpu"));
        }
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
        Ok(GpuBuffer { raw: self.device.create_buffer(&descriptor), len, kind: PhantomData })
    }

    /// A buffer that holds `data`.
    pub fn upload<T: Pod>(&self, label: &'static str, data: &[T]) -> Result<GpuBuffer<T>> {
        let buffer = self.allocate(label, data.len())?;
        self.write(&buffer, data)?;
        Ok(buffer)
    }

    /// Overwrites the elements of `buffer`; `data` has as many.
    pub fn write<T: Pod>(&self, buffer: &GpuBuffer<T>, data: &[T]) -> Result<()> {
        if data.len() != buffer.len {
            return Err(Error::bug(format!("{} elements written to a buffer of {}", data.len(), buffer.len)));
        }
        let bytes: &[u8] = bytemuck::cast_slice(data);
        if !bytes.len().is_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT as usize) {
            return Err(Error::bug(format!("elements of {} bytes are not whole words", size_of::<T>())));
        }
        if !bytes.is_empty() {
            self.queue.write_buffer(&buffer.raw, 0, bytes);
        }
        Ok(())
    }

    pub(super) fn uniform(&self, params: &impl Pod) -> wgpu::Buffer {
        let bytes = bytemuck::bytes_of(params);
        let descriptor = wgpu::BufferDescriptor {
            label: Some("params"),
            size: padded_size(bytes.len(), 1),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        };
        let buffer = self.device.create_buffer(&descriptor);
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    /// Waits for all submitted work and copies `buffer` back; reports what went wrong on the way.
    pub fn download<T: Pod>(&self, buffer: &GpuBuffer<T>) -> Result<Vec<T>> {
        let descriptor = wgpu::BufferDescriptor {
            label: Some("read-back"),
            size: buffer.size(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        };
        let staging = self.device.create_buffer(&descriptor);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&buffer.raw, 0, &staging, 0, buffer.size());
        self.queue.submit([encoder.finish()]);
        let (done, mapped) = std::sync::mpsc::channel();
        // The receiver outlives the wait below; should it be gone after all, nobody wants the answer.
        staging.map_async(wgpu::MapMode::Read, .., move |result| drop(done.send(result)));
        self.wait()?;
        let unreadable = |why: String| Error::device(format!("results cannot be read back: {why}"));
        match mapped.try_recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(unreadable(error.to_string())),
            Err(error) => return Err(unreadable(error.to_string())),
        }
        let view = staging.get_mapped_range(..).map_err(|error| unreadable(error.to_string()))?;
        Ok(bytemuck::pod_collect_to_vec(&view[..buffer.len * size_of::<T>()]))
    }

    /// Waits until all submitted work is done, then reports recorded errors.
    pub(super) fn wait(&self) -> Result<()> {
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        polled.map(drop).map_err(|error| Error::device(format!("the compute device does not answer: {error}")))
    }
}

#[cfg(test)]
mod tests {
    use super::padded_size;

    #[test]
    fn sizes_are_whole_units_of_sixteen_and_never_zero() {
        let expected =
            [(0, 4, 16), (1, 4, 16), (3, 4, 16), (4, 4, 16), (5, 4, 32), (1, 12, 16), (3, 12, 48), (1, 24, 32)];
        for (len, size, bytes) in expected {
            assert_eq!(padded_size(len, size), bytes, "{len} elements of {size} bytes");
        }
    }
}
