#include "runtime/render/render_loop.h"

#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/realtime/deadlines.h"
#include "runtime/realtime/real_time.h"

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
  explicit SlowProcess(RenderedBody& body) : body_(body) {}

  // Nothing more after a failure: the fast process goes on with what it has.
  void update(std::int64_t now_ns, std::int64_t skipped) noexcept {
    missed_deadlines += skipped;
    if (failure != nullptr) {
      return;
    }
    try {
      updates += body_.serve(now_ns).has_value() ? 1 : 0;
    } catch (...) {
      failure = std::current_exception();
    }
  }

  std::int64_t updates = 0;
  std::int64_t missed_deadlines = 0;
  std::exception_ptr failure;

 private:
  RenderedBody& body_;
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

TickOutputs outputs(const RenderSetup& setup) {
  return {
      .trace = setup.trace,
      .telemetry = setup.recorder == nullptr ? nullptr : &setup.recorder->telemetry(),
      .flight = setup.flight,
      .watch = setup.watch};
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

// One tool: what its two processes share, and its fast one.
class ToolRun {
 public:
  explicit ToolRun(const RenderedTool& tool)
      : tool_(tool),
        one_(tool.setup.several != nullptr
                 ? nullptr
                 : std::make_unique<OneContact>(
                       tool.config.fast.fast, *tool.setup.stream,
                       tool.setup.watch_needle, tool.setup.watch_friction)),
        body_(tool.setup.several != nullptr ? *tool.setup.several : *one_),
        fast_(tool.config.fast, devices(), body_, outputs(tool.setup)),
        slow_(body_),
        session_(tool.setup.device),
        deadlines_(0, tool.config.fast.rate_hz) {
    if (tool.setup.second != nullptr) {
      second_.emplace(*tool.setup.second);
    }
    body_.begin_with(tool.setup.surface);
  }

  void begin(std::int64_t start_ns) {
    deadlines_ = Deadlines(start_ns, tool_.config.fast.rate_hz);
    stop_ns_ = end_ns(start_ns, tool_.config.duration_s);
  }

  [[nodiscard]] Deadlines& deadlines() noexcept { return deadlines_; }
  [[nodiscard]] std::int64_t next_ns() const noexcept { return deadlines_.next_ns(); }

  [[nodiscard]] bool goes_on() const noexcept {
    return !over_ && deadlines_.next_ns() < stop_ns_ && !tool_.setup.stop.load() &&
           !abandoned_.load();
  }

  // Another tool's thread could not start: this one's ends at its next tick.
  void abandon() noexcept { abandoned_.store(true); }

  [[nodiscard]] bool is_over() const noexcept { return over_; }

  // Does not look at what the fast thread writes. @param skipped deadlines.
  void serve(std::int64_t now_ns, std::int64_t skipped) noexcept {
    slow_.update(now_ns, skipped);
  }

  void turn(std::int64_t skipped) noexcept { over_ = !fast_.tick(skipped); }

  void drain() {
    if (tool_.setup.recorder != nullptr && fast_.report().ticks % kDrainTicks == 0) {
      tool_.setup.recorder->drain();
    }
  }

  // The fast thread.
  void run(std::int64_t start_ns) {
    grant_ = request_real_time(tool_.config.cpu);
    MonotonicClock clock;
    begin(start_ns);
    deadlines_ = Deadlines(clock.now_ns(), tool_.config.fast.rate_hz);
    while (goes_on()) {
      turn(wait(deadlines_, clock));
    }
    // Before anybody waits for the slow thread.
    for (Device* device : devices()) {
      static_cast<void>(device->write(Eigen::Vector3d::Zero()));
    }
  }

  [[nodiscard]] RenderReport report() const {
    RenderReport report = fast_.report();
    const std::vector<SurfaceDent> dents = body_.dents();
    report.dents =
        std::count_if(dents.begin(), dents.end(), [](const SurfaceDent& dent) {
          return dent.carried_n > 0.0;
        });
    report.surface = body_.kept();
    report.slow_updates = slow_.updates;
    report.slow_missed_deadlines = slow_.missed_deadlines;
    report.slow_error = slow_.failure;
    report.slow_failure = message_of(slow_.failure);
    report.interrupted = tool_.setup.stop.load();
    report.scheduling = grant_.remark;
    return report;
  }

 private:
  // One for each hand.
  [[nodiscard]] std::span<Device* const> devices() const noexcept {
    return std::span(devices_).first(tool_.setup.second == nullptr ? 1 : 2);
  }

  const RenderedTool& tool_;
  std::array<Device*, kPortsMax> devices_{&tool_.setup.device, tool_.setup.second};
  std::unique_ptr<OneContact> one_;  // null: several contacts
  RenderedBody& body_;
  FastProcess fast_;
  SlowProcess slow_;
  DeviceSession session_;
  std::optional<DeviceSession> second_;
  Deadlines deadlines_;
  std::int64_t stop_ns_ = 0;
  bool over_ = false;
  std::atomic<bool> abandoned_ = false;
  RealTimeGrant grant_;
};

using ToolRuns = std::vector<std::unique_ptr<ToolRun>>;

ToolRuns make_runs(std::span<const RenderedTool> tools) {
  ToolRuns runs;
  for (const RenderedTool& tool : tools) {
    runs.push_back(std::make_unique<ToolRun>(tool));
  }
  return runs;
}

// Whose tick is next; null when all have ended.
ToolRun* earliest(const ToolRuns& runs) {
  ToolRun* next = nullptr;
  for (const auto& run : runs) {
    if (run->goes_on() && (next == nullptr || run->next_ns() < next->next_ns())) {
      next = run.get();
    }
  }
  return next;
}

// One slow turn, for the tools that go on.
void serve_tools(const ToolRuns& runs, std::int64_t now_ns, std::int64_t skipped) {
  for (const auto& run : runs) {
    if (!run->is_over()) {
      run->serve(now_ns, skipped);
    }
  }
}

void run_slow_process(const ToolRuns& runs, const std::atomic<bool>& done,
                      std::int64_t start_ns, double slow_hz) noexcept {
  request_slow_real_time();
  MonotonicClock clock;
  Deadlines deadlines(start_ns, slow_hz);
  while (!done.load()) {
    const std::int64_t skipped = wait(deadlines, clock);
    for (const auto& run : runs) {
      run->serve(clock.now_ns(), skipped);
    }
  }
}

std::vector<RenderReport> reports(const ToolRuns& runs) {
  std::vector<RenderReport> all;
  for (const auto& run : runs) {
    all.push_back(run->report());
  }
  return all;
}

void check_tools(std::span<const RenderedTool> tools) {
  if (tools.empty()) {
    throw InputError("a scene without a tool cannot be rendered");
  }
  const RenderConfig& first = tools.front().config;
  for (const RenderedTool& tool : tools) {
    check(tool.config);
    if (tool.setup.stream == nullptr && tool.setup.several == nullptr) {
      throw InputError("a tool needs elements, or contacts, to be rendered");
    }
    const std::size_t hands =
        tool.setup.several == nullptr ? 1 : tool.setup.several->hands();
    if (hands != (tool.setup.second == nullptr ? 1U : 2U)) {
      throw InputError(fmt::format("{} hands need a device each", hands));
    }
    if (tool.config.slow_hz != first.slow_hz ||
        tool.config.duration_s != first.duration_s) {
      throw InputError(fmt::format(
          "tools of one scene share the slow process and the end: {} Hz and {} s, "
          "beside {} Hz and {} s",
          tool.config.slow_hz, tool.config.duration_s, first.slow_hz,
          first.duration_s));
    }
  }
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
  const RenderedTool tool{config, setup};
  return render_in_turns(std::span(&tool, 1), clock).front();
}

RenderReport render_in_real_time(const RenderConfig& config, const RenderSetup& setup) {
  const RenderedTool tool{config, setup};
  return render_in_real_time(std::span(&tool, 1)).front();
}

std::vector<RenderReport> render_in_turns(std::span<const RenderedTool> tools,
                                          Clock& clock) {
  check_tools(tools);
  const ToolRuns runs = make_runs(tools);
  const std::int64_t start_ns = clock.now_ns();
  for (const auto& run : runs) {
    run->begin(start_ns);
  }
  Deadlines slow_deadlines(start_ns, tools.front().config.slow_hz);
  for (ToolRun* next = earliest(runs); next != nullptr;) {
    const std::int64_t due_ns = next->next_ns();
    next->turn(wait(next->deadlines(), clock));
    next->drain();
    next = earliest(runs);
    const bool all = next == nullptr || next->next_ns() > due_ns;
    if (all && clock.now_ns() >= slow_deadlines.next_ns()) {
      serve_tools(runs, clock.now_ns(), slow_deadlines.begin(clock.now_ns()));
    }
  }
  return reports(runs);
}

std::vector<RenderReport> render_in_real_time(std::span<const RenderedTool> tools) {
  check_tools(tools);
  const ToolRuns runs = make_runs(tools);
  for (const RenderedTool& tool : tools) {
    if (tool.setup.recorder != nullptr) {
      tool.setup.recorder->start();
    }
  }
  MonotonicClock clock;
  std::atomic<bool> done = false;
  const std::int64_t start_ns = clock.now_ns();
  const double slow_hz = tools.front().config.slow_hz;
  // The threads touch what is theirs, the exchanges and the flags; nothing else.
  {
    const JoinedThread slow_thread(done, std::thread([&] {
                                     run_slow_process(runs, done, start_ns, slow_hz);
                                   }));
    std::vector<std::jthread> fast_threads;
    try {
      for (const auto& run : runs) {
        fast_threads.emplace_back([&run, start_ns] {
          run->run(start_ns);
        });
      }
    } catch (const std::system_error& error) {
      for (const auto& run : runs) {
        run->abandon();
      }
      throw DeviceError(fmt::format("a tool's thread cannot start: {}", error.what()));
    }
  }
  return reports(runs);
}

}  // namespace palpate
