// What of being pressed stays on a body when a run is over: dents and softening at
// sites of its surface, of each tool. RECORDING.md describes the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpate {

constexpr std::int64_t kSurfaceStateVersion = 1;  ///< readers refuse any other

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

struct SurfaceState {
  std::string writer = {};           ///< tool and version
  std::string database = {};         ///< name of the file, without its folder
  std::string database_sha256 = {};  ///< its content_sha256
  /// By name of the table of responses; sites rise, rows' tables are 0.
  std::map<std::string, std::vector<YieldedRow>> tool = {};
};

/// Writes it whole or not at all. @throws InputError if the place cannot be written.
void write_surface_state(const std::filesystem::path& file, const SurfaceState& state);

/// @throws InputError if it is missing, FormatError if it is foreign, damaged, of
/// another version, or its values break the rules above.
[[nodiscard]] SurfaceState read_surface_state(const std::filesystem::path& file);

/// The same, of a body. @param sha256 content_sha256 of its database.
/// @throws InputError if it is the state of another body, saying of which.
[[nodiscard]] SurfaceState read_surface_state(const std::filesystem::path& file,
                                              const std::string& sha256,
                                              const std::string& database);

/// What tables of responses had left on a surface, each row with its table's place in
/// `tables`; nothing where one has none there.
[[nodiscard]] std::vector<YieldedRow> surface_of(
    const SurfaceState& surface, const std::vector<std::string>& tables);

/// The other way round, in place of what these tables had. Two hands' tables of one
/// name have their own dents: the deeper one counts.
void put_surface(const std::vector<YieldedRow>& rows,
                 const std::vector<std::string>& tables, SurfaceState& surface);

/// The largest of each depth, of no site in particular; 0 for none.
[[nodiscard]] YieldedRow largest_of(const std::vector<YieldedRow>& rows);

/// Every row has a table and site of its own and values that are finite and not
/// negative; they rise.
/// @param where names them in an error. @throws FormatError
void check_yielded(const std::vector<YieldedRow>& rows, const std::string& where);

}  // namespace palpate
