#include "tests/support/old_contact_recording.h"

#include "formats/base/atomic_file.h"
#include "formats/base/lines.h"

namespace palpate {

void write_old_contact_recording(const std::filesystem::path& file,
                                 const OldContactRecording& r) {
  AtomicFile atomic(file);
  StoredWriter out = make_writer(form_of(file));
  out.attribute("/", "format", std::string("palpate-contact-recording"));
  out.attribute("/", "format_version", std::int64_t{2});
  out.attribute("/", "tools", join_lines(r.tools));
  out.attribute("/", "model", r.model);
  out.attribute("/", "writer", r.writer);
  out.attribute("/", "database", r.database);
  out.attribute("/", "database_sha256", r.database_sha256);
  out.attribute("/", "fast_hz", r.fast_hz);
  out.attribute("/", "slow_hz", r.slow_hz);
  out.attribute("/", "force_scale", r.force_scale);
  out.attribute("/", "force_max_n", r.force_max_n);
  out.attribute("/", "ramp_s", r.ramp_s);
  out.attribute("/", "fault", r.fault);
  out.group("/tick");
  out.dataset("/tick/time_s", "s", r.time_s);
  out.dataset("/tick/pose", "m 1", r.pose);
  out.dataset("/tick/wrench", "N N.m", r.wrench);
  out.dataset("/tick/contacts", "1", r.contacts);
  out.dataset("/tick/depth_m", "m", r.depth_m);
  out.dataset("/tick/work_j", "J", r.work_j);
  out.dataset("/tick/stored_j", "J", r.stored_j);
  out.dataset("/tick/tank_j", "J", r.tank_j);
  out.dataset("/tick/dissipated_j", "J", r.dissipated_j);
  out.remark("/", kDigestName, out.digest());
  atomic.write(out.image());
  atomic.commit();
}

}  // namespace palpate
