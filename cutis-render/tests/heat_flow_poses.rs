//! Heat flow over surfaces that move after the flow was made.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "common/sheets.rs"]
mod sheets;

use cutis_render::passes::atlas::Atlas;
use cutis_render::passes::heat_flow::HeatFlow;
use cutis_render::passes::stretch::stretch_mm_per_texel;
use cutis_scene::{Material, Object};
use glam::Vec3;
use sheets::{flown_in_pose, in_four, noise, plane};

/// A plane that is drawn out to one side after the flow was made, more than it is pressed together to the other: Gaussians
/// keep their width in millimetres, over cuts and on coarse maps, too.
#[test]
fn a_bump_keeps_its_width_in_another_pose() {
    let middle = Vec3::new(0.7, -0.4, 0.0);
    let bump = |v: f32| move |p: Vec3| 1.5 / v * (-(p - middle).length_squared() / (2.0 * v)).exp();
    for variance_mm2 in [1.2, 6.0, 24.0] {
        let rest = plane(in_four);
        let mut mesh = rest.mesh.clone();
        mesh.positions_mm.iter_mut().for_each(|p| *p *= Vec3::new(1.4, 0.85, 1.0));
        let posed = Object::new("plane", mesh, Material::default());
        let lit = flown_in_pose(&posed, Some(&rest), 512, variance_mm2, bump(1.5));
        let expected = bump(1.5 + variance_mm2);
        let worst = lit.iter().map(|l| (l.after - expected(l.place_mm)).abs()).fold(0.0, f32::max);
        let worst = worst / expected(middle);
        eprintln!("{variance_mm2} mm²: {worst:.4} of the peak");
        assert!(worst < 0.012, "{variance_mm2}: {worst}");
    }
}

/// What a pose has changed is as it was when the object comes back to rest, however fast links were in between.
#[test]
fn back_at_rest_heat_flows_as_before() {
    let rest = plane(in_four);
    let atlas = Atlas::new(&rest, 256);
    let variances_mm2 = [1.0, 30.0];
    let flow = HeatFlow::new(&rest, &atlas, &stretch_mm_per_texel(&rest, &atlas), &variances_mm2);
    assert!(flow.levels.len() > 1, "there is a coarse level");
    let mut mesh = rest.mesh.clone();
    mesh.positions_mm.iter_mut().for_each(|p| *p *= 0.7);
    let light: Vec<f64> = (0..256 * 256).map(|i| f64::from(noise(i / 7, 5).round())).collect();
    let mut posed = flow.clone();
    posed.set_pose(&Object::new("plane", mesh, Material::default()));
    assert!(posed.flow(&light) != flow.flow(&light), "the pose shows");
    posed.set_pose(&rest);
    assert!(posed.flow(&light) == flow.flow(&light), "nothing is left of the pose");
}

/// A quarter that is too small for an area when the flow is made: once it has grown, even light is as even there as elsewhere, on
/// coarse maps, too, whose texels stood for nothing.
#[test]
fn what_grows_in_a_pose_is_lit_like_the_rest() {
    let grown = plane(in_four);
    let mut mesh = grown.mesh.clone();
    let is_small = |p: &&mut Vec3| p.x > 0.0 && p.y > 0.0;
    mesh.positions_mm.iter_mut().filter(is_small).for_each(|p| *p *= 1e-30);
    let small = Object::new("plane", mesh, Material::default());
    let atlas = Atlas::new(&small, 256);
    let mut flow = HeatFlow::new(&small, &atlas, &stretch_mm_per_texel(&small, &atlas), &[1.0, 30.0]);
    let lit_texels = |flow: &HeatFlow| {
        flow.levels.last().unwrap().exchange.areas_mm2.iter().filter(|area| **area > 0.0).count()
    };
    assert!(flow.levels.len() > 1, "there is a coarse level");
    let before = lit_texels(&flow);
    flow.set_pose(&grown);
    assert!(lit_texels(&flow) > before + before / 5, "it has grown");
    let coarse = &flow.levels.last().unwrap().exchange;
    let maps = flow.flow(&vec![1.0f64; 256 * 256]);
    let lit = maps[1].iter().zip(&coarse.areas_mm2).filter(|(_, area)| **area > 0.0);
    let off = lit.map(|(light, _)| (light - 1.0).abs()).fold(0.0, f64::max);
    assert!(off < 1e-3, "{off}");
}
