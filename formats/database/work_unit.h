// Pieces of a response database on their way. Pieces are computed one by one, kept
// across kills, shared out among machines, and put together in the end.
//
// A unit is a set of nodes that is solved as a whole and gives the same bits whoever
// solves it. A plan knows all that does not depend on units. Both are CBOR (RFC 8949).
// A shard's file is a magic line, the SHA-256 of what follows (64 hex digits), CBOR.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/database/error_calibration.h"
#include "formats/database/response_database.h"
#include "formats/mesh/surface_search.h"

namespace palpate {

/// One node's response with one tool, as a unit delivers it.
struct WorkUnitNode {
  std::int32_t tool = 0;  ///< index
  std::int32_t vertex = -1;
  /// Its error_relative is an estimate, which assemble() calibrates.
  NodeResponse response = {};
  std::string failure = {};  ///< why the path ends early, or is missing; else empty
  /// What its solve tried after its first recipe, with reasons, one line; else empty.
  std::string history = {};
  /// The tool also met a part of the body whose contact is not in the response.
  bool reaches_elsewhere = false;
};

/// A response that breaks a rule (broken_rule) becomes that of a failed node, without a
/// curve. The failure says which rule; a node that failed without a curve is flagged.
void fail_if_broken(WorkUnitNode& node);

struct WorkUnitOutcome {
  std::int64_t index = -1;
  /// A better solution at one place of the surface, of each tool. The solution measures
  /// the error of what the other units' answers make of that place.
  bool is_check = false;
  std::vector<WorkUnitNode> node;
  /// Of a check: its triangle and area coordinates; triangle -1: at the vertex itself.
  SurfacePoint place = {};
};

/// What all units of one computation have in common.
struct JobDescription {
  std::string digest;  ///< of everything that the outcomes depend on
  std::int64_t units = 0;
  SurfaceMesh body;
  Points normal;
  std::vector<ToolShape> tool;
  double force_relative = 0.0;  ///< [-] the scene's accuracy budget
  std::int64_t reachable = 0;   ///< vertices, of each tool
  double depth_max_m = 0.0;
  double force_max_n = 0.0;
  /// The same at every node of every tool: times and one row of shares; else empty.
  Viscoelasticity relaxation = {};
  std::vector<Yielding> yielding = {};  ///< by tool, rows for all vertices
  std::vector<Puncture> puncture = {};  ///< by tool, rows for all vertices; or none
  std::int64_t bundles = 1;             ///< of responses that relax
  std::string left_out = {};            ///< of every response; counts are added to it
  Provenance provenance;                ///< but `left_out` and `plan_sha256`
};

[[nodiscard]] std::vector<std::byte> to_bytes(const WorkUnitOutcome& unit);
[[nodiscard]] std::vector<std::byte> to_bytes(const JobDescription& plan);
/// @throws FormatError naming `source` if the bytes are not one.
[[nodiscard]] WorkUnitOutcome unit_from_bytes(std::span<const std::byte> bytes,
                                              const std::string& source);
[[nodiscard]] JobDescription plan_from_bytes(std::span<const std::byte> bytes,
                                             const std::string& source);

/// Some units of a plan, in one file.
struct Shard {
  JobDescription plan;
  std::vector<WorkUnitOutcome> unit;
};
void write_shard(const std::filesystem::path& file, const Shard& shard);
/// @throws InputError for a missing file, FormatError for one that is no shard.
[[nodiscard]] Shard read_shard(const std::filesystem::path& file);
/// Whether a file begins as a shard does.
[[nodiscard]] bool is_shard(const std::filesystem::path& file);

/// How the whole came out.
struct Assembly {
  ResponseDatabase database;
  std::int64_t solved = 0;
  std::int64_t interpolated = 0;
  std::int64_t failed = 0;     ///< without a curve
  std::int64_t truncated = 0;  ///< solved, but not to the end of the path
  /// Of those with a curve: it ends where the tool meets a held part of the body.
  std::int64_t ended_at_support = 0;
  std::int64_t untouched = 0;  ///< reachable, but the tool met nothing to press
  std::int64_t outside_reach = 0;
  std::int64_t over_budget = 0;
  std::int64_t tilts_limited = 0;  ///< their force leans or turns more (tilt_line.h)
  std::int64_t near_singular = 0;  ///< other equilibria may lie near
  double error_factor =
      0.0;  ///< [-] stated errors over estimates, of tools the largest
  double hard_error_factor = 0.0;  ///< [-] the same beside nodes with kNearSingular
  /// [-] The share of nodes that stated errors hold for, as known from the number of
  /// checks. Of tools the share is the least, 0.95 at most; and of nodes with
  /// kNearSingular.
  double error_covered = kErrorCoverage;
  double hard_error_covered = kErrorCoverage;
  std::int64_t checked_in_vain = 0;     ///< checks that failed: they count as misses
  std::int64_t reaching_elsewhere = 0;  ///< the tool also met another part of the body
  std::vector<double> error;            ///< [-] stated, ascending
  std::vector<double> checked;        ///< [-] errors against finer solutions, ascending
  std::vector<std::string> failures;  ///< "vertex 12, tool ball: reason"
};

/// Whether a unit's nodes all keep the rules: what a checkpoint may give back.
[[nodiscard]] bool is_sound(const WorkUnitOutcome& unit);

/// Forces [N] (k x 3) of the field that is rendered from a database, on its tool of
/// that index. Places [m] (k x 3) are of the tool's reference point. Checks between
/// vertices are compared with these forces (runtime/slow/static_field.h has them).
using StoredForces = std::function<Points(const ResponseDatabase& database,
                                          std::size_t tool, const Points& position_m)>;

/// Puts the units together; their order does not matter. Tilts get their limits
/// (limit_tilt). Estimates of error become
/// stated errors: times the factor that checks found (error_calibration.h). A node
/// whose response breaks a rule becomes a failed one (fail_if_broken).
/// @param stored may be empty where every check is at a vertex.
/// @throws InputError naming the units that are missing, that come twice, or whose
/// nodes the body does not have.
[[nodiscard]] Assembly assemble(const JobDescription& plan,
                                std::span<const WorkUnitOutcome> units,
                                const StoredForces& stored);

/// @throws NumericalError saying why if no node at all was solved.
void require_responses(const JobDescription& plan, const Assembly& assembly);

}  // namespace palpate
