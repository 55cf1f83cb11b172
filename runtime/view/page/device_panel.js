// The panel of a page that can press with a device of its own (runtime/view/page_device.h).

const get = (id) => document.getElementById(id);
const kKeepMs = 200;
const kPhases = {
  off: "",
  connecting: "connecting",
  testing: "testing its motors",
  on: "presses",
};

export class DevicePanel {
  constructor(app) {
    this.app = app;
    this.phase = "off";
    get("device_panel").hidden = false;
    get("device").addEventListener("click", () => (this.phase === "off" ? this.ask() : this.letGo()));
    // A page that hangs says nothing, and is let go of.
    setInterval(() => this.phase !== "off" && app.link.device("keep"), kKeepMs);
    document.addEventListener("visibilitychange", () => document.hidden && this.letGo());
  }

  // From over the cursor, with the device's right to the picture's.
  ask() {
    const { app } = this;
    app.letGo();
    const [right] = app.view ? app.view.screenAxes() : [[1, 0, 0]];
    app.link.device("on", {
      node: app.place?.node ?? app.surface.under(app.state.tool_m).node, right,
      limit: get("device_limit").checked,
    });
  }

  letGo() {
    if (this.phase !== "off") {
      this.app.link.device("off");
    }
  }

  show({ phase, detail, force_max_n: most, hz }) {
    this.phase = phase;
    const put = (id, text) => { if (get(id).textContent !== text) { get(id).textContent = text; } };
    put("device", phase === "off" ? "Press with a device" : "Let go of the device");
    get("device").setAttribute("aria-pressed", String(phase !== "off"));
    get("device_limit").disabled = phase !== "off";
    const rate = phase === "on" ? `${kPhases.on}, ${hz.toFixed(0)} forces a second, to ${most} N` : kPhases[phase];
    put("device_text", [rate, detail].filter((text) => text !== "").join(": "));
    get("device_text").classList.toggle("warn", phase === "off" && detail !== "");
  }
}
