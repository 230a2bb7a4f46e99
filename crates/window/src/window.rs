//! The system window, which handles events, draws frames and sleeps in between.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Fullscreen, Window, WindowId};

use super::action::Action;
use super::arrivals::Arrivals;
use super::display::Screens;
use super::egui_host::EguiHost;
use super::mishap::{self, plain};
use super::model::{AppModel, WindowOptions};
use super::news_pace::NewsPace;
use super::state::Effect;
use super::stats::{Holdings, Stats};
use super::wake::Woken;
pub use super::window_error::WindowError;

/// Shortest time between two frames.
const FRAME: Duration = Duration::from_micros(16_600);
/// Time until the next frame above which the window counts as at rest.
const REST: Duration = Duration::from_secs(1);
/// Largest number of losses within [`LOSSES_WITHIN`] after which the device is opened again.
const MAX_LOSSES: usize = 5;
const LOSSES_WITHIN: Duration = Duration::from_secs(60);
/// What is told if a paste brings no text.
const NOTHING_TO_PASTE: &str =
    "Nothing was pasted: the clipboard has no text, or the program that holds it does not answer.";

/// A window that the system has granted, its graphics device, and the model that it shows.
struct OpenWindow {
    window: Arc<Window>,
    host: EguiHost,
    model: AppModel,
}

/// The event handler of a running window.
struct Runner {
    options: WindowOptions,
    proxy: EventLoopProxy<Woken>,
    open: Option<OpenWindow>,
    stats: Stats,
    begun: Instant,
    redraw_at: Option<Instant>,
    last_frame: Instant,
    pace: NewsPace,
    /// When the events of this turn of the loop may have come.
    arrivals: Arrivals,
    /// Moments of the recent losses of the device.
    losses: Vec<Instant>,
    /// True if the measurements were written since the last frame.
    told: bool,
    failure: Option<WindowError>,
}

/// A function that closes a window from any thread, as the user would.
pub(crate) type Closer = Box<dyn Fn() + Send>;

/// Opens a window and runs it until it is closed. `begun` is the moment when the program started;
/// `hand_out` receives the function that closes the window from outside.
pub fn run(
    options: WindowOptions,
    begun: Instant,
    hand_out: impl FnOnce(Closer),
) -> Result<(), WindowError> {
    mishap::tell_panics_plainly();
    let event_loop = EventLoop::<Woken>::with_user_event().build();
    let event_loop = event_loop.map_err(|why| WindowError::Display(plain(&why.to_string())))?;
    let closing = event_loop.create_proxy();
    hand_out(Box::new(move || {
        // Once the loop has ended, the window is closed already.
        let _ = closing.send_event(Woken::Quit);
    }));
    let now = Instant::now();
    let mut runner = Runner {
        options,
        proxy: event_loop.create_proxy(),
        open: None,
        stats: Stats::since(begun),
        begun,
        redraw_at: None,
        last_frame: now,
        pace: NewsPace::new(now),
        arrivals: Arrivals::new(now),
        losses: Vec::new(),
        told: true,
        failure: None,
    };
    let ended = catch_unwind(AssertUnwindSafe(|| event_loop.run_app(&mut runner)));
    mishap::window_is_open(false);
    match ended {
        Ok(Ok(())) => runner.failure.map_or(Ok(()), Err),
        // The settings were saved when the loop ended.
        Ok(Err(_)) => Err(WindowError::Gone),
        Err(panic) => Err(runner.abandon(panic.as_ref())),
    }
}

impl Runner {
    /// Saves what the user would lose by a panic, and returns the error for it. What is left of the
    /// window is not dropped, since its display may be gone.
    fn abandon(mut self, panic: &(dyn Any + Send)) -> WindowError {
        if let Some(mut open) = self.open.take() {
            save(&mut open.model);
            std::mem::forget(open);
        }
        std::mem::forget(self);
        WindowError::Panicked(mishap::words_of(panic))
    }

    /// Opens the window. The engine is opened first, on its own thread, because it takes longest.
    fn open(&self, event_loop: &ActiveEventLoop) -> Result<OpenWindow, WindowError> {
        let screens = Screens::of(event_loop)?;
        let proxy = self.proxy.clone();
        let model = AppModel::new(
            &self.options,
            Arc::new(move || {
                // Once the loop has ended, there is nothing to wake.
                let _ = proxy.send_event(Woken::News);
            }),
        );
        let window = event_loop.create_window(screens.attributes());
        let window = window.map_err(|why| WindowError::Window(plain(&why.to_string())))?;
        let window = Arc::new(window);
        let host = EguiHost::new(event_loop, &window, &self.proxy, None);
        let host = host.map_err(|why| screens.odd_depth.map_or(why.into(), WindowError::Depth))?;
        window.set_visible(true);
        mishap::window_is_open(true);
        Ok(OpenWindow { window, host, model })
    }

    /// Schedules a frame for a moment, or for later if it would follow the last frame too soon.
    fn draw_at(&mut self, moment: Instant) {
        let moment = moment.max(self.last_frame + FRAME);
        self.redraw_at = Some(self.redraw_at.map_or(moment, |other| other.min(moment)));
    }

    fn draw(&mut self, event_loop: &ActiveEventLoop) {
        let Some(open) = &mut self.open else { return };
        let began = Instant::now();
        self.last_frame = began;
        self.redraw_at = None;
        self.told = false;
        let moving = open.model.state.tick((began - self.begun).as_secs_f64());
        open.host.ctx.set_theme(open.model.state.look.theme);
        open.host.ctx.set_zoom_factor(open.model.ui_scale());
        let mut effects = Vec::new();
        let OpenWindow { host, model, .. } = open;
        model.map_renderer.is_quick = host.is_quick();
        let again = host.frame(event_loop, |ui| effects.extend(model.show(ui)));
        let progress = model.progress();
        self.pace.drew(began.elapsed(), &progress);
        self.stats.frame(began, &progress, model.state.dragging);
        self.stats.figure(model.figure_shown().is_some());
        if model.state.shown.debug {
            model.measured = self.stats.report(Holdings::of(model)).lines();
        }
        if let Some(complaint) = host.complaint() {
            model.state.notices.fail(format!("The graphics driver refused something: {complaint}"));
        }
        model.save_sometimes();
        // The frame may have changed the view, so the work comes after it.
        let has_news = model.work();
        let news = if has_news { self.pace.pause(&model.progress(), began) } else { Duration::MAX };
        let moving = moving || model.state.moving.is_some();
        let works = model.compute.is_waiting() && !model.lab_hides_map();
        let again = if moving || works { Duration::ZERO } else { again.min(news) };
        if again < Duration::from_secs(3600) {
            // A figure keeps its pace, however long its frames take; a map's frames leave time to compute.
            let since = if model.lab_hides_map() { began } else { Instant::now() };
            self.draw_at(since + again);
        }
        for effect in effects {
            self.perform(event_loop, effect);
        }
    }

    /// Carries out an effect that only the window can.
    fn perform(&mut self, event_loop: &ActiveEventLoop, effect: Effect) {
        let Some(open) = &mut self.open else { return };
        match effect {
            Effect::Quit => event_loop.exit(),
            Effect::FullScreen => {
                let whole = open.window.fullscreen().is_none();
                open.window.set_fullscreen(whole.then_some(Fullscreen::Borderless(None)));
            }
            Effect::Copy(text) => open.host.ctx.copy_text(text),
            Effect::SavePicture(document, path) => {
                open.model.write_picture(open.host.copied_map(), *document, path);
            }
            Effect::CopyPicture(document) => {
                let image = open.model.image(open.host.copied_map(), &document);
                image.into_iter().for_each(|image| open.host.ctx.copy_image(image));
            }
            #[cfg(feature = "rigs")]
            Effect::LoseDevice => open.host.lose_device(),
        }
        self.draw_at(Instant::now());
    }

    /// Opens the device again after it was lost.
    fn recover(&mut self, event_loop: &ActiveEventLoop) {
        let Some(mut open) = self.open.take_if(|open| open.host.is_lost()) else { return };
        self.losses.retain(|loss| loss.elapsed() < LOSSES_WITHIN);
        self.losses.push(Instant::now());
        // The old surface must be gone before the window can have another one.
        let remains = open.host.into_surviving();
        match EguiHost::new(event_loop, &open.window, &self.proxy, Some(remains)) {
            Ok(host) if self.losses.len() <= MAX_LOSSES => {
                open.model.forget_card();
                let told = "The graphics device was lost and opened again; the map is as it was.";
                open.model.state.notices.tell(told);
                let OpenWindow { window, model, .. } = open;
                self.open = Some(OpenWindow { window, host, model });
                self.draw_at(Instant::now());
            }
            Ok(_) => self.give_up(event_loop, &mut open.model, WindowError::Lost),
            Err(error) => self.give_up(event_loop, &mut open.model, error.into()),
        }
    }

    /// Saves the settings and closes the window with an error, since nothing can be drawn any more.
    fn give_up(&mut self, event_loop: &ActiveEventLoop, model: &mut AppModel, why: WindowError) {
        save(model);
        self.failure = Some(why);
        event_loop.exit();
    }

    /// Handles news from a thread: passes on jobs at once, but draws a little later unless the
    /// picture is the first of the whole view or the last.
    fn news(&mut self) {
        let Some(open) = &mut self.open else { return };
        open.model.work();
        // News other than tiles comes from flights, exports and dialogs, which the panels show.
        let pause = self.pace.pause(&open.model.progress(), Instant::now());
        self.draw_at(self.last_frame + pause);
    }

    /// Shows a notice.
    fn tell(&mut self, notice: &str) {
        if let Some(open) = &mut self.open {
            open.model.state.notices.tell(notice);
            self.draw_at(Instant::now());
        }
    }

    /// Does at rest what would disturb a moving window: saves the settings, and writes the
    /// measurements. Returns the moment at which there is more to save, if there is.
    fn rest(&mut self) -> Option<Instant> {
        let save_at = self.open.as_mut().and_then(|open| open.model.save_at_rest());
        self.write_measurements();
        save_at
    }

    /// Writes the measurements if the view is complete and nothing moves, so that writing does not
    /// disturb what is measured.
    fn write_measurements(&mut self) {
        let (Some(open), Some(path)) = (&self.open, &self.options.stats) else { return };
        let progress = open.model.progress();
        let still = !open.model.state.dragging && progress.done == progress.wanted;
        if still && !std::mem::replace(&mut self.told, true) {
            // The error of a file that cannot be written is reported when the window closes.
            let _ = self.stats.report(Holdings::of(&open.model)).write(path);
        }
    }

    fn close(&mut self) {
        let Some(mut open) = self.open.take() else { return };
        save(&mut open.model);
        if let Some(path) = &self.options.stats
            && let Err(source) = self.stats.report(Holdings::of(&open.model)).write(path)
        {
            let path = path.display().to_string();
            self.failure = Some(WindowError::Stats { path, source });
        }
    }
}

/// Saves what a model keeps while no notice can be shown any more.
fn save(model: &mut AppModel) {
    if let Some(problem) = model.save() {
        log::error!("{problem}");
    }
}

/// Returns true if an event comes from the user.
fn is_input(event: &WindowEvent) -> bool {
    matches!(
        event,
        WindowEvent::CursorMoved { .. }
            | WindowEvent::MouseInput { .. }
            | WindowEvent::MouseWheel { .. }
            | WindowEvent::KeyboardInput { .. }
            | WindowEvent::PinchGesture { .. }
            | WindowEvent::Touch(_)
    )
}

impl ApplicationHandler<Woken> for Runner {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match self.open(event_loop) {
            Ok(open) => {
                self.open = Some(open);
                self.draw_at(Instant::now());
            }
            Err(error) => {
                self.failure = Some(error);
                event_loop.exit();
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        match event {
            WindowEvent::RedrawRequested => {
                self.draw(event_loop);
                self.recover(event_loop);
            }
            WindowEvent::CloseRequested => {
                let effects = open.model.act(vec![Action::Quit]);
                effects.into_iter().for_each(|effect| self.perform(event_loop, effect));
                self.draw_at(Instant::now());
            }
            WindowEvent::Destroyed => event_loop.exit(),
            event => {
                let repaint = open.host.on_event(&event, self.arrivals.earliest());
                if is_input(&event) {
                    self.stats.input(self.arrivals.earliest());
                }
                if repaint {
                    let now = Instant::now();
                    self.pace.touch(now);
                    self.draw_at(now);
                }
            }
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, woken: Woken) {
        match woken {
            Woken::Draw(moment) => self.draw_at(moment),
            Woken::News => self.news(),
            Woken::Quit => event_loop.exit(),
            Woken::Pasted(pasted) => {
                if self.open.as_mut().is_some_and(|open| open.host.paste(pasted)) {
                    self.tell(NOTHING_TO_PASTE);
                }
            }
            Woken::Accessibility(event) => {
                if let Some(open) = &mut self.open {
                    open.host.on_accessibility(event);
                }
            }
        }
        self.recover(event_loop);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = Instant::now();
        match (self.redraw_at, &self.open) {
            (Some(moment), Some(open)) if moment <= now => {
                open.window.request_redraw();
                event_loop.set_control_flow(ControlFlow::Wait);
            }
            (Some(moment), open) => {
                // The window is at rest even if a notice will disappear later or finer samples are
                // being computed.
                let refines =
                    || open.as_ref().is_some_and(|open| open.model.compute.explorer.refines());
                let is_at_rest = moment > now + REST || refines();
                let save_at = if is_at_rest { self.rest() } else { None };
                let next = save_at.map_or(moment, |save_at| save_at.min(moment));
                event_loop.set_control_flow(ControlFlow::WaitUntil(next));
            }
            (None, _) => {
                let next = self.rest().map_or(ControlFlow::Wait, ControlFlow::WaitUntil);
                event_loop.set_control_flow(next);
            }
        }
        self.arrivals.wait(now);
    }

    fn new_events(&mut self, _: &ActiveEventLoop, _: winit::event::StartCause) {
        self.arrivals.begin_turn(Instant::now());
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.close();
    }
}
