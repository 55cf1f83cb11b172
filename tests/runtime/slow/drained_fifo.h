// What a slow process has sent.
#pragma once

#include <vector>

#include "runtime/slow/element_source.h"

namespace palpate {

/// All elements that wait, taken out.
inline std::vector<Element> drain(ElementFifo& fifo) {
  std::vector<Element> all;
  while (const Element* front = fifo.front()) {
    all.push_back(*front);
    fifo.pop();
  }
  return all;
}

}  // namespace palpate
