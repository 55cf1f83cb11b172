#include "formats/measurement/jpk_header.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/measurement/delimited_text.h"

namespace palpate {
namespace {

constexpr int kSlotsMax = 16;  // a chain of slots that is longer runs in a circle

void append_utf8(unsigned code, std::string& text) {
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += static_cast<char>(0xC0 | (code >> 6));
    text += static_cast<char>(0x80 | (code & 0x3F));
  } else {
    text += static_cast<char>(0xE0 | (code >> 12));
    text += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
    text += static_cast<char>(0x80 | (code & 0x3F));
  }
}

// One character or escape at `at`, which moves behind it.
void take(std::string_view line, std::size_t& at, std::string& text) {
  if (line[at] != '\\' || at + 1 == line.size()) {
    text += line[at++];
    return;
  }
  // Java's properties: \t \n \r, \uXXXX of one UTF-16 unit, any other character stands
  // for itself.
  const char escaped = line[at + 1];
  at += 2;
  if (escaped == 'u' && at + 4 <= line.size()) {
    unsigned code = 0;
    for (const char digit : line.substr(at, 4)) {
      const std::size_t value =
          std::string_view("0123456789abcdef")
              .find(digit >= 'A' && digit <= 'F' ? static_cast<char>(digit - 'A' + 'a')
                                                 : digit);
      code = 16 * code + static_cast<unsigned>(value & 0xF);
    }
    at += 4;
    append_utf8(code, text);
  } else {
    text += escaped == 't'   ? '\t'
            : escaped == 'n' ? '\n'
            : escaped == 'r' ? '\r'
                             : escaped;
  }
}

void take_line(std::string_view line, JpkHeader& header) {
  std::string key, value;
  std::size_t at = 0;
  while (at < line.size() && line[at] != '=' && line[at] != ':') {
    take(line, at, key);
  }
  ++at;
  while (at < line.size() && (line[at] == ' ' || line[at] == '\t')) {
    ++at;
  }
  while (at < line.size()) {
    take(line, at, value);
  }
  header[std::string(trimmed(key))] = value;
}

const std::string& need(const JpkHeader& header, const std::string& file,
                        const std::string& key) {
  const auto found = header.find(key);
  if (found == header.end()) {
    throw FormatError(fmt::format("{}: the header has no \"{}\"", file, key));
  }
  return found->second;
}

double need_number(const JpkHeader& header, const std::string& file,
                   const std::string& key) {
  const std::string& text = need(header, file, key);
  const auto number = parse_number(text, false);
  if (!number || !std::isfinite(*number)) {
    throw FormatError(
        fmt::format("{}: \"{}\" is \"{}\", must be a finite number", file, key, text));
  }
  return *number;
}

JpkScaling scaling_at(const JpkHeader& header, const std::string& file,
                      const std::string& key) {
  JpkScaling scaling{need_number(header, file, key + ".multiplier"),
                     need_number(header, file, key + ".offset"), ""};
  for (const char* unit : {".unit.unit", ".unit"}) {
    const auto found = header.find(key + unit);
    if (found != header.end()) {
      scaling.unit = found->second;
      break;
    }
  }
  return scaling;
}

// "channel.x.data.encoder" or, in the shared form, "channel.x.encoder"; empty where
// there is none.
std::string encoder_key(const JpkHeader& header, const std::string& channel) {
  for (const char* key : {".data.encoder", ".encoder"}) {
    if (header.contains("channel." + channel + key + ".type")) {
      return "channel." + channel + key;
    }
  }
  return "";
}

// How a number is stored.
struct Stored {
  std::size_t bytes = 0;
  bool is_signed = true, real = false;
};

std::optional<Stored> stored_as(const std::string& type) {
  if (type == "signedshort" || type == "unsignedshort") {
    return Stored{2, type[0] == 's', false};
  }
  if (type == "signedinteger" || type == "unsignedinteger") {
    return Stored{4, type[0] == 's', false};
  }
  if (type == "signedlong" || type == "unsignedlong") {
    return Stored{8, type[0] == 's', false};
  }
  if (type == "float" || type == "float-data") {
    return Stored{4, true, true};
  }
  if (type == "double" || type == "double-data") {
    return Stored{8, true, true};
  }
  return std::nullopt;
}

double number_at(std::string_view bytes, const Stored& stored) {
  std::uint64_t bits = 0;
  for (const char byte : bytes) {
    bits = bits << 8 | static_cast<unsigned char>(byte);
  }
  if (stored.real) {
    return stored.bytes == 4 ? static_cast<double>(std::bit_cast<float>(
                                   static_cast<std::uint32_t>(bits)))
                             : std::bit_cast<double>(bits);
  }
  if (!stored.is_signed) {
    return static_cast<double>(bits);
  }
  const auto unused = static_cast<int>(64 - 8 * stored.bytes);
  return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
}

}  // namespace

JpkHeader parse_jpk_header(std::string_view text) {
  JpkHeader header;
  std::string joined;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line.remove_suffix(line.ends_with('\r') ? 1 : 0);
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (joined.empty() && (line.starts_with('#') || line.starts_with('!'))) {
      continue;
    }
    joined += line;
    // A line that ends with an odd number of backslashes goes on in the next.
    const std::size_t last = joined.find_last_not_of('\\');
    const std::size_t slashes =
        joined.size() - (last == std::string::npos ? 0 : last + 1);
    if (slashes % 2 == 1 && !text.empty()) {
      joined.pop_back();
      continue;
    }
    if (!joined.empty()) {
      take_line(joined, header);
    }
    joined.clear();
  }
  return header;
}

JpkHeader with_shared(JpkHeader header, const JpkHeader& shared) {
  constexpr std::string_view kStar = ".*";
  JpkHeader borrowed;
  for (const auto& [key, value] : header) {
    if (!key.ends_with(kStar)) {
      continue;
    }
    const std::string kind = key.substr(0, key.size() - kStar.size());
    const std::size_t dot = kind.find_last_of('.');
    const std::string below = dot == std::string::npos ? "" : kind.substr(0, dot + 1);
    const std::string from = fmt::format(
        "{}.{}.", dot == std::string::npos ? kind : kind.substr(dot + 1), value);
    for (auto it = shared.lower_bound(from);
         it != shared.end() && it->first.starts_with(from); ++it) {
      borrowed[below + it->first.substr(from.size())] = it->second;
    }
  }
  header.merge(borrowed);
  return header;
}

JpkScaling jpk_scaling(const JpkHeader& header, const std::string& file,
                       const std::string& channel, const std::string& slot) {
  const std::string set = fmt::format("channel.{}.conversion-set.conversion", channel);
  const std::string encoder = encoder_key(header, channel);
  JpkScaling total;
  if (!encoder.empty()) {
    total = scaling_at(header, file, encoder + ".scaling");
  }
  const std::string& base = need(header, file, set + "s.base");
  // From the wanted slot down to the base: each slot names the one that it is made of.
  std::vector<JpkScaling> steps;  // outermost first
  std::string at = slot.empty() ? need(header, file, set + "s.default") : slot;
  for (int step = 0; at != base; ++step) {
    const std::string key = fmt::format("{}.{}", set, at);
    const auto defined = header.find(key + ".defined");
    if (step == kSlotsMax || defined == header.end() || defined->second != "true") {
      throw FormatError(fmt::format(
          "{}: channel {} has no slot \"{}\": it was measured without that "
          "calibration; "
          "set sensitivity and spring constant in the instrument's software",
          file, channel, at));
    }
    steps.push_back(scaling_at(header, file, key + ".scaling"));
    at = need(header, file, key + ".base-calibration-slot");
  }
  // y = b + m (offset + multiplier x): slots are applied from the base upwards.
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    total.multiplier *= step->multiplier;
    total.offset = total.offset * step->multiplier + step->offset;
    total.unit = step->unit;
  }
  return total;
}

std::vector<double> jpk_numbers(const JpkHeader& header, const std::string& file,
                                const std::string& channel, std::string_view bytes) {
  const std::string encoder = encoder_key(header, channel);
  std::string type;
  if (!encoder.empty()) {
    type = need(header, file, encoder + ".type");
  } else {
    // Segments name the type under "data", shared headers without it.
    const auto data = header.find("channel." + channel + ".data.type");
    const auto shared = header.find("channel." + channel + ".type");
    type = data != header.end()     ? data->second
           : shared != header.end() ? shared->second
                                    : "";
  }
  const auto stored = stored_as(type);
  if (!stored) {
    throw FormatError(fmt::format(
        "{}: channel {} is stored as \"{}\", which is not known", file, channel, type));
  }
  if (bytes.size() % stored->bytes != 0) {
    throw FormatError(fmt::format("{}: channel {} has {} bytes, no whole number of {}",
                                  file, channel, bytes.size(), stored->bytes));
  }
  std::vector<double> numbers;
  numbers.reserve(bytes.size() / stored->bytes);
  for (std::size_t at = 0; at < bytes.size(); at += stored->bytes) {
    numbers.push_back(number_at(bytes.substr(at, stored->bytes), *stored));
  }
  return numbers;
}

}  // namespace palpate
