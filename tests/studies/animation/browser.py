"""Chromium without a display, told what to do over a pipe (the DevTools protocol), so that pages are really run."""

import json
import os
import shutil
import subprocess
import sys

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
PATIENCE = 60.0  # seconds without an answer
# Chromium reads from 3 and writes to 4, numbers that may be taken in this process.
PLACE = """
import os, sys
told, heard = (os.dup(os.dup(os.dup(int(n)))) for n in sys.argv[1:3])
os.dup2(told, 3)
os.dup2(heard, 4)
os.execv(sys.argv[3], sys.argv[3:])
"""


class Browser:
    """One page of a browser; `open` loads a file, `run` evaluates JavaScript there and waits for promises."""

    def __init__(self, profile):
        told, tell = os.pipe()
        hear, heard = os.pipe()
        self.process = subprocess.Popen(
            [
                sys.executable, "-c", PLACE, str(told), str(heard), CHROMIUM, "--headless", "--no-sandbox",
                "--disable-gpu", "--remote-debugging-pipe", f"--user-data-dir={profile}", "about:blank",
            ],
            pass_fds=(told, heard), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(told)
        os.close(heard)
        self.tell, self.hear = os.fdopen(tell, "wb", 0), os.fdopen(hear, "rb", 0)
        self.number, self.rest, self.session = 0, b"", None
        self.events = []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network"):
            self.call(f"{domain}.enable")

    def close(self):
        self.tell.close()
        self.hear.close()
        self.process.terminate()
        self.process.wait(PATIENCE)

    def _next(self):
        while b"\0" not in self.rest:
            piece = self.hear.read(1 << 16)
            if not piece:
                raise RuntimeError("the browser went away")
            self.rest += piece
        message, _, self.rest = self.rest.partition(b"\0")
        return json.loads(message)

    def call(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        self.tell.write(json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self.number:
                assert "error" not in answer, answer
                return answer["result"]
            if "method" in answer:
                self.events.append(answer)

    def open(self, address, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        # An address that differs in its fragment alone would not be loaded anew.
        for page in ("about:blank", address):
            self.events.clear()
            self.call("Page.navigate", url=page)
            while not any(event["method"] == "Page.loadEventFired" for event in self.events):
                event = self._next()
                if "method" in event:
                    self.events.append(event)

    def run(self, script):
        """The value of the body of an async function, as JSON."""
        asked = f"(async () => {{ {script} }})()"
        answer = self.call("Runtime.evaluate", expression=asked, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def press(self, key, shift=False):
        """A key of the keyboard."""
        more = {"text": key} if len(key) == 1 else {}
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, modifiers=8 if shift else 0, **more)

    def click(self, x, y):
        """The mouse at a place of the window [pixel]."""
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)

    def screenshot(self, path):
        import base64

        path.write_bytes(base64.b64decode(self.call("Page.captureScreenshot", captureBeyondViewport=True)["data"]))

    @property
    def errors(self):
        """Exceptions of the page since it was opened."""
        return [event["params"] for event in self.events if event["method"] == "Runtime.exceptionThrown"]

    @property
    def asked_for(self):
        """Addresses that the page has fetched since it was opened."""
        sent = [event for event in self.events if event["method"] == "Network.requestWillBeSent"]
        return [event["params"]["request"]["url"] for event in sent]
