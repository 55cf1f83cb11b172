#include "runtime/device/threaded_device.h"

#include <utility>

#include "formats/base/error.h"
#include "runtime/device/device_turn.h"
#include "runtime/realtime/clock.h"
#include "runtime/realtime/real_time.h"

namespace palpate {
namespace {

constexpr std::int64_t kFirstReadingNs = 2'000'000'000;

}  // namespace

LinkedDevice::LinkedDevice(std::unique_ptr<DeviceLink> link, const LinkTiming& timing)
    : link_(std::move(link)), timing_(timing) {}

LinkedDevice::~LinkedDevice() {
  close();
}

void LinkedDevice::open() {
  close();
  stop_.store(false);
  lost_.store(false);
  silent_ = false;
  report_ = {};
  command_.write({});
  static_cast<void>(reading_.fetch());  // one of an earlier session is no answer
  link_->open();
  thread_ = std::thread([this] {
    run();
  });
  MonotonicClock clock;
  const std::int64_t until_ns = clock.now_ns() + kFirstReadingNs;
  while (!reading_.fetch()) {
    if (lost_.load() || clock.now_ns() > until_ns) {
      const std::string why = lost_.load() ? failure() : "no position within 2 s";
      close();
      throw DeviceError(name() + ": " + why);
    }
    clock.sleep_until_ns(clock.now_ns() + 1'000'000);
  }
}

DeviceStatus LinkedDevice::read(DeviceReading& reading) noexcept {
  if (lost_.load()) {
    return DeviceStatus::kLost;
  }
  static_cast<void>(reading_.fetch());
  reading = reading_.latest().reading;
  MonotonicClock clock;
  reading.read_ns = clock.now_ns();
  const bool stale =
      reading.read_ns - reading.time_ns > nanoseconds_in(timing_.stale_s);
  return stale ? DeviceStatus::kLate : DeviceStatus::kOk;
}

DeviceStatus LinkedDevice::write(const Eigen::Vector3d& force_n) noexcept {
  MonotonicClock clock;
  command_.write({.force_n = force_n,
                  .time_ns = clock.now_ns(),
                  .measured_ns = reading_.latest().begin_ns});
  return lost_.load() ? DeviceStatus::kLost : DeviceStatus::kOk;
}

void LinkedDevice::close() noexcept {
  stop_.store(true);
  if (thread_.joinable()) {
    thread_.join();
  }
}

std::string LinkedDevice::failure() const {
  return lost_.load() ? link_->failure() : "";
}

LinkedDevice::Command LinkedDevice::wanted(std::int64_t now_ns) noexcept {
  static_cast<void>(command_.fetch());
  const Command& command = command_.latest();
  const bool silent = now_ns - command.time_ns > nanoseconds_in(timing_.silent_s);
  report_.silences += silent && !silent_ && command.time_ns > 0 ? 1 : 0;
  silent_ = silent;
  return silent ? Command{} : command;
}

// While the fast loop writes.
void LinkedDevice::await_answer(std::int64_t measured_ns) noexcept {
  constexpr std::int64_t kLookNs = 20'000;
  MonotonicClock clock;
  const std::int64_t until_ns = clock.now_ns() + nanoseconds_in(timing_.answer_s);
  while (!silent_ && !stop_.load() && clock.now_ns() < until_ns) {
    static_cast<void>(command_.fetch());
    if (command_.latest().measured_ns >= measured_ns) {
      return;
    }
    clock.sleep_until_ns(clock.now_ns() + kLookNs);
  }
}

void LinkedDevice::run() noexcept {
  static_cast<void>(request_real_time(-1));
  MonotonicClock clock;
  const std::int64_t begin_ns = clock.now_ns();
  const auto period_ns = nanoseconds_in(1.0 / timing_.rate_max_hz);
  Command held;  // what the device got last
  TurnFromStart from_start;
  while (!stop_.load()) {
    const std::int64_t start_ns = clock.now_ns();
    Measured measured{.reading = {}, .begin_ns = start_ns};
    const Command command = wanted(start_ns);
    const LinkStatus status =
        link_->transact(command.force_n, measured.reading.position_m);
    const std::int64_t end_ns = clock.now_ns();
    measured.reading.time_ns = end_ns;
    measured.reading.withheld_n = command_.latest().force_n - link_->sent_n();
    report_.time.add(end_ns - start_ns);
    ++report_.transactions;
    if (held.force_n != Eigen::Vector3d::Zero()) {
      report_.force_age.add(end_ns - held.measured_ns);
    }
    if (status == LinkStatus::kOk) {
      held = command;
      measured.reading.turn = from_start(link_->turn());
      reading_.write(measured);
      await_answer(start_ns);
    } else if (status == LinkStatus::kLost) {
      lost_.store(true);
      break;
    } else {
      ++report_.missed;
    }
    clock.sleep_until_ns(start_ns + period_ns);
  }
  report_.duration_s =
      static_cast<double>(clock.now_ns() - begin_ns) / kNanosecondsPerSecond;
  link_->close();
}

}  // namespace palpate
