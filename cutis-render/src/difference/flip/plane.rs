//! One number per pixel, and filters of it that are products of a row and a column.

use rayon::prelude::*;

/// One number per pixel.
#[derive(Debug, Clone)]
pub(super) struct Plane {
    width: usize,
    pub(super) values: Vec<f32>,
}

impl Plane {
    /// Rows of `width` values.
    pub(super) fn new(width: usize, values: Vec<f32>) -> Self {
        Self { width, values }
    }

    /// The same size with other values.
    pub(super) fn map(&self, of: impl Fn(f32) -> f32 + Sync) -> Self {
        Self::new(self.width, self.values.par_iter().map(|&v| of(v)).collect())
    }

    /// Filtered along the rows and then along the columns, by weights around their middle. Beyond its edge the plane
    /// goes on as at the edge.
    pub(super) fn filtered(&self, across: &[f32], down: &[f32]) -> Self {
        self.along_rows(across).along_columns(down)
    }

    fn along_rows(&self, weights: &[f32]) -> Self {
        let radius = weights.len() / 2;
        let mut values = vec![0.0; self.values.len()];
        let rows = values.par_chunks_mut(self.width).zip(self.values.par_chunks(self.width));
        rows.for_each(|(to, row)| {
            let (first, last) = (row[0], row[row.len() - 1]);
            let mut padded = vec![first; radius];
            padded.extend_from_slice(row);
            padded.resize(row.len() + 2 * radius, last);
            for (i, &weight) in weights.iter().enumerate() {
                add_scaled(to, &padded[i..i + row.len()], weight);
            }
        });
        Self::new(self.width, values)
    }

    fn along_columns(&self, weights: &[f32]) -> Self {
        let radius = weights.len() / 2;
        let height = self.values.len() / self.width;
        let mut values = vec![0.0; self.values.len()];
        values.par_chunks_mut(self.width).enumerate().for_each(|(y, to)| {
            for (i, &weight) in weights.iter().enumerate() {
                let source = (y + i).saturating_sub(radius).min(height - 1) * self.width;
                add_scaled(to, &self.values[source..source + self.width], weight);
            }
        });
        Self::new(self.width, values)
    }
}

fn add_scaled(to: &mut [f32], from: &[f32], weight: f32) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += weight * from);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_fall_where_they_belong_and_edges_go_on() {
        let plane = Plane::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 8.0]);
        let filtered = plane.filtered(&[0.25, 0.5, 0.25], &[0.0, 1.0, 0.0]);
        assert_eq!(filtered.values[3..6], [0.25, 0.5, 0.25]);
        // The corner of 8 is there once more beyond the edge.
        assert_eq!(filtered.values[6..], [0.0, 2.0, 6.0]);
        let filtered = plane.filtered(&[1.0], &[0.0, 0.0, 1.0]);
        assert_eq!(filtered.values, [0.0, 1.0, 0.0, 0.0, 0.0, 8.0, 0.0, 0.0, 8.0]);
    }

    #[test]
    fn filters_larger_than_the_plane_are_fine() {
        let plane = Plane::new(2, vec![3.0; 4]);
        let weights = [1.0 / 16.0; 16];
        assert_eq!(plane.filtered(&weights, &weights).values, [3.0; 4]);
    }
}
