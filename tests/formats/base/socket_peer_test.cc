#include "formats/base/socket_peer.h"

#include <array>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

namespace palpate {
namespace {

TEST(SocketPeer, OneOfThisUserIsNoStranger) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
  EXPECT_FALSE(stranger_at(ends[0]));
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(SocketPeer, AnotherUserIsNamed) {
  if (::geteuid() != 0) {
    GTEST_SKIP() << "only root can be another user";
  }
  constexpr uid_t kOther = 4321;
  std::array<int, 2> ends{};
  ASSERT_EQ(::seteuid(kOther), 0);
  const int made = ::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data());
  const auto by_itself = stranger_at(ends[0]);
  ASSERT_EQ(::seteuid(0), 0);
  ASSERT_EQ(made, 0);
  EXPECT_FALSE(by_itself);
  ASSERT_TRUE(stranger_at(ends[0]));
  EXPECT_EQ(*stranger_at(ends[0]), kOther);
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(SocketPeer, WhereNobodySaysItIsAStranger) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  EXPECT_TRUE(stranger_at(ends[0]));
  ::close(ends[0]);
  ::close(ends[1]);
}

}  // namespace
}  // namespace palpate
