//! Looks at the built-in head from all sides: simple shading, no skin optics, a quick check of shape and maps.
//!
//! `cargo run --release -p cutis-scene --example look_at_head -- [folder] [triangles] [clay|skin]`

use cutis_scene::head::{HeadDetail, built_in};
use cutis_scene::{Bvh, Object, SurfacePoint, Texels};
use glam::{Mat3, Vec3};
use rayon::prelude::*;
use std::path::Path;

const WIDTH: u32 = 600;
const HEIGHT: u32 = 700;

struct View {
    name: &'static str,
    yaw_deg: f32,
    pitch_deg: f32,
    look_at_mm: Vec3,
    height_mm: f32,
}

fn view(name: &'static str, yaw_deg: f32, pitch_deg: f32, look_at_mm: Vec3, height_mm: f32) -> View {
    View { name, yaw_deg, pitch_deg, look_at_mm, height_mm }
}

fn views() -> Vec<View> {
    let middle = Vec3::new(0.0, -38.0, -10.0);
    vec![
        view("1_front", 0.0, 0.0, middle, 345.0),
        view("2_three_quarter", 38.0, 6.0, middle, 345.0),
        view("3_profile", 90.0, 0.0, middle, 345.0),
        view("4_back", 165.0, 5.0, middle, 345.0),
        view("5_below", 20.0, -38.0, middle, 345.0),
        view("6_ear", 75.0, 0.0, Vec3::new(70.0, -15.0, -10.0), 95.0),
        view("7_eye", 15.0, 0.0, Vec3::new(25.0, -5.0, 80.0), 90.0),
        view("8_mouth", 12.0, 0.0, Vec3::new(0.0, -58.0, 90.0), 100.0),
    ]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| "head_look".to_owned());
    let triangles = arguments.next().map_or(Ok(100_000), |n| n.parse())?;
    let clay = arguments.next().is_some_and(|look| look == "clay");
    let only = arguments.next();
    std::fs::create_dir_all(&folder)?;
    let start = std::time::Instant::now();
    let head = built_in(HeadDetail { triangles, map_size: if clay { 0 } else { 2048 } });
    eprintln!(
        "{} triangles, {} vertices, {} charts, closed {}, {:.2} s",
        head.mesh.triangles.len(),
        head.mesh.positions_mm.len(),
        head.charts.count,
        head.closed,
        start.elapsed().as_secs_f32()
    );
    report_texels(&head);
    let objects = [head];
    let bvh = Bvh::build(&objects);
    let mut sheet = image::RgbImage::new(4 * WIDTH, 2 * HEIGHT);
    let wanted = |v: &&View| only.as_ref().is_none_or(|o| v.name.contains(o.as_str()));
    for (i, view) in (0u32..).zip(views().iter().filter(wanted)) {
        let image = picture(&objects[0], &bvh, view, clay)?;
        image.save(Path::new(&folder).join(format!("{}.png", view.name)))?;
        image::imageops::replace(&mut sheet, &image, i64::from(i % 4 * WIDTH), i64::from(i / 4 * HEIGHT));
    }
    save_maps(&objects[0], Path::new(&folder))?;
    layout(&objects[0]).save(Path::new(&folder).join("uv.png"))?;
    sheet.save(Path::new(&folder).join("sheet.png"))?;
    Ok(())
}

fn picture(head: &Object, bvh: &Bvh, view: &View, clay: bool) -> Result<image::RgbImage, &'static str> {
    let world_from_view = Mat3::from_rotation_y(view.yaw_deg.to_radians())
        * Mat3::from_rotation_x(-view.pitch_deg.to_radians());
    let mm = view.height_mm / HEIGHT as f32;
    let pixel = |index: u32| {
        let (x, y) = (index % WIDTH, index / WIDTH);
        let mut sum = Vec3::ZERO;
        for s in 0..4u32 {
            let (sx, sy) = (0.25 + 0.5 * (s & 1) as f32, 0.25 + 0.5 * (s >> 1) as f32);
            let offset =
                Vec3::new(x as f32 + sx - 0.5 * WIDTH as f32, 0.5 * HEIGHT as f32 - y as f32 - sy, 0.0) * mm;
            // A long lens from 1.5 m.
            let eye = world_from_view * Vec3::new(0.0, 0.0, 1500.0);
            let target = world_from_view * offset;
            let dir = (target - eye).normalize();
            sum += shade(head, bvh, eye + view.look_at_mm, dir, world_from_view, index * 4 + s, clay);
        }
        (sum / 4.0).to_array().map(encode)
    };
    let pixels: Vec<[u8; 3]> = (0..WIDTH * HEIGHT).into_par_iter().map(pixel).collect();
    image::RgbImage::from_raw(WIDTH, HEIGHT, pixels.into_flattened()).ok_or("picture size")
}

fn encode(linear: f32) -> u8 {
    let c = linear.clamp(0.0, 1.0);
    let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0 + 0.5) as u8
}

fn shade(
    head: &Object,
    bvh: &Bvh,
    eye: Vec3,
    dir: Vec3,
    world_from_view: Mat3,
    seed: u32,
    clay: bool,
) -> Vec3 {
    let Some(hit) = bvh.closest(eye, dir, 4000.0) else { return Vec3::splat(0.03) };
    let point = head.surface_point(hit.triangle, hit.b1, hit.b2);
    let material = &head.material;
    let normal = match (&material.normal, clay) {
        (Some(map), false) => map.at(point.map_uv, point.normal, point.tangent),
        _ => point.normal,
    };
    let albedo = if clay { Vec3::new(0.55, 0.5, 0.46) } else { material.albedo.at(point.map_uv) };
    let key = world_from_view * Vec3::new(-0.55, 0.6, 0.62).normalize();
    let fill = world_from_view * Vec3::new(0.75, 0.1, 0.5).normalize();
    let mut light = 2.1 * lambert(bvh, &point, normal, key) + 0.45 * lambert(bvh, &point, normal, fill);
    light += 0.55 * openness(bvh, &point, seed);
    let mut colour = albedo * light;
    if !clay {
        let half = (key - dir).normalize();
        let m = material.roughness.at(point.map_uv);
        let gloss =
            0.028 * material.rho_s.at(point.map_uv) * normal.dot(half).max(0.0).powf(2.0 / (m * m)) / (m * m);
        colour += Vec3::splat(2.1 * gloss * lambert(bvh, &point, normal, key));
    }
    colour
}

fn lambert(bvh: &Bvh, point: &SurfacePoint, normal: Vec3, to_light: Vec3) -> f32 {
    let cosine = normal.dot(to_light).max(0.0) / std::f32::consts::PI;
    let start = bvh.step_off(point.lifted_position_mm, point.normal);
    if cosine == 0.0 || bvh.occluded(start, to_light, 1000.0) {
        0.0
    } else {
        cosine * std::f32::consts::PI * 0.5
    }
}

/// Open part of the sky over the point, from a few rays within 80 mm.
fn openness(bvh: &Bvh, point: &SurfacePoint, seed: u32) -> f32 {
    const RAYS: u32 = 6;
    let start = bvh.step_off(point.lifted_position_mm, point.normal);
    let open = (0..RAYS).filter(|ray| {
        let d = random_direction(seed * RAYS + ray);
        !bvh.occluded(start, (point.normal + d * 0.99).normalize_or(point.normal), 80.0)
    });
    open.count() as f32 / RAYS as f32
}

fn random_direction(seed: u32) -> Vec3 {
    let hash = |mut x: u32| {
        x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
        x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
        (x ^ (x >> 16)) as f32 / u32::MAX as f32
    };
    let (z, angle) = (2.0 * hash(seed) - 1.0, std::f32::consts::TAU * hash(seed ^ 0x9e37_79b9));
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * angle.cos(), r * angle.sin(), z)
}

/// Saves the maps as they are stored.
fn save_maps(head: &Object, folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let material = &head.material;
    let maps = [
        ("map_albedo", material.albedo.texture.as_ref()),
        ("map_normal", material.normal.as_ref().map(|n| &n.texture)),
        ("map_shine", material.rho_s.texture.as_ref().map(|(t, _)| t)),
    ];
    for (name, texture) in maps.into_iter().filter_map(|(name, t)| Some((name, t?))) {
        let (Texels::Srgb8(texels) | Texels::Linear8(texels)) = texture.texels() else { continue };
        let image =
            image::RgbaImage::from_raw(texture.width(), texture.height(), texels.clone().into_flattened());
        image.ok_or("map size")?.save(folder.join(format!("{name}.png")))?;
    }
    Ok(())
}

/// Prints how large a texel is on the face and how the size varies.
fn report_texels(head: &Object) {
    let mesh = &head.mesh;
    let face = |t: &usize| {
        let p = mesh.corners_mm(*t).iter().sum::<Vec3>() / 3.0;
        p.z > 30.0 && p.y > -115.0 && p.y < 90.0
    };
    let mut sizes: Vec<(f32, f32)> = (0..mesh.triangles.len())
        .filter(face)
        .map(|t| {
            let [a, b, c] = mesh.corner_map_uvs(t);
            let texels = 0.5 * (b - a).perp_dot(c - a).abs() * 2048.0 * 2048.0;
            ((mesh.area_mm2(t) / texels).sqrt(), mesh.area_mm2(t))
        })
        .collect();
    sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let whole: f32 = sizes.iter().map(|s| s.1).sum();
    let quantile = |q: f32| {
        let mut below = 0.0;
        sizes
            .iter()
            .find(|s| {
                below += s.1;
                below >= q * whole
            })
            .map_or(0.0, |s| s.0)
    };
    eprintln!(
        "texel on the face, mm at 2048: 1 % {:.3}, 10 % {:.3}, half {:.3}, 90 % {:.3}, 99 % {:.3}; overlap {:.5}",
        quantile(0.01),
        quantile(0.1),
        quantile(0.5),
        quantile(0.9),
        quantile(0.99),
        cutis_scene::Charts::overlap_fraction(mesh, 2048)
    );
}

/// The charts of the texture, each in its colour, with the edges of every triangle darker.
fn layout(head: &Object) -> image::RgbImage {
    const SIZE: f32 = 1400.0;
    let mut image = image::RgbImage::new(SIZE as u32, SIZE as u32);
    for t in 0..head.mesh.triangles.len() {
        let c = head.mesh.corner_map_uvs(t).map(|uv| uv * SIZE - 0.5);
        let hue = head.charts.of_triangle[t].wrapping_mul(0x9e37_79b9).to_be_bytes();
        let colour = image::Rgb([90 + hue[0] / 2, 90 + hue[1] / 2, 90 + hue[2] / 2]);
        let (lo, hi) = (c[0].min(c[1]).min(c[2]).ceil(), c[0].max(c[1]).max(c[2]));
        let area = (c[1] - c[0]).perp_dot(c[2] - c[0]);
        for y in lo.y as u32..=hi.y.min(SIZE - 1.0) as u32 {
            for x in lo.x as u32..=hi.x.min(SIZE - 1.0) as u32 {
                let p = glam::Vec2::new(x as f32, y as f32);
                let inside = |i: usize| (c[(i + 1) % 3] - c[i]).perp_dot(p - c[i]) / area >= 0.0;
                if (0..3).all(inside) {
                    image.put_pixel(x, y, colour);
                }
            }
        }
    }
    image
}
