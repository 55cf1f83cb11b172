#include "tests/peers/step_times.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <vector>

#include "tests/support/allocation_guard.h"

namespace palpate::peers {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kRepeats = 5;

double us_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  const auto at =
      values.begin() +
      static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double empty_reading_us() {
  std::vector<double> all;
  for (int i = 0; i < 10000; ++i) {
    all.push_back(us_since(Clock::now()));
  }
  return quantile(all, 0.5);
}

struct Times {
  std::vector<double> step_us;
  std::vector<double> slow_us;
};

void replay(OpenTool& tool, const Hand& hand, Times& times) {
  for (const Eigen::Vector3d& centre : hand.centre_m) {
    const auto begin = Clock::now();
    tool.pose(centre);
    (void)tool.force();
    times.step_us.push_back(us_since(begin));
    if (tool.slow_is_due()) {
      const auto slow = Clock::now();
      tool.slow();
      times.slow_us.push_back(us_since(slow));
    }
  }
}

double allocations_per_tick(OpenTool& tool, const Hand& hand) {
  std::uint64_t count = 0;
  for (const Eigen::Vector3d& centre : hand.centre_m) {
    {
      const test::AllocationGuard guard;
      tool.pose(centre);
      (void)tool.force();
      count += guard.count();
    }
    if (tool.slow_is_due()) {
      tool.slow();
    }
  }
  return static_cast<double>(count) / static_cast<double>(hand.centre_m.size());
}

}  // namespace

StepTimes step_times(const Renderer& renderer, const std::string& variant,
                     const PeerScene& scene, const std::filesystem::path& own,
                     std::span<const Hand* const> hands) {
  const double empty_us = empty_reading_us();
  const auto least = [](double& kept, double value) {
    kept = std::min(kept, std::max(0.0, value));
  };
  constexpr double kFirst = std::numeric_limits<double>::infinity();
  StepTimes result{kFirst, kFirst, kFirst, 0.0};
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    Times times;
    for (const Hand* hand : hands) {
      OpenTool tool(renderer, variant, scene.folder, own, kHandTickS);
      replay(tool, *hand, times);
    }
    least(result.median_us, quantile(times.step_us, 0.5) - empty_us);
    least(result.p999_us, quantile(times.step_us, 0.999) - empty_us);
    least(result.slow_median_us, quantile(times.slow_us, 0.5) - empty_us);
  }
  for (const Hand* hand : hands) {
    OpenTool tool(renderer, variant, scene.folder, own, kHandTickS);
    result.allocations +=
        allocations_per_tick(tool, *hand) / static_cast<double>(hands.size());
  }
  return result;
}

}  // namespace palpate::peers
