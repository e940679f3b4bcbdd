"""A real browser for the cases that open pages: Chromium, headless, driven by its WebDriver (chromium-driver). Where
POLYRECON_BROWSER is "firefox", Firefox on a virtual screen (firefox-esr, xvfb), driven by WebDriver BiDi."""

import base64
import contextlib
import json
import os
import pathlib
import re
import secrets
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request
import zlib

import OpenImageIO as oiio

# Names of keys in the WebDriver standard, for those that are no characters.
KEYS = {"Left": "\ue012", "Up": "\ue013", "Right": "\ue014", "Down": "\ue015", "Shift": "\ue008", "Tab": "\ue004"}
KEYS |= {"Escape": "\ue00c", "Enter": "\ue007", "Home": "\ue011", "End": "\ue010"}
ELEMENT = "element-6066-11e4-a52e-4f735466cecf"

# The worst contrast of a text and its ground, and where it is.
CONTRAST = """
const light = (c) => { c = c / 255; return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; };
const parse = (text) => text.match(/[\\d.]+/g).map(Number);
const luminanceOf = (c) => 0.2126 * light(c[0]) + 0.7152 * light(c[1]) + 0.0722 * light(c[2]);
const ground = (e) => {
  for (; e; e = e.parentElement) {
    const c = parse(getComputedStyle(e).backgroundColor);
    if ((c[3] ?? 1) > 0.99) return c;
  }
  return [255, 255, 255];
};
const hasText = (e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
let worst = 99, where = '';
for (const e of document.querySelectorAll('body *')) {
  if (!e.checkVisibility() || e.disabled || !hasText(e)) continue;
  const style = getComputedStyle(e), below = ground(e);
  let part = 1;
  for (let one = e; one; one = one.parentElement) part *= getComputedStyle(one).opacity;
  const color = parse(e instanceof SVGElement ? style.fill : style.color).slice(0, 3);
  const seen = color.map((c, i) => c * part + below[i] * (1 - part));
  const a = luminanceOf(seen), b = luminanceOf(below);
  const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  if (ratio < worst) { worst = ratio; where = e.outerHTML.slice(0, 80); }
}
return [worst, where]"""


class Browser:
    """A window. Its pages have one pixel of the screen for each of CSS."""

    def open(self, path, fragment=""):
        """Loads a file, even if it is open, and waits for it; path may end with a query."""
        self._call("Navigate", url="about:blank")  # Another fragment alone would load nothing.
        name, question, query = str(path).partition("?")
        self._call("Navigate", url=pathlib.Path(name).resolve().as_uri() + question + query + fragment)

    def run(self, script, *arguments):
        """Runs the body of a function in the page; returns what it returns."""
        return self._call("ExecuteScript", script=script, args=list(arguments))

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
        self._call("PerformActions", actions=[{"type": "key", "id": "keyboard", "actions": actions}])

    def point(self, x, y, click=False):
        """Moves the pointer to a place of the window."""
        actions = [{"type": "pointerMove", "x": x, "y": y, "duration": 0}]
        if click:
            actions += [{"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}]
        self._call("PerformActions", actions=[{"type": "pointer", "id": "mouse", "actions": actions}])

    def drag(self, begin, end):
        move = [{"type": "pointerMove", "x": x, "y": y, "duration": 0} for x, y in (begin, end)]
        actions = [move[0], {"type": "pointerDown", "button": 0}, move[1], {"type": "pointerUp", "button": 0}]
        self._call("PerformActions", actions=[{"type": "pointer", "id": "mouse", "actions": actions}])

    def screenshot(self, path=None):
        """The window as an array (H, W, 3) of 0 to 255; also as a file."""
        png = base64.b64decode(self._call("TakeScreenshot", full=False))
        if path:
            pathlib.Path(path).write_bytes(png)
        with tempfile.NamedTemporaryFile(suffix=".png") as file:
            file.write(png)
            file.flush()
            picture = oiio.ImageBuf(file.name).get_pixels(oiio.UINT8)
        return picture[:, :, :3].astype(int)

    def worst_contrast(self):
        """The lowest contrast of a visible text and its ground, and the element that has it."""
        return self.run(CONTRAST)

    def print_pages(self):
        """The number of pages that it prints."""
        pdf = base64.b64decode(self._call("Print"))
        objects = [pdf]
        for packed in re.findall(rb"stream\r?\n(.*?)endstream", pdf, re.DOTALL):
            with contextlib.suppress(zlib.error):
                objects.append(zlib.decompressobj().decompress(packed))
        return sum(len(re.findall(rb"/Type\s*/Page\b", text)) for text in objects)


class Chromium(Browser):
    """Chromium by the WebDriver standard."""

    def __init__(self, address, session):
        self._address = f"{address}/session/{session}"

    def _call(self, name, **content):
        if name == "TakeScreenshot":
            return call("GET", f"{self._address}/screenshot", {})
        paths = {"Navigate": "url", "ExecuteScript": "execute/sync", "PerformActions": "actions", "Print": "print"}
        return call("POST", f"{self._address}/{paths[name]}", content)

    def command(self, name, **parameters):
        """A command of the browser's DevTools protocol."""
        return call("POST", f"{self._address}/goog/cdp/execute", {"cmd": name, "params": parameters})

    def resize(self, width, height):
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.command("Emulation.setDeviceMetricsOverride", **size)

    def log(self):
        """What the page said to the console since the last call: errors of scripts, violations of its policy."""
        return [entry["message"] for entry in call("POST", f"{self._address}/se/log", {"type": "browser"})]


class Firefox(Browser):
    """Firefox by WebDriver BiDi, which reaches the variables of a page's scripts whatever its policy says. Marionette,
    which is plainer, does not."""

    def __init__(self, port):
        self._socket = WebSocket(port, "/session")
        self._count = 0
        self._said = []
        self._send("session.new", capabilities={})
        self._send("session.subscribe", events=["log.entryAdded"])
        self._context = self._send("browsingContext.getTree")["contexts"][0]["context"]

    def _send(self, method, **parameters):
        self._count += 1
        self._socket.send(json.dumps({"id": self._count, "method": method, "params": parameters}))
        while (message := json.loads(self._socket.receive())).get("id") != self._count:
            entry = message.get("params", {})
            if entry.get("level") == "error":
                self._said.append(entry["text"])
        if message["type"] == "error":
            raise SystemExit(f"FAILED {method}: {message['message']}")
        return message["result"]

    def _call(self, name, **content):
        if name == "Navigate":
            return self._navigate(content["url"])
        if name == "PerformActions":
            return self._send("input.performActions", context=self._context, **content)
        if name == "ExecuteScript":
            function = f"(function() {{{content['script']}}})"
            expression = f"JSON.stringify({function}.apply(window, {json.dumps(content['args'])}))"
            target = {"context": self._context}
            found = self._send("script.evaluate", expression=expression, target=target, awaitPromise=False)
            if found["type"] == "exception":
                raise SystemExit(f"FAILED {content['script']}: {found['exceptionDetails']['text']}")
            return json.loads(found["result"].get("value", "null"))
        method = {"TakeScreenshot": "captureScreenshot", "Print": "print"}[name]
        return self._send(f"browsingContext.{method}", context=self._context)["data"]

    def _navigate(self, url, seconds=120):
        """Loads a page and waits for it. Firefox can do both in one command, which now and then does not answer."""
        self._send("browsingContext.navigate", context=self._context, wait="none", url=url)
        end = time.monotonic() + seconds
        while True:
            with contextlib.suppress(SystemExit):  # Between two pages there is none to be asked.
                address, state = self.run("return [location.href, document.readyState]")
                if address.split("#")[0] == url.split("#")[0] and state == "complete":
                    return
            if time.monotonic() > end:
                raise SystemExit(f"FAILED waiting for {url}")
            time.sleep(0.02)

    def resize(self, width, height):
        size = {"width": width, "height": height}
        self._send("browsingContext.setViewport", context=self._context, viewport=size, devicePixelRatio=1)

    def log(self):
        """The errors of the page's scripts since the last call."""
        said, self._said = self._said, []
        return said


class WebSocket:
    """A connection to a program on this machine that exchanges texts (RFC 6455)."""

    def __init__(self, port, path):
        self._socket = socket.create_connection(("127.0.0.1", port), timeout=240)
        self._file = self._socket.makefile("rb")
        key = base64.b64encode(secrets.token_bytes(16)).decode()
        words = [f"GET {path} HTTP/1.1", f"Host: 127.0.0.1:{port}", "Upgrade: websocket", "Connection: Upgrade"]
        words += [f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13", "", ""]
        self._socket.sendall("\r\n".join(words).encode())
        while self._file.readline().strip():
            pass

    def send(self, text):
        data = text.encode()
        if len(data) < 126:
            length = bytes([128 + len(data)])
        elif len(data) < 1 << 16:
            length = bytes([128 + 126]) + len(data).to_bytes(2, "big")
        else:
            length = bytes([128 + 127]) + len(data).to_bytes(8, "big")
        mask = b"mask"  # Clients must have one; Firefox refuses zero.
        masked = bytes(byte ^ mask[i % 4] for i, byte in enumerate(data))
        self._socket.sendall(b"\x81" + length + mask + masked)  # a whole text

    def receive(self):
        text, last = b"", False
        while not last:
            head = self._file.read(2)
            if len(head) < 2:
                raise SystemExit("FAILED the browser has ended")
            last, size = head[0] >= 128, head[1]
            if size >= 126:
                size = int.from_bytes(self._file.read(2 if size == 126 else 8), "big")
            text += self._file.read(size)
        return text.decode()


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
        if os.environ.get("POLYRECON_BROWSER") == "firefox":
            yield start_firefox(stack, width, height, dark)
        else:
            yield start_chromium(stack, width, height, dark, wait)


def start_chromium(stack, width, height, dark, wait):
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
    window = Chromium(address, session)
    window.resize(width, height)
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    window.command("Emulation.setEmulatedMedia", features=[scheme])
    return window


def start_firefox(stack, width, height, dark):
    profile = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True)))
    # Without a screen Firefox has no WebGL2.
    screen = ["Xvfb", "-displayfd", "1", "-nolisten", "tcp", "-screen", "0", f"{width + 200}x{height + 300}x24"]
    server = subprocess.Popen(screen, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    stack.callback(server.wait)
    stack.callback(server.terminate)
    display = server.stdout.readline().strip()
    preferences = {
        "layout.css.prefers-color-scheme.content-override": 0 if dark else 1,
        "layout.css.devPixelsPerPx": "1.0",
        "webgl.force-enabled": True,
    }
    lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});\n" for name, value in preferences.items()]
    (profile / "user.js").write_text("".join(lines))
    firefox = subprocess.Popen(
        ["firefox-esr", "--remote-debugging-port=0", "--no-remote", "--profile", profile],
        env=dict(os.environ, DISPLAY=f":{display}", HOME=str(profile)),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    stack.callback(firefox.wait)
    stack.callback(firefox.terminate)
    server_file = profile / "WebDriverBiDiServer.json"
    while not (server_file.exists() and (text := server_file.read_text())):
        if firefox.poll() is not None:
            raise SystemExit("FAILED Firefox has ended")
        time.sleep(0.05)
    window = Firefox(json.loads(text)["ws_port"])
    window.resize(width, height)
    return window
