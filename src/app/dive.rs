//! Going deeper by itself: a descent in the background that the window follows.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use super::action::{Action, Look};
use super::camera::Camera;
use super::desk::Desk;
use super::engine_room::{Wake, step_back};
use super::panels::deeper::DeeperAction;
use crate::engine::EngineError;
use crate::engine::choice::{ChoiceError, Kind, Wish, choose};
use crate::scene::{Document, Scene};
use crate::tiles::descent::{Deeper, Descent};

/// A descent on a thread with an engine of its own. Dropped, it stops.
#[derive(Debug)]
pub struct Dive {
    news: Receiver<Dived>,
    stopped: Arc<AtomicBool>,
}

/// What a dive has to tell.
#[derive(Clone, Debug, PartialEq)]
pub enum Dived {
    /// The next view.
    To(Box<Scene>),
    /// It is over, for this reason.
    Over(String),
}

#[derive(Debug, thiserror::Error)]
enum DiveError {
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    #[error(transparent)]
    Engine(#[from] EngineError),
}

impl Dive {
    /// Goes down from a scene, at first towards a point `wish` widths from its middle.
    pub fn start(scene: Scene, wish: [f64; 2], engine: Wish, wake: Wake) -> Self {
        let (sender, news) = channel();
        let stopped = Arc::new(AtomicBool::new(false));
        let stop = Arc::clone(&stopped);
        std::thread::spawn(move || {
            step_back();
            // The pictures are small: a graphics card would take longer to be opened.
            let engine = Wish { kind: Kind::Cpu, adapter: None, ..engine };
            let why = match dive(scene, wish, &engine, &stop, (&sender, &wake)) {
                Ok(()) => "Nothing near is left to see: the way down ends here.".to_string(),
                Err(error) => format!("The way down ended: {error}."),
            };
            // Nobody listens any more to a dive that was stopped.
            let _ = sender.send(Dived::Over(why));
            wake();
        });
        Dive { news, stopped }
    }

    /// What it has found since.
    pub fn news(&self) -> Option<Dived> {
        self.news.try_recv().ok()
    }
}

/// The way down, as a window keeps it.
#[derive(Debug)]
pub struct Way {
    /// What still goes down.
    pub dive: Option<Dive>,
    /// The views found so far, from where it began.
    pub scenes: Vec<Scene>,
    /// The file for film keys.
    pub path: String,
}

impl Default for Way {
    fn default() -> Self {
        Way { dive: None, scenes: Vec::new(), path: "keys.toml".to_string() }
    }
}

impl Desk {
    /// Begins to go deeper towards the pointer, or the middle without one; or stops.
    pub(super) fn toggle_dive(&mut self) {
        if self.way.dive.take().is_some() {
            return;
        }
        let screen = self.state.screen();
        let pointer = self.state.pointer.unwrap_or_default();
        let wish = (screen.offset_at(pointer) / screen.camera.width_rad).to_array();
        // Deep places show nothing within a budget that stays behind.
        self.state.question.budget.auto = true;
        let scene = self.state.document().scene();
        self.way.scenes = vec![scene.clone()];
        let wish_for = Wish { demand: self.state.demand, ..self.wish.clone() };
        self.way.dive = Some(Dive::start(scene, wish, wish_for, Arc::clone(&self.wake)));
    }

    /// Follows what goes down; says whether there was anything new.
    pub(super) fn follow_dive(&mut self) -> bool {
        let Some(news) = self.way.dive.as_ref().and_then(Dive::news) else { return false };
        match news {
            Dived::To(scene) => {
                let Camera { center, width_rad, .. } = Camera::from_view(&scene.view);
                self.state.go(Camera { center, width_rad, ..self.state.target() });
                self.way.scenes.push(*scene);
            }
            Dived::Over(why) => {
                self.way.dive = None;
                self.state.notices.tell(why);
            }
        }
        true
    }

    /// A person who moves or closes something wants to have the map to himself.
    pub(super) fn stop_dive_for(&mut self, action: &Action) {
        let moves = matches!(action, Action::Look(look) if *look != Look::Release);
        if moves || matches!(action, Action::Escape | Action::Show(_) | Action::Scene(..)) {
            self.way.dive = None;
        }
    }

    pub(super) fn deeper(&mut self, action: DeeperAction) -> Option<Action> {
        match action {
            DeeperAction::Toggle => return Some(Action::GoDeeper),
            DeeperAction::Path(path) => self.way.path = path,
            DeeperAction::Open(k) => {
                let scene = self.way.scenes.get(k)?;
                return Some(Action::Look(Look::To(Camera::from_view(&scene.view))));
            }
            DeeperAction::Keep => {
                let shown = self.state.document();
                let scenes = self.way.scenes.iter().cloned();
                let documents: Vec<Document> =
                    scenes.map(|scene| shown.clone().with_scene(scene)).collect();
                let path = PathBuf::from(&self.way.path);
                self.add_keys(&path, &documents);
            }
        }
        None
    }
}

impl Drop for Dive {
    fn drop(&mut self) {
        self.stopped.store(true, Ordering::Relaxed);
    }
}

fn dive(
    scene: Scene,
    wish: [f64; 2],
    engine: &Wish,
    stop: &AtomicBool,
    (sender, wake): (&Sender<Dived>, &Wake),
) -> Result<(), DiveError> {
    let mut chosen = choose(engine, &|_| ())?;
    let mut descent = Descent::new(scene, chosen.recipe, wish);
    let go_on = || !stop.load(Ordering::Relaxed);
    while let Deeper::Scene(scene) = descent.next(chosen.engine.as_mut(), &go_on)? {
        if sender.send(Dived::To(scene)).is_err() {
            break;
        }
        wake();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::BuiltIn;
    use std::time::Duration;

    #[test]
    fn a_dive_goes_deeper_until_nobody_listens() {
        let scene = BuiltIn::named("filigree").unwrap().document().scene();
        let (sender, woken) = channel();
        let wake: Wake = Arc::new(move || {
            let _ = sender.send(());
        });
        let dive = Dive::start(scene.clone(), [0.1, 0.0], Wish::default(), wake);
        let mut widths = vec![scene.view.width_rad().hi];
        while widths.len() < 4 {
            woken.recv_timeout(Duration::from_secs(60)).unwrap();
            while let Some(Dived::To(scene)) = dive.news() {
                widths.push(scene.view.width_rad().hi);
            }
        }
        assert!(widths.windows(2).all(|pair| pair[1] < 0.4 * pair[0]), "{widths:?}");
        drop(dive);
        // Its thread drops the sender when it ends.
        while woken.recv_timeout(Duration::from_secs(60)).is_ok() {}
    }
}
