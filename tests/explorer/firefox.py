"""A headless Firefox that tests drive by its own protocol, Marionette, over a socket."""

from __future__ import annotations

import json
import shutil
import socket
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

PROGRAM = next(filter(None, map(shutil.which, ("firefox", "firefox-esr"))), None)
# Seconds after which a browser hangs, on the slowest machine.
PATIENCE = 300.0


class Firefox:
    """One page in a browser of its own."""

    def __init__(self) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        preferences = f'user_pref("marionette.port", {port});\n'
        (Path(self._profile.name) / "user.js").write_text(preferences, encoding="utf-8")
        self._process = subprocess.Popen(
            [str(PROGRAM), "--headless", "--marionette", "--profile", self._profile.name],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._number = 0
        self._rest = b""
        self._socket = self._connected(port)
        self._message()  # what the browser is
        self.send("WebDriver:NewSession")

    def _connected(self, port: int) -> socket.socket:
        until = time.monotonic() + PATIENCE
        while True:
            try:
                return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
            except OSError:
                if time.monotonic() > until:
                    raise
                time.sleep(0.2)

    def _message(self) -> Any:
        """Return the next message: its length, a colon, and so many bytes of JSON."""
        while b":" not in self._rest:
            self._rest += self._socket.recv(1 << 16)
        length, _, self._rest = self._rest.partition(b":")
        while len(self._rest) < int(length):
            self._rest += self._socket.recv(1 << 16)
        text, self._rest = self._rest[: int(length)], self._rest[int(length) :]
        return json.loads(text)

    def send(self, command: str, **parameters: Any) -> Any:
        """Send a command and return its result."""
        self._number += 1
        text = json.dumps([0, self._number, command, parameters]).encode()
        self._socket.sendall(f"{len(text)}:".encode() + text)
        _, _, error, result = self._message()
        if error:
            raise RuntimeError(f"{command}: {error['message']}")
        return result

    def open(self, address: str) -> None:
        """Load a page and wait until its first scene is drawn."""
        self.send("WebDriver:Navigate", url=address)
        self.wait("document.querySelector('.iva-explorer .foot')?.textContent")

    def value(self, expression: str) -> Any:
        """Return the value of an expression."""
        return self.send("WebDriver:ExecuteScript", script=f"return {expression}", args=[])["value"]

    def wait(self, expression: str, seconds: float = PATIENCE) -> Any:
        """Wait until an expression is true, and return it."""
        until = time.monotonic() + seconds
        while not (value := self.value(expression)):
            if time.monotonic() > until:
                raise TimeoutError(f"{expression} did not become true")
            time.sleep(0.05)
        return value

    def close(self) -> None:
        """End the browser."""
        self._socket.close()
        self._process.terminate()
        self._process.wait(timeout=PATIENCE)
        self._profile.cleanup()
