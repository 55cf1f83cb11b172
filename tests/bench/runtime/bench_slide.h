// `runtime_bench slide`: the renderer where proxies are measured, sliding and
// pressing on closed surfaces of about 1000, 10 000 and 100 000 triangles.
//
// The body is a sphere of 0.1 m across, a triangle mesh of meridians and parallels, of
// 1 N/mm everywhere. The fast process runs at 2 kHz, the slow one at 100 Hz. Paths:
//
//   slide   press to 1 mm, 60 mm along the surface at 0.1 m/s and back, release;
//           repeated
//   cycle   press to 4 mm (8 mJ), 10 mm along the surface and back, release; repeated
//
// The paths are those of the true sphere, so that the force error counts the mesh too.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "runtime/account/local_model.h"

namespace palpate {

struct SlideBenchOptions {
  std::vector<std::int64_t> triangles{968, 10'000, 100'000};
  std::vector<double> tool_radius_m{0.001, 0.005};
  std::vector<double> friction{0.0, 0.3};
  LocalModel model = LocalModel::kPotential;
  int rounds = 5;  ///< of each path
};

struct SlideBenchRow {
  std::int64_t triangles = 0;  ///< of the body that was made
  double tool_radius_m = 0.0;
  double friction = 0.0;
  std::string path;        ///< slide, cycle
  double p50_ns = 0.0;     ///< [ns] of taking in elements and one fast step, wall time
  double p999_ns = 0.0;    ///< [ns]
  double slow_ns = 0.0;    ///< [ns] median of a slow update
  double stored_j = 0.0;   ///< [J] most that the body held
  double created_j = 0.0;  ///< [J] >= 0, most that was ever given away
  double felt_j = 0.0;     ///< [J] >= 0, likewise by trapezoids of the forces
  double net_j = 0.0;      ///< [J] put in over the closed path; lost, if positive
  double force_n = 0.0;    ///< [N] median of the normal force on the level stretch
  double error = 0.0;  ///< [-] rms of the normal force there, relative to the sphere's
  std::uint64_t interventions = 0;  ///< of the ledger
  std::int64_t not_finite = 0;      ///< forces
};

/// A sphere of that many triangles, at least, and 1 N/mm. @throws InputError.
[[nodiscard]] ResponseDatabase slide_body(std::int64_t triangles, double tool_radius_m,
                                          double friction);

[[nodiscard]] std::vector<SlideBenchRow> run_slide_bench(
    const SlideBenchOptions& options);

[[nodiscard]] std::string table_text(const std::vector<SlideBenchRow>& rows);
[[nodiscard]] std::string to_json(const std::vector<SlideBenchRow>& rows);

}  // namespace palpate
