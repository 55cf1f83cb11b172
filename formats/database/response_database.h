// The response database in memory and as a file; FORMAT.md describes every dataset.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/forms/open_stored.h"
#include "formats/mesh/surface_mesh.h"
#include "formats/response/relaxation.h"
#include "formats/response/response_table.h"
#include "formats/stored/storage_options.h"

namespace palpate {

constexpr int kDatabaseVersion = 2;       ///< major: readers refuse another one
constexpr int kDatabaseVersionMinor = 9;  ///< additions that readers may pass over

/// Where the numbers came from: enough to compute them again.
struct Provenance {
  std::string writer;         ///< tool and version
  std::string scene_toml;     ///< full configuration, as read; empty for measurements
  std::string source_file;    ///< name (no path) of the mesh or measurement
  std::string source_sha256;  ///< of that file
  std::string left_out;       ///< what was not computed, and why; one line
  /// Digest of all that the responses depend on, the program too; empty for
  /// measurements, and where a part was cut off or something added.
  std::string plan_sha256 = {};
};

/// The raw measurement behind fitted responses: one indentation or several in turn.
/// Only depth and force must be there; the rest is empty where it is not known.
struct Measurement {
  std::vector<double> depth_m;  ///< (m) [m] as measured, contact point not subtracted
  std::vector<double> force_n;  ///< (m) [N]
  std::vector<double> time_s = {};           ///< (m) [s]
  std::vector<double> depth_errors_m = {};   ///< (m) [m] standard uncertainty
  std::vector<double> force_errors_n = {};   ///< (m) [N] standard uncertainty
  std::vector<std::int64_t> run_begin = {};  ///< (r + 1) run i owns these samples
  std::vector<std::int32_t> run_node = {};   ///< (r) nearest node, -1: unknown
  std::vector<std::string> run_name = {};  ///< (r) e.g. the file it came from, one line
  RunRelaxation relaxation = {};           ///< (r) of what each run held
};

struct ResponseDatabase {
  SurfaceMesh body;
  Points normal;                     ///< (n x 3) outward unit normals at the vertices
  std::vector<ResponseTable> tools;  ///< at least one
  Measurement measurement;           ///< empty unless responses were measured
  Provenance provenance;
  StorageOptions storage;  ///< as it was read, and as it is to be written
};

/// Checks every rule of FORMAT.md: shapes, ranges, finiteness, unit directions, curves.
/// @throws FormatError with the first violation: dataset, node and value.
void check(const ResponseDatabase& database);

/// Writes atomically: a temporary beside `file`, fsync, rename. Equal input gives equal
/// bytes. Nodes lie along a space-filling curve in the file; a reader restores the
/// order of the source. Depths and forces are rounded to storage.precision
/// (rounded_database.h). @throws FormatError as check() does, before anything is
/// written; InputError if the place cannot be written.
/// @param form none: what the file's name asks for
void write_database(const std::filesystem::path& file, const ResponseDatabase& database,
                    std::optional<StoredForm> form = std::nullopt);

/// The bytes of the flat file that write_database() writes. @throws as it does.
[[nodiscard]] std::vector<std::byte> flat_bytes(const ResponseDatabase& database);

/// Reads a file of either form, and checks. @throws InputError for a missing file,
/// FormatError for one that is foreign, truncated, damaged or of a newer major version.
[[nodiscard]] ResponseDatabase read_database(const StoredSource& file);

/// As read_database(), with nodes and triangles in the file's order instead of the
/// source's: without a copy, in half the memory.
[[nodiscard]] ResponseDatabase read_in_file_order(const StoredSource& file);

/// The table of the named tool, or the only one for an empty name.
/// @throws InputError naming the tools that there are.
[[nodiscard]] const ResponseTable& find_tool(const ResponseDatabase& database,
                                             const std::string& name);

/// The same of several names; of none, the only one.
[[nodiscard]] std::vector<const ResponseTable*> find_tools(
    const ResponseDatabase& database, const std::vector<std::string>& names);

}  // namespace palpate
