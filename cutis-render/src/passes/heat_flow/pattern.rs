//! Where the links of elements stand in the matrix of all: that depends on the layout alone, and the matrix of a pose is added up
//! without looking for anything.

use super::elements::Element;
use super::rows::Rows;
use rayon::prelude::*;

/// Which texels are linked.
#[derive(Debug, Clone)]
pub struct Pattern {
    /// All links, without strengths.
    rows: Rows,
    /// Places of every link of every element, one after the other, in both directions.
    places: Vec<[u32; 2]>,
}

impl Pattern {
    /// Of some elements.
    pub fn new(elements: &[Element]) -> Self {
        let pairs = elements.iter().flat_map(|element| &element.links);
        let mut ends: Vec<(u32, u32, u32)> =
            (0..).zip(pairs).flat_map(|(n, &(i, j, _))| [(i, j, 2 * n), (j, i, 2 * n + 1)]).collect();
        ends.par_sort_unstable();
        let mut places = vec![[0; 2]; ends.len() / 2];
        let mut links: Vec<(u32, u32, f32)> = Vec::new();
        for (texel, other, n) in ends {
            if links.last().is_none_or(|&(t, o, _)| (t, o) != (texel, other)) {
                links.push((texel, other, 0.0));
            }
            places[n as usize / 2][n as usize % 2] = links.len() as u32 - 1;
        }
        Self { rows: Rows::new(links), places }
    }

    /// The sum of elements, which are those of the pattern in their order, each as strong as the weakest of its texels lets it be. A
    /// gap has all texels of its cells: it is never stronger than they are, and together they can only take energy from the slopes
    /// of light.
    pub fn filled(&self, elements: &[Element], pace: impl Fn(u32) -> f32 + Sync) -> Rows {
        let weakest = |Element { links }: &Element| {
            links.iter().map(|&(i, j, _)| pace(i).min(pace(j))).fold(1.0, f32::min)
        };
        let weakest: Vec<f32> = elements.par_iter().map(weakest).collect();
        let strengths = elements
            .iter()
            .zip(weakest)
            .flat_map(|(element, part)| element.links.iter().map(move |(.., strength)| part * strength));
        let mut rows = self.rows.clone();
        for (&places, strength) in self.places.iter().zip(strengths) {
            places.into_iter().for_each(|place| rows.links[place as usize].1 += strength);
        }
        rows
    }
}
