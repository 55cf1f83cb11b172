// The hands that hold tools of several contacts, or one body together: where each
// presses, how each has turned its tool, and how far a pinch is open.
import { Quaternion, Vector3 } from "/vendor.min.js";

const kDegree = Math.PI / 180;
const kTiltMost = 60 * kDegree;
const kUp = new Vector3(0, 0, 1);

const turnAbout = (x, y, z, angle) => new Quaternion().setFromAxisAngle(new Vector3(x, y, z), angle);

export class Grip {
  // @param surface where the hands slide. @param tools as body.json has them.
  constructor(surface, tools) {
    this.surface = surface;
    this.hands = tools.map((tool) => ({ tool, place: null, spin: 0, tilt: [0, 0], held: false }));
    this.both = tools.length > 1;  // the pointer moves both, as a pinch
    this.chosen = 0;               // else this one
    this.axes = [[1, 0, 0], [0, 1, 0]];  // right and up of the screen
    this.spread = 0;               // of a pinch: angle between right and thumb to finger
    // Closed: the tools touch each other; they do not feel it.
    const reach = tools.map(({ spheres }) => Math.max(...spheres.map(({ centre_m: c, radius_m }) => Math.hypot(c[0], c[1]) + radius_m)));
    this.openLeast = reach.reduce((sum, r) => sum + r, 0);
    this.openMost = 4 * this.openLeast;
    this.opening = this.openLeast;
  }

  get active() { return this.both ? this.hands : [this.hands[this.chosen]]; }
  get any() { return this.hands.some((hand) => hand.held); }

  choose(which) {
    this.both = which === "both";
    this.chosen = this.both ? this.chosen : Number(which);
  }

  // The runtime's own places, at the start.
  start(state) {
    this.hands.forEach((hand, i) => { hand.place = this.surface.under(state.hands[i].tool_m); });
    if (this.both) {
      const [a, b] = this.hands.map(({ place }) => place.point);
      this.open(Math.hypot(...a.map((v, k) => v - b[k])));
      return this.surface.under(a.map((v, k) => (v + b[k]) / 2));
    }
    return this.hands[this.chosen].place;
  }

  // The pointer is there; a pinch has it between the fingers.
  move(place, axes) {
    this.axes = axes;
    this.centre = place;
    if (!this.both) {
      this.hands[this.chosen].place = place;
      return;
    }
    const [c, s] = [Math.cos(this.spread), Math.sin(this.spread)];
    this.hands.forEach((hand, i) => {
      const half = (i === 0 ? -0.5 : 0.5) * this.opening;
      hand.place = this.surface.slide(place, ...axes, [half * c, half * s]);
    });
  }

  open(opening_m) {
    this.opening = Math.min(this.openMost, Math.max(this.openLeast, opening_m));
    if (this.both && this.centre) {
      this.move(this.centre, this.axes);
    }
  }

  // A pinch turns as a whole; a tool turns about its own axis, then tilts.
  turn(spin, tilt) {
    if (this.both) {
      this.spread += spin;
      this.open(this.opening);
    }
    for (const hand of this.both ? [] : this.active) {
      hand.spin = Math.atan2(Math.sin(hand.spin + spin), Math.cos(hand.spin + spin));
      hand.tilt = hand.tilt.map((angle, k) => Math.min(kTiltMost, Math.max(-kTiltMost, angle + tilt[k])));
    }
  }

  stand() {
    for (const hand of this.active) {
      Object.assign(hand, { spin: 0, tilt: [0, 0] });
    }
  }

  // Where a hand wants its tool, pressed in by `depth_m` at the sphere that is deepest.
  target({ tool, place, spin, tilt }, depth_m) {
    const normal = new Vector3().fromArray(place.normal);
    const turn = new Quaternion().setFromUnitVectors(kUp, normal)
      .multiply(turnAbout(1, 0, 0, tilt[0])).multiply(turnAbout(0, 1, 0, tilt[1])).multiply(turnAbout(0, 0, 1, spin));
    const reach = Math.max(...tool.spheres.map(({ centre_m, radius_m }) =>
      radius_m - new Vector3().fromArray(centre_m).applyQuaternion(turn).dot(normal)));
    return {
      target_m: new Vector3().fromArray(place.point).addScaledVector(normal, reach - depth_m).toArray(),
      turn: turn.toArray(),
    };
  }
}

// The panel at the left: which hand, opening, turns.
export class GripPanel {
  constructor(app, get) {
    const { grip } = app;
    this.app = app;
    this.get = get;
    get("contacts_panel").hidden = false;
    const error = Math.max(...grip.hands.map(({ tool }) => tool.coupling_error));
    get("coupling_error").textContent = error > 0 ? `its stated error: ± ${(100 * error).toPrecision(2)} % of force` : "its error has not been measured";
    get("which_hand").hidden = grip.hands.length < 2;
    grip.hands.forEach((hand, i) => { get(`hand_${i}_name`).textContent = hand.tool.name; });
    for (const input of document.querySelectorAll("input[name=which]")) {
      input.onchange = () => app.chooseHand(input.value);
    }
    get("coupled").onchange = (event) => app.link.set({ coupled: event.target.checked });
    get("opening").oninput = (event) => app.openPinch(grip.openLeast + (event.target.value / 100) * (grip.openMost - grip.openLeast));
    get("spin").oninput = (event) => app.turnTool(event.target.value * kDegree - this.spin(), [0, 0]);
    get("tilt_x").oninput = (event) => app.turnTool(0, [event.target.value * kDegree - grip.active[0].tilt[0], 0]);
    get("tilt_y").oninput = (event) => app.turnTool(0, [0, event.target.value * kDegree - grip.active[0].tilt[1]]);
    get("upright").addEventListener("click", () => app.standTool());
    this.show();
  }

  spin() { return this.app.grip.both ? this.app.grip.spread : this.app.grip.active[0].spin; }

  // What the grip is, where a slider is not in the user's hand.
  show() {
    const { app: { grip }, get } = this;
    const put = (id, value, text) => {
      if (get(id) !== document.activeElement) { get(id).value = value; }
      get(`${id}_text`).textContent = text;
    };
    const angle = (id, radians) => put(id, radians / kDegree, `${Math.round(radians / kDegree)}°`);
    for (const input of document.querySelectorAll("input[name=which]")) {
      input.checked = input.value === (grip.both ? "both" : String(grip.chosen));
    }
    get("opening_row").hidden = !grip.both;
    put("opening", (100 * (grip.opening - grip.openLeast)) / (grip.openMost - grip.openLeast), `${(1e3 * grip.opening).toFixed(0)} mm`);
    const spin = this.spin();
    angle("spin", Math.atan2(Math.sin(spin), Math.cos(spin)));
    const turns = !grip.both && grip.active[0].tool.spheres.length > 1;
    get("tilts").hidden = !turns;
    get("spin_row").hidden = !turns && !grip.both;
    if (turns) {
      angle("tilt_x", grip.active[0].tilt[0]);
      angle("tilt_y", grip.active[0].tilt[1]);
    }
    get("turns").hidden = !turns && !grip.both;
  }
}
