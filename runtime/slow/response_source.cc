#include "runtime/slow/response_source.h"

#include <span>
#include <utility>

#include "runtime/slow/field_stiffness.h"
#include "runtime/slow/file_contacts.h"
#include "runtime/slow/file_press_site.h"
#include "runtime/slow/memory_elements.h"

namespace palpate {
namespace {

class ResponsesInMemory : public ResponseSource {
 public:
  explicit ResponsesInMemory(const ResponseDatabase& database) : database_(database) {}

  PressingTool tool(const std::string& name) const override {
    return PressingTool(find_tool(database_, name));
  }
  RenderedStiffness stiffness(const std::string& tool, LocalModel model,
                              double force_max_n) const override {
    return model_stiffness(database_, find_tool(database_, tool), model, force_max_n);
  }
  std::vector<StiffestNode> stiffest(const std::string& tool, LocalModel model,
                                     double force_max_n) const override {
    return stiffest_by_contact(database_, find_tool(database_, tool), model,
                               force_max_n);
  }
  std::unique_ptr<TableElements> elements(const std::string& tool, double force_scale,
                                          const Eigen::Vector3d&) const override {
    return std::make_unique<ElementStream>(database_, find_tool(database_, tool),
                                           force_scale);
  }
  std::shared_ptr<ContactStream> contacts(const std::vector<std::string>& tools,
                                          double force_scale,
                                          const Eigen::Vector3d&) const override {
    return std::make_shared<ContactStream>(database_, find_tools(database_, tools),
                                           force_scale);
  }
  const ResponseDatabase* database() const override { return &database_; }

 private:
  const ResponseDatabase& database_;
};

class ResponsesInFile : public ResponseSource {
 public:
  ResponsesInFile(StoredSource file, std::size_t budget_bytes, bool in_thread)
      : file_(std::move(file)),
        reader_(file_),
        budget_bytes_(budget_bytes),
        in_thread_(in_thread) {}

  PressingTool tool(const std::string& name) const override {
    return pressing_tools(reader_.index(), std::span(&name, 1)).front();
  }
  RenderedStiffness stiffness(const std::string& tool, LocalModel,
                              double force_max_n) const override {
    return streamed_stiffness(reader_, find_tool(reader_.index(), tool), force_max_n);
  }
  std::vector<StiffestNode> stiffest(const std::string& tool, LocalModel,
                                     double force_max_n) const override {
    return streamed_stiffest(reader_, find_tool(reader_.index(), tool), force_max_n);
  }
  std::unique_ptr<TableElements> elements(
      const std::string& tool, double force_scale,
      const Eigen::Vector3d& start_m) const override {
    CacheOptions cache = share_of(force_scale);
    cache.tool = tool;
    return std::make_unique<StreamedElements>(file_, cache, start_m, in_thread_);
  }
  std::shared_ptr<ContactStream> contacts(
      const std::vector<std::string>& tools, double force_scale,
      const Eigen::Vector3d& start_m) const override {
    return streamed_contacts(reader_.index(), file_, tools, share_of(force_scale),
                             start_m, in_thread_);
  }

  const ChunkReader* reader() const override { return &reader_; }

 private:
  [[nodiscard]] CacheOptions share_of(double force_scale) const {
    return {.budget_bytes = budget_bytes_, .force_scale = force_scale};
  }

  StoredSource file_;
  ChunkReader reader_;
  std::size_t budget_bytes_;
  bool in_thread_;
};

}  // namespace

std::unique_ptr<ResponseSource> responses_in_memory(const ResponseDatabase& database) {
  return std::make_unique<ResponsesInMemory>(database);
}

std::unique_ptr<ResponseSource> responses_in_file(const StoredSource& file,
                                                  std::size_t budget_bytes,
                                                  bool in_thread) {
  return std::make_unique<ResponsesInFile>(file, budget_bytes, in_thread);
}

}  // namespace palpate
