"""Responses as `palpate-db export FILE -o FILE.json` writes them, for the scripts here."""
import bisect
import json
import subprocess


def read(tools, database):
    """Places and responses of a database; a response is empty where there is none."""
    file = database.with_suffix(".json")
    subprocess.run([tools / "palpate-db", "export", database, "-o", file], check=True,
                   stdout=subprocess.DEVNULL)
    body = json.loads(file.read_text())
    return body["position_m"], [r if r and r["depth_m"] else None for r in body["response"]]


def force_at(response, position_m):
    """[N] at a penetration; depths along the force are taken for those along the normal."""
    x = [response["touch_offset_m"] + d for d in response["depth_m"]]
    f = response["force_n"]
    if position_m <= x[0]:
        return 0.0
    i = min(max(bisect.bisect_right(x, position_m), 1), len(x) - 1)
    t = (position_m - x[i - 1]) / (x[i] - x[i - 1])
    return f[i - 1] + t * (f[i] - f[i - 1])
