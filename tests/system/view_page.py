"""Drives the live view's page in headless Chromium and prints what it saw, as JSON.

view_page.py PALPATE-RUN DATABASE [FOLDER for pictures]
             [--no-3d | --dimple | --standing | --contacts | --pinch | --needle | --friction | --touch | --device]
view_page.py --own PAGE.html [FOLDER for pictures] [the same]: a page of its own, from a
file; "log" is what its runtime was asked and told, in order. "refused": why it did not start.
"""

import json
import signal
import subprocess
import sys

import websocket
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

PATIENCE_S = 60  # software rendering on a busy machine


def browser(flags, size):
    options = Options()
    for flag in ["--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--no-first-run",
                 "--disable-background-networking", "--disable-component-update",
                 "--disable-sync", f"--window-size={size}"] + flags:
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


class Watcher:
    """A second page: what the runtime says, past the first page. It connects anew each
    time: the server drops a page that does not read."""

    def __init__(self, address):
        self.host, self.token = address.split("/")[2], address.split("#")[1]

    def __enter__(self):
        self.socket = websocket.create_connection(
            f"ws://{self.host}/live", origin=f"http://{self.host}",
            subprotocols=["palpate.1", self.token], timeout=20)
        self.role = json.loads(self.socket.recv())["role"]
        return self

    def __exit__(self, *_):
        self.socket.close()

    def next(self, kind):
        while True:
            message = json.loads(self.socket.recv())
            if message["type"] == kind:
                return message

    def state(self):
        with self:
            return self.next("state")

    def refusal(self, message):
        with self:
            self.socket.send(json.dumps(message))
            return self.role, self.next("refused")["why"]


class OwnWatcher:
    """Of a page of its own nobody else hears the runtime."""

    def __init__(self, driver):
        self.driver = driver

    def state(self):
        return self.driver.execute_script("return { ...window.palpate.state, trace: null };")


# Before a page of its own starts: its worker keeps what it is asked, when frames are, and
# what it tells, and gives it out when asked for.
LISTEN = """
const listen = `{
  const log = [];
  const post = self.postMessage.bind(self);
  self.postMessage = (message, more) => {
    const state = message[0] === "text" ? JSON.parse(message[1]) : {};
    if (state.type === "state") {
      const { force_n, depth_m, stored_j, memory_j, fault, hands } = state;
      log.push({ told: { force_n, depth_m, stored_j, memory_j, fault,
        hands: (hands ?? []).map((hand) => [...hand.force_n, ...hand.torque_n_m]) } });
    }
    post(message, more);
  };
  addEventListener("message", (event) => {
    if (event.data === "log") {
      event.stopImmediatePropagation();
      post(["log", log]);
    } else if (typeof event.data === "number") {  // [ms] that it hangs
      event.stopImmediatePropagation();
      for (const begin = performance.now(); performance.now() - begin < event.data;) {}
    } else if (typeof event.data === "string" && event.data !== "go") {
      log.push({ text: event.data });
    }
  });
  const make = WebAssembly.instantiate;
  WebAssembly.instantiate = async (...all) => {
    const { instance: { exports } } = await make(...all);
    let room = [0, 0];
    const given = () => new TextDecoder().decode(new Uint8Array(exports.memory.buffer, ...room));
    const heard = {
      palpate_page_frame: (now) => ({ now }),
      palpate_page_device_watch: (watch) => ({ watch }),
      palpate_page_device_hear: (...hear) => ({ hear, given: given() }),
      palpate_page_device_event: () => ({ event: given() }),
      palpate_page_device_gone: () => ({ gone: given() }),
    };
    const wrapped = Object.entries(heard).map(([name, entry]) => [name, (...all) => {
      log.push(entry(...all));
      return exports[name](...all);
    }]);
    return { instance: { exports: { ...exports, ...Object.fromEntries(wrapped), palpate_page_room: (size) => {
      room = [exports.palpate_page_room(size), size];
      return room[0];
    } } } };
  };
}`;
const RealBlob = Blob;
window.Blob = class extends RealBlob {
  constructor(parts, options) {
    super(String(parts[0]).includes("wasi_snapshot_preview1") ? [listen, ...parts] : parts, options);
  }
};
const RealWorker = Worker;
window.Worker = class extends RealWorker {
  constructor(address) {
    super(address);
    window.listened ??= this;
  }
};
"""

LOG = """
const done = arguments[0];
window.listened.addEventListener("message", ({ data: [type, log] }) => type === "log" && done(log));
window.listened.postMessage("log");
"""

PACE = """
const done = arguments[0], begin = performance.now();
let frames = 0;
const count = (now) => now - begin > 2000 ? done(1000 * frames / (now - begin)) : (++frames, requestAnimationFrame(count));
requestAnimationFrame(count);
"""


class Page:
    def __init__(self, driver, folder):
        self.driver, self.folder = driver, folder
        self.body = driver.find_element(By.TAG_NAME, "body")

    def text(self, element):
        return self.driver.find_element(By.ID, element).text

    def number(self, element):
        return float(self.text(element))

    def wait(self, condition):
        WebDriverWait(self.driver, PATIENCE_S, poll_frequency=0.1).until(lambda _: condition())

    def steady(self, element="force"):
        """Waits until a number stands still; a stall of the page may let go meanwhile."""
        last = [None, 0]

        def same():
            value = self.text(element)
            last[:] = [value, last[1] + 1 if value == last[0] else 0]
            return last[1] >= 5 and self.text("state") == "pressing" and float(value) > 0.01

        self.wait(same)
        return self.number(element)

    def keys(self, keys):
        self.body.send_keys(keys)

    def entry(self):
        """Of the first channel on the canvas, from its middle [pixels]."""
        return self.driver.execute_script("""
            const { view, state } = window.palpate;
            const at = view.vector(state.needle.channels[0].entry_m).project(view.camera);
            return [0.5 * at.x * view.width, -0.5 * at.y * view.height].map(Math.round);""")

    def picture(self, name):
        if self.folder:
            self.driver.save_screenshot(f"{self.folder}/{name}.png")


def in_a_frame(page, script):
    """What a script returns after the page has drawn, before it hears anything new."""
    return page.driver.execute_async_script(
        "const done = arguments[0], read = () => {" + script + "};"
        "requestAnimationFrame(() => requestAnimationFrame(() => done(read())));")


# Where the tools are, to a micrometre.
WHERE = """
const { state } = window.palpate;
return [state, ...state.hands ?? []].map((part) => part.tool_m?.map((x) => x.toFixed(6)).join()).join(";");
"""


def settled(page):
    """Waits until the tools stand still."""
    where = []

    def same():
        where.append(in_a_frame(page, WHERE))
        return len(where) > 1 and where[-1] == where[-2]

    page.wait(same)


def paused_in_contact(page, watcher):
    """Pauses; once more where the page stalled just then and so let go."""
    for _ in range(5):
        page.keys(Keys.SPACE)
        page.wait(lambda: page.text("state") == "paused")
        settled(page)
        state = watcher.state()
        if any(state["force_n"]):
            return state
        page.keys(Keys.SPACE)
        page.steady()
    raise RuntimeError("the page stalls too often to press")


def poke_by_mouse(page, watcher, seen):
    canvas = page.driver.find_element(By.ID, "canvas")
    ActionChains(page.driver).key_down(Keys.SHIFT).move_to_element(canvas).click_and_hold().perform()
    page.wait(lambda: page.number("force") > 0.01)
    seen["mouse_force_n"] = page.steady()
    for _ in range(3):
        page.driver.execute_script(
            "arguments[0].dispatchEvent(new WheelEvent('wheel', {deltaY: -120, bubbles: true, cancelable: true}))", canvas)
    page.wait(lambda: page.number("force") > 1.05 * seen["mouse_force_n"])
    seen["deeper_force_n"] = page.steady()
    state = paused_in_contact(page, watcher)
    seen["paused"] = {
        "shown_force_n": page.text("force"), "shown_depth_mm": page.text("depth"),
        "shown_energy_mj": page.text("energy"), "force_n": state["force_n"],
        "depth_m": state["depth_m"], "stored_j": state["stored_j"], "fault": state["fault"]}
    page.picture("pressed")
    page.keys(Keys.SPACE)
    ActionChains(page.driver).release().key_up(Keys.SHIFT).perform()
    page.wait(lambda: page.text("state") == "free")
    page.wait(lambda: page.text("force") == "0.000")
    seen["released_force_n"] = watcher.state()["force_n"]


def poke_by_keys(page, seen):
    page.keys("p")
    page.wait(lambda: page.number("force") > 0.01)
    seen["keys_force_n"] = page.steady()
    page.keys(Keys.ENTER)
    page.wait(lambda: "node" in page.text("curve_title"))
    seen["curve"] = page.text("curve_facts")
    page.keys("]]]]]")
    page.wait(lambda: page.number("force") > 1.05 * seen["keys_force_n"])
    page.picture("keys")
    page.keys(Keys.ESCAPE)
    page.wait(lambda: page.text("force") == "0.000" and page.text("state") == "free")


CAMERA = "return window.palpate.view.camera.position.toArray();"


def touch(page, watcher, seen):
    """Fingers: one on the body, a second one beside it, one beside the body, a tap."""
    tell = page.driver.execute_cdp_cmd
    tell("Emulation.setTouchEmulationEnabled", {"enabled": True, "maxTouchPoints": 2})
    canvas = page.driver.find_element(By.ID, "canvas").rect
    middle = {"x": canvas["x"] + canvas["width"] / 2, "y": canvas["y"] + canvas["height"] / 2, "id": 0}
    beside = {"x": canvas["x"] + 12, "y": canvas["y"] + 150, "id": 1}

    def fingers(kind, *at):
        tell("Input.dispatchTouchEvent", {"type": kind, "touchPoints": list(at)})

    fingers("touchStart", middle)
    page.wait(lambda: page.number("force") > 0.01)
    seen["finger_force_n"] = page.steady()
    page.picture("finger")
    fingers("touchStart", middle, beside)
    page.wait(lambda: page.text("state") == "free" and page.text("force") == "0.000")
    fingers("touchEnd")
    seen["camera"] = [in_a_frame(page, CAMERA)]
    fingers("touchStart", beside)
    for step in range(1, 6):
        fingers("touchMove", {**beside, "x": beside["x"] + 20 * step})
    fingers("touchEnd")
    settled(page)
    seen["camera"].append(in_a_frame(page, CAMERA))
    seen["turned_force"] = page.text("force")
    fingers("touchStart", middle)
    fingers("touchEnd")
    page.wait(lambda: "node" in page.text("curve_title"))


# The surface and the tool as they are drawn, beside what the runtime said of them.
DRAWN = """
const { view, body, state } = window.palpate;
const now = view.surface.geometry.attributes.position.array;
let lowest = Infinity;
view.tool.updateMatrixWorld(true);
view.tool.traverse((part) => {
  const corner = part.geometry?.attributes.position;
  for (let i = 0; i < (corner?.count ?? 0); ++i) {
    lowest = Math.min(lowest, view.centre.clone().fromBufferAttribute(corner, i).applyMatrix4(part.matrixWorld).z);
  }
});
return {
  moved_m: Array.from(now, (x, i) => x - body.position[i]), lowest_m: lowest,
  tool_m: state.tool_m, nodes: state.contact_nodes, shares: state.contact_shares,
  contact_m: state.contact_m, penetration_m: state.penetration_m, depth_m: state.depth_m,
  label: document.getElementById("template").textContent,
};
"""


PLACES = [("left", 2 * Keys.ARROW_RIGHT + Keys.ARROW_UP), ("middle", 2 * Keys.ARROW_RIGHT),
          ("right", 4 * Keys.ARROW_RIGHT)]


def dimples(page, watcher, seen, places):
    """Presses at these places, each further to the right."""
    seen["dimples"] = []
    for name, slide in places:
        page.keys(slide)
        page.keys("p")
        page.steady()
        paused_in_contact(page, watcher)
        page.picture(f"dimple_{name}")
        seen["dimples"].append(in_a_frame(page, DRAWN))
        page.keys(Keys.ESCAPE)
        page.keys(Keys.SPACE)
        page.wait(lambda: page.text("state") == "free")


# Tools, arrows and numbers of several contacts, beside what the runtime said of them.
HANDS = """
const { view, state } = window.palpate;
const end = (arrow) => arrow.heads[0].position.toArray();
const place = (mesh) => mesh.getWorldPosition(view.centre.clone()).toArray();
view.scene.updateMatrixWorld(true);
const text = (id) => document.getElementById(id).textContent;
return {
  state,
  metres_per_n: view.metresPerNewton, metres_per_n_m: view.contacts.metresPerNewtonMetre,
  drawn: view.contacts.hands.map((hand) => ({
    spheres: hand.group.children.filter((part) => part.geometry.type === "SphereGeometry").map(place),
    force: end(hand.force), other: end(hand.other), torque: end(hand.torque),
    thin: hand.contact.filter((arrow) => arrow.shaft.visible).map(end),
  })),
  force: text("force"), force2: text("force2"), torque: text("torque"),
  coupled: text("body_coupled"), added: text("body_added"), other: text("other_text"),
  hands: document.getElementById("which_hand").checkVisibility(), error: text("coupling_error"),
  lowered_m: view.body.position[2] - view.surface.geometry.attributes.position.array[2], label: text("template"),
  tool: text("what"), switched: document.getElementById("coupled").checked,
};
"""


def click_in_the_middle(page):
    ActionChains(page.driver).move_to_element(page.driver.find_element(By.ID, "canvas")).click().perform()


def hands(page):
    """The page's hands once they stand still."""
    settled(page)
    return in_a_frame(page, HANDS)


def contacts(page, watcher, seen):
    """A tool of several contacts: pressed, turned by keys and by dragging, uncoupled."""
    click_in_the_middle(page)
    page.keys("p")
    page.steady()
    seen["flat"] = hands(page)
    page.keys("eeeekkkk")
    page.wait(lambda: page.number("torque") > 0.1)
    canvas = page.driver.find_element(By.ID, "canvas")
    ActionChains(page.driver).key_down(Keys.CONTROL).move_to_element(canvas).click_and_hold() \
        .move_by_offset(20, -15).release().key_up(Keys.CONTROL).perform()
    page.steady()
    paused_in_contact(page, watcher)
    seen["turned"] = hands(page)
    page.picture("contacts_turned")
    page.keys(Keys.SPACE)
    page.keys("u")
    page.steady()
    page.keys("c")
    page.wait(lambda: page.text("other_text") == "what coupled contacts give")
    seen["uncoupled"] = hands(page)
    page.keys(Keys.ESCAPE)
    page.wait(lambda: page.text("state") == "free")
    page.keys("p")
    page.steady()
    seen["again"] = hands(page)
    page.picture("contacts_uncoupled")


def pinch(page, watcher, seen):
    """Two hands: both at once, closer, one alone, and one by the mouse while the other holds."""
    click_in_the_middle(page)
    page.keys("p")
    page.wait(lambda: page.number("force2") > 0.01)
    page.steady()
    seen["both"] = hands(page)
    page.picture("pinch_open")
    page.keys("=" * 6)
    page.steady()
    seen["opened"] = hands(page)
    page.keys("2p")  # the second lets go
    page.wait(lambda: page.text("force2") == "0.000")
    page.steady()
    seen["first_alone"] = hands(page)
    canvas = page.driver.find_element(By.ID, "canvas")
    ActionChains(page.driver).key_down(Keys.SHIFT).move_to_element(canvas).move_by_offset(90, 10).click_and_hold().perform()
    page.wait(lambda: page.number("force2") > 0.01)
    page.steady()
    seen["by_mouse"] = hands(page)
    page.picture("pinch_by_mouse")
    ActionChains(page.driver).release().key_up(Keys.SHIFT).perform()
    page.wait(lambda: page.text("force2") == "0.000")
    seen["released"] = hands(page)


# A needle as it is drawn and plotted, beside what the runtime said of it.
NEEDLE = """
const { view, state, needle } = window.palpate;
view.scene.updateMatrixWorld(true);
const end = (tube) => tube.localToWorld(view.centre.clone().set(0, 1, 0)).toArray();
const text = (id) => document.getElementById(id).textContent;
return {
  state: { ...state, trace: null },
  tubes: view.needle.channels.map(({ tubes }) => tubes.filter(({ visible }) => visible).map(end)),
  tip: view.needle.inside.visible ? end(view.needle.inside) : null,
  marks: needle.plot.marks, points: needle.plot.passes.map(({ length }) => length),
  deepest_mm: Math.max(...needle.plot.passes.flat().map(([mm]) => mm)),
  force: text("force"), depth: text("depth"), membranes: text("membranes"), rupture: text("rupture"),
  layer: text("layer_now"), plotted: document.getElementById("needle_plot").checkVisibility(),
  rubs: state.friction !== undefined || [...document.querySelectorAll(".of_friction")].some((part) => part.checkVisibility()),
};
"""


def device(page, watcher, seen):
    """Asks for the page's own device, presses, lets its runtime hang, and lets go."""
    state = watcher.state
    page.driver.find_element(By.ID, "device_limit").click()
    page.driver.find_element(By.ID, "device").click()
    page.wait(lambda: state()["device"]["phase"] == "testing")
    seen["told"] = page.text("device_text")
    page.wait(lambda: state()["device"]["phase"] != "testing")
    seen["device"] = state()["device"]
    seen["settings"] = state()["settings"]
    if seen["device"]["phase"] != "on":
        return
    page.wait(lambda: state()["state"] == "pressing" and state()["depth_m"] > 0.001)
    page.picture("device")
    page.keys("p")  # the pointer does not press beside it
    canvas = page.driver.find_element(By.ID, "canvas")
    ActionChains(page.driver).key_down(Keys.SHIFT).move_to_element(canvas).click().key_up(Keys.SHIFT).perform()
    seen["holding"] = state()["holding"]
    seen["phase"] = state()["device"]["phase"]
    seen["hz"] = state()["device"]["hz"]
    page.driver.execute_script("window.listened.postMessage(120);")  # its runtime hangs
    page.wait(lambda: state()["state"] == "free")
    seen["after"] = state()["device"]["phase"]
    page.wait(lambda: state()["state"] == "pressing" and state()["depth_m"] > 0.001)
    page.driver.execute_script("window.listened.postMessage(900);")
    page.wait(lambda: state()["device"]["phase"] == "off")
    seen["hung"] = page.text("device_text")
    page.keys("r")
    page.wait(lambda: state()["fault"] == "none")
    page.driver.find_element(By.ID, "device").click()
    page.wait(lambda: state()["device"]["phase"] == "testing")
    page.keys(Keys.ESCAPE)
    page.wait(lambda: state()["device"]["phase"] == "off")
    seen["off"] = page.text("device_text")
    poke_by_keys(page, seen)


def inserted(page):
    return int(page.text("membranes")) > 0 and "tip in" in page.text("layer_now")


def needle(page, watcher, seen):
    """A needle: pushed in by keys until membranes break, pulled back, let go, and inserted again."""
    page.keys("p")
    page.wait(lambda: page.number("force") > 0.01)
    seen["before"] = in_a_frame(page, NEEDLE)

    def deeper():
        if page.text("state") == "free":  # a stall of the page has let go
            page.keys("p")
        page.keys("]]]")
        return page.number("membranes") > 1

    page.wait(deeper)
    page.wait(lambda: inserted(page))
    settled(page)
    seen["inserted"] = in_a_frame(page, NEEDLE)
    page.picture("needle_in")
    page.keys(Keys.ESCAPE)
    page.wait(lambda: page.text("state") == "free" and page.text("force") == "0.000" and not inserted(page))
    settled(page)
    seen["withdrawn"] = in_a_frame(page, NEEDLE)
    page.picture("needle_out")
    canvas = page.driver.find_element(By.ID, "canvas")
    page.keys("[[")
    ActionChains(page.driver).key_down(Keys.SHIFT).move_to_element_with_offset(canvas, *page.entry()).click_and_hold().perform()
    page.wait(lambda: inserted(page))
    settled(page)
    seen["again"] = in_a_frame(page, NEEDLE)
    ActionChains(page.driver).release().key_up(Keys.SHIFT).perform()
    page.wait(lambda: page.text("state") == "free")
    page.keys("r")
    page.wait(lambda: page.text("membranes") == "0")
    settled(page)
    seen["reset"] = in_a_frame(page, NEEDLE)


# The lateral spring, the surface and the loop, beside what the runtime said of them.
FRICTION = """
const { view, body, state, friction } = window.palpate;
const text = (id) => document.getElementById(id).textContent;
const { spring } = view;
const now = view.surface.geometry.attributes.position.array;
return {
  state: { ...state, trace: null, friction: { ...state.friction, trace: null } },
  anchor: spring.anchor.visible ? spring.anchor.position.toArray() : null, foot: spring.foot.position.toArray(),
  colour: spring.material.color.getHexString(),
  loop: friction.plot.loop, axis: friction.plot.axis,
  rubs: text("rubs"), mm: text("lateral_mm"), newton: text("lateral_n"),
  moved_m: Array.from(now, (x, i) => x - body.position[i]),
  plotted: document.getElementById("lateral_plot").checkVisibility(),
};
"""


# How far the contact is from the cursor [m].
LAG = """
const { place, state } = window.palpate;
return Math.hypot(...place.point.map((v, k) => v - state.contact_m[k]));
"""


def friction(page, watcher, seen):
    """A contact that is moved sideways: it sticks, slips, and goes there and back."""
    seen["above"] = in_a_frame(page, FRICTION)
    page.keys("p")
    page.steady()
    settled(page)
    seen["pressed"] = in_a_frame(page, FRICTION)
    page.keys(Keys.ARROW_RIGHT)
    page.wait(lambda: page.number("lateral_n") > 0.05)
    settled(page)
    seen["sticks"] = in_a_frame(page, FRICTION)
    page.picture("friction_sticks")
    seen["loops"] = []
    for keys in (7 * Keys.ARROW_RIGHT, 8 * Keys.ARROW_LEFT, 8 * Keys.ARROW_RIGHT):
        page.keys(keys)
        page.wait(lambda: in_a_frame(page, LAG) < 2e-3)
        settled(page)
        seen["loops"].append(in_a_frame(page, "return window.palpate.friction.plot.loop;"))
    seen["slips"] = in_a_frame(page, FRICTION)
    page.picture("friction_loop")
    page.keys(Keys.ESCAPE)
    page.wait(lambda: page.text("state") == "free" and page.text("force") == "0.000")
    seen["lifted"] = in_a_frame(page, FRICTION)


def serve(tool, database, more):
    """palpate-run view, which has printed its address."""
    which = {"--contacts": ["--tool", "pads"], "--pinch": ["--tool", "ball,pads", "--together"]}
    tools = next((which[one] for one in more if one in which), [])
    return subprocess.Popen([tool, "view", database] + tools, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


def open_served(driver, address, more, seen):
    """@return the page, and who watches it"""
    driver.get(address.split("#")[0])
    page = Page(driver, folder_of(more))
    page.wait(lambda: page.text("state") == "cannot start")
    seen["without_token"] = page.text("message")
    seen["errors_without_token"] = len([e for e in driver.get_log("browser") if e["source"] == "javascript"])
    driver.get("about:blank")
    driver.get(address)
    page = Page(driver, folder_of(more))
    page.wait(lambda: page.text("state") == "free")
    seen["address"] = driver.current_url
    watcher = Watcher(address)
    seen["watcher"], seen["refusal"] = watcher.refusal({"type": "run", "do": "reset"})
    return page, watcher


def open_own(driver, file, more, seen):
    """The same of a page of its own."""
    driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": LISTEN})
    driver.get("file://" + file)
    page = Page(driver, folder_of(more))
    page.wait(lambda: page.text("state") in ("free", "cannot start"))
    if page.text("state") != "free":
        print(json.dumps({"refused": page.text("message")}))
        return None, None
    seen["start_ms"] = driver.execute_script("return performance.now();")
    seen["loaded"] = driver.execute_script(
        "return performance.getEntriesByType('resource').map(({ name }) => name).filter((name) => !name.startsWith('blob:'));")
    return page, OwnWatcher(driver)


def folder_of(more):
    return next((one for one in more if not one.startswith("--")), None)


def play(page, watcher, more, flat, seen):
    if "--dimple" in more:
        dimples(page, watcher, seen, PLACES)
    elif "--standing" in more:
        dimples(page, watcher, seen, PLACES[:1])
    elif "--contacts" in more:
        contacts(page, watcher, seen)
    elif "--pinch" in more:
        pinch(page, watcher, seen)
    elif "--needle" in more:
        needle(page, watcher, seen)
    elif "--device" in more:
        device(page, watcher, seen)
    elif "--touch" in more:
        touch(page, watcher, seen)
    elif "--friction" in more:
        friction(page, watcher, seen)
    else:
        if not flat:
            poke_by_mouse(page, watcher, seen)
        poke_by_keys(page, seen)


def main():
    tool, database, *more = sys.argv[1:]
    flat = "--no-3d" in more
    view = None if tool == "--own" else serve(tool, database, more)
    driver = None
    seen = {}
    try:
        address = view and view.stdout.readline().strip()
        driver = browser(["--disable-3d-apis"] if flat else [], "1500,940" if folder_of(more) else "1060,640")
        page, watcher = open_served(driver, address, more, seen) if view else open_own(driver, database, more, seen)
        if page is None:
            return
        seen["no_webgl"] = driver.find_element(By.ID, "no_webgl").is_displayed()
        play(page, watcher, more, flat, seen)
        seen["errors"] = [e["message"] for e in driver.get_log("browser") if e["level"] == "SEVERE"]
        if view is None:
            seen["frames_per_s"] = driver.execute_async_script(PACE)
            seen["speed"] = watcher.state()["speed"]
            seen["log"] = driver.execute_async_script(LOG)
    finally:
        if driver:
            driver.quit()
        if view:
            view.send_signal(signal.SIGTERM)
            seen["exit_code"] = view.wait(20)
    print(json.dumps(seen))


main()
