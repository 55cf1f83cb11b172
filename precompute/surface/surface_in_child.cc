#include "precompute/surface/surface_in_child.h"

#include <cstdint>
#include <cstring>
#include <exception>
#include <span>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/process/run_in_child.h"

namespace palpate {
namespace {

// The first of the message: how long each part is. `failure` bytes stand for all else.
struct Sizes {
  std::int64_t vertices = 0;
  std::int64_t triangles = 0;
  std::int64_t counts = 0;
  std::int64_t failure = 0;
  double lost_share = 0.0;
};

template <typename T>
void append(std::vector<char>& bytes, const T* data, std::int64_t count) {
  const auto* first = reinterpret_cast<const char*>(data);
  bytes.insert(bytes.end(), first, first + static_cast<std::size_t>(count) * sizeof(T));
}

template <typename T>
void take(std::span<const char>& bytes, T* data, std::int64_t count) {
  const std::size_t size = static_cast<std::size_t>(count) * sizeof(T);
  if (bytes.size() < size) {
    throw NumericalError("the child's answer is cut short");
  }
  std::memcpy(data, bytes.data(), size);
  bytes = bytes.subspan(size);
}

std::vector<char> packed(const SurfaceAndCounts& result) {
  const Sizes sizes{.vertices = result.mesh.position_m.rows(),
                    .triangles = result.mesh.triangle.rows(),
                    .counts = std::ssize(result.count),
                    .lost_share = result.lost_share};
  std::vector<char> bytes;
  append(bytes, &sizes, 1);
  append(bytes, result.mesh.position_m.data(), 3 * sizes.vertices);
  append(bytes, result.mesh.triangle.data(), 3 * sizes.triangles);
  append(bytes, result.count.data(), sizes.counts);
  return bytes;
}

// The first line, for libraries write several.
std::vector<char> packed_failure(const std::string& text) {
  const std::string line = text.substr(0, text.find('\n'));
  const Sizes sizes{.failure = std::ssize(line)};
  std::vector<char> bytes;
  append(bytes, &sizes, 1);
  append(bytes, line.data(), sizes.failure);
  return bytes;
}

SurfaceAndCounts unpacked(std::span<const char> bytes, std::string_view what) {
  Sizes sizes;
  take(bytes, &sizes, 1);
  if (sizes.failure > 0) {
    std::string text(static_cast<std::size_t>(sizes.failure), ' ');
    take(bytes, text.data(), sizes.failure);
    throw NumericalError(fmt::format("{}: {}", what, text));
  }
  SurfaceAndCounts result;
  result.lost_share = sizes.lost_share;
  result.mesh.position_m.resize(sizes.vertices, 3);
  result.mesh.triangle.resize(sizes.triangles, 3);
  result.count.resize(static_cast<std::size_t>(sizes.counts));
  take(bytes, result.mesh.position_m.data(), 3 * sizes.vertices);
  take(bytes, result.mesh.triangle.data(), 3 * sizes.triangles);
  take(bytes, result.count.data(), sizes.counts);
  return result;
}

}  // namespace

SurfaceAndCounts surface_in_child(std::string_view what,
                                  const std::function<SurfaceAndCounts()>& work) {
  const ChildResult child = run_in_child(
      [&] {
        try {
          return packed(work());
        } catch (const std::exception& error) {
          return packed_failure(error.what());
        }
      },
      {});
  if (!child.done) {
    throw NumericalError(fmt::format("{}: it failed: {}", what, child.failure));
  }
  SurfaceAndCounts result = unpacked(child.bytes, what);
  const SurfaceMesh& mesh = result.mesh;
  if (mesh.triangle.rows() == 0 || !mesh.position_m.allFinite() ||
      mesh.triangle.minCoeff() < 0 ||
      mesh.triangle.maxCoeff() >= mesh.position_m.rows()) {
    throw NumericalError(fmt::format("{}: nothing sensible came out of it", what));
  }
  return result;
}

}  // namespace palpate
