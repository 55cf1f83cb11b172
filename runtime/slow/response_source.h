// Where a body's responses lie, in memory or in its file: what is asked of them before
// they are rendered, and who sends them then.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/database/chunk_reader.h"
#include "formats/database/response_database.h"
#include "runtime/account/local_model.h"
#include "runtime/device/stability_margin.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/contact_stiffness.h"
#include "runtime/slow/table_elements.h"

namespace palpate {

/// Tools by name; empty: the only one. What it gives does not need it any more, but for
/// PressingTool.
class ResponseSource {
 public:
  ResponseSource() = default;
  virtual ~ResponseSource() = default;
  ResponseSource(const ResponseSource&) = delete;
  ResponseSource& operator=(const ResponseSource&) = delete;

  /// @throws InputError naming the tools that there are.
  [[nodiscard]] virtual PressingTool tool(const std::string& name) const = 0;

  /// Of a tool that touches at one place.
  [[nodiscard]] virtual RenderedStiffness stiffness(const std::string& tool,
                                                    LocalModel model,
                                                    double force_max_n) const = 0;

  /// By contact.
  [[nodiscard]] virtual std::vector<StiffestNode> stiffest(
      const std::string& tool, LocalModel model, double force_max_n) const = 0;

  /// Of a tool that touches at one place. @param start_m [m] where it is first.
  [[nodiscard]] virtual std::unique_ptr<TableElements> elements(
      const std::string& tool, double force_scale,
      const Eigen::Vector3d& start_m) const = 0;

  /// Of tools whose contacts are coupled.
  [[nodiscard]] virtual std::shared_ptr<ContactStream> contacts(
      const std::vector<std::string>& tools, double force_scale,
      const Eigen::Vector3d& start_m) const = 0;

  /// Null: not in memory.
  [[nodiscard]] virtual const ResponseDatabase* database() const { return nullptr; }
  /// Null: not in a file.
  [[nodiscard]] virtual const ChunkReader* reader() const { return nullptr; }
};

/// @param database outlives it.
[[nodiscard]] std::unique_ptr<ResponseSource> responses_in_memory(
    const ResponseDatabase& database);

/// Responses stay in the file but for budget_bytes of each elements() and contacts().
/// The margin's friction is that of the tool, because the index has none of the nodes.
/// @param in_thread reads beside the slow process, not in it. @throws as ChunkReader.
[[nodiscard]] std::unique_ptr<ResponseSource> responses_in_file(
    const StoredSource& file, std::size_t budget_bytes, bool in_thread);

}  // namespace palpate
