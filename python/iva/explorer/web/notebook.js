// The widget of a notebook: the page in an element, and its scene kept in step with Python.

/** Python hears of a scene once it has rested for so long. */
const QUIET_MS = 150;

function render({ model, el }) {
  let timer = null;
  let told = JSON.stringify(model.get("scene"));
  const mounted = mount(el, {
    wasm: unpacked(bytesOf(WASM)),
    scene: model.get("scene"),
    version: VERSION,
    onScene: (scene) => {
      clearTimeout(timer);
      timer = setTimeout(() => {
        told = JSON.stringify(scene);
        model.set("scene", scene);
        model.save_changes();
      }, QUIET_MS);
    },
  });
  const changed = () => {
    const scene = model.get("scene");
    if (JSON.stringify(scene) === told) return;
    mounted.ready.then((page) => page.show(scene));
  };
  model.on("change:scene", changed);
  return () => {
    clearTimeout(timer);
    model.off("change:scene", changed);
    mounted.destroy();
  };
}

export default { render };
