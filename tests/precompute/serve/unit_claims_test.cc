#include "precompute/serve/unit_claims.h"

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <optional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/comes_true.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;

class UnitClaimsTest : public testing::Test {
 protected:
  bool is_claimed(int unit) const {
    return std::filesystem::exists(folder_ / ("claim-00000" + std::to_string(unit)));
  }

  ScratchFolder folder_;
};

TEST_F(UnitClaimsTest, OneOfTwoHasAUnit) {
  UnitClaims a(folder_.path());
  UnitClaims b(folder_.path());
  EXPECT_TRUE(a.claim(1));
  EXPECT_TRUE(a.claim(1));
  EXPECT_FALSE(b.claim(1));
  EXPECT_TRUE(b.claim(2));
  a.give_back(1);
  EXPECT_TRUE(comes_true(
      [&] {
        return b.claim(1);
      },
      std::chrono::seconds(10)));
}

// Idle workers ask again and again for what others work on.
TEST_F(UnitClaimsTest, LooksSeldomAtWhatOthersWorkOn) {
  UnitClaims a(folder_.path(), milliseconds(600'000));
  UnitClaims b(folder_.path(), milliseconds(600'000));
  EXPECT_TRUE(a.claim(1));
  EXPECT_FALSE(b.claim(1));
  std::filesystem::remove(folder_ / "claim-000001");
  EXPECT_FALSE(b.claim(1)) << "it looked again at once";
}

TEST_F(UnitClaimsTest, ManyAtOnceShareThemOut) {
  constexpr int kClaimants = 4;
  constexpr int kUnits = 9;
  std::array<std::optional<UnitClaims>, kClaimants> claims;
  std::array<std::atomic<int>, kUnits> owners{};
  std::vector<std::thread> threads;
  for (auto& mine : claims) {
    mine.emplace(folder_.path());
    threads.emplace_back([&] {
      for (int unit = 0; unit < kUnits; ++unit) {
        owners[static_cast<std::size_t>(unit)] += mine->claim(unit) ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (int unit = 0; unit < kUnits; ++unit) {
    EXPECT_EQ(owners[static_cast<std::size_t>(unit)], 1) << unit;
  }
}

TEST_F(UnitClaimsTest, AClaimThatNobodyTouchesIsAnybodys) {
  std::ofstream(folder_ / "claim-000001") << "of one that was killed";
  UnitClaims patient(folder_.path(), milliseconds(60000));
  UnitClaims next(folder_.path(), milliseconds(200));
  EXPECT_FALSE(next.claim(1));
  std::this_thread::sleep_for(milliseconds(400));
  EXPECT_FALSE(patient.claim(1));
  EXPECT_TRUE(next.claim(1));
}

TEST_F(UnitClaimsTest, AnOwnerKeepsItsClaimAlive) {
  UnitClaims owner(folder_.path(), milliseconds(200));
  UnitClaims other(folder_.path(), milliseconds(2000));
  EXPECT_TRUE(owner.claim(1));
  std::this_thread::sleep_for(milliseconds(2500));
  EXPECT_FALSE(other.claim(1));
}

// A service that was killed does not keep its next one waiting.
TEST_F(UnitClaimsTest, AKilledProcessHasNoneOfThisMachine) {
  const milliseconds never(600'000);
  std::array<int, 2> said{};
  ASSERT_EQ(pipe(said.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    UnitClaims claims(folder_.path(), never);
    const char has = claims.claim(1) ? 'y' : 'n';
    (void)!write(said[1], &has, 1);
    for (;;) {
      pause();
    }
  }
  char has = 0;
  ASSERT_EQ(read(said[0], &has, 1), 1);
  EXPECT_EQ(has, 'y');
  EXPECT_FALSE(UnitClaims(folder_.path(), never).claim(1));
  kill(child, SIGKILL);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  EXPECT_TRUE(UnitClaims(folder_.path(), never).claim(1));
  close(said[0]);
  close(said[1]);
}

TEST_F(UnitClaimsTest, OfAnotherMachineOrNumberingIsKept) {
  for (const char* claimant : {"elsewhere 999999999 0 4026531836\n",
                               "elsewhere 999999999 0\n", "\n", "1 2\n"}) {
    std::ofstream(folder_ / "claim-000001") << claimant;
    EXPECT_FALSE(UnitClaims(folder_.path(), milliseconds(600'000)).claim(1))
        << claimant;
  }
}

TEST_F(UnitClaimsTest, AreGivenBackInTheEnd) {
  {
    UnitClaims claims(folder_.path());
    EXPECT_TRUE(claims.claim(3));
    EXPECT_TRUE(is_claimed(3));
  }
  EXPECT_FALSE(is_claimed(3));
}

}  // namespace
}  // namespace palpate
