// Writes what the fast process says of its ticks, without ever holding it up.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "formats/recording/recording_writer.h"
#include "runtime/render/telemetry.h"

namespace palpate {

/// Empties the queues of a Telemetry into a file, in a thread of its own. In simulated
/// time drain() empties them when it is called, so that the file is the same every
/// time. A file that cannot be written any more ends the recording, not the run;
/// failure() says so.
class Recorder {
 public:
  /// @throws InputError if the place cannot be written.
  Recorder(const std::filesystem::path& file, const RecordingHeader& header);

  /// Ends the recording with the fault "exception", unless finish() was called.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// The queues; the fast thread's end is `push`.
  [[nodiscard]] Telemetry& telemetry() noexcept { return *telemetry_; }

  /// From here on a thread calls drain().
  void start();

  /// Writes what the queues hold. Allocates, locks, may wait for the disk.
  void drain() noexcept;

  /// Ends the thread, writes the rest and the end. To be called once the fast thread is
  /// silent.
  void finish(std::string_view fault) noexcept;

  /// Why the recording ended early; empty if it did not.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

  /// Records that are not in the file because a queue was full.
  [[nodiscard]] std::uint64_t dropped() const noexcept {
    return telemetry_->ticks.dropped() + telemetry_->arrivals.dropped();
  }

 private:
  std::unique_ptr<Telemetry> telemetry_ = std::make_unique<Telemetry>();
  std::unique_ptr<RecordingWriter> writer_;
  std::string failure_;
  bool finished_ = false;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

/// Writes the flight log as a recording that begins where the log does.
/// @throws InputError if the place cannot be written.
void write_flight_log(const std::filesystem::path& file, const RecordingHeader& header,
                      const FlightLog& log, std::string_view fault);

}  // namespace palpate
