#include "formats/measurement/mach1_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/measurement/column_name.h"
#include "formats/measurement/delimited_text.h"
#include "formats/measurement/text_table.h"

namespace palpate {
namespace {

constexpr std::string_view kMach1FirstLine = "<Mach-1 File>";
// Functions that hold still, swing or search; and those that may press.
constexpr std::array<std::string_view, 4> kNoPress{"Wait", "Zero Load", "Sinusoid",
                                                   "Tare"};
constexpr std::array<std::string_view, 4> kMayPress{"Find Contact", "Move Relative",
                                                    "Move Absolute", "Scan"};
constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr double kOffNormalMax = 10.0;  // [deg]

struct Block {
  InstrumentCurve curve;  // bytes of its rows, names above them
  std::map<std::string, std::string> key;
};

// The bytes of one line, and where the next begins.
std::string_view line_at(std::string_view text, std::size_t at, std::size_t& next) {
  const std::size_t end = std::min(text.find('\n', at), text.size());
  next = std::min(end + 1, text.size());
  return trimmed(text.substr(at, end - at));
}

void take_key(std::string_view line, Block& block) {
  const std::size_t colon = line.find(':');
  if (colon != std::string_view::npos) {
    block.key[std::string(trimmed(line.substr(0, colon)))] =
        std::string(trimmed(line.substr(colon + 1)));
  }
}

// All blocks with data, from one pass over the text.
std::vector<Block> blocks_of(std::string_view text) {
  std::vector<Block> blocks;
  Block block;
  enum { kOutside, kInfo, kHead, kData } place = kOutside;
  const auto close = [&](std::size_t end, const char* broken) {
    block.curve.end = end;
    block.curve.broken = broken;
    blocks.push_back(std::move(block));
    block = Block{};
    place = kOutside;
  };
  // <INFO> ... <END INFO>, <name of the function>, "key: value" lines, <DATA>, a line
  // of names, rows, <END DATA>; then the next block.
  std::size_t number = 1;
  for (std::size_t at = 0, next = 0; at < text.size(); at = next, ++number) {
    const std::string_view line = line_at(text, at, next);
    if (place == kData && (line == "<INFO>" || line == "<DATA>")) {
      close(at, "has no <END DATA> before the next block");
    }
    if (line == "<INFO>") {
      place = kInfo;
    } else if (line == "<END INFO>") {
      place = kHead;
    } else if (place == kHead && line == "<DATA>") {
      place = kData;
      block.curve.begin = next;
      block.curve.line = number + 1;
    } else if (place == kData && line == "<END DATA>") {
      close(at, "");
    } else if (place == kHead && line.starts_with('<') && line.ends_with('>')) {
      block.curve.kind = std::string(line.substr(1, line.size() - 2));
    } else if (place == kHead) {
      take_key(line, block);
    }
  }
  if (place == kData) {
    close(text.size(), "ends with the file, without <END DATA>: the file is cut short");
  }
  return blocks;
}

// Three numbers between tabs, blanks, commas or semicolons, brackets taken off.
std::optional<Eigen::Vector3d> three_numbers(std::string text) {
  for (char& c : text) {
    c = c == ',' || c == ';' || c == '(' || c == ')' || c == '[' || c == ']' ||
                c == '\t'
            ? ' '
            : c;
  }
  std::vector<double> numbers;
  for (const std::string& cell : split_cells(text, ' ')) {
    if (!cell.empty()) {
      const auto number = parse_number(cell, false);
      if (!number || !std::isfinite(*number)) {
        return std::nullopt;
      }
      numbers.push_back(*number);
    }
  }
  return numbers.size() == 3
             ? std::optional(Eigen::Vector3d(numbers[0], numbers[1], numbers[2]))
             : std::nullopt;
}

// Position and normal of the block, and its columns.
void take_head(Block& block) {
  InstrumentCurve& curve = block.curve;
  for (const auto& [key, text] : block.key) {
    if (const auto three = three_numbers(text)) {
      if (key.starts_with("Surface Normal") && three->norm() > 0.0) {
        curve.normal = three->normalized();
      } else if (key.starts_with("Contact") &&
                 key.find("(x, y, z)") != std::string::npos) {
        const std::string unit = parse_column_name(key).unit;
        curve.position_m = length_unit_si(unit).value_or(1e-3) * *three;
      }
    }
  }
  const auto value = [&](const char* key, const char* otherwise) {
    const auto found = block.key.find(key);
    return found == block.key.end() ? otherwise : found->second;
  };
  curve.columns.depth = {value("Stage Axis", "Position (z)"), kUnitFromHeader};
  curve.columns.force = {value("Load Cell Axis", "Fz"), kUnitFromHeader};
  curve.columns.time = MeasurementColumn{"Time", kUnitFromHeader};
}

bool named(std::span<const std::string_view> names, const std::string& kind) {
  return std::any_of(names.begin(), names.end(), [&](std::string_view name) {
    return kind.starts_with(name);
  });
}

// "6 Find Contact, 1 Wait".
std::string counted(const std::map<std::string, int>& kinds) {
  std::string text;
  for (const auto& [kind, count] : kinds) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, kind);
  }
  return text;
}

// The lines of a block's rows, dividers between its ramps left out.
std::vector<TextLine> block_lines(const std::filesystem::path& file,
                                  const InstrumentCurve& curve) {
  const std::string text = read_file(file);
  const std::size_t begin = std::min(curve.begin, text.size());
  auto lines = text_lines(std::string_view(text).substr(begin, curve.end - begin),
                          file.string(), curve.line);
  std::erase_if(lines, [](const TextLine& line) {
    return trimmed(line.text) == "<divider>";
  });
  return lines;
}

struct Along {
  std::vector<double> value;
  std::string columns;
};

// Three columns as one component along a direction, in SI units; nothing where one of
// them is missing.
std::optional<Along> along(const std::string& file, std::span<const TextLine> lines,
                           const Eigen::Vector3d& direction, bool lengths) {
  const auto names = split_cells(lines.front().text, '\t');
  Along result;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name =
        fmt::format(fmt::runtime(lengths ? "Position ({})" : "F{}"), kAxes[axis]);
    if (matching_columns(names, name).size() != 1) {
      return std::nullopt;
    }
    const MeasurementColumn column{name, kUnitFromHeader};
    const MeasurementColumn other{lengths ? "Fz" : "Position (z)", kUnitFromHeader};
    const Measurement m =
        read_table(file, lines,
                   {lengths ? column : other, lengths ? other : column, std::nullopt})
            .samples;
    const std::vector<double>& part = lengths ? m.depth_m : m.force_n;
    result.value.resize(part.size(), 0.0);
    for (std::size_t i = 0; i < part.size(); ++i) {
      // sum over axes of n_axis part_axis: ways from the first row on, forces as they
      // are.
      result.value[i] += direction[axis] * (part[i] - (lengths ? part.front() : 0.0));
    }
    result.columns += fmt::format("{}\"{}\"", axis == 0 ? "" : ", ", name);
  }
  return result;
}

// Angle between the way of the stage and the normal [deg].
double off_normal(const std::string& file, std::span<const TextLine> lines,
                  const Eigen::Vector3d& normal) {
  std::array<Along, 3> way;
  for (int axis = 0; axis < 3; ++axis) {
    way[static_cast<std::size_t>(axis)] =
        along(file, lines, Eigen::Vector3d::Unit(axis), true).value();
  }
  Eigen::Vector3d farthest = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < way[0].value.size(); ++i) {
    const Eigen::Vector3d here(way[0].value[i], way[1].value[i], way[2].value[i]);
    farthest = here.norm() > farthest.norm() ? here : farthest;
  }
  const double cosine = std::abs(farthest.dot(normal)) / farthest.norm();
  return std::acos(std::min(cosine, 1.0)) * 180.0 / std::numbers::pi;
}

// Way and force along the surface's normal instead of along z.
void project(const std::string& file, std::span<const TextLine> lines,
             const Eigen::Vector3d& normal, MeasurementFile& result) {
  const auto depth = along(file, lines, normal, true);
  if (!depth) {
    result.notes.emplace_back(
        "the block has a surface normal, but not all of Position (x), (y), (z): depth "
        "and force are along the stage's axis");
    return;
  }
  const double angle = off_normal(file, lines, normal);
  if (!(angle <= kOffNormalMax)) {
    throw InputError(
        fmt::format("{}: the stage moves {:.0f} deg off the surface normal of its "
                    "block; tell depth "
                    "and force column",
                    file, angle));
  }
  result.samples.depth_m = depth->value;
  result.depth_column = "Position along the surface normal";
  if (const auto force = along(file, lines, normal, false)) {
    result.samples.force_n = force->value;
    result.force_column = "force along the surface normal";
  }
  result.notes.emplace_back("depth and force are along the block's surface normal");
}

}  // namespace

bool is_mach1(const std::filesystem::path&, std::string_view head) {
  if (head.starts_with("\xEF\xBB\xBF")) {
    head.remove_prefix(3);
  }
  return trimmed(head.substr(0, head.find('\n'))) == kMach1FirstLine;
}

InstrumentFile list_mach1(const std::filesystem::path& file) {
  std::vector<Block> blocks = blocks_of(read_file(file));
  const auto rank = [](const Block& block) {
    const std::string& kind = block.curve.kind;
    return named(kNoPress, kind) ? 0 : named(kMayPress, kind) ? 1 : 2;
  };
  // Unknown functions rank above kMayPress, and those above kNoPress. The best rank in
  // the file counts, and rank 0 never does.
  int best = 0;
  for (const Block& block : blocks) {
    best = std::max(best, rank(block));
  }
  InstrumentFile result;
  std::map<std::string, int> others;
  for (Block& block : blocks) {
    if (best == 0 || rank(block) != best) {
      ++others[block.curve.kind];
      continue;
    }
    take_head(block);
    block.curve.number = static_cast<int>(result.curve.size()) + 1;
    result.curve.push_back(std::move(block.curve));
  }
  if (result.curve.empty()) {
    throw FormatError(fmt::format("{}: no block of the file presses: it holds {}",
                                  file.string(),
                                  others.empty() ? "no data" : counted(others)));
  }
  result.left_out = counted(others);
  return result;
}

MeasurementFile read_mach1(const std::filesystem::path& file,
                           const InstrumentCurve& curve,
                           const InstrumentRequest& request) {
  if (!curve.broken.empty()) {
    throw FormatError(fmt::format("{}: line {}: the block <{}> {}", file.string(),
                                  curve.line, curve.kind, curve.broken));
  }
  const std::vector<TextLine> lines = block_lines(file, curve);
  if (lines.size() < 2) {
    throw FormatError(fmt::format("{}: line {}: the block <{}> holds no rows",
                                  file.string(), curve.line, curve.kind));
  }
  MeasurementColumns columns = given_columns(curve, request);
  for (MeasurementColumn* column : {&columns.depth, &columns.force}) {
    column->unit = column->unit.empty() ? kUnitFromHeader : column->unit;
  }
  if (!request.given.time &&
      matching_columns(split_cells(lines.front().text, '\t'), "Time").size() != 1) {
    columns.time.reset();
  }
  MeasurementFile result =
      read_table(file.string(), lines, columns, request.header_units);
  const bool given =
      !request.given.depth.column.empty() || !request.given.force.column.empty();
  if (curve.normal && !given) {
    project(file.string(), lines, *curve.normal, result);
  }
  return result;
}

}  // namespace palpate
