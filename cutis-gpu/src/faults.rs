//! What a device refuses: collected where wgpu tells it, handed out where somebody can say it.

use crate::GpuError;
use std::sync::{Arc, Mutex, PoisonError};

/// The first thing that went wrong since somebody last asked; what follows it is mostly its consequence. A device that is
/// lost stays lost.
#[derive(Debug, Clone, Default)]
pub struct Faults {
    first: Arc<Mutex<Option<GpuError>>>,
}

impl Faults {
    /// Of a device, which tells nobody else from now on.
    pub fn of(device: &wgpu::Device) -> Self {
        let faults = Self::default();
        let told = faults.clone();
        device.on_uncaptured_error(Arc::new(move |error| told.note(refusal(error))));
        let told = faults.clone();
        device.set_device_lost_callback(move |why, words| told.note(loss(why, &words)));
        faults
    }

    fn note(&self, error: GpuError) {
        tracing::debug!("{error}");
        let mut first = self.first.lock().unwrap_or_else(PoisonError::into_inner);
        match &*first {
            Some(GpuError::Lost { .. }) => {}
            Some(_) if !matches!(error, GpuError::Lost { .. }) => {}
            _ => *first = Some(error),
        }
    }

    /// The first error: once, but for the loss of the device, which is told every time.
    ///
    /// # Errors
    /// If there was one.
    pub fn check(&self) -> Result<(), GpuError> {
        let mut first = self.first.lock().unwrap_or_else(PoisonError::into_inner);
        let told = if matches!(&*first, Some(GpuError::Lost { .. })) { first.clone() } else { first.take() };
        told.map_or(Ok(()), Err)
    }
}

fn refusal(error: wgpu::Error) -> GpuError {
    match error {
        wgpu::Error::OutOfMemory { .. } => GpuError::OutOfMemory { asked_bytes: 0 },
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            GpuError::Refused { reason: one_line(&description) }
        }
    }
}

/// Drivers need not say anything.
fn loss(why: wgpu::DeviceLostReason, words: &str) -> GpuError {
    let reason = match (words, why) {
        ("", wgpu::DeviceLostReason::Destroyed) => "its device was closed".to_owned(),
        ("", _) => "its driver does not say why".to_owned(),
        (words, _) => one_line(words),
    };
    GpuError::Lost { reason }
}

/// A description in lines, as one.
fn one_line(description: &str) -> String {
    let lines = description.lines().map(str::trim).filter(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join(" ")
}
