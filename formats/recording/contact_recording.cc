#include "formats/recording/contact_recording.h"

#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/lines.h"
#include "formats/hdf5/hdf5_reader.h"

namespace palpate {
namespace {

constexpr const char* kContactFormat = "palpate-contact-recording";
constexpr std::size_t kMostHands = 2;

// What a file holds, for both ways.
template <typename File, typename Recording>
void exchange(File& file, Recording& r) {
  file.attribute("/", "writer", r.writer);
  file.attribute("/", "database", r.database);
  file.attribute("/", "database_sha256", r.database_sha256);
  file.attribute("/", "fast_hz", r.fast_hz);
  file.attribute("/", "slow_hz", r.slow_hz);
  file.attribute("/", "force_scale", r.force_scale);
  file.attribute("/", "force_max_n", r.force_max_n);
  file.attribute("/", "ramp_s", r.ramp_s);
  file.attribute("/", "fault", r.fault);
  file.group("/tick");
  file.dataset("/tick/time_s", "s", r.time_s);
  file.dataset("/tick/pose", "m 1", r.pose);
  file.dataset("/tick/wrench", "N N.m", r.wrench);
  file.dataset("/tick/contacts", "1", r.contacts);
  file.dataset("/tick/depth_m", "m", r.depth_m);
  file.dataset("/tick/work_j", "J", r.work_j);
  file.dataset("/tick/stored_j", "J", r.stored_j);
  file.dataset("/tick/tank_j", "J", r.tank_j);
  file.dataset("/tick/dissipated_j", "J", r.dissipated_j);
}

void check_head(const Hdf5Reader& file, const ContactRecording& r) {
  if (r.tools.empty() || r.tools.size() > kMostHands) {
    file.fail(fmt::format("attribute /@tools names {} tools, must be 1 or 2",
                          r.tools.size()));
  }
  for (const auto& [name, value] :
       {std::pair("fast_hz", r.fast_hz), std::pair("slow_hz", r.slow_hz),
        std::pair("force_scale", r.force_scale),
        std::pair("force_max_n", r.force_max_n), std::pair("ramp_s", r.ramp_s + 1.0)}) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      file.fail(fmt::format("attribute /@{} is out of its range", name));
    }
  }
}

void check_tick_rows(const Hdf5Reader& file, const ContactRecording& r) {
  const auto rows = static_cast<Eigen::Index>(r.time_s.size());
  const auto expect = [&](const char* name, Eigen::Index has, Eigen::Index columns,
                          Eigen::Index wanted) {
    if (has != rows || columns != wanted) {
      file.fail(fmt::format("/tick/{} has {} rows of {}, must have {} of {}", name, has,
                            columns, rows, wanted));
    }
  };
  expect("pose", r.pose.rows(), r.pose.cols(), 7 * r.hands());
  expect("wrench", r.wrench.rows(), r.wrench.cols(), 6 * r.hands());
  expect("contacts", static_cast<Eigen::Index>(r.contacts.size()), 1, 1);
  for (const auto& [name, column] :
       {std::pair("depth_m", &r.depth_m), std::pair("work_j", &r.work_j),
        std::pair("stored_j", &r.stored_j), std::pair("tank_j", &r.tank_j),
        std::pair("dissipated_j", &r.dissipated_j)}) {
    expect(name, static_cast<Eigen::Index>(column->size()), 1, 1);
  }
  constexpr double kUnit = 1e-9;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!std::isfinite(r.time_s[at]) || (i > 0 && !(r.time_s[at] > r.time_s[at - 1]))) {
      file.fail(fmt::format("/tick/time_s, row {}: {}, must rise", i, r.time_s[at]));
    }
    for (Eigen::Index hand = 0; hand < r.hands(); ++hand) {
      const auto pose = r.pose.row(i).segment<7>(7 * hand);
      if (!pose.allFinite() || std::abs(pose.tail<4>().norm() - 1.0) > kUnit) {
        file.fail(fmt::format(
            "/tick/pose, row {}: hand {} has no place with a unit quaternion", i,
            hand + 1));
      }
    }
  }
}

}  // namespace

void write_contact_recording(const std::filesystem::path& file,
                             const ContactRecording& recording) {
  const Hdf5Lock lock;
  AtomicFile atomic(file);
  Hdf5Writer out;
  out.attribute("/", "format", std::string(kContactFormat));
  out.attribute("/", "format_version", kContactRecordingVersion);
  out.attribute("/", "tools", join_lines(recording.tools));
  out.attribute("/", "model", recording.model);
  exchange(out, recording);
  out.remark("/", kDigestName, out.digest());
  atomic.write(out.image());
  atomic.commit();
}

bool is_contact_recording(const std::filesystem::path& file) {
  const Hdf5Lock lock;
  try {
    const Hdf5Reader in(file);
    return in.has_attribute("/", "format") &&
           in.remark("/", "format") == kContactFormat;
  } catch (const Error&) {
    return false;  // who reads it says what is wrong
  }
}

ContactRecording read_contact_recording(const std::filesystem::path& file) {
  const Hdf5Lock lock;
  Hdf5Reader in(file);
  std::string format;
  if (in.has_attribute("/", "format")) {
    in.attribute("/", "format", format);
  }
  if (format != kContactFormat) {
    in.fail("is not a recording of contacts");
  }
  std::int64_t version = 0;
  in.attribute("/", "format_version", version);
  if (version < 1 || version > kContactRecordingVersion) {
    in.fail(fmt::format("format version is {}, must be 1 or {}", version,
                        kContactRecordingVersion));
  }
  ContactRecording recording;
  std::string tools;
  in.attribute("/", "tools", tools);
  recording.tools = split_lines(tools);
  if (version == 1) {
    recording.model = "facets";
  } else {
    in.attribute("/", "model", recording.model);
  }
  exchange(in, recording);
  if (in.remark("/", kDigestName) != in.digest()) {
    in.fail("is damaged: its SHA-256 is not the one it states");
  }
  check_head(in, recording);
  check_tick_rows(in, recording);
  return recording;
}

}  // namespace palpate
