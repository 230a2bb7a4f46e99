//! The gradient strip: the palette with its stops, which are dragged along it, under a histogram of
//! the view's times.

use egui::{
    EventFilter, Id, Key, Modifiers, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui,
    WidgetInfo, pos2, vec2,
};

use super::colour_strip::{paint_strip, rgb};
use flipmap_scene::PictureTable;
use flipmap_scene::palette::Palette;
use flipmap_scene::palette::gradient::{STOPS, Stop, colour_at, even, list_text, parse_list};

/// Number of colours that a copy of a palette begins with.
const COPIED: u32 = 7;
/// Largest number of stops that are edited one by one.
const MAX_EDITED_STOPS: usize = 32;
/// Number of bars of the histogram.
pub(super) const BARS: usize = 96;
/// Heights in points of the histogram, the colours and the handles.
const BARS_HEIGHT: f32 = 36.0;
const COLOURS_HEIGHT: f32 = 20.0;
const HANDLES_HEIGHT: f32 = 16.0;
/// Share of the palette by which an arrow key moves a stop.
const KEY_STEP: f64 = 0.01;
/// Points of the wheel for a shift through the whole palette.
const WHEEL_POINTS: f32 = 1500.0;

/// Shows the palette of a picture under the histogram of its use, and changes it as the user drags,
/// adds, paints or removes stops. The wheel shifts the palette.
pub(super) fn gradient_strip(ui: &mut Ui, picture: &mut PictureTable, bars: &[f32]) {
    let Ok(palette) = Palette::named(&picture.palette) else { return };
    let listed = parse_list(&picture.palette).ok().filter(|stops| stops.len() <= MAX_EDITED_STOPS);
    let width = ui.available_width();
    let handles_height = if listed.is_some() { HANDLES_HEIGHT } else { 2.0 };
    let height = BARS_HEIGHT + COLOURS_HEIGHT + handles_height;
    let (rect, _) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
    // The outermost handles lie within the panel.
    let along = rect.shrink2(vec2(6.0, 0.0));
    let colours = Rect::from_min_size(
        along.left_top() + vec2(0.0, BARS_HEIGHT),
        vec2(along.width(), COLOURS_HEIGHT),
    );
    histogram(ui, along, bars);
    let strip = paint_colours(ui, colours, &palette);
    shift(ui, &strip, picture);
    let clicked = strip.interact_pointer_pos().filter(|_| strip.clicked());
    let place = clicked.map(|at| share_along(colours, at));
    if let Some(mut stops) = listed {
        let handles =
            Rect::from_min_max(colours.left_bottom(), rect.right_bottom() - vec2(6.0, 0.0));
        if stops_changed(ui, handles, &mut stops, place) {
            picture.palette = list_text(&stops);
        }
        return;
    }
    let copy = ui.button("Edit a copy of the palette");
    let copy = copy.on_hover_text("Its colours become a gradient of your own");
    if copy.clicked() || place.is_some() {
        let mut stops = copied(&palette);
        if let Some(place) = place {
            add(ui, &mut stops, place);
        }
        picture.palette = list_text(&stops);
    }
}

/// Shows the handles of the stops and the chosen one's colour; adds a stop at a `place` that was
/// clicked. Returns true if the stops have changed.
fn stops_changed(ui: &mut Ui, handles: Rect, stops: &mut Vec<Stop>, place: Option<f64>) -> bool {
    let mut chosen = chosen(ui).min(stops.len() - 1);
    let (mut changed, mut removed) = (false, None);
    for number in 0..stops.len() {
        let response = handle(ui, handles, stops, number, number == chosen);
        if response.clicked() || response.dragged() || response.has_focus() {
            chosen = number;
        }
        changed |= moved(ui, &response, handles, stops, number);
        let deletes = || ui.input(|input| input.key_pressed(Key::Delete));
        if response.has_focus() && stops.len() > *STOPS.start() && deletes() {
            removed = Some(number);
        }
    }
    if let Some(number) = removed {
        stops.remove(number);
        chosen = chosen.min(stops.len() - 1);
        changed = true;
    }
    choose(ui, chosen);
    match place.filter(|_| stops.len() < MAX_EDITED_STOPS) {
        Some(place) => {
            add(ui, stops, place);
            true
        }
        None => edited(ui, stops, chosen) || changed,
    }
}

/// Shows how often each part of the palette is used.
fn histogram(ui: &Ui, along: Rect, bars: &[f32]) {
    let width = along.width() / bars.len().max(1) as f32;
    let floor = along.top() + BARS_HEIGHT;
    for (bar, share) in bars.iter().enumerate() {
        let left = along.left() + width * bar as f32;
        let top = floor - share * (BARS_HEIGHT - 2.0);
        let rect = Rect::from_min_max(pos2(left, top), pos2(left + width, floor));
        ui.painter().rect_filled(rect, 0.0, ui.visuals().weak_text_color());
    }
}

fn paint_colours(ui: &Ui, rect: Rect, palette: &Palette) -> Response {
    paint_strip(ui, rect, |share| palette.colour(share));
    let response = ui.interact(rect, ui.scope_id().with("gradient"), Sense::click());
    let told = "Gradient: a click adds a stop, the wheel shifts it";
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, told));
    response.on_hover_text(told)
}

/// Shifts the palette by the wheel over it.
fn shift(ui: &Ui, strip: &Response, picture: &mut PictureTable) {
    if !strip.hovered() {
        return;
    }
    let wheel = ui.input_mut(|input| std::mem::take(&mut input.smooth_scroll_delta));
    let turned = f64::from((wheel.x + wheel.y) / WHEEL_POINTS);
    if turned != 0.0 {
        // Six decimals: a round shift stays round in the file.
        picture.offset = ((picture.offset + turned).rem_euclid(1.0) * 1e6).round() / 1e6;
    }
}

/// Shows the handle of a stop under its colour.
fn handle(ui: &Ui, rect: Rect, stops: &[Stop], number: usize, chosen: bool) -> Response {
    let Stop { place, colour } = stops[number];
    let tip = pos2(rect.left() + rect.width() * place as f32, rect.top());
    let size = vec2(12.0, rect.height());
    let area = Rect::from_min_size(tip - vec2(6.0, 0.0), size);
    let response = ui.interact(area, handle_id(ui, number), Sense::click_and_drag());
    let name = format!("Stop {} of {} at {:.1} %", number + 1, stops.len(), 100.0 * place);
    response.widget_info(|| WidgetInfo::labeled(Role::Slider, true, &name));
    let visuals = ui.style().interact(&response);
    let rim = if chosen { ui.visuals().selection.stroke } else { visuals.fg_stroke };
    let points = [[0.0, 0.0], [5.0, 5.0], [5.0, 14.0], [-5.0, 14.0], [-5.0, 5.0]];
    let points: Vec<Pos2> = points.map(|[x, y]| tip + vec2(x, y)).into();
    let width = if chosen { 2.0 } else { 1.0 };
    ui.painter().add(Shape::convex_polygon(points, rgb(colour), Stroke::new(width, rim.color)));
    response.on_hover_text(name)
}

fn handle_id(ui: &Ui, number: usize) -> Id {
    ui.scope_id().with(("stop", number))
}

/// Moves a stop as it is dragged or as the arrow keys say, between its neighbours. Returns true if
/// it has moved.
fn moved(ui: &Ui, handle: &Response, rect: Rect, stops: &mut [Stop], number: usize) -> bool {
    let mut place = stops[number].place;
    if let Some(at) = handle.interact_pointer_pos().filter(|_| handle.dragged()) {
        place = share_along(rect, at);
    }
    if handle.has_focus() {
        let arrows = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(handle.id, arrows));
        let steps = ui.input_mut(|input| {
            let mut count = |key| input.count_and_consume_key(Modifiers::NONE, key) as f64;
            count(Key::ArrowRight) - count(Key::ArrowLeft)
        });
        place += steps * KEY_STEP;
    }
    set_place(stops, number, place)
}

/// Puts a stop at a place between its neighbours; returns true if it has moved.
fn set_place(stops: &mut [Stop], number: usize, place: f64) -> bool {
    let least = number.checked_sub(1).map_or(0.0, |before| stops[before].place);
    let most = stops.get(number + 1).map_or(1.0, |next| next.place);
    let new = ((1000.0 * place).round() / 1000.0).clamp(least, most);
    let changed = place != stops[number].place && new != stops[number].place;
    if changed {
        stops[number].place = new;
    }
    changed
}

/// Shows the colour and the place of the chosen stop, and the button that removes it; returns true
/// if one of them has changed.
fn edited(ui: &mut Ui, stops: &mut Vec<Stop>, number: usize) -> bool {
    let before = stops.clone();
    ui.horizontal(|ui| {
        let name = format!("Stop {}", number + 1);
        let label = ui.label(&name);
        ui.color_edit_button_srgb(&mut stops[number].colour).labelled_by(label.id);
        let mut percent = 100.0 * stops[number].place;
        let field = egui::DragValue::new(&mut percent).suffix(" %").speed(0.2).max_decimals(1);
        let at = ui.label("at");
        if ui.add(field.range(0.0..=100.0)).labelled_by(at.id).changed() {
            set_place(stops, number, percent / 100.0);
        }
        let can_add = stops.len() < MAX_EDITED_STOPS;
        if ui.add_enabled(can_add, egui::Button::new("Add")).clicked() {
            let (from, to) = match stops.get(number + 1) {
                Some(next) => (stops[number].place, next.place),
                None => (stops[number - 1].place, stops[number].place),
            };
            add(ui, stops, 0.5 * (from + to));
        }
        let can_remove = stops.len() > *STOPS.start();
        if ui.add_enabled(can_remove, egui::Button::new("Remove")).clicked() {
            stops.remove(number);
        }
    });
    *stops != before
}

/// Adds a stop in the colour that the gradient has there, and chooses it.
fn add(ui: &Ui, stops: &mut Vec<Stop>, place: f64) {
    let place = (1000.0 * place).round() / 1000.0;
    let number = stops.partition_point(|stop| stop.place <= place);
    stops.insert(number, Stop { place, colour: colour_at(stops, place) });
    choose(ui, number);
}

/// Returns the number of the stop chosen last.
fn chosen(ui: &Ui) -> usize {
    ui.data(|data| data.get_temp(ui.scope_id().with("chosen"))).unwrap_or(0)
}

fn choose(ui: &Ui, number: usize) {
    ui.data_mut(|data| data.insert_temp(ui.scope_id().with("chosen"), number));
}

/// Returns the share of the strip at a point, from 0 to 1.
fn share_along(strip: Rect, at: Pos2) -> f64 {
    f64::from(((at.x - strip.left()) / strip.width()).clamp(0.0, 1.0))
}

/// Returns evenly spaced colours of a palette as stops.
fn copied(palette: &Palette) -> Vec<Stop> {
    let colour = |k: u32| palette.colour(f64::from(k) / f64::from(COPIED - 1));
    even(&(0..COPIED).map(colour).collect::<Vec<_>>())
}
