//! Flags that were given, one by one.

use super::ramp;
use crate::cli::{DepthAbsorptionArgs, ImageSpaceArgs, TechniqueArgs, TextureBlurArgs, WrapArgs};
use cutis_render::TechniqueName;
use cutis_render::prepare::ColourRamp;
use cutis_render::settings::TechniqueSettings;
use cutis_render::technique::depth_absorption::{DepthAbsorptionSettings, FallOff};
use miette::Result;
use std::sync::Arc;

/// A flag that was given.
pub struct Wish {
    /// The flag.
    pub flag: &'static str,
    /// Whose number it is.
    pub technique: TechniqueName,
    /// What it does.
    pub set: Box<dyn FnOnce(&mut TechniqueSettings)>,
}

/// All flags that were given; files that they name are read.
///
/// # Errors
/// If a file cannot be read or is no ramp. Other values are taken as they are.
pub fn wishes(args: &TechniqueArgs, warnings: &mut Vec<String>) -> Result<Vec<Wish>> {
    let depth_absorption = of_depth_absorption(&args.depth_absorption, warnings)?;
    let all = [
        of_wrap(&args.wrap),
        depth_absorption,
        of_texture_blur(&args.texture_blur),
        of_image_space(&args.image_space),
    ];
    Ok(all.into_iter().flatten().collect())
}

/// The numbers of one technique among those of all.
struct Of<S> {
    technique: TechniqueName,
    part: fn(&mut TechniqueSettings) -> &mut S,
}

impl<S: 'static> Of<S> {
    fn wish<T: 'static>(&self, flag: &'static str, value: Option<T>, set: fn(&mut S, T)) -> Option<Wish> {
        let (technique, part) = (self.technique, self.part);
        value.map(|value| Wish { flag, technique, set: Box::new(move |all| set(part(all), value)) })
    }
}

fn of_wrap(args: &WrapArgs) -> Vec<Wish> {
    let of = Of { technique: TechniqueName::Wrap, part: |all| &mut all.wrap };
    let wishes = [
        of.wish("--wrap", args.wrap, |s, x| s.wrap = x),
        of.wish("--scatter-width", args.scatter_width, |s, x| s.scatter_width = x),
        of.wish("--scatter-colour", args.scatter_colour, |s, x| s.scatter_colour = x),
        of.wish("--wrap-form", args.wrap_form, |s, x| s.form = x),
        of.wish("--wrap-energy-conserving", args.wrap_energy_conserving, |s, x| s.energy_conserving = x),
        of.wish("--wrap-radius", args.wrap_radius, |s, x| s.radius_mm = Some(x)),
        of.wish("--wrap-shine", args.wrap_shine, |s, x| s.shine = x),
        of.wish("--shininess", args.shininess, |s, x| s.shininess = x),
        of.wish("--wrap-specular", args.wrap_specular, |s, x| s.specular_colour = x),
        of.wish("--wrap-shadow-offset", args.wrap_shadow_offset, |s, x| s.shadow_offset_mm = x),
    ];
    wishes.into_iter().flatten().collect()
}

fn of_depth_absorption(args: &DepthAbsorptionArgs, warnings: &mut Vec<String>) -> Result<Vec<Wish>> {
    let of = Of { technique: TechniqueName::DepthAbsorption, part: |all| &mut all.depth_absorption };
    let put_ramp = |s: &mut DepthAbsorptionSettings, ramp: Arc<ColourRamp>| s.fall_off = FallOff::Ramp(ramp);
    let image = args.absorption_ramp_image.as_deref().zip(args.absorption_ramp_length);
    let of_image = image.map(|(path, length_mm)| ramp::of_image(path, length_mm, warnings)).transpose()?;
    let wishes = [
        of.wish("--sigma-t", args.sigma_t, |s, x| s.fall_off = FallOff::Exponential(x)),
        of.wish("--absorption-ramp", args.absorption_ramp.clone(), put_ramp),
        of.wish("--absorption-ramp-image", of_image.map(Arc::new), put_ramp),
        of.wish("--growth", args.growth, |s, x| s.growth_mm = x),
        of.wish("--entry", args.entry, |s, x| s.entry = x),
        of.wish("--depth-samples", args.depth_samples, |s, x| s.samples = x),
        of.wish("--depth-filter-radius", args.depth_filter_radius, |s, x| s.filter_radius_mm = x),
        of.wish("--depth-layers", args.depth_layers, |s, x| s.layers = x),
    ];
    Ok(wishes.into_iter().flatten().collect())
}

fn of_texture_blur(args: &TextureBlurArgs) -> Vec<Wish> {
    let of = Of { technique: TechniqueName::TextureBlur, part: |all| &mut all.texture_blur };
    let wishes = [
        of.wish("--blur-weights", args.blur_weights, |s, x| s.weights = x),
        of.wish("--blur-passes", args.blur_passes, |s, x| s.passes = x),
        of.wish("--blur-blend", args.blur_blend, |s, x| s.blend = x),
        of.wish("--blur-width", args.blur_width, |s, x| s.width = x),
        of.wish("--blur-depth", args.blur_depth, |s, x| s.depth = x),
    ];
    wishes.into_iter().flatten().collect()
}

fn of_image_space(args: &ImageSpaceArgs) -> Vec<Wish> {
    let of = Of { technique: TechniqueName::ImageSpace, part: |all| &mut all.image_space };
    let wishes = [
        of.wish("--profile-samples", args.profile_samples, |s, x| s.samples = x),
        of.wish("--uniform-samples", args.uniform_samples, |s, x| s.uniform_samples = x),
        of.wish("--uniform-radius", args.uniform_radius, |s, x| s.uniform_radius_mm = Some(x)),
        of.wish("--jacobian", args.jacobian, |s, x| s.jacobian = x),
        of.wish("--sample-count", args.sample_count, |s, x| s.count = x),
        of.wish("--light-views", args.light_views, |s, x| s.light_views = x),
        of.wish("--sampled-profile", args.sampled_profile, |s, x| s.profile = x),
    ];
    wishes.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::techniques::{fulfilled, idle};
    use clap::{Args, Command, FromArgMatches};
    use cutis_render::technique::depth_absorption::EntryPoint;
    use cutis_render::technique::image_space::{ImageSpaceProfile, ImageSpaceSettings, SampleCount};
    use cutis_render::technique::texture_blur::{BlurWeights, BlurWidth, TextureBlurSettings};
    use cutis_render::technique::wrap::{WrapForm, WrapSettings, WrapShine};
    use glam::Vec3;

    fn given(words: &[&str]) -> Vec<Wish> {
        let command = TechniqueArgs::augment_args(Command::new("test").no_binary_name(true));
        let matches = command.try_get_matches_from(words).expect("is sound");
        wishes(&TechniqueArgs::from_arg_matches(&matches).expect("is sound"), &mut Vec::new())
            .expect("no file")
    }

    fn settings(words: &[&str]) -> TechniqueSettings {
        fulfilled(TechniqueSettings::default(), given(words)).expect("is in range")
    }

    #[test]
    fn every_flag_changes_its_own_number() {
        let all = settings(&[
            "--wrap=0.5",
            "--scatter-width=0.4",
            "--scatter-colour=0.3,0.2,0.1",
            "--wrap-form=formula",
            "--wrap-energy-conserving=on",
            "--wrap-radius=70",
            "--wrap-shine=power",
            "--shininess=30",
            "--wrap-specular=0.1,0.2,0.3",
            "--wrap-shadow-offset=3",
            "--sigma-t=1,2,3",
            "--growth=0.25",
            "--entry=distance",
            "--depth-samples=9",
            "--depth-filter-radius=2",
            "--depth-layers=4",
            "--blur-weights=printed",
            "--blur-passes=3",
            "--blur-blend=0.75",
            "--blur-width=material",
            "--blur-depth=on",
            "--profile-samples=64",
            "--uniform-samples=16",
            "--uniform-radius=4",
            "--jacobian=off",
            "--sample-count=all",
            "--light-views=off",
            "--sampled-profile=gaussians",
        ]);
        let wrap = WrapSettings {
            wrap: 0.5,
            scatter_width: 0.4,
            scatter_colour: Vec3::new(0.3, 0.2, 0.1),
            shininess: 30.0,
            form: WrapForm::Formula,
            energy_conserving: true,
            radius_mm: Some(70.0),
            shine: WrapShine::Power,
            specular_colour: Vec3::new(0.1, 0.2, 0.3),
            shadow_offset_mm: 3.0,
        };
        assert_eq!(all.wrap, wrap);
        let depth_absorption = DepthAbsorptionSettings {
            fall_off: FallOff::Exponential(Vec3::new(1.0, 2.0, 3.0)),
            growth_mm: 0.25,
            entry: EntryPoint::Distance,
            samples: 9,
            filter_radius_mm: 2.0,
            layers: 4,
        };
        assert_eq!(all.depth_absorption, depth_absorption);
        let texture_blur = TextureBlurSettings {
            weights: BlurWeights::Printed,
            passes: 3,
            blend: 0.75,
            width: BlurWidth::Material,
            depth: true,
        };
        assert_eq!(all.texture_blur, texture_blur);
        let image_space = ImageSpaceSettings {
            samples: 64,
            uniform_samples: 16,
            uniform_radius_mm: Some(4.0),
            jacobian: false,
            count: SampleCount::All,
            light_views: false,
            profile: ImageSpaceProfile::Gaussians,
            round: 0,
        };
        assert_eq!(all.image_space, image_space);
        assert_eq!(settings(&[]), TechniqueSettings::default());
    }

    #[test]
    fn a_ramp_takes_the_place_of_the_material() {
        let FallOff::Ramp(ramp) = settings(&["--absorption-ramp=0:1,1,1;2:0,0,0"]).depth_absorption.fall_off
        else {
            panic!("is a ramp")
        };
        assert_eq!(ramp.at_mm(1.0), Vec3::splat(0.5));
    }

    #[test]
    fn wishes_of_techniques_that_do_not_draw_are_told() {
        let wishes = given(&["--wrap=0.5", "--blur-passes=2", "--jacobian=on"]);
        assert!(idle(&wishes[..1], TechniqueName::Wrap).is_empty());
        assert_eq!(
            idle(&wishes, TechniqueName::TextureBlur),
            [
                "--wrap has no effect: the technique is texture-blur",
                "--jacobian has no effect: the technique is texture-blur"
            ]
        );
    }
}
