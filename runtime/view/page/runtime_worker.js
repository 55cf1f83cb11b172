// The runtime of a page without a server: runtime/view/page_module.cc, compiled to
// WebAssembly. Messages are those of the live view's socket.

const kFrameMs = 1000 / 60;
const kWatchMs = 5;

let exported = null;
let device = null;  // line to the worker that carries messages of the page's own device
const memory = () => new Uint8Array(exported.memory.buffer);
const encoder = new TextEncoder();
const decoder = new TextDecoder();

// What the C library asks of a system: a clock, and somewhere to complain.
const system = {
  clock_time_get: (which, precision, at) => {
    new DataView(exported.memory.buffer).setBigUint64(at, BigInt(Math.round(1e6 * performance.now())), true);
    return 0;
  },
  fd_write: (descriptor, parts, count, written) => {
    const view = new DataView(exported.memory.buffer);
    let bytes = 0;
    let text = "";
    for (let i = 0; i < count; ++i) {
      const [at, size] = [view.getUint32(parts + 8 * i, true), view.getUint32(parts + 8 * i + 4, true)];
      text += decoder.decode(memory().subarray(at, at + size));
      bytes += size;
    }
    console.error(text);
    view.setUint32(written, bytes, true);
    return 0;
  },
  environ_sizes_get: (count, bytes) => {
    const view = new DataView(exported.memory.buffer);
    view.setUint32(count, 0, true);
    view.setUint32(bytes, 0, true);
    return 0;
  },
  environ_get: () => 0,
  proc_exit: (code) => { throw new Error(`the runtime ended with code ${code}`); },
};
// It has no files, which is what the C library looks for when it starts.
const kNoDescriptor = 8;
const imports = {
  wasi_snapshot_preview1: new Proxy(system, { get: (all, name) => all[name] ?? (() => kNoDescriptor) }),
};

// Puts bytes where the module reads them.
function give(bytes) {
  const at = exported.palpate_page_room(bytes.length);  // memory may have grown
  memory().set(bytes, at);
}

// Texts and bytes that the module has ready.
const bytesAt = (begin, size) => memory().slice(begin, begin + size);
const ready = (size) => bytesAt(exported.palpate_page_ready(), size);

// Whether a device is wanted, and what is to be said to it, after each call.
function followDevice() {
  const command = exported.palpate_page_device_command();
  if (command > 0) {
    device?.postMessage(decoder.decode(ready(command)));
  }
  if (exported.palpate_page_device_active() === 0) {
    device?.postMessage("end");
    device = null;
  } else {
    device ??= lineToDevice();
  }
}

function lineToDevice() {
  const { port1: line, port2: end } = new MessageChannel();
  postMessage(["device", end], [end]);
  line.onmessage = ({ data: [type, text, instant, withheld, asked] }) => {
    if (line !== device) {
      return;
    }
    guarded(() => {
      const now = performance.now();
      give(encoder.encode(text));
      if (type === "state") {
        exported.palpate_page_device_hear(now, Math.min(now, instant - performance.timeOrigin), withheld, asked);
      } else if (type === "event") {
        exported.palpate_page_device_event();
      } else {
        exported.palpate_page_device_gone();
      }
      followDevice();
    });
  };
  return line;
}

async function start({ module, database, name, tools, device_ports: ports }) {
  const { instance } = await WebAssembly.instantiate(module, imports);
  exported = instance.exports;
  exported._initialize();
  for (const text of [name, ...tools]) {
    give(encoder.encode(text));
    exported.palpate_page_name();
  }
  exported.palpate_page_ports(ports.states, ports.events);
  
  give(new Uint8Array(database));
  const refused = exported.palpate_page_open();
  if (refused > 0) {
    throw new Error(decoder.decode(ready(refused)));
  }
  const text = decoder.decode(ready(exported.palpate_page_text()));
  const { buffer } = ready(exported.palpate_page_body());
  postMessage(["started", { text, bytes: buffer }], [buffer]);
}

function tell() {
  for (let size = exported.palpate_page_take(); size > 0; size = exported.palpate_page_take()) {
    postMessage(["text", decoder.decode(ready(size))]);
  }
}

function guarded(act) {
  try {
    act();
  } catch (error) {
    clearInterval(timer);
    timer = null;
    device?.postMessage("end");
    device = null;
    postMessage(["failed", error.message]);
  }
}

let timer = null;
onmessage = ({ data }) => {
  if (typeof data === "object") {
    start(data).catch((error) => postMessage(["failed", error.message]));
  } else if (data === "go") {
    timer = setInterval(() => guarded(() => {
      exported.palpate_page_frame(performance.now());
      tell();
      followDevice();
    }), kFrameMs);
    setInterval(() => device !== null && guarded(() => {
      exported.palpate_page_device_watch(performance.now());
      followDevice();
    }), kWatchMs);
  } else if (timer !== null) {
    guarded(() => {
      give(encoder.encode(data));
      exported.palpate_page_receive();
      followDevice();
    });
  }
};
