"""Debian's Firefox without a window, driven through Marionette, its own protocol: no driver, no package."""

from __future__ import annotations

import json
import socket
import subprocess
import time
from base64 import b64decode
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

FIREFOX = Path("/usr/bin/firefox-esr")

# a port of its own choice; nothing is asked of a network
PREFERENCES = {
    "marionette.port": 0,
    "app.normandy.enabled": False,
    "browser.startup.page": 0,
    "datareporting.policy.dataSubmissionEnabled": False,
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
    "services.settings.server": "data:,#",
    "toolkit.telemetry.enabled": False,
}
HEARD = """
    const all = Services.console.getMessageArray();
    Services.console.reset();
    return all
        .filter((each) => each instanceof Ci.nsIScriptError && /^file:/.test(each.sourceName))
        .map((each) => each.errorMessage);
"""


class Firefox:
    """One window; ``open`` a file, ``run`` a script in it, ``press`` keys; close it by ``with``."""

    def __init__(self, preferences: Mapping[str, object] = PREFERENCES) -> None:
        self.preferences = preferences

    def __enter__(self) -> Firefox:
        self._folder = TemporaryDirectory(ignore_cleanup_errors=True)
        folder = Path(self._folder.name)
        lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});" for name, value in self.preferences.items()]
        folder.joinpath("user.js").write_text("\n".join(lines), encoding="utf-8")
        command = [FIREFOX, "--headless", "--marionette", "--remote-allow-system-access", "--profile", folder]
        self._process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self._socket = socket.create_connection(("127.0.0.1", self._port(folder)), timeout=120)
        self._file, self._number = self._socket.makefile("rb"), 0
        self._answer()  # its greeting
        self.send("WebDriver:NewSession", {"capabilities": {"alwaysMatch": {"timeouts": {"script": 120_000}}}})
        return self

    def __exit__(self, *_: object) -> None:
        self._process.terminate()
        self._process.wait(60)
        self._file.close()
        self._socket.close()
        self._folder.cleanup()

    def _port(self, folder: Path) -> int:
        """Port that Firefox has taken, which it writes into its profile."""
        until = time.monotonic() + 60
        while time.monotonic() < until and self._process.poll() is None:
            if (file := folder / "MarionetteActivePort").exists() and (text := file.read_text()):
                return int(text)
            time.sleep(0.1)
        raise TimeoutError("Firefox does not start")

    def _answer(self) -> Any:
        size = b""
        while not size.endswith(b":"):
            size += self._file.read(1)
        return json.loads(self._file.read(int(size[:-1])))

    def send(self, command: str, parameters: dict[str, Any] | None = None) -> Any:
        """Answer of a command of Marionette; RuntimeError with its message where it failed."""
        self._number += 1
        text = json.dumps([0, self._number, command, parameters or {}]).encode()
        self._socket.sendall(f"{len(text)}:".encode() + text)
        _, _, fault, found = self._answer()
        if fault:
            raise RuntimeError(f"{fault['error']}: {fault['message']}")
        return found.get("value", found) if isinstance(found, dict) else found

    def open(self, address: str) -> None:
        """The page at an address, loaded."""
        self.send("WebDriver:Navigate", {"url": address})

    def run(self, script: str, *given: Any) -> Any:
        """What the body of an async function returns in the page; ``arguments`` in it are what is given."""
        whole = f"return (async (...arguments_) => {{ {script} }})(...arguments);".replace("arguments_", "given")
        return self.send("WebDriver:ExecuteScript", {"script": whole, "args": list(given), "sandbox": None})

    def press(self, selector: str, keys: str) -> None:
        """Keys sent to an element; WebDriver's codes for others than letters (right arrow: U+E014)."""
        found = self.send("WebDriver:FindElement", {"using": "css selector", "value": selector})
        self.send("WebDriver:ElementSendKeys", {"id": next(iter(found.values())), "text": keys})

    def heard(self) -> list[str]:
        """Errors of pages opened from files since it was last asked, and what their policy refused."""
        self.send("Marionette:SetContext", {"value": "chrome"})
        try:
            return self.send("WebDriver:ExecuteScript", {"script": HEARD, "args": []})
        finally:
            self.send("Marionette:SetContext", {"value": "content"})

    def picture(self) -> bytes:
        """The window as PNG."""
        return b64decode(self.send("WebDriver:TakeScreenshot", {"full": False}))
