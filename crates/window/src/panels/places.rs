//! Built-in places worth seeing, and the user's bookmarks.

use std::sync::Arc;

use egui::{
    Button, Context, Image, Key, Response, Role, TextEdit, TextureHandle, Ui, Vec2, WidgetInfo,
    vec2,
};

use crate::places::{Bookmark, Places};
use crate::thumbs::{loaded, thumb};
use flipmap_render::output::Picture;
use flipmap_scene::{BUILT_IN, Document};

/// The panel's unfinished input: names being typed, and the deletion to be confirmed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlaceForm {
    /// Name of the next bookmark.
    pub name: String,
    /// Name of the bookmark whose deletion is to be confirmed.
    pub deleting: Option<String>,
    /// Name of the bookmark being renamed, and its new name so far.
    pub renaming: Option<(String, String)>,
}

impl PlaceForm {
    /// Creates a form with a name for the next bookmark.
    pub(crate) fn named(name: String) -> Self {
        PlaceForm { name, ..PlaceForm::default() }
    }
}

/// An action of the user in the panel.
#[derive(Clone, Debug, PartialEq)]
pub enum PlaceAction {
    /// Changes the form to this one.
    Change(PlaceForm),
    /// Opens this document.
    Open(Box<Document>),
    /// Opens this built-in place.
    Visit(Box<Document>),
    /// Adds a bookmark of the view under this name.
    Add(String),
    /// Renames the bookmark with the first name to the second name.
    Rename(String, String),
    /// Deletes the bookmark with this name.
    Delete(String),
}

/// The pictures of places as textures of the window.
#[derive(Default)]
pub struct Thumbnails {
    textures: Vec<(Arc<Picture>, TextureHandle)>,
    built_in: Vec<(&'static str, TextureHandle)>,
}

/// Size of a picture in the list, in points.
const PICTURE: Vec2 = vec2(64.0, 48.0);

impl Thumbnails {
    fn texture(&mut self, ctx: &Context, bookmark: &Bookmark) -> &TextureHandle {
        let same = |(picture, _): &(Arc<Picture>, _)| Arc::ptr_eq(picture, &bookmark.picture);
        let place = self.textures.iter().position(same).unwrap_or_else(|| {
            let Picture { size, rgb, .. } = &*bookmark.picture;
            let texture = loaded(ctx, &bookmark.name, *size, rgb);
            self.textures.push((Arc::clone(&bookmark.picture), texture));
            self.textures.len() - 1
        });
        &self.textures[place].1
    }

    /// Returns the picture of a built-in place.
    fn built_in(&mut self, ctx: &Context, name: &'static str) -> Option<&TextureHandle> {
        let place = self.built_in.iter().position(|(other, _)| *other == name);
        let place = match place {
            Some(place) => place,
            None => {
                let (size, rgb) = thumb(name)?;
                let texture = loaded(ctx, name, size, &rgb);
                self.built_in.push((name, texture));
                self.built_in.len() - 1
            }
        };
        Some(&self.built_in[place].1)
    }

    /// Drops the pictures of deleted bookmarks.
    fn retain(&mut self, places: &Places) {
        self.textures.retain(|(picture, _)| {
            places.bookmarks().iter().any(|other| Arc::ptr_eq(&other.picture, picture))
        });
    }
}

/// Shows the built-in places and the bookmarks; returns the user's actions.
pub fn places_panel(
    ui: &mut Ui,
    places: &Places,
    form: &PlaceForm,
    thumbnails: &mut Thumbnails,
) -> Vec<PlaceAction> {
    let (mut new, mut actions) = (form.clone(), Vec::new());
    ui.heading("Your places");
    keep(ui, &mut new, &mut actions);
    thumbnails.retain(places);
    for bookmark in places.bookmarks() {
        ui.push_id(&bookmark.name, |ui| {
            let texture = thumbnails.texture(ui.ctx(), bookmark).clone();
            row(ui, bookmark, &texture, &mut new, &mut actions);
        });
    }
    ui.separator();
    ui.heading("Worth seeing");
    for scene in BUILT_IN {
        ui.horizontal(|ui| {
            if let Some(texture) = thumbnails.built_in(ui.ctx(), scene.name) {
                let image = Image::new(texture).fit_to_exact_size(PICTURE);
                ui.add(image.alt_text(format!("Picture of {}", scene.name)));
            }
            ui.vertical(|ui| {
                if named(ui, scene.name, &format!("Open {}", scene.name)) {
                    actions.push(PlaceAction::Visit(Box::new(scene.document())));
                }
                ui.label(scene.sentence());
            });
        });
        ui.add_space(4.0);
    }
    if new != *form {
        actions.push(PlaceAction::Change(new));
    }
    actions
}

/// Shows the field and the button that bookmark the view.
fn keep(ui: &mut Ui, form: &mut PlaceForm, actions: &mut Vec<PlaceAction>) {
    ui.horizontal(|ui| {
        let label = ui.label("Name");
        let field = TextEdit::singleline(&mut form.name).desired_width(140.0);
        let field = ui.add(field).labelled_by(label.id);
        let entered = entered(ui, &field);
        let ready = !form.name.trim().is_empty();
        let pressed = ui.add_enabled(ready, Button::new("Keep this view")).clicked();
        if ready && (pressed || entered) {
            actions.push(PlaceAction::Add(form.name.trim().to_string()));
            form.name.clear();
        }
    });
}

fn row(
    ui: &mut Ui,
    bookmark: &Bookmark,
    texture: &TextureHandle,
    form: &mut PlaceForm,
    actions: &mut Vec<PlaceAction>,
) {
    let name = &bookmark.name;
    ui.horizontal(|ui| {
        let image = Image::new(texture).fit_to_exact_size(PICTURE);
        ui.add(image.alt_text(format!("Picture of {name}")));
        ui.vertical(|ui| {
            if named(ui, name, &format!("Open {name}")) {
                actions.push(PlaceAction::Open(Box::new(bookmark.picture.document.clone())));
            }
            ui.horizontal(|ui| change(ui, name, form, actions));
        });
    });
}

/// Shows the buttons to rename and to delete a bookmark; a deletion asks for confirmation.
fn change(ui: &mut Ui, name: &str, form: &mut PlaceForm, actions: &mut Vec<PlaceAction>) {
    if form.deleting.as_deref() == Some(name) {
        if named(ui, "Delete for good", &format!("Delete {name} for good")) {
            actions.push(PlaceAction::Delete(name.to_string()));
            form.deleting = None;
        }
        if named(ui, "Keep", &format!("Keep {name}")) {
            form.deleting = None;
        }
        return;
    }
    if let Some((_, new)) = form.renaming.as_mut().filter(|(old, _)| old == name) {
        let field = ui.add(TextEdit::singleline(new).desired_width(90.0));
        field.widget_info(|| {
            let mut info = WidgetInfo::text_edit(true, "", &*new, "");
            info.label = Some(format!("New name of {name}"));
            info
        });
        let (new, entered) = (new.trim().to_string(), entered(ui, &field));
        if named(ui, "Rename", &format!("Rename {name} to this")) || entered {
            actions.push(PlaceAction::Rename(name.to_string(), new));
            form.renaming = None;
        }
        return;
    }
    if named(ui, "Rename…", &format!("Rename {name}…")) {
        form.renaming = Some((name.to_string(), name.to_string()));
    }
    if named(ui, "Delete…", &format!("Delete {name}…")) {
        form.deleting = Some(name.to_string());
    }
}

/// Returns true if the Enter key has just ended the input to a field.
fn entered(ui: &Ui, field: &Response) -> bool {
    field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
}

/// Shows a button whose accessible name says more than its text; returns true if it was clicked.
fn named(ui: &mut Ui, text: &str, name: &str) -> bool {
    let response = ui.button(text);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    response.clicked()
}
