#include "tests/support/page_visit.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/json_text.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

const std::string kBegin = R"js(<script>
window.addEventListener('load', () => setTimeout(() => {
  const seen = {};
)js";

// Printed into the page.
const std::string kEnd = R"js(
  seen.requests = performance.getEntriesByType('resource').length;
  const result = document.createElement('pre');
  result.id = 'seen';
  result.textContent = JSON.stringify(seen);
  document.body.append(result);
}, 300));
</script></body>)js";

}  // namespace

std::string page_browser() {
  for (const char* name : {"chromium-headless-shell", "chromium", "chromium-browser"}) {
    if (std::system(fmt::format("command -v {} >/dev/null 2>&1", name).c_str()) == 0) {
      return name;
    }
  }
  return "";
}

PageVisit visit_page(const std::string& page, const std::string& script) {
  const ScratchFolder folder;
  std::string visited = page;
  visited.replace(visited.rfind("</body>"), 7, kBegin + script + kEnd);
  std::ofstream(folder / "page.html", std::ios::binary) << visited;
  const std::string command = fmt::format(
      "HOME='{0}' timeout 120 {1} --headless --no-sandbox --disable-gpu "
      "--user-data-dir='{0}/profile' --enable-logging=stderr --window-size=1200,1000 "
      "--virtual-time-budget=3000 --dump-dom 'file://{0}/page.html' >'{0}/dom' "
      "2>'{0}/log'",
      folder.path().string(), page_browser());
  PageVisit result;
  EXPECT_EQ(std::system(command.c_str()), 0) << bytes_of(folder / "log");
  const std::string dom = bytes_of(folder / "dom");
  const std::string begin = "<pre id=\"seen\">";
  const std::size_t at = dom.rfind(begin);
  if (at != std::string::npos) {
    const std::size_t from = at + begin.size();
    result.seen = parse_json(dom.substr(from, dom.find("</pre>", from) - from));
  }
  std::istringstream log(bytes_of(folder / "log"));
  for (std::string line; std::getline(log, line);) {
    if (line.find("CONSOLE") != std::string::npos) {
      result.complaints += line + '\n';
    }
  }
  return result;
}

}  // namespace palpate
