#include "formats/recording/recording.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <span>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/utf8_path.h"
#include "formats/hdf5/hdf5_handle.h"
#include "formats/hdf5/hdf5_lock.h"
#include "formats/recording/contact_recording.h"
#include "formats/recording/recording_layout.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using hdf5::Handle;
using recording::Column;

constexpr std::size_t kWidest = kKeptLayers;  // columns of a row

class Reader {
 public:
  explicit Reader(const fs::path& file);

  RecordingHeader header() const;
  [[nodiscard]] bool has(const char* name) const {
    return H5Aexists(id_.get(), name) > 0;
  }
  [[nodiscard]] bool has_group(const char* path) const {
    return hdf5::link_at(id_.get(), path) == hdf5::Link::kHard;
  }
  std::string text(const char* name) const;
  std::int64_t integer(const char* name) const;
  double real(const char* name) const;

  // The rows of all columns. Of a file that has not ended, those before the first block
  // that is missing anywhere.
  template <typename Row>
  std::vector<Row> rows(std::span<const Column> columns, bool ended) const;

  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError(fmt::format("{}: {}", utf8_of(file_), what));
  }

 private:
  static Handle open(const fs::path& file);
  Handle attribute(const char* name, H5T_class_t wanted) const;
  Handle dataset(const Column& column) const;
  std::size_t extent(const Column& column, hid_t dataset) const;
  bool read_block(const Column& column, hid_t dataset, std::size_t begin,
                  std::size_t count, std::byte* to) const;

  QuietHdf5 quiet_;
  fs::path file_;
  std::uintmax_t bytes_ = 0;
  Handle id_;
};

// What its writer left open for others to read, when it died, opens in no other way.
Handle Reader::open(const fs::path& file) {
  Handle id(hdf5::open_read_only(file), H5Fclose);
  if (id) {
    return id;
  }
  return {hdf5::open_read_only(file, H5F_ACC_SWMR_READ), H5Fclose};
}

Reader::Reader(const fs::path& file) : file_(file), id_(-1, H5Fclose) {
  require_regular_file(file);
  std::ifstream in(file, std::ios::binary);
  std::array<char, 8> head{};
  in.read(head.data(), head.size());
  std::error_code unknown;
  bytes_ = fs::file_size(file, unknown);
  if (in.bad() || unknown || (!in && !in.eof())) {
    throw InputError(fmt::format("{}: cannot be opened: {}", utf8_of(file),
                                 unknown ? unknown.message() : "cannot be read"));
  }
  if (std::memcmp(head.data(), "\x89HDF\r\n\x1a\n", head.size()) != 0) {
    fail(fmt::format("is not an HDF5 file ({} bytes), must be a recording", bytes_));
  }
  Handle opened = open(file);
  if (!opened) {
    fail(fmt::format("is truncated or damaged ({} bytes): {}", bytes_,
                     hdf5::last_failure()));
  }
  std::destroy_at(&id_);
  std::construct_at(&id_, std::move(opened));
}

Handle Reader::attribute(const char* name, H5T_class_t wanted) const {
  if (!has(name)) {
    fail(fmt::format("attribute /@{} is missing", name));
  }
  Handle opened(H5Aopen(id_.get(), name, H5P_DEFAULT), H5Aclose);
  const Handle type(opened ? H5Aget_type(opened.get()) : -1, H5Tclose);
  const Handle space(opened ? H5Aget_space(opened.get()) : -1, H5Sclose);
  const bool fits =
      type && space && H5Sget_simple_extent_type(space.get()) == H5S_SCALAR &&
      H5Tget_class(type.get()) == wanted &&
      (wanted == H5T_STRING
           ? H5Tis_variable_str(type.get()) == 0 && H5Tget_size(type.get()) <= bytes_
           : H5Tget_size(type.get()) == 8);
  if (!fits) {
    fail(fmt::format("attribute /@{} is not what a recording has there", name));
  }
  return opened;
}

std::string Reader::text(const char* name) const {
  const Handle opened = attribute(name, H5T_STRING);
  const Handle type(H5Aget_type(opened.get()), H5Tclose);
  std::string value(H5Tget_size(type.get()), '\0');
  if (H5Aread(opened.get(), type.get(), value.data()) < 0) {
    fail(fmt::format("attribute /@{} cannot be read: {}", name, hdf5::last_failure()));
  }
  value.erase(value.find_last_not_of('\0') + 1);
  return value;
}

std::int64_t Reader::integer(const char* name) const {
  std::int64_t value = 0;
  if (H5Aread(attribute(name, H5T_INTEGER).get(), H5T_NATIVE_INT64, &value) < 0) {
    fail(fmt::format("attribute /@{} cannot be read: {}", name, hdf5::last_failure()));
  }
  return value;
}

double Reader::real(const char* name) const {
  double value = 0.0;
  if (H5Aread(attribute(name, H5T_FLOAT).get(), H5T_NATIVE_DOUBLE, &value) < 0) {
    fail(fmt::format("attribute /@{} cannot be read: {}", name, hdf5::last_failure()));
  }
  return value;
}

RecordingHeader Reader::header() const {
  if (!has("format") || text("format") != recording::kFormat) {
    fail("is not a recording");
  }
  const std::int64_t version = integer("format_version");
  if (version < 1 || version > kRecordingVersion) {
    fail(fmt::format("format version is {}, must be 1 to {}", version,
                     kRecordingVersion));
  }
  RecordingHeader header;
  const auto read_all = [&](const auto& texts, const auto& numbers) {
    for (const recording::TextField& field : texts) {
      header.*field.member = text(field.name);
    }
    for (const recording::NumberField& field : numbers) {
      header.*field.member = real(field.name);
      if (std::isnan(header.*field.member)) {
        fail(fmt::format("attribute /@{} is not a number", field.name));
      }
    }
  };
  read_all(recording::kTexts, recording::kNumbers);
  // Version 1 called the field over facets "potential".
  header.model = recorded_model(version, header.model);
  if (version >= 3) {
    read_all(recording::kAddedTexts, recording::kAddedNumbers);
  }
  if (header.poses == 0.0 && !header.second_tool.empty()) {
    fail("names a second tool, whose ticks must have poses");
  }
  return header;
}

// Ours in every respect: nothing else is handed to HDF5 to interpret.
Handle Reader::dataset(const Column& column) const {
  const auto stored = [this](const char* path) {
    return path != nullptr && hdf5::link_at(id_.get(), path) == hdf5::Link::kHard;
  };
  const char* path = stored(column.former) ? column.former : column.path;
  if (!stored(path)) {
    fail(fmt::format("dataset {} is missing or a link to another", column.path));
  }
  Handle opened(H5Dopen2(id_.get(), path, H5P_DEFAULT), H5Dclose);
  const Handle type(opened ? H5Dget_type(opened.get()) : -1, H5Tclose);
  const Handle create(opened ? H5Dget_create_plist(opened.get()) : -1, H5Pclose);
  unsigned flags = 0;
  std::size_t values = 0;
  const bool fits =
      type && create && H5Tequal(type.get(), hdf5::file_type(column.type)) > 0 &&
      H5Pget_layout(create.get()) == H5D_CHUNKED &&
      H5Pget_nfilters(create.get()) == 1 &&
      H5Pget_filter2(create.get(), 0, &flags, &values, nullptr, 0, nullptr, nullptr) ==
          H5Z_FILTER_FLETCHER32;
  if (!fits) {
    fail(fmt::format("dataset {} is not what a recording has there", column.path));
  }
  return opened;
}

std::size_t Reader::extent(const Column& column, hid_t dataset) const {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const int rank = column.width == 1 ? 1 : 2;
  std::array<hsize_t, 2> size{0, 1};
  if (!space || H5Sget_simple_extent_ndims(space.get()) != rank ||
      H5Sget_simple_extent_dims(space.get(), size.data(), nullptr) < 0 ||
      size[1] != column.width || size[0] > bytes_) {
    fail(fmt::format("dataset {} has not the shape that a recording has there",
                     column.path));
  }
  return size[0];
}

bool Reader::read_block(const Column& column, hid_t dataset, std::size_t begin,
                        std::size_t count, std::byte* to) const {
  const int rank = column.width == 1 ? 1 : 2;
  const std::array<hsize_t, 2> from{begin, 0};
  const std::array<hsize_t, 2> size{count, column.width};
  const Handle in_file(H5Dget_space(dataset), H5Sclose);
  const Handle in_memory(H5Screate_simple(rank, size.data(), nullptr), H5Sclose);
  H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, from.data(), nullptr, size.data(),
                      nullptr);
  // A block that was never written would read as zeros.
  hsize_t stored = 0;
  const std::array<hsize_t, 2> block{begin, 0};
  return H5Dget_chunk_storage_size(dataset, block.data(), &stored) >= 0 && stored > 0 &&
         H5Dread(dataset, hdf5::file_type(column.type), in_memory.get(), in_file.get(),
                 H5P_DEFAULT, to) >= 0;
}

template <typename Row>
std::vector<Row> Reader::rows(std::span<const Column> columns, bool ended) const {
  std::vector<Handle> opened;
  std::size_t count = SIZE_MAX;
  for (const Column& column : columns) {
    opened.push_back(dataset(column));
    const std::size_t rows = extent(column, opened.back().get());
    // Columns are written one after another: where the writer died, the shortest
    // counts.
    if (ended && count != SIZE_MAX && rows != count) {
      fail(fmt::format("dataset {} has {} rows, must have {}", column.path, rows,
                       count));
    }
    count = std::min(count, rows);
  }
  std::vector<Row> table;
  // A block of a column after the other, each scattered over the rows' members.
  std::vector<std::byte> packed(kRecordingBlock * kWidest * sizeof(double));
  for (std::size_t begin = 0; begin < count; begin += kRecordingBlock) {
    const std::size_t block = std::min(kRecordingBlock, count - begin);
    table.resize(begin + block);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (!read_block(columns[i], opened[i].get(), begin, block, packed.data())) {
        if (ended) {
          fail(fmt::format("dataset {}, rows from {}: damaged: {}", columns[i].path,
                           begin, hdf5::last_failure()));
        }
        // A block that was not written ends what is known; in an ended recording it is
        // damage.
        table.resize(begin);
        return table;
      }
      const std::size_t bytes = columns[i].width * bytes_of(columns[i].type);
      for (std::size_t row = 0; row < block; ++row) {
        auto* to = reinterpret_cast<std::byte*>(&table[begin + row]);
        std::memcpy(to + columns[i].offset, &packed[row * bytes], bytes);
      }
    }
  }
  return table;
}

// Of two tables that a crash has cut at different times: ticks whose elements are
// there.
void leave_whole_ticks(Recording& recording) {
  const auto arrived = static_cast<std::int64_t>(recording.arrival.size());
  const auto cut = std::find_if(recording.tick.begin(), recording.tick.end(),
                                [&](const TickRecord& tick) {
                                  return tick.arrivals > arrived;
                                });
  recording.tick.erase(cut, recording.tick.end());
}

bool all_finite(const TickRecord& tick) {
  // A pose is as measured: what the device said, even if that is no number.
  const std::array<double, 6> numbers{tick.depth_m,      tick.work_j,
                                      tick.stored_j,     tick.tank_j,
                                      tick.dissipated_j, tick.rest_offset_m};
  const auto finite = [](double x) {
    return std::isfinite(x);
  };
  const auto all = [&](const auto& values) {
    return std::all_of(values.begin(), values.end(), finite);
  };
  return all(numbers) && all(tick.force_n) && all(tick.torque_n_m) &&
         all(tick.second.force_n) && all(tick.second.torque_n_m);
}

void check(const Recording& recording, const Reader& reader) {
  const RecordingHeader& h = recording.header;
  if (!(h.fast_hz > 0.0 && h.slow_hz > 0.0 && h.force_scale > 0.0)) {
    reader.fail(
        fmt::format("rates are {} and {} Hz and the scale of forces is {}, "
                    "must be positive",
                    h.fast_hz, h.slow_hz, h.force_scale));
  }
  for (std::size_t i = 0; i < recording.tick.size(); ++i) {
    const TickRecord& tick = recording.tick[i];
    if (tick.tick < 0 || (i > 0 && tick.tick <= recording.tick[i - 1].tick)) {
      reader.fail(fmt::format("tick number {} in row {} is not above the one before",
                              tick.tick, i));
    }
    if (!all_finite(tick)) {
      reader.fail(fmt::format("tick {} has a force or an energy that is not finite",
                              tick.tick));
    }
  }
  for (std::size_t i = 1; i < recording.arrival.size(); ++i) {
    // Elements are accepted again in this order.
    if (recording.arrival[i].tick < recording.arrival[i - 1].tick) {
      reader.fail(fmt::format("arrival in row {} is earlier than the one before", i));
    }
  }
}

}  // namespace

Recording read_recording(const fs::path& file) {
  if (is_contact_recording(file)) {
    return read_contact_recording(file);
  }
  const Hdf5Lock lock;
  const Reader reader(file);
  Recording recording;
  recording.header = reader.header();
  recording.ended = reader.has("ended");
  KeptSurface& surface = recording.header.surface;
  if (reader.has_group("/surface")) {
    surface.yielded =
        reader.rows<YieldedRow>(recording::surface_columns(recording.header), true);
  }
  if (reader.has_group("/channel")) {
    surface.channels = reader.rows<ChannelRow>(recording::kChannelColumns, true);
  }
  check_kept(surface, fmt::format("{}: /surface", utf8_of(file)));
  recording.tick = reader.rows<TickRecord>(recording::tick_columns(recording.header),
                                           recording.ended);
  recording.arrival = reader.rows<ArrivalRecord>(
      recording::arrival_columns(recording.header), recording.ended);
  if (recording.ended) {
    recording.end = {.ticks_dropped = reader.integer("ticks_dropped"),
                     .arrivals_dropped = reader.integer("arrivals_dropped"),
                     .fault = reader.text("fault")};
  } else {
    leave_whole_ticks(recording);
  }
  check(recording, reader);
  return recording;
}

}  // namespace palpate
