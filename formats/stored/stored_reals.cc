// Numbers in the file's own precision, doubles in memory.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/stored/storage_options.h"
#include "formats/stored/stored_reader.h"
#include "formats/stored/stored_writer.h"

namespace palpate {
namespace {

std::string scale_path(const std::string& path) {
  return path + "_scale";
}

}  // namespace

void StoredWriter::reals(const std::string& path, const char* units,
                         const std::vector<double>& values,
                         const std::vector<std::int64_t>& begin) {
  if (precision_ == Precision::kFloat64) {
    dataset(path, units, values);
    return;
  }
  if (precision_ == Precision::kFloat32) {
    derived(path, units, std::vector<float>(values.begin(), values.end()));
  } else {
    // int16: value = scale * step, one scale for each node's run of samples.
    std::vector<std::int16_t> steps(values.size());
    std::vector<double> scale;
    for (std::size_t i = 0; i + 1 < begin.size(); ++i) {
      const auto from = static_cast<std::size_t>(begin[i]);
      const auto to = static_cast<std::size_t>(begin[i + 1]);
      scale.push_back(int16_scale(std::span(values).subspan(from, to - from)));
      for (std::size_t k = from; k < to; ++k) {
        steps[k] = static_cast<std::int16_t>(
            scale.back() > 0.0 ? std::lround(values[k] / scale.back()) : 0);
      }
    }
    derived(path, units, steps);
    derived(scale_path(path), units, scale);
  }
  digest_only(path, values);
}

void StoredReader::reals(const std::string& path, const char* units,
                         std::vector<double>& values,
                         const std::vector<std::int64_t>& begin) {
  const StoredType type = type_of(path);
  if (type != StoredType::kFloat32 && type != StoredType::kInt16) {
    dataset(path, units, values);
    return;
  }
  const StoredShape shape = shape_of(path, units, type, {-1});
  allocate(path, shape, [&] {
    values.resize(static_cast<std::size_t>(shape[0]));
  });
  rows_as_reals(path, units, 0, 0, begin, values);
  digest_only(path, values);
}

void StoredReader::rows_as_reals(const std::string& path, const char* units,
                                 std::int64_t first_row, std::int64_t first_node,
                                 const std::vector<std::int64_t>& begin,
                                 std::vector<double>& values) const {
  const auto count = static_cast<std::int64_t>(values.size());
  switch (type_of(path)) {
    case StoredType::kFloat32: {
      std::vector<float> stored(values.size());
      rows(path, units, StoredType::kFloat32, first_row, count, 0, stored.data());
      std::copy(stored.begin(), stored.end(), values.begin());
      return;
    }
    case StoredType::kInt16:
      break;
    default:
      rows(path, units, StoredType::kFloat64, first_row, count, 0, values.data());
      return;
  }
  if (begin.empty() || begin.front() != 0 || begin.back() != count ||
      !std::is_sorted(begin.begin(), begin.end())) {
    fail(fmt::format("dataset {} has {} rows, sample_begin does not divide them", path,
                     count));
  }
  // value = scale * step; scale[i] is of node first_node + i.
  std::vector<std::int16_t> steps(values.size());
  std::vector<double> scale(begin.size() - 1);
  rows(path, units, StoredType::kInt16, first_row, count, 0, steps.data());
  rows(scale_path(path), units, StoredType::kFloat64, first_node,
       static_cast<std::int64_t>(scale.size()), 0, scale.data());
  for (std::size_t i = 0; i < scale.size(); ++i) {
    for (auto k = static_cast<std::size_t>(begin[i]);
         k < static_cast<std::size_t>(begin[i + 1]); ++k) {
      values[k] = scale[i] * static_cast<double>(steps[k]);
    }
  }
}

}  // namespace palpate
