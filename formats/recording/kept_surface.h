// What of being pressed stays on a body for good: sites that have yielded, and the
// channels of needles. RECORDING.md describes the files that have it.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace palpate {

/// A site of the surface that has yielded.
struct YieldedRow {
  std::int32_t site = -1;   ///< number in the database, >= 0
  double dent_m = 0.0;      ///< [m] >= 0 depth that stays, along the normal
  double softened_m = 0.0;  ///< [m] >= 0 depth up to which its curve has softened
  /// Of the tools' tables of responses, one for each radius of each hand's tool; 0 of a
  /// tool that touches at one place.
  std::int32_t table = 0;

  [[nodiscard]] bool operator==(const YieldedRow&) const = default;
};

constexpr std::int64_t kKeptLayers = 6;  ///< of a channel, at most

/// A channel that a needle has cut (runtime/needle/channel.h).
struct ChannelRow {
  std::array<double, 3> entry_m{};  ///< [m] of the tool's reference point
  std::array<double, 3> axis{};     ///< [-] outward unit
  double depth_m = 0.0;             ///< [m] >= 0 along the axis
  std::int32_t layer = 0;           ///< that the tip has broken into, from 0
  /// [m] along the axis where layers begin: the first at 0, rising; NaN: no more.
  std::array<double, kKeptLayers> layer_depth_m{};
  /// Row of the tool's materials; -1: no more layers.
  std::array<std::int32_t, kKeptLayers> layer_material{};
  std::int32_t table = 0;  ///< as of a site

  /// NaN is NaN.
  [[nodiscard]] bool operator==(const ChannelRow& other) const noexcept;
};

struct KeptSurface {
  std::vector<YieldedRow> yielded = {};   ///< by table, then by site
  std::vector<ChannelRow> channels = {};  ///< by table, then in the order of punctures

  [[nodiscard]] bool empty() const noexcept {
    return yielded.empty() && channels.empty();
  }
  [[nodiscard]] bool operator==(const KeptSurface&) const = default;
};

/// The largest of each depth, of no site in particular; 0 for none.
[[nodiscard]] YieldedRow largest_of(const std::vector<YieldedRow>& rows);

/// Every site has a table and number of its own and values that are finite and not
/// negative; they rise. Tables of channels rise, and their values are as above.
/// @param where names them in an error. @throws FormatError
void check_kept(const KeptSurface& surface, const std::string& where);

}  // namespace palpate
