//! Small pictures of scenes, computed in the background: what a question or a place looks like
//! before the user chooses it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;

use egui::{Context, TextureHandle};

use super::background_work::BackgroundWork;
use super::compute_service::Wake;
use super::thumbs::loaded;
use flipmap_engine::choice::{ChoiceError, EngineRequest, IntegrationSetting};
use flipmap_engine::{Accuracy, EngineError, EngineKind};
use flipmap_pendulum::Status;
use flipmap_render::output::RowPainter;
use flipmap_render::tiles::{Renderer, Samples};
use flipmap_scene::palette::{ViewTimes, budget_range_secs};
use flipmap_scene::{Document, PictureTable, Sampling, Scene, SceneError};

/// Width and height of a picture in pixels.
pub(crate) const SIZE: [u32; 2] = [96, 60];

/// Height of a picture as a share of its width.
pub(crate) const ASPECT: f32 = SIZE[1] as f32 / SIZE[0] as f32;

/// Pictures of a list of documents, of which some may still be missing.
#[derive(Default)]
pub(crate) struct SmallPictures {
    wanted: Vec<Document>,
    /// Documents whose pictures are computed, or being computed.
    begun: Vec<Document>,
    textures: Vec<Option<TextureHandle>>,
    running: Option<BackgroundWork<(usize, Vec<u8>)>>,
}

impl SmallPictures {
    /// Asks for the pictures of these documents, and begins to compute them.
    pub(crate) fn of(&mut self, documents: Vec<Document>, wake: &Wake) {
        self.wanted = documents;
        self.begin(wake);
    }

    /// Begins to compute the pictures that were asked for last, unless that was done. Only one thread
    /// computes at a time: until the last one has stopped, a later call has to begin.
    pub(crate) fn begin(&mut self, wake: &Wake) {
        if self.wanted == self.begun {
            return;
        }
        if let Some(running) = self.running.as_ref().filter(|running| !running.has_ended()) {
            running.stop();
            self.begun.clear();
            return;
        }
        self.begun.clone_from(&self.wanted);
        // The pictures of before stay until those of the new documents come.
        self.textures.resize(self.begun.len(), None);
        let (documents, wake, last) = (self.begun.clone(), Arc::clone(wake), Arc::clone(wake));
        let work = move |sender: &_, stop: &_| {
            if let Err(error) = compute(&documents, stop, sender, &wake) {
                log::warn!("the small pictures are missing: {error}");
            }
        };
        // The last wake comes when the work counts as ended, so that whoever it wakes can begin.
        self.running = Some(BackgroundWork::start_then(self.begun.len(), work, move || last()));
    }

    /// Returns the picture of a document by its place in the list; none until it is computed.
    pub(crate) fn texture(&mut self, ctx: &Context, place: usize) -> Option<&TextureHandle> {
        let running = self.running.iter();
        for (place, rgb) in running.flat_map(|work| std::iter::from_fn(|| work.news())) {
            let name = format!("small picture {place}");
            self.textures[place] = Some(loaded(ctx, name, SIZE, &rgb));
        }
        self.textures.get(place)?.as_ref()
    }
}

/// The reason why there are no pictures.
#[derive(Debug, thiserror::Error)]
enum SmallPictureError {
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    #[error(transparent)]
    Engine(#[from] EngineError),
    #[error(transparent)]
    Scene(#[from] SceneError),
}

fn compute(
    documents: &[Document],
    stop: &AtomicBool,
    sender: &SyncSender<(usize, Vec<u8>)>,
    wake: &Wake,
) -> Result<(), SmallPictureError> {
    let setting = IntegrationSetting::Accuracy(Accuracy::Fast);
    // Pictures that need the same engine share it.
    let mut opened: Option<(EngineRequest, Renderer)> = None;
    for (place, document) in documents.iter().enumerate() {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        let scene = document.scene();
        // Opening a graphics card would take longer than a picture.
        let kind = Some(EngineKind::Cpu);
        let request = EngineRequest { kind, setting, ..EngineRequest::default() };
        let request = request.answering(&scene.question);
        let mut renderer = match opened.take().filter(|(of, _)| *of == request) {
            Some((_, renderer)) => renderer,
            None => Renderer::new(&request)?,
        };
        let goes_on = |_, _| !stop.load(Ordering::Relaxed);
        let Some(samples) = renderer.render_while(&scene, SIZE, &goes_on)? else { break };
        opened = Some((request, renderer));
        let rgb = painted(&scene, &document.picture, &samples)?;
        if sender.send((place, rgb)).is_err() {
            break;
        }
        wake();
    }
    Ok(())
}

/// Returns a picture, as its own times spread the colours.
fn painted(
    scene: &Scene,
    picture: &PictureTable,
    samples: &Samples,
) -> Result<Vec<u8>, SceneError> {
    let (single, adaptive) = (Sampling::SINGLE, false);
    let mut picture = PictureTable { samples: single, adaptive, ..picture.clone() };
    if picture.follows_view() && picture.paints_times(scene.question.ask) {
        let times = (0..samples.len()).map(|place| samples.get(place));
        let times =
            times.filter(|outcome| outcome.status == Status::Answered).map(|outcome| outcome.time);
        let weight = ViewTimes::weight(scene.view.width_rad().hi);
        let range_secs = budget_range_secs(scene.build.unit_secs(), scene.question.budget.secs);
        picture.times = ViewTimes::new(times).spread(weight, range_secs);
    }
    Ok(RowPainter::new(scene, SIZE, &picture)?.paint(samples))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute_service::woken;
    use flipmap_scene::BuiltIn;
    use std::time::Duration;

    #[test]
    fn pictures_asked_for_while_others_are_computed_come_after_them() {
        let documents = |names: &[&str]| -> Vec<Document> {
            names.iter().map(|name| BuiltIn::named(name).unwrap().document()).collect()
        };
        let ((wake, woken), ctx) = (woken(), Context::default());
        let mut pictures = SmallPictures::default();
        pictures.of(documents(&["filigree", "threads", "deep"]), &wake);
        pictures.of(documents(&["lesson", "home"]), &wake);
        assert!(pictures.texture(&ctx, 0).is_none(), "nothing is computed yet");
        while (0..2).any(|place| pictures.texture(&ctx, place).is_none()) {
            woken.recv_timeout(Duration::from_secs(300)).unwrap();
            pictures.begin(&wake);
        }
        assert_eq!(pictures.begun, documents(&["lesson", "home"]));
        assert_eq!(pictures.texture(&ctx, 1).unwrap().size(), SIZE.map(|side| side as usize));
        assert!(pictures.texture(&ctx, 2).is_none());
    }
}
