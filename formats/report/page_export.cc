#include "formats/report/page_export.h"

#include <algorithm>
#include <functional>
#include <utility>

#include <fmt/ranges.h>

#include "formats/base/error.h"
#include "formats/database/database_slice.h"

namespace palpate {
namespace {

class Cut {
 public:
  // Empties what is there, and says so once.
  template <typename... Parts>
  void out(const char* what, bool there, Parts&... parts) {
    if (there) {
      ((parts = Parts()), ...);
      say(what);
    }
  }
  void say(const char* what) {
    if (std::find(left_out_.begin(), left_out_.end(), what) == left_out_.end()) {
      left_out_.emplace_back(what);
    }
  }
  [[nodiscard]] std::string text() const {
    return left_out_.empty()
               ? ""
               : fmt::format("This page leaves out {}.", fmt::join(left_out_, "; "));
  }

 private:
  std::vector<std::string> left_out_;
};

// Of a tool, what is neither shown nor rendered.
void leave_out_unseen(ResponseTable& table, bool several, Cut& cut) {
  cut.out("uncertainties of samples", !table.force_errors_n.empty(),
          table.force_errors_n);
  cut.out("what solves tried and why some failed",
          !table.history.empty() || !table.failure.empty(), table.history,
          table.history_text, table.failure, table.failure_reason);
  cut.out("measured holds", !table.relaxation.empty(), table.relaxation);
  cut.out("how several contacts couple", !several && !table.compliance.empty(),
          table.compliance);
}

ResponseDatabase part_of(const ResponseDatabase& database,
                         const std::vector<std::string>& tools, Cut& cut) {
  if (tools.size() > 2) {
    throw InputError(
        fmt::format("a page has one tool, or two for two hands, not {}", tools.size()));
  }
  const std::vector<const ResponseTable*> tables = find_tools(database, tools);
  ResponseDatabase part = database;
  if (tables.size() < database.tools.size()) {
    part = slice(database, {.tools = tools});
    cut.say("other tools");
  }
  cut.out("raw measurements", !part.measurement.depth_m.empty(), part.measurement);
  const bool several = tables.size() > 1 || !tables.front()->tool.contact.empty();
  for (ResponseTable& table : part.tools) {
    leave_out_unseen(table, several, cut);
  }
  return part;
}

void leave_out_displacements(ResponseDatabase& part, Cut& cut) {
  for (ResponseTable& table : part.tools) {
    cut.out("stored displacements, which a template stands for",
            !table.displacement.node.empty(), table.displacement);
  }
}

}  // namespace

PageExport page_of(const ResponseDatabase& database, const std::string& name,
                   const std::vector<std::string>& tools,
                   std::span<const std::byte> module, const InversePorts& device,
                   std::size_t bytes_most) {
  Cut cut;
  ResponseDatabase part = part_of(database, tools, cut);
  const auto page = [&] {
    const std::vector<std::byte> flat = flat_bytes(part);
    const std::string left_out = cut.text();
    return PageExport{standalone_page({name, tools, left_out, flat, device}, module),
                      left_out};
  };
  PageExport made = page();
  if (made.html.size() > bytes_most && part.storage.precision != Precision::kInt16) {
    part.storage.precision = Precision::kInt16;
    cut.say("digits of depths and forces beyond 1/32767 of a node's largest");
    made = page();
  }
  if (made.html.size() > bytes_most) {
    leave_out_displacements(part, cut);
    made = page();
  }
  return made;
}

}  // namespace palpate
