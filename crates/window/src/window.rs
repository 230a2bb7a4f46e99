//! The system window, which handles events, draws frames and sleeps in between.

use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Fullscreen, Window, WindowId};

use super::arrivals::Arrivals;
use super::egui_host::{EguiHost, HostError};
use super::model::{AppModel, WindowOptions};
use super::news_pace::NewsPace;
use super::settings::Theme;
use super::state::Effect;
use super::stats::{Holdings, Stats};
use super::wake::Woken;

/// The reason why the window could not be opened or had to close.
#[derive(Debug, thiserror::Error)]
pub enum WindowError {
    /// No display is available.
    #[error("no window can be opened here ({0}); use flipmap render for pictures without a window")]
    Display(#[from] winit::error::EventLoopError),
    /// The system refused the window.
    #[error("the system refused the window: {0}")]
    Window(#[from] winit::error::OsError),
    /// No graphics device can draw the window.
    #[error(transparent)]
    Host(#[from] HostError),
    /// The graphics device was lost again and again.
    #[error(
        "the graphics device was lost again and again; the view was saved. Update the graphics \
         driver, or look with software graphics"
    )]
    Lost,
    /// The measurements could not be written.
    #[error("cannot write the measurements to {path}: {source}")]
    Stats {
        /// Path of the file.
        path: String,
        /// Cause of the failure.
        source: std::io::Error,
    },
}

/// Shortest time between two frames.
const FRAME: Duration = Duration::from_micros(16_600);
/// Time until the next frame above which the window counts as at rest.
const REST: Duration = Duration::from_secs(1);
/// Largest number of losses within [`LOSSES_WITHIN`] after which the device is opened again.
const MAX_LOSSES: usize = 5;
const LOSSES_WITHIN: Duration = Duration::from_secs(60);

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
    let event_loop = EventLoop::<Woken>::with_user_event().build()?;
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
    event_loop.run_app(&mut runner)?;
    runner.failure.map_or(Ok(()), Err)
}

impl Runner {
    /// Opens the window. The engine is opened first, on its own thread, because it takes longest.
    fn open(&self, event_loop: &ActiveEventLoop) -> Result<OpenWindow, WindowError> {
        let proxy = self.proxy.clone();
        let model = AppModel::new(
            &self.options,
            Arc::new(move || {
                // Once the loop has ended, there is nothing to wake.
                let _ = proxy.send_event(Woken::News);
            }),
        );
        let attributes = Window::default_attributes()
            .with_title("flipmap")
            // Screen readers must know of the window before it is shown.
            .with_visible(false)
            .with_inner_size(LogicalSize::new(1280.0, 800.0))
            .with_min_inner_size(LogicalSize::new(320.0, 240.0));
        let window = Arc::new(event_loop.create_window(attributes)?);
        let host = EguiHost::new(event_loop, &window, &self.proxy, None)?;
        window.set_visible(true);
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
        apply_looks(open);
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
        let again = if moving || works { Duration::ZERO } else { again };
        let again = again.min(news);
        if again < Duration::from_secs(3600) {
            self.draw_at(Instant::now() + again);
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
        model.save();
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

    /// Writes the measurements if the view is complete and nothing moves, so that writing does not
    /// disturb what is measured.
    fn rest(&mut self) {
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
        open.model.save();
        if let Some(path) = &self.options.stats
            && let Err(source) = self.stats.report(Holdings::of(&open.model)).write(path)
        {
            let path = path.display().to_string();
            self.failure = Some(WindowError::Stats { path, source });
        }
    }
}

/// Applies the chosen theme and scale.
fn apply_looks(open: &OpenWindow) {
    let state = &open.model.state;
    let theme = match state.look.theme {
        Theme::System => egui::ThemePreference::System,
        Theme::Dark => egui::ThemePreference::Dark,
        Theme::Light => egui::ThemePreference::Light,
    };
    open.host.ctx.set_theme(theme);
    open.host.ctx.set_zoom_factor(open.model.ui_scale());
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
            WindowEvent::CloseRequested | WindowEvent::Destroyed => event_loop.exit(),
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
                if moment > now + REST || refines() {
                    self.rest();
                }
                event_loop.set_control_flow(ControlFlow::WaitUntil(moment));
            }
            (None, _) => {
                self.rest();
                event_loop.set_control_flow(ControlFlow::Wait);
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
