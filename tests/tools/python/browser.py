"""A headless Chromium for the tests of pages, led by its own protocol (Chrome DevTools) over a WebSocket."""

import base64
import contextlib
import itertools
import json
import re
import subprocess
import tempfile
import time
import urllib.request
from pathlib import Path

from sanitizer import ENVIRONMENT_OF_OTHERS
from websockets.sync.client import connect

PROGRAM = "chromium"
PATIENCE = 60.0  # [s] of wall clock that anything may take on a machine with other work


class Browser:
    """A process of its own with a profile of its own; pages are closed with it."""

    def __enter__(self):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.process = subprocess.Popen(
            [PROGRAM, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
             "--disable-component-update", "--disable-sync", "--disable-quic", "--hide-scrollbars", "--disable-dev-shm-usage",
             "--disable-background-timer-throttling", "--disable-renderer-backgrounding", "--disable-backgrounding-occluded-windows",
             "--remote-debugging-port=0", f"--user-data-dir={self.profile.name}", "about:blank"],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            env=ENVIRONMENT_OF_OTHERS)
        told = Path(self.profile.name) / "DevToolsActivePort"
        until(lambda: told.is_file() and "\n" in told.read_text(), "Chromium tells its port")
        self.port = told.read_text().split()[0]
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.profile.cleanup()

    def open(self, address, width=1400, height=900, dark=False):
        """A page in a window of its own: none is hidden by another."""
        version = json.load(urllib.request.urlopen(f"http://127.0.0.1:{self.port}/json/version", timeout=PATIENCE))
        with connect(version["webSocketDebuggerUrl"]) as socket:
            socket.send(json.dumps({"id": 1, "method": "Target.createTarget", "params": {"url": "about:blank", "newWindow": True}}))
            target = json.loads(socket.recv(timeout=PATIENCE))["result"]["targetId"]
        page = BrowserPage(target, f"ws://127.0.0.1:{self.port}/devtools/page/{target}")
        page.call("Page.enable")
        page.call("Runtime.enable")
        page.size(width, height, dark)
        page.call("Page.navigate", url=address)
        page.until("document.readyState === 'complete'")
        return page

    def close(self, page):
        """As a user closes a tab."""
        urllib.request.urlopen(f"http://127.0.0.1:{self.port}/json/close/{page.target}", timeout=PATIENCE).read()


class BrowserPage:
    def __init__(self, target, address):
        self.target, self.numbers = target, itertools.count(1)
        self.socket = contextlib.ExitStack().enter_context(connect(address, max_size=1 << 26))
        self.complaints = []  # exceptions and refusals that the page's console holds

    def call(self, method, **parameters):
        number = next(self.numbers)
        self.socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while True:
            answer = json.loads(self.socket.recv(timeout=PATIENCE))
            if answer.get("method") == "Runtime.exceptionThrown":
                details = answer["params"]["exceptionDetails"]
                self.complaints.append(details.get("exception", {}).get("description", details["text"]))
            if answer.get("id") == number:
                if "error" in answer:
                    raise AssertionError(f"{method}: {answer['error']}")
                return answer["result"]

    def value(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise AssertionError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def until(self, expression):
        until(lambda: self.value(expression), expression)

    def size(self, width, height, dark=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 500)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def mouse(self, kind, x, y):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1, buttons=0 if kind == "mouseReleased" else 1)

    def touch(self, kind, x=None, y=None):
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[] if x is None else [{"x": x, "y": y}])

    def middle(self, selector):
        """Where an element stands in the window."""
        return self.value(f"""(() => {{ const e = document.querySelector({json.dumps(selector)}); e.scrollIntoView({{block: "center"}});
            const b = e.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2, b.width]; }})()""")

    def click(self, selector):
        x, y, _ = self.middle(selector)
        self.mouse("mousePressed", x, y)
        self.mouse("mouseReleased", x, y)

    def key(self, kind, key, code):
        self.call("Input.dispatchKeyEvent", type=kind, key=key, code=code, windowsVirtualKeyCode={"ArrowRight": 39, "ArrowLeft": 37, " ": 32}.get(key, ord(key[0].upper())))

    def screenshot(self, path, whole=True):
        height = self.value("document.documentElement.scrollHeight")
        width = self.value("innerWidth")
        clip = {"x": 0, "y": 0, "width": width, "height": height, "scale": 1}
        data = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole, **({"clip": clip} if whole else {}))["data"]
        Path(path).write_bytes(base64.b64decode(data))


def overlaps(page, selector=".picture text"):
    """Words of a page, else of its pictures, that lie over each other: pairs of texts, none within the other, whose boxes have more than a
    pixel in common. What stands still over a page that is scrolled below it is compared with its like."""
    return page.value(f"(() => {{ const texts = [...document.querySelectorAll({json.dumps(selector)})]" """
          .filter((e) => e.textContent.trim() && e.getBoundingClientRect().width > 0);
        const stands = (e) => Boolean(e.closest("footer"));
        const boxes = texts.map((e) => e.getBoundingClientRect()), found = [];
        for (let i = 0; i < boxes.length; ++i) for (let k = 0; k < i; ++k) {
          if (texts[i].contains(texts[k]) || texts[k].contains(texts[i]) || stands(texts[i]) !== stands(texts[k])) continue;
          const a = boxes[i], b = boxes[k];
          if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1)
            found.push(texts[i].textContent + " | " + texts[k].textContent);
        }
        return found;
    })()""")


def contrast_of(page, selector):
    """Contrast of the first such element's text, or of an SVG text's fill, against what is behind it (WCAG 2.2)."""
    colours = page.value(f"""(() => {{ const e = document.querySelector({json.dumps(selector)}), style = getComputedStyle(e);
        let ground = e;
        while (ground.parentElement && /, 0\\)$|transparent/.test(getComputedStyle(ground).backgroundColor)) ground = ground.parentElement;
        return [e instanceof SVGElement ? style.fill : style.color, getComputedStyle(ground).backgroundColor]; }})()""")

    def luminance(colour):
        shares = [int(part) / 255 for part in re.findall(r"\d+", colour)[:3]]
        red, green, blue = (share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4 for share in shares)
        return 0.2126 * red + 0.7152 * green + 0.0722 * blue

    dark, bright = sorted(luminance(colour) for colour in colours)
    return (bright + 0.05) / (dark + 0.05)


def until(condition, what):
    """Waits for another process: no pause but the look itself, and an end where it never comes."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if condition():
            return
        time.sleep(0.02)
    raise AssertionError(f"not within {PATIENCE:g} s: {what}")
