// The datasets of a database's index in their order, once for writing, comparing,
// reading and digesting; only for the sources behind database_index.h.
//
// `Access` has group(path), values(path, units, values) and optional(path, wanted).
#pragma once

#include <string>

#include "formats/database/database_index.h"
#include "formats/stored/stored_reader.h"

namespace palpate::content {

template <typename Access, typename Index>
void exchange_index(Access& access, Index& index) {
  access.group("/index");
  access.values("/index/node_begin", "1", index.node_begin);
  access.values("/index/triangle_begin", "1", index.triangle_begin);
  access.values("/index/box_min_m", "m", index.box_min_m);
  access.values("/index/box_max_m", "m", index.box_max_m);
  access.values("/index/sha256", "1", index.sha256);
  for (auto& tool : index.tools) {
    const std::string group = "/tools/" + tool.tool.name + "/index";
    access.group(group);
    access.values(group + "/sample_begin", "1", tool.sample_begin);
    access.values(group + "/depth_max_m", "m", tool.depth_max_m);
    access.values(group + "/force_max_n", "N", tool.force_max_n);
    access.values(group + "/stiffness_max_n_per_m", "N m-1",
                  tool.stiffness_max_n_per_m);
    access.values(group + "/error_relative_max", "1", tool.error_relative_max);
    access.values(group + "/direction_spread_max_rad", "rad",
                  tool.direction_spread_max_rad);
    access.values(group + "/origin_count", "1", tool.origin_count);
    access.values(group + "/flag_count", "1", tool.flag_count);
    access.values(group + "/sha256", "1", tool.sha256);
    if (access.optional(group + "/memory_sha256", tool.memory_sha256.rows() > 0)) {
      access.values(group + "/memory_sha256", "1", tool.memory_sha256);
    }
    if (access.optional(group + "/tilt_sha256", tool.tilt_sha256.rows() > 0)) {
      access.values(group + "/tilt_sha256", "1", tool.tilt_sha256);
    }
    if (access.optional(group + "/compliance_sha256",
                        tool.compliance_sha256.rows() > 0)) {
      access.values(group + "/compliance_sha256", "1", tool.compliance_sha256);
    }
    if (access.optional(group + "/puncture_sha256", tool.puncture_sha256.rows() > 0)) {
      access.values(group + "/puncture_sha256", "1", tool.puncture_sha256);
    }
    if (access.optional(group + "/contact_sha256", tool.contact_sha256.rows() > 0)) {
      access.values(group + "/contact_sha256", "1", tool.contact_sha256);
    }
    if (access.optional(group + "/share_min", tool.share_min.rows() > 0)) {
      access.values(group + "/share_min", "1", tool.share_min);
      access.values(group + "/share_max", "1", tool.share_max);
    }
  }
}

/// Writes an index, or compares the file's with one.
template <typename File>
struct DerivedIndex {
  File& file;
  void group(const std::string& path) { file.group(path); }
  template <typename Values>
  void values(const std::string& path, const char* units, const Values& values) {
    file.derived(path, units, values);
  }
  [[nodiscard]] bool optional(const std::string& /*path*/, bool wanted) const {
    return wanted;
  }
};

/// Reads an index.
struct ReadIndex {
  StoredReader& file;
  void group(const std::string& path) { file.group(path); }
  template <typename Values>
  void values(const std::string& path, const char* units, Values& values) {
    file.dataset(path, units, values);
  }
  [[nodiscard]] bool optional(const std::string& path, bool wanted) {
    return file.optional_dataset(path, wanted);
  }
};

}  // namespace palpate::content
