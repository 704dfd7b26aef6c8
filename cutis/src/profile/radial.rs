//! R(r) and T(r) by radius, as lists.

use super::Profiled;
use super::channel::Channel;
use super::plot::Ranges;
use cutis_optics::BoxedProfile;
use rayon::prelude::*;
use serde::Serialize;
use std::iter::once;

/// Radii, evenly in the logarithm.
const RADII: i32 = 64;

/// What leaves a channel's layers, by distance from the beam's axis.
#[derive(Serialize)]
pub struct RadialProfile {
    pub r_mm: Vec<f64>,
    pub reflectance_per_mm2: Vec<f64>,
    /// Empty where nothing comes out below.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub transmittance_per_mm2: Vec<f64>,
}

/// The radii that all channels share, mm.
pub fn radii_mm(channels: &[Channel]) -> Vec<f64> {
    let (from, to) = Ranges::of(channels).r_log_mm;
    let part = |i: i32| f64::from(i) / f64::from(RADII - 1);
    (0..RADII).map(|i| from * (to / from).powf(part(i))).collect()
}

impl RadialProfile {
    pub fn new(channel: &Channel, r_mm: &[f64]) -> Self {
        let at = |profile: &BoxedProfile| r_mm.par_iter().map(|&r| profile.at_mm(r)).collect();
        Self {
            r_mm: r_mm.to_vec(),
            reflectance_per_mm2: at(&channel.profile),
            transmittance_per_mm2: channel.transmitted.as_ref().map_or_else(Vec::new, at),
        }
    }
}

/// A line per radius: R of every channel, then T of those that have any.
pub fn csv(profiled: &Profiled) -> String {
    let r_mm = radii_mm(&profiled.channels);
    let (mut names, mut columns) = (vec!["r_mm".to_owned()], vec![r_mm.clone()]);
    let channels: Vec<_> = profiled.channels.iter().map(|c| (c, RadialProfile::new(c, &r_mm))).collect();
    let mut add = |what: &str, channel: &Channel, column: &Vec<f64>| {
        if !column.is_empty() {
            let suffix = channel.name.map_or_else(String::new, |name| format!("_{name}"));
            names.push(format!("{what}{suffix}_per_mm2"));
            columns.push(column.clone());
        }
    };
    channels.iter().for_each(|(c, radial)| add("reflectance", c, &radial.reflectance_per_mm2));
    channels.iter().for_each(|(c, radial)| add("transmittance", c, &radial.transmittance_per_mm2));
    let row = |i: usize| columns.iter().map(|column| column[i].to_string()).collect::<Vec<_>>().join(",");
    once(names.join(",")).chain((0..r_mm.len()).map(row)).map(|line| line + "\n").collect()
}
