#include "precompute/build/checkpoint.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/sha256.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigestLength = 64;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

bool is_unit(const fs::directory_entry& entry) {
  return entry.path().filename().string().starts_with("unit-");
}

void write(const fs::path& file, std::span<const std::byte> bytes) {
  AtomicFile place(file);
  place.write(bytes);
  place.commit();
}

}  // namespace

Checkpoint::Checkpoint(const fs::path& output, const JobDescription& plan, bool resume,
                       FolderUse use)
    : folder_(output.string() + ".partial"), digest_(plan.digest) {
  make_folder();
  lock_.emplace(folder_, use);
  if (is_there() && holds_units()) {
    if (!resume) {
      throw InputError(
          fmt::format("{} holds units of an unfinished build: --resume goes on with "
                      "them; remove the folder to start again",
                      folder_.string()));
    }
    if (read_file(digest_file()) != plan.digest) {
      throw InputError(
          fmt::format("{} belongs to another scene, body or program; remove "
                      "the folder to start again",
                      folder_.string()));
    }
    return;
  }
  make();
}

void Checkpoint::make() const {
  make_folder();
  if (!is_there()) {  // what is in it somebody did not remove whole: nobody knows whose
    remove_units();
  }
  write(digest_file(), bytes_of(digest_));
}

void Checkpoint::make_folder() const {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) {
    cannot_be(folder_, "made", error.value());
  }
}

void Checkpoint::remove_units() const {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored)) {
    if (is_unit(entry)) {
      fs::remove(entry, ignored);
    }
  }
}

// Another build may have made it anew since it was taken away.
Checkpoint::~Checkpoint() {
  if (lock_->is_still_there() && !holds_units()) {
    remove();
  }
}

bool Checkpoint::holds_units() const {
  std::error_code ignored;
  const fs::directory_iterator entries(folder_, ignored);
  return std::any_of(begin(entries), end(entries), is_unit);
}

fs::path Checkpoint::digest_file() const {
  return folder_ / "digest";
}

bool Checkpoint::is_there() const {
  return fs::exists(digest_file());
}

fs::path Checkpoint::file_of(std::int64_t unit) const {
  return folder_ / fmt::format("unit-{:06}", unit);
}

std::optional<WorkUnitOutcome> Checkpoint::load(std::int64_t unit) const {
  const fs::path file = file_of(unit);
  std::string content;
  try {
    content = read_file(file);
  } catch (const InputError&) {
    return std::nullopt;
  }
  const auto bytes = bytes_of(content);
  const auto body = bytes.subspan(std::min(bytes.size(), kDigestLength));
  Sha256 sum;
  sum.update(body);
  if (bytes.size() < kDigestLength || !content.starts_with(sum.hex())) {
    return std::nullopt;
  }
  try {
    WorkUnitOutcome outcome = unit_from_bytes(body, file.string());
    if (outcome.index == unit && is_sound(outcome)) {
      return outcome;
    }
  } catch (const FormatError&) {
    // Of another layout: as good as missing.
  }
  return std::nullopt;
}

void Checkpoint::keep(const WorkUnitOutcome& unit) const {
  const std::vector<std::byte> body = to_bytes(unit);
  Sha256 sum;
  sum.update(body);
  const std::string digest = sum.hex();
  std::vector<std::byte> bytes(bytes_of(digest).begin(), bytes_of(digest).end());
  bytes.insert(bytes.end(), body.begin(), body.end());
  write(file_of(unit.index), bytes);
}

void Checkpoint::remove() const {
  std::error_code ignored;
  fs::remove(digest_file(), ignored);
  fs::remove_all(folder_, ignored);
}

}  // namespace palpate
