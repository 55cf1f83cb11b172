#!/usr/bin/env python3
"""A driver for palpate: a tool of 0.1 kg that a hand presses down and lifts again.
  driver.py SOCKET X Y Z      the place above the body to start from [m]
Put your device, your tracker or your simulation where it says "the device"."""
import math
import os
import socket
import struct
import sys
import time

HELLO = struct.Struct("=8s5d")  # magic, damping, Coulomb, resolution, delay, largest force
# Time, position, withheld, sequence, done, missed, turn (w, x, y, z). Without the turn
# and with "palpdev2", if yours does not know how it is turned.
STATE = struct.Struct("=q3d3dQqQ4d")
COMMAND = struct.Struct("=Q3d")  # sequence, force


def main():
    if len(sys.argv) != 5:
        sys.exit("usage: driver.py SOCKET X Y Z")
    path, start = sys.argv[1], [float(word) for word in sys.argv[2:]]
    if os.path.exists(path):
        os.unlink(path)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    listener.bind(path)
    listener.listen(1)
    end, _ = listener.accept()
    end.send(HELLO.pack(b"palpdev3", 0.5, 0.0, 0.0, 1e-3, 5.0))
    end.setblocking(False)

    x, v, step, mass = list(start), [0.0, 0.0, 0.0], 1e-3, 0.1
    sequence, force, largest = 0, (0.0, 0.0, 0.0), 0.0
    begin = heard = time.monotonic_ns()
    while True:
        try:
            while datagram := end.recv(COMMAND.size):
                sequence, *force = COMMAND.unpack(datagram)
                heard = time.monotonic_ns()
            break  # its end is closed
        except BlockingIOError:
            pass
        now = time.monotonic_ns()
        if now - heard > 20_000_000:  # silent: let go
            sequence, force = 0, (0.0, 0.0, 0.0)
        hand = list(start)
        hand[2] -= 0.006 * (1.0 - math.cos(3.14 * (now - begin) * 1e-9))
        for i in range(3):  # the device
            v[i] += step / mass * (force[i] + 300.0 * (hand[i] - x[i]) - 5.0 * v[i])
            x[i] += step * v[i]
        tilt = 0.05 * math.sin(2.0 * (now - begin) * 1e-9)  # half of it, about x
        turn = (math.cos(tilt), math.sin(tilt), 0.0, 0.0)
        largest = max(largest, abs(force[2]))
        try:
            done = time.monotonic_ns()
            end.send(STATE.pack(now, *x, 0.0, 0.0, 0.0, sequence, done, 0, *turn))
        except BlockingIOError:
            pass  # the renderer is busy: it takes the next
        except OSError:
            break
        time.sleep(step)
    print(f"largest force {largest:.3f} N, last {abs(force[2]):.3f} N")


if __name__ == "__main__":
    main()
