#include "formats/measurement/decimal_mark.h"

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/measurement/delimited_text.h"

namespace palpate {
namespace {

bool is_whole(const std::string& cell) {
  const std::size_t first = cell.find_first_of("0123456789");
  return first != std::string::npos && cell.size() - first == 3 &&
         cell.find_first_not_of("0123456789", first) == std::string::npos;
}

void take_first(std::size_t& first, bool found, std::size_t line) {
  first = first == 0 && found ? line : first;
}

}  // namespace

void DecimalMark::see(const std::string& cell, std::size_t line) {
  bool marked = false;
  for (const char mark : {',', '.'}) {
    if (cell.find(mark) != std::string::npos) {
      Seen& seen = mark == ',' ? comma_ : point_;
      const bool grouped = ends_in_groups(cell, mark);
      take_first(seen.any, true, line);
      take_first(seen.grouped, grouped, line);
      take_first(seen.other, !grouped, line);
      marked = true;
    }
  }
  take_first(plain_, !marked && is_whole(cell), line);
  if ((comma_.any != 0 && point_.grouped != 0) ||
      (point_.any != 0 && comma_.grouped != 0)) {
    throw FormatError(fmt::format(
        "{}: a comma in line {} and a point in line {}: one of them separates "
        "thousands, which are not read; export without thousands separators",
        file_, comma_.grouped != 0 ? comma_.grouped : comma_.any,
        point_.grouped != 0 ? point_.grouped : point_.any));
  }
}

void DecimalMark::check() const {
  if (comma_.grouped != 0 && comma_.other == 0 && plain_ != 0) {
    throw FormatError(
        fmt::format("{}: the comma in line {} separates thousands or decimals: line {} "
                    "has a number "
                    "of three digits without; export without thousands separators",
                    file_, comma_.grouped, plain_));
  }
}

}  // namespace palpate
