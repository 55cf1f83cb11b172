#include "runtime/render_loop.h"

#include <cmath>
#include <memory>
#include <thread>

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

  void update(std::int64_t now_ns, std::int64_t skipped) {
    missed_deadlines += skipped;
    if (exchange_.tool.fetch()) {
      stream_.update(exchange_.tool.latest(), now_ns, exchange_.elements);
      ++updates;
    }
  }

  std::int64_t updates = 0;
  std::int64_t missed_deadlines = 0;

 private:
  ElementSender& stream_;
  RenderExchange& exchange_;
};

std::int64_t end_ns(std::int64_t start_ns, double duration_s) {
  return start_ns + std::llround(duration_s * kNanosecondsPerSecond);
}

RenderReport finish(const FastProcess& fast, const SlowProcess& slow,
                    const RenderSetup& setup) {
  RenderReport report = fast.report();
  report.slow_updates = slow.updates;
  report.slow_missed_deadlines = slow.missed_deadlines;
  report.interrupted = setup.stop.load();
  return report;
}

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
  const auto fast =
      std::make_unique<FastProcess>(config.fast, setup.device, *exchange, setup.trace);
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
  }
  return finish(*fast, slow, setup);
}

RenderReport render_in_real_time(const RenderConfig& config, const RenderSetup& setup) {
  check(config);
  const auto exchange = std::make_unique<RenderExchange>();
  const auto fast =
      std::make_unique<FastProcess>(config.fast, setup.device, *exchange, setup.trace);
  SlowProcess slow(setup.stream, *exchange);
  const DeviceSession session(setup.device);
  MonotonicClock clock;
  RealTimeGrant grant;
  std::atomic<bool> done = false;
  const std::int64_t start_ns = clock.now_ns();
  const std::int64_t stop_ns = end_ns(start_ns, config.duration_s);

  // The threads touch what is theirs, the exchange and the flags; nothing else.
  std::thread fast_thread([&] {
    grant = request_real_time();
    Deadlines deadlines(clock.now_ns(), config.fast.rate_hz);
    while (deadlines.next_ns() < stop_ns && !setup.stop.load() &&
           fast->tick(wait(deadlines, clock))) {
    }
    done.store(true);
  });
  std::thread slow_thread([&] {
    Deadlines deadlines(start_ns, config.slow_hz);
    while (!done.load()) {
      const std::int64_t skipped = wait(deadlines, clock);
      slow.update(clock.now_ns(), skipped);
    }
  });
  fast_thread.join();
  slow_thread.join();
  RenderReport report = finish(*fast, slow, setup);
  report.scheduling = grant.remark;
  return report;
}

}  // namespace palpate
