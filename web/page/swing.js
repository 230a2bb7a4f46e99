/**
 * The card with the pendulum of a clicked pixel: it swings beside its twin, which was released one
 * pixel away, and its second bob draws a trail. The motion is integrated in slices, ahead of the
 * clock, and nothing runs once it is known and the clock stands still.
 */

import { setText } from "./readout.js";

const $ = (id) => document.getElementById(id);

/** Milliseconds of a frame that may go into integrating. */
const SLICE_MS = 6;
/** Length of the outstretched pendulum and radius of the heavier bob, in halves of the stage. */
const FILLED = 0.88;
const HEAVIEST = 0.07;
/** Bands of equal opacity in the trail. */
const BANDS = 12;
const COLOURS = {
  own: "#ff9a5c", rod: "#e4e4e7", twin: "#8ecdf5", trail: "255 154 92", flip: "#fff",
};

/** The ring on the map at the clicked point, which is measured from the middle of the canvas. */
export class Ring {
  #element = $("ring");
  #point = null;

  /** The point of the ring; null if there is none. */
  get point() {
    return this.#point;
  }

  /** Shows the ring at a point, or hides it without one. */
  put(point) {
    this.#point = point;
    this.#element.hidden = point === null;
    if (point) this.#element.style.transform = `translate(${point[0]}px, ${point[1]}px)`;
  }

  /** Moves the ring along with the map: `moved` maps its old point to the new one. */
  move(moved) {
    if (this.#point) this.put(moved(this.#point));
  }
}

/** Draws pendulums in metres on a canvas in pixels. */
class Stage {
  #canvas = $("stage");
  #context = this.#canvas.getContext("2d");
  #middle = [0, 0];
  #half = 1;
  #pixel = 1;

  /** Clears the stage; `lengths` and `masses` are those of both bobs. */
  begin(lengths, masses) {
    this.#pixel = Math.min(devicePixelRatio, 2);
    const [width, height] = [this.#canvas.clientWidth, this.#canvas.clientHeight];
    const [across, up] = [width, height].map((side) => Math.round(side * this.#pixel));
    if (this.#canvas.width !== across) this.#canvas.width = across;
    if (this.#canvas.height !== up) this.#canvas.height = up;
    this.#context.setTransform(this.#pixel, 0, 0, this.#pixel, 0, 0);
    this.#context.clearRect(0, 0, width, height);
    this.#middle = [width / 2, height / 2];
    this.#half = Math.min(width, height) / 2;
    this.lengths = lengths;
    this.scale = (this.#half * FILLED) / (lengths[0] + lengths[1]);
    const heaviest = Math.max(...masses);
    this.radii = masses.map((m) => Math.max(3, this.#half * HEAVIEST * Math.sqrt(m / heaviest)));
  }

  /** The point on the canvas of a place in metres from the pivot, y up. */
  #at(x, y) {
    return [this.#middle[0] + x * this.scale, this.#middle[1] - y * this.scale];
  }

  /** Both bobs of a pendulum with these angles from hanging straight down, anticlockwise. */
  bobs(theta1, theta2) {
    const [l1, l2] = this.lengths;
    const first = [l1 * Math.sin(theta1), -l1 * Math.cos(theta1)];
    const second = [first[0] + l2 * Math.sin(theta2), first[1] - l2 * Math.cos(theta2)];
    return [this.#at(...first), this.#at(...second)];
  }

  /** Draws the way of the second bob, the older the fainter; `places` holds x, y, x, y, … */
  trail(places) {
    const count = places.length / 2;
    const g = this.#context;
    [g.lineWidth, g.lineJoin, g.lineCap] = [1.6, "round", "butt"];
    for (let band = 0; band < BANDS; band++) {
      const [from, to] = [band, band + 1].map((k) => Math.floor((k * (count - 1)) / BANDS));
      g.strokeStyle = `rgb(${COLOURS.trail} / ${(0.75 * (band + 1)) / BANDS})`;
      g.beginPath();
      for (let i = from; i <= to; i++) g.lineTo(...this.#at(places[2 * i], places[2 * i + 1]));
      g.stroke();
    }
  }

  /** Draws a pendulum; a `faint` one is dashed and pale. */
  pendulum([first, second], faint) {
    const g = this.#context;
    g.globalAlpha = faint ? 0.6 : 1;
    g.setLineDash(faint ? [4, 4] : []);
    g.lineWidth = faint ? 1.5 : 2.5;
    g.strokeStyle = faint ? COLOURS.twin : COLOURS.rod;
    g.beginPath();
    for (const point of [this.#middle, first, second]) g.lineTo(...point);
    g.stroke();
    g.setLineDash([]);
    g.fillStyle = faint ? COLOURS.twin : COLOURS.own;
    this.#disc(first, this.radii[0]);
    this.#disc(second, this.radii[1]);
    g.fillStyle = COLOURS.rod;
    this.#disc(this.#middle, 2.5);
    g.globalAlpha = 1;
  }

  #disc([x, y], radius) {
    this.#context.beginPath();
    this.#context.arc(x, y, radius, 0, 2 * Math.PI);
    this.#context.fill();
  }

  /** Marks the place of a flip, with words beside it. */
  flip([x, y], words) {
    const g = this.#context;
    [g.strokeStyle, g.fillStyle, g.lineWidth] = [COLOURS.flip, COLOURS.flip, 1.5];
    g.beginPath();
    g.arc(x, y, this.radii[1] + 4, 0, 2 * Math.PI);
    g.stroke();
    g.font = `13px ${getComputedStyle(document.body).fontFamily}`;
    [g.textAlign, g.textBaseline] = ["center", "bottom"];
    const half = g.measureText(words).width / 2;
    const inside = Math.min(Math.max(x, half + 2), 2 * this.#middle[0] - half - 2);
    const above = y - this.radii[1] - 7;
    g.fillText(words, inside, above < 16 ? y + this.radii[1] + 24 : above);
  }
}

/** The card. */
export class SwingCard {
  #card = $("swing");
  #stage = null;
  #swing = null;
  #masses = [1, 1];
  #secs = 0;
  #isPlaying = false;
  #isKnown = false;
  #lastMs = 0;
  #isAsked = false;
  #failed;

  /** `closed` is called when the card is closed, `failed` with an error that was thrown. */
  constructor(closed, failed) {
    this.#failed = failed;
    this.#card.querySelector(".close").addEventListener("click", closed);
    $("play").addEventListener("click", () => this.#toggle());
    $("restart").addEventListener("click", () => this.#restart());
    new ResizeObserver(() => this.#ask()).observe($("stage"));
  }

  get isOpen() {
    return this.#swing !== null;
  }

  /** Lets a pendulum with these masses swing. */
  open(swing, masses) {
    this.#swing?.free();
    this.#swing = swing;
    this.#masses = masses;
    this.#isKnown = false;
    this.#card.hidden = false;
    this.#stage ??= new Stage();
    $("swing-words").textContent = "";
    this.#restart();
  }

  /** Closes the card. Returns false if it was not open. */
  close() {
    if (!this.isOpen) return false;
    this.#swing.free();
    this.#swing = null;
    this.#card.hidden = true;
    return true;
  }

  #restart() {
    this.#secs = 0;
    this.#play(true);
  }

  #toggle() {
    if (!this.#isPlaying && this.#isOver()) this.#secs = 0;
    this.#play(!this.#isPlaying);
  }

  #isOver() {
    return this.#isKnown && this.#secs >= this.#swing.end_secs();
  }

  #play(isPlaying) {
    this.#isPlaying = isPlaying;
    setText($("play"), isPlaying ? "Pause" : "Play");
    this.#lastMs = performance.now();
    this.#ask();
  }

  #ask() {
    if (this.#isAsked || !this.isOpen) return;
    this.#isAsked = true;
    requestAnimationFrame((nowMs) => {
      this.#isAsked = false;
      try {
        this.#frame(nowMs);
      } catch (error) {
        this.#failed(error);
      }
    });
  }

  #frame(nowMs) {
    if (!this.isOpen) return;
    const swing = this.#swing;
    if (!this.#isKnown) this.#isKnown = !swing.advance(SLICE_MS);
    const passed = Math.min(Math.max(nowMs - this.#lastMs, 0), 100) / 1000;
    this.#lastMs = nowMs;
    if (this.#isPlaying) {
      const speed = Number(this.#card.querySelector('[name="speed"]:checked').value);
      this.#secs = Math.min(this.#secs + passed * speed, swing.end_secs());
      if (this.#isOver()) this.#play(false);
    }
    this.#draw(swing);
    setText($("clock"), `${this.#secs.toFixed(2)}\u00a0s`);
    setText($("swing-words"), swing.words());
    if (this.#isPlaying || !this.#isKnown) this.#ask();
  }

  #draw(swing) {
    const stage = this.#stage;
    stage.begin(swing.lengths(), this.#masses);
    stage.trail(swing.trail(this.#secs));
    const [theta1, theta2, twin1, twin2] = swing.at(this.#secs);
    const flip = swing.flip_secs();
    if (flip <= this.#secs) this.#drawFlip(stage, swing.at(flip), flip);
    if (twin1 !== undefined) stage.pendulum(stage.bobs(twin1, twin2), true);
    if (theta1 !== undefined) stage.pendulum(stage.bobs(theta1, theta2), false);
  }

  #drawFlip(stage, angles, secs) {
    // The bob that flips is the one that points straight up.
    const isUp = (angle) => -Math.cos(angle);
    const bob = isUp(angles[1]) >= isUp(angles[0]) ? 1 : 0;
    stage.flip(stage.bobs(angles[0], angles[1])[bob], `flip at ${secs.toFixed(3)}\u00a0s`);
  }
}
