"""What the live view costs: its share of a core while a page presses, bytes and frames a
second, and how long a pointer takes to the runtime and back to the page.

view_load.py ADDRESS PID [SECONDS]     ADDRESS as palpate-run view printed it
Needs Debian's python3-websocket.
"""

import json
import os
import statistics
import sys
import time

import websocket


def cpu_s(pid):
    fields = open(f"/proc/{pid}/stat").read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def pressed_m(state):
    """Where the (first) tool is pressed in by 2 mm."""
    if "hands" not in state:
        return [c - 0.002 * n for c, n in zip(state["contact_m"], state["normal"])]
    touch = max((one for one in state["contacts"] if one["hand"] == 0), key=lambda one: one["depth_m"])
    return [x - (0.002 - touch["depth_m"]) * n for x, n in zip(state["hands"][0]["tool_m"], touch["normal"])]


def main():
    address, pid, seconds = sys.argv[1], int(sys.argv[2]), float((sys.argv[3:] or ["10"])[0])
    host, token = address.split("/")[2], address.split("#")[1]
    socket = websocket.create_connection(f"ws://{host}/live", origin=f"http://{host}",
                                         subprotocols=["palpate.1", token])
    state = {"type": ""}
    while state["type"] != "state" or state.get("contacts") == []:
        state = json.loads(socket.recv())
    deep = pressed_m(state)
    begin, used, frames, size, delays, touching = time.time(), cpu_s(pid), 0, 0, [], 0
    sent, target = None, None
    while time.time() < begin + seconds:
        text = socket.recv()
        message = json.loads(text)
        if message["type"] != "state":
            continue
        frames, size = frames + 1, size + len(text)
        touching += any(message["force_n"])
        if target and message["pointer_m"] == target:
            delays.append(time.time() - sent)
            target = None
        if not target:
            target = [deep[0] + 1e-6 * (frames % 1000), deep[1], deep[2]]
            sent = time.time()
        socket.send(json.dumps({"type": "point", "hold": True, "target_m": target}))
    wall = time.time() - begin
    delays.sort()
    print(json.dumps({
        "share_of_a_core": round((cpu_s(pid) - used) / wall, 4), "frames_hz": round(frames / wall, 1),
        "bytes_per_frame": size // frames, "touching": round(touching / frames, 2),
        "pointer_to_page_ms": {"median": round(1e3 * statistics.median(delays), 2),
                               "p95": round(1e3 * delays[int(0.95 * len(delays))], 2)}}))


main()
