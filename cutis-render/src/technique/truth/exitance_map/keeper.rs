//! The state of a map on disk, to go on from.

use super::Estimator;
use crate::RenderError;
use crate::film::Checkpoint;
use crate::settings::Settings;
use crate::technique::truth::{KEEP_EVERY, checkpoint_error};
use std::time::Instant;

/// Keeps the state of a map on disk, if that is wanted.
pub(super) struct Keeper {
    checkpoint: Option<Checkpoint>,
    key: u64,
    last_kept: Instant,
}

impl Keeper {
    pub(super) fn new(settings: &Settings, key: u64) -> Self {
        let checkpoint = settings.checkpoint.as_ref().map(|checkpoint| checkpoint.beside("exitance"));
        Self { checkpoint, key, last_kept: Instant::now() }
    }

    /// Samples per texel that were taken before.
    pub(super) fn load(&self, estimator: &mut dyn Estimator) -> Result<u64, RenderError> {
        let Some(checkpoint) = &self.checkpoint else { return Ok(0) };
        let Some((samples, state)) =
            checkpoint.load(self.key, estimator.state().len()).map_err(checkpoint_error)?
        else {
            return Ok(0);
        };
        estimator.restore(samples, &state);
        Ok(samples)
    }

    pub(super) fn keep_now_and_then(
        &mut self,
        samples: u64,
        estimator: &dyn Estimator,
    ) -> Result<(), RenderError> {
        if self.last_kept.elapsed() > KEEP_EVERY {
            self.keep(samples, estimator)?;
            self.last_kept = Instant::now();
        }
        Ok(())
    }

    pub(super) fn keep(&self, samples: u64, estimator: &dyn Estimator) -> Result<(), RenderError> {
        let Some(checkpoint) = &self.checkpoint else { return Ok(()) };
        checkpoint.save(self.key, samples, &estimator.state()).map_err(checkpoint_error)
    }
}
