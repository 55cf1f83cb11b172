#include "runtime/render/recorder.h"

#include <chrono>
#include <vector>

namespace palpate {
namespace {

// A tenth of what the queues hold at 2 kHz.
constexpr auto kPause = std::chrono::milliseconds(20);

// Takes what is in a queue now.
template <typename Ring, typename Record>
void take_all(Ring& ring, std::vector<Record>& batch) {
  while (const Record* record = ring.front()) {
    batch.push_back(*record);
    ring.pop();
  }
}

}  // namespace

Recorder::Recorder(const std::filesystem::path& file, const RecordingHeader& header)
    : writer_(std::make_unique<RecordingWriter>(file, header)) {}

Recorder::~Recorder() {
  finish("exception");
}

void Recorder::start() {
  thread_ = std::thread([this] {
    while (!stop_.load()) {
      drain();
      std::this_thread::sleep_for(kPause);
    }
  });
}

void Recorder::drain() noexcept {
  try {
    std::vector<TickRecord> ticks;
    std::vector<ArrivalRecord> arrivals;
    take_all(telemetry_->ticks, ticks);
    // What these ticks took in is in its queue by now, and is written before them.
    take_all(telemetry_->arrivals, arrivals);
    if (writer_ != nullptr) {
      writer_->append(arrivals);
      writer_->append(ticks);
    }
  } catch (const std::exception& error) {
    failure_ = error.what();
    writer_.reset();  // leaves the partial file
  } catch (...) {
    writer_.reset();
  }
}

void Recorder::finish(std::string_view fault) noexcept {
  stop_.store(true);
  if (thread_.joinable()) {
    thread_.join();
  }
  if (finished_) {
    return;
  }
  finished_ = true;
  drain();
  try {
    if (writer_ != nullptr) {
      writer_->finish(
          {.ticks_dropped = static_cast<std::int64_t>(telemetry_->ticks.dropped()),
           .arrivals_dropped =
               static_cast<std::int64_t>(telemetry_->arrivals.dropped()),
           .fault = std::string(fault)});
    }
  } catch (const std::exception& error) {
    failure_ = error.what();
  }
  writer_.reset();
}

void write_flight_log(const std::filesystem::path& file, const RecordingHeader& header,
                      const FlightLog& log, std::string_view fault) {
  RecordingWriter writer(file, header);
  writer.append(log.arrivals.values());
  writer.append(log.ticks.values());
  writer.finish({.fault = std::string(fault)});
}

}  // namespace palpate
