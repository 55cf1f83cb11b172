// What a served scene says of the body and the tool that are rendered.
#pragma once

#include <cstdint>
#include <string>

#include "formats/database/response_database.h"
#include "formats/service/service_message.h"

namespace palpate {

/// Index of the named tool, or of the only one for an empty name. @throws InputError
/// naming those that there are.
[[nodiscard]] std::int32_t tool_index(const JobDescription& plan,
                                      const std::string& name);

/// @throws InputError, in one sentence, for what is not rendered while it is computed:
/// a tool of several contacts, responses that relax or yield.
void check_rendered(const JobDescription& plan, std::int32_t tool);

/// Whether another scene has this one's body and tool, so that its answers may take the
/// place of this one's.
[[nodiscard]] bool same_body(const JobDescription& a, const JobDescription& b,
                             std::int32_t tool);

/// The body with its tool of that index and no response: what a session is made of
/// before answers come.
[[nodiscard]] ResponseDatabase body_of(const ServedScene& scene, std::int32_t tool);

/// What a scene's database answers with that tool. @throws FormatError if it is of
/// another body, InputError if it lacks the tool.
[[nodiscard]] ServedResponses answers_of(const ResponseDatabase& database,
                                         const JobDescription& plan, std::int32_t tool);

}  // namespace palpate
