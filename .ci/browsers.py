"""Install the browsers in which the explorer is tested, where they are missing (Debian, Ubuntu)."""

import os
import shutil
import subprocess
import sys

WANTED = {"chromium": ("chromium", "google-chrome"), "firefox-esr": ("firefox", "firefox-esr")}

missing = [name for name, programs in WANTED.items() if not any(map(shutil.which, programs))]
if missing:
    if shutil.which("apt-get") is None:
        sys.exit(f"install {' and '.join(missing)}: there is no apt-get to do it")
    command = ["apt-get", "install", "--yes", "--no-install-recommends", *missing]
    before = [] if os.geteuid() == 0 else ["sudo"]
    subprocess.run([*before, *command], check=True)
