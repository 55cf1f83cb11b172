// Changes of what is rendered of a database, any of them: for tests and fuzzers of who
// must refuse it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "formats/database/chunk_reader.h"
#include "formats/database/database_rules.h"
#include "formats/database/response_database.h"

namespace palpate {

/// One change: what, of which tool, where, how, by which number.
struct DatabaseChange {
  static constexpr std::size_t kBytes = 13;

  explicit DatabaseChange(std::span<const std::uint8_t, kBytes> bytes)
      : what(bytes[0]), tool(bytes[1]), how(bytes[4]) {
    std::memcpy(&where, &bytes[2], sizeof where);
    std::memcpy(&number, &bytes[5], sizeof number);
  }

  std::uint8_t what;
  std::uint8_t tool;
  std::uint16_t where = 0;
  std::uint8_t how;
  double number = 0.0;
};

inline double changed(double value, const DatabaseChange& change) {
  switch (change.how % 5) {
    case 0:
      return change.number;
    case 1:
      return -value;
    case 2:
      return value * 50.0;
    case 3:
      return value * (1.0 + 1e-8);
    default:
      return 0.0;
  }
}

inline void apply(ResponseDatabase& database, const DatabaseChange& change) {
  ResponseTable& table = database.tools[change.tool % database.tools.size()];
  const std::array<std::vector<double>*, 10> values{&table.depth_m,
                                                    &table.force_n,
                                                    &table.stiffness_n_per_m,
                                                    &table.energy_j,
                                                    &table.friction,
                                                    &table.presliding_m,
                                                    &table.touch_offset_m,
                                                    &table.error_relative,
                                                    &table.direction_spread_rad,
                                                    &table.stiffness_max_n_per_m};
  const auto at = [&](auto& array) -> auto& {
    return array.data()[change.where % static_cast<std::size_t>(array.size())];
  };
  switch (const std::size_t what = change.what % 16; what) {
    case 10:
      at(table.direction) = changed(at(table.direction), change);
      break;
    case 11:
      at(database.normal) = changed(at(database.normal), change);
      break;
    case 12:
      at(database.body.position_m) = changed(at(database.body.position_m), change);
      break;
    case 13:
      at(table.flags) = static_cast<std::uint8_t>(at(table.flags) ^ change.how);
      break;
    case 14:
      at(table.origin) = change.how;
      break;
    case 15:
      at(database.body.triangle) =
          static_cast<std::int32_t>(change.how % database.body.position_m.rows());
      break;
    default:
      at(*values[what]) = changed(at(*values[what]), change);
  }
}

/// Everything that a renderer streams. @throws FormatError where it is refused.
inline void stream_all(const std::filesystem::path& file) {
  const ChunkReader reader(file);
  for (std::int64_t k = 0; k < reader.index().chunks(); ++k) {
    const BodyChunk body = reader.body(k);
    for (std::size_t tool = 0; tool < reader.index().tools.size(); ++tool) {
      check_normals(body.normal, reader.responses(tool, k), body.node_begin);
    }
  }
}

}  // namespace palpate
