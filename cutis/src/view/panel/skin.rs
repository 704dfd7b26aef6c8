//! The material.

use super::number::{factor, linear};
use super::profile_plot;
use crate::view::app::Viewer;
use cutis_optics::presets;
use cutis_render::prepare::Kernel;
use cutis_render::prepare::kernel::kernel_of;
use eframe::egui::{ComboBox, Ui};

/// Shows it.
pub fn show(viewer: &mut Viewer, ui: &mut Ui) {
    let (look, original) = (&mut viewer.looks[viewer.edited], &viewer.original);
    let skin = &mut look.skin;
    let own = "the scene's own";
    let before = skin.preset.clone();
    ComboBox::from_label("material").selected_text(skin.preset.as_deref().unwrap_or(own)).show_ui(ui, |ui| {
        ui.selectable_value(&mut skin.preset, None, own);
        for preset in presets::all() {
            ui.selectable_value(&mut skin.preset, Some(preset.name.to_owned()), preset.name)
                .on_hover_text(preset.source);
        }
    });
    if skin.preset != before {
        // Gaussians of another kernel have other numbers.
        look.drawing.muted_gaussians.clear();
    }
    free_path(&mut skin.free_path, ui);
    factor("× roughness", "factor on Beckmann's roughness m", 0.2..=3.0).show(ui, &mut skin.roughness);
    let hint = "factor on the specular intensity rho_s: 0 dry, 1 as it is, more is oily";
    linear("× oiliness", hint, 0.0..=3.0, 1.0).show(ui, &mut skin.oiliness);
    let hint = "share of the colour that filters light on its way in, the rest on its way out";
    linear("albedo before scattering", hint, 0.0..=1.0, original.skin.albedo_mix)
        .show(ui, &mut skin.albedo_mix);
    linear("× relief", "factor on the normal map", 0.0..=3.0, 1.0).show(ui, &mut skin.relief);
    let hint = "factor on distances through the body: the less, the more light comes through ears and fingers; \
                the truth does not know it";
    linear("× thickness", hint, 0.0..=4.0, 1.0).show(ui, &mut skin.thickness);
    let mut material = viewer.scene.objects.first().map(|object| object.material.clone());
    material.iter_mut().for_each(|material| skin.apply_to(material));
    let gaussians = look.drawing.gaussians;
    match material.map(|material| kernel_of(&material, gaussians)) {
        Some(Ok(kernel)) => {
            gaussians_on_and_off(&mut look.drawing.muted_gaussians, &kernel, ui);
            profile_plot::show(ui, &kernel.without(&look.drawing.muted_gaussians));
        }
        Some(Err(error)) => drop(ui.label(error.to_string())),
        None => {}
    }
}

/// One slider for all channels, or one for each.
fn free_path(factors: &mut [f32; 3], ui: &mut Ui) {
    let id = ui.scope_id().with("channels apart");
    let mut apart = ui.data(|data| data.get_temp(id).unwrap_or(false));
    let hint = "factor on the distance that light goes between two scatterings";
    if !apart {
        let mut all = factors[0];
        factor("× mean free path", hint, 0.05..=20.0).show(ui, &mut all);
        if all != factors[0] {
            *factors = [all; 3];
        }
    } else {
        for (name, value) in ["× red", "× green", "× blue"].into_iter().zip(factors) {
            factor(name, hint, 0.05..=20.0).show(ui, value);
        }
    }
    ui.checkbox(&mut apart, "a mean free path for every channel");
    ui.data_mut(|data| data.insert_temp(id, apart));
}

/// A box for every Gaussian.
fn gaussians_on_and_off(muted: &mut Vec<usize>, kernel: &Kernel, ui: &mut Ui) {
    ui.label("Gaussians, by standard deviation [mm]");
    ui.horizontal_wrapped(|ui| {
        for (i, (variance, weight)) in kernel.variances_mm2.iter().zip(&kernel.weights).enumerate() {
            let mut on = !muted.contains(&i);
            let [r, g, b] = weight.to_array();
            let hint = format!("variance {variance:.4} mm², weights {r:.3}, {g:.3}, {b:.3}");
            if ui.checkbox(&mut on, format!("{:.2}", variance.sqrt())).on_hover_text(hint).changed() {
                muted.retain(|&m| m != i);
                if !on {
                    muted.push(i);
                }
            }
        }
    });
}
