// Writes a small database and, where a second file is named, a small recording: the
// seeds of database_fuzz and recording_fuzz.
#include <array>

#include "formats/hdf5/hdf5_io.h"
#include "formats/recording/recording_writer.h"
#include "tests/support/small_database.h"

namespace {

void write_recording(const char* file) {
  palpate::RecordingHeader header;
  header.fast_hz = 1000.0;
  header.slow_hz = 100.0;
  palpate::RecordingWriter writer(file, header);
  std::array<palpate::TickRecord, 5> ticks{};
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ticks[i].tick = static_cast<std::int64_t>(i);
  }
  writer.append(ticks);
  writer.append(std::array<palpate::ArrivalRecord, 2>{});
  writer.finish({});
}

}  // namespace

int main(int argc, char** argv) {
  palpate::skip_hdf5_exit_cleanup();
  palpate::write_database(argv[1], palpate::small_database());
  if (argc > 2) {
    write_recording(argv[2]);
  }
  return 0;
}
