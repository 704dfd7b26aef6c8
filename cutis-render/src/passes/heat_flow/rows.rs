//! A sparse matrix over texels, row by row.

use rayon::prelude::*;

/// Links of some texels to any others, or what they read of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rows {
    /// Texels, growing.
    pub texels: Vec<u32>,
    /// Where each texel's links begin, and where the last one's end.
    pub starts: Vec<u32>,
    /// Texel at the other end, and strength of the link.
    pub links: Vec<(u32, f32)>,
}

impl Rows {
    /// Of entries in any order: a texel, the one at the other end, and the strength.
    pub fn new(mut all: Vec<(u32, u32, f32)>) -> Self {
        all.par_sort_unstable_by_key(|&(texel, other, _)| (texel, other));
        let mut rows = Self::default();
        for (n, &(texel, other, strength)) in all.iter().enumerate() {
            if rows.texels.last() != Some(&texel) {
                rows.texels.push(texel);
                rows.starts.push(n as u32);
            }
            rows.links.push((other, strength));
        }
        rows.starts.push(all.len() as u32);
        rows
    }

    /// Every texel with its links.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &[(u32, f32)])> {
        self.texels
            .iter()
            .zip(self.starts.windows(2))
            .map(|(&texel, ends)| (texel as usize, &self.links[ends[0] as usize..ends[1] as usize]))
    }
}
