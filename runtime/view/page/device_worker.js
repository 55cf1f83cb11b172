// Carries messages between Haply's service and the runtime (runtime_worker.js), and stands
// between the device and a runtime that hangs: after kSilentMs without its answer the force
// is zero, after kGoneMs the connection ends.

const kSilentMs = 20;
const kGoneMs = 1000;

let line = null;        // to the runtime
let states = null;
let events = null;
let latest = "";        // command
let heard = 0;          // when the runtime was last heard
let waiting = 0;        // since when it has a state without a command; 0: it has none
let own = [];           // of commands without a state yet: whether they are this worker's
let withheld = false;   // the runtime's command was not what acted
let released = false;   // this worker has put the force to zero since the latest command

const now = () => performance.now();
// Of every worker the same clock.
const instant = () => performance.timeOrigin + performance.now();
const zeroOf = (command) => command.replace(/("[xyz]":)[^,}]*/g, (all, key) => `${key}0`);

function send(command, mine) {
  states.send(command);
  own.push(mine);
}

function release() {
  if (latest !== "" && !released && states?.readyState === WebSocket.OPEN) {
    released = true;
    withheld = true;
    send(zeroOf(latest), true);
  }
}

// The last message is zero force; with the connection all that it asked for ends.
function end() {
  release();
  states?.close();
  events?.close();
  close();
}

function open(ports) {
  const socket = (port, what) => {
    const made = new WebSocket(`ws://127.0.0.1:${port}/`);
    made.onclose = () => line.postMessage(["gone", made.opened ? "the service has stopped"
      : `no ${what} at port ${port} of this computer: is Haply's service running, and may this page reach it?`]);
    return made;
  };
  // Before the first force, so that no event is missed.
  events = socket(ports.events, "events");
  events.onmessage = ({ data }) => line.postMessage(["event", data]);
  events.onopen = () => {
    events.opened = true;
    states = socket(ports.states, "service");
    states.onopen = () => { states.opened = true; };
    states.onmessage = ({ data }) => {
      const asked = own.length > 0;
      if (own.shift() !== true) {
        waiting ||= now();
        line.postMessage(["state", data, instant(), withheld, asked]);
        withheld = false;
      }
    };
  };
}

setInterval(() => {
  const silent = Math.max(waiting > 0 ? now() - waiting : 0, now() - heard - kSilentMs);
  if (latest !== "" && silent > kGoneMs) {
    line.postMessage(["gone", "the page stood still for a second"]);
    end();
  } else if (silent > kSilentMs) {
    release();
  }
}, 5);

onmessage = ({ data }) => {
  line = data.line;
  line.onmessage = ({ data: command }) => take(command);
  open(data.ports);
};

function take(command) {
  if (command === "end") {
    end();
  } else if (states?.readyState === WebSocket.OPEN) {
    const late = waiting > 0 && now() - waiting > kSilentMs;  // of a place long left
    latest = command;
    heard = now();
    waiting = 0;
    released = late;
    withheld ||= late;
    send(late ? zeroOf(command) : command, false);
  }
}
