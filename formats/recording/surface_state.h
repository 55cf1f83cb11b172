// What of being pressed stays on a body when a run is over, of each tool, in a file.
// RECORDING.md describes it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "formats/recording/kept_surface.h"

namespace palpate {

/// Readers refuse any later one. Without channels a file is of version 1.
constexpr std::int64_t kSurfaceStateVersion = 2;

struct SurfaceState {
  std::string writer = {};           ///< tool and version
  std::string database = {};         ///< name of the file, without its folder
  std::string database_sha256 = {};  ///< its content_sha256
  /// By name of the table of responses; sites rise, rows' tables are 0.
  std::map<std::string, KeptSurface> tool = {};
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
[[nodiscard]] KeptSurface surface_of(const SurfaceState& surface,
                                     const std::vector<std::string>& tables);

/// The other way round, in place of what these tables had. Two hands' tables of one
/// name have their own dents and channels. Of a site, and of channels with one entry
/// and axis, the deeper one counts.
void put_surface(const KeptSurface& rows, const std::vector<std::string>& tables,
                 SurfaceState& surface);

}  // namespace palpate
