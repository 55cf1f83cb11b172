"""The tools that need palpate's AGPL parts, as processes."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile

from . import _palpate


class ToolsMissing(_palpate.Error):
    """A tool is not installed where it was looked for."""


# Of formats/base/error.h.
_KINDS = {2: _palpate.InputError, 3: _palpate.FormatError, 4: _palpate.NumericalError}
_PATIENCE_S = 10.0  # after Ctrl-C, before the process is killed


def find_tool(name):
    """The path of a tool: in the folder PALPATE_TOOLS, beside the package, on the PATH. ToolsMissing says where it looked."""
    package = pathlib.Path(__file__).resolve().parent
    folders = [package / "bin", package.parent.parent / "bin"]  # of a wheel; of a build folder
    given = os.environ.get("PALPATE_TOOLS")
    if given:
        folders = [pathlib.Path(given)]  # the variable is meant
    for folder in folders:
        if os.access(folder / name, os.X_OK) and (folder / name).is_file():
            return str(folder / name)
    found = None if given else shutil.which(name)
    if found:
        return found
    looked = f"PALPATE_TOOLS={given}" if given else f"{folders[0]}, {folders[1]}, PATH (PALPATE_TOOLS is not set)"
    raise ToolsMissing(f"{name} is not there: looked in {looked}; install Debian package palpate, or set PALPATE_TOOLS "
                       "to the folder of the tools")


def _stop(process):
    """As Ctrl-C in a terminal: the tool ends its own children and leaves nothing behind."""
    process.send_signal(signal.SIGINT)
    try:
        process.wait(_PATIENCE_S)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def run(name, arguments, progress=None):
    """Runs a tool with --json. Returns its exit code, report (None: not JSON) and complaint.

    progress(line) is called with each line that it says meanwhile. An exception, KeyboardInterrupt too, ends the tool.
    """
    command = [find_tool(name), *map(os.fspath, arguments), "--json"]
    lines = []
    with tempfile.TemporaryFile("w+") as out:
        with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.PIPE, text=True,
                              errors="replace", start_new_session=True) as process:
            try:
                for line in process.stderr:
                    lines = [*lines[-9:], line.rstrip()]
                    if progress is not None:
                        progress(lines[-1])
                process.wait()
            except BaseException:
                _stop(process)
                raise
        out.seek(0)
        text = out.read()
    try:
        report = json.loads(text)
    except ValueError:
        report = None
    return process.returncode, report, _complaint(name, lines)


def _complaint(name, lines):
    said = [line for line in lines if line.startswith(f"{name}: ")]
    return (said[-1][len(name) + 2:] if said else lines[-1] if lines else "it said nothing").removeprefix("error: ")


def must_run(name, arguments, progress=None):
    """run(), and the report. The tool's errors are raised as palpate's."""
    code, report, complaint = run(name, arguments, progress)
    if code == 130:
        raise KeyboardInterrupt
    if code != 0:
        kind = _KINDS.get(code, _palpate.Error)
        raise kind(complaint if code in _KINDS else f"{name} ended with {code}: {complaint}")
    return report
