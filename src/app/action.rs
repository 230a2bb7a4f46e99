//! Everything that a person can do.

use std::path::PathBuf;

use glam::DVec2;

use super::camera::Camera;
use super::pins::PinAction;
use super::settings::{Layers, Theme};
use super::state::Dialog;
use crate::engine::Accuracy;
use crate::engine::choice::EngineKind;
use crate::lab::Figure;
use crate::physics::Theta;
use crate::scene::{Build, Document, FlipQuestion, PictureTable};

/// Moving about. Points are from the canvas' middle, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// The map follows the pointer by so many points.
    Drag(DVec2),
    /// The pointer lets go.
    Release,
    /// Larger by a factor about a point.
    Zoom {
        /// Above 1: closer.
        factor: f64,
        /// What stays in place.
        about: DVec2,
    },
    /// So that the rectangle between two points fills the canvas.
    Box([DVec2; 2]),
    /// By a share of the canvas.
    Step(DVec2),
    /// The whole torus.
    Home,
    /// To the view before.
    Back,
    /// To the view that was left by going back.
    Forward,
    /// Somewhere else.
    To(Camera),
}

impl Action {
    /// Whether it needs the map to be seen.
    pub fn is_of_map(&self) -> bool {
        matches!(self, Action::Look(_) | Action::Pin(_) | Action::GoDeeper | Action::Layers(_))
    }
}

/// Something to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Move about.
    Look(Look),
    /// The pointer is over this point of the map, or over none.
    Hover(Option<DVec2>),
    /// A rectangle is being drawn between two points, or no more.
    Drawing(Option<[DVec2; 2]>),
    /// Go deeper by itself from the pointer's place, or stop.
    GoDeeper,
    /// Show a figure of the laboratory, or the map again.
    Lab(Option<Figure>),
    /// Open a start in a figure.
    OpenInLab(Figure, [Theta; 2]),
    /// Show a start that was aimed in the laboratory on the map.
    FromLab([Theta; 2]),
    /// Pin the pixel at a point.
    Pin(DVec2),
    /// Take back the pin that the first click of a double click made.
    Unpin,
    /// Something about a pin.
    Pins(PinAction),
    /// Play or pause the pendulum that is shown.
    PlayPause,
    /// Another pendulum or question.
    Scene(Box<Build>, FlipQuestion),
    /// Other colours.
    Picture(PictureTable),
    /// Another accuracy.
    Accuracy(Accuracy),
    /// Another kind of engine.
    Engine(EngineKind),
    /// Open the engine anew after a failure.
    TryAgain,
    /// Show or hide layers.
    Layers(Layers),
    /// Open or close a dialog.
    Toggle(Dialog),
    /// Close whatever is open.
    Escape,
    /// Show a scene.
    Show(Box<Document>),
    /// Open a file.
    Open(PathBuf),
    /// Choose a file to open.
    AskForFile,
    /// What was pasted: a location.
    Paste(String),
    /// Copy the location.
    CopyLocation,
    /// Centre the map on a start.
    Find([Theta; 2]),
    /// Hide a notice.
    Dismiss(u64),
    /// Interface larger by a factor.
    UiScale(f32),
    /// Dark, light, or as the system is.
    Theme(Theme),
    /// Smooth moves or jumps.
    Animate(bool),
    /// The whole screen or a window.
    FullScreen,
    /// Lose the graphics device, to see the window survive it.
    LoseDevice,
    /// Close the window.
    Quit,
}
