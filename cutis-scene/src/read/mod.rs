//! Readers: from files that nobody vouches for to a [`crate::Scene`] that can be believed.
