//! The actions that the user can take.

use std::path::PathBuf;

use glam::DVec2;

use super::colour_cycle::ColourCycle;
use super::pins::{PinAction, PinId};
use super::sections::Section;
use super::settings::{EdgeSamples, Layers, Theme};
use super::state::Dialog;
use flipmap_engine::{Accuracy, EngineKind};
use flipmap_lab::Figure;
use flipmap_lab::take_away::TakeAway;
use flipmap_numbers::Exact;
use flipmap_pendulum::State;
use flipmap_scene::{Document, PictureTable, Scene};
use flipmap_screen::camera::Camera;
use flipmap_screen::flight::playback::Playback;

/// A movement of the view. Points are measured from the middle of the canvas, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// Drags the map along with the pointer by an offset in points.
    Drag(DVec2),
    /// Ends a drag.
    Release,
    /// Zooms by a factor about a point.
    Zoom {
        /// Magnification; above 1 zooms in.
        factor: f64,
        /// Point that stays in place.
        about: DVec2,
    },
    /// Zooms so that the rectangle between two corners fills the canvas.
    Box([DVec2; 2]),
    /// Turns the map about the middle of the canvas, as a drag from one point to another does.
    Turn([DVec2; 2]),
    /// Stretches the map vertically: divides the radians from top to bottom by this factor.
    Stretch(f64),
    /// Moves by a share of the canvas.
    Step(DVec2),
    /// Shows the whole torus.
    Home,
    /// Goes back to the previous view.
    Back,
    /// Goes forward to the view that was left by going back.
    Forward,
    /// Moves to another camera.
    To(Camera),
}

impl Action {
    /// Returns true if the action needs the map to be visible.
    pub(crate) fn is_of_map(&self) -> bool {
        matches!(
            self,
            Action::Look(_)
                | Action::Wheel(..)
                | Action::Pin(_)
                | Action::GoDeeper
                | Action::Layers(_)
        )
    }
}

/// An action in the laboratory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabAction {
    /// Plays or pauses the figure that is shown.
    PlayPause,
    /// Takes the next slower (−1) or faster (1) speed.
    ShiftSpeed(isize),
    /// Switches the lab between its usual look and a large one with few controls for an audience.
    Projector,
    /// Begins the lesson of the figures, or ends it.
    Lesson,
    /// Shows the figure before (−1) or after (1) the one that is shown.
    Step(isize),
    /// Writes the figure that is shown to a file.
    TakeAway(TakeAway),
}

/// An action of the user.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Moves the view.
    Look(Look),
    /// Sets the point of the map under the pointer, or none.
    Hover(Option<DVec2>),
    /// Sets the rectangle being drawn between two points, or none.
    Drawing(Option<[DVec2; 2]>),
    /// Starts an automatic descent from the pointer's position, or stops it.
    GoDeeper,
    /// Shows a figure of the laboratory, or the map again.
    Lab(Option<Figure>),
    /// Acts on the laboratory.
    InLab(LabAction),
    /// Opens a start in a figure.
    OpenInLab(Figure, State<f64>),
    /// Shows on the map a start that was chosen in the laboratory.
    FromLab(State<f64>),
    /// Pins the pixel at a point.
    Pin(DVec2),
    /// Removes the pin that the first click of a double click made.
    Unpin,
    /// Acts on a pin.
    Pins(PinAction),
    /// Plays or pauses the pendulum that is shown.
    PlayPause,
    /// Changes the pendulum, the question or the plane; the view stays if the plane does.
    Scene(Box<Scene>),
    /// Lets the light of the relief come from a point.
    Light(DVec2),
    /// Changes the colours.
    Picture(PictureTable),
    /// Starts, changes or stops the animation of the palette.
    ColourCycle(ColourCycle),
    /// Paints the map in the colours kept under a digit.
    Favourite(u8),
    /// Keeps the colours of the map under a digit.
    KeepFavourite(u8),
    /// Opens, changes or closes the clock that makes the map show flips as time passes.
    Timeline(Option<Playback>),
    /// Changes the accuracy level.
    Accuracy(Accuracy),
    /// Changes the kind of engine.
    Engine(Option<EngineKind>),
    /// Reopens the engine after a failure.
    TryAgain,
    /// Shows or hides layers.
    Layers(Layers),
    /// Zooms by a factor about a point or the structure next to it.
    Wheel(f64, DVec2),
    /// Takes hold of a pin, or lets it go.
    HoldPin(Option<PinId>),
    /// Moves the pin that is held to a point of the canvas.
    MovePin(DVec2),
    /// Saves the map as it is on the screen.
    SavePicture,
    /// Copies the map as it is on the screen.
    CopyPicture,
    /// Opens a panel at the side.
    Panel(&'static str),
    /// Opens a section of the side panel, or closes the panel if it shows the section.
    Section(Section),
    /// Opens or closes a dialog.
    Toggle(Dialog),
    /// Closes whatever is open.
    Escape,
    /// Shows a scene.
    Show(Box<Document>),
    /// Shows a built-in place, in the colours that the user has chosen, if any.
    Visit(Box<Document>),
    /// Opens a file.
    Open(PathBuf),
    /// Asks the user for a file to open.
    AskForFile,
    /// Pastes a text, which should be a location.
    Paste(String),
    /// Copies the set-up of the figure that is shown, as a line of text.
    CopySetUp,
    /// Copies the location.
    CopyLocation,
    /// Copies the link to a page that shows the location.
    CopyLink,
    /// Centres the map on a start.
    Find([Exact; 2]),
    /// Keeps the notices for now, because the pointer is on them.
    HoldNotices,
    /// Hides a notice.
    Dismiss(u64),
    /// Sets the scale of the interface.
    UiScale(f32),
    /// Sets the theme: dark, light, or that of the system.
    Theme(Theme),
    /// Turns smooth moves on or off.
    Animate(bool),
    /// Sets the number of samples per pixel at edges while the view rests.
    Edges(EdgeSamples),
    /// Switches between full screen and a window.
    FullScreen,
    /// Destroys the graphics device, to check that the window survives its loss.
    #[cfg(feature = "rigs")]
    LoseDevice,
    /// Closes the window.
    Quit,
}
