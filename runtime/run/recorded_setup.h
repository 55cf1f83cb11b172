// What a recording says of a run's set-up, and that set-up made again of it.
#pragma once

#include <memory>

#include "formats/database/response_database.h"
#include "formats/recording/recording.h"
#include "runtime/account/local_model.h"
#include "runtime/render/fast_process.h"
#include "runtime/render/rendered_body.h"
#include "runtime/run/render_run.h"
#include "runtime/slow/memory_elements.h"

namespace palpate {

/// What a recording must say of a run. @param body what it renders, if that touches at
/// several places; null: one contact.
[[nodiscard]] RecordingHeader recording_header(const SimulationReport& report,
                                               const FastProcessConfig& config,
                                               const DeviceLimits& limits,
                                               const RenderedBody* body);

/// Configuration of the fast step that a header describes.
/// @throws FormatError for a model that is not known or a value out of range.
[[nodiscard]] FastConfig fast_config(const RecordingHeader& header);

/// What a recording rendered, at rest.
class ReplayedBody {
 public:
  /// @param database outlives it. @throws InputError if the database has not the tools,
  /// or as SeveralContacts; FormatError as fast_config().
  ReplayedBody(const RecordingHeader& header, const ResponseDatabase& database,
               LocalModel model);

  [[nodiscard]] RenderedBody& body() const noexcept { return *body_; }

 private:
  std::unique_ptr<ElementStream> stream_;  // of one contact
  std::unique_ptr<RenderedBody> body_;
};

}  // namespace palpate
