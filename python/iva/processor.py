"""What the compiled part needs of a processor, checked before it is loaded.

On x86-64 that is the level x86-64-v3 (AVX2 and the fused multiply-add), as polars needs it too. A
machine without it would end the process at the first such instruction, without a word.
"""

import sys

NEEDS = "iva needs a processor with AVX2 and FMA (x86-64-v3: Intel since 2013, AMD since 2015)"
FLAGS = frozenset({"abm", "avx2", "bmi1", "bmi2", "f16c", "fma", "movbe"})  # as Linux names them


def lacking(cpuinfo: str) -> list[str]:
    """Return the flags that the first processor of Linux' list does not have, in order.

    Examples
    --------
    >>> lacking("flags : avx avx2 fma")
    ['abm', 'bmi1', 'bmi2', 'f16c', 'movbe']
    """
    for line in cpuinfo.splitlines():
        if line.startswith("flags"):
            return sorted(FLAGS.difference(line.split()))
    return []  # not told


def found_lacking() -> list[str]:
    """Return what is missing of this machine; nothing where the system does not tell."""
    if sys.platform == "linux":
        import os

        if os.uname().machine != "x86_64":
            return []
        try:
            with open("/proc/cpuinfo", encoding="utf-8") as file:  # noqa: PTH123 - pathlib is slow
                return lacking(file.read(8192))  # of a list that may be long
        except OSError:
            return []
    if sys.platform == "win32":
        import ctypes
        import os

        if os.environ.get("PROCESSOR_ARCHITECTURE") != "AMD64":
            return []
        avx2 = 40  # PF_AVX2_INSTRUCTIONS_AVAILABLE
        return [] if ctypes.windll.kernel32.IsProcessorFeaturePresent(avx2) else ["avx2"]
    if sys.platform == "darwin":
        import ctypes
        import os

        if os.uname().machine != "x86_64":
            return []
        value = ctypes.c_int(1)
        size = ctypes.c_size_t(ctypes.sizeof(value))
        name = b"hw.optional.avx2_0"
        ctypes.CDLL(None).sysctlbyname(name, ctypes.byref(value), ctypes.byref(size), None, 0)
        return [] if value.value else ["avx2"]
    return []


def require() -> None:
    """Check this machine.

    Raises
    ------
    ImportError
        With one sentence; the command ``iva`` ends with that sentence alone.
    """
    if missing := found_lacking():
        sentence = f"{NEEDS}; this one lacks {', '.join(missing)}"
        # The command's script imports this package before any line of ours could catch an error.
        name = sys.argv[0].replace("\\", "/").rpartition("/")[2] if sys.argv else ""
        if name in ("iva", "iva.exe"):
            sys.exit(sentence)
        raise ImportError(sentence)
