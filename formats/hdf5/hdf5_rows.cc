// Some rows of a dataset at a time: what a reader of chunks does.
#include <array>

#include <fmt/format.h>

#include "formats/hdf5/hdf5_handle.h"
#include "formats/hdf5/hdf5_reader.h"

namespace palpate {

using hdf5::Handle;

const Hdf5Reader::Kept& Hdf5Reader::kept(const std::string& path, const char* units,
                                         Hdf5Type type, std::int64_t columns) const {
  std::unique_ptr<const Kept>& known = kept_[path];
  if (known && known->type == type && known->units == units &&
      known->columns == columns) {
    return *known;
  }
  known.reset();
  const Hdf5Shape wanted = columns == 0 ? Hdf5Shape{-1} : Hdf5Shape{-1, columns};
  const Hdf5Shape shape = checked_shape(path, units, type, wanted);
  // Without a cache of chunks, which would hold more than the rows that are asked for.
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access.get(), 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT);
  Handle dataset(H5Dopen2(id_, path.c_str(), access.get()), H5Dclose);
  if (!dataset) {
    fail(fmt::format("dataset {} cannot be opened: {}", path, hdf5::last_failure()));
  }
  known = std::make_unique<const Kept>(
      Kept{std::move(dataset), type, units, columns, shape.front()});
  return *known;
}

void Hdf5Reader::rows(const std::string& path, const char* units, Hdf5Type type,
                      std::int64_t begin, std::int64_t count, std::int64_t columns,
                      void* to) const {
  const Kept& opened = kept(path, units, type, columns);
  if (begin < 0 || count < 0 || begin > opened.rows - count) {
    fail(fmt::format("dataset {} has {} rows, the index asks for {} from {}", path,
                     opened.rows, count, begin));
  }
  if (count == 0) {
    return;
  }
  // Rows [begin, begin + count) of the file, all columns, to as many rows in memory.
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(begin), 0};
  const std::array<hsize_t, 2> size{static_cast<hsize_t>(count),
                                    static_cast<hsize_t>(columns)};
  const Handle there(H5Dget_space(opened.dataset.get()), H5Sclose);
  const Handle here(H5Screate_simple(columns == 0 ? 1 : 2, size.data(), nullptr),
                    H5Sclose);
  if (!there ||
      H5Sselect_hyperslab(there.get(), H5S_SELECT_SET, start.data(), nullptr,
                          size.data(), nullptr) < 0 ||
      H5Dread(opened.dataset.get(), hdf5::file_type(type), here.get(), there.get(),
              H5P_DEFAULT, to) < 0) {
    fail(fmt::format("dataset {} cannot be read: {}", path, hdf5::last_failure()));
  }
}

Hdf5Type Hdf5Reader::type_of(const std::string& path) const {
  if (const auto known = kept_.find(path); known != kept_.end() && known->second) {
    return known->second->type;
  }
  const Handle opened(has(path) ? H5Dopen2(id_, path.c_str(), H5P_DEFAULT) : -1,
                      H5Dclose);
  const Handle stored(opened ? H5Dget_type(opened.get()) : -1, H5Tclose);
  for (const Hdf5Type type : {Hdf5Type::kFloat64, Hdf5Type::kFloat32, Hdf5Type::kInt64,
                              Hdf5Type::kInt32, Hdf5Type::kInt16, Hdf5Type::kUint8}) {
    if (stored && H5Tequal(stored.get(), hdf5::file_type(type)) > 0) {
      return type;
    }
  }
  fail(opened ? fmt::format("dataset {} has an unknown element type", path)
              : fmt::format("dataset {} is missing", path));
}

}  // namespace palpate
