/**
 * The address bar as the view: the part after # is the location of what is shown. A view at which a
 * gesture came to rest gets an entry of its own in the browser's history, so that Back returns to
 * the view before.
 */

/** Milliseconds without a change after which a gesture has come to rest. */
const REST_MS = 400;
/** Milliseconds within which the next gesture continues the last one. */
const SAME_GESTURE_MS = 1500;

/** Words of locations that belong to the view. */
export const VIEW_WORDS = ["center", "width", "rotate", "stretch"];

/** The part of an address that shows a location, with # before it. */
export function hashOf(location) {
  // encodeURI leaves all characters of locations as they are, so that addresses can be read.
  return `#${encodeURI(location).replaceAll("#", "%23")}`;
}

/** The location in the address bar, encoded or plain; empty if there is none. */
export function locationInAddress() {
  const text = window.location.hash.slice(1);
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** The words of a location with their values. */
export function partsOf(location) {
  const parts = location.replace(/^\s*flipmap:/, "").split(";");
  const pairs = parts.filter((part) => part.includes("=")).map((part) => part.split("="));
  return pairs.map((pair) => pair.map((text) => text.trim()));
}

/** The width in a location, in rad; NaN if it has none. */
export function widthIn(location) {
  return Number(partsOf(location).find(([word]) => word === "width")?.[1] ?? NaN);
}

/** The address of links: the base that index.html sets, or that of the page. */
export function linkTo(location) {
  const base = document.querySelector('meta[name="flipmap-links"]').content.trim();
  const url = new URL(base || window.location.href, window.location.href);
  url.hash = hashOf(location);
  return url.href;
}

/** Keeps the address bar at what is shown. */
export class Address {
  #location;
  #timer = 0;
  #beganMs = null;
  #restedMs = -Infinity;
  #depth = history.state?.depth ?? 0;
  #shown = window.location.hash;

  /** `location()` tells what is shown; `show(location)` is called when the address bar changes. */
  constructor(location, show) {
    this.#location = location;
    history.replaceState({ depth: this.#depth }, "");
    const arrive = () => {
      if (window.location.hash === this.#shown) return;
      this.#forget();
      this.#shown = window.location.hash;
      this.#depth = history.state?.depth ?? this.#depth + 1;
      history.replaceState({ depth: this.#depth }, "");
      show(locationInAddress());
    };
    addEventListener("popstate", arrive);
    addEventListener("hashchange", arrive);
  }

  #forget() {
    clearTimeout(this.#timer);
    this.#beganMs = null;
    this.#restedMs = -Infinity;
  }

  /** The view, or what is asked, has changed: the address follows once it rests. */
  changed() {
    this.#beganMs ??= performance.now();
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.settle(), REST_MS);
  }

  /** Writes what is shown into the address bar. A `leap` is never part of the gesture before. */
  settle(leap = false) {
    clearTimeout(this.#timer);
    // A link written in another way than the map writes it is no new view.
    const isNew = leap || this.#beganMs !== null;
    const began = this.#beganMs ?? performance.now();
    this.#beganMs = null;
    const hash = hashOf(this.#location());
    if (hash === this.#shown) return;
    const continues = !isNew || (!leap && began - this.#restedMs < SAME_GESTURE_MS);
    this.#depth += continues ? 0 : 1;
    const write = continues ? "replaceState" : "pushState";
    history[write]({ depth: this.#depth }, "", hash);
    this.#shown = window.location.hash;
    this.#restedMs = performance.now();
  }

  /** Goes back to the view before, but never off this page. */
  back() {
    this.settle();
    if (this.#depth > 0) history.back();
  }
}
