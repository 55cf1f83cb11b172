#include "precompute/process/failure_of.h"

#include <exception>
#include <new>

#include "formats/base/error.h"

namespace palpate {

std::string failure_of(const std::string& whose, const std::function<void()>& work) {
  try {
    work();
    return {};
  } catch (const Interrupted&) {
    throw;
  } catch (const ResourceError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw ResourceError(whose + " needed more memory than there is");
  } catch (const std::exception& error) {
    const std::string said = error.what();
    return said.empty() ? whose + " ended by an exception that says nothing" : said;
  } catch (...) {
    return whose + " ended by an unknown exception";
  }
}

}  // namespace palpate
