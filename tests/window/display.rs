//! A private virtual display: an X server in memory, and a connection that moves the pointer,
//! presses keys and reads the screen as any X program could.

use std::collections::HashMap;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use image::RgbImage;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    AtomEnum, ClientMessageEvent, ConfigureWindowAux, ConnectionExt, CreateWindowAux, EventMask,
    ImageFormat, InputFocus, KEY_PRESS_EVENT, KEY_RELEASE_EVENT, MOTION_NOTIFY_EVENT, MapState,
    PropMode, WindowClass,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;
use x11rb::{COPY_DEPTH_FROM_PARENT, COPY_FROM_PARENT, CURRENT_TIME};

/// Width and height of the screen in pixels.
pub(crate) const SCREEN: [u16; 2] = [1600, 1000];

/// The X server and a connection to it.
pub(crate) struct Display {
    server: Child,
    /// Name of the display, as in `DISPLAY`.
    pub name: String,
    connection: RustConnection,
    root: u32,
    /// Key code of each X keysym, and true if Shift must be held.
    keys: HashMap<u32, (u8, bool)>,
}

/// Number of the left mouse button in X.
pub(crate) const LEFT: u8 = 1;
/// Numbers of the buttons that X reports for the wheel: away from the user, and towards the user.
const WHEEL: [u8; 2] = [4, 5];

const BUTTON_PRESS: u8 = x11rb::protocol::xproto::BUTTON_PRESS_EVENT;
const BUTTON_RELEASE: u8 = x11rb::protocol::xproto::BUTTON_RELEASE_EVENT;

/// Polls `ask` until it returns an answer; panics with a message naming `what` after `max_secs`.
pub(crate) fn wait_for<T>(what: &str, max_secs: u64, mut ask: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(answer) = ask() {
            return answer;
        }
        assert!(begun.elapsed() < Duration::from_secs(max_secs), "waited {max_secs} s for {what}");
        sleep(Duration::from_millis(20));
    }
}

impl Display {
    /// Starts a server on a free display.
    pub(crate) fn open() -> Self {
        Self::of_depth(24)
    }

    /// Starts a server whose screen has this many bits a pixel.
    pub(crate) fn of_depth(bits: u8) -> Self {
        let [width, height] = SCREEN;
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-nolisten", "tcp", "-screen", "0"])
            .arg(format!("{width}x{height}x{bits}"))
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect(
                "Xvfb starts: apt-get install xvfb, or declare with FLIPMAP_NO_WINDOW=1 that no \
                 window can be opened here",
            );
        let mut number = String::new();
        let told = server.stdout.take().expect("it is piped");
        BufReader::new(told).read_line(&mut number).expect("Xvfb tells its display");
        let name = format!(":{}", number.trim());
        let (connection, screen) = x11rb::connect(Some(&name)).expect("Xvfb answers");
        let root = connection.setup().roots[screen].root;
        let keys = keys(&connection);
        Display { server, name, connection, root, keys }
    }

    /// Sets a resource of the server, as `xrdb` does; it lasts as long as this connection.
    pub(crate) fn set_resource(&self, text: &str) {
        let (name, kind) = (AtomEnum::RESOURCE_MANAGER, AtomEnum::STRING);
        let set = self.connection.change_property8(
            PropMode::REPLACE,
            self.root,
            name,
            kind,
            text.as_bytes(),
        );
        set.expect("the server is there").check().expect("the root window has properties");
    }

    /// Takes the clipboard, and never answers those who ask for its text.
    pub(crate) fn hold_clipboard(&self) {
        let window = self.connection.generate_id().expect("there are identifiers left");
        let made = self.connection.create_window(
            COPY_DEPTH_FROM_PARENT,
            window,
            self.root,
            0,
            0,
            1,
            1,
            0,
            WindowClass::INPUT_OUTPUT,
            COPY_FROM_PARENT,
            &CreateWindowAux::new(),
        );
        made.expect("the server is there").check().expect("a window can be made");
        let clipboard = self.connection.intern_atom(false, b"CLIPBOARD");
        let clipboard = clipboard.expect("the server is there").reply().expect("it is a name").atom;
        let taken = self.connection.set_selection_owner(window, clipboard, CURRENT_TIME);
        taken.expect("the server is there").check().expect("nobody else holds it");
    }

    /// Ends the server, as a log-out does.
    pub(crate) fn end(&mut self) {
        self.server.kill().expect("it runs");
        self.server.wait().expect("it ends");
    }

    /// The window with this title, or `None` while it is not shown.
    pub(crate) fn window(&self, title: &str) -> Option<u32> {
        let windows = self.connection.query_tree(self.root).ok()?.reply().ok()?.children;
        windows.into_iter().find(|window| {
            let (from, kind) = (AtomEnum::WM_NAME, AtomEnum::ANY);
            let name = self.connection.get_property(false, *window, from, kind, 0, 64);
            let name = name.ok().and_then(|name| name.reply().ok());
            let how = self.connection.get_window_attributes(*window);
            let how = how.ok().and_then(|how| how.reply().ok());
            name.is_some_and(|name| name.value == title.as_bytes())
                && how.is_some_and(|how| how.map_state == MapState::VIEWABLE)
        })
    }

    /// Takes a screenshot of the whole screen.
    pub(crate) fn shot(&self) -> RgbImage {
        let [w, h] = SCREEN;
        let image = self
            .connection
            .get_image(ImageFormat::Z_PIXMAP, self.root, 0, 0, w, h, u32::MAX)
            .expect("the server is there")
            .reply()
            .expect("the screen can be read");
        let rgb = image.data.chunks_exact(4).flat_map(|bgrx| [bgrx[2], bgrx[1], bgrx[0]]);
        RgbImage::from_raw(w.into(), h.into(), rgb.collect()).expect("four bytes a pixel")
    }

    /// Gives a window the keyboard focus, which no window manager does here.
    pub(crate) fn focus(&self, window: u32) {
        let focus = self.connection.set_input_focus(InputFocus::PARENT, window, 0u32);
        focus.expect("the server is there").check().expect("the window is there");
    }

    /// Moves the pointer to a point of the screen.
    pub(crate) fn point(&self, x: f64, y: f64) {
        self.fake(MOTION_NOTIFY_EVENT, 0, [x.round() as i16, y.round() as i16]);
    }

    /// Holds a button down.
    pub(crate) fn press(&self, button: u8) {
        self.fake(BUTTON_PRESS, button, [0, 0]);
    }

    /// Releases a button.
    pub(crate) fn release(&self, button: u8) {
        self.fake(BUTTON_RELEASE, button, [0, 0]);
    }

    /// Presses and releases a button.
    pub(crate) fn click(&self, button: u8) {
        self.press(button);
        self.release(button);
    }

    /// Turns the wheel `times` times, away from the user if positive. The window receives two
    /// notches each time: one when the wheel's button goes down, and one when it comes up.
    pub(crate) fn wheel_twice(&self, times: i32) {
        let button = WHEEL[usize::from(times < 0)];
        (0..times.abs()).for_each(|_| self.click(button));
    }

    /// Drags from one point to another in small steps, as a hand does.
    pub(crate) fn drag(&self, from: [f64; 2], to: [f64; 2]) {
        const STEPS: u32 = 20;
        self.point(from[0], from[1]);
        self.press(LEFT);
        for step in 1..=STEPS {
            let share = f64::from(step) / f64::from(STEPS);
            let along = |axis: usize| from[axis] + share * (to[axis] - from[axis]);
            self.point(along(0), along(1));
            sleep(Duration::from_millis(8));
        }
        self.release(LEFT);
    }

    /// Presses and releases keys together, such as `ctrl+q` or `F1`.
    pub(crate) fn key(&self, chord: &str) {
        let codes: Vec<u8> = chord.split('+').flat_map(|name| self.codes(keysym(name))).collect();
        codes.iter().for_each(|code| self.fake(KEY_PRESS_EVENT, *code, [0, 0]));
        codes.iter().rev().for_each(|code| self.fake(KEY_RELEASE_EVENT, *code, [0, 0]));
    }

    /// Types a text, letter by letter.
    pub(crate) fn type_in(&self, text: &str) {
        for letter in text.chars() {
            let codes = self.codes(letter.into());
            codes.iter().for_each(|code| self.fake(KEY_PRESS_EVENT, *code, [0, 0]));
            codes.iter().rev().for_each(|code| self.fake(KEY_RELEASE_EVENT, *code, [0, 0]));
        }
    }

    /// Resizes a window.
    pub(crate) fn resize(&self, window: u32, [width, height]: [u32; 2]) {
        let size = ConfigureWindowAux::new().width(width).height(height);
        let asked = self.connection.configure_window(window, &size);
        asked.expect("the server is there").check().expect("the window is there");
    }

    /// Asks a window to close, as the button in its title bar does.
    pub(crate) fn ask_to_close(&self, window: u32) {
        let [protocols, delete] = ["WM_PROTOCOLS", "WM_DELETE_WINDOW"].map(|name| {
            let atom = self.connection.intern_atom(false, name.as_bytes());
            atom.expect("the server is there").reply().expect("atoms have numbers").atom
        });
        let message = ClientMessageEvent::new(32, window, protocols, [delete, 0, 0, 0, 0]);
        let sent = self.connection.send_event(false, window, EventMask::NO_EVENT, message);
        sent.expect("the server is there").check().expect("the window is there");
    }

    fn codes(&self, keysym: u32) -> Vec<u8> {
        let (code, shift) = self.keys[&keysym];
        let shift = shift.then(|| self.keys[&SHIFT].0);
        shift.into_iter().chain([code]).collect()
    }

    fn fake(&self, kind: u8, detail: u8, [x, y]: [i16; 2]) {
        let sent = self.connection.xtest_fake_input(kind, detail, 0, self.root, x, y, 0);
        sent.expect("the server is there").check().expect("XTest takes it");
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // An error means that the server is already gone, which is fine.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

const SHIFT: u32 = 0xffe1;

/// The X keysym of a named key.
fn keysym(name: &str) -> u32 {
    match name {
        "ctrl" => 0xffe3,
        "shift" => SHIFT,
        "alt" => 0xffe9,
        "Escape" => 0xff1b,
        "Return" => 0xff0d,
        "BackSpace" => 0xff08,
        "Tab" => 0xff09,
        "Left" => 0xff51,
        "Up" => 0xff52,
        "Right" => 0xff53,
        "Down" => 0xff54,
        "plus" => '+'.into(),
        "minus" => '-'.into(),
        "space" => ' '.into(),
        _ => match name.strip_prefix('F').and_then(|number| number.parse::<u32>().ok()) {
            Some(number) => 0xffbd + number,
            None => name.chars().next().expect("a key has a name").into(),
        },
    }
}

/// The code of every key on the server's keyboard, and whether it needs Shift.
fn keys(connection: &RustConnection) -> HashMap<u32, (u8, bool)> {
    let setup = connection.setup();
    let (first, last) = (setup.min_keycode, setup.max_keycode);
    let mapping = connection.get_keyboard_mapping(first, last - first + 1);
    let mapping = mapping.expect("the server is there").reply().expect("it has a keyboard");
    let mut keys = HashMap::new();
    for (code, row) in
        (first..=last).zip(mapping.keysyms.chunks(mapping.keysyms_per_keycode.into()))
    {
        for (keysym, shift) in row.iter().take(2).zip([false, true]) {
            keys.entry(*keysym).or_insert((code, shift));
        }
    }
    keys
}
