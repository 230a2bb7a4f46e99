/**
 * The panels: colours, the pendulum and the question, and what there is to know. Panels change the
 * map through the page, and show what the map tells of itself.
 */

import { VIEW_WORDS, hashOf, partsOf, widthIn } from "./address.js";
import { copy, levelWords, setText } from "./readout.js";

const $ = (id) => document.getElementById(id);

/** Milliseconds for which a slider must rest before the map is computed again. */
const SLIDER_MS = 60;
const SOFTWARE_SLIDER_MS = 400;
/** Steps of a slider from its least to its greatest value. */
const STEPS = 200;
/** Sliders of the pendulum: setting, place in it, name, unit, least and greatest value. */
const BUILD = [
  { setting: "masses", place: 0, name: "Mass m1", unit: "kg", least: 0.1, most: 10 },
  { setting: "masses", place: 1, name: "Mass m2", unit: "kg", least: 0.1, most: 10 },
  { setting: "lengths", place: 0, name: "Length l1", unit: "m", least: 0.1, most: 10 },
  { setting: "lengths", place: 1, name: "Length l2", unit: "m", least: 0.1, most: 10 },
  { setting: "gravity", place: 0, name: "Gravity", unit: "m/s²", least: 0.5, most: 50 },
  { setting: "budget", place: 0, name: "Budget", unit: "s", least: 3, most: 300 },
];
const USUAL_COLOURS = { palette: "iris", relief: 0, scale: "log", reverse: false, cycles: 1 };

/** The numbers of a setting's text, which has a comma between two of them. */
export const numbersOf = (text) => String(text).split(",").map(Number);

/** A slider whose equal steps are equal ratios, with its number beside it. */
class RatioSlider {
  #of;
  #range = document.createElement("input");
  #number = document.createElement("input");
  #timer = 0;

  constructor(of, changed, restMs) {
    this.#of = of;
    const id = `${of.setting}-${of.place}`;
    const label = document.createElement("label");
    label.htmlFor = id;
    label.textContent = of.name;
    Object.assign(this.#range, { id, type: "range", min: 0, max: STEPS, step: 1 });
    Object.assign(this.#number, { type: "number", min: 0, step: "any", inputMode: "decimal" });
    this.#number.setAttribute("aria-label", `${of.name} in ${of.unit}`);
    const unit = document.createElement("span");
    unit.textContent = of.unit;
    const number = document.createElement("span");
    number.className = "number";
    number.append(this.#number, unit);
    this.elements = [label, this.#range, number];
    this.#range.addEventListener("input", () => {
      this.#write(this.#ofRange());
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => {
        this.#timer = 0;
        changed(this.value);
      }, restMs());
    });
    this.#number.addEventListener("change", () => changed(this.value));
  }

  get value() {
    return Number(this.#number.value);
  }

  #ofRange() {
    const { least, most } = this.#of;
    const value = least * (most / least) ** (Number(this.#range.value) / STEPS);
    return Number(value.toPrecision(3));
  }

  #write(value) {
    this.#number.value = value;
    this.#range.setAttribute("aria-valuetext", `${value} ${this.#of.unit}`);
  }

  /** Shows a value, but leaves what is being changed right now. */
  show(value, isOpen = true) {
    this.#range.disabled = this.#number.disabled = !isOpen;
    if (this.#timer !== 0) return;
    if (document.activeElement !== this.#number) this.#write(Number(value.toPrecision(6)));
    if (document.activeElement === this.#range) return;
    const { least, most } = this.#of;
    this.#range.value = (STEPS * Math.log(value / least)) / Math.log(most / least);
  }
}

/** The colours of palettes, as the legend would show them; none where they are not a bar. */
function previews(map, palettes) {
  const legend = () => JSON.parse(map.legend());
  if (legend().square) return [];
  const { picture } = JSON.parse(map.tell());
  const found = palettes.map((palette) => {
    map.paint(JSON.stringify({ ...picture, palette, reverse: false, cycles: 1 }));
    return legend().colours;
  });
  map.paint(JSON.stringify(picture));
  return found;
}

/** All panels. */
export class Panels {
  #page;
  #choices;
  #sliders = new Map();
  #opened = null;
  #told = null;
  #least = Infinity;

  /**
   * `page` offers the `map`, `told()`, `set(name, text)`, `reset()`, `paint(picture)`, `go(link)`
   * and `opened()`, which is called when a panel opens.
   */
  constructor(page, choices) {
    this.#page = page;
    this.#choices = choices;
    this.#listenToBar();
    this.#makePendulum();
    this.#makeColours();
    $("copy-command").addEventListener("click", () =>
      copy($("command").textContent, "The command was copied.", $("command")));
  }

  /** The sentence of a question. */
  sentence(ask) {
    return this.#choices.questions.find(({ name }) => name === ask)?.sentence ?? ask;
  }

  #listenToBar() {
    for (const button of document.querySelectorAll("[data-panel]")) {
      button.addEventListener("click", () => this.toggle(button.dataset.panel));
    }
    for (const close of document.querySelectorAll(".panel .close")) {
      close.addEventListener("click", () => this.close());
    }
  }

  /** Opens a panel, or closes it if it is open. */
  toggle(name) {
    const opens = name !== this.#opened;
    this.close();
    if (!opens) return;
    this.#opened = name;
    $(name).hidden = false;
    this.#button(name).setAttribute("aria-expanded", "true");
    this.#page.opened();
    if (name === "colours") this.#preview();
    this.show(this.#page.told());
    $(name).focus({ preventScroll: true });
  }

  /** Closes the open panel. Returns false if there is none. */
  close() {
    if (this.#opened === null) return false;
    const panel = $(this.#opened);
    const button = this.#button(this.#opened);
    if (panel.contains(document.activeElement)) button.focus();
    panel.hidden = true;
    button.setAttribute("aria-expanded", "false");
    this.#opened = null;
    return true;
  }

  #button(name) {
    return document.querySelector(`[data-panel="${name}"]`);
  }

  #makePendulum() {
    const { questions } = this.#choices;
    $("ask").append(...questions.map(({ name, sentence }) => new Option(sentence, name)));
    for (const name of ["ask", "rule"]) {
      $(name).addEventListener("change", () => this.#page.set(name, $(name).value));
    }
    const restMs = () => (this.#told?.is_software ? SOFTWARE_SLIDER_MS : SLIDER_MS);
    for (const of of BUILD) {
      const slider = new RatioSlider(of, () => this.#build(of.setting), restMs);
      this.#sliders.set(of, slider);
      const rows = of.setting === "budget" ? $("auto-budget").closest(".rows") : $("build");
      if (of.setting === "budget") rows.prepend(...slider.elements);
      else rows.append(...slider.elements);
    }
    $("auto-budget").addEventListener("change", () => {
      if ($("auto-budget").checked) this.#page.set("budget", "auto");
      else this.#build("budget");
    });
    $("reset-pendulum").addEventListener("click", () => this.#page.reset());
  }

  /** Sets a setting to the values of its sliders. */
  #build(setting) {
    const parts = [...this.#sliders].filter(([of]) => of.setting === setting);
    this.#page.set(setting, parts.map(([, slider]) => slider.value).join());
  }

  #makeColours() {
    const labels = this.#choices.palettes.map((name) => {
      const label = document.createElement("label");
      const input = Object.assign(document.createElement("input"), {
        type: "radio", name: "palette", value: name,
      });
      input.addEventListener("change", () => this.#paint({ palette: name }));
      label.append(input, document.createElement("i"), name);
      return label;
    });
    $("palettes").append(...labels);
    for (const id of ["relief", "cycles"]) {
      $(id).addEventListener("input", () => this.#paint({ [id]: Number($(id).value) }));
    }
    $("scale").addEventListener("change", () => this.#paint({ scale: $("scale").value }));
    $("reverse").addEventListener("change", () => this.#paint({ reverse: $("reverse").checked }));
    $("reset-colours").addEventListener("click", () => this.#paint(USUAL_COLOURS));
  }

  #paint(change) {
    this.#page.paint({ ...this.#page.told().picture, ...change });
  }

  /** Shows the colours of each palette above its name. */
  #preview() {
    const strips = [...$("palettes").querySelectorAll("i")];
    if (strips[0].style.background) return;
    previews(this.#page.map, this.#choices.palettes).forEach((colours, k) => {
      strips[k].style.background = `linear-gradient(to right, ${colours.join()})`;
    });
  }

  /** Shows what the map tells of itself in the panel that is open. */
  show(told) {
    this.#told = told;
    if (this.#opened === "colours") this.#showColours(told.picture);
    if (this.#opened === "pendulum") this.#showPendulum(told);
    if (this.#opened === "about") this.#showAbout(told);
  }

  #showColours(picture) {
    for (const input of $("palettes").querySelectorAll("input")) {
      input.checked = input.value === picture.palette;
    }
    for (const id of ["relief", "cycles"]) {
      if (document.activeElement !== $(id)) $(id).value = picture[id];
      const words = id === "relief" ? picture[id].toFixed(2) : `${picture[id]}×`;
      setText($(id).nextElementSibling, words);
    }
    $("scale").value = picture.scale;
    $("reverse").checked = picture.reverse;
  }

  #showPendulum(told) {
    const { settings } = told;
    $("ask").value = settings.ask;
    $("rule").value = settings.rule;
    // Only the time of a flip depends on which bob is watched.
    $("rule").disabled = settings.ask !== "flip";
    $("auto-budget").checked = told.auto_budget;
    for (const [of, slider] of this.#sliders) {
      if (of.setting === "budget") slider.show(told.budget_secs, !told.auto_budget);
      else slider.show(numbersOf(settings[of.setting])[of.place]);
    }
    this.#showOthers();
    this.#showScenes(told.least_width);
  }

  /** Tells of settings that links and scenes may change, but that have no controls here. */
  #showOthers() {
    const own = new Set([...VIEW_WORDS, ...BUILD.map(({ setting }) => setting), "ask", "rule"]);
    const others = partsOf(this.#page.map.location()).filter(([word]) => !own.has(word));
    $("others").hidden = others.length === 0;
    const words = others.map((part) => part.join("\u00a0")).join(", ");
    setText($("others"), `Set by the link or the scene: ${words}.`);
  }

  /** Lists the scenes that this browser's numbers can show. */
  #showScenes(least) {
    if (least === this.#least) return;
    this.#least = least;
    const shown = this.#choices.scenes.filter(({ link }) => widthIn(link) >= least);
    const items = shown.map(({ name, sentence, link }) => {
      const item = document.createElement("li");
      const anchor = document.createElement("a");
      anchor.href = hashOf(link);
      anchor.textContent = name;
      anchor.addEventListener("click", (event) => {
        if (event.ctrlKey || event.metaKey || event.shiftKey) return;
        event.preventDefault();
        this.#page.go(link);
      });
      item.append(anchor, ` · ${sentence}`);
      return item;
    });
    $("scenes").replaceChildren(...items);
  }

  #showAbout(told) {
    setText($("level"), `Now ${levelWords(told)}.`);
    setText($("adapter"), told.adapter);
    setText($("command"), told.command);
    const items = told.checks.map(({ name, passed, detail }) => {
      const item = document.createElement("li");
      item.textContent = `${name}: ${passed ? "passed" : "failed"}${detail ? ` (${detail})` : ""}`;
      return item;
    });
    $("checks").replaceChildren(...items);
  }
}
