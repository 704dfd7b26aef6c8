//! Flattens one disc: Tutte's embedding into a circle, then scalable locally injective mappings with the symmetric
//! Dirichlet energy, whose barrier keeps every triangle the right way round.
//!
//! Tutte 1963, doi:10.1112/plms/s3-13.1.743; Rabinovich, Poranne, Panozzo & Sorkine-Hornung 2017,
//! doi:10.1145/2983621 (both from memory). The border is free, so nothing but a test keeps distant parts of a chart
//! from overlapping; charts that start nearly flat do not.

use glam::{DMat2, DVec2, DVec3};

/// A disc with its own numbering of points.
pub struct Disc {
    /// Positions in space, mm.
    pub points_mm: Vec<DVec3>,
    /// Corners, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The border, in order, counter-clockwise.
    pub border: Vec<u32>,
}

/// Outer rounds; the energy changes by less than a percent in the last ones.
const ROUNDS: usize = 24;
/// Steps of the linear solver per round; it starts from the last solution.
const SOLVER_STEPS: usize = 60;

/// Positions in the plane, in mm (lengths as near as possible to those in space), all triangles counter-clockwise.
pub fn flatten(disc: &Disc) -> Vec<DVec2> {
    let mut flat = tutte(disc);
    let corners: Vec<Corner> =
        disc.triangles.iter().map(|t| Corner::new(t.map(|c| disc.points_mm[c as usize]))).collect();
    let space: f64 = corners.iter().map(|c| c.area).sum();
    let plane: f64 = disc.triangles.iter().map(|t| area(t.map(|c| flat[c as usize]))).sum();
    flat.iter_mut().for_each(|p| *p *= (space / plane).sqrt());
    for _ in 0..ROUNDS {
        improve(disc, &corners, &mut flat);
    }
    flat
}

fn area([a, b, c]: [DVec2; 3]) -> f64 {
    0.5 * (b - a).perp_dot(c - a)
}

/// The border on a circle, every other point in the middle of its neighbours, nearer ones weighing more.
fn tutte(disc: &Disc) -> Vec<DVec2> {
    let mut flat = vec![DVec2::ZERO; disc.points_mm.len()];
    let mut fixed = vec![false; flat.len()];
    let step = |i: usize| {
        let (a, b) = (disc.border[i], disc.border[(i + 1) % disc.border.len()]);
        (disc.points_mm[a as usize] - disc.points_mm[b as usize]).length()
    };
    let whole: f64 = (0..disc.border.len()).map(step).sum();
    let mut along = 0.0;
    for (i, &p) in disc.border.iter().enumerate() {
        flat[p as usize] = DVec2::from_angle(std::f64::consts::TAU * along / whole) * 100.0;
        fixed[p as usize] = true;
        along += step(i);
    }
    let mut links = vec![Vec::with_capacity(7); flat.len()];
    for &[a, b, c] in &disc.triangles {
        for (i, j) in [(a, b), (b, c), (c, a)] {
            let weight = 1.0 / (disc.points_mm[i as usize] - disc.points_mm[j as usize]).length().max(1e-6);
            links[i as usize].push((j as usize, weight));
            links[j as usize].push((i as usize, weight));
        }
    }
    relax(&links, &fixed, &mut flat);
    flat
}

/// Conjugate gradients for the graph Laplacian with fixed points.
fn relax(links: &[Vec<(usize, f64)>], fixed: &[bool], flat: &mut [DVec2]) {
    let diagonal: Vec<f64> = links.iter().map(|l| l.iter().map(|(_, w)| w).sum()).collect();
    let apply = |x: &[DVec2]| -> Vec<DVec2> {
        let row = |i: usize| x[i] * diagonal[i] - links[i].iter().map(|&(j, w)| x[j] * w).sum::<DVec2>();
        (0..x.len()).map(|i| if fixed[i] { DVec2::ZERO } else { row(i) }).collect()
    };
    let precondition =
        |r: &[DVec2]| -> Vec<DVec2> { r.iter().zip(&diagonal).map(|(r, d)| *r / *d).collect() };
    // A few hundred points across need a few hundred steps; the residual decides.
    conjugate_gradients(flat, vec![DVec2::ZERO; links.len()], apply, precondition, 3000, 1e-10);
}

/// Solves `A x = b` for a symmetric positive `A`, starting from `x`.
fn conjugate_gradients(
    x: &mut [DVec2],
    b: Vec<DVec2>,
    apply: impl Fn(&[DVec2]) -> Vec<DVec2>,
    precondition: impl Fn(&[DVec2]) -> Vec<DVec2>,
    steps: usize,
    tolerance: f64,
) {
    let dot = |a: &[DVec2], b: &[DVec2]| -> f64 { a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum() };
    let mut r: Vec<DVec2> = b.iter().zip(apply(x)).map(|(b, ax)| *b - ax).collect();
    let mut z = precondition(&r);
    let mut p = z.clone();
    let mut rz = dot(&r, &z);
    let first = rz;
    for _ in 0..steps {
        if rz <= first * tolerance * tolerance || rz == 0.0 {
            break;
        }
        let ap = apply(&p);
        let alpha = rz / dot(&p, &ap);
        for i in 0..x.len() {
            x[i] += p[i] * alpha;
            r[i] -= ap[i] * alpha;
        }
        z = precondition(&r);
        let next = dot(&r, &z);
        let beta = next / rz;
        rz = next;
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = *z + *p * beta);
    }
}

/// A triangle at rest: its area and the gradients of its three hat functions.
struct Corner {
    area: f64,
    gradients: [DVec2; 3],
}

impl Corner {
    fn new([a, b, c]: [DVec3; 3]) -> Self {
        let x = (b - a).normalize_or(DVec3::X);
        let height = (c - a) - x * x.dot(c - a);
        // A sliver is given a hundredth of a millimetre of height, so that its gradients stay finite.
        let (width, height) = ((b - a).length().max(0.01), height.length().max(0.01));
        let flat = [DVec2::ZERO, DVec2::new(width, 0.0), DVec2::new(x.dot(c - a), height)];
        let double = width * height;
        let gradients = std::array::from_fn(|i| (flat[(i + 2) % 3] - flat[(i + 1) % 3]).perp() / double);
        Self { area: 0.5 * double, gradients }
    }

    fn jacobian(&self, x: [DVec2; 3]) -> DMat2 {
        (0..3).fold(DMat2::ZERO, |j, i| j + outer(x[i], self.gradients[i]))
    }
}

/// a bᵀ.
fn outer(a: DVec2, b: DVec2) -> DMat2 {
    DMat2::from_cols(a * b.x, a * b.y)
}

/// Symmetric Dirichlet energy per area, infinite for a triangle that is turned over.
fn energy(j: DMat2) -> f64 {
    let d = j.determinant();
    let square = j.x_axis.length_squared() + j.y_axis.length_squared();
    if d <= 0.0 { f64::INFINITY } else { square * (1.0 + 1.0 / (d * d)) }
}

fn total_energy(disc: &Disc, corners: &[Corner], flat: &[DVec2]) -> f64 {
    let of = |(t, c): (&[u32; 3], &Corner)| c.area * energy(c.jacobian(t.map(|i| flat[i as usize])));
    disc.triangles.iter().zip(corners).map(of).sum()
}

/// The quadratic stand-in of one triangle: `area |W (J - R)|²`; `m` is `area WᵀW`.
struct Proxy {
    m: DMat2,
    target: DMat2,
}

impl Proxy {
    fn new(j: DMat2, area: f64) -> Self {
        let (a, b, c, d) = (j.x_axis.x, j.y_axis.x, j.x_axis.y, j.y_axis.y);
        let (e, f, g, h) = (0.5 * (a + d), 0.5 * (a - d), 0.5 * (c + b), 0.5 * (c - b));
        let (q, r) = (e.hypot(h), f.hypot(g));
        let (turn, lean) = (h.atan2(e), g.atan2(f));
        let u = DMat2::from_angle(0.5 * (lean + turn));
        // (s - s^-3) / (s - 1), divided out so that s = 1 is harmless.
        let weight = |s: f64| 1.0 + (1.0 + (1.0 + 1.0 / s) / s) / s;
        let weights = DVec2::new(weight(q + r), weight((q - r).max(1e-6)));
        let m = u * DMat2::from_diagonal(weights * area) * u.transpose();
        Self { m, target: DMat2::from_angle(turn) }
    }
}

/// One outer round: solve the stand-in, then go as far towards its solution as the energy falls.
fn improve(disc: &Disc, corners: &[Corner], flat: &mut Vec<DVec2>) {
    let place = |x: &[DVec2], t: &[u32; 3]| t.map(|i| x[i as usize]);
    let proxies: Vec<Proxy> = disc
        .triangles
        .iter()
        .zip(corners)
        .map(|(t, c)| Proxy::new(c.jacobian(place(flat, t)), c.area))
        .collect();
    let gather = |stress: &dyn Fn(usize) -> DMat2| {
        let mut sums = vec![DVec2::ZERO; flat.len()];
        for (k, t) in disc.triangles.iter().enumerate() {
            let s = stress(k);
            (0..3).for_each(|i| sums[t[i] as usize] += s * corners[k].gradients[i]);
        }
        sums
    };
    let mut blocks = vec![DMat2::ZERO; flat.len()];
    for (k, t) in disc.triangles.iter().enumerate() {
        (0..3).for_each(|i| blocks[t[i] as usize] += proxies[k].m * corners[k].gradients[i].length_squared());
    }
    let inverses: Vec<DMat2> = blocks.iter().map(|b| b.inverse()).collect();
    let b = gather(&|k| proxies[k].m * proxies[k].target);
    let apply = |x: &[DVec2]| gather(&|k| proxies[k].m * corners[k].jacobian(place(x, &disc.triangles[k])));
    let precondition =
        |r: &[DVec2]| -> Vec<DVec2> { r.iter().zip(&inverses).map(|(r, i)| *i * *r).collect() };
    let mut wish = flat.clone();
    conjugate_gradients(&mut wish, b, apply, precondition, SOLVER_STEPS, 1e-6);
    let direction: Vec<DVec2> = wish.iter().zip(flat.iter()).map(|(w, f)| *w - *f).collect();
    line_search(disc, corners, flat, &direction);
}

fn line_search(disc: &Disc, corners: &[Corner], flat: &mut Vec<DVec2>, direction: &[DVec2]) {
    let largest =
        disc.triangles.iter().map(|t| first_collapse(t.map(|i| (flat[i as usize], direction[i as usize]))));
    let mut step = largest.fold(f64::INFINITY, f64::min).mul_add(0.9, 0.0).min(1.0);
    let before = total_energy(disc, corners, flat);
    // After 30 halvings nothing would move: the chart has converged.
    for _ in 0..30 {
        let trial: Vec<DVec2> = flat.iter().zip(direction).map(|(f, d)| *f + *d * step).collect();
        if total_energy(disc, corners, &trial) < before {
            *flat = trial;
            return;
        }
        step *= 0.5;
    }
}

/// The smallest positive time at which a moving triangle has no area.
fn first_collapse([(a, da), (b, db), (c, dc)]: [(DVec2, DVec2); 3]) -> f64 {
    let (u, v, du, dv) = (b - a, c - a, db - da, dc - da);
    let (square, linear, constant) = (du.perp_dot(dv), u.perp_dot(dv) + du.perp_dot(v), u.perp_dot(v));
    let discriminant = linear * linear - 4.0 * square * constant;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    // The stable form of both roots.
    let q = -0.5 * (linear + linear.signum() * discriminant.sqrt());
    let positive = |t: f64| if t > 0.0 { t } else { f64::INFINITY };
    positive(q / square).min(positive(constant / q))
}
