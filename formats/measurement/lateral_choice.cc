#include "formats/measurement/lateral_choice.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/measurement/column_name.h"

namespace palpate {
namespace {

enum class LateralPart { kAlong, kAcross, kNormal, kUnsaid };

constexpr std::size_t kStem = 5;  // letters: "normal" begins "normalkraft"
constexpr std::array kAlongWords{
    "x",       "fx",       "ft",     "fl",         "lateral",       "tangential",
    "shear",   "friction", "stroke", "horizontal", "sliding",       "slide",
    "tangent", "traction", "drag",   "reibkraft",  "reibungskraft", "querkraft"};
constexpr std::array kAcrossWords{"y", "fy"};
constexpr std::array kNormalWords{"z",        "fz",      "fn",          "normal",
                                  "vertical", "preload", "axial",       "depth",
                                  "gap",      "height",  "indentation", "penetration"};

// Words in lower case; a single letter belongs to the one before: "F_n", "Force X".
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words;
  bool inside = false;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto c = static_cast<unsigned char>(name[i]);
    const bool letter = std::isalpha(c) != 0;
    const bool hump = letter && i > 0 && std::isupper(c) != 0 &&
                      std::islower(static_cast<unsigned char>(name[i - 1])) != 0;
    if (letter && (!inside || hump)) {
      words.emplace_back();
    }
    if (letter) {
      words.back() += static_cast<char>(std::tolower(c));
    }
    inside = letter;
  }
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (words[i].size() == 1 && words[i - 1] == "f") {
      words[i] = "f" + words[i];
    }
  }
  return words;
}

template <class Words>
bool has_any(const std::vector<std::string>& words, const Words& known) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::any_of(known.begin(), known.end(), [&](std::string_view one) {
      return word == one || (one.size() >= kStem && word.starts_with(one));
    });
  });
}

LateralPart part_of(const std::string& header) {
  const std::vector<std::string> words = words_of(parse_column_name(header).quantity);
  return has_any(words, kNormalWords)   ? LateralPart::kNormal
         : has_any(words, kAlongWords)  ? LateralPart::kAlong
         : has_any(words, kAcrossWords) ? LateralPart::kAcross
                                        : LateralPart::kUnsaid;
}

// Columns of one unit, by the part that their names tell.
class SortedColumns {
 public:
  SortedColumns(const std::string& file, const TableHeader& header,
                std::size_t quantity)
      : file_(file), header_(header), all_(columns_with_unit(header, quantity)) {}

  [[nodiscard]] std::vector<std::size_t> of(LateralPart part) const {
    std::vector<std::size_t> found;
    std::copy_if(all_.begin(), all_.end(), std::back_inserter(found),
                 [&](std::size_t column) {
                   return part_of(header_.name[column]) == part;
                 });
    return found;
  }
  // The only one; none where there is none. @throws InputError for several.
  [[nodiscard]] std::optional<MeasurementColumn> one(
      const std::vector<std::size_t>& found, const char* what) const {
    if (found.empty()) {
      return std::nullopt;
    }
    if (found.size() > 1) {
      std::string names;
      for (const std::size_t column : found) {
        names +=
            fmt::format("{}\"{}\"", names.empty() ? "" : ", ", header_.name[column]);
      }
      throw InputError(fmt::format("{}: {} columns may be the {}: {}; tell which",
                                   file_, found.size(), what, names));
    }
    return MeasurementColumn{chosen_by(header_, found.front()), kUnitFromHeader};
  }
  [[nodiscard]] std::optional<MeasurementColumn> along(const char* what) const {
    const auto said = of(LateralPart::kAlong);
    return one(said.empty() ? of(LateralPart::kUnsaid) : said, what);
  }
  // Said to be normal, or without a word beside one that is said to be along.
  [[nodiscard]] std::optional<MeasurementColumn> normal() const {
    const auto said = of(LateralPart::kNormal), rest = of(LateralPart::kUnsaid);
    const bool by_rest = said.empty() && !of(LateralPart::kAlong).empty();
    return one(by_rest ? rest : said, "normal force");
  }
  [[nodiscard]] std::size_t size() const { return all_.size(); }

 private:
  const std::string& file_;
  const TableHeader& header_;
  std::vector<std::size_t> all_;
};

void take_column(const std::optional<MeasurementColumn>& found, const char* what,
                 MeasurementColumn& column, std::vector<std::string>* notes) {
  if (column.column.empty() && found) {
    column.column = found->column;
    column.unit = column.unit.empty() ? found->unit : column.unit;
    if (notes != nullptr) {
      notes->push_back(fmt::format("\"{}\" is the {}", found->column, what));
    }
  }
}

void take_normal_column(const SortedColumns& forces, LateralColumns& lateral,
                        std::vector<std::string>* notes) {
  if (lateral.normal || lateral.normal_is_known) {
    return;
  }
  if (const auto found = forces.normal()) {
    lateral.normal.emplace();
    take_column(found, "normal force", *lateral.normal, notes);
  }
}

}  // namespace

void take_lateral_columns(const std::string& file, const TableHeader& header,
                          MeasurementColumns& columns,
                          std::vector<std::string>* notes) {
  const SortedColumns lengths(file, header, kDepth), forces(file, header, kForce);
  LateralColumns& lateral = *columns.lateral;
  if (columns.depth.column.empty() && lengths.size() == 0) {
    throw InputError(
        fmt::format("{}: no column of the header states a unit of length; tell which "
                    "is the lateral "
                    "displacement, and its unit",
                    file));
  }
  const bool by_names = columns.depth.column.empty() && columns.force.column.empty();
  if (columns.depth.column.empty() && lengths.size() > 1) {
    take_column(lengths.along("lateral displacement"), "lateral displacement",
                columns.depth, notes);
  }
  if (columns.force.column.empty() && forces.size() > 0) {
    const auto found = forces.along("tangential force");
    if (!found) {
      throw InputError(fmt::format(
          "{}: every column of forces is a normal one by its name; tell which is the "
          "tangential force",
          file));
    }
    take_column(forces.size() > 1 ? found : std::nullopt, "tangential force",
                columns.force, notes);
  }
  if (forces.size() > 1) {
    take_normal_column(forces, lateral, notes);
  }
  const auto across = lengths.of(LateralPart::kAcross);
  const auto across_force = forces.of(LateralPart::kAcross);
  if (by_names && !lateral.across && across.size() == 1 && across_force.size() == 1) {
    lateral.across = lengths.one(across, "displacement across");
    lateral.across_force = forces.one(across_force, "force across");
  }
}

}  // namespace palpate
