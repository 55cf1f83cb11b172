#include "formats/database/work_unit.h"

#include <algorithm>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/sha256.h"
#include "formats/database/work_unit_cbor.h"
#include "formats/response/response_rules.h"

namespace palpate {
namespace {

constexpr std::string_view kShardMagic = "palpate-shard-2\n";
constexpr std::size_t kDigestLength = 64;

std::vector<std::byte> to_cbor(const nlohmann::json& json) {
  const std::vector<std::uint8_t> bytes = nlohmann::json::to_cbor(json);
  std::vector<std::byte> result(bytes.size());
  std::transform(bytes.begin(), bytes.end(), result.begin(), [](std::uint8_t b) {
    return std::byte{b};
  });
  return result;
}

template <typename T>
T from_cbor(std::span<const std::byte> bytes, const std::string& source) {
  try {
    const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
    return nlohmann::json::from_cbor(first, first + bytes.size()).get<T>();
  } catch (const nlohmann::json::exception& error) {
    throw FormatError(fmt::format("{} is damaged: {}", source, error.what()));
  }
}

std::string digest_of(std::span<const std::byte> bytes) {
  Sha256 sum;
  sum.update(bytes);
  return sum.hex();
}

void append(std::vector<std::byte>& bytes, std::string_view text) {
  const auto more = std::as_bytes(std::span(text));
  bytes.insert(bytes.end(), more.begin(), more.end());
}

bool begins_as_shard(std::span<const std::byte> bytes) {
  return bytes.size() >= kShardMagic.size() &&
         std::equal(kShardMagic.begin(), kShardMagic.end(), bytes.begin(),
                    [](char c, std::byte b) {
                      return static_cast<std::byte>(c) == b;
                    });
}

}  // namespace

void fail_if_broken(WorkUnitNode& node) {
  const std::string broken = broken_rule(node.response);
  if (!broken.empty()) {
    node.failure = fmt::format("its response was dropped: {}", broken);
    node.response = {};
  }
  if (!node.failure.empty() && node.response.origin == ResponseOrigin::kNone) {
    node.response.flags = kFailed;
  }
}

bool is_sound(const WorkUnitOutcome& unit) {
  return std::all_of(unit.node.begin(), unit.node.end(), [](const WorkUnitNode& node) {
    return broken_rule(node.response).empty();
  });
}

std::vector<std::byte> to_bytes(const WorkUnitOutcome& unit) {
  return to_cbor(unit);
}

std::vector<std::byte> to_bytes(const JobDescription& plan) {
  return to_cbor(plan);
}

WorkUnitOutcome unit_from_bytes(std::span<const std::byte> bytes,
                                const std::string& source) {
  return from_cbor<WorkUnitOutcome>(bytes, source);
}

JobDescription plan_from_bytes(std::span<const std::byte> bytes,
                               const std::string& source) {
  return from_cbor<JobDescription>(bytes, source);
}

void write_shard(const std::filesystem::path& file, const Shard& shard) {
  const auto body = to_cbor({{"plan", shard.plan}, {"unit", shard.unit}});
  std::vector<std::byte> bytes;
  append(bytes, kShardMagic);
  append(bytes, digest_of(body));
  bytes.insert(bytes.end(), body.begin(), body.end());
  AtomicFile place(file);
  place.write(bytes);
  place.commit();
}

Shard read_shard(const std::filesystem::path& file) {
  const std::string content = read_file(file);
  const auto bytes = std::as_bytes(std::span(content));
  if (!begins_as_shard(bytes)) {
    throw FormatError(fmt::format("{} is no palpate shard", file.string()));
  }
  const auto rest = bytes.subspan(kShardMagic.size());
  const auto body = rest.subspan(std::min(rest.size(), kDigestLength));
  const std::string digest = digest_of(body);
  const auto stored = rest.first(std::min(rest.size(), kDigestLength));
  const auto expected = std::as_bytes(std::span(digest));
  if (!std::equal(stored.begin(), stored.end(), expected.begin(), expected.end())) {
    throw FormatError(
        fmt::format("{} is damaged: its bytes do not have the SHA-256 that it carries",
                    file.string()));
  }
  const auto json = from_cbor<nlohmann::json>(body, file.string());
  try {
    return {json.at("plan").get<JobDescription>(),
            json.at("unit").get<std::vector<WorkUnitOutcome>>()};
  } catch (const nlohmann::json::exception& error) {
    throw FormatError(fmt::format("{} is damaged: {}", file.string(), error.what()));
  }
}

bool is_shard(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string head(kShardMagic.size(), '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  return in && head == kShardMagic;
}

}  // namespace palpate
