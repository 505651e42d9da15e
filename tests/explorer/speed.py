"""How long the explorer takes in headless Chromium: `make bench-explorer`.

Frames are steps of a slider: run, tables and all views, from the event to the end of the script,
and from frame to frame while it slides. The first frame counts from the begin of navigation.
"""

from __future__ import annotations

import json
import math
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from scipy.integrate import solve_ivp

import iva
from chromium import Chromium

SLIDE = """(async () => {
  const slider = document.querySelector('input[type=range][aria-label=Clearance]');
  const [script, frames] = [[], []];
  let last = await new Promise(requestAnimationFrame);
  for (let step = 0; step < 200; step += 1) {
    slider.value = String(60 + step);
    const began = performance.now();
    slider.dispatchEvent(new Event('input'));
    script.push(performance.now() - began);
    const now = await new Promise(requestAnimationFrame);
    frames.push(now - last);
    last = now;
  }
  return [script, frames];
})()"""

PARTS = """(() => {
  const times = {};
  const median = (work) => {
    const all = Array.from({length: 41}, () => {
      const began = performance.now(); work(); return performance.now() - began;
    });
    return all.sort((a, b) => a - b)[20];
  };
  const { state } = now;
  times.run = median(() => { now.engine.set(state.scene); now.engine.run(state.samples); });
  for (const view of now.views) times[view.name] = median(() => view.show(now.data, now.colours));
  times.controls = median(() => now.controls.show());
  times['map and response'] = median(() => {
    now.forced.show(now.data, now.colours); now.map.scene(now.data, now.colours);
    now.map.draw(now.data, now.colours);
  });
  times.measures = median(() => now.table.show(now.data));
  return times;
})()"""

MAP = """(async () => {
  const { map } = now;
  const began = performance.now();
  map.restart();
  clearTimeout(map.timer);
  map.begin();
  const told = {};
  let longest = 0;
  let last = performance.now();
  while (map.told.textContent !== '') {
    await new Promise(requestAnimationFrame);
    const at = performance.now();
    longest = Math.max(longest, at - last);
    last = at;
    if (!told.coarse && map.known.every(Boolean)) told.coarse = at - began;
  }
  return {coarse: told.coarse, whole: performance.now() - began, 'longest frame': longest};
})()"""

#: Two masses, as the page takes them.
LIST = {
    "choices": {"0.kind": "siva", "1.kind": "siva"},
    "values": {
        "primary.damping_ratio": 0.005,
        **{f"absorber.{k}.mass_ratio": 0.05 for k in (0, 1)},
        **{f"absorber.{k}.restitution": 0.6 for k in (0, 1)},
        **{f"absorber.{k}.clearance": 0.5 - 0.1 * k for k in (0, 1)},
        "start.displacement": 1.0,
        "run.periods": 20.0,
    },
}
#: Changes of the first scene.
SCENES = {
    "free mass": "edit({}, null)",
    "pendulum": "edit({'absorber.length': 3, 'absorber.frequency_ratio': 0.4}, null, "
    "{kind: 'piva'})",
    "force": "edit({'force.amplitude': 0.1, 'force.relative_frequency': 1.05}, null)",
    "friction": "edit({'absorber.friction': 0.05, 'absorber.gravity': 1}, null)",
    "two masses": f"load({json.dumps(LIST)})",
}


def by_hand() -> float:
    """Return the seconds that SciPy takes for the decay of the first scene, with events by hand."""
    zeta, mu, e, d = 0.005, 0.1, 0.6, 0.5

    def motion(_time: float, state: list[float]) -> list[float]:
        x, v, _y, w = state
        pulled = -x - 2 * zeta * v
        return [v, pulled, w, -pulled]

    def wall(side: float) -> Callable[[float, list[float]], float]:
        def reached(_time: float, state: list[float]) -> float:
            return d - side * state[2]

        vars(reached).update(terminal=True, direction=-1)
        return reached

    began = time.perf_counter()
    now, end, state = 0.0, 40 * math.pi, [1.0, 0.0, 0.0, 0.0]
    while now < end:
        found = solve_ivp(
            motion, (now, end), state, "DOP853", events=[wall(1), wall(-1)], rtol=1e-9, atol=1e-12
        )
        now, (x, v, y, w) = found.t[-1], found.y[:, -1]
        state = [x, v + mu * (1 + e) * w / (1 + mu), math.copysign(d, y), -e * w]
    return time.perf_counter() - began


def told(name: str, values: list[float]) -> None:
    """Print median and 95 % of some times."""
    high = statistics.quantiles(values, n=20)[-1]
    print(f"  {name:<34} median {statistics.median(values):6.1f} ms   95 % {high:6.1f} ms")


def main() -> None:
    """Print all."""
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder, "explorer.html")
        iva.explore().write(page)
        print(f"page {page.stat().st_size / 1e3:.0f} kB")
        browser = Chromium()
        try:
            for name, scene in SCENES.items():
                browser.open(page.as_uri())
                first = browser.value("performance.getEntriesByName('first scene')[0].startTime")
                browser.value(
                    "explorer.ready.then((page) => { page.play(false); globalThis.now = page; })"
                )
                print(f"{name}: first frame {first:.0f} ms after the navigation began")
                browser.value(f"now.state.{scene}")
                browser.wait("now.map.told.textContent === ''", 120)
                script, frames = browser.value(SLIDE)
                told("a step of the slider, script", script)
                told("from frame to frame", frames)
                parts = browser.value(PARTS)
                print("  " + ", ".join(f"{part} {time:.1f}" for part, time in parts.items()))
                browser.wait("now.map.told.textContent === ''", 120)
                times = browser.value(MAP)
                said = ", ".join(f"{part} {time:.0f} ms" for part, time in times.items())
                print(f"  map of 120 × 80: {said}")
                if name == "free mass":
                    decay = times["whole"] / (120 * 80)
                    ratio = 1e3 * min(by_hand() for _ in range(5)) / decay
                    print(
                        f"  a decay of the map {decay:.3f} ms; by SciPy {ratio:.0f} times as long"
                    )
        finally:
            browser.close()


if __name__ == "__main__":
    main()
