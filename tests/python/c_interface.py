"""palpate.h by ctypes: what the package is compared with."""
import ctypes
import os

import numpy

_NUMBERS = ("metres", "newtons", "position_gain", "force_gain", "tick", "slow_hz", "damping", "delay", "force_max",
            "stall", "ramp")


class Options(ctypes.Structure):
    _fields_ = [("struct_size", ctypes.c_size_t), ("tool_name", ctypes.c_char_p)] + [
        (name, ctypes.c_double) for name in _NUMBERS] + [("flags", ctypes.c_uint32), ("model", ctypes.c_char_p)]


class State(ctypes.Structure):
    _fields_ = [("struct_size", ctypes.c_size_t), ("status", ctypes.c_int32), ("triangle", ctypes.c_int32)] + [
        (name, ctypes.c_double * 3) for name in ("contact_point", "normal", "force")] + [
        (name, ctypes.c_double) for name in (
            "depth", "work_j", "stored_j", "tank_j", "dissipated_j", "rest_offset", "force_scale", "tilt_rad")] + [
        ("starved", ctypes.c_int32), ("extrapolated", ctypes.c_int32), ("ticks", ctypes.c_uint64)]


class Host:
    """One tool of a body in a file, slow steps its own."""

    def __init__(self, file, **options):
        self._c = ctypes.CDLL(os.environ["PALPATE_LIBRARY"])
        self._c.palpate_open.restype = self._c.palpate_tool_add.restype = ctypes.c_void_p
        given = Options(struct_size=ctypes.sizeof(Options), flags=1,
                        **{name: os.fsencode(value) if isinstance(value, str) else value
                           for name, value in options.items()})
        error = ctypes.create_string_buffer(500)
        body = self._c.palpate_open(os.fsencode(file), ctypes.byref(given), error, 500)
        assert body, error.value
        self._body = ctypes.c_void_p(body)
        self._tool = ctypes.c_void_p(self._c.palpate_tool_add(self._body))

    def slow_step(self):
        return self._c.palpate_slow_step(self._body)

    def wrench(self, position, orientation, dt):
        """Status, force, torque."""
        numbers = [numpy.array(part, float) if part is not None else None for part in (position, orientation)]
        force, torque = numpy.empty(3), numpy.empty(3)
        at, turned, f, t = (None if part is None else part.ctypes.data_as(ctypes.c_void_p)
                            for part in (*numbers, force, torque))
        status = self._c.palpate_wrench(self._tool, at, turned, ctypes.c_double(dt), f, t)
        return status, force, torque

    def force(self, position, orientation, dt):
        """Status, force."""
        at, turned, force = numpy.array(position, float), numpy.array(orientation, float), numpy.empty(3)
        pointers = [part.ctypes.data_as(ctypes.c_void_p) for part in (at, turned, force)]
        status = self._c.palpate_force(self._tool, *pointers[:2], ctypes.c_double(dt), pointers[2])
        return status, force

    def delivered(self, force):
        made = numpy.array(force, float)
        return self._c.palpate_delivered(self._tool, made.ctypes.data_as(ctypes.c_void_p), None)

    def state(self):
        state = State(struct_size=ctypes.sizeof(State))
        self._c.palpate_state_get(self._tool, ctypes.byref(state))
        return state

    def close(self):
        self._c.palpate_close(self._body)
