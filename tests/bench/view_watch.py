"""Whether a page that watches disturbs the device's loop: late ticks without and with one.

view_watch.py PALPATE-RUN DATABASE [SECONDS] [DEVICE]: the device renders for SECONDS (60); in
the second half a page watches, at 60 frames a second, by a bare WebSocket. Prints the ticks of
each half and how many of them came after a missed deadline.
"""

import json
import subprocess
import sys
import time

import websocket


def connect(address):
    host, token = address.split("/")[2], address.split("#")[1]
    return websocket.create_connection(f"ws://{host}/live", origin=f"http://{host}",
                                       subprotocols=["palpate.1", token], timeout=20)


def next_run(socket):
    while True:
        message = json.loads(socket.recv())
        if message["type"] == "state":
            return message["run"], len(message["trace"]["time_s"])


def main():
    tool, database = sys.argv[1:3]
    seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 60.0
    device = sys.argv[4] if len(sys.argv) > 4 else "emulated-falcon"
    run = subprocess.Popen([tool, "view", database, "--device", device, "--limit-stiffness",
                            "--seconds", str(seconds)],
                           stdout=subprocess.PIPE, text=True)
    address = run.stdout.readline().strip()
    if not address:
        sys.exit(run.wait())
    time.sleep(seconds / 2)
    socket = connect(address)
    before, _ = next_run(socket)
    latest, frames, shown = before, 0, 0
    try:
        while True:
            latest, ticks = next_run(socket)
            frames += 1
            shown += ticks
    except (websocket.WebSocketException, OSError):
        pass  # the run is over
    run.communicate()
    ticks, late = before["ticks"], before["late_ticks"]
    with_ticks, with_late = latest["ticks"] - ticks, latest["late_ticks"] - late
    print(f"without a page: {ticks} ticks, {late} late ({100 * late / max(1, ticks):.3f} %)")
    print(f"with a page:    {with_ticks} ticks, {with_late} late "
          f"({100 * with_late / max(1, with_ticks):.3f} %), {frames} frames, {shown} ticks shown")


main()
