#include "runtime/render/recorder.h"

#include <chrono>
#include <vector>

namespace palpate {
namespace {

// A tenth of what the queues hold at 2 kHz.
constexpr auto kPause = std::chrono::milliseconds(20);

// Takes what is in a queue now, and hands it on in one piece.
template <typename Ring, typename Record>
void empty(Ring& ring, RecordingWriter* writer, std::vector<Record>& batch) {
  batch.clear();
  while (const Record* record = ring.front()) {
    batch.push_back(*record);
    ring.pop();
    if (batch.size() == kRecordingBlock) {
      break;
    }
  }
  if (writer != nullptr) {
    writer->append(batch);
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
    do {
      empty(telemetry_->ticks, writer_.get(), ticks);
      empty(telemetry_->arrivals, writer_.get(), arrivals);
    } while (ticks.size() == kRecordingBlock || arrivals.size() == kRecordingBlock);
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
  writer.append(log.ticks.values());
  writer.append(log.arrivals.values());
  writer.finish({.fault = std::string(fault)});
}

}  // namespace palpate
