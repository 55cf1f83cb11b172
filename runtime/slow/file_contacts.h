// Several contacts on a body that stays in its file: a stream of elements for each
// table of responses, all within one budget.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/database/database_index.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/file_elements.h"

namespace palpate {

/// Tools of an index, by name. @throws InputError naming the tools that there are.
[[nodiscard]] std::vector<PressingTool> pressing_tools(
    const DatabaseIndex& index, std::span<const std::string> names);

/// Of tools that press the body of `file` together; each table has its share of the
/// budget. Forces are those of the whole database in memory. @param index of the file.
/// @param cache budget, horizon and scale of all. @param start_m, in_thread as
/// StreamedElements takes them. @throws as that and coupled_set().
[[nodiscard]] std::shared_ptr<ContactStream> streamed_contacts(
    const DatabaseIndex& index, const StoredSource& file,
    std::span<const std::string> tools, const CacheOptions& cache,
    const Eigen::Vector3d& start_m, bool in_thread);

}  // namespace palpate
