//! A colour for every distance through a body: what an artist makes in place of an exponential (Green 2004, section 16.3).

use glam::Vec3;

/// What is wrong with a ramp.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RampError {
    /// Fewer than two stops.
    #[error("a colour ramp needs two stops at least, got {count}")]
    TooFew {
        /// How many there were.
        count: usize,
    },
    /// A distance that does not follow the one before.
    #[error(
        "distances of a colour ramp must be finite, not negative and growing, got {after_mm} mm after {before_mm} mm"
    )]
    Order {
        /// The stop before, mm.
        before_mm: f32,
        /// The stop that does not follow, mm.
        after_mm: f32,
    },
    /// Not a colour.
    #[error("colours of a colour ramp must be finite and not negative, got {value} at {distance_mm} mm")]
    Colour {
        /// The stop, mm.
        distance_mm: f32,
        /// Its channel that makes no sense.
        value: f32,
    },
}

/// Linear colours at growing distances, mixed evenly between; the ends go on.
#[derive(Debug, Clone, PartialEq)]
pub struct ColourRamp {
    stops: Vec<(f32, Vec3)>,
}

impl ColourRamp {
    /// From stops: distance in mm, linear colour.
    ///
    /// # Errors
    /// If there are fewer than two, a distance does not grow, or a number makes no sense.
    pub fn new(stops: Vec<(f32, Vec3)>) -> Result<Self, RampError> {
        if stops.len() < 2 {
            return Err(RampError::TooFew { count: stops.len() });
        }
        let mut before_mm = -f32::MIN_POSITIVE;
        for &(distance_mm, colour) in &stops {
            if !(distance_mm > before_mm && distance_mm >= 0.0 && distance_mm.is_finite()) {
                return Err(RampError::Order { before_mm: before_mm.max(0.0), after_mm: distance_mm });
            }
            let bad = colour.to_array().into_iter().find(|c| !(*c >= 0.0 && c.is_finite()));
            if let Some(value) = bad {
                return Err(RampError::Colour { distance_mm, value });
            }
            before_mm = distance_mm;
        }
        Ok(Self { stops })
    }

    /// The stops: distance in mm, linear colour.
    pub fn stops(&self) -> &[(f32, Vec3)] {
        &self.stops
    }

    /// Colour at a distance, mm.
    pub fn at_mm(&self, distance_mm: f32) -> Vec3 {
        let after = self.stops.partition_point(|(stop_mm, _)| *stop_mm <= distance_mm);
        match (after.checked_sub(1).map(|i| self.stops[i]), self.stops.get(after)) {
            (Some((from_mm, from)), Some(&(to_mm, to))) => {
                from.lerp(to, (distance_mm - from_mm) / (to_mm - from_mm))
            }
            (Some((_, last)), None) => last,
            (None, _) => self.stops[0].1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_mixed_between_stops_and_go_on_at_the_ends() {
        let ramp =
            ColourRamp::new(vec![(1.0, Vec3::ONE), (3.0, Vec3::X), (4.0, Vec3::ZERO)]).expect("is sound");
        for (distance_mm, colour) in [
            (0.0, Vec3::ONE),
            (1.0, Vec3::ONE),
            (2.0, Vec3::new(1.0, 0.5, 0.5)),
            (3.0, Vec3::X),
            (9.0, Vec3::ZERO),
        ] {
            assert!((ramp.at_mm(distance_mm) - colour).abs().max_element() < 1e-6, "{distance_mm}");
        }
    }

    #[test]
    fn what_is_no_ramp_is_refused() {
        let refused =
            |stops: &[(f32, Vec3)]| ColourRamp::new(stops.to_vec()).expect_err("is none").to_string();
        assert_eq!(refused(&[(0.0, Vec3::ONE)]), "a colour ramp needs two stops at least, got 1");
        for after_mm in [1.0, 0.5, f32::NAN, f32::INFINITY] {
            assert!(refused(&[(1.0, Vec3::ONE), (after_mm, Vec3::ONE)]).contains("after 1 mm"), "{after_mm}");
        }
        assert!(refused(&[(-1.0, Vec3::ONE), (2.0, Vec3::ONE)]).contains("got -1 mm"));
        assert!(refused(&[(0.0, Vec3::ONE), (2.0, Vec3::NEG_X)]).contains("got -1 at 2 mm"));
    }
}
