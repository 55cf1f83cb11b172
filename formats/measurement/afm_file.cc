#include "formats/measurement/afm_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/hdf5/hdf5_handle.h"
#include "formats/hdf5/hdf5_lock.h"
#include "formats/measurement/column_name.h"

namespace palpate {
namespace {

using hdf5::Handle;
using UnitSize = std::optional<double> (*)(std::string_view);

constexpr hsize_t kSamplesMax = 100'000'000;

class AfmFile {
 public:
  explicit AfmFile(const std::filesystem::path& file)
      : name_(file.string()), id_(hdf5::open_read_only(file), H5Fclose) {
    if (!id_) {
      throw FormatError(fmt::format("{}: is not an HDF5 file", name_));
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError(fmt::format("{}: {}", name_, what));
  }

  [[nodiscard]] hid_t id() const { return id_.get(); }

  [[nodiscard]] bool has(const std::string& group, const std::string& dataset) const {
    return hdf5::link_at(id(), group + "/" + dataset) == hdf5::Link::kHard;
  }

  // A dataset in SI units.
  [[nodiscard]] std::vector<double> values(const std::string& path,
                                           UnitSize size) const {
    const bool in_file = hdf5::link_at(id(), path) == hdf5::Link::kHard;
    const Handle dataset(in_file ? H5Dopen2(id(), path.c_str(), H5P_DEFAULT) : -1,
                         H5Dclose);
    if (!dataset) {
      fail(fmt::format("no dataset \"{}\"", path));
    }
    const Handle space(H5Dget_space(dataset.get()), H5Sclose);
    const Handle type(H5Dget_type(dataset.get()), H5Tclose);
    hsize_t samples = 0;
    if (H5Sget_simple_extent_ndims(space.get()) != 1 ||
        H5Sget_simple_extent_dims(space.get(), &samples, nullptr) != 1 ||
        samples == 0 || samples > kSamplesMax ||
        H5Tget_class(type.get()) != H5T_FLOAT) {
      fail(fmt::format("dataset \"{}\" is not one row of 1 to {} real numbers", path,
                       kSamplesMax));
    }
    if (!hdf5::holds_its_bytes(dataset.get())) {
      fail(fmt::format("dataset \"{}\" is not written in full in this file", path));
    }
    std::vector<double> values(samples);
    if (H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                values.data()) < 0) {
      fail(
          fmt::format("dataset \"{}\" cannot be read: {}", path, hdf5::last_failure()));
    }
    const std::string unit = text(dataset.get());
    const auto si = size(unit);
    if (!si) {
      fail(fmt::format("dataset \"{}\" has the unit \"{}\", which is not known", path,
                       unit));
    }
    for (double& value : values) {
      if (!std::isfinite(value)) {
        fail(fmt::format("dataset \"{}\", sample {} is {}, must be finite", path,
                         &value - values.data() + 1, value));
      }
      value *= *si;
    }
    return values;
  }

  // The spring constant of the cantilever [N/m].
  [[nodiscard]] double spring_n_per_m(const std::string& group) const {
    constexpr const char* kName = "spring constant";
    double value = std::nan("");
    if (hdf5::link_at(id(), group) == hdf5::Link::kHard &&
        H5Aexists_by_name(id(), group.c_str(), kName, H5P_DEFAULT) > 0) {
      const Handle attribute(
          H5Aopen_by_name(id(), group.c_str(), kName, H5P_DEFAULT, H5P_DEFAULT),
          H5Aclose);
      (void)H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &value);
    }
    if (!(value > 0.0) || !std::isfinite(value)) {
      fail(fmt::format(
          "group \"{}\" has the \"{}\" {}, must be positive and finite, because the "
          "depth is the height less the bending",
          group, kName, value));
    }
    return value;
  }

 private:
  // The attribute "unit": a text of variable length, as Python writes it, or of fixed.
  [[nodiscard]] static std::string text(hid_t dataset) {
    if (H5Aexists(dataset, "unit") <= 0) {
      return "";
    }
    const Handle attribute(H5Aopen(dataset, "unit", H5P_DEFAULT), H5Aclose);
    const Handle type(H5Aget_type(attribute.get()), H5Tclose);
    if (H5Tget_class(type.get()) != H5T_STRING) {
      return "";
    }
    if (H5Tis_variable_str(type.get()) > 0) {
      char* raw = nullptr;
      if (H5Aread(attribute.get(), type.get(), static_cast<void*>(&raw)) < 0 ||
          raw == nullptr) {
        return "";
      }
      std::string unit(raw);
      H5free_memory(raw);
      return unit;
    }
    std::string unit(H5Tget_size(type.get()), '\0');
    if (H5Aread(attribute.get(), type.get(), unit.data()) < 0) {
      return "";
    }
    return unit.substr(0, unit.find('\0'));
  }

  QuietHdf5 quiet_;
  std::string name_;
  Handle id_;
};

herr_t collect_number(hid_t, const char* name, const H5L_info_t*, void* numbers) {
  int number = 0;
  const std::string_view text(name);
  const auto [stop, error] =
      std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc() && stop == text.data() + text.size() && number >= 0) {
    static_cast<std::vector<int>*>(numbers)->push_back(number);
  }
  return 0;
}

}  // namespace

std::vector<int> afm_curves(const std::filesystem::path& file) {
  const Hdf5Lock lock;
  const AfmFile afm(file);
  std::vector<int> numbers;
  (void)H5Literate(afm.id(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, &collect_number,
                   &numbers);
  if (numbers.empty()) {
    afm.fail("holds no force curve: no group named by a number");
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

MeasurementFile read_afm_curve(const std::filesystem::path& file, int number) {
  const Hdf5Lock lock;
  const AfmFile afm(file);
  const std::string group = std::to_string(number);
  MeasurementFile result;
  result.force_column = "force";
  result.samples.force_n = afm.values(group + "/force", &force_unit_si);
  const auto* const position = std::find_if(
      std::begin(kAfmPositions), std::end(kAfmPositions), [&](const char* name) {
        return afm.has(group, name);
      });
  if (position == std::end(kAfmPositions)) {
    afm.fail(fmt::format("group \"{}\" has no dataset \"{}\", \"{}\" or \"{}\"", group,
                         kAfmPositions[0], kAfmPositions[1], kAfmPositions[2]));
  }
  result.depth_column = *position;
  auto& depth = result.samples.depth_m;
  depth = afm.values(group + "/" + *position, &length_unit_si);
  if (afm.has(group, "time")) {
    result.time_column = "time";
    result.samples.time_s = afm.values(group + "/time", &time_unit_si);
  }
  const std::size_t samples = result.samples.force_n.size();
  if (depth.size() != samples ||
      (!result.time_column.empty() && result.samples.time_s.size() != samples)) {
    afm.fail(fmt::format("group \"{}\" has {} forces, {} positions and {} times", group,
                         samples, depth.size(), result.samples.time_s.size()));
  }
  // depth = -(height + F / k): the height falls as the probe nears, and the cantilever
  // takes F / k of the way. A tip position has that already.
  const double bending_per_n =
      position == std::begin(kAfmPositions) ? 0.0 : 1.0 / afm.spring_n_per_m(group);
  for (std::size_t i = 0; i < samples; ++i) {
    depth[i] = -(depth[i] + bending_per_n * result.samples.force_n[i]);
  }
  return result;
}

}  // namespace palpate
