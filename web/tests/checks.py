"""What the page must do, tried in a real browser; each check is a function named `check_…`."""

import base64
import json
import subprocess
import time

from browser import NO_WEBGPU, Browser

DONE = "document.documentElement.dataset.state == 'done'"
TAU = 6.283185307179586
# Levels of 255 by which two pictures of the same samples may differ: the card blends and rounds.
NOISE = 3
# Share of pixels that may differ by more.
MOST_DIFFERENT = 0.005
# Seconds that the whole map may take on two cores without a card.
PATIENCE = 120


class Failed(Exception):
    """A check that did not hold."""


def hold(condition, words):
    if not condition:
        raise Failed(words)


def told(browser):
    return json.loads(browser.script("return window.flipmap.map.tell()"))


def location(browser):
    return browser.script("return window.flipmap.map.location()")


def center_and_width(text):
    words = dict(part.split("=") for part in text.removeprefix("flipmap:").split(";"))
    return [float(x) for x in words["center"].split(",")], float(words["width"])


def picture_of(browser, path):
    """Saves the picture that the page would save, with its scene inside."""
    text = """
        const done = arguments[0], map = window.flipmap.map;
        map.draw(performance.now() / 1000);
        const scene = map.document();
        document.getElementById('map').toBlob(async (blob) => {
            const png = map.saved(new Uint8Array(await blob.arrayBuffer()), scene);
            let text = '';
            for (const byte of png) text += String.fromCharCode(byte);
            done(btoa(text));
        });"""
    path.write_bytes(base64.b64decode(browser.later(text)))


def compare(program, ours, theirs):
    command = [program, "compare", ours, theirs, "--tolerance", str(NOISE), "--share", "1", "--json"]
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    hold(result.returncode == 0, f"compare: {result.stderr.strip()}")
    return json.loads(result.stdout)


def render(program, out, scene, *options):
    """Renders a scene with the program, and returns what it tells of it."""
    command = [program, "render", scene, "-o", out, "--json", *options]
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    hold(result.returncode == 0, f"render: {result.stderr.strip()}")
    return json.loads(result.stdout)


def check_home(page):
    """Home appears at once and is complete soon; then nothing moves."""
    with page.browser() as browser:
        begun = time.monotonic()
        browser.open(page.address)
        browser.wait("window.flipmap && JSON.parse(window.flipmap.map.tell()).covered", 30)
        first = time.monotonic() - begun
        browser.shot(page.shots / "first.png")
        browser.wait(DONE, PATIENCE)
        whole = time.monotonic() - begun
        browser.shot(page.shots / "home.png")
        frames = """const done = arguments[0]; let frames = 0, map = window.flipmap.map;
            const draw = map.draw.bind(map); map.draw = (secs) => (frames++, draw(secs));
            setTimeout(() => { delete map.draw; done(frames); }, 1500);"""
        idle = browser.later(frames)
        hold(idle == 0, f"{idle} frames were drawn while nothing changed")
        hold(not browser.complaints(), f"the browser complains: {browser.complaints()}")
        return f"first picture after {first:.1f} s, all of it after {whole:.1f} s, then no frame"


def check_pixels(page):
    """The picture is as right as the one that the program renders at the same level.

    Two of the program's own engines differ in 1 % of the pixels at `fast`, all of them in chaos, so the judge is
    the program's picture at `balanced`.
    """
    scene = f"flipmap:center=0,0;width={TAU}"
    with page.browser(size=(1024, 640)) as browser:
        browser.open(f"{page.address}#{scene}")
        browser.wait(f"window.flipmap && {DONE}", PATIENCE)
        ours, theirs, judge = (page.shots / f"{name}.png" for name in ["ours", "theirs", "judge"])
        picture_of(browser, ours)
    options = ["--size", "1024x640", "--samples", "1", "--no-denoise", "--no-curve"]
    render(page.program, theirs, scene, "--accuracy", "fast", *options)
    render(page.program, judge, scene, "--accuracy", "balanced", *options)
    [beside, wrong, usual] = [
        compare(page.program, *pair)["share"] for pair in [(ours, theirs), (ours, judge), (theirs, judge)]
    ]
    words = (f"{100 * beside:.2f} % of the pixels differ from `render --accuracy fast`, and {100 * wrong:.2f} % from "
             f"`balanced`, from which `fast` differs in {100 * usual:.2f} %")
    hold(wrong <= 1.1 * usual, words)
    return words


def check_link(page):
    """The address is the view, Back works, and a link opens what it was copied from."""
    link = "flipmap:center=-1.66,0.1;width=0.4;budget=60;masses=1,2"
    with page.browser() as browser:
        browser.open(f"{page.address}#{link}")
        browser.wait("window.flipmap", 30)
        shown = location(browser)
        hold("masses=1,2" in shown and "budget=60" in shown, f"{link} became {shown}")
        center, width = center_and_width(shown)
        hold(abs(center[0] + 1.66) < 1e-9 and abs(width - 0.4) < 1e-9, f"{link} became {shown}")
        browser.wheel(640, 300, -240)
        browser.wait(f"window.flipmap.map.location() != '{shown}'", 10)
        browser.wait("decodeURIComponent(location.hash).slice(1) == window.flipmap.map.location()", 10)
        closer = location(browser)
        hold(center_and_width(closer)[1] < width, "the wheel did not zoom in")
        browser.script("history.back()")
        browser.wait(f"window.flipmap.map.location() == '{shown}'", 10)
        address = browser.script("return location.href")
    made = render(page.program, page.shots / "linked.png", address, "--size", "16x10", "--accuracy", "lesson")
    read = made["made"]["location"]
    hold(read == shown, f"the program reads {address} as {read}")
    with page.browser() as browser:
        browser.open(f"{page.address}#flipmap%3Acenter%3D1%2C2%3Bwidth%3D0.5")
        browser.wait("window.flipmap", 30)
        hold(center_and_width(location(browser)) == ([1.0, 2.0], 0.5), "a link with % was not understood")
        browser.open(f"{page.address}#flipmap:width=0")
        browser.wait("[...document.querySelectorAll('[role=status], [role=alert], .notice')]"
                     ".some((e) => e.textContent.includes('width'))", 10)
    return f"{shown}, closer and back; the program reads the same"


def check_drag(page):
    """Dragging stays alive while tiles compute, and moves the map with the pointer."""
    with page.browser() as browser:
        browser.open(f"{page.address}#flipmap:center=2,2;width=1")
        browser.wait("window.flipmap", 30)
        browser.script("""window.gaps = []; let last = performance.now();
            const look = (now) => { window.gaps.push(now - last); last = now; window.going && requestAnimationFrame(look); };
            window.going = true; requestAnimationFrame(look);""")
        before, _ = center_and_width(location(browser))
        browser.drag((700, 400), (572, 400), steps=40)
        after, _ = center_and_width(location(browser))
        gaps = browser.script("window.going = false; return window.gaps.slice(2)")
        hold(abs(after[0] - before[0] - 0.1) < 1e-3, f"the map moved by {after[0] - before[0]} rad instead of 0.1")
        worst, mean = max(gaps), sum(gaps) / len(gaps)
        hold(mean < 200, f"{mean:.0f} ms a frame while dragging")
        return f"{mean:.0f} ms a frame on average while dragging, {worst:.0f} at worst"


def check_click(page):
    """A click lets the pendulum swing beside its twin."""
    with page.browser() as browser:
        browser.open(page.address)
        browser.wait(f"window.flipmap && {DONE}", PATIENCE)
        browser.click(520, 330)
        browser.wait("document.querySelector('#swing:not([hidden]) canvas')", 10)
        time.sleep(3)
        words = browser.script("return document.getElementById('swing').innerText")
        hold("flips" in words or "flip" in words, f"the card says '{words}'")
        browser.shot(page.shots / "swing.png")
        browser.key("Escape")
        browser.wait("document.getElementById('swing').hidden", 5)
        return " ".join(words.split())[:110]


def check_panels(page):
    """Colours and pendulums can be changed."""
    with page.browser() as browser:
        browser.open(page.address)
        browser.wait(f"window.flipmap && {DONE}", PATIENCE)
        for name in ["colours", "pendulum", "about"]:
            browser.script(f"document.querySelector('[data-panel={name}]').click()")
            browser.wait(f"!document.getElementById('{name}').hidden", 5)
            time.sleep(0.5)
            browser.shot(page.shots / f"{name}.png")
        # Growth takes a processor long.
        browser.resize((480, 300))
        map_of = "window.flipmap.map"
        for ask in ["first", "state", "growth", "flip"]:
            browser.script("const ask = document.getElementById('ask'); ask.value = arguments[0];"
                           "ask.dispatchEvent(new Event('input', {bubbles: true}));"
                           "ask.dispatchEvent(new Event('change', {bubbles: true}));", ask)
            browser.wait(f"JSON.parse({map_of}.tell()).settings.ask == '{ask}' && {DONE}", PATIENCE)
            browser.shot(page.shots / f"ask-{ask}.png")
        return "colours, pendulum, about; first, state, growth"


def check_phone(page):
    """Two fingers zoom on a phone, and nothing is cut off."""
    with page.browser(size=(390, 844), touch=True) as browser:
        browser.open(page.address)
        browser.wait(f"window.flipmap && {DONE}", 2 * PATIENCE)
        browser.shot(page.shots / "phone.png")
        _, before = center_and_width(location(browser))
        browser.touches("touchStart", [(150, 400), (240, 400)])
        for k in range(1, 11):
            browser.touches("touchMove", [(150 - 6 * k, 400), (240 + 6 * k, 400)])
        browser.touches("touchEnd", [])
        _, after = center_and_width(location(browser))
        hold(0.3 < after / before < 0.6, f"the pinch zoomed by {before / after:.2f} instead of 2.3")
        wide = browser.script("return document.documentElement.scrollWidth")
        hold(wide <= 390, f"the page is {wide} points wide")
        return f"a pinch zooms by {before / after:.2f}"


def check_resize(page):
    """The map follows the window."""
    with page.browser() as browser:
        browser.open(page.address)
        browser.wait(f"window.flipmap && {DONE}", PATIENCE)
        browser.resize((800, 500))
        browser.wait("document.getElementById('map').width == 800", 10)
        browser.wait(DONE, PATIENCE)
        browser.shot(page.shots / "small.png")
        return "800 × 500 after 1280 × 800"


def check_tabs(page):
    """Two tabs do not disturb each other."""
    with page.browser() as browser:
        browser.open(f"{page.address}#flipmap:center=0,0;width=3")
        browser.wait(f"window.flipmap && {DONE}", PATIENCE)
        [first] = browser.tabs()
        browser.switch(browser.new_tab())
        browser.resize((1280, 800))
        browser.open(f"{page.address}#flipmap:center=1,1;width=1")
        browser.wait(f"window.flipmap && {DONE}", PATIENCE)
        second = location(browser)
        browser.switch(first)
        hold(center_and_width(location(browser))[1] == 3 and center_and_width(second)[1] == 1, "the views mixed")
        return f"width 3 and {second}"


def check_end(page):
    """Where the browser's numbers end, the page says so and names the program's command."""
    with page.browser() as browser:
        browser.open(f"{page.address}#flipmap:center=-1.66,0.1;width=0.1")
        browser.wait("window.flipmap", 30)
        for _ in range(40):
            browser.wheel(640, 400, -600)
            time.sleep(0.1)
        browser.wait("document.body.innerText.includes('flipmap explore')", 20)
        browser.wait("JSON.parse(window.flipmap.map.tell()).covered", PATIENCE)
        browser.shot(page.shots / "end.png")
        state = told(browser)
        hold(state["at_end"], f"at {state['width']}")
        return f"ends at a width of {state['width']:.2e} rad in {state['level']}"


def check_without_webgpu(page):
    """Without WebGPU there is one sentence and a still picture."""
    with page.browser(flags=NO_WEBGPU) as browser:
        browser.open(page.address)
        browser.wait("document.documentElement.dataset.state == 'failed'", 20)
        text = browser.script("return document.body.innerText")
        hold("WebGPU" in text, f"the page says '{text}'")
        time.sleep(0.5)
        browser.shot(page.shots / "without.png")
        return next(line for line in text.splitlines() if "WebGPU" in line)[:120]


def check_lost(page):
    """A lost device is told in a sentence."""
    with page.browser() as browser:
        browser.devtools("Page.addScriptToEvaluateOnNewDocument", source="""
            const request = GPUAdapter.prototype.requestDevice;
            GPUAdapter.prototype.requestDevice = async function (wanted) {
                return (window.device = await request.call(this, wanted)); };""")
        browser.open(page.address)
        browser.wait(f"window.flipmap && {DONE}", PATIENCE)
        browser.script("window.device.destroy()")
        browser.wheel(640, 400, -240)
        browser.wait("document.documentElement.dataset.state == 'failed'", 20)
        browser.shot(page.shots / "lost.png")
        return browser.script("return document.body.innerText").split("\n")[0][:120]


def check_pairs(page):
    """Balanced, in pairs of f32, compares with the program's balanced (minutes without a card)."""
    with page.browser(size=(512, 320)) as browser:
        browser.open(f"{page.address}#flipmap:center=0,0;width={TAU}")
        browser.wait(f"window.flipmap && {DONE}", PATIENCE)
        begun = time.monotonic()
        browser.script("""window.raised = ''; const map = window.flipmap.map;
            map.pairs().then((pairs) => { map.raise(pairs); window.raised = 'yes'; },
                             (error) => { window.raised = String(error); });""")
        browser.wait("window.raised", 1200)
        hold(browser.script("return window.raised") == "yes", browser.script("return window.raised"))
        compiled = time.monotonic() - begun
        browser.script("""const map = window.flipmap.map; window.finished = false;
            const turn = () => { map.work(); map.is_busy() ? setTimeout(turn) : (window.finished = true); }; turn();""")
        browser.wait("window.finished", 1200)
        whole = time.monotonic() - begun - compiled
        ours, theirs = page.shots / "ours-balanced.png", page.shots / "theirs-balanced.png"
        picture_of(browser, ours)
    options = ["--accuracy", "balanced", "--size", "512x320", "--samples", "1", "--no-denoise", "--no-curve"]
    render(page.program, theirs, f"flipmap:center=0,0;width={TAU}", *options)
    share = compare(page.program, ours, theirs)["share"]
    hold(share <= MOST_DIFFERENT, f"{100 * share:.2f} % of the pixels differ by more than {NOISE} levels")
    return f"compiled in {compiled:.0f} s, computed in {whole:.0f} s; {100 * share:.3f} % of the pixels differ"


# Minutes long without a card: only if named.
SLOW = {"pairs"}


class Page:
    """The page under test."""

    def __init__(self, address, program, shots):
        self.address, self.program, self.shots = address, program, shots

    def browser(self, **options):
        return Browser(**options)


def run(address, program, shots, names):
    """Runs the named checks, or all but the slow ones; returns the number of those that failed."""
    every = {name.removeprefix("check_"): check for name, check in globals().items() if name.startswith("check_")}
    unknown = [name for name in names if name not in every]
    if unknown:
        print(f"scripts/web: no check is called {', '.join(unknown)}; there are {', '.join(every)}")
        return len(unknown)
    chosen = names or [name for name in every if name not in SLOW]
    page, failed = Page(address, program, shots), 0
    for name in chosen:
        try:
            print(f"ok      {name}: {every[name](page)}", flush=True)
        except Exception as why:  # One broken check must not hide the others.
            failed += 1
            print(f"FAILED  {name}: {why or type(why).__name__}", flush=True)
    print(f"scripts/web: {len(chosen) - failed} of {len(chosen)} checks passed; pictures are in {shots}")
    return failed
