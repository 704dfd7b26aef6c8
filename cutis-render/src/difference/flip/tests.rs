//! FLIP against the program of its authors, and what must hold for any pictures.

use super::*;

const WIDTH: usize = 96;
const HEIGHT: usize = 64;

/// A picture from a formula of column, row and channel.
fn picture(of: impl Fn(u32, u32, u32) -> f64) -> Vec<Vec3> {
    let at = |i: usize| {
        let (x, y) = ((i % WIDTH) as u32, (i / WIDTH) as u32);
        Vec3::from_array([0, 1, 2].map(|c| of(x, y, c) as f32))
    };
    (0..WIDTH * HEIGHT).map(at).collect()
}

/// Even noise in 0..1 from a hash of 32 bits.
fn noise(seed: u32, x: u32, y: u32, c: u32) -> f64 {
    let mut h =
        x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77) ^ c.wrapping_mul(0xC2B2_AE3D) ^ seed;
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    h ^= h >> 15;
    f64::from(h >> 8) / f64::from(1 << 24)
}

fn gradient(x: u32, y: u32, c: u32) -> f64 {
    let (across, down) = (f64::from(x) / (WIDTH - 1) as f64, f64::from(y) / (HEIGHT - 1) as f64);
    [across, down, 0.5 * (1.0 - across)][c as usize]
}

fn disc(centre: f64, x: u32, y: u32, c: u32) -> f64 {
    let inside = (f64::from(x) - centre).powi(2) + (f64::from(y) - 31.5).powi(2) < 400.0;
    if inside { [0.8, 0.5, 0.4][c as usize] } else { 0.05 }
}

fn blocks(turn: u32) -> Vec<Vec3> {
    picture(|x, y, c| noise(7, x / 8, y / 8, (c + turn) % 3))
}

fn ramp(x: u32, c: u32) -> f64 {
    (10.0 * f64::from(x) / (WIDTH - 1) as f64 - 5.0).exp2() * [1.0, 0.6, 0.3][c as usize]
}

fn sparks(height: f64) -> Vec<Vec3> {
    let spark = |x: u32, y: u32| if x % 16 == 8 && y % 16 == 8 { height } else { 0.0 };
    picture(|x, y, c| 0.02 + 0.01 * noise(3, x, y, c) + spark(x, y))
}

fn lit_corner(height: f64, rest: f64) -> Vec<Vec3> {
    picture(|x, y, c| rest + if x < 40 && y < 40 { height * gradient(x, y, c) } else { 0.0 })
}

/// Picture and reference.
type Pictures = (Vec<Vec3>, Vec<Vec3>);

fn ldr_pairs() -> [Pictures; 5] {
    let noisy = |x, y, c| (gradient(x, y, c) + 0.2 * (noise(1, x, y, c) - 0.5)).clamp(0.0, 1.0);
    [
        (picture(|x, y, c| gradient(x, y, c) * 0.9 + 0.05), picture(gradient)),
        (picture(noisy), picture(gradient)),
        (picture(|x, y, c| disc(50.0, x, y, c)), picture(|x, y, c| disc(47.0, x, y, c))),
        (blocks(1), blocks(0)),
        (picture(|_, _, _| 1.0), picture(|_, _, _| 0.0)),
    ]
}

fn hdr_pairs() -> [Pictures; 6] {
    let noisy = |x, y, c| ramp(x, c) * (1.0 + 0.3 * (noise(2, x, y, c) - 0.5));
    [
        (picture(noisy), picture(|x, _, c| ramp(x, c))),
        (sparks(0.0), sparks(200.0)),
        (sparks(100.0), sparks(200.0)),
        (picture(|x, y, c| disc(47.0, x, y, c) * 20.0), picture(|x, y, c| disc(47.0, x, y, c) * 16.0)),
        (lit_corner(4.0, 0.001), lit_corner(5.0, 0.002)),
        (lit_corner(4.0, 0.0), lit_corner(5.0, 0.0)),
    ]
}

fn pair((test, reference): &Pictures) -> Pair<'_> {
    Pair::new(test, reference, WIDTH).expect("a pair")
}

/// What `validation/flip_reference.py` printed with flip-evaluator 1.7, at 67 and at 20 pixels per degree: mean, maximum.
const LDR_BY_ITS_AUTHORS: [(f64, [(f64, f64); 5]); 2] = [
    (
        67.0,
        [
            (0.220_956_8, 0.396_778),
            (0.124_940_4, 0.410_588),
            (0.094_978_7, 0.928_779),
            (0.819_839_7, 0.991_059),
            (0.967_391_8, 0.967_392),
        ],
    ),
    (
        20.0,
        [
            (0.211_240_6, 0.403_935),
            (0.291_090_7, 0.576_521),
            (0.060_498_8, 0.982_750),
            (0.847_063_9, 0.994_303),
            (0.967_391_3, 0.967_391),
        ],
    ),
];
const HDR_BY_ITS_AUTHORS: [(f64, [(f64, f64); 6]); 2] = [
    (
        67.0,
        [
            (0.061_891_0, 0.178_571),
            (0.056_786_7, 0.862_210),
            (0.012_626_2, 0.174_882),
            (0.194_160_9, 0.252_457),
            (0.400_666_8, 0.585_833),
            (0.059_979_9, 0.334_202),
        ],
    ),
    (
        20.0,
        [
            (0.159_434_9, 0.297_432),
            (0.012_368_2, 0.989_895),
            (0.002_816_5, 0.348_273),
            (0.190_112_9, 0.275_658),
            (0.392_924_8, 0.680_934),
            (0.053_270_2, 0.376_131),
        ],
    ),
];
/// The exposures that went with it: first, last, how many.
const EXPOSURES_BY_ITS_AUTHORS: [(f64, f64, u32); 6] = [
    (-3.324_610, 1.622_758, 5),
    (-6.560_770, 6.400_019, 13),
    (-6.560_770, 6.400_019, 13),
    (-2.071_312, 1.405_225, 4),
    (-0.380_589, 10.049_082, 11),
    (-0.379_542, 24.083_298, 25),
];

/// Two programs in f32 that add up in different orders. Where a picture is even, its features differ from none by
/// roundings r of some 1e-7, and the error of the colour is raised to the power of 1 - √r: 2e-4 of its logarithm at most.
const MEAN_TOLERANCE: f64 = 5e-5;
const MAX_TOLERANCE: f64 = 1e-4;

#[allow(clippy::print_stdout, reason = "`--nocapture` shows by how much")]
fn assert_meets(found: &FlipMap, (mean, max): (f64, f64), what: &str) {
    println!("{what}: mean {:.7} ({:+.1e}), max {:.6}", found.mean, found.mean - mean, found.max);
    assert!((found.mean - mean).abs() < MEAN_TOLERANCE, "{what}: mean {} for {mean}", found.mean);
    assert!((f64::from(found.max) - max).abs() < MAX_TOLERANCE, "{what}: max {} for {max}", found.max);
}

#[test]
fn ldr_flip_meets_the_program_of_its_authors() {
    for (pixels_per_degree, expected) in LDR_BY_ITS_AUTHORS {
        for (i, pictures) in ldr_pairs().iter().enumerate() {
            let found = ldr_flip(pair(pictures), pixels_per_degree);
            assert_meets(&found, expected[i], &format!("LDR {pixels_per_degree} pair {i}"));
        }
    }
}

#[test]
fn hdr_flip_meets_the_program_of_its_authors() {
    for (pixels_per_degree, expected) in HDR_BY_ITS_AUTHORS {
        for (i, pictures) in hdr_pairs().iter().enumerate() {
            let found = hdr_flip(pair(pictures), pixels_per_degree);
            assert_meets(&found.map, expected[i], &format!("HDR {pixels_per_degree} pair {i}"));
            let (start, stop, count) = EXPOSURES_BY_ITS_AUTHORS[i];
            let Exposures { start_ev, stop_ev, count: found } = found.exposures;
            assert!((start_ev - start).abs() < 1e-5 && (stop_ev - stop).abs() < 1e-5, "{start_ev} {stop_ev}");
            assert_eq!(found, count);
        }
    }
}

#[test]
fn identical_pictures_have_no_error_at_all() {
    for (_, reference) in ldr_pairs() {
        let found = ldr_flip(pair(&(reference.clone(), reference)), DEFAULT_PIXELS_PER_DEGREE);
        assert_eq!((found.mean, found.max), (0.0, 0.0));
    }
    for (_, reference) in hdr_pairs() {
        let found = hdr_flip(pair(&(reference.clone(), reference)), DEFAULT_PIXELS_PER_DEGREE);
        assert_eq!((found.map.mean, found.map.max), (0.0, 0.0));
    }
}

#[test]
fn errors_lie_between_0_and_1_and_the_order_does_not_matter_on_a_screen() {
    for (test, reference) in ldr_pairs() {
        let there = ldr_flip(pair(&(test.clone(), reference.clone())), DEFAULT_PIXELS_PER_DEGREE);
        let back = ldr_flip(pair(&(reference, test)), DEFAULT_PIXELS_PER_DEGREE);
        assert_eq!(there, back);
        assert!(there.errors.iter().all(|e| (0.0..=1.0).contains(e)));
    }
}

#[test]
fn even_pictures_have_the_error_of_their_colours_at_every_distance() {
    // White and black are 100 apart, green and blue 308.1 after Hunt's effect by hand: 100^0.7 = 25.12 of 55.2, beyond
    // the knee at 0.4: 0.95 + 0.05 (25.12/55.2 - 0.4)/0.6. No edges, so the whole picture has this error.
    let white_and_black = (vec![Vec3::ONE; 400], vec![Vec3::ZERO; 400]);
    for pixels_per_degree in [1.0, 10.0, 67.0, 300.0] {
        let pair = Pair::new(&white_and_black.0, &white_and_black.1, 20).expect("a pair");
        let found = ldr_flip(pair, pixels_per_degree);
        assert!(found.errors.iter().all(|e| (e - found.errors[0]).abs() < 1e-4), "{pixels_per_degree}");
        assert!((found.mean - 0.967_39).abs() < 1e-4, "{pixels_per_degree}: {}", found.mean);
    }
}

#[test]
fn light_beyond_any_limit_is_compared_without_nan() {
    for scale in [1e-3_f32, 1e30] {
        let (mut test, mut reference) = hdr_pairs()[3].clone();
        test.iter_mut().chain(&mut reference).for_each(|pixel| *pixel *= scale);
        let found = hdr_flip(pair(&(test, reference)), DEFAULT_PIXELS_PER_DEGREE);
        // The unit of light does not matter but for roundings.
        assert!((found.map.mean - HDR_BY_ITS_AUTHORS[0].1[3].0).abs() < 1e-4, "{scale}: {}", found.map.mean);
    }
    let black = vec![Vec3::ZERO; WIDTH * HEIGHT];
    let lost = hdr_flip(pair(&(black.clone(), black)), DEFAULT_PIXELS_PER_DEGREE);
    assert_eq!(lost.map.max, 0.0);
}
