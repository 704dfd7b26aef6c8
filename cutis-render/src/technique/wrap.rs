//! Wrap lighting: diffuse light that goes on beyond the terminator, with a tint where it ends (Green 2004, GPU Gems,
//! chapter 16, section 16.2 and listing 16-1).
//!
//! Symbols: c = N·L, w the wrap; c_w = (c + w)/(1 + w). Light of irradiance E leaves as E (max(c_w, 0) + tint · colour).
//! A whole ball sends back 1 + w times the light of a Lambertian one; the energy-conserving variant divides by that.
//! Beside the paper: shadows, light from all around, the film of the skin and what its surface lets in, all as the other
//! techniques have them; and a wrap for each channel from how far the material spreads light.
//! Not modelled: where light entered. A shadow's edge on flat skin stays sharp.

use super::{Exitance, Inside};
use crate::RenderError;
use crate::lit_scene::Lit;
use crate::passes::irradiance::from_environment;
use crate::passes::resolve::Place;
use crate::prepare::kernel::kernel_of;
use crate::prepare::skin_table::{SkinTable, smoothstep};
use crate::settings::within;
use cutis_scene::Material;
use glam::{Vec3, Vec4};
use std::f32::consts::PI;
use std::fmt;

/// Numbers of the technique `wrap`; those of listing 16-1 by default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrapSettings {
    /// Cosine by which light goes on beyond the terminator, 0 to 1.
    pub wrap: f32,
    /// Width of the tint at the terminator, in wrapped cosines, 0 to 1.
    pub scatter_width: f32,
    /// Colour of the tint, linear, 0 to 1 of the irradiance.
    pub scatter_colour: Vec3,
    /// Exponent of the paper's specular power, 1 to 1000.
    pub shininess: f32,
    /// Where the function is evaluated.
    pub form: WrapForm,
    /// Whether a whole ball sends back no more light than a Lambertian one.
    pub energy_conserving: bool,
    /// Radius of the body, mm: with one, each channel wraps as far as the material spreads light over such a body, in place
    /// of `wrap`, and the tint is that much narrower than the widest of them.
    pub radius_mm: Option<f32>,
    /// How the surface reflects lights.
    pub shine: WrapShine,
    /// Colour of the paper's specular power, linear.
    pub specular_colour: Vec3,
    /// How far above the surface a place where the light ends looks for what hides it, mm: beyond the bulge of its own body.
    /// A tenth of that at the terminator.
    pub shadow_offset_mm: f32,
}

/// Where the function is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrapForm {
    /// Read from a table over N·L and N·H, as in the paper.
    Table,
    /// Computed at every place.
    Formula,
}

/// How the surface reflects lights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrapShine {
    /// By the lobe of all other techniques.
    Measured,
    /// By a power of N·H, as in the paper.
    Power,
}

impl WrapForm {
    /// All of them.
    pub const ALL: [WrapForm; 2] = [WrapForm::Table, WrapForm::Formula];
}

impl WrapShine {
    /// All of them.
    pub const ALL: [WrapShine; 2] = [WrapShine::Measured, WrapShine::Power];
}

impl fmt::Display for WrapForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            WrapForm::Table => "table",
            WrapForm::Formula => "formula",
        })
    }
}

impl fmt::Display for WrapShine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            WrapShine::Measured => "measured",
            WrapShine::Power => "power",
        })
    }
}

impl Default for WrapSettings {
    fn default() -> Self {
        Self {
            wrap: 0.2,
            scatter_width: 0.3,
            scatter_colour: Vec3::new(0.15, 0.0, 0.0),
            shininess: 40.0,
            form: WrapForm::Table,
            energy_conserving: false,
            radius_mm: None,
            shine: WrapShine::Measured,
            specular_colour: Vec3::splat(0.2),
            shadow_offset_mm: 10.0,
        }
    }
}

impl WrapSettings {
    /// Checks every number against its range.
    ///
    /// # Errors
    /// Names the first that is out of its range.
    pub fn check(&self) -> Result<(), RenderError> {
        let unit = 0.0..=1.0;
        let colour = |name, c: Vec3| {
            let worst = c.to_array().into_iter().find(|x| !unit.contains(x)).unwrap_or(0.0);
            within(name, worst, "0 to 1 in every channel", unit.contains(&worst))
        };
        within("wrap", self.wrap, "0 to 1", unit.contains(&self.wrap))?;
        within("scatter width", self.scatter_width, "0 to 1", unit.contains(&self.scatter_width))?;
        colour("scatter colour", self.scatter_colour)?;
        colour("specular colour", self.specular_colour)?;
        within("shininess", self.shininess, "1 to 1000", (1.0..=1000.0).contains(&self.shininess))?;
        let offset_mm = self.shadow_offset_mm;
        within("shadow offset", offset_mm, "0 to 1000 mm", (0.0..=1000.0).contains(&offset_mm))?;
        let radius_mm = self.radius_mm.unwrap_or(1.0);
        within(
            "radius of the body",
            radius_mm,
            "above 0 and finite, in mm",
            radius_mm > 0.0 && radius_mm.is_finite(),
        )
    }

    /// Wrap of each channel on a material: light that enters at the terminator leaves within the angle that it spreads by.
    ///
    /// # Errors
    /// If the material has no kernel.
    pub fn wraps(&self, material: &Material, gaussians: usize) -> Result<Vec3, RenderError> {
        let Some(radius_mm) = self.radius_mm else { return Ok(Vec3::splat(self.wrap)) };
        let deviation_mm = kernel_of(material, gaussians)?.deviation_mm();
        Ok((deviation_mm / radius_mm).min(Vec3::ONE))
    }

    /// Width of the tint where channels wrap so far.
    pub fn tint_width(&self, wraps: Vec3) -> f32 {
        if self.radius_mm.is_some() { self.scatter_width * wraps.max_element() } else { self.scatter_width }
    }

    /// The function of the paper's listing: light per irradiance in rgb, the specular power in alpha, for N·L and N·H.
    pub fn light(&self, wraps: Vec3, cos_light: f32, cos_half: f32) -> Vec4 {
        let wrapped = (cos_light + wraps) / (1.0 + wraps);
        let energy = if self.energy_conserving { 1.0 / (1.0 + wraps) } else { Vec3::ONE };
        let (width, lit) = (self.tint_width(wraps), wrapped.max(Vec3::ZERO));
        let tint = wrapped.map(|c| smoothstep(0.0, width, c) * (1.0 - smoothstep(width, 2.0 * width, c)));
        // The listing takes a power of negative cosines, too; there is no light behind the surface.
        let power = if wrapped.max_element() > 0.0 { cos_half.max(0.0).powf(self.shininess) } else { 0.0 };
        ((lit + tint * self.scatter_colour) * energy).extend(power)
    }
}

/// Places above the surface that look for what hides a light, along tangent, bitangent and normal in times of the offset: over
/// half of it to all sides, and up and down, so that the shadow's edge is as soft as the light that wraps into it.
pub const PLACES_ABOVE: [Vec3; 16] = [
    Vec3::new(0.088, 0.0, 0.53),
    Vec3::new(-0.113, 0.103, 1.16),
    Vec3::new(0.017, -0.197, 0.84),
    Vec3::new(0.142, 0.186, 1.47),
    Vec3::new(-0.261, -0.046, 0.66),
    Vec3::new(0.247, -0.157, 1.28),
    Vec3::new(-0.083, 0.308, 0.97),
    Vec3::new(-0.156, -0.304, 0.59),
    Vec3::new(0.342, 0.125, 1.22),
    Vec3::new(-0.355, 0.147, 0.91),
    Vec3::new(0.172, -0.366, 1.41),
    Vec3::new(0.126, 0.405, 0.72),
    Vec3::new(-0.38, -0.223, 1.34),
    Vec3::new(0.447, -0.103, 1.03),
    Vec3::new(-0.274, 0.386, 0.78),
    Vec3::new(-0.062, -0.488, 1.09),
];

/// Below this, nothing wraps.
const LEAST_WRAP: f32 = 1e-6;

/// Light that wraps around the bodies of a scene.
pub struct Wrapped<'a> {
    lit: Lit<'a>,
    /// Of every object, in order.
    bodies: Vec<Body>,
}

struct Body {
    wraps: Vec3,
    table: Option<SkinTable>,
}

impl<'a> Wrapped<'a> {
    /// Prepares the tables.
    ///
    /// # Errors
    /// If a material has no kernel.
    pub fn new(lit: Lit<'a>) -> Result<Self, RenderError> {
        let settings = &lit.settings.techniques.wrap;
        let body = |object: &cutis_scene::Object| {
            let wraps = settings.wraps(&object.material, lit.settings.gaussians)?;
            let table = (settings.form == WrapForm::Table).then(|| SkinTable::new(settings, wraps));
            Ok(Body { wraps, table })
        };
        let bodies = lit.scene.objects.iter().map(body).collect::<Result<_, RenderError>>()?;
        Ok(Self { lit, bodies })
    }

    fn light(&self, place: &Place, cos_light: f32, cos_half: f32) -> Vec4 {
        let Body { wraps, table } = &self.bodies[place.object_number];
        match table {
            Some(table) => table.at(cos_light, cos_half),
            None => self.lit.settings.techniques.wrap.light(*wraps, cos_light, cos_half),
        }
    }

    /// Fraction of a light that is seen. Beyond the terminator the body itself would hide all of it: what hides the light
    /// from a place above counts, more and more from where the wrap begins to matter.
    fn visible(&self, place: &Place, l: usize) -> f32 {
        let (point, light) = (&place.point, &self.lit.scene.lights[l]);
        let wrap = self.bodies[place.object_number].wraps.max_element().max(LEAST_WRAP);
        let cos = point.normal.dot(light.sample(point.position_mm).dir_to_light);
        if cos >= wrap {
            return place.visible(l);
        }
        let offset_mm = self.lit.settings.techniques.wrap.shadow_offset_mm * offset_share(cos, wrap);
        let (tangent, bitangent) = point.normal.any_orthonormal_pair();
        let sees = |above: &Vec3| {
            let aside = tangent * above.x + bitangent * above.y;
            let origin = point.position_mm + (point.normal * above.z + aside) * offset_mm;
            let towards = light.sample(origin);
            !self.lit.bvh.occluded(origin, towards.dir_to_light, towards.distance_mm)
        };
        let above =
            PLACES_ABOVE.iter().filter(|above| sees(above)).count() as f32 / PLACES_ABOVE.len() as f32;
        above + (place.visible(l) - above) * (cos / wrap).max(0.0)
    }

    /// Sum over all lights of what `of_light` makes of irradiance, table and rho_dt.
    fn over_lights(&self, place: &Place, of_light: impl Fn(Vec3, Vec4, f32) -> Vec3) -> Vec3 {
        let shine = place.shine();
        let mut sum = Vec3::ZERO;
        for (l, light) in self.lit.scene.lights.iter().enumerate() {
            let towards = light.sample(place.point.position_mm);
            let half = (towards.dir_to_light + place.dir_to_eye).normalize_or(place.normal);
            let cos_light = place.normal.dot(towards.dir_to_light);
            let light = self.light(place, cos_light, place.normal.dot(half));
            if light == Vec4::ZERO {
                continue;
            }
            let wraps = self.bodies[place.object_number].wraps;
            let wrapped = ((cos_light + wraps) / (1.0 + wraps)).max_element();
            let rho_dt = place.maps.rho_dt.at(wrapped, shine.roughness, shine.rho_s);
            sum += of_light(towards.irradiance_w_per_m2 * self.visible(place, l), light, rho_dt);
        }
        sum
    }
}

/// Part of the shadow's offset at a cosine of the smooth surface: a body of radius R bulges by R cos²/2 before a place beyond
/// its terminator.
fn offset_share(cos: f32, wrap: f32) -> f32 {
    let beyond = (-cos / wrap).clamp(0.0, 1.0);
    0.1 + 0.9 * beyond * beyond
}

impl Inside for Wrapped<'_> {
    fn exitance(&self, place: &Place) -> Exitance {
        let Place { maps, point, .. } = *place;
        let material = &place.object.material;
        let from_lights =
            self.over_lights(place, |irradiance, light, rho_dt| irradiance * light.truncate() * rho_dt);
        let (rho_s, roughness) = (material.rho_s.at(point.map_uv), material.roughness.at(point.map_uv));
        let around = from_environment(self.lit.environment, &maps.ambient, &point, place.normal, place.chart);
        let light = from_lights + around * maps.rho_dt.mean(roughness, rho_s);
        let local = light * material.film_inwards(point.map_uv) * maps.kernel.total();
        Exitance { local, transmitted: Vec3::ZERO }
    }

    fn shine(&self, place: &Place) -> Option<Vec3> {
        let settings = &self.lit.settings.techniques.wrap;
        (settings.shine == WrapShine::Power).then(|| {
            let colour = settings.specular_colour / PI;
            self.over_lights(place, |irradiance, light, _| irradiance * colour * light.w)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_optics::Medium;
    use cutis_scene::Scattering;

    /// Light of a whole ball over that of a Lambertian one: the integral over all N·L is twice the mean.
    fn of_a_ball(settings: &WrapSettings) -> Vec3 {
        let n = 20_000;
        let cosines = (0..n).map(|i| 2.0 * (i as f32 + 0.5) / n as f32 - 1.0);
        let sum: Vec3 = cosines.map(|c| settings.light(Vec3::splat(settings.wrap), c, 0.0).truncate()).sum();
        4.0 * sum / n as f32
    }

    #[test]
    fn a_ball_gains_the_wrap_unless_energy_is_conserved() {
        for wrap in [0.0, 0.2, 0.5, 1.0] {
            let plain = WrapSettings { wrap, scatter_colour: Vec3::ZERO, ..WrapSettings::default() };
            // The midpoint rule over a kink at one of 20,000 steps: 1e-8; f32 sums of 20,000 terms: 1e-4.
            assert!((of_a_ball(&plain) - (1.0 + wrap)).abs().max_element() < 3e-4, "{wrap}");
            let conserving = WrapSettings { energy_conserving: true, ..plain };
            assert!((of_a_ball(&conserving) - 1.0).abs().max_element() < 3e-4, "{wrap}");
        }
    }

    #[test]
    fn the_listing_has_its_hand_computed_values() {
        let paper = WrapSettings::default();
        let at = |cos_light, cos_half| paper.light(Vec3::splat(0.2), cos_light, cos_half);
        // c = 0: c_w = 1/6, 0.5556 of the tint's width; smoothstep 3 t² - 2 t³ = 0.58299, and 1 behind it: 0.087449 of red.
        let red = 1.0 / 6.0 + 0.15 * 0.582_99;
        assert!((at(0.0, 1.0) - Vec4::new(red, 1.0 / 6.0, 1.0 / 6.0, 1.0)).abs().max_element() < 1e-5);
        // Beyond the wrap nothing is left, be the half vector where it may.
        assert_eq!(at(-0.2, 1.0), Vec4::ZERO);
        assert_eq!(at(-1.0, -1.0), Vec4::ZERO);
        // Facing the light the tint has ended: c_w = 1 > 2 · 0.3. 0.9^40 = 0.014781.
        assert!((at(1.0, 0.9) - Vec4::new(1.0, 1.0, 1.0, 0.014_781)).abs().max_element() < 1e-5);
    }

    #[test]
    fn without_wrap_and_tint_it_is_lambert() {
        let plain = WrapSettings { wrap: 0.0, scatter_width: 0.0, ..WrapSettings::default() };
        for i in -10..=10 {
            let cos = i as f32 / 10.0;
            assert_eq!(plain.light(Vec3::ZERO, cos, 0.0).truncate(), Vec3::splat(cos.max(0.0)));
        }
    }

    /// Wraps and tint come from the material where the body has a radius: nothing of either without a free path, and all that
    /// a wrap may be where the free path is endless.
    #[test]
    fn without_a_free_path_it_is_lambert_and_an_endless_one_wraps_all_around() {
        let of = |free_path_mm: f64| {
            let medium = Medium::new(0.01 / free_path_mm, 1.0 / free_path_mm, 1.4).expect("is physical");
            let material = Material { scattering: Scattering::Medium([medium; 3]), ..Material::default() };
            let settings = WrapSettings { radius_mm: Some(80.0), ..WrapSettings::default() };
            let wraps = settings.wraps(&material, 6).expect("has a kernel");
            (-100..=100).map(move |i| {
                let cos = i as f32 / 100.0;
                (cos, settings.light(wraps, cos, 0.0).truncate())
            })
        };
        for (cos, light) in of(1e-9) {
            // The wrap is a tenth of a billionth; the tint as wide, which no cosine here falls in.
            assert!((light - cos.max(0.0)).abs().max_element() < 1e-6, "{cos}: {light}");
        }
        let half = |cos: f32| (cos + 1.0) / 2.0;
        for (cos, light) in of(1e9) {
            assert!(light.y == half(cos) && light.z == half(cos) && light.x >= half(cos), "{cos}: {light}");
        }
    }

    #[test]
    fn hostile_numbers_are_named() {
        let refused = |settings: WrapSettings| settings.check().expect_err("is out of range").to_string();
        let usual = WrapSettings::default();
        assert_eq!(refused(WrapSettings { wrap: -1.0, ..usual }), "wrap must be 0 to 1, got -1");
        assert_eq!(refused(WrapSettings { wrap: f32::NAN, ..usual }), "wrap must be 0 to 1, got NaN");
        assert!(
            refused(WrapSettings { scatter_colour: Vec3::new(0.0, 2.0, 0.0), ..usual }).contains("got 2")
        );
        assert!(refused(WrapSettings { radius_mm: Some(0.0), ..usual }).contains("radius of the body"));
        assert!(usual.check().is_ok());
    }
}
