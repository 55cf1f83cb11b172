#include "formats/recording/recording_writer.h"

#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "formats/hdf5/hdf5_handle.h"
#include "formats/hdf5/hdf5_lock.h"
#include "formats/recording/recording_layout.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using hdf5::Handle;
using recording::Column;

[[noreturn]] void cannot_write(const fs::path& file, const std::string& why) {
  throw InputError(fmt::format("{}: cannot be written: {}", file.string(), why));
}

void put(const fs::path& file, hid_t object, const char* name, hid_t type,
         const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle made(
      H5Acreate2(object, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!made || H5Awrite(made.get(), type, value) < 0) {
    cannot_write(file, hdf5::last_failure());
  }
}

void put_text(const fs::path& file, hid_t object, const char* name,
              const std::string& value) {
  const Handle type = hdf5::string_type(value.size());
  put(file, object, name, type.get(), value.c_str());
}

void put_number(const fs::path& file, hid_t object, const char* name,
                std::int64_t value) {
  put(file, object, name, H5T_STD_I64LE, &value);
}

void put_header(const fs::path& file, hid_t root, const RecordingHeader& header) {
  put_text(file, root, "format", recording::kFormat);
  put_number(file, root, "format_version", kRecordingVersion);
  const auto put_all = [&](const auto& texts, const auto& numbers) {
    for (const recording::TextField& field : texts) {
      put_text(file, root, field.name, header.*field.member);
    }
    for (const recording::NumberField& field : numbers) {
      put(file, root, field.name, H5T_IEEE_F64LE, &(header.*field.member));
    }
  };
  put_all(recording::kTexts, recording::kNumbers);
  put_all(recording::kAddedTexts, recording::kAddedNumbers);
}

// An empty dataset that can grow, in checksummed blocks.
void make_column(const fs::path& file, hid_t id, const Column& column) {
  const int rank = column.width == 1 ? 1 : 2;
  const std::array<hsize_t, 2> size{0, column.width};
  const std::array<hsize_t, 2> most{H5S_UNLIMITED, column.width};
  const std::array<hsize_t, 2> block{kRecordingBlock, column.width};
  const Handle space(H5Screate_simple(rank, size.data(), most.data()), H5Sclose);
  const Handle create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(create.get(), false);
  H5Pset_chunk(create.get(), rank, block.data());
  H5Pset_fletcher32(create.get());
  const Handle made(H5Dcreate2(id, column.path, hdf5::file_type(column.type),
                               space.get(), H5P_DEFAULT, create.get(), H5P_DEFAULT),
                    H5Dclose);
  if (!made) {
    cannot_write(file, hdf5::last_failure());
  }
  put_text(file, made.get(), "units", column.units);
}

// Same run, same bytes, whenever it is written.
Handle without_times(hid_t kind) {
  Handle create(H5Pcreate(kind), H5Pclose);
  H5Pset_obj_track_times(create.get(), false);
  return create;
}

Handle open_file(const fs::path& file, bool create) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
  const Handle made = without_times(H5P_FILE_CREATE);
  Handle id(create ? H5Fcreate(file.c_str(), H5F_ACC_TRUNC, made.get(), access.get())
                   : H5Fopen(file.c_str(), H5F_ACC_RDWR, access.get()),
            H5Fclose);
  if (!id) {
    cannot_write(file, errno != 0 ? std::strerror(errno) : hdf5::last_failure());
  }
  return id;
}

void flush_to_disk(const fs::path& path, int flags, const fs::path& target) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  const bool done = fd >= 0 && (::fsync(fd) == 0 || errno == EINVAL);
  const int error = errno;
  if (fd >= 0) {
    ::close(fd);
  }
  if (!done) {
    cannot_write(target, std::strerror(error));
  }
}

}  // namespace

// One table of rows: its datasets, and rows that do not fill a block yet.
template <typename Row>
class RecordingTable {
 public:
  RecordingTable(fs::path file, hid_t id, std::vector<Column> columns)
      : file_(std::move(file)), columns_(std::move(columns)) {
    for (const Column& column : columns_) {
      dataset_.emplace_back(H5Dopen2(id, column.path, H5P_DEFAULT), H5Dclose);
    }
    waiting_.reserve(kRecordingBlock);
  }

  // `before_block` is called before a block is written.
  template <typename Before>
  void append(std::span<const Row> rows, Before before_block) {
    for (const Row& row : rows) {
      waiting_.push_back(row);
      if ((rows_ + static_cast<std::int64_t>(waiting_.size())) % kBlock == 0) {
        before_block();
        write();
      }
    }
  }
  void append(std::span<const Row> rows) {
    append(rows, [] {});
  }

  // Writes the rows that wait. A block that is not full is filled by later rows.
  void write() {
    for (std::size_t i = 0; i < columns_.size() && !waiting_.empty(); ++i) {
      write_column(columns_[i], dataset_[i].get());
    }
    rows_ += static_cast<std::int64_t>(waiting_.size());
    waiting_.clear();
  }

 private:
  static constexpr auto kBlock = static_cast<std::int64_t>(kRecordingBlock);

  void write_column(const Column& column, hid_t dataset) {
    const std::size_t bytes = column.width * bytes_of(column.type);
    packed_.resize(bytes * waiting_.size());
    for (std::size_t row = 0; row < waiting_.size(); ++row) {
      const auto* from = reinterpret_cast<const std::byte*>(&waiting_[row]);
      std::memcpy(&packed_[row * bytes], from + column.offset, bytes);
    }
    const int rank = column.width == 1 ? 1 : 2;
    const std::array<hsize_t, 2> begin{static_cast<hsize_t>(rows_), 0};
    const std::array<hsize_t, 2> count{waiting_.size(), column.width};
    const std::array<hsize_t, 2> size{begin[0] + count[0], column.width};
    if (H5Dset_extent(dataset, size.data()) < 0) {
      cannot_write(file_, hdf5::last_failure());
    }
    const Handle in_file(H5Dget_space(dataset), H5Sclose);
    const Handle in_memory(H5Screate_simple(rank, count.data(), nullptr), H5Sclose);
    H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, begin.data(), nullptr,
                        count.data(), nullptr);
    const hid_t type = hdf5::file_type(column.type);
    if (H5Dwrite(dataset, type, in_memory.get(), in_file.get(), H5P_DEFAULT,
                 packed_.data()) < 0 ||
        H5Dflush(dataset) < 0) {
      cannot_write(file_, hdf5::last_failure());
    }
  }

  fs::path file_;
  std::vector<Column> columns_;
  std::vector<Handle> dataset_;
  std::vector<Row> waiting_;
  std::vector<std::byte> packed_;
  std::int64_t rows_ = 0;
};

class RecordingWriter::File {
 public:
  File(const fs::path& target, const RecordingHeader& header)
      : target_(target), partial_(target.string() + ".partial") {
    if (!target.has_filename() ||
        (fs::exists(target) && !fs::is_regular_file(target))) {
      cannot_write(target, "is not a regular file");
    }
    errno = 0;
    id_.emplace(open_file(partial_, true));
    put_header(target_, id_->get(), header);
    const Handle create = without_times(H5P_GROUP_CREATE);
    for (const char* group : {"/tick", "/arrival"}) {
      const Handle made(
          H5Gcreate2(id_->get(), group, H5P_DEFAULT, create.get(), H5P_DEFAULT),
          H5Gclose);
    }
    const std::vector<Column> of_ticks = recording::tick_columns(header);
    const std::vector<Column> of_arrivals = recording::arrival_columns(header);
    for (const std::vector<Column>& columns : {of_ticks, of_arrivals}) {
      for (const Column& column : columns) {
        make_column(target_, id_->get(), column);
      }
    }
    if (!header.surface.yielded.empty()) {
      put_rows("/surface", recording::surface_columns(header), header.surface.yielded,
               create.get());
    }
    if (!header.surface.channels.empty()) {
      put_rows("/channel",
               {recording::kChannelColumns.begin(), recording::kChannelColumns.end()},
               header.surface.channels, create.get());
    }
    if (H5Fstart_swmr_write(id_->get()) < 0) {
      cannot_write(target_, hdf5::last_failure());
    }
    ticks.emplace(target_, id_->get(), of_ticks);
    arrivals.emplace(target_, id_->get(), of_arrivals);
  }

  void finish(const RecordingEnd& end) {
    ticks->write();
    arrivals->write();
    ticks.reset();
    arrivals.reset();
    id_.reset();
    id_.emplace(open_file(partial_, false));
    // In single-writer mode no attribute can be made.
    put_number(target_, id_->get(), "ticks_dropped", end.ticks_dropped);
    put_number(target_, id_->get(), "arrivals_dropped", end.arrivals_dropped);
    put_text(target_, id_->get(), "fault", end.fault);
    put_number(target_, id_->get(), "ended", 1);
    if (H5Fflush(id_->get(), H5F_SCOPE_GLOBAL) < 0) {
      cannot_write(target_, hdf5::last_failure());
    }
    id_.reset();
    flush_to_disk(partial_, O_RDONLY, target_);
    std::error_code error;
    fs::rename(partial_, target_, error);
    if (error) {
      cannot_write(target_, error.message());
    }
    const fs::path folder = target_.has_parent_path() ? target_.parent_path() : ".";
    flush_to_disk(folder, O_RDONLY | O_DIRECTORY, target_);
  }

 private:
  template <typename Row>
  void put_rows(const char* group, const std::vector<Column>& columns,
                const std::vector<Row>& rows, hid_t create) {
    {
      const Handle made(H5Gcreate2(id_->get(), group, H5P_DEFAULT, create, H5P_DEFAULT),
                        H5Gclose);
    }
    for (const Column& column : columns) {
      make_column(target_, id_->get(), column);
    }
    RecordingTable<Row> table(target_, id_->get(), columns);
    table.append(rows);
    table.write();
  }

  QuietHdf5 quiet_;
  fs::path target_;
  fs::path partial_;
  std::optional<Handle> id_;

 public:
  // Closed before the file.
  std::optional<RecordingTable<TickRecord>> ticks;
  std::optional<RecordingTable<ArrivalRecord>> arrivals;
};

RecordingWriter::RecordingWriter(const fs::path& file, const RecordingHeader& header) {
  const Hdf5Lock lock;
  file_ = std::make_unique<File>(file, header);
}

RecordingWriter::~RecordingWriter() {
  const Hdf5Lock lock;
  if (failed_) {
    // HDF5 1.10 can crash when it closes a file after a write that failed.
    static_cast<void>(file_.release());
  }
  file_.reset();
}

template <typename Work>
void RecordingWriter::guarded(Work work) {
  const Hdf5Lock lock;
  failed_ = true;
  work();
  failed_ = false;
}

void RecordingWriter::append(std::span<const TickRecord> ticks) {
  guarded([&] {
    file_->ticks->append(ticks, [&] {
      file_->arrivals->write();  // else a crash would take the ticks, too
    });
  });
}

void RecordingWriter::append(std::span<const ArrivalRecord> arrivals) {
  guarded([&] {
    file_->arrivals->append(arrivals);
  });
}

void RecordingWriter::finish(const RecordingEnd& end) {
  guarded([&] {
    file_->finish(end);
  });
}

}  // namespace palpate
