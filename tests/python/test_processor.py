"""What the compiled part needs of a processor: levels as the x86-64 psABI defines them.

The flags are those of x86-64-v3, by the names that Linux gives them (``abm`` is LZCNT).
"""

from __future__ import annotations

import sys

import pytest

from iva import processor

V2 = "flags\t\t: fpu sse sse2 ssse3 sse4_1 sse4_2 popcnt cx16 lahf_lm"
V3 = f"{V2} abm avx avx2 bmi1 bmi2 f16c fma movbe xsave"


def test_flags_of_the_level_are_found() -> None:
    assert processor.lacking(f"processor\t: 0\n{V3}\n") == []
    assert processor.lacking(f"processor\t: 0\n{V2} avx abm\n{V3}\n") == [
        "avx2",
        "bmi1",
        "bmi2",
        "f16c",
        "fma",
        "movbe",
    ]
    assert processor.lacking("processor\t: 0\nFeatures\t: fp asimd\n") == []


def test_this_machine_lacks_nothing() -> None:
    """It runs the compiled part, so it has what that needs."""
    assert processor.found_lacking() == []
    processor.require()


@pytest.mark.parametrize(
    ("command", "kind"),
    [
        ("/usr/bin/iva", SystemExit),
        ("C:\\Scripts\\iva.exe", SystemExit),
        ("model.py", ImportError),
        ("", ImportError),
    ],
)
def test_what_is_missing_is_one_sentence(
    monkeypatch: pytest.MonkeyPatch, command: str, kind: type[BaseException]
) -> None:
    monkeypatch.setattr(processor, "found_lacking", lambda: ["avx2", "fma"])
    monkeypatch.setattr(sys, "argv", [command])
    with pytest.raises(kind) as caught:
        processor.require()
    said = str(caught.value)
    assert said.startswith("iva needs a processor with AVX2 and FMA")
    assert said.endswith("this one lacks avx2, fma")
    assert "\n" not in said
