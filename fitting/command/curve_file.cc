#include "fitting/command/curve_file.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "fitting/curve/split_presses.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

const InstrumentCurve& chosen(const CurveFile& choice, const InstrumentFile& list) {
  if (choice.press == CurveFile::kNoPress) {
    throw InputError(fmt::format("{}: holds {} presses: {}; choose one by --press",
                                 choice.file, list.curve.size(),
                                 name_curves(list.curve)));
  }
  const auto found = std::find_if(list.curve.begin(), list.curve.end(),
                                  [&](const InstrumentCurve& curve) {
                                    return curve.number == choice.press;
                                  });
  if (found == list.curve.end()) {
    throw InputError(fmt::format("{}: --press {}: is not in the file, which holds {}",
                                 choice.file, choice.press, name_curves(list.curve)));
  }
  return *found;
}

MeasurementFile read_or_ask(const InstrumentLayout& layout, const CurveFile& choice,
                            const InstrumentCurve& curve) {
  try {
    return layout.read(choice.file, curve, {choice.given, choice.header_units, false});
  } catch (const InputError& error) {
    if (!choice.given.depth.column.empty() && !choice.given.force.column.empty()) {
      throw;
    }
    throw InputError(
        fmt::format("{} (--depth-column, --depth-unit, --force-column, --force-unit)",
                    error.what()));
  }
}

// The samples with their times, where the file tells some that can be read.
std::optional<Measurement> read_timed(const InstrumentLayout& layout,
                                      const CurveFile& choice,
                                      const InstrumentCurve& curve) {
  try {
    return layout.read(choice.file, curve, {choice.given, choice.header_units, true})
        .samples;
  } catch (const Error&) {
    return std::nullopt;
  }
}

// One of the presses that follow one another in the samples of a single curve.
std::string take_press(const CurveFile& choice, Measurement& samples) {
  std::vector<Measurement> presses = split_presses(samples);
  if (choice.press < 1 || choice.press > static_cast<int>(presses.size())) {
    throw InputError(fmt::format(
        "{}: --press {}: the file holds {}", choice.file, choice.press,
        presses.size() == 1 ? std::string("one press")
                            : fmt::format("presses 1 to {}", presses.size())));
  }
  samples = presses[static_cast<std::size_t>(choice.press) - 1];
  return fmt::format("press {} of {}", choice.press, presses.size());
}

}  // namespace

CurveRead read_curve_file(const CurveFile& choice) {
  const InstrumentLayout& layout = layout_of(choice.file);
  const InstrumentFile list = layout.list(choice.file);
  const bool several = list.curve.size() > 1;
  const InstrumentCurve& curve = several ? chosen(choice, list) : list.curve.front();
  CurveRead read{read_or_ask(layout, choice, curve), std::string(layout.name), "",
                 curve.tip_radius_m, read_timed(layout, choice, curve)};
  if (several) {
    read.press =
        fmt::format("press {} ({} in the file){}", curve.number, list.curve.size(),
                    curve.kind.empty() ? "" : ", " + curve.kind);
  } else if (choice.press != CurveFile::kNoPress) {
    read.press = take_press(choice, read.measurement.samples);
    if (read.timed) {
      static_cast<void>(take_press(choice, *read.timed));
    }
  }
  if (!list.left_out.empty()) {
    read.measurement.notes.push_back("left out: " + list.left_out);
  }
  return read;
}

std::string take_tip(const CurveRead& read, IndenterOptions& options) {
  const bool sphere = options.shape == "sphere" && !options.radius_m;
  if (!read.tip_radius_m || (!options.shape.empty() && !sphere)) {
    return "";
  }
  if (options.shape.empty() &&
      (options.radius_m || options.half_angle_deg || options.height_m)) {
    return "";  // given in part: the flags' own check says what is missing
  }
  options.shape = "sphere";
  options.radius_m = read.tip_radius_m;
  return fmt::format("sphere of radius {:.4g} m, as the file states",
                     *read.tip_radius_m);
}

}  // namespace palpate
