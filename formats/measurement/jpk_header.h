// Headers of JPK force files: lines "key=value" as Java's properties, and the scalings
// that turn a channel's numbers into metres and newtons.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Keys and values. Escapes \: \= \# \! \\ \t \n \r \uXXXX are resolved, lines that
/// begin with # or ! are comments, a line that ends in a backslash goes on.
using JpkHeader = std::map<std::string, std::string, std::less<>>;
[[nodiscard]] JpkHeader parse_jpk_header(std::string_view text);

/// A segment's header with what it borrows: "channel.x.lcd-info.*=3" stands for all
/// keys "lcd-info.3." of the shared header, put below "channel.x.".
[[nodiscard]] JpkHeader with_shared(JpkHeader header, const JpkHeader& shared);

/// offset + multiplier * raw.
struct JpkScaling {
  double multiplier = 1.0, offset = 0.0;
  std::string unit;
};

/// From the stored numbers of a channel to one of its calibration slots. The encoder's
/// scaling comes first, then those of the slots between the base and `slot`.
/// @param slot empty: the default one
/// @throws FormatError naming the key that is missing, and for a slot that the file
/// does not define: the channel is not calibrated.
[[nodiscard]] JpkScaling jpk_scaling(const JpkHeader& header, const std::string& file,
                                     const std::string& channel,
                                     const std::string& slot = "");

/// Stored numbers of a channel, big-endian, before any scaling.
/// @throws FormatError for a type that is not known, and for bytes that are no whole
/// number of samples.
[[nodiscard]] std::vector<double> jpk_numbers(const JpkHeader& header,
                                              const std::string& file,
                                              const std::string& channel,
                                              std::string_view bytes);

}  // namespace palpate
