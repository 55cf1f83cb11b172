// Mouse, wheel and keys: orbit, press, slide, pick.

const kClickPixels = 4;
const kTapMs = 250;
const kTurnPerPixel = 0.008;  // [rad]
const kStepRad = Math.PI / 36;

const get = (id) => document.getElementById(id);

// Presses begin before the orbit hears of them: in the capture phase.
function listenToPointer(app) {
  const { view } = app;
  const canvas = get("canvas");
  let down = null;
  if (matchMedia("(pointer: coarse)").matches) {
    get("hint").textContent = "a finger on the body presses · beside it turns · two zoom · a tap picks a node";
  }
  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus();
    if (!event.isPrimary && down?.press) {  // a second finger: the hand is for the view
      app.letActiveGo();
      down = null;
      view.orbit.enabled = true;
      return;
    }
    const left = event.button === 0;
    const over = view.overTool(event);
    const turn = left && event.ctrlKey && app.grip !== null;
    const finger = event.pointerType === "touch" && view.hit(event) !== null;
    down = {
      x: event.clientX, y: event.clientY, since: event.timeStamp, finger, turn,
      press: left && !turn && (event.shiftKey || finger || over >= 0),
    };
    view.orbit.enabled = !down.press && !down.turn;
    if (down.turn || down.press) {
      app.reachFor(over);
    }
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
    if (down?.turn) {
      app.turnTool(kTurnPerPixel * (event.clientX - down.x), [kTurnPerPixel * (event.clientY - down.y), 0]);
      Object.assign(down, { x: event.clientX, y: event.clientY });
    }
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
    const tap = down.finger && moved < 3 * kClickPixels && event.timeStamp - down.since < kTapMs;
    if (down.press) {
      app.letActiveGo();
    }
    if (tap || (!down.press && !down.turn && moved < kClickPixels && event.button === 0)) {
      pick(app, view.hit(event));
    }
    down = null;
    view.orbit.enabled = true;
  }, { capture: true });
  canvas.addEventListener("pointercancel", () => { down = null; view.orbit.enabled = true; app.letGo(); });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    if (event.altKey && app.grip?.both) {
      app.openPinch(app.grip.opening * (1 - 0.0008 * event.deltaY) - 1e-6 * event.deltaY);
      event.stopImmediatePropagation();
    } else if (app.holding) {
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
  p: (app) => app.toggleHold(),
  Escape: (app) => {
    app.letGo();
    app.device?.letGo();
  },
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
  q: (app) => app.turnTool(-kStepRad, [0, 0]),
  e: (app) => app.turnTool(kStepRad, [0, 0]),
  i: (app) => app.turnTool(0, [-0.4 * kStepRad, 0]),
  k: (app) => app.turnTool(0, [0.4 * kStepRad, 0]),
  j: (app) => app.turnTool(0, [0, -0.4 * kStepRad]),
  l: (app) => app.turnTool(0, [0, 0.4 * kStepRad]),
  u: (app) => app.standTool(),
  c: (app) => app.toggleCoupled(),
  1: (app) => app.chooseHand("0"),
  2: (app) => app.chooseHand("1"),
  3: (app) => app.chooseHand("both"),
  "-": (app) => app.openPinch(app.grip?.opening - 0.001),
  "=": (app) => app.openPinch(app.grip?.opening + 0.001),
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
  click("poke", () => app.toggleHold());
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
