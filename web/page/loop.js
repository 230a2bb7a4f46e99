/**
 * The loop: computing in tasks of its own, drawing in frames, and neither while nothing changes.
 */

/** Keeps a map computing and drawn. */
export class Loop {
  #map;
  #reports;
  #steps = new Set();
  #isAsked = false;
  #isWorking = false;
  #hasFailed = false;

  /**
   * `reports` are called: `drawn()` after each frame, `worked()` after each piece of work, `done()`
   * when there is no work left, and `failed(error)`, after which the loop rests.
   */
  constructor(map, reports) {
    this.#map = map;
    this.#reports = reports;
  }

  /** Draws in the next frame. */
  draw() {
    if (this.#isAsked || this.#hasFailed) return;
    this.#isAsked = true;
    requestAnimationFrame((nowMs) => this.#frame(nowMs));
  }

  /** Draws at once. */
  drawNow() {
    this.#guarded(() => {
      if (this.#map.draw(performance.now() / 1000)) this.draw();
    });
  }

  /** What is drawn now, as the bytes of a PNG file. */
  async picture(canvas) {
    // The canvas can be read only in the task in which it was drawn. Its copy has four bytes a pixel
    // in every browser.
    this.drawNow();
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.width, canvas.height];
    copy.getContext("2d").drawImage(canvas, 0, 0);
    const blob = await new Promise((made) => copy.toBlob(made, "image/png"));
    if (!blob) throw new Error("the browser made no picture");
    return new Uint8Array(await blob.arrayBuffer());
  }

  /** Calls `step(milliseconds)` in each frame, before it is drawn, until it returns false. */
  animate(step) {
    this.#steps.add(step);
    this.draw();
  }

  /** Works until all is computed. */
  work() {
    if (this.#isWorking || this.#hasFailed) return;
    this.#isWorking = true;
    setTimeout(() => this.#guarded(() => this.#turn()));
  }

  #turn() {
    this.#isWorking = false;
    if (this.#map.work()) this.draw();
    this.#reports.worked();
    if (this.#map.is_busy()) this.work();
    else this.#reports.done();
  }

  #frame(nowMs) {
    this.#isAsked = false;
    this.#guarded(() => {
      for (const step of this.#steps) if (!step(nowMs)) this.#steps.delete(step);
      if (this.#map.draw(nowMs / 1000) || this.#steps.size > 0) this.draw();
      this.#reports.drawn();
    });
  }

  /** Does something unless the map has failed; from the first error on, nothing more is done. */
  #guarded(does) {
    if (this.#hasFailed || document.documentElement.dataset.state === "failed") return;
    try {
      does();
    } catch (error) {
      this.#hasFailed = true;
      this.#reports.failed(error);
    }
  }
}
