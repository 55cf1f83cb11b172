#include "precompute/serve/unit_claims.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <sstream>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

std::string name_of_this_machine() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return host.data();
}

// Within which numbers of processes mean something; 0: not known.
std::uintmax_t process_numbers() {
  struct stat space {};
  return ::stat("/proc/self/ns/pid", &space) == 0 ? space.st_ino : 0;
}

std::string name_of_this_claimant() {
  static std::atomic<int> instance = 0;
  return fmt::format("{} {} {} {}\n", name_of_this_machine(), getpid(), instance++,
                     process_numbers());
}

// Whether a claimant of this machine has ended, however it did.
bool is_gone(const std::string& claimant) {
  std::istringstream words(claimant);
  std::string machine;
  pid_t process = 0;
  int instance = 0;
  std::uintmax_t numbers = 0;
  return words >> machine >> process >> instance >> numbers && process > 0 &&
         numbers != 0 && numbers == process_numbers() &&
         machine == name_of_this_machine() && ::kill(process, 0) != 0 && errno == ESRCH;
}

// False if the file is there already.
bool write_new(const fs::path& file, const std::string& text) {
  const int descriptor = ::open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC,
                                S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH);
  if (descriptor < 0) {
    return false;
  }
  const bool written =
      ::write(descriptor, text.data(), text.size()) == std::ssize(text);
  ::close(descriptor);
  return written;
}

std::string content_of(const fs::path& file) {
  try {
    return read_file(file);
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

UnitClaims::UnitClaims(fs::path folder, std::chrono::milliseconds stale)
    : folder_(std::move(folder)),
      stale_(stale),
      me_(name_of_this_claimant()),
      touching_([this](const std::stop_token& end) {
        touch_until_the_end(end);
      }) {}

UnitClaims::~UnitClaims() {
  touching_.request_stop();
  touching_.join();
  for (const auto& [unit, file] : mine_) {
    std::error_code ignored;
    fs::remove(file, ignored);
  }
}

fs::path UnitClaims::file_of(std::int64_t unit) const {
  return folder_ / fmt::format("claim-{:06}", unit);
}

// A name in the folder that nobody else uses.
fs::path UnitClaims::unique(const std::string& what) const {
  std::string name = what + " " + me_;
  std::replace(name.begin(), name.end(), ' ', '-');
  name.pop_back();  // the line's end
  return folder_ / name;
}

// Of other machines by the clock of the file system, which they share.
bool UnitClaims::is_stale(const fs::path& file) const {
  if (is_gone(content_of(file))) {
    return true;
  }
  std::error_code gone;
  const auto touched = fs::last_write_time(file, gone);
  if (gone) {
    return true;
  }
  const fs::path now = unique("now");
  std::error_code failed;
  fs::remove(now, failed);
  if (!write_new(now, me_)) {
    return false;
  }
  const auto time = fs::last_write_time(now, failed);
  fs::remove(now, gone);
  return !failed && time - touched > stale_;
}

bool UnitClaims::claim(std::int64_t unit) {
  const std::lock_guard lock(mutex_);
  // On a file system that machines share every look is several messages.
  const auto now = std::chrono::steady_clock::now();
  const auto other = others_.find(unit);
  if (other != others_.end() && now - other->second < stale_ / 60) {
    return false;
  }
  const fs::path file = file_of(unit);
  if (!write_new(file, me_)) {
    if (mine_.contains(unit) || !is_stale(file)) {
      if (!mine_.contains(unit)) {
        others_[unit] = now;
      }
      return mine_.contains(unit);
    }
    // Two that find it stale at once both write; the one that reads its own name has
    // it.
    const fs::path taken = unique("taken");
    std::error_code failed;
    fs::remove(taken, failed);
    if (!write_new(taken, me_)) {
      return false;
    }
    fs::rename(taken, file, failed);
    if (failed || content_of(file) != me_) {
      return false;
    }
  }
  mine_[unit] = file;
  others_.erase(unit);
  return true;
}

void UnitClaims::give_back(std::int64_t unit) {
  const std::lock_guard lock(mutex_);
  if (const auto mine = mine_.find(unit); mine != mine_.end()) {
    std::error_code ignored;
    fs::remove(mine->second, ignored);
    mine_.erase(mine);
  }
}

void UnitClaims::touch_until_the_end(const std::stop_token& end) const {
  std::unique_lock lock(mutex_);
  while (!end.stop_requested()) {
    for (const auto& [unit, file] : mine_) {
      utimensat(AT_FDCWD, file.c_str(), nullptr, 0);
    }
    ending_.wait_for(lock, end, stale_ / 4, [] {
      return false;
    });
  }
}

}  // namespace palpate
