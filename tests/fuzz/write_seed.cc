// Writes a small database and, where more files are named, small recordings of one
// contact, of several by a program of before, and of two hands: the seeds of
// database_fuzz and recording_fuzz.
#include <array>

#include "formats/hdf5/hdf5_lock.h"
#include "formats/recording/recording_writer.h"
#include "tests/support/old_contact_recording.h"
#include "tests/support/punctured_sphere.h"
#include "tests/support/small_database.h"

namespace {

void write_recording(const char* file, bool two_hands) {
  palpate::RecordingHeader header;
  header.poses = two_hands ? 1.0 : 0.0;
  header.second_tool = two_hands ? "finger" : "";
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

void write_contacts(const char* file) {
  palpate::OldContactRecording r;
  r.tools = {"ball"};
  r.fast_hz = 1000.0;
  r.slow_hz = 100.0;
  r.force_max_n = 8.0;
  r.time_s = {0.0, 0.001};
  r.pose = palpate::RowMajor<double>::Zero(2, 7);
  r.pose.col(6).setOnes();
  r.wrench = palpate::RowMajor<double>::Zero(2, 6);
  r.contacts = {0, 0};
  for (auto* column :
       {&r.depth_m, &r.work_j, &r.stored_j, &r.tank_j, &r.dissipated_j}) {
    column->resize(2);
  }
  palpate::write_old_contact_recording(file, r);
}

}  // namespace

int main(int argc, char** argv) {
  palpate::skip_hdf5_exit_cleanup();
  palpate::ResponseDatabase database = palpate::small_database();
  database.tools[1].puncture = palpate::some_puncture(6);
  palpate::write_database(argv[1], database);
  if (argc > 2) {
    write_recording(argv[2], false);
  }
  if (argc > 3) {
    write_contacts(argv[3]);
  }
  if (argc > 4) {
    write_recording(argv[4], true);
  }
  return 0;
}
