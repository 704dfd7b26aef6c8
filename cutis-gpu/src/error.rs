//! Why the graphics processor cannot be used.

/// What stands in the way of a device, or of a frame on it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// No adapter of the wanted kind.
    #[error("there is no graphics adapter{among}: {reason}")]
    NoAdapter {
        /// Which ones would have done.
        among: &'static str,
        /// What there was instead.
        reason: String,
    },
    /// The adapter gives no device with the limits that every WebGPU implementation grants.
    #[error("the adapter '{adapter}' gives no device: {reason}")]
    NoDevice {
        /// The adapter.
        adapter: String,
        /// What it said.
        reason: String,
    },
    /// Something is larger than the device takes.
    #[error("{what} is {size}, more than the {limit} this graphics adapter takes")]
    TooLarge {
        /// What it is.
        what: &'static str,
        /// How large, with its unit.
        size: String,
        /// The limit.
        limit: u64,
    },
    /// The device has no room.
    #[error(
        "the graphics adapter ran out of memory when {} MiB were asked for: a smaller --irradiance-size, or --quality low, \
         takes less",
        asked_bytes >> 20
    )]
    OutOfMemory {
        /// Textures and buffers asked for so far.
        asked_bytes: u64,
    },
    /// The device takes an order for a mistake: ours, or its driver's.
    #[error("the graphics adapter refused an order: {reason}")]
    Refused {
        /// What it said, on one line.
        reason: String,
    },
    /// The device gave up.
    #[error("the graphics adapter gave up: {reason}")]
    Lost {
        /// What it said.
        reason: String,
    },
}
