#include "formats/measurement/jpk_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/measurement/delimited_text.h"
#include "formats/measurement/jpk_header.h"
#include "formats/measurement/zip_archive.h"

namespace palpate {
namespace {

constexpr const char* kHeights[] = {"measuredHeight", "capacitiveSensorHeight",
                                    "strainGaugeHeight", "height"};
constexpr const char* kShared = "shared-data/header.properties";

// "index/12/header.properties" is of curve 12.
std::optional<int> index_of(const std::string& name) {
  constexpr std::string_view kIndex = "index/";
  int number = -1;
  if (!name.starts_with(kIndex)) {
    return std::nullopt;
  }
  const char* end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data() + kIndex.size(), end, number);
  return error == std::errc() && stop != end && *stop == '/' && number >= 0
             ? std::optional(number)
             : std::nullopt;
}

// Curves of a map have a folder of their own, and `begin` 1.
std::string folder_of(const InstrumentCurve& curve) {
  return curve.begin == 0 ? "" : fmt::format("index/{}/", curve.number);
}

std::optional<double> number_below(const JpkHeader& header, std::string_view end) {
  for (const auto& [key, value] : header) {
    if (key.ends_with(end)) {
      return parse_number(value, false);
    }
  }
  return std::nullopt;
}

std::optional<Eigen::Vector3d> position_of(const JpkHeader& header) {
  const auto x = number_below(header, ".header.position.x"),
             y = number_below(header, ".header.position.y");
  if (!x || !y || !std::isfinite(*x) || !std::isfinite(*y)) {
    return std::nullopt;
  }
  return Eigen::Vector3d(*x, *y, 0.0);
}

struct Segment {
  std::string style;  // "extend", "pause", "retract"
  std::vector<double> force_n, bending_m, height_m;
  double duration_s = 0.0;
};

// One press being read.
class Press {
 public:
  Press(const ZipArchive& zip, std::string folder)
      : zip_(zip), folder_(std::move(folder)) {
    if (zip.has(kShared)) {
      shared_ = parse_jpk_header(zip.read(kShared));
    }
  }

  [[nodiscard]] std::vector<Segment> segments() {
    std::vector<Segment> segments;
    for (int number = 0;; ++number) {
      const std::string folder = fmt::format("{}segments/{}/", folder_, number);
      if (!zip_.has(folder + "segment-header.properties")) {
        break;
      }
      segments.push_back(segment(folder));
    }
    if (segments.empty()) {
      throw FormatError(
          fmt::format("{}: has no entry \"{}segments/0/\"", zip_.file(), folder_));
    }
    return segments;
  }

  [[nodiscard]] const std::string& height() const { return height_; }

 private:
  [[nodiscard]] Segment segment(const std::string& folder) {
    const JpkHeader header = with_shared(
        parse_jpk_header(zip_.read(folder + "segment-header.properties")), shared_);
    const auto text = [&](const char* key) {
      const auto found = header.find(key);
      return found == header.end() ? std::string() : found->second;
    };
    Segment segment;
    segment.style = text("force-segment-header.settings.style");
    segment.duration_s =
        parse_number(text("force-segment-header.duration"), false).value_or(0.0);
    const auto height =
        std::find_if(std::begin(kHeights), std::end(kHeights), [&](const char* name) {
          return header.contains(fmt::format("channel.{}.data.file.name", name));
        });
    if (height == std::end(kHeights)) {
      throw FormatError(
          fmt::format("{}: {} has no channel of the height", zip_.file(), folder));
    }
    height_ = *height;
    segment.height_m = channel(header, folder, height_, "", "m");
    segment.bending_m = channel(header, folder, "vDeflection", "distance", "m");
    segment.force_n = channel(header, folder, "vDeflection", "force", "N");
    if (segment.height_m.size() != segment.force_n.size()) {
      throw FormatError(fmt::format("{}: {} has {} heights and {} forces", zip_.file(),
                                    folder, segment.height_m.size(),
                                    segment.force_n.size()));
    }
    return segment;
  }

  [[nodiscard]] std::vector<double> channel(const JpkHeader& header,
                                            const std::string& folder,
                                            const std::string& name,
                                            const std::string& slot,
                                            const std::string& unit) const {
    const std::string key = "channel." + name + ".data.";
    const auto path = header.find(key + "file.name");
    if (path == header.end()) {
      throw FormatError(
          fmt::format("{}: {} has no channel {}", zip_.file(), folder, name));
    }
    std::vector<double> values =
        jpk_numbers(header, zip_.file(), name, zip_.read(folder + path->second));
    const auto stated = header.find(key + "num-points");
    const auto count =
        stated == header.end() ? std::nullopt : parse_number(stated->second, false);
    if (count && *count != static_cast<double>(values.size())) {
      throw FormatError(fmt::format("{}: {}{} holds {} samples, its header says {}",
                                    zip_.file(), folder, path->second, values.size(),
                                    stated->second));
    }
    const JpkScaling scaling = jpk_scaling(header, zip_.file(), name, slot);
    if (scaling.unit != unit) {
      throw FormatError(fmt::format("{}: {} channel {} is in \"{}\", must be in {}",
                                    zip_.file(), folder, name, scaling.unit, unit));
    }
    for (double& value : values) {
      value = scaling.offset + scaling.multiplier * value;
      if (!std::isfinite(value)) {
        throw FormatError(
            fmt::format("{}: {} channel {} holds a number that is not finite",
                        zip_.file(), folder, name));
      }
    }
    return values;
  }

  const ZipArchive& zip_;
  std::string folder_;
  JpkHeader shared_;
  std::string height_;
};

// Instruments differ in the sign of the deflection: it rises where the cantilever is
// pressed, at the least height of the approach.
bool falls_under_press(const std::vector<Segment>& segments) {
  for (const Segment& s : segments) {
    if (s.style == "extend" && s.force_n.size() > 1) {
      const auto deepest = std::min_element(s.height_m.begin(), s.height_m.end());
      const std::size_t at = static_cast<std::size_t>(deepest - s.height_m.begin());
      std::vector<double> sorted = s.force_n;
      const auto middle =
          sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
      std::nth_element(sorted.begin(), middle, sorted.end());
      return s.force_n[at] < *middle;
    }
  }
  return false;
}

}  // namespace

bool is_jpk(const std::filesystem::path& file, std::string_view head) {
  if (!is_zip(head)) {
    return false;
  }
  const std::string extension = file.extension().string();
  if (extension.starts_with(".jpk")) {
    return true;  // its name says so, be it broken
  }
  try {
    const ZipArchive& zip = open_archive(file);
    return zip.has("segments/0/segment-header.properties") || zip.has(kShared);
  } catch (const Error&) {
    return false;
  }
}

InstrumentFile list_jpk(const std::filesystem::path& file) {
  const ZipArchive& zip = open_archive(file);
  std::set<int> numbers;
  for (const std::string& name : zip.names()) {
    if (const auto number = index_of(name)) {
      numbers.insert(*number);
    }
  }
  InstrumentFile result;
  for (const int number : numbers) {
    InstrumentCurve curve{.number = number, .begin = 1};
    const std::string header = folder_of(curve) + "header.properties";
    if (zip.has(header)) {
      curve.position_m = position_of(parse_jpk_header(zip.read(header)));
    }
    result.curve.push_back(std::move(curve));
  }
  if (numbers.empty()) {
    InstrumentCurve curve;
    if (zip.has("header.properties")) {
      curve.position_m = position_of(parse_jpk_header(zip.read("header.properties")));
    }
    result.curve.push_back(std::move(curve));
  }
  return result;
}

MeasurementFile read_jpk(const std::filesystem::path& file,
                         const InstrumentCurve& curve,
                         const InstrumentRequest& request) {
  const ZipArchive& zip = open_archive(file);
  Press press(zip, folder_of(curve));
  const std::vector<Segment> segments = press.segments();
  const double sign = falls_under_press(segments) ? -1.0 : 1.0;
  MeasurementFile result;
  double begin_s = 0.0;
  for (const Segment& s : segments) {
    // depth = -(height + bending); sample i of a segment is i / count of its duration
    // after it began.
    const auto count = static_cast<double>(s.force_n.size());
    for (std::size_t i = 0; i < s.force_n.size(); ++i) {
      result.samples.depth_m.push_back(-(s.height_m[i] + sign * s.bending_m[i]));
      result.samples.force_n.push_back(sign * s.force_n[i]);
      result.samples.time_s.push_back(begin_s +
                                      s.duration_s * static_cast<double>(i) / count);
    }
    begin_s += s.duration_s;
  }
  if (result.samples.depth_m.empty()) {
    throw FormatError(fmt::format("{}: its segments hold no samples", zip.file()));
  }
  if (request.with_time && begin_s > 0.0) {
    result.time_column = "duration of the segments";
  } else {
    result.samples.time_s.clear();
  }
  result.depth_column = press.height() + " + bending";
  result.force_column = "vDeflection";
  result.notes.push_back(fmt::format("depth is minus {} and the bending{}",
                                     press.height(),
                                     sign < 0.0 ? "; the deflection's sign is turned, "
                                                  "because it falls under the press"
                                                : ""));
  return result;
}

}  // namespace palpate
