"""The compiled half of `iva`."""

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Final, final

__all__ = [
    "SCHEMA_VERSION",
    "VERSION",
    "ArrowTable",
    "IvaError",
    "Record",
    "Study",
    "SweepFolder",
    "attractors",
    "basins",
    "check",
    "check_choices",
    "check_files",
    "check_restitution_table",
    "column_units",
    "copy_examples",
    "curve",
    "design",
    "diagram",
    "doubts",
    "empty_tables",
    "example_names",
    "fields",
    "follow",
    "gradients",
    "in_range",
    "kind_of_file",
    "larger_is_better",
    "lyapunov",
    "main",
    "masri_caughey",
    "metadata",
    "modes",
    "on_slow_manifold",
    "optimised_scene",
    "orbit",
    "orbit_at",
    "primary_units",
    "read_record",
    "read_table",
    "sampled",
    "scene_of_study",
    "simulate",
    "slow_manifold",
    "state",
    "state_of_modes",
    "states",
    "sweep_into",
    "switch",
    "trajectory",
    "unit_system",
    "verdict_on_contacts",
    "verify",
    "visible",
]

SCHEMA_VERSION: Final[int]
VERSION: Final[str]

_Spec = dict[str, Any]
_Chain = tuple[Sequence[int], Sequence[bool], bool, int]
_Point = tuple[_Chain, tuple[str, int, int], float, Sequence[float]]
_Steps = tuple[tuple[float, float], float, int]
_Range = tuple[float, float]
_Progress = Callable[[int, int, int], object]
_Starts = tuple[int, int, Sequence[_Range] | None, bool]

class IvaError(RuntimeError): ...

@final
class ArrowTable:
    @property
    def metadata(self) -> dict[str, str]: ...
    @property
    def units(self) -> dict[str, str]: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...

@final
class Record:
    def __new__(
        cls, times: Sequence[float], values: Sequence[float], kind: str, is_metric: bool = False
    ) -> Record: ...
    @property
    def times(self) -> list[float]: ...
    @property
    def values(self) -> list[float]: ...
    @property
    def kind(self) -> str: ...
    @property
    def is_metric(self) -> bool: ...
    def __eq__(self, value: object, /) -> bool: ...
    def __reduce__(
        self,
    ) -> tuple[type[Record], tuple[list[float], list[float], str, bool]]: ...

@final
class Study:
    def __new__(
        cls,
        spec: _Spec,
        sampling: tuple[Any, ...],
        tables: Sequence[str],
        measures: Sequence[str] | None = None,
        errors: bool = False,
        whole: tuple[int, int] | None = None,
    ) -> Study: ...
    @property
    def points(self) -> int: ...
    @property
    def swept(self) -> list[str]: ...
    def run(
        self,
        threads: int | None = None,
        progress: _Progress | None = None,
        memory_limit: float | None = None,
    ) -> dict[str, ArrowTable]: ...
    def part(self, first: int, last: int) -> Study: ...
    def part_points(self, memory_limit: float | None = None) -> int: ...
    def values(self, first: int, last: int) -> list[tuple[str, list[float]]]: ...
    def scene(self, point: int) -> _Spec: ...
    def run_points(self, first: int, last: int) -> dict[str, ArrowTable]: ...
    def run_part(self, first: int, last: int, folder: str | PathLike[str], style: str) -> str: ...
    def __reduce__(self) -> tuple[type[Study], tuple[Any, ...]]: ...

@final
class SweepFolder:
    @staticmethod
    def open(
        study: Study,
        folder: str | PathLike[str],
        style: str,
        resume: bool,
        overwrite: bool,
        elsewhere: bool = False,
    ) -> tuple[SweepFolder, list[str]]: ...
    @property
    def missing(self) -> list[tuple[int, int, int]]: ...
    @property
    def done(self) -> tuple[int, int]: ...
    @property
    def work(self) -> Path: ...
    def take(self, part: int, staged: str) -> None: ...
    def enter(self, part: int, staged: str) -> None: ...
    def close(self) -> None: ...
    def abandon(self) -> str: ...

def sweep_into(
    study: Study,
    folder: str | PathLike[str],
    style: str,
    resume: bool,
    overwrite: bool,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> list[str]: ...
def read_record(path: str | PathLike[str], kind: str | None = None) -> Record: ...
def kind_of_file(contents: bytes) -> str | None: ...
def fields(part: str, kind: str) -> list[tuple[str, str, str]]: ...
def check(part: str, values: Sequence[tuple[str, float]]) -> None: ...
def primary_units(spec: _Spec) -> str: ...
def unit_system(spec: _Spec) -> str: ...
def design(spec: _Spec, absorber: int = 0) -> dict[str, Any]: ...
def modes(
    entries: dict[str, Any],
) -> tuple[list[tuple[float, float]], list[tuple[str, list[float]]], bool]: ...
def check_restitution_table(
    points: Sequence[Sequence[float]], values: Sequence[tuple[str, float]]
) -> None: ...
def check_choices(words: Sequence[tuple[str, str]]) -> None: ...
def column_units(system: str, swept: Sequence[str]) -> tuple[str, dict[str, dict[str, str]]]: ...
def doubts(spec: _Spec, sampling: tuple[Any, ...] | None = None) -> list[str]: ...
def verdict_on_contacts(spec: _Spec, times: list[float], absorbers: list[int]) -> str | None: ...
def simulate(
    spec: _Spec,
    measures: Sequence[str] | None = None,
    tables: Sequence[str] | None = None,
    errors: bool = False,
) -> dict[str, ArrowTable]: ...
def verify(
    spec: _Spec,
    measures: Sequence[str] | None = None,
    tables: Sequence[str] | None = None,
) -> tuple[dict[str, ArrowTable], list[tuple[str, int, int, int, float | None, str | None]]]: ...
def gradients(
    spec: _Spec,
    key: str,
    measures: Sequence[str] | None = None,
    tables: Sequence[str] | None = None,
) -> dict[str, ArrowTable]: ...
def trajectory(spec: _Spec, samples_per_period: int) -> ArrowTable: ...
def state(spec: _Spec, time: float) -> ArrowTable: ...
def state_of_modes(spec: _Spec, time: float) -> list[list[float]] | None: ...
def states(spec: _Spec, times: Sequence[float]) -> ArrowTable: ...
def masri_caughey(spec: _Spec) -> dict[str, Any]: ...
def orbit(
    spec: _Spec, periods: int, symmetric: bool | None, settle: int, verify: bool
) -> dict[str, Any]: ...
def follow(
    spec: _Spec,
    periods: int,
    symmetric: bool,
    over: str,
    steps: _Steps,
    progress: _Progress | None,
) -> dict[str, Any]: ...
def switch(
    spec: _Spec, point: _Point, over: str, steps: _Steps, progress: _Progress | None
) -> dict[str, Any]: ...
def orbit_at(
    spec: _Spec, given: _Chain, over: str, value: float, unknowns: Sequence[float]
) -> dict[str, Any]: ...
def curve(
    spec: _Spec,
    point: _Point,
    over: tuple[str, str],
    ranges: tuple[tuple[float, float], tuple[tuple[float, float], tuple[float, float]]],
    steps: tuple[Sequence[float], float, int],
    progress: _Progress | None,
) -> dict[str, Any]: ...
def diagram(
    spec: _Spec,
    over: str,
    values: Sequence[float],
    directions: Sequence[str],
    window: tuple[int, int],
    progress: _Progress | None,
) -> dict[str, Any]: ...
def lyapunov(
    spec: _Spec, starts: _Starts, window: tuple[int, int], progress: _Progress | None
) -> dict[str, Any]: ...
def attractors(
    spec: _Spec,
    starts: _Starts,
    most_periods: int,
    most_cycles: int,
    progress: _Progress | None,
) -> dict[str, Any]: ...
def basins(
    spec: _Spec,
    over: tuple[str, str],
    values: tuple[Sequence[float], Sequence[float]],
    orbits: Sequence[Sequence[float]] | None,
    limits: tuple[int, int, int],
    progress: _Progress | None,
) -> dict[str, Any]: ...
def slow_manifold(spec: _Spec) -> dict[str, Any]: ...
def on_slow_manifold(spec: _Spec, theta: float) -> tuple[float, float, bool]: ...
def metadata(path: str | PathLike[str]) -> dict[str, str]: ...
def read_table(path: str | PathLike[str]) -> ArrowTable: ...
def scene_of_study(path: str | PathLike[str], point: int) -> _Spec: ...
def optimised_scene(path: str | PathLike[str]) -> _Spec: ...
def in_range(key: str, values: Sequence[float]) -> list[bool]: ...
def sampled(sampling: tuple[Any, ...]) -> list[tuple[str, list[float]]]: ...
def copy_examples(folder: str | PathLike[str]) -> list[Path]: ...
def example_names() -> list[str]: ...
def check_files(files: Sequence[tuple[str | PathLike[str], int, str]]) -> None: ...
def visible(text: str) -> str: ...
def empty_tables(path: str | PathLike[str]) -> dict[str, ArrowTable]: ...
def larger_is_better() -> list[str]: ...
def main(argv: Sequence[str]) -> int: ...
