// The page of palpate-run view: the runtime's numbers and its body, pressed by mouse or
// keys. All physics is the runtime's; the page says where the hand is and shows the rest.
import { BodyView } from "/body_view.js";
import { CurvePlot, handRows, TickPlots } from "/plots.js";
import { drawArrowKey, drawColourBar, drawScaleBar } from "/bars.js";
import { DevicePanel } from "/device_panel.js";
import { Friction } from "/friction.js";
import { fetchBody, Link } from "/link.js";
import { Grip, GripPanel } from "/grip.js";
import { History } from "/history.js";
import { deepestPress, Needle } from "/needle.js";
import { savePicture, saveTable, toggleVideo } from "/save.js";
import { Served } from "/served.js";
import { Settings } from "/settings.js";
import { Surface } from "/surface.js";
import { ContactNumbers } from "/contact_numbers.js";
import { listen } from "/hands.js";

const get = (id) => document.getElementById(id);

class App {
  constructor(body) {
    this.body = body;
    this.surface = new Surface(body);
    const { hands } = body.text;  // of several contacts or two hands
    this.grip = hands ? new Grip(this.surface, hands) : null;
    const rows = hands ? handRows(hands) : undefined;
    this.history = new History(rows ? ["time_s", ...rows.flatMap((row) => row.keys)]
      : ["time_s", "force_n", "depth_m", "stored_j", "tank_j", "memory_j"]);
    this.plots = new TickPlots(get("plots"), this.history, rows);
    this.curve = new CurvePlot(get("curve_plot"));
    this.needle = body.text.puncture ? new Needle(body) : null;
    this.friction = body.text.rubs ? new Friction() : null;
    this.pressMax = deepestPress(body.text);
    this.press = 0.6 * body.text.depth_max_m;
    this.place = null;    // the cursor on the surface
    this.holding = false;
    this.state = null;
    this.showNames();
    this.view = this.makeView();
    this.served = body.text.served ? new Served(this) : null;
    this.link = new Link({
      state: (message) => this.take(message),
      curve: (message) => this.showCurve(message),
      field: (message) => this.view?.yielding.take(message),
      answers: (message) => this.served?.answers(message),
      role: (message) => this.showRole(message.role),
      refused: (message) => this.complain(message.why),
      gone: (why) => this.lost(why),
    });
    this.settings = new Settings(body.text, (settings) => this.link.set(settings));
    this.setPress(this.press);
    if (this.grip) {
      this.contacts = new ContactNumbers(hands);
      this.panel = new GripPanel(this, get);
    }
    listen(this);
    requestAnimationFrame(() => this.frame());
    // Not with the frames, which may be rare: a hold that is not said again within
    // a second is over. A page that hangs says nothing.
    setInterval(() => this.holding && this.sendPoint(), 25);
  }

  showNames() {
    const { text } = this.body;
    const tools = (text.hands ?? [text.tool]).map((tool) => `${tool.name}, ${tool.description}`).join("; ");
    get("what").textContent = `${text.database} · ${tools} · ${this.body.stiffness.length} nodes`;
    get("what").title = `${text.source}, written by ${text.writer}. ${text.left_out}`;
    drawColourBar(text.map);
  }

  makeView() {
    try {
      return new BodyView(get("canvas"), this.body, (node) => this.link.field(node));
    } catch (error) {
      console.info(`no 3-D view: ${error.message}`);
      get("no_webgl").hidden = false;
      for (const id of ["colour_bar", "legend", "template", "scale_bar", "hint"]) {
        get(id).hidden = true;
      }
      return null;
    }
  }

  // From the runtime.
  take(state) {
    this.state = state;
    if (state.device) {
      this.device ??= new DevicePanel(this);
      this.device.show(state.device);
    }
    this.history.add({ ...state.trace, ...state.loads });
    this.fresh = true;
    this.needle?.take(state);
    this.friction?.plot.take(state);
    if (!this.place) {
      this.setPlace(this.grip ? this.grip.start(state) : this.surface.under(state.tool_m));
    }
  }

  // A page that only watches offers nothing that steers.
  showRole(role) {
    const { device } = this.body.text;
    this.view?.yielding.forget();  // a connection begins with this message
    get("role").textContent = role === "controller" ? "steers" : device ? `watches; the ${device} steers` : "watches";
    if (device) {
      for (const part of document.querySelectorAll("#controls fieldset, #pause, #advance, #reset, #record, #replay")) {
        part.disabled = true;
      }
      get("hint").textContent = "drag turns · click picks a node · ? all keys";
    }
  }

  lost(why = "") {
    get("message").textContent = why;
    this.forgetHold();
    this.state = null;
    get("state").textContent = "no connection";
    get("state").dataset.kind = "warn";
    get("role").textContent = "–";
  }

  complain(why) {
    get("message").textContent = why;
    clearTimeout(this.complaint);
    this.complaint = setTimeout(() => { get("message").textContent = ""; }, 4000);
  }

  showCurve(curve) {
    get("curve_title").textContent = `Response curve of node ${curve.node}`;
    const flags = curve.flags.length > 0 ? `; ${curve.flags.join(", ")}` : "";
    const angle = (Math.acos(Math.min(1, Math.abs(curve.normal.reduce((s, v, k) => s + v * curve.direction[k], 0)))) * 180) / Math.PI;
    get("curve_facts").textContent = curve.depth_m.length > 0
      ? `${curve.origin}, error ± ${(100 * curve.error_relative).toPrecision(2)} %, force ${angle.toFixed(1)}° off the normal, ` +
        `largest slope ${curve.stiffness_max_n_per_m.toPrecision(3)} N/m${flags}`
      : `no response here: ${curve.origin}${flags}`;
    this.curve.show(curve);
    this.view?.showPick(curve);
  }

  // From the user.
  setPlace(place) {
    this.place = place;
    if (this.grip) {
      this.grip.move(place, this.view ? this.view.screenAxes() : [[1, 0, 0], [0, 1, 0]]);
      this.gripChanged();
      return;
    }
    this.view?.showCursor(this.view.vector(place.point), this.view.vector(place.normal));
  }

  placeOf(hit) {
    return { point: hit.point.toArray(), normal: hit.normal.toArray(), node: hit.node };
  }

  // About a tenth of the tool's width.
  stepLength() { return 0.2 * this.body.text.tool.shape.half_width_m; }

  setPress(depth_m) {
    this.press = Math.min(this.pressMax, Math.max(0, depth_m));
    get("press").value = (100 * this.press) / this.pressMax;
    get("press_text").textContent = `${(this.press * 1e3).toFixed(1)} mm`;
  }

  hold() {
    if (!this.place || this.body.text.device || this.deviceSteers() || (this.holding && !this.grip)) {
      return;
    }
    this.holding = true;
    for (const hand of this.grip?.active ?? []) {
      hand.held = true;
    }
    this.sendPoint();
  }

  // The page's own device steers.
  deviceSteers() { return this.state?.device !== undefined && this.state.device.phase !== "off"; }

  letGo() {
    if (this.holding) {
      this.forgetHold();
      this.link.letGo();
    }
  }

  forgetHold() {
    this.holding = false;
    this.needle?.forget();
    this.grip?.hands.forEach((hand) => { hand.held = false; });
  }

  // Those that the pointer moves; the other hand stays where it is.
  letActiveGo() {
    if (!this.grip) {
      this.letGo();
      return;
    }
    for (const hand of this.grip.active.filter(({ held }) => held)) {
      hand.held = false;
      this.link.letGo({ hand: this.grip.hands.indexOf(hand) });
    }
    this.holding = this.grip.any;
  }

  toggleHold() {
    const held = this.grip ? this.grip.active.every((hand) => hand.held) : this.holding;
    if (held) {
      this.letActiveGo();
    } else {
      this.hold();
    }
  }

  sendPoint() {
    if (!this.grip) {
      this.link.hold((this.needle ?? this.surface).target(this.place, this.press));
    }
    this.grip?.hands.forEach((hand, i) => {
      if (hand.held) {
        const { target_m: target, turn } = this.grip.target(hand, this.press);
        this.link.hold(target, { hand: i, turn });
      }
    });
  }

  // Of several contacts and two hands.
  gripChanged() {
    this.view?.contacts.showCursors(this.grip);
    this.panel?.show();
  }

  // The pointer takes a tool that it meets; a pinch keeps both.
  reachFor(hand) {
    if (this.grip && hand >= 0 && !this.grip.both) {
      this.chooseHand(String(hand));
    }
  }

  chooseHand(which) {
    if (this.grip && (which === "0" || this.grip.hands.length > 1)) {
      this.grip.choose(which);
      const { place } = this.grip.active[0];
      if (!this.grip.both && place) {
        this.place = place;
      }
      this.gripChanged();
    }
  }

  turnTool(spin, tilt) {
    if (this.grip) {
      this.grip.turn(spin, tilt);
      this.gripChanged();
    }
  }

  standTool() {
    if (this.grip) {
      this.grip.stand();
      this.gripChanged();
    }
  }

  openPinch(opening_m) {
    if (this.grip?.both) {
      this.grip.open(opening_m);
      this.gripChanged();
    }
  }

  toggleCoupled() {
    if (this.grip && this.state) {
      this.link.set({ coupled: !this.state.coupled });
    }
  }

  slide(right_m, up_m) {
    const [right, up] = this.view ? this.view.screenAxes() : [[1, 0, 0], [0, 1, 0]];
    this.setPlace(this.surface.slide(this.place, right, up, [right_m, up_m]));
  }

  run(what) {
    this.link.run(what);
    if (["reset", "record", "replay"].includes(what)) {
      this.forgetHold();
    }
  }

  togglePause() { this.run(this.state?.paused ? "resume" : "pause"); }
  savePicture() {
    this.view?.redraw();
    savePicture(get("canvas"));
  }
  saveTable() { saveTable(this.history); }
  toggleVideo() { get("video").setAttribute("aria-pressed", String(toggleVideo(get("canvas")))); }

  toggleTheme() {
    const { dataset } = document.documentElement;
    dataset.theme = dataset.theme === "dark" ? "light" : "dark";
    this.plots.build();
    this.needle?.plot.build();
    this.friction?.plot.build();
    this.view?.recolour();
  }

  // Sixty times a second, less where the machine is slow.
  frame() {
    requestAnimationFrame(() => this.frame());
    if (this.state && this.fresh) {
      this.fresh = false;
      this.showState();
      this.view?.show(this.state);
    }
    const now = performance.now();
    if (now - (this.drawn ?? 0) > 50) {
      this.drawn = now;
      this.plots.draw();
      this.needle?.plot.draw();
      this.friction?.plot.draw();
      if (this.state && !this.grip) {
        // In a channel a needle is on no curve.
        this.curve.at(this.state.needle?.in >= 0 ? 0 : this.state.depth_m * 1e3, Math.hypot(...this.state.force_n));
      }
    }
    if (this.view && now >= (this.nextPicture ?? 0)) {
      this.nextPicture = this.view.software ? now + 90 : now;
      this.view.draw();
      drawScaleBar(this.view);
      drawArrowKey(this.view);
    }
  }

  showState() {
    const { state } = this;
    const put = (id, text) => { if (get(id).textContent !== text) { get(id).textContent = text; } };
    put("force", Math.hypot(...state.force_n).toFixed(3));
    this.contacts?.show(state, put);
    this.needle?.show(state, put);
    this.friction?.show(state, put);
    if (state.service) {
      this.served?.show(state);
    }
    put("depth", Math.max(0, state.depth_m * 1e3).toFixed(2));
    put("energy", (state.stored_j * 1e3).toFixed(3));
    put("tank", (state.tank_j * 1e3).toFixed(3));
    put("memory", (state.memory_j * 1e3).toFixed(3));
    get("memory_row").hidden = !this.body.text.relaxes;
    put("net", (state.net_j * 1e3).toFixed(3));
    get("net").classList.toggle("warn", state.net_j < -1e-6);
    put("shift", (state.shift_m * 1e3).toFixed(2));
    put("state", state.fault === "none" ? state.state : `fault: ${state.fault}`);
    get("state").dataset.kind = state.fault !== "none" || state.state.includes("silent") ? "warn"
      : state.state === "pressing" ? "contact" : "";
    put("fast", `${Math.round(state.settings.fast_hz)} Hz`);
    put("slow", `${Number(state.settings.slow_hz.toPrecision(4))} Hz`);
    put("step_time", !(state.run.step_p50_ns > 0) ? "–" : `${(state.run.step_p50_ns / 1e3).toFixed(1)} µs`);
    put("speed", state.paused ? "paused" : `${state.speed.toFixed(2)} ×`);
    get("poke").setAttribute("aria-pressed", String(state.holding));
    get("pause").setAttribute("aria-pressed", String(state.paused));
    get("record").setAttribute("aria-pressed", String(state.tape === "recording"));
    get("replay").setAttribute("aria-pressed", String(state.tape === "playing"));
    if (this.view) {
      put("template", this.view.yielding.label());
    }
    this.settings.show(state.settings);
  }
}

fetchBody().then((body) => { window.palpate = new App(body); }, (error) => {
  get("state").textContent = "cannot start";
  get("state").dataset.kind = "warn";
  get("message").textContent = error.message;
});
