#include "runtime/render_loop.h"

#include <cmath>
#include <memory>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "formats/error.h"
#include "runtime/deadlines.h"
#include "runtime/real_time.h"

namespace palpate {
namespace {

void check_positive(const char* what, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw InputError(fmt::format("{} is {}, must be positive and finite", what, value));
  }
}

// The slow process without its clock.
class SlowProcess {
 public:
  SlowProcess(ElementSender& stream, RenderExchange& exchange)
      : stream_(stream), exchange_(exchange) {}

  // Nothing more after a failure: the fast process goes on with what it has.
  void update(std::int64_t now_ns, std::int64_t skipped) noexcept {
    missed_deadlines += skipped;
    if (failure != nullptr || !exchange_.tool.fetch()) {
      return;
    }
    try {
      stream_.update(exchange_.tool.latest(), now_ns, exchange_.elements);
      ++updates;
    } catch (...) {
      failure = std::current_exception();
    }
  }

  std::int64_t updates = 0;
  std::int64_t missed_deadlines = 0;
  std::exception_ptr failure;

 private:
  ElementSender& stream_;
  RenderExchange& exchange_;
};

std::int64_t end_ns(std::int64_t start_ns, double duration_s) {
  return start_ns + std::llround(duration_s * kNanosecondsPerSecond);
}

std::string message_of(const std::exception_ptr& failure) {
  if (failure == nullptr) {
    return "";
  }
  try {
    std::rethrow_exception(failure);
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "unknown exception";
  }
}

RenderReport finish(const FastProcess& fast, const SlowProcess& slow,
                    const RenderSetup& setup) {
  RenderReport report = fast.report();
  report.slow_updates = slow.updates;
  report.slow_missed_deadlines = slow.missed_deadlines;
  report.slow_error = slow.failure;
  report.slow_failure = message_of(slow.failure);
  report.interrupted = setup.stop.load();
  return report;
}

TickOutputs outputs(const RenderSetup& setup) {
  return {
      .trace = setup.trace,
      .telemetry = setup.recorder == nullptr ? nullptr : &setup.recorder->telemetry(),
      .flight = setup.flight};
}

// Sets a flag and joins a thread on every way out of a scope.
class JoinedThread {
 public:
  JoinedThread(std::atomic<bool>& done, std::thread thread)
      : done_(done), thread_(std::move(thread)) {}
  ~JoinedThread() {
    done_.store(true);
    thread_.join();
  }
  JoinedThread(const JoinedThread&) = delete;
  JoinedThread& operator=(const JoinedThread&) = delete;

 private:
  std::atomic<bool>& done_;
  std::thread thread_;
};

// Fast ticks after which a recorder without a thread is emptied: its queues hold the
// elements of so many slow updates.
constexpr std::int64_t kDrainTicks = 256;

// Sleeps to a deadline and begins its work: the deadlines skipped since the last.
std::int64_t wait(Deadlines& deadlines, Clock& clock) noexcept {
  clock.sleep_until_ns(deadlines.next_ns());
  return deadlines.begin(clock.now_ns());
}

}  // namespace

void check(const RenderConfig& config) {
  check_positive("duration [s]", config.duration_s);
  check_positive("fast rate [Hz]", config.fast.rate_hz);
  check_positive("slow rate [Hz]", config.slow_hz);
  if (config.slow_hz > config.fast.rate_hz) {
    throw InputError(fmt::format("slow rate is {} Hz, must be at most the fast {} Hz",
                                 config.slow_hz, config.fast.rate_hz));
  }
  if (config.fast.rate_hz > 1e5 || config.slow_hz < 1.0) {
    throw InputError(
        fmt::format("rates are {} and {} Hz, must be at most 100000 and at least 1",
                    config.fast.rate_hz, config.slow_hz));
  }
}

RenderReport render_in_turns(const RenderConfig& config, const RenderSetup& setup,
                             Clock& clock) {
  check(config);
  const auto exchange = std::make_unique<RenderExchange>();
  const auto fast = std::make_unique<FastProcess>(config.fast, setup.device, *exchange,
                                                  outputs(setup));
  SlowProcess slow(setup.stream, *exchange);
  const DeviceSession session(setup.device);
  const std::int64_t start_ns = clock.now_ns();
  const std::int64_t stop_ns = end_ns(start_ns, config.duration_s);
  Deadlines fast_deadlines(start_ns, config.fast.rate_hz);
  Deadlines slow_deadlines(start_ns, config.slow_hz);
  while (fast_deadlines.next_ns() < stop_ns && !setup.stop.load()) {
    if (!fast->tick(wait(fast_deadlines, clock))) {
      break;
    }
    if (clock.now_ns() >= slow_deadlines.next_ns()) {
      slow.update(clock.now_ns(), slow_deadlines.begin(clock.now_ns()));
    }
    if (setup.recorder != nullptr && fast->report().ticks % kDrainTicks == 0) {
      setup.recorder->drain();
    }
  }
  return finish(*fast, slow, setup);
}

RenderReport render_in_real_time(const RenderConfig& config, const RenderSetup& setup) {
  check(config);
  const auto exchange = std::make_unique<RenderExchange>();
  const auto fast = std::make_unique<FastProcess>(config.fast, setup.device, *exchange,
                                                  outputs(setup));
  SlowProcess slow(setup.stream, *exchange);
  const DeviceSession session(setup.device);
  if (setup.recorder != nullptr) {
    setup.recorder->start();
  }
  MonotonicClock clock;
  RealTimeGrant grant;
  std::atomic<bool> done = false;
  const std::int64_t start_ns = clock.now_ns();
  const std::int64_t stop_ns = end_ns(start_ns, config.duration_s);

  // The threads touch what is theirs, the exchange and the flags; nothing else.
  {
    const JoinedThread slow_thread(done, std::thread([&] {
                                     request_slow_real_time();
                                     Deadlines deadlines(start_ns, config.slow_hz);
                                     while (!done.load()) {
                                       const std::int64_t skipped =
                                           wait(deadlines, clock);
                                       slow.update(clock.now_ns(), skipped);
                                     }
                                   }));
    std::thread fast_thread([&] {
      grant = request_real_time(config.cpu);
      Deadlines deadlines(clock.now_ns(), config.fast.rate_hz);
      while (deadlines.next_ns() < stop_ns && !setup.stop.load() &&
             fast->tick(wait(deadlines, clock))) {
      }
      // Before anybody waits for the slow thread.
      static_cast<void>(setup.device.write(Eigen::Vector3d::Zero()));
    });
    fast_thread.join();
  }
  RenderReport report = finish(*fast, slow, setup);
  report.scheduling = grant.remark;
  return report;
}

}  // namespace palpate
