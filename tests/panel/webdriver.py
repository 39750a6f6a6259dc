"""Controls Chromium with Selenium."""

import base64
import contextlib
import os
import pathlib

from selenium import webdriver
from selenium.common.exceptions import WebDriverException
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from simulator import HANG

AXE = pathlib.Path(__file__).resolve().parents[2] / "build/axe/node_modules/axe-core/axe.min.js"
SCRIPT = 10 * HANG  # seconds; axe-core takes more than a minute on a page of 64 modules if the machine is busy
KEYS = {"Tab": Keys.TAB, "Enter": Keys.ENTER, "Space": Keys.SPACE, "Shift": Keys.SHIFT, "Alt": Keys.ALT,
        "Left": Keys.LEFT, "Right": Keys.RIGHT}


def started(options):
    """Starts ChromeDriver and Chromium. Another program can take the port that Selenium has chosen for ChromeDriver; it
    then gets another chance."""
    for _ in range(9):
        with contextlib.suppress(WebDriverException):
            return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


class Browser:
    """Chromium without a display. Only one thread at a time may use a Browser object."""

    def __init__(self):
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        for argument in ("--headless=new", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
                         "--disable-extensions", "--disable-background-networking", "--disable-component-update",
                         "--disable-sync", "--hide-scrollbars", "--force-device-scale-factor=1"):
            options.add_argument(argument)
        if os.geteuid() == 0:
            options.add_argument("--no-sandbox")  # the sandbox does not work for root
        self._driver = started(options)
        self._driver.set_script_timeout(SCRIPT)  # only detects a hang; `until` has its own timeout
        self._driver.command_executor.set_timeout(SCRIPT + 20)
        self.close = self._driver.quit
        self.open = self._driver.get

    def run(self, script, *arguments):
        """Runs `script` as the body of a function and returns its result."""
        return self._driver.execute_script(script, *arguments)

    def promised(self, script, *arguments):
        """Runs `script` as the body of an async function and returns its result."""
        text = (
            "const done = arguments[arguments.length - 1];"
            f"(async () => {{ {script} }})().then(done, (error) => done('error: ' + error));"
        )
        value = self._driver.execute_async_script(text, *arguments)
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
        return self._driver.find_element(By.CSS_SELECTOR, selector)

    def click(self, selector):
        self.find(selector).click()

    def type(self, selector, text):
        self.find(selector).send_keys(text)

    def actions(self):
        return ActionChains(self._driver, duration=0)

    def pointer(self, *actions):
        """Performs actions of the mouse. Each is "down", "up", or the selector of an element to move to."""
        mouse = self.actions()
        for action in actions:
            if action == "down":
                mouse.click_and_hold()
            elif action == "up":
                mouse.release()
            else:
                mouse.move_to_element(self.find(action))
        mouse.perform()

    def drag(self, selector, pixels):
        """Drags from the middle of the element by `pixels` to the right, or to the left if `pixels` is negative."""
        self.actions().drag_and_drop_by_offset(self.find(selector), pixels, 0).perform()

    def touch(self, kind, *at):
        """Sends a touch event. `kind` is "start", "move", "end" or "cancel". If `kind` is "start" or "move", `at` is
        x and y in the viewport, in pixels; otherwise `at` is empty."""
        points = [{"x": at[0], "y": at[1]}] if at else []
        self.devtools("Input.dispatchTouchEvent", type=f"touch{kind.capitalize()}", touchPoints=points)

    def key(self, *actions):
        """Presses and releases keys. Each action is a name from KEYS. With the prefix +, the key is only pressed; with
        the prefix -, it is only released."""
        keys = self.actions()
        for action in actions:
            if action[0] != "-":
                keys.key_down(KEYS[action.lstrip("+")])
            if action[0] != "+":
                keys.key_up(KEYS[action.lstrip("-")])
        keys.perform()

    def devtools(self, command, **parameters):
        return self._driver.execute_cdp_cmd(command, parameters)

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
        said = self._driver.get_log("browser")
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
