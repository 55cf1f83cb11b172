// A body as large as wanted for the bench of streaming.
#pragma once

#include <cstdint>
#include <filesystem>

#include "formats/database/response_database.h"

namespace palpate {

constexpr double kFineTriangleM = 0.001;   ///< [m] of the plate at x < 0
constexpr double kCoarseTriangleM = 0.01;  ///< [m] of the plate at x > 0
constexpr const char* kStreamBodyWriter = "runtime_bench stream";  ///< in provenance

/// Two square plates in the plane z = 0, outside upwards, a metre apart: triangles of
/// 1 mm and of 10 mm. Every node has a response k d^1.5 to 5 mm.
/// @param nodes of both together, at least 8; rounded down to two squares.
[[nodiscard]] ResponseDatabase stream_body(std::int64_t nodes, int samples);

/// Nodes along a side of each plate.
[[nodiscard]] std::int64_t plate_side(std::int64_t nodes);

/// Writes a stream_body() in a process of its own, whose memory is gone with it.
/// Call before any thread is started. @throws InputError if it fails, having said why.
void write_stream_body(const std::filesystem::path& file, std::int64_t nodes,
                       int samples);

}  // namespace palpate
