// Rows of measures, computed in workers, or in idle slices of the page where there can be none.

import { Engine } from "./engine.js";
import { clamp } from "./format.js";

/** What a worker runs after the source of the engine: one job at a time, a newer one ends it. */
const WORK = `
let engine = null;
let newest = 0;
const pause = () => new Promise((resolve) => setTimeout(resolve, 0));
onmessage = async ({ data }) => {
  if (data.wasm) {
    engine = await Engine.load(data.wasm);
    postMessage({ ready: true });
    return;
  }
  newest = data.id;
  if (!data.scene) return;
  await pause();
  if (data.id !== newest) return;
  const { error } = engine.set(data.scene);
  if (error) { postMessage({ id: data.id, failed: error.sentence }); return; }
  let last = performance.now();
  for (const { index, xPath, xs, yPath, ys } of data.rows) {
    const values = engine.row(xPath, xs, yPath, ys[0], data.measure);
    postMessage({ id: data.id, index, values }, [values.buffer]);
    if (performance.now() - last > 30) {
      await pause();
      if (data.id !== newest) return;
      engine.set(data.scene);
      last = performance.now();
    }
  }
  postMessage({ id: data.id, done: true });
};
`;

/** Most workers of a page: each holds a simulator of its own. */
const MOST_WORKERS = 4;

/** Jobs of one sort: a newer replaces an older. Two queues of a page have workers of their own. */
export class Background {
  constructor(options, engine) {
    this.options = options;
    this.engine = engine;
    this.id = 0;
    this.job = null;
    this.workers = [];
    // The page itself needs a core to stay at hand.
    const cores = (globalThis.navigator?.hardwareConcurrency ?? 2) - 1;
    this.ready = 0;
    try {
      const source = `${Engine.source.replace(/^export (default )?/gm, "")}\n${WORK}`;
      const address = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
      for (let count = 0; count < clamp(cores, 1, MOST_WORKERS); count += 1) this.hire(address);
    } catch {
      this.withoutWorkers();
    }
  }

  hire(address) {
    const worker = new Worker(address);
    worker.onmessage = ({ data }) => this.receive(data);
    worker.onerror = (event) => {
      event.preventDefault();
      this.withoutWorkers();
    };
    worker.postMessage({ wasm: this.options.wasm });
    this.workers.push(worker);
  }

  another() {
    return new Background(this.options, this.engine);
  }

  withoutWorkers() {
    for (const worker of this.workers) worker.terminate();
    this.workers = [];
    this.ready = 0;
    if (this.job) this.send();
  }

  /** `rows` of `{xPath, xs, yPath, ys}`; `onRow(index, values)` gets each, `onEnd` the end or a fault. */
  start(job) {
    this.id += 1;
    this.job = { ...job, id: this.id, left: Math.max(1, this.workers.length) };
    if (this.ready === this.workers.length) this.send();
  }

  /** Ends the job in progress. */
  cancel() {
    this.id += 1;
    this.job = null;
    for (const worker of this.workers) worker.postMessage({ id: this.id });
  }

  stop() {
    this.cancel();
    for (const worker of this.workers) worker.terminate();
  }

  /** Workers take the rows in turns, so that all of them begin with the coarse ones. */
  send() {
    const { id, scene, measure } = this.job;
    const rows = this.job.rows.map((row, index) => ({ index, ...row }));
    const count = this.workers.length;
    this.workers.forEach((worker, own) => {
      worker.postMessage({ id, scene, measure, rows: rows.filter(({ index }) => index % count === own) });
    });
    if (!count) this.slices(this.job, rows);
  }

  receive(data) {
    if (data.ready) {
      this.ready += 1;
      if (this.job && this.ready === this.workers.length) this.send();
    } else if (this.job && data.id === this.job.id) {
      if (data.values) this.job.onRow(data.index, data.values);
      else {
        this.job.left -= 1;
        if (data.failed || this.job.left === 0) this.end(data.failed ?? null);
      }
    }
  }

  end(fault) {
    const { onEnd } = this.job;
    this.job = null;
    onEnd(fault);
  }

  /** The same on the page itself: some milliseconds at a time, and the scene set anew each time. */
  slices(job, rows) {
    const idle = globalThis.requestIdleCallback ?? ((action) => setTimeout(action, 16));
    const left = [...rows];
    const slice = () => {
      if (job !== this.job) return;
      const { error } = this.engine.set(job.scene);
      if (error) {
        this.end(error.sentence);
        return;
      }
      const until = performance.now() + 8;
      while (left.length && performance.now() < until) {
        const { index, xPath, xs, yPath, ys } = left.shift();
        const values = this.engine.row(xPath, xs, yPath, ys[0], job.measure);
        job.onRow(index, values);
      }
      if (left.length) idle(slice);
      else this.end(null);
    };
    idle(slice);
  }
}
