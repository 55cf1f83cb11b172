// Writes a recording as it happens.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "formats/recording/recording.h"

namespace palpate {

/// Writes beside the target, as "<target>.partial", block by block. finish() closes the
/// partial file and renames it over the target, so that the target is always a whole
/// recording. After a crash or SIGKILL the partial file can be read up to its last
/// whole block of ticks. Each block is in the kernel's hands when append() returns,
/// after all arrivals that were appended before. HDF5's single-writer mode keeps what
/// leads to the blocks in order. (After a power failure only what the kernel had
/// written.) One thread; excludes other use of HDF5 by Hdf5Lock.
class RecordingWriter {
 public:
  /// @throws InputError if the place cannot be written.
  RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header);
  /// Leaves the partial file behind unless finish() was called.
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Keeps what does not fill a block for the next call; a tick's arrivals come before
  /// it. @throws InputError if the file cannot be written, for example on a full disk.
  void append(std::span<const TickRecord> ticks);
  void append(std::span<const ArrivalRecord> arrivals);

  /// Writes what is left and the end, fsync, rename. To be called once.
  void finish(const RecordingEnd& end);

 private:
  class File;
  template <typename Work>
  void guarded(Work work);

  std::unique_ptr<File> file_;
  bool failed_ = false;
};

}  // namespace palpate
