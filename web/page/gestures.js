/**
 * Pointers, wheel and keys on the map. Points are measured from the middle of the canvas, x to the
 * right and y down, as the map expects them.
 */

/** Points by which a held pointer may shake before it drags; a finger shakes more. */
const SHAKE = { mouse: 4, pen: 6, touch: 10 };
/** Milliseconds between the two clicks of a double click, and points between their places. */
const DOUBLE_MS = 280;
const DOUBLE_POINTS = 28;
/** Milliseconds that the zoom of a click and that of a notch of the wheel take. */
const GLIDE_MS = 250;
const WHEEL_MS = 140;
/** Logarithm of the zoom by a point of the wheel's way, and of a trackpad's pinch. */
const WHEEL_PACE = 0.002;
const PINCH_PACE = 0.012;
/** Rotation of two fingers from which they turn the map, in rad. */
const TWIST = Math.PI / 18;
/** Points by which an arrow moves the map, its zoom by a key, and a bracket's turn in rad. */
const ARROW = 60;
const KEY_ZOOM = 1.5;
const KEY_TURN = Math.PI / 36;

const isStill = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

/** A zoom that slows down towards its end; more zoom can be added on its way. */
class Glide {
  #view;
  #animate;
  #rest = 0;
  #point = [0, 0];
  #endMs = 0;
  #lastMs = 0;
  #isGoing = false;

  constructor(view, animate) {
    this.#view = view;
    this.#animate = animate;
  }

  /** Adds the logarithm of a zoom about a point, to be reached within a number of milliseconds. */
  push(log, point, ms) {
    this.#point = point;
    if (isStill()) {
      this.#view.zoom(Math.exp(log), ...point);
      return;
    }
    this.#rest += log;
    const now = performance.now();
    this.#endMs = now + ms;
    if (this.#isGoing) return;
    this.#isGoing = true;
    this.#lastMs = now;
    this.#animate((nowMs) => this.#step(nowMs));
  }

  /** Lets the zoom end where it is. */
  stop() {
    this.#rest = 0;
  }

  #step(nowMs) {
    const leftMs = this.#endMs - this.#lastMs;
    const doneMs = Math.max(0, nowMs - this.#lastMs);
    const left = leftMs > doneMs ? ((leftMs - doneMs) / leftMs) ** 2 : 0;
    const log = this.#rest * (1 - left);
    this.#rest -= log;
    this.#lastMs = Math.max(nowMs, this.#lastMs);
    if (log !== 0 && !this.#view.zoom(Math.exp(log), ...this.#point)) this.#rest = 0;
    this.#isGoing = Math.abs(this.#rest) > 1e-4;
    return this.#isGoing;
  }
}

/** Two fingers: the map stays under both of them. */
class Pinch {
  #view;
  #turned = 0;
  #turns = false;

  constructor(view) {
    this.#view = view;
  }

  /** Follows one finger from a point to another while the other finger rests. */
  follow(other, from, to) {
    const [was, is] = [from, to].map((end) => [end[0] - other[0], end[1] - other[1]]);
    const [wide, wider] = [was, is].map(([x, y]) => Math.hypot(x, y));
    if (wide < 8 || wider < 8) return;
    const middle = [(to[0] + other[0]) / 2, (to[1] + other[1]) / 2];
    this.#view.drag((to[0] - from[0]) / 2, (to[1] - from[1]) / 2);
    this.#view.zoom(wider / wide, ...middle);
    const by = Math.atan2(was[0] * is[1] - was[1] * is[0], was[0] * is[0] + was[1] * is[1]);
    this.#turned += by;
    this.#turns ||= Math.abs(this.#turned) > TWIST;
    if (this.#turns) turnAbout(this.#view, by, middle);
  }
}

/** Turns the map by an angle, clockwise on the screen, about a point. */
function turnAbout(view, by, [x, y]) {
  const [cos, sin] = [Math.cos(by), Math.sin(by)];
  view.turn(100, 0, 100 * cos, 100 * sin);
  view.drag(x - (x * cos - y * sin), y - (x * sin + y * cos));
}

/** Tells clicks from double clicks, by the time of the events and not by that of their handling. */
class Clicks {
  #act;
  #glide;
  #last = null;

  constructor(act, glide) {
    this.#act = act;
    this.#glide = glide;
  }

  click(point, timeMs) {
    const last = this.#last;
    this.#last = null;
    if (last && timeMs - last.timeMs < DOUBLE_MS && distance(point, last.point) < DOUBLE_POINTS) {
      clearTimeout(last.timer);
      if (last.isDone) this.#act.unclick();
      this.#glide.push(Math.log(3), point, GLIDE_MS);
      return;
    }
    const now = { point, timeMs, isDone: false };
    now.timer = setTimeout(() => {
      now.isDone = true;
      this.#act.click(...point);
    }, DOUBLE_MS);
    this.#last = now;
  }

  /** Forgets a click that has not been acted on. */
  stop() {
    clearTimeout(this.#last?.timer);
    this.#last = null;
  }
}

const distance = ([x0, y0], [x1, y1]) => Math.hypot(x1 - x0, y1 - y0);

/**
 * Listens to the canvas. `view` moves the map (drag, zoom, turn, stretch, home); `act` does all else
 * (click, unclick, hover, leave, back, escape); `animate` calls a function in each frame until it
 * returns false. Returns a function that ends what gestures have begun, because another view is shown.
 */
export function listen(canvas, view, act, animate) {
  const glide = new Glide(view, animate);
  const point = (event) => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    return [event.clientX - left - width / 2, event.clientY - top - height / 2];
  };
  const clicks = new Clicks(act, glide);
  listenToPointers(canvas, { view, act, glide, clicks, point });
  listenToWheel(canvas, { view, glide, clicks, point });
  listenToKeys(canvas, { view, act, glide });
  return () => {
    glide.stop();
    clicks.stop();
  };
}

/** The pointers that are held down: one drags or turns the map, or clicks; two pinch it. */
class Pointers {
  #canvas;
  #to;
  #held = new Map();
  #press = null;
  #pinch = null;

  constructor(canvas, to) {
    this.#canvas = canvas;
    this.#to = to;
  }

  down(event) {
    if (event.button !== 0 || this.#held.size === 2) return;
    const { view, glide, point } = this.#to;
    this.#canvas.setPointerCapture(event.pointerId);
    glide.stop();
    this.#held.set(event.pointerId, point(event));
    const isSecond = this.#held.size === 2;
    this.#press = { last: point(event), isDrag: isSecond, turns: event.shiftKey };
    if (isSecond) this.#pinch = new Pinch(view);
  }

  move(event) {
    const { act, point } = this.#to;
    const to = point(event);
    const from = this.#held.get(event.pointerId);
    if (!from) {
      if (event.pointerType !== "touch") act.hover(...to, event.clientX, event.clientY);
      return;
    }
    if (this.#held.size === 2) {
      const [[, other]] = [...this.#held].filter(([id]) => id !== event.pointerId);
      this.#pinch.follow(other, from, to);
    } else {
      this.#drag(to, SHAKE[event.pointerType] ?? SHAKE.touch);
    }
    this.#held.set(event.pointerId, to);
  }

  #drag(to, shake) {
    const press = this.#press;
    if (!press.isDrag && distance(press.last, to) <= shake) return;
    const { view, act, clicks } = this.#to;
    if (!press.isDrag) {
      act.leave();
      clicks.stop();
    }
    press.isDrag = true;
    this.#canvas.classList.add("dragging");
    const [x, y] = press.last;
    if (press.turns) view.turn(x, y, ...to);
    else view.drag(to[0] - x, to[1] - y);
    press.last = to;
  }

  release(event) {
    if (!this.#held.delete(event.pointerId)) return;
    this.#canvas.classList.remove("dragging");
    const isClick = event.type === "pointerup" && !this.#press.isDrag;
    if (isClick) this.#to.clicks.click(this.#to.point(event), event.timeStamp);
    // The finger that stays on the map goes on dragging it.
    for (const last of this.#held.values()) this.#press = { last, isDrag: true, turns: false };
  }
}

function listenToPointers(canvas, to) {
  const pointers = new Pointers(canvas, to);
  canvas.addEventListener("pointerdown", (event) => pointers.down(event));
  canvas.addEventListener("pointermove", (event) => pointers.move(event));
  canvas.addEventListener("pointerup", (event) => pointers.release(event));
  canvas.addEventListener("pointercancel", (event) => pointers.release(event));
  canvas.addEventListener("pointerleave", () => to.act.leave());
}

function listenToWheel(canvas, { view, glide, clicks, point }) {
  const wheel = (event) => {
    event.preventDefault();
    clicks.stop();
    const unit = [1, 18, 400][event.deltaMode];
    // Shift makes some browsers turn the wheel sideways.
    const way = unit * (event.deltaY || event.deltaX);
    if (event.altKey) {
      view.stretch(Math.exp(-way * WHEEL_PACE));
      return;
    }
    const pace = event.ctrlKey && Math.abs(way) < 50 ? PINCH_PACE : WHEEL_PACE;
    const log = Math.max(-0.6, Math.min(0.6, -way * pace));
    glide.push(log, point(event), WHEEL_MS);
  };
  canvas.addEventListener("wheel", wheel, { passive: false });
  listenToSafari(canvas, view, point);
}

/** Safari tells of a trackpad's pinch and twist by events of its own. */
function listenToSafari(canvas, view, point) {
  let last = null;
  canvas.addEventListener("gesturestart", (event) => {
    event.preventDefault();
    // Fingers on a screen are pointers too, which are listened to already.
    const isTouch = navigator.maxTouchPoints > 0;
    last = isTouch ? null : 1;
  });
  canvas.addEventListener("gesturechange", (event) => {
    event.preventDefault();
    if (last === null) return;
    view.zoom(event.scale / last, ...point(event));
    last = event.scale;
  });
  canvas.addEventListener("gestureend", (event) => event.preventDefault());
}

function listenToKeys(canvas, { view, act, glide }) {
  const middle = [0, 0];
  const zoom = (factor) => glide.push(Math.log(factor), middle, WHEEL_MS);
  const keys = {
    ArrowLeft: () => view.drag(ARROW, 0),
    ArrowRight: () => view.drag(-ARROW, 0),
    ArrowUp: () => view.drag(0, ARROW),
    ArrowDown: () => view.drag(0, -ARROW),
    "+": () => zoom(KEY_ZOOM),
    "=": () => zoom(KEY_ZOOM),
    "-": () => zoom(1 / KEY_ZOOM),
    "[": () => turnAbout(view, -KEY_TURN, middle),
    "]": () => turnAbout(view, KEY_TURN, middle),
    0: () => view.home(),
    Home: () => view.home(),
    Backspace: () => act.back(),
    Enter: () => act.click(0, 0, true),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Escape") act.escape();
    const isOnMap = event.target === canvas || event.target === document.body;
    if (!isOnMap || !Object.hasOwn(keys, event.key)) return;
    event.preventDefault();
    keys[event.key]();
  });
}
