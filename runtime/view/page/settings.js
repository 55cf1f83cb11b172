// The settings at the left: what they say to the runtime, and what it says they are.

const kModels = {
  "single": ["zero-order hold", "may buzz"],
  "first-order-hold": ["first-order hold", "may buzz"],
  "equal-energy": ["equal energy", "passive"],
  "energy-tank": ["energy tank", "passive"],
  "element": ["element", "passive"],
  "potential": ["potential field", "passive"],
};
const kSlowHz = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000];

const get = (id) => document.getElementById(id);

export class Settings {
  // @param send called with { slow_hz: 20 } and the like.
  constructor(text, send) {
    this.slowHz = kSlowHz.filter((hz) => hz <= text.ranges.slow_hz[1]);
    this.radios = new Map();
    for (const model of text.models) {
      get("models").append(this.radio(model, send));
    }
    get("slow_hz").max = this.slowHz.length - 1;
    get("slow_hz").oninput = (event) => send({ slow_hz: this.slowHz[event.target.value] });
    get("stiffness").oninput = (event) => send({ stiffness_scale: 10 ** (event.target.value / 100) });
    get("friction").oninput = (event) => send({ friction: Number(event.target.value) });
    get("friction_stored").onchange = (event) =>
      send({ friction: event.target.checked ? null : Number(get("friction").value) });
    get("friction").value = text.tool.friction;
    this.stored = text.tool.friction;
  }

  radio(model, send) {
    const label = document.createElement("label");
    const input = document.createElement("input");
    Object.assign(input, { type: "radio", name: "model", value: model });
    input.onchange = () => send({ model });
    const [name, remark] = kModels[model] ?? [model, ""];
    const small = document.createElement("small");
    small.textContent = remark;
    label.append(input, name, small);
    this.radios.set(model, input);
    return label;
  }

  // What the runtime has; a slider in the user's hand is left alone.
  show(settings) {
    this.radios.get(settings.model).checked = true;
    get("slow_hz_text").textContent = `${Number(settings.slow_hz.toPrecision(4))} Hz`;
    get("stiffness_text").textContent = settings.stiffness_scale === null ? "–" : `× ${settings.stiffness_scale.toPrecision(3)}`;
    const friction = settings.friction ?? this.stored;
    get("friction_text").textContent = friction.toFixed(2);
    get("friction_stored").checked = settings.friction === null;
    const held = document.activeElement;
    const place = (id, value) => { if (get(id) !== held) { get(id).value = value; } };
    const nearest = this.slowHz.reduce((best, hz, i) =>
      Math.abs(Math.log(hz / settings.slow_hz)) < Math.abs(Math.log(this.slowHz[best] / settings.slow_hz)) ? i : best, 0);
    place("slow_hz", nearest);
    place("stiffness", 100 * Math.log10(settings.stiffness_scale ?? 1));
    place("friction", friction);
  }
}
