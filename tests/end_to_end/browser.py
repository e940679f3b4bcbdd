"""A real browser for the cases that open pages: Chromium, headless, driven by its WebDriver (chromium-driver)."""

import base64
import contextlib
import json
import pathlib
import re
import subprocess
import tempfile
import time
import urllib.error
import urllib.request

import OpenImageIO as oiio

# Names of keys in the WebDriver standard, for those that are no characters.
KEYS = {"Left": "\ue012", "Up": "\ue013", "Right": "\ue014", "Down": "\ue015", "Shift": "\ue008", "Tab": "\ue004"}
KEYS |= {"Escape": "\ue00c", "Enter": "\ue007", "Home": "\ue011", "End": "\ue010"}
ELEMENT = "element-6066-11e4-a52e-4f735466cecf"


class Browser:
    """A window. Its pages have one pixel of the screen for each of CSS."""

    def __init__(self, address, session):
        self._address = f"{address}/session/{session}"

    def _call(self, method, path, **content):
        return call(method, f"{self._address}/{path}", content)

    def command(self, name, **parameters):
        """A command of the browser's DevTools protocol."""
        return self._call("POST", "goog/cdp/execute", cmd=name, params=parameters)

    def open(self, path, fragment=""):
        """Opens a file and waits until it is loaded; path may end with a query."""
        name, question, query = str(path).partition("?")
        self._call("POST", "url", url=pathlib.Path(name).resolve().as_uri() + question + query + fragment)

    def run(self, script, *arguments):
        """Runs the body of a function in the page; returns what it returns."""
        return self._call("POST", "execute/sync", script=script, args=list(arguments))

    def until(self, condition, seconds=60):
        """Waits for an expression to hold; returns its value."""
        end = time.monotonic() + seconds
        while not (value := self.run(f"return {condition}")):
            if time.monotonic() > end:
                raise SystemExit(f"FAILED waiting for {condition}")
            time.sleep(0.02)
        return value

    def press(self, *keys):
        """Presses keys one after the other: characters, or names such as "Left" and "Shift+Right"."""
        actions = []
        for key in keys:
            words = [KEYS.get(word, word) for word in (key.split("+") if len(key) > 1 else [key])]
            actions += [{"type": "keyDown", "value": word} for word in words]
            actions += [{"type": "keyUp", "value": word} for word in reversed(words)]
        self._call("POST", "actions", actions=[{"type": "key", "id": "keyboard", "actions": actions}])

    def point(self, x, y, click=False):
        """Moves the pointer to a place of the window."""
        actions = [{"type": "pointerMove", "x": x, "y": y, "duration": 0}]
        if click:
            actions += [{"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}]
        self._call("POST", "actions", actions=[{"type": "pointer", "id": "mouse", "actions": actions}])

    def drag(self, begin, end):
        move = [{"type": "pointerMove", "x": x, "y": y, "duration": 0} for x, y in (begin, end)]
        actions = [move[0], {"type": "pointerDown", "button": 0}, move[1], {"type": "pointerUp", "button": 0}]
        self._call("POST", "actions", actions=[{"type": "pointer", "id": "mouse", "actions": actions}])

    def screenshot(self, path=None):
        """The window as an array (H, W, 3) of 0 to 255; also as a file."""
        png = base64.b64decode(self._call("GET", "screenshot"))
        if path:
            pathlib.Path(path).write_bytes(png)
        with tempfile.NamedTemporaryFile(suffix=".png") as file:
            file.write(png)
            file.flush()
            picture = oiio.ImageBuf(file.name).get_pixels(oiio.UINT8)
        return picture[:, :, :3].astype(int)

    def print_pages(self):
        """The number of pages that it prints."""
        pdf = base64.b64decode(self._call("POST", "print"))
        return len(re.findall(rb"/Type\s*/Page\b", pdf))

    def log(self):
        """What the page said to the console since the last call: errors of scripts, violations of its policy."""
        return [entry["message"] for entry in self._call("POST", "se/log", type="browser")]


def call(method, address, content):
    data = json.dumps(content).encode() if method == "POST" else None
    request = urllib.request.Request(address, data, {"Content-Type": "application/json"}, method=method)
    try:
        with urllib.request.urlopen(request, timeout=240) as answer:
            return json.load(answer)["value"]
    except urllib.error.HTTPError as error:
        raise SystemExit(f"FAILED {address}: {json.load(error)['value']['message']}") from error


@contextlib.contextmanager
def browser(width=1280, height=900, dark=True, wait=True):
    """A Browser whose window has this size, as a context. wait: whether open() waits until the page is loaded."""
    with contextlib.ExitStack() as stack:
        profile = stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
        driver = subprocess.Popen(
            ["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        stack.callback(driver.wait)
        stack.callback(driver.terminate)
        for line in driver.stdout:
            if match := re.search(r"started successfully on port (\d+)", line):
                break
        address = f"http://127.0.0.1:{match[1]}"
        # SwiftShader draws WebGL2 on the processor.
        flags = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars"]
        flags += ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--force-device-scale-factor=1"]
        flags += [f"--user-data-dir={profile}", f"--window-size={width},{height}"]
        options = {"args": flags, "binary": "/usr/bin/chromium"}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        wanted["pageLoadStrategy"] = "normal" if wait else "none"
        session = call("POST", f"{address}/session", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]
        stack.callback(call, "DELETE", f"{address}/session/{session}", {})
        window = Browser(address, session)
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        window.command("Emulation.setDeviceMetricsOverride", **size)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        window.command("Emulation.setEmulatedMedia", features=[scheme])
        yield window
