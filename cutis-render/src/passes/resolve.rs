//! The final pass: from blurred irradiance to radiance at every pixel
//! (d'Eon, Luebke & Enderton 2007, section 5.4, "Render final image").

use crate::passes::irradiance::{distance_slot, shading_normal};
use crate::passes::object_maps::ObjectMaps;
use crate::passes::specular::Shine;
use crate::passes::transmission::Transmission;
use crate::passes::visibility::faces;
use crate::prepare::FilteredEnvironment;
use crate::settings::Aov;
use cutis_scene::{Bvh, Hit, Object, Scene, SurfacePoint};
use glam::{Vec3, Vec4};
use std::f32::consts::PI;

/// What the final pass reads.
pub struct Resolve<'a> {
    /// The whole scene.
    pub scene: &'a Scene,
    /// Rays against it.
    pub bvh: &'a Bvh,
    /// The environment, if there is one.
    pub environment: Option<&'a FilteredEnvironment>,
    /// Textures and tables of each object.
    pub maps: &'a [ObjectMaps],
    /// Light that has come through each of them.
    pub transmission: &'a [Transmission],
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

/// A point on the surface, and where it lies in the textures.
struct Place<'a> {
    object: &'a Object,
    maps: &'a ObjectMaps,
    transmission: &'a Transmission,
    seams: Option<&'a Vec<Vec4>>,
    point: SurfacePoint,
    normal: Vec3,
    chart: u32,
}

impl Resolve<'_> {
    /// What a ray sees that meets nothing.
    pub fn miss(&self, dir: Vec3) -> Sample {
        Sample { radiance: self.background(dir), layers: vec![Vec4::ZERO; self.aovs.len()] }
    }

    /// The object that was hit, and what is known of it.
    pub fn object_of(&self, hit: &Hit) -> (&Object, &ObjectMaps) {
        (&self.scene.objects[hit.object as usize], &self.maps[hit.object as usize])
    }

    /// The surface that was hit.
    pub fn point(&self, hit: &Hit) -> SurfacePoint {
        self.object_of(hit).0.surface_point(hit.triangle, hit.b1, hit.b2)
    }

    fn background(&self, dir: Vec3) -> Vec4 {
        match &self.scene.environment {
            Some(environment) if environment.visible => environment.radiance(dir).extend(1.0),
            _ => self.scene.background.map_or(Vec4::ZERO, |radiance| radiance.extend(1.0)),
        }
    }

    /// What the eye sees of a point on the object and in the chart of `hit`, looking along `dir`.
    pub fn shade(&self, hit: &Hit, point: &SurfacePoint, dir: Vec3) -> Sample {
        let place = self.place(hit, point, dir);
        let parts = self.parts(&place, -dir);
        let radiance = (parts.diffuse + parts.transmission + parts.specular).extend(1.0);
        let layers = self.aovs.iter().map(|&aov| self.layer(aov, &place, &parts)).collect();
        Sample { radiance, layers }
    }

    fn place(&self, hit: &Hit, point: &SurfacePoint, dir: Vec3) -> Place<'_> {
        let (object, maps) = self.object_of(hit);
        let normal = towards_eye(shading_normal(object, point), -dir);
        let chart = object.charts.of_triangle[hit.triangle as usize];
        let transmission = &self.transmission[hit.object as usize];
        let seams = self.seams.get(hit.object as usize);
        Place { object, maps, transmission, seams, point: *point, normal, chart }
    }

    /// The sums of the paper's final pass.
    fn parts(&self, place: &Place, dir_to_eye: Vec3) -> Parts {
        let uv = place.point.uv;
        let material = &place.object.material;
        let shine = Shine {
            normal: place.normal,
            dir_to_eye,
            rho_s: material.rho_s.at(uv),
            roughness: material.roughness.at(uv),
            f0: material.f0,
        };
        let local = place.maps.diffused.weighted_sum(&place.maps.kernel.weights, uv, place.chart);
        // On the way out: the film once more, rho_dt towards the eye, and the even spread of exitance over directions.
        let film = material.film_outwards(uv);
        let cos_eye = place.normal.dot(dir_to_eye);
        let leaving = film * (place.maps.rho_dt.at(cos_eye, shine.roughness, shine.rho_s) / PI);
        let transmitted = place.transmission.at(place.maps, uv, place.chart);
        Parts {
            exitance: (local + transmitted) * film,
            diffuse: local * leaving,
            transmission: transmitted * leaving,
            specular: self.specular(place, &shine),
        }
    }

    fn specular(&self, place: &Place, shine: &Shine) -> Vec3 {
        let Place { maps, point, chart, .. } = place;
        let mut sum = Vec3::ZERO;
        for (light, visibility) in self.scene.lights.iter().zip(&maps.visibility) {
            if faces(point, light) {
                let visible = maps.atlas.charts.sample(visibility, point.uv, *chart).unwrap_or(0.0);
                sum += shine.from_light(&light.sample(point.position_mm)) * visible;
            }
        }
        if let Some(environment) = self.environment {
            let open = maps.ambient.at(point.uv, *chart, point.normal, shine.normal);
            sum += shine.from_environment(environment, &maps.rho_dt, open);
        }
        sum
    }

    fn layer(&self, aov: Aov, place: &Place, parts: &Parts) -> Vec4 {
        let (maps, uv) = (place.maps, place.point.uv);
        let read = |level: usize| {
            let level = level.min(maps.diffused.levels.len() - 1);
            maps.diffused.sample(level, 0, uv, place.chart).truncate().extend(1.0)
        };
        match aov {
            Aov::Irradiance => read(0),
            Aov::Blur(i) => read(usize::from(i) + 1),
            Aov::Stretch => maps.stretch_at(uv).extend(0.0).extend(1.0),
            Aov::Thickness => self.distances(place),
            Aov::Normal => place.normal.extend(1.0),
            Aov::Albedo => place.object.material.albedo.at(uv).extend(1.0),
            Aov::Specular => parts.specular.extend(1.0),
            Aov::Transmission => parts.transmission.extend(1.0),
            Aov::Diffuse => (parts.diffuse + parts.transmission).extend(1.0),
            Aov::Exitance => parts.exitance.extend(1.0),
            // Nothing here is left to chance.
            Aov::StandardError => Vec4::ZERO,
            Aov::Charts => Vec4::splat(place.chart as f32),
            Aov::Seams => place.seams.map_or(Vec4::ZERO, |map| map[maps.texel_at(uv)]),
            Aov::ShadowSamples => Vec4::splat(maps.tried[maps.texel_at(uv)] as f32),
            // The picture counts them.
            Aov::Samples => Vec4::ZERO,
        }
    }

    /// Distances towards the first four lights, mm.
    fn distances(&self, place: &Place) -> Vec4 {
        let mut distances = Vec4::ZERO;
        for l in 0..self.scene.lights.len().min(4) {
            let (layer, component) = distance_slot(l);
            distances[l] = place.maps.diffused.sample(0, layer, place.point.uv, place.chart)[component];
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
