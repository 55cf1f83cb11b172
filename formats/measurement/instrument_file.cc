#include "formats/measurement/instrument_file.h"

#include <algorithm>
#include <array>
#include <fstream>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/measurement/afm_file.h"
#include "formats/measurement/afm_tab_file.h"
#include "formats/measurement/cantilever_text_file.h"
#include "formats/measurement/jpk_file.h"
#include "formats/measurement/mach1_file.h"
#include "formats/measurement/machine_table.h"
#include "formats/measurement/optics11_file.h"
#include "formats/measurement/workbook_file.h"
#include "formats/measurement/zip_archive.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

bool is_hdf5(const fs::path&, std::string_view head) {
  return head.starts_with("\x89HDF\r\n\x1a\n");
}

InstrumentFile list_afm(const fs::path& file) {
  InstrumentFile result;
  for (const int number : afm_curves(file)) {
    result.curve.push_back({.number = number});
  }
  return result;
}

MeasurementFile read_afm(const fs::path& file, const InstrumentCurve& curve,
                         const InstrumentRequest&) {
  return read_afm_curve(file, curve.number);
}

InstrumentFile list_one(const fs::path&) {
  return {.curve = {InstrumentCurve{}}};
}

// The first that recognises a file has it; text is left for the last.
constexpr std::array kLayouts{
    InstrumentLayout{"afmformats HDF5", &is_hdf5, &list_afm, &read_afm},
    InstrumentLayout{"JPK force archive", &is_jpk, &list_jpk, &read_jpk},
    InstrumentLayout{"workbook", &is_workbook, &list_workbook, &read_workbook},
    InstrumentLayout{"Biomomentum Mach-1 text", &is_mach1, &list_mach1, &read_mach1},
    InstrumentLayout{"Optics11 text", &is_optics11, &list_optics11, &read_optics11},
    InstrumentLayout{"afmformats text", &is_afm_tab, &list_afm_tab, &read_afm_tab},
    InstrumentLayout{"JPK text", &is_jpk_text, &list_one, &read_jpk_text},
    InstrumentLayout{"NanoScope text", &is_nanoscope_text, &list_one,
                     &read_nanoscope_text},
    InstrumentLayout{"delimited text", &is_text, &list_tables, &read_machine_table},
};

// Binary files of others that hold no text, by how they begin, and what to do.
constexpr std::array<std::string_view, 3> kOthers[] = {
    {"\xD0\xCF\x11\xE0", "an Excel workbook before 2007 (.xls)", "save it as .xlsx"},
    {"TDSm", "a LabVIEW file (.tdms)",
     "take the text that Optics11 writes beside it, or export it as text"},
    {"\\*Force file list", "a NanoScope file of Bruker (.spm, .pfc)",
     "export the force curve as ASCII with force and separation or ramp"},
    {"\\*File list", "a NanoScope file of Bruker (.spm)",
     "export the force curve as ASCII with force and separation or ramp"},
    {"\x1F\x8B", "compressed (gzip)", "unpack it"},
    {"%PDF", "a PDF", "export the samples as text"},
};

// Versions 2 and 5, in either order of bytes, which no text begins with.
bool is_igor_wave(std::string_view head) {
  return head.size() > 64 && ((head[1] == '\0' && (head[0] == 2 || head[0] == 5)) ||
                              (head[0] == '\0' && (head[1] == 2 || head[1] == 5)));
}

void refuse_others(const fs::path& file, std::string_view head) {
  const bool binary = head.find('\0') != std::string_view::npos;
  if (is_igor_wave(head)) {
    throw FormatError(fmt::format(
        "{}: is an Igor binary wave (.ibw, Asylum Research): export it as text, or by "
        "afmformats as .h5",
        file.string()));
  }
  for (const auto& [begin, what, remedy] : kOthers) {
    if (head.starts_with(begin) && (binary || begin.front() != '\\')) {
      throw FormatError(
          fmt::format("{}: is {}, which is not read: {}", file.string(), what, remedy));
    }
  }
}

std::string head_of(const fs::path& file) {
  require_regular_file(file);
  std::string head(kInstrumentHead, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max(stream.gcount(), std::streamsize{0})));
  return head;
}

}  // namespace

const InstrumentLayout& layout_of(const fs::path& file) {
  const std::string head = head_of(file);
  refuse_others(file, head);
  const auto found = std::find_if(kLayouts.begin(), kLayouts.end() - 1,
                                  [&](const InstrumentLayout& layout) {
                                    return layout.recognises(file, head);
                                  });
  if (is_zip(head) && found == kLayouts.end() - 1) {
    throw FormatError(fmt::format(
        "{}: is a zip archive, but no JPK file and no workbook, or it is cut short; "
        "unpack it, if it holds files of measurements",
        file.string()));
  }
  return *found;
}

std::string name_curves(std::span<const InstrumentCurve> curves) {
  constexpr std::size_t kMost = 12;
  std::string names;
  for (const InstrumentCurve& curve : curves.first(std::min(curves.size(), kMost))) {
    names += fmt::format("{}{}", names.empty() ? "" : ", ", curve.number);
    const std::string line =
        curve.line > 0 ? fmt::format("line {}", curve.line) : std::string();
    if (!curve.kind.empty() || !line.empty()) {
      names += fmt::format(" ({}{}{})", curve.kind,
                           curve.kind.empty() || line.empty() ? "" : ", ", line);
    }
  }
  return curves.size() > kMost ? fmt::format("{}, ... {}", names, curves.back().number)
                               : names;
}

std::size_t clipped_samples(const Measurement& samples) {
  constexpr std::size_t kMin = 8;
  const std::vector<double>& depth = samples.depth_m;
  const auto moved = std::find_if(depth.begin(), depth.end(), [](double d) {
    return d != 0.0;
  });
  const auto still = static_cast<std::size_t>(moved - depth.begin());
  const auto force = std::span(samples.force_n).first(still);
  const bool alive = std::any_of(force.begin(), force.end(), [&](double f) {
    return f != force.front();
  });
  return still >= kMin && alive ? still : 0;
}

MeasurementColumns given_columns(const InstrumentCurve& curve,
                                 const InstrumentRequest& request) {
  const auto first = [](const MeasurementColumn& given, const MeasurementColumn& own) {
    const bool mine = given.column.empty() && !own.column.empty();
    return MeasurementColumn{mine ? own.column : given.column,
                             given.unit.empty() && mine ? own.unit : given.unit};
  };
  MeasurementColumns columns;
  columns.depth = first(request.given.depth, curve.columns.depth);
  columns.force = first(request.given.force, curve.columns.force);
  columns.time = request.given.time  ? request.given.time
                 : request.with_time ? curve.columns.time
                                     : std::nullopt;
  columns.lateral = request.given.lateral;
  return columns;
}

}  // namespace palpate
