//! The final pass: from blurred irradiance to radiance at every pixel
//! (d'Eon, Luebke & Enderton 2007, section 5.4, "Render final image").

use crate::lit_scene::Lit;
use crate::passes::irradiance::{distance_slot, shading_normal};
use crate::passes::object_maps::ObjectMaps;
use crate::passes::specular::Shine;
use crate::passes::visibility::faces;
use crate::settings::Aov;
use crate::technique::{Exitance, Inside};
use cutis_scene::{Hit, Object, SurfacePoint};
use glam::{Vec3, Vec4};
use std::f32::consts::PI;

/// What the final pass reads.
pub struct Resolve<'a> {
    /// The scene and its light.
    pub lit: Lit<'a>,
    /// What the technique knows of the light inside the bodies.
    pub inside: &'a dyn Inside,
    /// Seams of each of them, where that layer is wanted.
    pub seams: &'a [Vec<Vec4>],
    /// Layers wanted beside the radiance.
    pub aovs: &'a [Aov],
}

/// Radiance and layers of one sample of a pixel.
#[derive(Debug, Clone)]
pub struct Sample {
    /// Radiance in rgb, coverage in alpha.
    pub radiance: Vec4,
    /// One value per wanted layer.
    pub layers: Vec<Vec4>,
}

/// The parts that make up the radiance at a point.
struct Parts {
    /// Before any eye looks, W/m².
    exitance: Vec3,
    diffuse: Vec3,
    transmission: Vec3,
    specular: Vec3,
}

/// A point on the surface that is looked at, and where it lies in the textures.
#[derive(Clone, Copy)]
pub struct Place<'a> {
    /// The object.
    pub object: &'a Object,
    /// Its number.
    pub object_number: usize,
    /// Its textures and tables.
    pub maps: &'a ObjectMaps,
    /// The point, with the smooth surface's normal.
    pub point: SurfacePoint,
    /// The normal with the material's relief, turned towards the eye.
    pub normal: Vec3,
    /// Unit vector to the eye.
    pub dir_to_eye: Vec3,
    /// The chart.
    pub chart: u32,
    /// The pixel that is drawn if it is drawn by this place alone; else which of the picture's samples, counted over the whole
    /// picture.
    pub sample: [u32; 2],
    /// Whether the pixel is drawn by this place alone.
    pub is_whole_pixel: bool,
}

/// What of the picture is drawn.
#[derive(Debug, Clone, Copy)]
pub struct PixelPart {
    /// The pixel, or one of the samples of all pixels.
    pub sample: [u32; 2],
    /// Whether it is a pixel.
    pub is_whole: bool,
}

impl Place<'_> {
    /// The surface's shine here.
    pub fn shine(&self) -> Shine {
        let (material, map_uv) = (&self.object.material, self.point.map_uv);
        Shine {
            normal: self.normal,
            dir_to_eye: self.dir_to_eye,
            rho_s: material.rho_s.at(map_uv),
            roughness: material.roughness.at(map_uv),
            f0: material.f0,
        }
    }

    /// Fraction of light number `l` that is seen from here.
    pub fn visible(&self, l: usize) -> f32 {
        self.maps
            .atlas
            .charts
            .sample(&self.maps.visibility[l], self.point.atlas_uv, self.chart)
            .unwrap_or(0.0)
    }
}

impl Resolve<'_> {
    /// What a ray sees that meets nothing.
    pub fn miss(&self, dir: Vec3) -> Sample {
        Sample { radiance: self.background(dir), layers: vec![Vec4::ZERO; self.aovs.len()] }
    }

    /// The object that was hit, and what is known of it.
    pub fn object_of(&self, hit: &Hit) -> (&Object, &ObjectMaps) {
        (&self.lit.scene.objects[hit.object as usize], &self.lit.maps[hit.object as usize])
    }

    /// The surface that was hit.
    pub fn point(&self, hit: &Hit) -> SurfacePoint {
        self.object_of(hit).0.surface_point(hit.triangle, hit.b1, hit.b2)
    }

    fn background(&self, dir: Vec3) -> Vec4 {
        match &self.lit.scene.environment {
            Some(environment) if environment.visible => environment.radiance(dir).extend(1.0),
            _ => self.lit.scene.background.map_or(Vec4::ZERO, |radiance| radiance.extend(1.0)),
        }
    }

    /// What the eye sees of a point on the object and in the chart of `hit`, looking along `dir`.
    pub fn shade(&self, hit: &Hit, point: &SurfacePoint, dir: Vec3, part: PixelPart) -> Sample {
        let place = self.place(hit, point, dir, part);
        let parts = self.parts(&place);
        let radiance = (parts.diffuse + parts.transmission + parts.specular).extend(1.0);
        let layers = self.aovs.iter().map(|&aov| self.layer(aov, &place, &parts)).collect();
        Sample { radiance, layers }
    }

    fn place(&self, hit: &Hit, point: &SurfacePoint, dir: Vec3, part: PixelPart) -> Place<'_> {
        let (object, maps) = self.object_of(hit);
        Place {
            object,
            object_number: hit.object as usize,
            maps,
            point: *point,
            normal: towards_eye(shading_normal(object, point), -dir),
            dir_to_eye: -dir,
            chart: object.charts.of_triangle[hit.triangle as usize],
            sample: part.sample,
            is_whole_pixel: part.is_whole,
        }
    }

    /// The sums of the paper's final pass.
    fn parts(&self, place: &Place) -> Parts {
        let shine = place.shine();
        let Exitance { local, transmitted } = self.inside.exitance(place);
        // On the way out: the film once more, rho_dt towards the eye, and the even spread of exitance over directions.
        let film = place.object.material.film_outwards(place.point.map_uv);
        let cos_eye = place.normal.dot(place.dir_to_eye);
        let leaving = film * (place.maps.rho_dt.at(cos_eye, shine.roughness, shine.rho_s) / PI);
        Parts {
            exitance: (local + transmitted) * film,
            diffuse: local * leaving,
            transmission: transmitted * leaving,
            specular: self.specular(place, &shine),
        }
    }

    fn specular(&self, place: &Place, shine: &Shine) -> Vec3 {
        let Place { maps, point, chart, .. } = place;
        let mut sum = self.inside.shine(place).unwrap_or_else(|| self.shine_of_lights(place, shine));
        if let Some(environment) = self.lit.environment {
            let open = maps.ambient.at(point.atlas_uv, *chart, point.normal, shine.normal);
            sum += shine.from_environment(environment, &maps.rho_dt, open);
        }
        sum
    }

    fn shine_of_lights(&self, place: &Place, shine: &Shine) -> Vec3 {
        let lights = self.lit.scene.lights.iter().enumerate();
        let facing = lights.filter(|(_, light)| faces(&place.point, light));
        facing
            .map(|(l, light)| shine.from_light(&light.sample(place.point.position_mm)) * place.visible(l))
            .sum()
    }

    fn layer(&self, aov: Aov, place: &Place, parts: &Parts) -> Vec4 {
        let (maps, uv) = (place.maps, place.point.atlas_uv);
        let read = |level: usize| {
            let level = level.min(maps.diffused.levels.len() - 1);
            maps.diffused.sample(level, 0, uv, place.chart).truncate().extend(1.0)
        };
        match aov {
            Aov::Irradiance => read(0),
            Aov::Blur(i) => read(usize::from(i) + 1),
            Aov::Stretch => maps.stretch_at(uv).extend(0.0).extend(1.0),
            Aov::Thickness => self.inside.distances_mm(place).unwrap_or_else(|| self.distances(place)),
            Aov::Normal => place.normal.extend(1.0),
            Aov::Albedo => place.object.material.albedo.at(place.point.map_uv).extend(1.0),
            Aov::Specular => parts.specular.extend(1.0),
            Aov::Transmission => parts.transmission.extend(1.0),
            Aov::Diffuse => (parts.diffuse + parts.transmission).extend(1.0),
            Aov::Exitance => parts.exitance.extend(1.0),
            // Nothing here is left to chance.
            Aov::StandardError => Vec4::ZERO,
            Aov::Charts => Vec4::splat(place.chart as f32),
            Aov::Seams => {
                self.seams.get(place.object_number).map_or(Vec4::ZERO, |map| map[maps.texel_at(uv)])
            }
            Aov::ShadowSamples => Vec4::splat(maps.tried[maps.texel_at(uv)] as f32),
            // The picture counts them.
            Aov::Samples => Vec4::ZERO,
        }
    }

    /// Distances towards the first four lights, mm.
    fn distances(&self, place: &Place) -> Vec4 {
        let mut distances = Vec4::ZERO;
        for l in 0..self.lit.scene.lights.len().min(4) {
            let (layer, component) = distance_slot(l);
            distances[l] = place.maps.diffused.sample(0, layer, place.point.atlas_uv, place.chart)[component];
        }
        distances
    }
}

/// Relief may tip a normal away from the eye at the silhouette; tip it back until it is seen edge-on.
fn towards_eye(normal: Vec3, dir_to_eye: Vec3) -> Vec3 {
    let cos = normal.dot(dir_to_eye);
    // A hair above 0 keeps the half vector and rho_dt defined.
    if cos >= 1e-3 { normal } else { (normal + dir_to_eye * (1e-3 - cos)).normalize_or(dir_to_eye) }
}
