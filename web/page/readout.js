/**
 * What the page says: the legend and the state of the map, the words at the pointer, notices, and
 * what happened if there is no map.
 */

const $ = (id) => document.getElementById(id);

/** Milliseconds for which a notice stays, unless it must be read. */
const NOTICE_MS = 8000;

/** What each level is, and how right. The shares were measured on the home map. */
const LEVELS = {
  fast: { means: "32-bit arithmetic", right: "92.5\u00a0%" },
  balanced: { means: "pairs of 32-bit numbers", right: "99.9\u00a0%" },
};

/** A width in words, as in the desktop program's status line. */
export function widthWords(width, unit) {
  const number = width >= 1e-3 ? width.toFixed(4) : width.toPrecision(4);
  return `${number}\u00a0${unit}`;
}

/** A level in words; how right it is only where that was measured: for the time of flips. */
export function levelWords({ level, settings }) {
  const { means, right } = LEVELS[level];
  const share = `right within 1\u00a0ms at ${right} of the home map’s pixels`;
  return settings.ask === "flip" ? `${level}: ${means}, ${share}` : `${level}: ${means}`;
}

/** Sets a text only where it changes, which spares the layout and screen readers. */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Shows how far the map is and how right, and whatever else is going on. */
export function showStatus(told, isDone, news) {
  const percent = Math.floor(100 * told.way);
  const going = [!isDone && `${percent}\u00a0%`, news].filter(Boolean);
  setText($("width"), [`${widthWords(told.width, told.unit)} wide`, ...going].join(" · "));
  setText($("status"), `${levelWords(told)}.`);
  setText($("unflipped-words"), `not within ${Number(told.budget_secs.toPrecision(3))}\u00a0s`);
  const bar = $("progress");
  bar.style.setProperty("--way", told.way);
  bar.setAttribute("aria-valuenow", percent);
  bar.classList.toggle("done", isDone);
}

let shownLegend = "";

/** Shows what the colours mean: `json` is the map's legend, `question` what is asked. */
export function showLegend(json, question) {
  if (json + question === shownLegend) return;
  shownLegend = json + question;
  const legend = JSON.parse(json);
  const name = legend.name.replaceAll("theta", "θ");
  const what = legend.square ? ` (${name})` : legend.unit && ` (${legend.unit})`;
  $("legend-title").textContent = question + what;
  showBar(legend);
  // Only questions about a flip leave pixels without an answer.
  const hasGround = !legend.square && (legend.unit === "s" || legend.name === "bob");
  $("legend-ground").hidden = !hasGround;
  $("unflipped").style.background = legend.unflipped;
  $("forbidden").style.background = legend.forbidden;
  $("legend").hidden = false;
}

function showBar({ square, colours, ticks, unit }) {
  const bar = $("legend-bar");
  bar.hidden = $("legend-ticks").hidden = square;
  if (square) return;
  bar.style.background = `linear-gradient(to right, ${colours.join()})`;
  const ends = [ticks.at(0), ticks.at(-1)].map((tick) => tick?.label ?? "");
  bar.setAttribute("aria-label", `Colours from ${ends.join(" to ")} ${unit}`);
  const labels = ticks.map(({ place, label }) => {
    const span = document.createElement("span");
    span.textContent = label;
    span.style.left = `${100 * place}%`;
    // The first and the last label stay over the bar.
    if (place < 0.04) span.className = "first";
    if (place > 0.96) span.className = "last";
    return span;
  });
  $("legend-ticks").replaceChildren(...labels);
}

/** Shows words beside a point of the window, without covering it; none hide the tag. */
export function showTag(words, x, y) {
  const tag = $("tag");
  tag.hidden = words === "";
  if (tag.hidden) return;
  setText(tag, words);
  const { width, height } = tag.getBoundingClientRect();
  const left = x + 16 + width < innerWidth ? x + 16 : Math.max(4, x - 12 - width);
  const top = y + 20 + height < innerHeight ? y + 20 : y - 12 - height;
  tag.style.transform = `translate(${Math.round(left)}px, ${Math.round(top)}px)`;
}

/**
 * Shows a notice, in the place of one with the same `name`. With `stays` it remains until it is
 * closed. `content` are further elements under the sentence. Returns the notice.
 */
export function notice(sentence, { name = "news", stays = false, content = [] } = {}) {
  closeNotice(name);
  const card = document.createElement("div");
  card.className = "card";
  card.dataset.name = name;
  const text = document.createElement("p");
  text.textContent = sentence;
  const close = button("×", () => card.remove());
  close.className = "close";
  close.setAttribute("aria-label", "Close this notice");
  card.append(text, ...content, close);
  $("notices").append(card);
  if (!stays) setTimeout(() => card.remove(), NOTICE_MS);
  return card;
}

/** Takes away the notice of a name. */
export function closeNotice(name) {
  $("notices").querySelector(`[data-name="${name}"]`)?.remove();
}

/** Takes away the last notice. Returns false if there is none. */
export function closeLastNotice() {
  const last = $("notices").lastElementChild;
  last?.remove();
  return last !== null;
}

/** A button with a word on it. */
export function button(word, whenClicked) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = word;
  made.addEventListener("click", whenClicked);
  return made;
}

/** A command of the desktop program with a button that copies it. */
export function commandLine(command) {
  const line = document.createElement("p");
  line.className = "command";
  // Its text changes while the map moves, which nobody wants to have read out.
  line.ariaLive = "off";
  const code = document.createElement("code");
  code.textContent = command;
  line.append(code, button("Copy", () => copy(code.textContent, "The command was copied.", code)));
  return line;
}

/** Copies a text. Where the browser does not allow it, the text is shown selected instead. */
export async function copy(text, copied, shown) {
  try {
    await navigator.clipboard.writeText(text);
    notice(copied);
  } catch {
    selectText(shown ?? shownText(text));
  }
}

function shownText(text) {
  const line = document.createElement("p");
  line.className = "command";
  const code = document.createElement("code");
  code.textContent = text;
  line.append(code);
  const sentence = "The browser does not let this page copy; here is the text to be copied:";
  notice(sentence, { name: "copy", stays: true, content: [line] });
  return code;
}

function selectText(element) {
  getSelection().selectAllChildren(element);
}

/** Gives the bytes of a PNG file to be kept under a name. */
export function download(bytes, name) {
  const url = URL.createObjectURL(new Blob([bytes], { type: "image/png" }));
  Object.assign(document.createElement("a"), { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

/** Replaces the map by a picture and a sentence on what happened. */
export function fail(error) {
  const state = document.documentElement.dataset;
  if (state.state === "failed") return;
  console.error(error);
  const wasOpen = "level" in state;
  state.state = "failed";
  const still = new Image();
  still.className = "still";
  still.alt = "The map of all double pendulums, as a picture";
  still.src = "./still.jpg";
  $("failure").prepend(still);
  setText($("failure-sentence"), sentenceOf(error, wasOpen));
  $("reload").hidden = !wasOpen;
  $("reload").addEventListener("click", () => location.reload());
  document.body.classList.add("failed");
  $("failure").hidden = false;
}

/** An error in a sentence for people. The map's own errors are sentences already, almost. */
export function sentenceOf(error, wasOpen) {
  if (error?.name === "Error" && error.message) {
    // Long reasons in brackets are for the console.
    const text = error.message.trim().replace(/ \([^)]{60,}\)/, "");
    const whole = text[0].toUpperCase() + text.slice(1);
    return /[.!?]$/.test(whole) ? whole : `${whole}.`;
  }
  return wasOpen
    ? "The map has stopped because of a fault in this page."
    : "A part of this page could not be loaded, so there is no map to explore.";
}
