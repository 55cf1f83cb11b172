#include "formats/mesh/off_reader.h"

#include <cstdint>
#include <sstream>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/mesh_text.h"

namespace palpate {
namespace {

// Lines that say something, numbered.
class Lines {
 public:
  explicit Lines(std::string bytes) : in_(with_unix_lines(std::move(bytes))) {}

  // False at the end of the file. `words` lives until the next call.
  [[nodiscard]] bool next(std::string_view& words) {
    while (std::getline(in_, line_)) {
      ++number_;
      words = line_;
      std::string_view rest = words;
      if (!take_word(rest).empty()) {
        return true;
      }
    }
    return false;
  }
  [[nodiscard]] int number() const noexcept { return number_; }

 private:
  std::istringstream in_;
  std::string line_;
  int number_ = 0;
};

void require_plain_off(std::string_view keyword, std::string_view next_word) {
  std::string_view prefix = keyword;
  if (!prefix.ends_with("OFF")) {
    throw FormatError("not OFF: the first word is not OFF");
  }
  prefix.remove_suffix(3);
  for (const std::string_view known : {"ST", "C", "N"}) {
    prefix.remove_prefix(prefix.starts_with(known) ? known.size() : 0);
  }
  if (!prefix.empty()) {
    throw FormatError(
        fmt::format("{} has other than three coordinates, must be OFF", keyword));
  }
  if (next_word == "BINARY") {
    throw FormatError("binary OFF, must be text");
  }
}

struct Counts {
  std::size_t points = 0;
  std::size_t faces = 0;
};

Counts read_counts(Lines& lines) {
  std::string_view words;
  if (!lines.next(words)) {
    throw FormatError("empty");
  }
  std::string_view keyword = take_word(words);
  std::string_view first = take_word(words);
  // The first count may stand close to the keyword.
  if (const auto end = keyword.find("OFF");
      end != std::string_view::npos && keyword.size() > end + 3) {
    words = first.empty() ? first
                          : std::string_view(
                                first.data(),
                                static_cast<std::size_t>(words.end() - first.begin()));
    first = keyword.substr(end + 3);
    keyword = keyword.substr(0, end + 3);
  }
  require_plain_off(keyword, first);
  if (first.empty() && lines.next(words)) {
    first = take_word(words);
  }
  Counts counts;
  if (!parse_number(first, counts.points) ||
      !parse_number(take_word(words), counts.faces)) {
    throw FormatError(
        fmt::format("line {}: not the counts of vertices and faces", lines.number()));
  }
  return counts;
}

std::vector<std::size_t> read_off_face(std::string_view words, std::size_t face,
                                       int number) {
  std::size_t count = 0;
  bool is_face = parse_number(take_word(words), count);
  std::vector<std::size_t> corners;
  for (std::size_t i = 0; is_face && i < count; ++i) {
    is_face = parse_number(take_word(words), corners.emplace_back());
  }
  if (!is_face) {
    throw FormatError(fmt::format(
        "line {}: face {} is not a count and as many vertices", number, face));
  }
  return corners;
}

}  // namespace

PolygonSoup read_off(std::string bytes) {
  Lines lines(std::move(bytes));
  const Counts counts = read_counts(lines);
  PolygonSoup soup;
  std::string_view words;
  while (soup.point.size() < counts.points && lines.next(words)) {
    soup.point.push_back(read_point(words, soup.point.size() + 1, lines.number()));
  }
  while (soup.face.size() < counts.faces && lines.next(words)) {
    soup.face.push_back(read_off_face(words, soup.face.size() + 1, lines.number()));
  }
  if (soup.point.size() < counts.points || soup.face.size() < counts.faces) {
    throw FormatError(fmt::format("cut short: {} of {} vertices and {} of {} faces",
                                  soup.point.size(), counts.points, soup.face.size(),
                                  counts.faces));
  }
  return soup;
}

}  // namespace palpate
