//! Small pictures of scenes, computed in the background: what a question or a place looks like
//! before the user chooses it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use egui::{ColorImage, Context, TextureHandle, TextureOptions};

use super::compute_service::{Wake, lower_priority};
use flipmap_engine::choice::{ChoiceError, EngineRequest, IntegrationSetting};
use flipmap_engine::{Accuracy, EngineError, EngineKind};
use flipmap_pendulum::Status;
use flipmap_render::output::RowPainter;
use flipmap_render::tiles::{Renderer, Samples};
use flipmap_scene::palette::{ViewTimes, budget_range_secs};
use flipmap_scene::{Document, PictureTable, Sampling, Scene, SceneError};

/// Width and height of a picture in pixels.
pub(crate) const SIZE: [u32; 2] = [96, 60];

/// Pictures of a list of documents, of which some may still be missing.
#[derive(Default)]
pub(crate) struct SmallPictures {
    documents: Vec<Document>,
    textures: Vec<Option<TextureHandle>>,
    running: Option<Running>,
}

/// A thread that computes pictures. Dropping it stops the thread after the current picture.
struct Running {
    news: Receiver<(usize, Vec<u8>)>,
    stopped: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stopped.store(true, Ordering::Relaxed);
    }
}

impl SmallPictures {
    /// Begins to compute the pictures of these documents, unless they are those that are shown.
    pub(crate) fn of(&mut self, documents: Vec<Document>, wake: &Wake) {
        if documents == self.documents {
            return;
        }
        // One thread at a time: while the last one ends, the new pictures wait for a later frame.
        if let Some(running) = self.running.as_ref().filter(|r| !r.thread.is_finished()) {
            running.stopped.store(true, Ordering::Relaxed);
            self.documents.clear();
            return;
        }
        let (sender, news) = channel();
        let stopped = Arc::new(AtomicBool::new(false));
        let (stop, wake) = (Arc::clone(&stopped), Arc::clone(wake));
        self.documents.clone_from(&documents);
        // The pictures of before stay until those of the new documents come.
        self.textures.resize(documents.len(), None);
        let thread = std::thread::spawn(move || {
            lower_priority();
            if let Err(error) = compute(&documents, &stop, &sender, &wake) {
                log::warn!("the small pictures are missing: {error}");
            }
            wake();
        });
        self.running = Some(Running { news, stopped, thread });
    }

    /// Returns the picture of a document by its place in the list; none until it is computed.
    pub(crate) fn texture(&mut self, ctx: &Context, place: usize) -> Option<&TextureHandle> {
        let news = self.running.iter().flat_map(|running| running.news.try_iter());
        for (place, rgb) in news {
            let image = ColorImage::from_rgb(SIZE.map(|side| side as usize), &rgb);
            let name = format!("small picture {place}");
            self.textures[place] = Some(ctx.load_texture(name, image, TextureOptions::LINEAR));
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
    sender: &Sender<(usize, Vec<u8>)>,
    wake: &Wake,
) -> Result<(), SmallPictureError> {
    let setting = IntegrationSetting::Accuracy(Accuracy::Fast);
    for (place, document) in documents.iter().enumerate() {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        let scene = document.scene();
        // Opening a graphics card would take longer than a picture.
        let kind = Some(EngineKind::Cpu);
        let request = EngineRequest { kind, setting, ..EngineRequest::default() };
        let mut renderer = Renderer::new(&request.answering(&scene.question))?;
        let samples = renderer.render(&scene, SIZE)?;
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
