//! Refines an unwrapped surface: long edges are cut in the middle, new points go onto the sculpture. Texture
//! coordinates are those of the edge's middle, so that an injective map stays injective.

use super::regions::neighbours;
use super::sculpture::Sculpture;
use super::unwrap::Unwrapped;
use glam::Vec3;
use rayon::prelude::*;

/// An edge: relative length as ordered bits, then the triangle and the corner where it begins.
type Edge = (u32, u32, u8);

/// A mesh of even edges still has some this much longer than an equilateral one of the same count.
const UNEVENNESS: f32 = 1.25;

/// Cuts edges until there are `triangles` of them; the relatively longest first.
pub fn refine(
    surface: Unwrapped,
    sculpture: &Sculpture,
    triangles: usize,
    edge_length_mm: &(impl Fn(Vec3) -> f32 + Sync),
) -> Unwrapped {
    let across = neighbours(&surface.surface.triangles);
    let wanted_mm = surface.surface.points_mm.par_iter().map(|&p| edge_length_mm(p)).collect();
    let mut cutting = Cutting { surface, across, wanted_mm };
    let mut at_least = UNEVENNESS * cutting.even_ratio(triangles);
    while cutting.surface.surface.triangles.len() + 1 < triangles {
        let first_new = cutting.surface.surface.points_mm.len();
        let before = cutting.surface.surface.triangles.len();
        let cuts = cutting.cut_longest(at_least, (triangles - before) / 2);
        let points = &mut cutting.surface.surface.points_mm;
        points[first_new..].par_iter_mut().for_each(|p| *p = sculpture.project(*p, 2));
        cutting.wanted_mm.par_extend(points[first_new..].par_iter().map(|&p| edge_length_mm(p)));
        // Hardly any edge as long as that left: shorter ones have to do for the rest.
        if cuts * 50 < before {
            at_least *= 0.85;
        }
    }
    cutting.surface
}

struct Cutting {
    surface: Unwrapped,
    /// Triangle across each edge.
    across: Vec<[u32; 3]>,
    /// Wanted edge length at each point, mm.
    wanted_mm: Vec<f32>,
}

impl Cutting {
    /// Relative length of all edges if `count` equilateral triangles covered the surface, each of its wanted size.
    fn even_ratio(&self, count: usize) -> f32 {
        let points = &self.surface.surface.points_mm;
        let area = |c: &[u32; 3]| {
            let p = c.map(|i| points[i as usize]);
            let wanted = c.iter().map(|&i| self.wanted_mm[i as usize]).sum::<f32>() / 3.0;
            0.5 * (p[1] - p[0]).cross(p[2] - p[0]).length() / (wanted * wanted)
        };
        let whole: f32 = self.surface.surface.triangles.iter().map(area).sum();
        // An equilateral triangle of edge e has the area 0.433 e²; ratios count two wanted lengths per edge.
        0.5 * (whole / (0.433 * count as f32)).sqrt()
    }

    /// Cuts at most `cuts` edges of a relative length of `at_least`, the longest first, each triangle at most once.
    fn cut_longest(&mut self, at_least: f32, cuts: usize) -> usize {
        let mut edges = self.edges(at_least);
        edges.par_sort_unstable_by(|a, b| b.cmp(a));
        let mut touched = vec![false; self.across.len()];
        let mut done = 0;
        for (_, t, corner) in edges {
            if done == cuts {
                break;
            }
            // A triangle that was cut has new edges, and its far half is not in the list at all.
            let other = self.across[t as usize][usize::from(corner)];
            if !touched[t as usize] && touched.get(other as usize) == Some(&false) {
                (touched[t as usize], touched[other as usize]) = (true, true);
                self.cut(t, corner, other);
                done += 1;
            }
        }
        done
    }

    fn edges(&self, at_least: f32) -> Vec<Edge> {
        let (triangles, points) = (&self.surface.surface.triangles, &self.surface.surface.points_mm);
        let of = |t: usize| {
            (0..3u8).filter_map(move |i| {
                let c = triangles[t];
                let (a, b) = (c[usize::from(i)] as usize, c[(usize::from(i) + 1) % 3] as usize);
                let ratio = (points[a] - points[b]).length() / (self.wanted_mm[a] + self.wanted_mm[b]);
                let once = t < self.across[t][usize::from(i)] as usize;
                (once && ratio >= at_least).then_some((ratio.to_bits(), t as u32, i))
            })
        };
        (0..triangles.len()).into_par_iter().flat_map_iter(of).collect()
    }

    /// Puts a point into the middle of an edge and cuts both triangles there.
    fn cut(&mut self, t: u32, corner: u8, other: u32) {
        let c = self.surface.surface.triangles[t as usize];
        let (a, b) = (c[usize::from(corner)], c[(usize::from(corner) + 1) % 3]);
        let back = self.surface.surface.triangles[other as usize];
        let other_corner =
            (0..3u8).find(|&j| back[usize::from(j)] == b).expect("neighbours share their edge's ends");
        let points = &mut self.surface.surface.points_mm;
        let point = points.len() as u32;
        points.push(0.5 * (points[a as usize] + points[b as usize]));
        let mut last = None;
        for side in [(t, corner), (other, other_corner)] {
            let uv = self.middle_uv(side, &mut last);
            halve(&mut self.surface.surface.triangles, side, point);
            halve(&mut self.surface.triangle_uvs, side, uv);
            self.reconnect(side);
        }
        // Each half meets the far half of the other triangle.
        let far = self.across.len() as u32 - 1;
        self.across[t as usize][0] = far;
        self.across[far as usize][0] = t;
        self.across[other as usize][0] = far - 1;
        self.across[far as usize - 1][0] = other;
    }

    /// Number of the texture coordinate in the middle of a triangle's edge; `last` is the other side's, if it was
    /// first, and is used again unless a seam runs along the edge.
    fn middle_uv(&mut self, (t, corner): (u32, u8), last: &mut Option<([u32; 2], u32)>) -> u32 {
        let c = self.surface.triangle_uvs[t as usize];
        let (from, to) = (c[usize::from(corner)], c[(usize::from(corner) + 1) % 3]);
        if let Some((pair, uv)) = *last
            && pair == [to, from]
        {
            return uv;
        }
        let uvs = &mut self.surface.uvs;
        uvs.push(0.5 * (uvs[from as usize] + uvs[to as usize]));
        *last = Some(([from, to], uvs.len() as u32 - 1));
        uvs.len() as u32 - 1
    }

    /// Updates the neighbours after a triangle was halved; edge 0 of both halves is left to the caller.
    fn reconnect(&mut self, (t, corner): (u32, u8)) {
        let i = usize::from(corner);
        let old = self.across[t as usize];
        let new = self.across.len() as u32;
        let (of_far, of_near) = (old[(i + 1) % 3], old[(i + 2) % 3]);
        self.across[t as usize] = [u32::MAX, new, of_near];
        self.across.push([u32::MAX, of_far, t]);
        let apex = self.surface.surface.triangles[new as usize][2];
        let theirs = self.surface.surface.triangles[of_far as usize];
        // Their edge towards us begins at the apex.
        let j = (0..3).find(|&j| theirs[j] == apex).expect("neighbours share their edge's ends");
        self.across[of_far as usize][j] = new;
    }
}

/// Replaces a triangle by the two on either side of a new corner in its edge from `corner`: the near one keeps the
/// number, the far one comes last; in both the cut edge's half is edge 0.
fn halve(list: &mut Vec<[u32; 3]>, (t, corner): (u32, u8), middle: u32) {
    let i = usize::from(corner);
    let c = list[t as usize];
    let (from, to, apex) = (c[i], c[(i + 1) % 3], c[(i + 2) % 3]);
    list[t as usize] = [from, middle, apex];
    list.push([middle, to, apex]);
}
