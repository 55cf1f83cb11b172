#include "formats/mesh/ply_header.h"

#include <array>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "formats/base/at.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr std::string_view kEnd = "end_header";

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes{{
    {"char", PlyType::kInt8},
    {"int8", PlyType::kInt8},
    {"uchar", PlyType::kUint8},
    {"uint8", PlyType::kUint8},
    {"short", PlyType::kInt16},
    {"int16", PlyType::kInt16},
    {"ushort", PlyType::kUint16},
    {"uint16", PlyType::kUint16},
    {"int", PlyType::kInt32},
    {"int32", PlyType::kInt32},
    {"uint", PlyType::kUint32},
    {"uint32", PlyType::kUint32},
    {"float", PlyType::kFloat32},
    {"float32", PlyType::kFloat32},
    {"double", PlyType::kFloat64},
    {"float64", PlyType::kFloat64},
}};

// Header lines one after the other.
class HeaderLines {
 public:
  explicit HeaderLines(std::string_view bytes) : bytes_(bytes) {}

  // The words of the next line that is no comment.
  std::vector<std::string_view> next() {
    for (;;) {
      const std::size_t end = bytes_.find('\n', at_);
      if (end == std::string_view::npos) {
        throw FormatError(fmt::format(
            "cut short or not PLY: the header does not end (no end_header) in {} lines",
            number_ + 1));
      }
      std::vector<std::string_view> words = split(bytes_.substr(at_, end - at_));
      at_ = end + 1;
      ++number_;
      if (!words.empty() && words[0] != "comment" && words[0] != "obj_info") {
        return words;
      }
    }
  }
  [[nodiscard]] std::size_t at() const { return at_; }

  template <typename... Values>
  [[noreturn]] void fail(fmt::format_string<Values...> what, Values&&... values) const {
    throw FormatError(fmt::format("PLY header, line {}: {}", number_,
                                  fmt::format(what, std::forward<Values>(values)...)));
  }

 private:
  static std::vector<std::string_view> split(std::string_view line) {
    constexpr std::string_view kBlank = " \t\r";
    std::vector<std::string_view> words;
    for (std::size_t begin = line.find_first_not_of(kBlank);
         begin != std::string_view::npos; begin = line.find_first_not_of(kBlank)) {
      line.remove_prefix(begin);
      words.push_back(line.substr(0, line.find_first_of(kBlank)));
      line.remove_prefix(words.back().size());
    }
    return words;
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  int number_ = 0;
};

PlyType type_of(const HeaderLines& lines, std::string_view name) {
  for (const auto& [known, type] : kTypes) {
    if (name == known) {
      return type;
    }
  }
  lines.fail(
      "unknown type {:?}, there are char, uchar, short, ushort, int, uint, "
      "float, double",
      name.substr(0, 40));
}

PlyEncoding encoding_of(const HeaderLines& lines,
                        const std::vector<std::string_view>& word) {
  if (word.size() == 3 && word[0] == "format") {
    if (word[1] == "ascii") {
      return PlyEncoding::kText;
    }
    if (word[1] == "binary_little_endian") {
      return PlyEncoding::kLittleEndian;
    }
    if (word[1] == "binary_big_endian") {
      return PlyEncoding::kBigEndian;
    }
  }
  lines.fail(
      "must be \"format\", then ascii, binary_little_endian or "
      "binary_big_endian, then 1.0");
}

PlyElement element_of(const HeaderLines& lines,
                      const std::vector<std::string_view>& word,
                      std::size_t file_bytes) {
  PlyElement element;
  const char* end = word.size() == 3 ? word[2].data() + word[2].size() : nullptr;
  if (end == nullptr) {
    lines.fail("must be \"element\", a name and a count");
  }
  const auto [stop, error] = std::from_chars(word[2].data(), end, element.count);
  if (stop != end || error == std::errc::invalid_argument) {
    lines.fail("must be \"element\", a name and a count");
  }
  if (error == std::errc::result_out_of_range || element.count > file_bytes) {
    lines.fail("announces {} elements, more than a file of {} bytes can hold", word[2],
               file_bytes);
  }
  element.name = word[1];
  return element;
}

PlyProperty property_of(const HeaderLines& lines,
                        const std::vector<std::string_view>& word) {
  PlyProperty property;
  property.is_list = word.size() == 5 && word[1] == "list";
  if (!property.is_list && word.size() != 3) {
    lines.fail(
        "must be \"property\", a type and a name, or \"property list\", two "
        "types and a name");
  }
  property.name = word.back();
  property.type = type_of(lines, word[word.size() - 2]);
  if (property.is_list) {
    property.count_type = type_of(lines, word[2]);
    if (!is_integer(property.count_type)) {
      lines.fail("a list's length must be an integer, is {}", word[2]);
    }
  }
  return property;
}

}  // namespace

std::size_t bytes_of(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32:
      return 4;
    case PlyType::kFloat64:
      break;
  }
  return 8;
}

bool is_integer(PlyType type) {
  return type != PlyType::kFloat32 && type != PlyType::kFloat64;
}

PlyHeader read_ply_header(std::string_view bytes) {
  if (!bytes.starts_with("ply\n") && !bytes.starts_with("ply\r\n")) {
    throw FormatError("not PLY: the first line must be \"ply\"");
  }
  PlyHeader header;
  HeaderLines lines(bytes);
  (void)lines.next();
  header.encoding = encoding_of(lines, lines.next());
  for (;;) {
    const std::vector<std::string_view> word = lines.next();
    if (word[0] != "property" && !header.element.empty() &&
        header.element.back().property.empty()) {
      lines.fail("element {:?} has no property", header.element.back().name);
    }
    if (word[0].starts_with(kEnd)) {
      // Text may go on in the same line, where its line break was lost.
      const bool glued = word.size() > 1 || word[0] != kEnd;
      if (glued && header.encoding != PlyEncoding::kText) {
        lines.fail("must be {} alone", kEnd);
      }
      header.bytes =
          glued ? at(word[0].data() - bytes.data()) + kEnd.size() : lines.at();
      return header;
    }
    if (word[0] == "element") {
      header.element.push_back(element_of(lines, word, bytes.size()));
    } else if (word[0] != "property") {
      lines.fail("{:?} is no word of a PLY header", word[0].substr(0, 40));
    } else if (header.element.empty()) {
      lines.fail("a property before any element");
    } else {
      header.element.back().property.push_back(property_of(lines, word));
    }
  }
}

}  // namespace palpate
