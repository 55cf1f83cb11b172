#include "runtime/served/scene_watch.h"

#include <fstream>
#include <iterator>

namespace palpate {

bool SceneWatch::changed_from(const std::string& served) {
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_ < kEvery) {
    return changed_;
  }
  looked_ = now;
  std::ifstream file(scene_, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)),
                         std::istreambuf_iterator<char>());
  changed_ = !text.empty() && text != served;
  return changed_;
}

}  // namespace palpate
