"""A curve of known law as the files of testing machines and instruments hold it."""
import json
import struct
import zipfile

import h5py
import numpy


def curve(seed=1, samples=250, gain=1.0):
    """Displacement [m], force [N] (a Hertz-like press from 1 mm on, with noise) and time [s]."""
    random = numpy.random.default_rng(seed)
    x = numpy.linspace(0.0, 4e-3, samples)
    force = gain * 6000.0 * numpy.maximum(0.0, x - 1e-3) ** 1.5 + random.normal(0.0, 0.003, samples)
    return x, force, numpy.linspace(0.0, 8.0, samples)


# A spring of 300 N/m at once, from 0.3 mm on, that relaxes by these shares [-] and times [s].
STAIR_G, STAIR_TAU_S, STAIR_N_PER_M, STAIR_FREE_M = (0.3, 0.25), (6.0, 120.0), 300.0, 3e-4


def staircase(holds_s=(240.0, 420.0, 720.0), seed=1, speed_m_per_s=1e-4, rate_hz=5.0):
    """Displacement [m], force [N] and time [s] of ramps of 0.5 mm with a hold after each: the quasi-linear law."""
    corners = [(0.0, 0.0), (STAIR_FREE_M / speed_m_per_s, STAIR_FREE_M)]
    for step, hold_s in enumerate(holds_s, 1):
        to_m = STAIR_FREE_M + 5e-4 * step
        reached_s = corners[-1][0] + (to_m - corners[-1][1]) / speed_m_per_s
        corners += [(reached_s, to_m), (reached_s + hold_s, to_m)]
    ends_s, ways_m = numpy.array(corners).T
    t = numpy.arange(0.0, ends_s[-1], 1.0 / rate_hz)

    def response(since_s):
        """The integral of the relaxation function from 0 on."""
        s = numpy.maximum(0.0, since_s)
        return s + sum(-g * (s + tau * numpy.expm1(-s / tau)) for g, tau in zip(STAIR_G, STAIR_TAU_S))

    force = 0.01 + numpy.random.default_rng(seed).normal(0.0, 1e-3, t.size)
    for i in range(1, len(corners) - 1):
        slope = STAIR_N_PER_M * (ways_m[i + 1] - ways_m[i]) / (ends_s[i + 1] - ends_s[i])
        force += slope * (response(t - ends_s[i]) - response(t - ends_s[i + 1]))
    return numpy.interp(t, ends_s, ways_m), force, t


def stairs(folder, **options):
    x, f, t = staircase(**options)
    file = folder / "stairs.csv"
    file.write_text(_lines(["Time (s),Travel (mm),Load (N)"], t, x * 1e3, f))
    return file, []


def _lines(head, *columns, separator=","):
    rows = [separator.join(map(repr, row)) for row in zip(*(column.tolist() for column in columns))]
    return "\n".join([*head, *rows]) + "\n"


def plain(folder):
    x, f, t = curve()
    file = folder / "plain.csv"
    file.write_text(_lines(["Time (s),Travel (mm),Load (N)"], t, x * 1e3, f))
    return file, []


def decimal_commas(folder):
    x, f, _ = curve(2)
    file = folder / "commas.txt"
    file.write_text(_lines(["Weg;Kraft", "mm;N"], x * 1e3, f, separator=";").replace(".", ","))
    return file, []


def bluehill(folder):
    head = ['"Results Table {}"', '"Time","Extension","Load"', '"(s)","(mm)","(kN)"']
    text = ""
    for i in (1, 2):
        x, f, t = curve(i, gain=i)
        text += _lines([head[0].format(i), *head[1:]], t, x * 1e3, f * 1e-3)
    file = folder / "bluehill.csv"
    file.write_text(text)
    return file, ["--press", "2"]


def loops(folder):
    x, f, _ = curve(3)
    back, zero = x[::-20], numpy.zeros(len(x[::-20]))
    file = folder / "loops.csv"
    file.write_text(_lines(["Travel (mm),Load (N)"], 1e3 * numpy.concatenate([x, back, x]),
                           numpy.concatenate([f, zero, 1.5 * f])))
    return file, ["--press", "2"]


def mach1(folder):
    x, f, t = curve(4)
    zero = numpy.zeros(len(x))
    head = ["<Mach-1 File>", "<INFO>", "Date:\tx", "<END INFO>", "<Normal Indentation>",
            "Contacts mapping (x, y, z):\t1\t2\t3", "Surface Normal (x, y, z):\t0\t0\t1", "<DATA>",
            "Time, s\tPosition (z), mm\tPosition (x), mm\tPosition (y), mm\tFx, N\tFy, N\tFz, N"]
    file = folder / "mach1.txt"
    text = _lines(head, t, x * 1e3, zero, zero, zero, zero, f, separator="\t") + "<divider>\n<END DATA>\n"
    file.write_text(text.replace("\n", "\r\n"))
    return file, []


def optics11(folder):
    x, f, t = curve(5)
    zero = numpy.zeros(len(x))
    head = ["X-position (um)\t1", "Y-position (um)\t2", "k (N/m)\t0.5", "Tip radius (um)\t25",
            "Time (s)\tLoad (uN)\tIndentation (nm)\tCantilever (nm)\tPiezo (nm)"]
    file = folder / "optics11.txt"
    file.write_text(_lines(head, t, f * 1e6, numpy.maximum(0.0, x - 1e-3) * 1e9, zero, x * 1e9, separator="\t"))
    return file, []


def afm_text(folder):
    x, f, t = curve(6)
    head = ["# BEGIN METADATA", "# " + json.dumps({"point count": len(x), "spring constant": 1e4}), "# END METADATA",
            "# force\theight (measured)\ttime"]
    file = folder / "curve.tab"
    file.write_text(_lines(head, f, -x, t, separator="\t"))
    return file, []


def afm_hdf5(folder):
    file = folder / "afm.h5"
    with h5py.File(file, "w") as h5:
        for number in (0, 1):
            x, f, t = curve(7 + number)
            group = h5.create_group(str(number))
            for name, values, unit in (("force", f, "N"), ("tip position", -x, "m"), ("time", t, "s")):
                group[name] = values
                group[name].attrs["unit"] = unit
    return file, ["--press", "1"]


def workbook(folder):
    x, f, _ = curve(9)
    rows = [f'<row r="1"><c r="A1" t="inlineStr"><is><t>{a}</t></is></c>'
            f'<c r="B1" t="inlineStr"><is><t>{b}</t></is></c></row>' for a, b in [("Travel (mm)", "Load (N)")]]
    rows += [f'<row r="{i}"><c r="A{i}"><v>{a!r}</v></c><c r="B{i}"><v>{b!r}</v></c></row>'
             for i, (a, b) in enumerate(zip((1e3 * x).tolist(), f.tolist()), 2)]
    file = folder / "book.xlsx"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("xl/workbook.xml", '<workbook xmlns:r="r"><sheets><sheet name="Probe" sheetId="1" r:id="rA"/>'
                                            "</sheets></workbook>")
        archive.writestr("xl/_rels/workbook.xml.rels", '<Relationships><Relationship Id="rA" '
                                                       'Target="worksheets/sheet1.xml"/></Relationships>')
        archive.writestr("xl/worksheets/sheet1.xml",
                         f"<worksheet><sheetData>{''.join(rows)}</sheetData></worksheet>")
    return file, []


def _slot(name, base, multiplier, offset, unit):
    key = f"conversion-set.conversion.{name}."
    return [f"{key}defined=true", f"{key}base-calibration-slot={base}", f"{key}scaling.multiplier={multiplier}",
            f"{key}scaling.offset={offset}", f"{key}scaling.unit.unit={unit}"]


def jpk(folder):
    x, f, _ = curve(10)
    raw = {"height": numpy.round((x - 2e-3) / 1e-6).astype(int), "vDeflection": numpy.round(f / 1e-6).astype(int)}
    encoder = ["encoder.scaling.multiplier=1.0", "encoder.scaling.offset=0.0", "encoder.scaling.unit.unit=V",
               "conversion-set.conversions.base=volts"]
    keys = {"height": ["encoder.type=signedshort", *encoder, "conversion-set.conversions.default=nominal",
                       *_slot("nominal", "volts", -1e-6, 0.0, "m")],
            "vDeflection": ["encoder.type=signedinteger", *encoder, "conversion-set.conversions.default=force",
                            *_slot("distance", "volts", 1e-9, 0.0, "m"), *_slot("force", "distance", 1e3, 0.0, "N")]}
    header = ["#Thu Mar 31", "force-segment-header.settings.style=extend", "force-segment-header.duration=2.0"]
    for channel, lines in keys.items():
        header += [f"channel.{channel}.data.file.name=channels/{channel}.dat",
                   f"channel.{channel}.data.num-points={len(x)}", *(f"channel.{channel}.{line}" for line in lines)]
    file = folder / "curve.jpk-force"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("header.properties", "force-scan-series.header.position.x=1.0E-5\n"
                                              "force-scan-series.header.position.y=-2.0E-5\n")
        archive.writestr("segments/0/segment-header.properties", "\n".join(header) + "\n")
        for channel, code in (("height", "h"), ("vDeflection", "i")):
            archive.writestr(f"segments/0/channels/{channel}.dat", struct.pack(f">{len(x)}{code}", *raw[channel]))
    return file, []


ALL = [plain, decimal_commas, bluehill, loops, mach1, optics11, afm_text, afm_hdf5, workbook, jpk]
