"""A headless Chromium, driven by chromedriver over WebDriver's HTTP interface."""

import base64
import json
import os
import pathlib
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request

# WebGPU on the processor (SwiftShader), with canvases that can be shown; everything else stays off.
WEBGPU = ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-features=Vulkan",
          "--use-angle=vulkan", "--use-vulkan=swiftshader"]
NO_WEBGPU = ["--disable-gpu", "--disable-features=WebGPU"]
ALWAYS = ["--headless=new", "--no-sandbox", "--disable-background-networking", "--disable-component-update",
          "--disable-sync", "--no-first-run", "--hide-scrollbars"]


class BrowserError(Exception):
    """What the browser or its driver refused."""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Browser:
    """One window of a browser; a context manager that ends it."""

    def __init__(self, size=(1280, 800), touch=False, flags=WEBGPU):
        chromium = os.environ.get("CHROMIUM") or shutil.which("chromium")
        if not (chromium and shutil.which("chromedriver")):
            raise BrowserError("chromium or chromedriver is missing; CHROMIUM names another browser of its kind")
        port = free_port()
        self.driver = subprocess.Popen(["chromedriver", f"--port={port}", "--log-level=SEVERE"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.base = f"http://127.0.0.1:{port}"
        self.session = ""
        try:
            self._begin({"args": ALWAYS + list(flags), "binary": chromium})
            self.resize(size, touch)
        except Exception:
            self.driver.kill()
            raise

    def _begin(self, options):
        self._wait_for_driver()
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        session = self._call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})
        self.session = f"/session/{session['sessionId']}"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self._call("DELETE", self.session)
        except (BrowserError, OSError):
            pass
        self.driver.kill()
        self.driver.wait()

    def _wait_for_driver(self):
        for _ in range(100):
            try:
                self._call("GET", "/status")
                return
            except OSError:
                time.sleep(0.1)
        raise BrowserError("chromedriver does not answer")

    def _call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, method=method, data=data,
                                         headers={"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise BrowserError(json.load(error)["value"]["message"].splitlines()[0]) from None

    def devtools(self, command, **parameters):
        return self._call("POST", f"{self.session}/goog/cdp/execute", {"cmd": command, "params": parameters})

    def resize(self, size, touch=False):
        """Gives the page a canvas of this size in points; with `touch`, that of a phone."""
        width, height = size
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height,
                      deviceScaleFactor=2 if touch else 1, mobile=touch)
        self.devtools("Emulation.setTouchEmulationEnabled", enabled=touch)

    def open(self, address):
        self._call("POST", f"{self.session}/url", {"url": address})

    def script(self, text, *arguments):
        return self._call("POST", f"{self.session}/execute/sync", {"script": text, "args": list(arguments)})

    def later(self, text, *arguments):
        """Runs a script that calls its last argument with the result."""
        return self._call("POST", f"{self.session}/execute/async", {"script": text, "args": list(arguments)})

    def wait(self, condition, seconds):
        """Waits until a JavaScript expression is true; returns the seconds that it took."""
        begun = time.monotonic()
        while time.monotonic() - begun < seconds:
            if self.script(f"return !!({condition})"):
                return time.monotonic() - begun
            time.sleep(0.05)
        raise BrowserError(f"not within {seconds} s: {condition}")

    def mouse(self, kind, x, y, **more):
        self.devtools("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def click(self, x, y):
        for kind in ["mousePressed", "mouseReleased"]:
            self.mouse(kind, x, y, button="left", clickCount=1)

    def drag(self, start, end, steps=12):
        self.mouse("mousePressed", *start, button="left", clickCount=1)
        for k in range(1, steps + 1):
            x, y = (a + (b - a) * k / steps for a, b in zip(start, end))
            self.mouse("mouseMoved", x, y, button="left", buttons=1)
        self.mouse("mouseReleased", *end, button="left", clickCount=1)

    def wheel(self, x, y, by):
        self.mouse("mouseWheel", x, y, deltaX=0, deltaY=by)

    def touches(self, kind, points):
        self.devtools("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y} for x, y in points])

    def key(self, name, code=None, text=None):
        for kind in ["keyDown", "keyUp"]:
            more = {"text": text} if text and kind == "keyDown" else {}
            self.devtools("Input.dispatchKeyEvent", type=kind, key=name, code=code or name, **more)

    def shot(self, path):
        picture = self._call("GET", f"{self.session}/screenshot")
        pathlib.Path(path).write_bytes(base64.b64decode(picture))

    def tabs(self):
        return self._call("GET", f"{self.session}/window/handles")

    def new_tab(self):
        return self._call("POST", f"{self.session}/window/new", {"type": "tab"})["handle"]

    def switch(self, tab):
        self._call("POST", f"{self.session}/window", {"handle": tab})

    def complaints(self):
        log = self._call("POST", f"{self.session}/se/log", {"type": "browser"})
        return [line["message"] for line in log if line["level"] == "SEVERE"]
