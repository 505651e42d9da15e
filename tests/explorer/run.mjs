// Runs the scenes given as JSON on standard input with the simulator of the explorer, and prints what it computes: the
// tables of each run, or the sentence of its error. Numbers are printed so that they are read back to the bit.
import { readFileSync } from "node:fs";
import { Engine } from "./engine.mjs";

const [module] = process.argv.slice(2);
const engine = await Engine.load(new Uint8Array(readFileSync(module)));
const asked = JSON.parse(readFileSync(0, "utf8"));
const plain = (table) => Object.fromEntries(
  Object.entries(table).map(([name, values]) => [name, Array.from(values, (it) => (Number.isNaN(it) ? null : it))]),
);
const answers = asked.map(({ scene, map }) => {
  const { error, units, absorbers } = engine.set(scene);
  if (error) return { error };
  if (map) return { map: plain({ map: engine.map(...map) }).map };
  const { error: fault, summary, units: _, ...tables } = engine.run(20, true);
  return { fault, units, places: absorbers, summary, ...Object.fromEntries(Object.entries(tables).map(([name, table]) => [name, plain(table)])) };
});
process.stdout.write(JSON.stringify({ description: engine.description, answers }));
