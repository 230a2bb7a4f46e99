/**
 * flipmap's page: opens the map of the wasm module on the canvas, keeps it computing and drawn, and
 * brings together gestures, the address bar, the panels and the pendulum.
 */

import { Address, VIEW_WORDS, linkTo, locationInAddress, partsOf, widthIn } from "./address.js";
import { Panels, numbersOf } from "./controls.js";
import { listen } from "./gestures.js";
import { Loop } from "./loop.js";
import {
  closeLastNotice, closeNotice, commandLine, copy, download, fail, notice, sentenceOf, setText,
  showLegend, showStatus, showTag, widthWords,
} from "./readout.js";
import { Ring, SwingCard } from "./swing.js";

const $ = (id) => document.getElementById(id);
const state = document.documentElement.dataset;

/** Milliseconds between two looks at how far the map is. */
const LOOK_MS = 250;
/** Most pixels along a side of the canvas, and most of them for a point. */
const MOST_PIXELS = 8192;
const MOST_DENSITY = 2;
/** Location of the whole map with everything as usual. */
const USUAL = "flipmap:";

/** The page around an open map. */
class Page {
  #canvas;
  #map;
  #loop;
  #address;
  #panels = null;
  #ring = new Ring();
  #card = new SwingCard(() => this.#closeSwing(), fail);
  #stopGestures = () => {};
  #isHome = true;
  #isDone = false;
  #hovered = null;
  /** Size of the canvas in points, and its pixels for each of them, as last fitted. */
  #size = [0, 0, 0];
  #lookedMs = 0;
  /** Level balanced: "later", "offered" by a button, "coming", "here" or "refused". */
  #balanced = "later";

  constructor(canvas, map) {
    this.#canvas = canvas;
    this.#map = map;
    this.#loop = new Loop(map, {
      drawn: () => this.#drawn(),
      worked: () => this.#worked(),
      done: () => this.#done(),
      failed: fail,
    });
    this.#fit();
    this.#show(locationInAddress());
    this.#address = new Address(() => map.location(), (link) => this.#show(link));
    new ResizeObserver(() => this.#fit()).observe(canvas);
    addEventListener("resize", () => this.#fit());
    this.#stopGestures =
      listen(canvas, this.#view(), this.#acts(), (step) => this.#loop.animate(step));
    // A device that was lost while nothing moved is noticed by drawing.
    addEventListener("focus", () => this.#redraw());
  }

  /** Fills the panels, which the first picture does not wait for. */
  hydrate() {
    const page = {
      map: this.#map,
      told: () => this.#told(),
      set: (name, text) => this.#set(name, text),
      reset: () => this.#leap(() => this.#reset()),
      paint: (picture) => this.#paint(picture),
      go: (link) => this.#leap(() => this.#show(link)),
      opened: () => this.#isNarrow() && this.#closeSwing(),
    };
    this.#panels = new Panels(page, JSON.parse(this.#map.choices()));
    $("home").addEventListener("click", () => this.#leap(() => this.#goHome()));
    $("copy-link").addEventListener("click", () => this.#copyLink());
    $("save-picture").addEventListener("click", () => this.#save());
    for (const button of document.querySelectorAll("button.balanced")) {
      button.addEventListener("click", () => this.#raise());
    }
    this.#look();
  }

  #told() {
    return JSON.parse(this.#map.tell());
  }

  #isNarrow() {
    return matchMedia("(max-width: 700px)").matches;
  }

  // The view

  /** Fits the map to the canvas, and draws before the browser shows the canvas empty. */
  #fit() {
    const canvas = this.#canvas;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    // A hidden canvas has no size.
    if (width === 0 || height === 0) return;
    const density = Math.min(devicePixelRatio, MOST_DENSITY, MOST_PIXELS / Math.max(width, height));
    const [across, up] = [width, height].map((side) => Math.round(side * density));
    const size = [width, height, density];
    if (size.every((value, i) => value === this.#size[i])) return;
    const grown = width / this.#size[0];
    this.#size = size;
    [canvas.width, canvas.height] = [across, up];
    this.#map.resize(width, height, density);
    this.#ring.move(([x, y]) => [x * grown, y * grown]);
    if (this.#isHome) {
      this.#map.home();
      this.#ring.put(null);
    }
    this.#loop.drawNow();
    this.#compute();
  }

  /** Shows a location. An empty one is that of the whole map; so is one that is not understood. */
  #show(link) {
    this.#stopGestures();
    this.#ring.put(null);
    closeNotice("end");
    this.#isHome = link === "";
    let isOpen = true;
    try {
      isOpen = this.#map.go(link || USUAL);
    } catch (error) {
      const sentence = `This address was not understood (${error.message}); here is the whole map.`;
      notice(sentence, { stays: true });
      this.#map.go(USUAL);
      this.#isHome = true;
    }
    if (this.#isHome) this.#map.home();
    else if (!isOpen) this.#tellTooDeep(link);
    this.#redraw();
  }

  #tellTooDeep(link) {
    const [code] = this.#tellEnd().getElementsByTagName("code");
    // The desktop program gets the location that was asked for, however far one zooms here.
    setText(code, `flipmap explore '${link.replaceAll("'", "")}'`);
    code.id = "asked";
  }

  /** What gestures do to the view. The ring moves along as far as that is simple. */
  #view() {
    const map = this.#map;
    const moved = () => {
      this.#isHome = false;
      this.#changed();
    };
    return {
      drag: (dx, dy) => {
        map.drag(dx, dy);
        this.#ring.move(([x, y]) => [x + dx, y + dy]);
        moved();
      },
      zoom: (factor, x, y) => this.#zoom(factor, x, y, moved),
      turn: (x0, y0, x1, y1) => {
        map.turn(x0, y0, x1, y1);
        this.#ring.put(null);
        moved();
      },
      stretch: (factor) => {
        map.stretch(factor);
        this.#ring.put(null);
        moved();
      },
      home: () => this.#leap(() => this.#goHome()),
    };
  }

  #zoom(factor, x, y, moved) {
    const width = () => (this.#ring.point ? widthIn(this.#map.location()) : 1);
    const before = width();
    const isOpen = this.#map.zoom(factor, x, y);
    // The map may have zoomed less than asked, at either end.
    const real = this.#ring.point ? before / width() : 1;
    this.#ring.move(([u, v]) => [x + (u - x) * real, y + (v - y) * real]);
    if (isOpen) closeNotice("end");
    else if (!document.querySelector('[data-name="end"]')) this.#tellEnd();
    moved();
    return isOpen;
  }

  /** Tells that the numbers of the level end at this width, and who goes on. */
  #tellEnd() {
    const told = this.#told();
    const isOnWay = ["later", "offered", "coming"].includes(this.#balanced);
    const whose = isOnWay ? "The numbers of the level fast" : "The browser’s numbers";
    const deeper = isOnWay ? " Those of balanced reach deeper." : "";
    const sentence =
      `${whose} end at this width, ${widthWords(told.least_width, told.unit)}.${deeper} ` +
      "The desktop program goes on, down to views 10⁻¹⁰⁰\u00a0rad wide:";
    const content = [commandLine(told.command)];
    return notice(sentence, { name: "end", stays: true, content });
  }

  #goHome() {
    this.#stopGestures();
    this.#map.home();
    this.#isHome = true;
    this.#ring.put(null);
    closeNotice("end");
    this.#redraw();
  }

  /** Does something that is an entry of its own in the browser's history. */
  #leap(does) {
    this.#address.settle();
    does();
    this.#address.settle(true);
  }

  #changed() {
    this.#address?.changed();
    this.#redraw();
  }

  #redraw() {
    this.#loop.draw();
    this.#compute();
  }

  #compute() {
    if (state.state === "failed") return;
    this.#isDone = false;
    state.state = "computing";
    this.#loop.work();
  }

  // What is asked, and its colours

  #set(name, text) {
    try {
      this.#map.set(name, text);
      this.#swingAgain();
      this.#changed();
    } catch (error) {
      notice(sentenceOf(error, true));
    }
    this.#look();
  }

  /** Asks the usual question of the usual pendulum, in the same view if it still means the same. */
  #reset() {
    const parts = partsOf(this.#map.location());
    const view = parts.filter(([word]) => VIEW_WORDS.includes(word)).map((part) => part.join("="));
    const isHome = this.#isHome || parts.some(([word]) => word === "plane");
    this.#show(isHome ? "" : USUAL + view.join(";"));
    this.#closeSwing();
    this.#look();
  }

  #paint(picture) {
    try {
      this.#map.paint(JSON.stringify(picture));
      this.#loop.draw();
    } catch (error) {
      notice(sentenceOf(error, true));
    }
    this.#look();
  }

  // The loop's reports

  #drawn() {
    if (this.#hovered) showTag(this.#map.hover(...this.#hovered.point), ...this.#hovered.at);
  }

  #worked() {
    const now = performance.now();
    if (now - this.#lookedMs > LOOK_MS) this.#look();
  }

  #done() {
    if (state.state === "failed") return;
    this.#isDone = true;
    this.#look();
    state.state = "done";
    if (this.#balanced !== "later") return;
    if (this.#told().is_software) {
      this.#balanced = "offered";
      this.#look();
    } else {
      this.#raise();
    }
  }

  /** Brings all that the page says up to date. */
  #look() {
    this.#lookedMs = performance.now();
    const told = this.#told();
    state.level = told.level;
    if (this.#panels === null) return;
    showLegend(this.#map.legend(), this.#panels.sentence(told.settings.ask));
    showStatus(told, this.#isDone, this.#balanced === "coming" && "preparing balanced");
    for (const button of document.querySelectorAll("button.balanced")) {
      button.hidden = this.#balanced !== "offered";
    }
    const code = document.querySelector('[data-name="end"] code:not(#asked)');
    if (code && told.at_end) setText(code, told.command);
    this.#panels.show(told);
  }

  /** Computes in pairs of numbers from now on, once they have been checked. */
  async #raise() {
    this.#balanced = "coming";
    this.#look();
    try {
      const pairs = await this.#map.pairs();
      this.#map.raise(pairs);
      this.#balanced = "here";
      this.#redraw();
    } catch (error) {
      this.#balanced = "refused";
      const sentence = `The level balanced cannot be used here: ${error.message}`;
      setText($("balanced-news"), sentenceOf(new Error(sentence), true));
      $("balanced-news").hidden = false;
      notice($("balanced-news").textContent);
      // The device may have been lost.
      this.#redraw();
    }
    this.#look();
  }

  // Pointers, pendulum, links and pictures

  #acts() {
    return {
      click: (x, y, isKey) => this.#swing([x, y], isKey),
      unclick: () => this.#closeSwing(),
      hover: (x, y, left, top) => {
        this.#hovered = { point: [x, y], at: [left, top] };
        this.#map.pointer(x, y);
        showTag(this.#map.hover(x, y), left, top);
      },
      leave: () => {
        this.#hovered = null;
        this.#map.pointer_gone();
        showTag("", 0, 0);
      },
      back: () => this.#address.back(),
      escape: () => this.#panels?.close() || this.#closeSwing() || closeLastNotice(),
    };
  }

  #swing(point, isKey) {
    const swing = this.#map.swing(...point);
    if (!swing) {
      notice("No pendulum starts here.");
      return;
    }
    if (this.#isNarrow()) this.#panels?.close();
    setText($("swing-start"), this.#map.hover(...point).split(" · ")[0]);
    this.#card.open(swing, numbersOf(this.#told().settings.masses));
    this.#ring.put(point);
    if (isKey) $("swing").focus();
  }

  /** Lets the pendulum of the ring swing anew after it was changed. */
  #swingAgain() {
    const { point } = this.#ring;
    if (point && this.#card.isOpen) this.#swing(point);
    else this.#closeSwing();
  }

  #closeSwing() {
    if ($("swing").contains(document.activeElement)) this.#canvas.focus();
    this.#ring.put(null);
    return this.#card.close();
  }

  #copyLink() {
    this.#address.settle();
    copy(linkTo(this.#map.location()), "The link was copied.");
  }

  async #save() {
    try {
      const picture = this.#loop.picture(this.#canvas);
      // Read in the task in which the picture was drawn.
      const scene = this.#map.document();
      download(this.#map.saved(await picture, scene), "flipmap.png");
    } catch (error) {
      notice(`The picture could not be saved: ${error.message}`);
    }
  }
}

async function start() {
  const { default: init, PageMap } = await import("./flipmap_web.js");
  await init();
  // A location that is not understood must not keep the map from opening, so it is shown later.
  const map = await PageMap.open($("map"), USUAL);
  // For tests only.
  window.flipmap = { map };
  const page = new Page($("map"), map);
  setTimeout(() => page.hydrate());
}

addEventListener("error", (event) => event.error && fail(event.error));
addEventListener("unhandledrejection", (event) => fail(event.reason));
start().catch(fail);
