// What several contacts and two hands do, in numbers and words beside the picture.

const get = (id) => document.getElementById(id);
const length = (v) => Math.hypot(...v);

export class ContactNumbers {
  // @param hands as body.json has them.
  constructor(hands) {
    this.hands = hands;
    const two = hands.length > 1;
    const turning = hands.some(({ spheres }) => spheres.length > 1);
    for (const id of ["contacts_legend", "compare_row", ...(turning ? ["torque_row", "torque_legend", "thin_legend"] : [])]) {
      get(id).hidden = false;
    }
    get("depth_name").textContent = "Deepest contact";
    get("force2_row").hidden = !two;
    get("second_legend").hidden = !two;
    document.querySelectorAll([".of_contacts", ...(two ? [".of_hands"] : []), ...(turning ? [".of_turns"] : [])].join()).forEach((row) => { row.hidden = false; });
    if (two) {
      get("force_name").textContent = `Force, ${hands[0].name}`;
      get("force2_name").textContent = `Force, ${hands[1].name}`;
      get("second_text").textContent = `the same, ${hands[1].name}`;
    }
    get("hint").textContent = two
      ? "Shift + drag pinches · Alt + wheel opens · 1 2 3 which hand · ? all keys"
      : "Shift + drag presses · Ctrl + drag turns the tool · ? all keys";
  }

  // @param put (id, text) writes where it differs.
  show(state, put) {
    const [first, second] = state.hands;
    put("torque", (length(first.torque_n_m) * 1e3).toFixed(3));
    if (second) {
      put("force2", length(second.force_n).toFixed(3));
      put("torque", state.hands.map((hand) => (length(hand.torque_n_m) * 1e3).toFixed(3)).join(", "));
    }
    const sum = (key) => state.hands.reduce((all, hand) => all + length(hand[key]), 0);
    const [coupled, added] = [sum("coupled_n"), sum("added_up_n")];
    put("body_coupled", state.compared ? coupled.toFixed(3) : "–");
    put("body_added", state.compared ? added.toFixed(3) : "–");
    const more = state.compared && coupled > 1e-6 ? Math.round(100 * (added / coupled - 1)) : null;
    put("body_more", more === null ? "" : `(${more < 0 ? "−" : "+"}${Math.abs(more)} %)`);
    put("other_text", state.coupled ? "what contacts added up would give" : "what coupled contacts give");
    put("scaled_note", state.scaled ? "some lie too close: coupled in part" : "");
    if (get("coupled") !== document.activeElement || get("coupled").checked !== state.coupled) {
      get("coupled").checked = state.coupled;
    }
  }
}
