// A plate that a stand-in of a service tells of: for tests of who joins it.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <thread>

#include <gtest/gtest.h>

#include "runtime/served/served_client.h"
#include "tests/support/fake_service.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {

inline const std::atomic<bool> kNever = false;

class ServedPlate : public testing::Test {
 protected:
  using milliseconds = std::chrono::milliseconds;
  using GoesOn = std::function<bool()>;

  [[nodiscard]] ServiceState state(const ServedClient& client) const {
    return client.status().state;
  }

  [[nodiscard]] ServedClientOptions options() const {
    return {.socket = socket_, .silent = milliseconds(300), .again = milliseconds(60)};
  }

  // Scene, preliminary answers; then it listens.
  FakeService::Script plain(FakeService*& service) {
    return [&](ServiceConnection& to, const GoesOn& goes_on) {
      (void)to.send(served_scene(database_), milliseconds(1000));
      (void)to.send(served_responses(database_, AnswerQuality::kPreliminary),
                    milliseconds(1000));
      while (service == nullptr) {
        std::this_thread::sleep_for(milliseconds(1));
      }
      service->listen(to, std::chrono::hours(1), goes_on);
    };
  }

  const ResponseDatabase database_ = sample_database(
      plate(0.1, 6), ball(0.005, 0.3, 5e-4),
      [](Eigen::Index, double d) {
        return 200.0 * d;
      },
      0.01);
  const ScratchFolder folder_;
  const std::filesystem::path socket_ = folder_ / "s.socket";
};

}  // namespace palpate
