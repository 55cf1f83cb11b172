// Mouse, wheel and keys: orbit, press, slide, pick.

const kClickPixels = 4;

const get = (id) => document.getElementById(id);

// Presses begin before the orbit hears of them: in the capture phase.
function listenToPointer(app) {
  const { view } = app;
  const canvas = get("canvas");
  let down = null;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus();
    down = { x: event.clientX, y: event.clientY, press: event.button === 0 && (event.shiftKey || view.overTool(event)) };
    view.orbit.enabled = !down.press;
    if (down.press) {
      canvas.setPointerCapture(event.pointerId);
      const hit = view.hit(event);
      if (hit) {
        app.setPlace(app.placeOf(hit));
      }
      app.hold();
    }
  }, { capture: true });
  canvas.addEventListener("pointermove", (event) => {
    const hit = down?.press ? view.hit(event) : null;
    if (hit) {
      app.setPlace(app.placeOf(hit));
    }
  }, { capture: true });
  canvas.addEventListener("pointerup", (event) => {
    if (!down) {
      return;
    }
    const moved = Math.hypot(event.clientX - down.x, event.clientY - down.y);
    if (down.press) {
      app.letGo();
    } else if (moved < kClickPixels && event.button === 0) {
      pick(app, view.hit(event));
    }
    down = null;
    view.orbit.enabled = true;
  }, { capture: true });
  canvas.addEventListener("pointercancel", () => { down = null; view.orbit.enabled = true; app.letGo(); });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    if (app.holding) {
      app.setPress(app.press * (1 - 0.0008 * event.deltaY) - 1e-7 * event.deltaY);
      event.stopImmediatePropagation();
    }
  }, { capture: true, passive: false });
}

function pick(app, hit) {
  if (hit) {
    app.setPlace(app.placeOf(hit));
    app.link.node(hit.node);
  }
}

const kKeys = {
  " ": (app) => app.togglePause(),
  ".": (app) => app.run("step"),
  r: (app) => app.run("reset"),
  p: (app) => (app.holding ? app.letGo() : app.hold()),
  Escape: (app) => app.letGo(),
  ArrowLeft: (app) => app.slide(-app.stepLength(), 0),
  ArrowRight: (app) => app.slide(app.stepLength(), 0),
  ArrowUp: (app) => app.slide(0, app.stepLength()),
  ArrowDown: (app) => app.slide(0, -app.stepLength()),
  "[": (app) => app.setPress(app.press - 0.02 * app.pressMax),
  "]": (app) => app.setPress(app.press + 0.02 * app.pressMax),
  f: (app) => app.view?.focusTool(),
  w: (app) => { if (app.view) { app.view.wire.visible = !app.view.wire.visible; } },
  n: (app) => { if (app.view) { app.view.normals.visible = !app.view.normals.visible; } },
  o: (app) => app.view?.toggleCamera(),
  s: (app) => app.savePicture(),
  v: (app) => app.toggleVideo(),
  d: (app) => app.toggleTheme(),
  "?": () => get("keys").showModal(),
  Enter: (app) => { if (app.place) { app.link.node(app.surface.nearest(app.place.point)); } },
};

// A focused control keeps the keys that it understands itself.
function belongsToControl(event) {
  const { target } = event;
  if (event.ctrlKey || event.metaKey || event.altKey || get("keys").open) {
    return true;
  }
  return (target.tagName === "INPUT" && (event.key.startsWith("Arrow") || event.key === " ")) ||
         (target.tagName === "BUTTON" && (event.key === " " || event.key === "Enter"));
}

function listenToKeys(app) {
  document.addEventListener("keydown", (event) => {
    const act = kKeys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (act && !belongsToControl(event)) {
      event.preventDefault();
      act(app);
    }
  });
}

function listenToButtons(app) {
  const click = (id, act) => get(id).addEventListener("click", act);
  click("pause", () => app.togglePause());
  click("advance", () => app.run("step"));
  click("reset", () => app.run("reset"));
  click("record", () => app.run("record"));
  click("replay", () => app.run("replay"));
  click("poke", () => kKeys.p(app));
  click("shot", () => app.savePicture());
  click("video", () => app.toggleVideo());
  click("csv", () => app.saveTable());
  click("dark", () => app.toggleTheme());
  click("help", () => get("keys").showModal());
  click("close_keys", () => get("keys").close());
  get("press").addEventListener("input", (event) => app.setPress((app.pressMax * event.target.value) / 100));
  get("controls").addEventListener("submit", (event) => event.preventDefault());
}

export function listen(app) {
  if (app.view) {
    listenToPointer(app);
  }
  listenToKeys(app);
  listenToButtons(app);
  // A hand that nobody sees holds nothing.
  window.addEventListener("blur", () => app.letGo());
  document.addEventListener("visibilitychange", () => document.hidden && app.letGo());
}
