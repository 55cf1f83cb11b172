// What a build without HDF5 has in place of recording.cc and recording_writer.cc:
// recordings grow block by block, which flat files do not.
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/utf8_path.h"
#include "formats/recording/recording_writer.h"

namespace palpate {

class RecordingWriter::File {};

RecordingWriter::RecordingWriter(const std::filesystem::path& file,
                                 const RecordingHeader& /*header*/) {
  throw InputError(fmt::format(
      "{}: cannot be written: recordings are HDF5 files, which this build does not "
      "write",
      utf8_of(file)));
}

RecordingWriter::~RecordingWriter() = default;

void RecordingWriter::append(std::span<const TickRecord> /*ticks*/) {}

void RecordingWriter::append(std::span<const ArrivalRecord> /*arrivals*/) {}

void RecordingWriter::finish(const RecordingEnd& /*end*/) {}

Recording read_recording(const std::filesystem::path& file) {
  throw InputError(fmt::format(
      "{}: cannot be read: recordings are HDF5 files, which this build does not read",
      utf8_of(file)));
}

}  // namespace palpate
