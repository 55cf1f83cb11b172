#include "formats/database/chunk_digest.h"

#include <string>

#include "formats/database/puncture_layout.h"
#include "formats/response/contact_table.h"

namespace palpate {
namespace {

std::vector<std::uint8_t> bytes_of(const Sha256& digest) {
  const std::string hex = digest.hex();
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    bytes.push_back(
        static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> chunk_digest(const BodyChunk& chunk) {
  Sha256 digest;
  add_values(digest, chunk.position_m);
  add_values(digest, chunk.normal);
  add_values(digest, chunk.source_node);
  add_values(digest, chunk.triangle);
  add_values(digest, chunk.source_triangle);
  return bytes_of(digest);
}

std::vector<std::uint8_t> chunk_digest(const ResponseTable& chunk) {
  Sha256 digest;
  add_values(digest, chunk.direction);
  add_values(digest, chunk.direction_spread_rad);
  add_values(digest, chunk.touch_offset_m);
  add_values(digest, chunk.error_relative);
  add_values(digest, chunk.friction);
  add_values(digest, chunk.presliding_m);
  add_values(digest, chunk.stiffness_max_n_per_m);
  add_values(digest, chunk.origin);
  add_values(digest, chunk.flags);
  add_values(digest, chunk.sample_begin);
  add_values(digest, chunk.depth_m);
  add_values(digest, chunk.force_n);
  add_values(digest, chunk.stiffness_n_per_m);
  add_values(digest, chunk.energy_j);
  return bytes_of(digest);
}

std::vector<std::uint8_t> memory_digest(const Viscoelasticity& chunk) {
  Sha256 digest;
  add_values(digest, chunk.g);
  add_values(digest, chunk.sites.site);
  add_values(digest, chunk.sites.weight);
  for_each_dataset(chunk.yielding, [&](const auto& /*name*/, const auto& /*units*/,
                                       const auto& values) {
    add_values(digest, values);
  });
  return bytes_of(digest);
}

std::vector<std::uint8_t> tilt_digest(const ResponseTable& chunk) {
  Sha256 digest;
  add_values(digest, chunk.tilt);
  add_values(digest, chunk.tilt_by_depth_per_m);
  return bytes_of(digest);
}

std::vector<std::uint8_t> compliance_digest(const ComplianceTable& chunk) {
  Sha256 digest;
  add_values(digest, chunk.value);
  add_values(digest, chunk.mode);
  return bytes_of(digest);
}

std::vector<std::uint8_t> contact_digest(const ContactTable& chunk) {
  Sha256 digest;
  for_each_contact_dataset(
      chunk, [&](const char* /*name*/, const char* /*units*/, Eigen::Index /*columns*/,
                 const RowsOf<float>& rows) {
        add_values(digest, rows);
      });
  return bytes_of(digest);
}

std::vector<std::uint8_t> puncture_digest(const Puncture& puncture) {
  Sha256 digest;
  const auto add_text = [&digest](const std::string& text) {
    digest.update(std::as_bytes(std::span(text)));
  };
  add_text(puncture.rule + "\n");
  for (const std::string& name : puncture.material) {
    add_text(name + "\n");
  }
  std::vector<double> numbers = numbers_of(puncture);
  while (!numbers.empty() && numbers.back() == 0.0) {  // as in files that lack it
    numbers.pop_back();
  }
  add_values(digest, numbers);
  content::for_each_puncture_dataset(
      puncture, [&](const auto& /*name*/, const auto& /*units*/, const auto& values) {
        add_values(digest, values);
      });
  add_values(digest, puncture.membrane_j);
  return bytes_of(digest);
}

}  // namespace palpate
