"""A headless Chromium that tests drive, over two pipes, so that nothing else is needed."""

from __future__ import annotations

import base64
import itertools
import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

PROGRAM = next(filter(None, map(shutil.which, ("chromium", "google-chrome", "chrome"))), None)
# Seconds after which a browser hangs, on the slowest machine.
PATIENCE = 300.0


class Chromium:
    """One page in a browser of its own; what it prints and asks the network for is kept."""

    def __init__(self, width: int = 1280, height: int = 900) -> None:
        to_browser, self._write = os.pipe()
        self._read, from_browser = os.pipe()
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run"]
        profile = f"--user-data-dir={self._profile.name}"
        # Chromium reads from descriptor 3 and writes to descriptor 4.
        pipes = f'exec 3<&{to_browser} 4>&{from_browser}; exec "$@"'
        command = [str(PROGRAM), *options, profile, "--remote-debugging-pipe", "about:blank"]
        self._process = subprocess.Popen(
            ["bash", "-c", pipes, "chromium", *command],
            pass_fds=(to_browser, from_browser),
            stderr=subprocess.DEVNULL,
        )
        os.close(to_browser)
        os.close(from_browser)
        self._rest = b""
        self._numbers = itertools.count(1)
        self._session: str | None = None
        self.console: list[str] = []
        self.requests: list[str] = []
        self._folder = Path(self._profile.name) / "saved"
        targets = self.send("Target.getTargets")["targetInfos"]
        target = next(it["targetId"] for it in targets if it["type"] == "page")
        attached = self.send("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")
        self.size(width, height)

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command and return its result; keeps what the page prints meanwhile."""
        number = next(self._numbers)
        message: dict[str, Any] = {"id": number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                result: dict[str, Any] = answer["result"]
                return result
            self._note(answer)

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._rest:
            more = os.read(self._read, 1 << 20)
            if not more:
                raise RuntimeError("the browser has ended")
            self._rest += more
        text, _, self._rest = self._rest.partition(b"\0")
        message: dict[str, Any] = json.loads(text)
        return message

    def _note(self, event: dict[str, Any]) -> None:
        told = event.get("params", {})
        match event.get("method"):
            case "Runtime.consoleAPICalled":
                said = [str(it.get("value", it.get("description"))) for it in told["args"]]
                self.console.append(" ".join([told["type"], *said]))
            case "Runtime.exceptionThrown":
                details = told["exceptionDetails"]
                self.console.append(
                    details.get("exception", details).get("description", details["text"])
                )
            case "Log.entryAdded":
                self.console.append(told["entry"]["text"])
            case "Network.requestWillBeSent":
                self.requests.append(told["request"]["url"])

    def size(self, width: int, height: int, *, mobile: bool = False) -> None:
        """Give the window a size."""
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": mobile}
        self.send("Emulation.setDeviceMetricsOverride", **metrics)

    def theme(self, name: str) -> None:
        """Prefer a dark or a light theme."""
        self.send(
            "Emulation.setEmulatedMedia",
            features=[{"name": "prefers-color-scheme", "value": name}],
        )

    def open(self, address: str) -> None:
        """Load a page and wait until its first scene is drawn."""
        self.send("Page.navigate", url="about:blank")
        self.send("Page.navigate", url=address)
        self.wait("document.querySelector('.iva-explorer .foot')?.textContent")

    def wait(self, expression: str, seconds: float = PATIENCE) -> Any:
        """Wait until an expression is true, and return it."""
        until = time.monotonic() + seconds
        while not (value := self.value(expression)):
            if time.monotonic() > until:
                raise TimeoutError(f"{expression} did not become true; console: {self.console}")
            time.sleep(0.05)
        return value

    def value(self, expression: str) -> Any:
        """Return the value of an expression, awaited."""
        answer = self.send(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise RuntimeError(details.get("exception", details).get("description", details))
        return answer["result"].get("value")

    def box(self, selector: str) -> dict[str, float]:
        """Return middle and size of an element on the screen."""
        found: dict[str, float] = self.value(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)});"
            "e.scrollIntoView({block: 'center'}); const b = e.getBoundingClientRect();"
            "return {x: b.x + b.width / 2, y: b.y + b.height / 2, width: b.width, height: b.height}"
            "})()"
        )
        return found

    def mouse(self, kind: str, x: float, y: float, *, pressed: bool = True) -> None:
        """Send one event of the mouse."""
        self.send(
            "Input.dispatchMouseEvent",
            type=kind, x=x, y=y, button="left", buttons=int(pressed), clickCount=1,
        )  # fmt: skip

    def drag(
        self, selector: str, right: float, down: float = 0.0, *, below: float = 0.0, steps: int = 6
    ) -> None:
        """Drag an element by so many pixels, from its middle or a share of its height below."""
        at = self.box(selector)
        at["y"] += below * at["height"]
        self.mouse("mousePressed", at["x"], at["y"])
        for step in range(1, steps + 1):
            share = step / steps
            self.mouse("mouseMoved", at["x"] + right * share, at["y"] + down * share)
        self.mouse("mouseReleased", at["x"] + right, at["y"] + down, pressed=False)

    def click(self, selector: str) -> None:
        """Click on an element."""
        at = self.box(selector)
        self.mouse("mousePressed", at["x"], at["y"])
        self.mouse("mouseReleased", at["x"], at["y"], pressed=False)

    def key(self, key: str, *, control: bool = False) -> None:
        """Press a key and let it go."""
        for kind in ("keyDown", "keyUp"):
            self.send("Input.dispatchKeyEvent", type=kind, key=key, code=key, modifiers=2 * control)

    def type(self, text: str) -> None:
        """Type a text where the caret is."""
        self.send("Input.insertText", text=text)

    def saved(self, name: str, seconds: float = PATIENCE) -> bytes:
        """Wait for a file that the page saves, and return it. Call :meth:`keep_files` before."""
        until = time.monotonic() + seconds
        file = self._folder / name
        while not (file.exists() and file.stat().st_size):
            if time.monotonic() > until:
                raise TimeoutError(f"{name} was not saved")
            time.sleep(0.05)
            self.value("0")
        return file.read_bytes()

    def keep_files(self) -> None:
        """Put what the page saves into a folder of the test."""
        self._folder.mkdir(exist_ok=True)
        self.send("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(self._folder))

    def picture(self, path: Path, *, whole: bool = False) -> None:
        """Write a picture of the page."""
        options: dict[str, Any] = {"captureBeyondViewport": whole}
        if whole:
            content = self.send("Page.getLayoutMetrics")["cssContentSize"]
            options["clip"] = {**content, "scale": 1}
        shot = self.send("Page.captureScreenshot", **options)
        path.write_bytes(base64.b64decode(shot["data"]))

    def close(self) -> None:
        """End the browser."""
        self._process.terminate()
        self._process.wait(timeout=PATIENCE)
        os.close(self._write)
        os.close(self._read)
        self._profile.cleanup()
