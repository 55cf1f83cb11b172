#include "formats/service/service_socket.h"

#include <atomic>
#include <barrier>
#include <optional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "formats/base/error.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kSoon{2000};

class ServiceSocket : public testing::Test {
 protected:
  ScratchFolder folder_;
  std::filesystem::path socket_ = folder_ / "organ.h5.socket";
};

TEST_F(ServiceSocket, CarriesMessagesBothWays) {
  ServiceListener listener(socket_);
  auto client = ServiceConnection::join(socket_);
  ASSERT_TRUE(client);
  auto server = listener.accept(kSoon);
  ASSERT_TRUE(server);
  EXPECT_TRUE(client->send(HandPlace{.tool = 3}, kSoon));
  EXPECT_TRUE(server->send(ServedEnd{.file = "f"}, kSoon));
  EXPECT_EQ(std::get<HandPlace>(server->receive(kSoon).value()).tool, 3);
  EXPECT_EQ(std::get<ServedEnd>(client->receive(kSoon).value()).file, "f");
}

TEST_F(ServiceSocket, LargeFramesPass) {
  ServiceListener listener(socket_);
  auto client = ServiceConnection::join(socket_);
  auto server = listener.accept(kSoon);
  const ServedEnd large{.file = std::string(20'000'000, 'x')};
  std::thread sender([&] {
    EXPECT_TRUE(server->send(large, milliseconds(20000)));
  });
  const auto got = client->receive(milliseconds(20000));
  sender.join();
  EXPECT_EQ(std::get<ServedEnd>(got.value()).file.size(), large.file.size());
}

TEST_F(ServiceSocket, TellsSilenceFromAnEnd) {
  ServiceListener listener(socket_);
  auto client = ServiceConnection::join(socket_);
  {
    auto server = listener.accept(kSoon);
    EXPECT_FALSE(client->receive(milliseconds(10)));
    EXPECT_TRUE(client->is_open());
  }
  EXPECT_FALSE(client->receive(kSoon));
  EXPECT_FALSE(client->is_open());
  EXPECT_FALSE(client->send(HandPlace{}, kSoon));
}

TEST_F(ServiceSocket, GivesUpOnWhoDoesNotListen) {
  ServiceListener listener(socket_);
  auto client = ServiceConnection::join(socket_);
  auto server = listener.accept(kSoon);
  const ServedEnd large{.file = std::string(20'000'000, 'x')};
  EXPECT_FALSE(server->send(large, milliseconds(50)));
  EXPECT_FALSE(server->is_open());
}

TEST_F(ServiceSocket, IsItsOwnersAlone) {
  const ServiceListener listener(socket_);
  struct stat status {};
  ASSERT_EQ(stat(socket_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & (S_IRWXG | S_IRWXO), 0U);
}

TEST_F(ServiceSocket, ListensOnceAndReplacesWhatAKillLeft) {
  {
    const ServiceListener listener(socket_);
    EXPECT_THROW(const ServiceListener second(socket_), InputError);
  }
  EXPECT_FALSE(std::filesystem::exists(socket_));
  EXPECT_FALSE(ServiceConnection::join(socket_));
  const auto left = folder_ / "left";
  {
    const ServiceListener listener(left);
    std::filesystem::create_hard_link(left, socket_);
  }
  EXPECT_TRUE(std::filesystem::is_socket(socket_));
  const ServiceListener replaced(socket_);
  EXPECT_TRUE(ServiceConnection::join(socket_));
}

TEST_F(ServiceSocket, SaysWhereItCannotBe) {
  const auto refusal = [](const std::filesystem::path& socket) {
    try {
      const ServiceListener listener(socket);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refusal(folder_ / "none" / "s").find("cannot be made"), std::string::npos);
  EXPECT_NE(refusal(std::string(200, 'x')).find("shorter --socket"), std::string::npos);
}

// Services that begin at once: one has the socket, and its socket is there.
TEST_F(ServiceSocket, OneOfManyThatBeginAtOnceListens) {
  for (int round = 0; round < 4; ++round) {
    constexpr int kServices = 6;
    std::barrier all(kServices);
    std::atomic<int> listening = 0;
    std::atomic<int> joined = 0;
    std::vector<std::thread> services;
    for (int i = 0; i < kServices; ++i) {
      services.emplace_back([&] {
        std::optional<ServiceListener> listener;
        all.arrive_and_wait();
        try {
          listener.emplace(socket_);
          ++listening;
        } catch (const InputError&) {
          // Another has it.
        }
        all.arrive_and_wait();
        if (listener) {
          while (listener->accept(milliseconds(0))) {  // those who looked
          }
          joined += ServiceConnection::join(socket_) ? 1 : 0;
        }
        all.arrive_and_wait();
      });
    }
    for (std::thread& service : services) {
      service.join();
    }
    ASSERT_EQ(listening, 1) << round;
    ASSERT_EQ(joined, 1) << round;
  }
}

}  // namespace
}  // namespace palpate
