// Which service a client joins, and which scene it takes.
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/served/served_client.h"
#include "runtime/served/service_process.h"
#include "tests/support/comes_true.h"
#include "tests/support/served_plate.h"

namespace palpate {
namespace {

class WhichService : public ServedPlate {};

TEST_F(WhichService, ASceneThatItsFileDoesNotHaveIsRefused) {
  FakeService* at = nullptr;
  FakeService service(socket_, plain(at));
  at = &service;
  ServedClientOptions wanted = options();
  wanted.text = "a scene";
  (void)ServedClient(wanted).scene(kNever);
  wanted.text = "the same with another material";
  ServedClient client(wanted);
  try {
    (void)client.scene(kNever);
    FAIL() << "another scene is rendered";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("computes another scene"),
              std::string::npos)
        << error.what();
  }
  EXPECT_TRUE(comes_true(
      [&] {
        return state(client) == ServiceState::kOther;
      },
      milliseconds(2000)));
}

// Of a command that was killed: its service ends, too.
TEST_F(WhichService, WhereAServiceOfSomebodyElseGoesItsOwnIsStarted) {
  FakeService* at = nullptr;
  FakeService service(socket_, plain(at));
  at = &service;
  std::atomic<int> started = 0;
  ServedClientOptions own = options();
  own.start = [&](bool /*anew*/) {
    ++started;
    return std::make_unique<ServiceProcess>(
        ServiceCommand{.program = "/bin/sleep", .scene = "", .output = ""});
  };
  ServedClient client(own);
  (void)client.scene(kNever);
  EXPECT_EQ(started, 0);
  service.die();
  EXPECT_TRUE(comes_true(
      [&] {
        return started == 1;
      },
      milliseconds(2000)));
}

TEST_F(WhichService, AnotherSceneIsTakenOnlyWhenItWasAskedFor) {
  std::atomic<int> digest = 1;
  FakeService service(socket_, [&](ServiceConnection& to, const GoesOn& goes_on) {
    const int mine = digest;
    (void)to.send(served_scene(database_, std::to_string(mine)), milliseconds(1000));
    (void)to.send(served_responses(database_, AnswerQuality::kFinal, mine),
                  milliseconds(1000));
    while (goes_on() && digest == mine) {
      std::this_thread::sleep_for(milliseconds(5));
    }
  });
  ServedClient client(options());
  (void)client.scene(kNever);
  EXPECT_EQ(client.scene_text(), "1");
  ASSERT_TRUE(comes_true(
      [&] {
        return client.answers().all().size() == 49;
      },
      milliseconds(2000)));
  digest = 2;
  ASSERT_TRUE(comes_true(
      [&] {
        return state(client) == ServiceState::kOther;
      },
      milliseconds(3000)));
  EXPECT_EQ(client.answers().at(0)->node->response.force_n.back(), 2.0);
  client.start_anew();
  ASSERT_TRUE(comes_true(
      [&] {
        return client.status().detail == "no service can be started from here";
      },
      milliseconds(2000)));
}

}  // namespace
}  // namespace palpate
