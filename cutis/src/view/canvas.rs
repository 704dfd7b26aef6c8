//! The picture in the window: drags, the value under the pointer, two sides with a line between, tiles of all maps.

use super::app::Viewer;
use super::mouse::{Movement, movement};
use super::screen::range;
use super::shown::{View, is_scaled, unit};
use super::side::{Side, Tile, value_of};
use cutis_render::Aov;
use eframe::egui::{
    Align2, Color32, CursorIcon, FontId, Grid, Image, Painter, Pos2, Rect, Response, ScrollArea, Sense,
    Stroke, TextureHandle, Ui, Vec2, load::SizedTexture, pos2, vec2,
};

/// Largest side of a picture, pixels.
const MAX_PIXELS: usize = 4096;
/// Width of a tile, points.
const TILE: f32 = 205.0;
/// How close to the line between two sides the pointer takes hold of it, points.
const GRIP: f32 = 8.0;
/// Distance of words from the edge, points.
const MARGIN: f32 = 8.0;

/// Shows it. Gives the size that a picture should have, pixels.
pub fn show(viewer: &mut Viewer, ui: &mut Ui) -> [u32; 2] {
    let rect = ui.available_rect_before_wrap();
    let pixels = rect.size() * ui.ctx().pixels_per_point();
    // Both sides by the same factor: the picture keeps its shape.
    let most = ui.input(|input| input.max_texture_side.min(MAX_PIXELS)) as f32;
    let shrunk = pixels * (most / pixels.max_elem().max(1.0)).min(1.0);
    let room = [shrunk.x, shrunk.y].map(|side| (side as u32).max(1));
    let size = viewer.size.unwrap_or(room);
    match viewer.shown.view {
        View::Maps => maps(viewer, ui),
        View::Map(aov) => map(viewer, ui, aov),
        View::Picture | View::Layer(_) => picture(viewer, ui, rect, size),
    }
    tell_failure(viewer, &ui.painter_at(rect), rect);
    size
}

/// As large as a picture of this shape fits in, in the middle.
fn fitted(room: Rect, size: [u32; 2]) -> Rect {
    let size = vec2(size[0] as f32, size[1] as f32);
    let fits = size * (room.size() / size).min_elem();
    Rect::from_center_size(room.center(), fits)
}

fn picture(viewer: &mut Viewer, ui: &mut Ui, room: Rect, size: [u32; 2]) {
    ui.painter_at(room).rect_filled(room, 0.0, Color32::BLACK);
    let rect = if viewer.size.is_some() { fitted(room, size) } else { room };
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    let on_line = drag_line(viewer, ui, &response);
    if !on_line && let Some(movement) = movement(ui, &response) {
        move_by(viewer, movement);
    }
    let painter = ui.painter_at(rect);
    let line = viewer.split.map_or(1.0, |share| share.clamp(0.0, 1.0));
    part(&painter, viewer.sides[0].texture.as_ref(), rect, [0.0, line]);
    if viewer.split.is_some() {
        part(&painter, viewer.sides[1].texture.as_ref(), rect, [line, 1.0]);
        let x = rect.left() + line * rect.width();
        painter.vline(x, rect.y_range(), Stroke::new(1.5, Color32::WHITE));
        words(&painter, pos2(rect.left() + MARGIN, rect.top() + MARGIN), Align2::LEFT_TOP, "A");
        words(&painter, pos2(rect.right() - MARGIN, rect.top() + MARGIN), Align2::RIGHT_TOP, "B");
    }
    tell_value(viewer, &response, &painter, line);
    tell_range(viewer, &painter, rect);
}

fn move_by(viewer: &mut Viewer, movement: Movement) {
    let light = viewer.light;
    // Both sides look from one place; lights are those of the side that is changed.
    let side = if matches!(movement, Movement::Light(_)) { viewer.edited } else { 0 };
    movement.apply(&mut viewer.looks[side], light);
}

/// Lets the line between two sides be dragged. Tells whether the pointer is about that.
fn drag_line(viewer: &mut Viewer, ui: &Ui, response: &Response) -> bool {
    let Some(share) = viewer.split else { return false };
    let rect = response.rect;
    let from = ui.input(|input| input.pointer.press_origin()).or(response.hover_pos());
    let x = rect.left() + share * rect.width();
    let id = response.id.with("line");
    let is_close = from.is_some_and(|p| (p.x - x).abs() < GRIP);
    if is_close {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    if response.drag_started() {
        ui.data_mut(|data| data.insert_temp(id, is_close));
    }
    let is_held = response.dragged() && ui.data(|data| data.get_temp(id).unwrap_or(false));
    if is_held && let Some(p) = response.interact_pointer_pos() {
        viewer.split = Some(((p.x - rect.left()) / rect.width().max(1.0)).clamp(0.0, 1.0));
    }
    is_held
}

/// A part of a picture, from one share of the width to another.
fn part(painter: &Painter, texture: Option<&TextureHandle>, rect: Rect, [from, to]: [f32; 2]) {
    let Some(texture) = texture else { return };
    let x = |share: f32| rect.left() + share * rect.width();
    let place = Rect::from_x_y_ranges(x(from)..=x(to), rect.y_range());
    let uv = Rect::from_min_max(pos2(from, 0.0), pos2(to, 1.0));
    painter.image(texture.id(), place, uv, Color32::WHITE);
}

fn tell_value(viewer: &Viewer, response: &Response, painter: &Painter, line: f32) {
    let Some(pointer) = response.hover_pos() else { return };
    let place = (pointer - response.rect.min) / response.rect.size();
    let side = usize::from(viewer.split.is_some() && place.x >= line);
    if let Some(value) = viewer.sides[side].value([place.x, place.y]) {
        words(painter, response.rect.left_bottom() + vec2(MARGIN, -MARGIN), Align2::LEFT_BOTTOM, &value);
    }
}

/// What the colours of a layer stand for.
fn tell_range(viewer: &Viewer, painter: &Painter, rect: Rect) {
    let View::Layer(aov) = viewer.shown.view else { return };
    let layer = viewer.sides[0].painted.as_ref().and_then(|p| p.frame.layers.first());
    let what = match layer {
        Some(layer) if is_scaled(aov) => {
            let [low, high] = range(layer);
            format!("{aov}: dark {low:.3}, bright {high:.3} {}", unit(aov))
        }
        Some(_) => format!("{aov} {}", unit(aov)),
        None => format!("{aov}: this technique has no such layer"),
    };
    words(painter, pos2(rect.center().x, rect.top() + MARGIN), Align2::CENTER_TOP, what.trim_end());
}

fn tell_failure(viewer: &Viewer, painter: &Painter, rect: Rect) {
    let mut place = rect.center();
    let sides = 0..viewer.side_count();
    for reason in sides.clone().filter_map(|side| viewer.failure(side)) {
        words(painter, place, Align2::CENTER_CENTER, reason);
        place.y += 3.0 * MARGIN;
    }
    let nothing = |side: usize| viewer.sides[side].texture.is_none() && viewer.failure(side).is_none();
    if sides.clone().all(nothing) {
        words(painter, place, Align2::CENTER_CENTER, "the first picture is being drawn …");
    }
}

/// Words on a dark ground.
fn words(painter: &Painter, place: Pos2, align: Align2, text: &str) {
    let width = (painter.clip_rect().width() - 2.0 * MARGIN).max(1.0);
    let galley = painter.layout(text.to_owned(), FontId::proportional(14.0), Color32::WHITE, width);
    let rect = align.anchor_size(place, galley.size());
    painter.rect_filled(rect.expand(3.0), 3.0, Color32::from_black_alpha(170));
    painter.galley(rect.min, galley, Color32::WHITE);
}

/// Textures of all passes at once; a click shows one in full.
fn maps(viewer: &mut Viewer, ui: &mut Ui) {
    let side = &viewer.sides[viewer.edited];
    if side.maps.is_empty() {
        let is_final = side.painted.as_ref().is_some_and(|painted| painted.is_final);
        let words = if is_final { "this technique has no maps" } else { "the maps are being drawn …" };
        ui.centered_and_justified(|ui| ui.label(words));
        return;
    }
    let columns = ((ui.available_width() / (TILE + MARGIN)) as usize).max(1);
    let mut chosen = None;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        Grid::new("maps").num_columns(columns).spacing([MARGIN, MARGIN]).show(ui, |ui| {
            for (i, tile) in side.maps.iter().enumerate() {
                if ui.vertical(|ui| tile_of(ui, side, tile)).inner {
                    chosen = Some(View::Map(tile.aov));
                }
                if (i + 1) % columns == 0 {
                    ui.end_row();
                }
            }
        });
    });
    if let Some(view) = chosen {
        viewer.shown.view = view;
    }
}

/// A texture with its name, and the value under the pointer. Tells whether it was clicked.
fn tile_of(ui: &mut Ui, side: &Side, tile: &Tile) -> bool {
    let name = match unit(tile.aov) {
        "" => tile.aov.to_string(),
        unit => format!("{} [{unit}]", tile.aov),
    };
    let image = Image::new(SizedTexture::new(tile.texture.id(), Vec2::splat(TILE)));
    let response = ui.add(image.sense(Sense::click()).alt_text(name.clone()));
    ui.label(name);
    if let Some(pointer) = response.hover_pos() {
        let place = (pointer - response.rect.min) / response.rect.size();
        let layer = side.painted.as_ref().and_then(|p| p.maps.get(tile.index));
        let value = layer.and_then(|layer| value_of(layer, [place.x, place.y]));
        response.clone().on_hover_text(value.unwrap_or_default());
    }
    response.clicked()
}

/// One of those textures in full; a click goes back.
fn map(viewer: &mut Viewer, ui: &mut Ui, aov: Aov) {
    let film = viewer.looks[viewer.edited].film;
    let side = &mut viewer.sides[viewer.edited];
    let rect = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(rect, Sense::click());
    let painter = ui.painter_at(rect);
    let square = Rect::from_center_size(rect.center(), Vec2::splat(rect.width().min(rect.height())));
    part(&painter, side.full_map(ui.ctx(), aov, &film).as_ref(), square, [0.0, 1.0]);
    let place = response.hover_pos().map(|p| (p - square.min) / square.size());
    let value = place.and_then(|p| value_of(side.map(aov)?, [p.x, p.y]));
    let value = value.unwrap_or_else(|| format!("{aov} {}", unit(aov)));
    words(&painter, rect.left_bottom() + vec2(MARGIN, -MARGIN), Align2::LEFT_BOTTOM, &value);
    if response.clicked() {
        viewer.shown.view = View::Maps;
    }
}
