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
    /// Of some elements on a map of so many texels.
    pub fn new(elements: &[Element], texel_count: usize) -> Self {
        let pairs = || elements.iter().flat_map(|element| element.links.iter().map(|&(i, j, _)| [i, j]));
        let mut counts = vec![0u32; texel_count];
        pairs().flatten().for_each(|texel| counts[texel as usize] += 1);
        let linked = counts.iter().enumerate().filter(|(_, count)| **count > 0);
        let mut rows: Vec<Row> =
            linked.map(|(texel, &count)| Row::new(texel as u32, count as usize)).collect();
        // From now on the number of a texel's row.
        (0..).zip(&rows).for_each(|(n, row)| counts[row.texel as usize] = n);
        for (n, [i, j]) in (0..).zip(pairs()) {
            rows[counts[i as usize] as usize].ends.push((j, 2 * n));
            rows[counts[j as usize] as usize].ends.push((i, 2 * n + 1));
        }
        rows.par_iter_mut().for_each(Row::merge);
        let mut places = vec![[0; 2]; pairs().count()];
        let mut links = Vec::new();
        for Row { texel, ends, others } in &rows {
            let first = links.len() as u32;
            ends.iter().for_each(|&(place, n)| places[n as usize / 2][n as usize % 2] = first + place);
            links.extend(others.iter().map(|&other| (*texel, other, 0.0)));
        }
        Self { rows: Rows::new(links), places }
    }

    /// The matrix of elements, which are those of the pattern in their order: the sum of what `of` makes of their strengths.
    /// Each is as strong as the weakest of its texels lets it be. A gap has all texels of its witnesses: it is never stronger
    /// than they are, and together they can only take energy from the slopes of light.
    pub fn filled(&self, elements: &[Element], pace: impl Fn(u32) -> f32 + Sync, of: fn(f32) -> f32) -> Rows {
        let weakest = |Element { links }: &Element| {
            links.iter().map(|&(i, j, _)| pace(i).min(pace(j))).fold(1.0, f32::min)
        };
        let weakest: Vec<f32> = elements.par_iter().map(weakest).collect();
        let strengths = elements
            .iter()
            .zip(weakest)
            .flat_map(|(element, part)| element.links.iter().map(move |&(.., strength)| part * of(strength)));
        let mut rows = self.rows.clone();
        for (&places, strength) in self.places.iter().zip(strengths) {
            places.into_iter().for_each(|place| rows.links[place as usize].1 += strength);
        }
        rows
    }
}

/// A texel's row while it is found.
struct Row {
    texel: u32,
    /// The texel at the other end of each of its links, then its place in the row; and which link of the elements that is, times
    /// two, and in which direction.
    ends: Vec<(u32, u32)>,
    /// Those texels, each once.
    others: Vec<u32>,
}

impl Row {
    fn new(texel: u32, count: usize) -> Self {
        Self { texel, ends: Vec::with_capacity(count), others: Vec::new() }
    }

    fn merge(&mut self) {
        self.ends.sort_unstable();
        for (other, _) in &mut self.ends {
            if self.others.last() != Some(other) {
                self.others.push(*other);
            }
            *other = self.others.len() as u32 - 1;
        }
    }
}
