"""Controls a browser over the WebDriver protocol."""

import base64
import contextlib
import json
import os
import pathlib
import re
import subprocess
import tempfile
import urllib.error
import urllib.request

from simulator import HANG

AXE = pathlib.Path(__file__).resolve().parents[2] / "build/axe/node_modules/axe-core/axe.min.js"
SCRIPT = 10 * HANG  # seconds; axe-core takes more than a minute on a page of 64 modules if the machine is busy
ELEMENT = "element-6066-11e4-a52e-4f735466cecf"
KEYS = {"Tab": "\ue004", "Enter": "\ue007", "Space": " ", "Shift": "\ue008", "Alt": "\ue00a", "Left": "\ue012",
        "Right": "\ue014"}


def started(driver):
    """Starts ChromeDriver. Returns its process and its port. ChromeDriver ends if the port that it has chosen for IPv4
    is in use for IPv6; it then gets another chance."""
    said = ""
    for _ in range(10):
        process = subprocess.Popen([driver, "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        for line in process.stdout:
            said += line
            port = re.search(r"started successfully on port (\d+)", line)
            if port:
                return process, port.group(1)
        process.stdout.close()
        process.wait()
    raise RuntimeError(f"{driver}: does not start: {said}")


class Browser:
    """Chromium without a display. Only one thread at a time may use a Browser object."""

    def __init__(self, driver="chromedriver", browser="/usr/bin/chromium"):
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self._driver, port = started(driver)
        self._base = f"http://127.0.0.1:{port}/session"
        arguments = [
            "--headless=new", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
            "--disable-extensions", "--disable-background-networking", "--disable-component-update",
            "--disable-sync", "--hide-scrollbars", "--force-device-scale-factor=1",
            f"--user-data-dir={self._profile.name}",
        ]
        if os.geteuid() == 0:
            arguments.append("--no-sandbox")  # the sandbox does not work for root
        options = {
            "goog:chromeOptions": {"args": arguments, "binary": browser},
            "goog:loggingPrefs": {"browser": "ALL"},
        }
        session = self._post("", {"capabilities": {"alwaysMatch": options}})
        self._base += "/" + session["sessionId"]
        self._post("/timeouts", {"script": 1000 * SCRIPT})  # only detects a hang; `until` has its own timeout

    def close(self):
        try:
            self._send("DELETE", "")
        finally:
            self._driver.terminate()
            self._driver.wait()
            self._driver.stdout.close()
            self._profile.cleanup()

    def _send(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(
            self._base + path, data, {"Content-Type": "application/json"}, method=method
        )
        try:
            with urllib.request.urlopen(request, timeout=SCRIPT + 20) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(json.load(error)["value"]["message"]) from None

    def _post(self, path, body):
        return self._send("POST", path, body)

    def open(self, address):
        self._post("/url", {"url": address})

    def run(self, script, *arguments):
        """Runs `script` as the body of a function and returns its result."""
        return self._post("/execute/sync", {"script": script, "args": list(arguments)})

    def promised(self, script, *arguments):
        """Runs `script` as the body of an async function and returns its result."""
        text = (
            "const done = arguments[arguments.length - 1];"
            f"(async () => {{ {script} }})().then(done, (error) => done('error: ' + error));"
        )
        value = self._post("/execute/async", {"script": text, "args": list(arguments)})
        assert not str(value).startswith("error: "), value
        return value

    def until(self, condition, *arguments):
        """Evaluates the expression `condition` in the page until it is true. Fails after HANG seconds."""
        script = f"""
            const given = arguments;
            const holds = () => {{ try {{ return ({condition}); }} catch (error) {{ return false; }} }};
            const gives_up = performance.now() + {1000 * HANG};
            while (!holds()) {{
              if (performance.now() > gives_up) {{ return false; }}
              await new Promise((go_on) => setTimeout(go_on, 10)); // lets the page receive messages
            }}
            return true;"""
        assert self.promised(script, *arguments), f"timeout: not true within {HANG} s: {condition} {arguments}"

    def find(self, selector):
        return self._post("/element", {"using": "css selector", "value": selector})[ELEMENT]

    def click(self, selector):
        self._post(f"/element/{self.find(selector)}/click", {})

    def type(self, selector, text):
        self._post(f"/element/{self.find(selector)}/value", {"text": text})

    def pointer(self, *actions):
        """Performs actions of the mouse. Each is "down", "up", or the selector of an element to move to."""
        moves = [
            {"type": f"pointer{action.capitalize()}", "button": 0}
            if action in ("down", "up")
            else {"type": "pointerMove", "x": 0, "y": 0, "origin": {ELEMENT: self.find(action)}}
            for action in actions
        ]
        self._post("/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": moves}]})

    def drag(self, selector, pixels):
        """Drags from the middle of the element by `pixels` to the right, or to the left if `pixels` is negative."""
        origin = {ELEMENT: self.find(selector)}
        self._post("/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [
            {"type": "pointerMove", "x": 0, "y": 0, "origin": origin},
            {"type": "pointerDown", "button": 0},
            {"type": "pointerMove", "x": pixels, "y": 0, "origin": origin},
            {"type": "pointerUp", "button": 0},
        ]}]})

    def touch(self, kind, *at):
        """Sends a touch event. `kind` is "start", "move", "end" or "cancel". If `kind` is "start" or "move", `at` is
        x and y in the viewport, in pixels; otherwise `at` is empty."""
        points = [{"x": at[0], "y": at[1]}] if at else []
        self.devtools("Input.dispatchTouchEvent", type=f"touch{kind.capitalize()}", touchPoints=points)

    def key(self, *actions):
        """Presses and releases keys. Each action is a name from KEYS. With the prefix +, the key is only pressed; with
        the prefix -, it is only released."""
        moves = []
        for action in actions:
            if action[0] != "-":
                moves.append({"type": "keyDown", "value": KEYS[action.lstrip("+")]})
            if action[0] != "+":
                moves.append({"type": "keyUp", "value": KEYS[action.lstrip("-")]})
        self._post("/actions", {"actions": [{"type": "key", "id": "keyboard", "actions": moves}]})

    def devtools(self, command, **parameters):
        return self._post("/goog/cdp/execute", {"cmd": command, "params": parameters})

    def size(self, width, height, phone=False):
        self.devtools(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone
        )

    def prefers(self, **features):
        """Sets media features whose names begin with prefers-. For example, color_scheme="dark" sets
        prefers-color-scheme to dark. Ends the emulation of all other media features."""
        media = [{"name": "prefers-" + name.replace("_", "-"), "value": value} for name, value in features.items()]
        self.devtools("Emulation.setEmulatedMedia", features=media)

    @contextlib.contextmanager
    def patient(self):
        """Pages that are opened in the `with` block run each timer of a second or more a thousand times later."""
        script = self.devtools("Page.addScriptToEvaluateOnNewDocument", source="""
            const usual = window.setTimeout;
            window.setTimeout = (run, delay, ...rest) => usual(run, delay < 1000 ? delay : 1000 * delay, ...rest);""")
        try:
            yield
        finally:
            self.devtools("Page.removeScriptToEvaluateOnNewDocument", identifier=script["identifier"])

    def logged_errors(self):
        """Returns the messages that the browser has logged since the previous call, at all levels. Omits messages about
        failed connections, and messages that begin with chrome://, because pages of the browser itself log these."""
        nobody = ("ERR_CONNECTION_REFUSED", "ERR_CONNECTION_RESET", "closed before the connection is established")
        said = self._post("/se/log", {"type": "browser"})
        messages = [each["message"] for each in said if not each["message"].startswith("chrome://")]
        return [message for message in messages if not any(text in message for text in nobody)]

    def violations(self):
        """Returns the violations that axe-core finds in the page: the rule, the problem, and up to three elements."""
        self.run(AXE.read_text(encoding="utf-8") + "; window.axe = axe;")
        found = self.promised("""
            const rules = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"];
            const {violations} = await axe.run(document, {runOnly: rules, resultTypes: ["violations"]});
            return violations.map(({id, help, nodes}) =>
              `${id}: ${help}: ${nodes.slice(0, 3).map((node) => node.target.join(" ")).join(", ")}`)""")
        return found

    def screenshot(self, path, whole=False):
        picture = self.devtools("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(base64.b64decode(picture["data"]))
