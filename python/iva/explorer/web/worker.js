// Rows of measures, computed in a worker, or in idle slices of the page where there can be none.

import { Engine } from "./engine.js";

/** What the worker runs after the source of the engine: one job at a time, a newer one ends it. */
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
  if (data.id === 0 || !data.scene) return;
  await pause();
  if (data.id !== newest) return;
  const { error } = engine.set(data.scene);
  if (error) { postMessage({ id: data.id, failed: error.sentence }); return; }
  let last = performance.now();
  for (let index = 0; index < data.rows.length; index += 1) {
    const { xPath, xs, yPath, ys } = data.rows[index];
    let values;
    try { values = engine.map(xPath, xs, yPath, ys, data.measure); } catch (fault) {
      values = new Float64Array(xs.length * ys.length).fill(NaN);
    }
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

/** Jobs of one sort: a newer replaces an older. Two queues of a page are two workers. */
export class Background {
  constructor(options, engine) {
    this.options = options;
    this.engine = engine;
    this.id = 0;
    this.ready = false;
    this.waiting = null;
    try {
      const source = `${Engine.source.replace(/^export (default )?/gm, "")}\n${WORK}`;
      const address = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
      this.worker = new Worker(address);
      this.worker.onmessage = ({ data }) => this.receive(data);
      this.worker.onerror = (event) => {
        event.preventDefault();
        this.withoutWorker();
      };
      this.worker.postMessage({ wasm: options.wasm });
    } catch {
      this.withoutWorker();
    }
  }

  another() {
    return new Background(this.options, this.engine);
  }

  withoutWorker() {
    this.worker?.terminate();
    this.worker = null;
    this.ready = true;
    if (this.waiting) this.slices(this.waiting);
  }

  /** `rows` of `{xPath, xs, yPath, ys}`; `onRow(index, values)` gets each, `onEnd` the end or a fault. */
  start(job) {
    this.id += 1;
    this.job = { ...job, id: this.id };
    this.waiting = this.job;
    if (this.ready) this.send();
  }

  stop() {
    this.id += 1;
    this.job = null;
    this.worker?.terminate();
  }

  send() {
    const { id, scene, rows, measure } = this.job;
    if (this.worker) this.worker.postMessage({ id, scene, rows, measure });
    else this.slices(this.job);
  }

  receive(data) {
    if (data.ready) {
      this.ready = true;
      if (this.job) this.send();
    } else if (this.job && data.id === this.job.id) {
      if (data.values) this.job.onRow(data.index, data.values);
      else this.job.onEnd(data.failed ?? null);
    }
  }

  /** The same on the page itself: some milliseconds at a time, and the scene set anew each time. */
  slices(job) {
    const idle = globalThis.requestIdleCallback ?? ((action) => setTimeout(action, 16));
    let index = 0;
    const slice = () => {
      if (job !== this.job) return;
      const { error } = this.engine.set(job.scene);
      if (error) {
        job.onEnd(error.sentence);
        return;
      }
      const until = performance.now() + 8;
      while (index < job.rows.length && performance.now() < until) {
        const { xPath, xs, yPath, ys } = job.rows[index];
        let values;
        try {
          values = this.engine.map(xPath, xs, yPath, ys, job.measure);
        } catch {
          values = new Float64Array(xs.length * ys.length).fill(NaN);
        }
        job.onRow(index, values);
        index += 1;
      }
      if (index < job.rows.length) idle(slice);
      else job.onEnd(null);
    };
    idle(slice);
  }
}
